//! Whole scans without pictures: spots are put where the simulator's light falls, with the noise that
//! pictures would give them. Hundreds of scans take seconds.

use nalgebra::Vector3;
use snellius::export::ReconstructionResult;
use snellius::pipeline::{Settings, reconstruct};
use snellius::scan::{Manifest, Scan, VesselShape};
use snellius::simulate::{Scene, SceneObject, Simulation, Sweep, Truth, TruthView};
use snellius::spots::{Spot, Spots};

use super::Random;

/// How a result stands to the truth, in views.
#[derive(Clone, Copy, Debug, Default)]
pub struct Score {
    pub views: usize,
    pub wanted: usize,
    pub found: usize,
    pub gross: usize,
    pub false_points: usize,
    pub squares: f64,
}

impl Score {
    pub fn of(result: &ReconstructionResult, truth: &Truth) -> Self {
        let mut score = Self::default();
        for (view, truth) in result.views.iter().zip(&truth.views) {
            score.views += 1;
            score.wanted += usize::from(truth.object.first().is_some());
            match (view.object.first(), truth.object.first()) {
                (Some(found), Some(place)) => {
                    let off = (Vector3::from(found) - Vector3::from(place)).norm();
                    score.found += 1;
                    score.gross += usize::from(off > 2.0);
                    score.squares += off * off;
                }
                (Some(_), None) => score.false_points += 1,
                (None, _) => {}
            }
        }
        score
    }

    pub fn and(self, other: Self) -> Self {
        Self {
            views: self.views + other.views,
            wanted: self.wanted + other.wanted,
            found: self.found + other.found,
            gross: self.gross + other.gross,
            false_points: self.false_points + other.false_points,
            squares: self.squares + other.squares,
        }
    }

    pub fn rms(&self) -> f64 {
        (self.squares / self.found as f64).sqrt()
    }
}

/// What the lens and the beam make of light: a spot as the detector would report it.
pub fn spot([u, v]: [f64; 2], light: f64, random: &mut Random) -> Spot {
    const WIDTH: f64 = 1.5;
    // As pictures of the simulator give it: some 0.07 px for an object's spot.
    let sigma = 0.06 * (900.0 / light).max(0.3).sqrt();
    let width = WIDTH * WIDTH;
    Spot {
        u: u + sigma * random.normal(),
        v: v + sigma * random.normal(),
        covariance: [sigma * sigma, 0.0, sigma * sigma],
        shape: [width, 0.0, width],
        skew: [0.0; 4],
        brightness: light,
        peak: light / (2.0 * std::f64::consts::PI * width),
        area: 30,
        saturated: false,
    }
}

/// Lights that are less than this far apart make one spot, px.
pub const MERGED: f64 = 5.0;

/// The spots that a view's light makes.
pub fn spots(view: &TruthView, random: &mut Random) -> Spots {
    let usual = |light: f64, random: &mut Random| light * (0.15 * random.normal()).exp();
    let mut lights: Vec<([f64; 2], f64)> = Vec::new();
    let own = [
        (view.vessel_pixel.first(), 650.0),
        (view.object_pixel.first(), 900.0),
        (view.back_pixel, 500.0),
    ];
    for (pixel, light) in own {
        lights.extend(pixel.map(|pixel| (pixel, usual(light, random))));
    }
    lights.extend(view.ghosts.iter().map(|ghost| (ghost.pixel, ghost.light)));
    let mut merged: Vec<([f64; 2], f64)> = Vec::new();
    for (pixel, light) in lights {
        let near = |other: &&mut ([f64; 2], f64)| {
            (other.0[0] - pixel[0]).hypot(other.0[1] - pixel[1]) < MERGED
        };
        match merged.iter_mut().find(near) {
            Some((place, sum)) => {
                let part = light / (*sum + light);
                *sum += light;
                for axis in 0..2 {
                    place[axis] += part * (pixel[axis] - place[axis]);
                }
            }
            None => merged.push((pixel, light)),
        }
    }
    let mut spots: Vec<Spot> = merged
        .into_iter()
        .map(|(pixel, light)| spot(pixel, light, random))
        .collect();
    spots.sort_by(|a, b| b.brightness.total_cmp(&a.brightness));
    Spots {
        spots,
        said: Vec::new(),
        noise: 1.0,
        line: None,
    }
}

pub fn measure(scene: Scene) -> (ReconstructionResult, Truth) {
    measure_with(scene, |_| {}, &Settings::default())
}

