//! Which spot is real: scans in which reflections, drops on the glass and the vessel's back wall show
//! spots that are none of the object's.
#![cfg(feature = "simulate")]
#![allow(
    clippy::disallowed_methods,
    reason = "expectations may come from the platform"
)]

mod common;

use common::Random;
use nalgebra::Vector3;
use snellius::export::ReconstructionResult;
use snellius::pipeline::{Settings, reconstruct};
use snellius::scan::{Scan, VesselShape};
use snellius::simulate::{Scene, SceneObject, Simulation, Sweep, Truth, TruthView};
use snellius::spots::{Spot, Spots};

/// How a result stands to the truth, in views.
#[derive(Clone, Copy, Debug, Default)]
struct Score {
    views: usize,
    wanted: usize,
    found: usize,
    gross: usize,
    false_points: usize,
    squares: f64,
}

impl Score {
    fn of(result: &ReconstructionResult, truth: &Truth) -> Self {
        let mut score = Self::default();
        for (view, truth) in result.views.iter().zip(&truth.views) {
            score.views += 1;
            score.wanted += usize::from(truth.object.is_some());
            match (view.object.first(), truth.object) {
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

    fn and(self, other: Self) -> Self {
        Self {
            views: self.views + other.views,
            wanted: self.wanted + other.wanted,
            found: self.found + other.found,
            gross: self.gross + other.gross,
            false_points: self.false_points + other.false_points,
            squares: self.squares + other.squares,
        }
    }

    fn rms(&self) -> f64 {
        (self.squares / self.found as f64).sqrt()
    }
}

/// What the lens and the beam make of light: a spot as the detector would report it.
fn spot([u, v]: [f64; 2], light: f64, random: &mut Random) -> Spot {
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
const MERGED: f64 = 5.0;

/// The spots that a view's light makes.
fn spots(view: &TruthView, random: &mut Random) -> Spots {
    let usual = |light: f64, random: &mut Random| light * (0.15 * random.normal()).exp();
    let mut lights: Vec<([f64; 2], f64)> = Vec::new();
    let own = [
        (view.vessel_pixel, 650.0),
        (view.object_pixel, 900.0),
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
    Spots { spots, noise: 1.0 }
}

fn measure(scene: Scene) -> (ReconstructionResult, Truth) {
    let mut random = Random::seeded(scene.seed);
    let simulation = Simulation::new(scene).unwrap();
    let truth = simulation.truth();
    let scan = Scan::new(simulation.manifest().clone()).unwrap();
    let spots: Vec<Spots> = truth.views.iter().map(|v| spots(v, &mut random)).collect();
    let result = reconstruct(&scan, &spots, &Settings::default())
        .unwrap()
        .result();
    (result, truth)
}

/// Vessels and objects as scans have them.
const KINDS: [&str; 6] = [
    "box in a tank",
    "ball in a tank",
    "box in a tank, pitched",
    "few views",
    "ball in a jar",
    "ball in a bowl",
];

fn scene(kind: &str, random: &mut Random) -> Scene {
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

/// Scans of a kind, with ghosts in 5 to 30 % of the views.
fn haunted(kind: &str, scans: u64) -> Score {
    let one = |seed: u64| {
        let mut random = Random::seeded(seed);
        let mut scene = scene(kind, &mut random);
        scene.seed = 1000 * seed;
        scene.ghosts.probability = random.between(0.05, 0.3);
        scene.ghosts.hides = 0.25;
        scene.ghosts.light = [250.0, 1300.0];
        let (result, truth) = measure(scene);
        Score::of(&result, &truth)
    };
    (0..scans).map(one).fold(Score::default(), Score::and)
}

/// In 240 scans, with ghosts in up to 30 % of the views. A ghost that takes the place of a spot that is
/// missing, and lies on the surface that the neighbours make, deceives anybody; those are the few false
/// points that are allowed. (Ray distance and brightness alone give 902 false points and 260 that are
/// grossly off.) Most points that are lost have merged with a ghost; a ball's outline is hard to tell.
#[test]
fn ghosts_become_no_points() {
    for kind in KINDS {
        let score = haunted(kind, 40);
        let found = score.found as f64 / score.wanted as f64;
        let least = if kind == "ball in a tank" { 0.96 } else { 0.97 };
        assert!(found >= least, "{kind}: {found} found, {score:?}");
        let false_share = score.false_points as f64 / score.views as f64;
        assert!(false_share < 0.003, "{kind}: {score:?}");
        let gross = score.gross as f64 / score.found as f64;
        assert!(gross < 0.003, "{kind}: {score:?}");
        assert!(score.rms() < 0.5, "{kind}: {} mm RMS", score.rms());
    }
}

/// Where nothing hints at ghosts, every spot is taken at its word: none is lost.
#[test]
fn without_ghosts_nothing_is_refused() {
    for kind in KINDS {
        for seed in 0..4 {
            let mut random = Random::seeded(seed);
            let mut scene = scene(kind, &mut random);
            scene.seed = seed;
            let (result, truth) = measure(scene);
            let score = Score::of(&result, &truth);
            assert_eq!(
                (score.found, score.false_points, score.gross),
                (score.wanted, 0, 0),
                "{kind}, {seed}"
            );
        }
    }
}

/// Where the beam passes the object, the back of the vessel lights up: a surface of its own, and none of the
/// object's.
#[test]
fn the_vessels_back_is_no_object() {
    for kind in ["ball in a tank", "ball in a jar", "ball in a bowl"] {
        let mut landed = 0;
        for seed in 0..12 {
            let mut random = Random::seeded(100 + seed);
            let mut scene = scene(kind, &mut random);
            scene.seed = 1000 * seed;
            scene.vessel.depth = Some(random.between(200.0, 260.0));
            scene.brightness.back = 500.0;
            if kind.starts_with("ball in a ") && !kind.ends_with("tank") {
                // A ball beside the middle, which some beams pass.
                scene.objects = vec![SceneObject::Sphere {
                    centre: [18.0, 0.0, 0.0],
                    radius: 14.0,
                }];
            }
            let (result, truth) = measure(scene);
            let score = Score::of(&result, &truth);
            landed += truth.views.iter().filter(|v| v.back.is_some()).count();
            assert_eq!(
                (score.found, score.false_points),
                (score.wanted, 0),
                "{kind}, {seed}"
            );
            for (view, truth) in result.views.iter().zip(&truth.views) {
                if truth.back.is_some() {
                    let reason = view.reason.as_deref().unwrap_or_default();
                    let named = ["back wall", "far side"]
                        .iter()
                        .any(|name| reason.contains(name));
                    assert!(named, "{kind}, {seed}, {}: {reason}", view.id);
                }
            }
        }
        assert!(landed >= 10, "{kind}: {landed}");
    }
}

/// Two steps of an object, seen squarely, are faces parallel to the front wall as well.
#[test]
fn a_step_of_the_object_is_no_back_wall() {
    let mut random = Random::seeded(7);
    let mut scene = scene("box in a tank", &mut random);
    scene.objects = [(-20.0, 70.0), (30.0, 90.0)]
        .map(|(x, z)| SceneObject::Box {
            centre: [x, 0.0, z],
            half: [25.0, 140.0, 10.0],
            rotation: [0.0; 3],
        })
        .to_vec();
    let (result, truth) = measure(scene);
    let score = Score::of(&result, &truth);
    assert_eq!((score.found, score.false_points), (score.wanted, 0));
}
