//! Are the standard deviations honest? A scene is photographed many times, each time with other noise and
//! speckle, and measured with its wall fitted and with the true wall given.
//!
//! ```sh
//! cargo run --release -p snellius --example sigma_monte_carlo -- SCENE.toml [SCANS] [glows]
//! ```
//!
//! With `glows` the light of the wall's inner face differs from scan to scan, as much as is held likely of it
//! beforehand (q (1 - q) = 0.16 +- 0.06 for its share q); else it is the scene's.
//!
//! For the object's points it prints how many were found, their error, that error in standard deviations (1
//! if they are honest) and the share within two of them (0.954). For the wall, how far it lies off where the
//! beam meets it, beside what its covariance says.
#![allow(clippy::print_stdout, reason = "the numbers are this program's output")]

use std::error::Error;

use nalgebra::{DVector, Vector3};
use rayon::prelude::*;

use snellius::camera::Pixel;
use snellius::export::ViewResult;
use snellius::geometry::Point;
use snellius::pipeline::{Reconstruction, Settings, reconstruct};
use snellius::rig::{Laser, Profiles};
use snellius::scan::Scan;
use snellius::simulate::{Exposure, Scene, Simulation, Truth, TruthView};
use snellius::spots::{Spots, find_line, find_spots};
use snellius::vessel::Wall;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let path = arguments.first().ok_or("which scene?")?;
    let scans: u64 = arguments.get(1).map_or(Ok(20), |text| text.parse())?;
    let glows = arguments.get(2).is_some_and(|word| word == "glows");
    let scene = Scene::from_toml(&std::fs::read_to_string(path)?)?;
    let simulation = Simulation::new(scene.clone())?;
    let views = (0..simulation.views()).into_par_iter();
    let dark: Vec<Exposure> = views.map(|view| simulation.room_light(view)).collect();
    let runs: Vec<Run> = (0..scans)
        .into_par_iter()
        .filter_map(|seed| {
            let mut scene = Scene {
                // Farther apart than a scan has pictures, of which neighbouring seeds share most.
                seed: 1000 * seed,
                ..scene.clone()
            };
            if glows {
                let part = INNER_FACE[seed as usize % INNER_FACE.len()];
                scene.brightness.inner_face = part * scene.brightness.outer_face;
            }
            Run::of(scene, &dark)
                .inspect_err(|error| println!("{seed}: {error}"))
                .ok()
        })
        .collect();
    println!("{path}: {} scans", runs.len());
    println!("              found        false  RMS mm  z along x, y, z     within 2 sigma");
    print("wall fitted", runs.iter().map(|run| &run.measured));
    print("wall given", runs.iter().map(|run| &run.known));
    let of_wall: Vec<&(f64, f64)> = runs.iter().flat_map(|run| &run.wall).collect();
    let mean = |of: &dyn Fn(&(f64, f64)) -> f64| {
        of_wall.iter().map(|wall| of(wall)).sum::<f64>() / of_wall.len() as f64
    };
    println!(
        "wall: off {:.4} mm on average, {:.4} mm RMS; {:.4} mm stated, z {:.2}",
        mean(&|w| w.0),
        mean(&|w| w.0 * w.0).sqrt(),
        mean(&|w| w.1 * w.1).sqrt(),
        mean(&|w| w.0 * w.0 / (w.1 * w.1)).sqrt(),
    );
    let shares: Vec<(f64, f64)> = runs.iter().filter_map(|run| run.share).collect();
    let count = shares.len().max(1) as f64;
    let middle = shares.iter().map(|s| s.0).sum::<f64>() / count;
    let scatter = shares.iter().map(|s| (s.0 - middle) * (s.0 - middle));
    println!(
        "inner glow: share {middle:.3}, scatter {:.3}; {:.3} stated",
        (scatter.sum::<f64>() / count).sqrt(),
        shares.iter().map(|s| s.1).sum::<f64>() / count
    );
    Ok(())
}

/// The inner face's light over the outer one's, at even parts of what is held likely of it beforehand.
const INNER_FACE: [f64; 4] = [0.112, 0.206, 0.306, 0.55];

/// What became of a scan.
struct Run {
    measured: Points,
    known: Points,
    /// How far the fitted wall lies off the true one, and one standard deviation of it, mm, where the beam
    /// meets it.
    wall: Vec<(f64, f64)>,
    /// The inner glow's share and its standard deviation.
    share: Option<(f64, f64)>,
}

#[derive(Default)]
struct Points {
    wanted: usize,
    false_points: usize,
    /// Errors, mm, and in standard deviations.
    errors: Vec<(Vector3<f64>, Vector3<f64>)>,
}

impl Run {
    fn of(scene: Scene, dark: &[Exposure]) -> Result<Self, Box<dyn Error>> {
        let simulation = Simulation::new(scene)?;
        let truth = simulation.truth();
        let settings = Settings::default();
        let spots = dark.iter().enumerate();
        let scan = Scan::new(simulation.manifest().clone())?;
        let observed = |(view, dark): (usize, &Exposure)| {
            let pictures = simulation.pictures_by(dark, view);
            match &scan.rig.laser {
                Laser::Beam(_) => find_spots(&pictures, &settings.spots),
                Laser::Sheet(sheet) => find_line(&pictures, sheet.profiles(), &settings.spots),
            }
        };
        let spots: Vec<Spots> = spots.map(observed).collect();
        let given = Scan {
            known_wall: Some(simulation.wall().outer.clone()),
            ..scan.clone()
        };
        let measured = reconstruct(&scan, &spots, &settings)?;
        let known = reconstruct(&given, &spots, &settings)?;
        let vessel = &measured.vessel;
        Ok(Self {
            wall: wall_errors(&vessel.wall, &truth),
            share: vessel.glows.map(|glows| (glows.share, glows.share_sigma)),
            measured: Points::of(&measured, &truth),
            known: Points::of(&known, &truth),
        })
    }
}