/// Measures a scene whose manifest is changed before.
pub fn measure_with(
    scene: Scene,
    change: impl FnOnce(&mut Manifest),
    settings: &Settings,
) -> (ReconstructionResult, Truth) {
    let mut random = Random::seeded(scene.seed);
    let simulation = Simulation::new(scene).unwrap();
    let truth = simulation.truth();
    let mut manifest = simulation.manifest().clone();
    change(&mut manifest);
    let scan = Scan::new(manifest).unwrap();
    let spots: Vec<Spots> = truth.views.iter().map(|v| spots(v, &mut random)).collect();
    let result = reconstruct(&scan, &spots, settings).unwrap().result();
    (result, truth)
}

/// Vessels and objects as scans have them.
pub const KINDS: [&str; 6] = [
    "box in a tank",
    "ball in a tank",
    "box in a tank, pitched",
    "few views",
    "ball in a jar",
    "ball in a bowl",
];

pub fn scene(kind: &str, random: &mut Random) -> Scene {
    let mut scene = Scene::from_toml(
        r#"
        name = "Ghosts"
        camera = { model = "opencv", width = 800, height = 600, fx = 1102.5, fy = 1101.8, cx = 403.2, cy = 296.4, distortion = [-0.112, 0.061, 0.0006, -0.0004, 0.0] }
        laser = { kind = "spot", origin = [-160.0, 3.0, 4.0], direction = [0.336, -0.006, 0.942] }
        flange_from_camera = { rotation = [0.7071, 0.0, 0.0, 0.7071], translation = [28.0, -41.5, 63.2] }
        vessel = { wall_thickness = 2.1, centre = [0.0, 0.0, 0.0], rotation = [-1.5, 2.0, 0.0], half_size = [260.0, 170.0] }
        media = { outside = 1.0, wall = 1.5, inside = 1.333 }
        brightness = { outer_face = 650.0, inner_face = 0.0 }
        sweep = []
    "#,
    )
    .unwrap();
    let object = match kind {
        "ball in a tank" => SceneObject::Sphere {
            centre: [
                random.between(-15.0, 20.0),
                random.between(-15.0, 15.0),
                100.0,
            ],
            radius: random.between(35.0, 60.0),
        },
        "ball in a jar" | "ball in a bowl" => SceneObject::Sphere {
            centre: [6.0, 0.0, 8.0],
            radius: 27.0,
        },
        _ => {
            let half = random.between(35.0, 50.0);
            SceneObject::Box {
                centre: [4.0, 0.0, 112.0],
                half: [half, 140.0, half],
                rotation: [0.0, random.between(30.0, 60.0), 0.0],
            }
        }
    };
    scene.objects = vec![object];
    let row = |y: f64, views: usize, rotation: [f64; 3], lift: f64| Sweep {
        from: [-72.0, y + lift, -400.0],
        to: [40.0, y + lift, -400.0],
        views,
        rotation,
        turn: [0.0; 2],
    };
    match kind {
        "ball in a jar" | "ball in a bowl" => {
            scene.vessel.shape = match kind {
                "ball in a jar" => VesselShape::Cylinder,
                _ => VesselShape::Sphere,
            };
            scene.vessel.wall_thickness = 2.5;
            scene.vessel.radius = Some(75.0);
            for y in [-12.0, 0.0, 12.0] {
                for step in 0..17 {
                    let yaw = -32.0 + 4.0 * f64::from(step);
                    let (sine, cosine) = yaw.to_radians().sin_cos();
                    let place = [-440.0 * sine, y, -440.0 * cosine];
                    scene.sweeps.push(Sweep {
                        from: place,
                        to: place,
                        views: 1,
                        rotation: [0.0, yaw, 0.0],
                        turn: [0.0; 2],
                    });
                }
            }
        }
        "few views" => {
            for y in [-60.0, -20.0, 20.0, 60.0] {
                scene.sweeps.push(row(y, 6, [0.0; 3], 0.0));
            }
        }
        "box in a tank, pitched" => {
            for y in [-60.0, -20.0, 20.0, 60.0] {
                scene.sweeps.push(row(y, 12, [-18.0, 0.0, 0.0], -130.0));
            }
        }
        "ball in a tank" => {
            for y in [-40.0, -20.0, 0.0, 20.0, 40.0] {
                scene.sweeps.push(row(y, 15, [0.0; 3], 0.0));
            }
        }
        _ => {
            for y in [-100.0, -50.0, 0.0, 50.0, 100.0] {
                scene.sweeps.push(row(y, 15, [0.0; 3], 0.0));
            }
        }
    }
    scene
}
