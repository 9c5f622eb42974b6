//! Random vessels before random rigs, and the spots that they would show: traced, not photographed.

use snellius::scan::{Scan, VesselShape};
use snellius::simulate::{Relief, Scene, SceneObject, Simulation, Sweep, Truth};
use snellius::spots::{Spot, Spots};

use super::Random;

/// A scan of a random vessel, without pictures.
pub struct Traced {
    pub scan: Scan,
    pub truth: Truth,
    pub simulation: Simulation,
}

/// A vessel of a shape, of a random size, turned at random, with a rig that walks round it or along it at
/// several heights.
///
/// The bulges of a free form come from control heights some `bulges` mm apart.
pub fn random_vessel(shape: VesselShape, bulges: f64, random: &mut Random) -> Scene {
    let mut scene = Scene::from_toml(RIG).unwrap();
    let over = match shape {
        VesselShape::Freeform if random.between(0.0, 1.0) < 0.5 => VesselShape::Plane,
        VesselShape::Freeform => VesselShape::Cylinder,
        simple => simple,
    };
    scene.vessel.shape = shape;
    scene.vessel.declared = Some(VesselShape::Auto);
    let smallest = if shape == VesselShape::Freeform {
        90.0
    } else {
        40.0
    };
    let radius = random.between(smallest, 150.0);
    scene.vessel.radius = Some(radius);
    let rows = random.between(3.0, 7.99).floor();
    let stations = random.between(9.0, 15.99).floor() as usize;
    let flat = over == VesselShape::Plane;
    let lean = 15.0;
    let roll = random.between(-180.0, 180.0);
    scene.vessel.rotation = [
        random.between(-lean, lean),
        random.between(-lean, lean),
        roll,
    ];
    if shape == VesselShape::Freeform {
        scene.vessel.rotation[2] = random.between(-lean, lean);
        scene.vessel.relief = Some(relief(over, bulges, random));
    }
    let half_height = if flat {
        random.between(12.0, 25.0) * 0.5 * (rows - 1.0)
    } else {
        (random.between(0.25, 0.5) * radius).min(60.0)
    };
    let arc = random.between(18.0, 32.0);
    let heights =
        (0..rows as usize).map(|row| half_height * (2.0 * row as f64 / (rows - 1.0) - 1.0));
    scene.sweeps = heights
        .flat_map(|y| {
            if flat {
                let half = 4.0 * (stations - 1) as f64;
                vec![Sweep {
                    from: [15.0 - half, y, -400.0],
                    to: [15.0 + half, y, -400.0],
                    views: stations,
                    rotation: [0.0; 3],
                    turn: [0.0; 2],
                }]
            } else {
                let step = |i: usize| arc * (2.0 * i as f64 / (stations - 1) as f64 - 1.0);
                (0..stations).map(|i| around(radius, y, step(i))).collect()
            }
        })
        .collect();
    scene.objects = vec![if flat {
        SceneObject::Box {
            centre: [4.0, 0.0, 112.0],
            half: [50.0, 140.0, 50.0],
            rotation: [0.0, 45.0, 0.0],
        }
    } else {
        SceneObject::Sphere {
            centre: [0.05 * radius, 0.0, 0.1 * radius],
            radius: 0.55 * radius,
        }
    }];
    scene
}

/// A station that looks at the y axis from 365 mm before a round vessel's face.
fn around(radius: f64, y: f64, degrees: f64) -> Sweep {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let away = radius + 365.0;
    let place = [-away * sin, y, -away * cos];
    Sweep {
        from: place,
        to: place,
        views: 1,
        rotation: [0.0, degrees, 0.0],
        turn: [0.0; 2],
    }
}

/// Bulges and dents of some millimetres.
fn relief(over: VesselShape, bulges: f64, random: &mut Random) -> Relief {
    let step = bulges * random.between(0.85, 1.15);
    let row = |random: &mut Random| (0..12).map(|_| 2.0 * random.normal()).collect();
    Relief {
        over,
        step: [step, step],
        heights: (0..12).map(|_| row(random)).collect(),
    }
}

impl Traced {
    pub fn new(scene: Scene) -> Self {
        let simulation = Simulation::new(scene).unwrap();
        Self {
            scan: Scan::new(simulation.manifest().clone()).unwrap(),
            truth: simulation.truth(),
            simulation,
        }
    }

    /// The spots at their true places but for noise of `sigma` px; of the vessel's, one in `stray` lies
    /// elsewhere on the epipolar line.
    pub fn spots(&self, sigma: f64, stray: f64, random: &mut Random) -> Vec<Spots> {
        let mut noisy = |pixel: [f64; 2]| Spot {
            u: pixel[0] + sigma * random.normal(),
            v: pixel[1] + sigma * random.normal(),
            covariance: [sigma * sigma, 0.0, sigma * sigma],
            shape: [1.4, 0.0, 1.4],
            skew: [0.0; 4],
            brightness: 800.0,
            peak: 90.0,
            area: 40,
            saturated: false,
        };
        let mut spots = Vec::new();
        for view in &self.truth.views {
            let on_wall = view.vessel_pixel.first().map(&mut noisy);
            let on_object = view.object_pixel.first().map(&mut noisy);
            spots.push(Spots {
                spots: on_wall.into_iter().chain(on_object).collect(),
                said: Vec::new(),
                noise: 1.0,
                line: None,
            });
        }
        for view in &mut spots {
            let is_stray = random.between(0.0, 1.0) < stray;
            if let Some(spot) = view.spots.first_mut().filter(|_| is_stray) {
                spot.u += random.between(-25.0, 25.0);
            }
        }
        spots
    }
}

/// The rig of the development: a camera of 38 degrees and a laser 160 mm to its left.
const RIG: &str = r#"
    name = "A random vessel"
    camera = { model = "opencv", width = 800, height = 600, fx = 1102.5, fy = 1101.8, cx = 403.2, cy = 296.4, distortion = [-0.112, 0.061, 0.0006, -0.0004, 0.0] }
    laser = { kind = "spot", origin = [-160.0, 3.0, 4.0], direction = [0.336, -0.006, 0.942] }
    flange_from_camera = { rotation = [1.0, 0.0, 0.0, 0.0], translation = [0.0, 0.0, 0.0] }
    vessel = { wall_thickness = 2.5, centre = [0.0, 0.0, 0.0], half_size = [300.0, 300.0] }
    media = { outside = 1.0, wall = 1.5, inside = 1.333 }
    sweep = []
"#;
