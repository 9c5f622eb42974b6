//! Photographed scenes of every kind of wall, held against what the true wall would give on the same
//! pictures.
#![cfg(feature = "cli")]
#![allow(
    clippy::disallowed_methods,
    reason = "expectations may come from the platform"
)]

mod common;

use std::io::Cursor;

use common::archives::{both_faces_glow, scene, simulate};
use nalgebra::Vector3;
use snellius::pipeline::{Settings, observe, reconstruct};
use snellius::scan::{Archive, Scan, VesselShape};
use snellius::simulate::{Relief, Scene, SceneFarWall, SceneObject, Simulation, Sweep, Truth};
use snellius::spots::Spots;

/// How object points stand to the truth.
#[derive(Debug, Default)]
struct Errors {
    wanted: f64,
    found: f64,
    squares: f64,
    /// Of the coordinates, those within two standard deviations.
    honest: f64,
}

impl Errors {
    fn of(scan: &Scan, spots: &[Spots], truth: &Truth) -> Self {
        let result = reconstruct(scan, spots, &Settings::default())
            .unwrap()
            .result();
        let mut errors = Self::default();
        for (view, truth) in result.views.iter().zip(&truth.views) {
            let Some(there) = truth.object.first() else {
                assert!(view.object.first().is_none(), "{}: no object", view.id);
                continue;
            };
            errors.wanted += 1.0;
            let (Some(here), Some(sigma)) = (view.object.first(), view.object_sigma.first()) else {
                continue;
            };
            errors.found += 1.0;
            let off = Vector3::from(here) - Vector3::from(there);
            errors.squares += off.norm_squared();
            let within = (0..3).filter(|axis| off[*axis].abs() <= 2.0 * sigma[*axis]);
            errors.honest += within.count() as f64 / 3.0;
        }
        errors
    }

    fn rms(&self) -> f64 {
        (self.squares / self.found).sqrt()
    }

    fn add(&mut self, other: &Self) {
        self.wanted += other.wanted;
        self.found += other.found;
        self.squares += other.squares;
        self.honest += other.honest;
    }
}

/// Over several seeds: at most `factor` times the error that the true wall gives, at least `share` of the
/// points, and standard deviations that are honest.
#[track_caller]
fn assert_recovered(scene: &Scene, factor: f64, share: f64) -> f64 {
    let (mut measured, mut known) = (Errors::default(), Errors::default());
    for seed in 20..22 {
        let scene = Scene {
            seed,
            ..scene.clone()
        };
        let wall = Simulation::new(scene.clone()).unwrap().wall().clone();
        let simulated = simulate(scene);
        let mut archive = Archive::open(Cursor::new(&simulated.archive[..])).unwrap();
        let settings = Settings::default();
        let spots: Vec<_> = (0..archive.scan().stations.len())
            .map(|view| observe(&mut archive, view, &settings).unwrap())
            .collect();
        let scan = archive.scan();
        let true_wall = Scan {
            known_wall: Some(wall.outer),
            ..scan.clone()
        };
        measured.add(&Errors::of(scan, &spots, &simulated.truth));
        known.add(&Errors::of(&true_wall, &spots, &simulated.truth));
    }
    assert!(measured.wanted >= 40.0, "the scene shows its object");
    let (here, best) = (measured.rms(), known.rms());
    assert!(
        measured.found >= share * measured.wanted,
        "{measured:?} found"
    );
    assert!(
        here <= factor * best,
        "{here} mm, {best} mm with the true wall"
    );
    measured.honest / measured.found
}

/// A simple wall: as good as known but for half, every point, and honest. (In these scenes the inner face's
/// share of the glow is nearer to what is expected of it than its standard deviation says.)
#[track_caller]
fn assert_honest(scene: &Scene) {
    let honest = assert_recovered(scene, 1.5, 1.0);
    assert!((0.90..=0.995).contains(&honest), "{honest} within 2 sigma");
}

/// A ball in a round vessel; the rig walks around it.
fn round(shape: VesselShape) -> Scene {
    let mut scene = scene();
    scene.brightness = both_faces_glow();
    scene.vessel.shape = shape;
    scene.vessel.radius = Some(80.0);
    scene.vessel.rotation = [1.0, 0.0, -2.0];
    scene.objects = vec![SceneObject::Sphere {
        centre: [6.0, 0.0, 8.0],
        radius: 32.0,
    }];
    let stations = [-14.0, 0.0, 14.0]
        .into_iter()
        .flat_map(|y| (-4..=4).map(move |step| (y, 7.0 * f64::from(step))));
    scene.sweeps = stations
        .map(|(y, degrees)| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let place = [-445.0 * sin, y, -445.0 * cos];
            Sweep {
                from: place,
                to: place,
                views: 1,
                rotation: [0.0, degrees, 0.0],
                turn: [0.0; 2],
            }
        })
        .collect();
    scene
}

/// The box in a tank whose front has a bulge, 4 mm high and some 15 cm wide.
fn bulging() -> Scene {
    let mut scene = scene();
    scene.brightness = both_faces_glow();
    scene.vessel.shape = VesselShape::Freeform;
    let height = |x: i32, y: i32| {
        let far = f64::from(x * x + y * y) * (60.0 * 60.0);
        4.0 * (-far / (2.0 * 75.0 * 75.0)).exp()
    };
    scene.vessel.relief = Some(Relief {
        over: VesselShape::Plane,
        step: [60.0, 60.0],
        heights: (-4..=4)
            .map(|y| (-4..=4).map(|x| height(x, y)).collect())
            .collect(),
    });
    scene.sweeps = [-50.0, -25.0, 0.0, 25.0, 50.0]
        .map(|y| Sweep {
            from: [-60.0, y, -400.0],
            to: [40.0, y, -400.0],
            views: 6,
            rotation: [0.0; 3],
            turn: [0.0; 2],
        })
        .to_vec();
    scene
}

/// The box in air behind a tank of water 62.1 mm deep: five media, and both walls glow.
fn behind_tank() -> Scene {
    let mut scene = scene();
    scene.vessel.far_wall = Some(SceneFarWall {
        distance: 62.1,
        thickness: 2.1,
    });
    scene.objects = vec![SceneObject::Box {
        centre: [4.0, 0.0, 160.0],
        half: [50.0, 140.0, 50.0],
        rotation: [0.0, 45.0, 0.0],
    }];
    scene.brightness = both_faces_glow();
    scene
}

#[test]
fn a_flat_wall() {
    assert_honest(&scene());
}

#[test]
fn a_jar() {
    assert_honest(&round(VesselShape::Cylinder));
}

#[test]
fn a_bowl() {
    assert_honest(&round(VesselShape::Sphere));
}

/// The points of a scan share one error of the wall, so whether a free form's standard deviations are honest
/// shows over many scans: see wall_shapes.rs.
#[test]
fn a_wall_with_a_bulge() {
    assert_recovered(&bulging(), 3.0, 0.8);
}

#[test]
fn an_object_behind_the_tank() {
    assert_honest(&behind_tank());
}

#[test]
fn a_wall_that_the_manifest_knows() {
    let mut jar = round(VesselShape::Cylinder);
    jar.vessel.known = true;
    let honest = assert_recovered(&jar, 1.0 + 1e-9, 1.0);
    assert!((0.90..=0.995).contains(&honest), "{honest} within 2 sigma");
}