impl Points {
    fn of(reconstruction: &Reconstruction, truth: &Truth) -> Self {
        let mut points = Self::default();
        let profiles = match &reconstruction.scan.rig.laser {
            Laser::Beam(_) => None,
            Laser::Sheet(sheet) => Some(sheet.profiles()),
        };
        for (view, truth) in reconstruction.result().views.iter().zip(&truth.views) {
            match profiles {
                None => points.count_beam(view, truth),
                Some(profiles) => points.count_line(view, truth, profiles),
            }
        }
        points
    }

    fn count_beam(&mut self, view: &ViewResult, truth: &TruthView) {
        let there = truth.object.first();
        self.wanted += usize::from(there.is_some());
        let here = view.object.first().zip(view.object_sigma.first());
        match (here, there) {
            (Some((here, sigma)), Some(there)) => self.count(&here, &sigma, Vector3::from(there)),
            (Some(_), None) => self.false_points += 1,
            (None, _) => {}
        }
    }

    /// A line's points are held against the true line in the same row (or column).
    fn count_line(&mut self, view: &ViewResult, truth: &TruthView, profiles: Profiles) {
        const FARTHEST: f64 = 3.0;
        let Some(line) = &view.line else { return };
        let lane = |[u, v]: &[f64; 2]| profiles.place(Pixel::new(*u, *v)).0.round() as i64;
        let mut lanes: Vec<i64> = truth.object_pixel.iter().map(lane).collect();
        lanes.dedup();
        self.wanted += lanes.len();
        let places = line.object.iter().zip(view.object.iter());
        for ((pixel, here), sigma) in places.zip(view.object_sigma.iter()) {
            match true_place(truth, *pixel, profiles) {
                Some((off, there)) if off < FARTHEST => self.count(here, sigma, there),
                _ => self.false_points += 1,
            }
        }
    }

    fn count(&mut self, here: &[f64; 3], sigma: &[f64; 3], there: Vector3<f64>) {
        let off = Vector3::from(*here) - there;
        let normalised = off.component_div(&Vector3::from(*sigma));
        self.errors.push((off, normalised));
    }
}

/// The true place that is seen in the row (or column) of a pixel, and how far from it there, px.
fn true_place(
    truth: &TruthView,
    [u, v]: [f64; 2],
    profiles: Profiles,
) -> Option<(f64, Vector3<f64>)> {
    const CONNECTED: f64 = 3.0;
    let place = |[u, v]: [f64; 2]| profiles.place(Pixel::new(u, v));
    let (lane, at) = place([u, v]);
    let pixels = truth.object_pixel.as_slice().windows(2);
    let crossings = pixels.zip(truth.object.as_slice().windows(2));
    let crossings = crossings.filter_map(|(pixels, places)| {
        let ((a, from), (b, to)) = (place(pixels[0]), place(pixels[1]));
        let part = (lane - a) / (b - a);
        let (first, second) = (Vector3::from(places[0]), Vector3::from(places[1]));
        let joined = (a - b).abs() < CONNECTED && (first - second).norm() < CONNECTED;
        (joined && (0.0..=1.0).contains(&part)).then(|| {
            let off = (at - from - part * (to - from)).abs();
            (off, first + (second - first) * part)
        })
    });
    crossings.min_by(|a, b| a.0.total_cmp(&b.0))
}

fn wall_errors(wall: &Wall, truth: &Truth) -> Vec<(f64, f64)> {
    const STEP: f64 = 1e-5;
    let freedom = wall.outer.freedom();
    let error = |place: Point<_>| {
        let slope = DVector::from_fn(freedom, |parameter, _| {
            let mut step = DVector::zeros(freedom);
            step[parameter] = STEP;
            let ahead = wall.outer.nudged(&step).signed_distance(place);
            (ahead - wall.outer.nudged(&-step).signed_distance(place)) / (2.0 * STEP)
        });
        let variance = (slope.transpose() * &wall.covariance * &slope).x;
        (wall.outer.signed_distance(place), variance.sqrt())
    };
    let places = truth.views.iter().filter_map(|view| view.vessel.first());
    places.map(|place| error(Point::from(place))).collect()
}

fn print<'a>(name: &str, runs: impl Iterator<Item = &'a Points>) {
    let runs: Vec<&Points> = runs.collect();
    let errors: Vec<_> = runs.iter().flat_map(|points| &points.errors).collect();
    let count = errors.len() as f64;
    let squares: f64 = errors.iter().map(|(off, _)| off.norm_squared()).sum();
    let z = |axis: usize| {
        let sum: f64 = errors.iter().map(|(_, z)| z[axis] * z[axis]).sum();
        (sum / count).sqrt()
    };
    let within = errors.iter().flat_map(|(_, z)| z.iter());
    let within = within.filter(|z| z.abs() <= 2.0).count();
    println!(
        "{name:12}  {:5}/{:5}  {:5}  {:.4}  {:.2} {:.2} {:.2}      {:.3}",
        errors.len(),
        runs.iter().map(|points| points.wanted).sum::<usize>(),
        runs.iter().map(|points| points.false_points).sum::<usize>(),
        (squares / count).sqrt(),
        z(0),
        z(1),
        z(2),
        within as f64 / (3.0 * count),
    );
}
