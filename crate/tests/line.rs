//! Line lasers: the line in the picture, the sheet behind the wall, whole scans recovered to their noise.
#![cfg(not(target_family = "wasm"))]
#![allow(
    clippy::disallowed_methods,
    reason = "expectations may come from the platform"
)]

mod common;

use std::sync::LazyLock;

use common::archives::{Simulated, measure, scene, simulate};
use common::pictures::pair;
use common::{Random, direction, lens, parallel_layers};
use nalgebra::Vector3;
use snellius::camera::Pixel;
use snellius::export::{ReconstructionResult, Status};
use snellius::geometry::{Camera, Point, Pose, Ray, World};
use snellius::object::{MeetingError, laser_ray, meet};
use snellius::optics::{Cylinder, Media, Stack, Surface, aim_through};
use snellius::rig::{Laser, Profiles, Rig, Sheet};
use snellius::scan::{InsideMedium, LaserKind, Picture, PicturePair, VesselShape};
use snellius::simulate::{Brightness, Scene, SceneObject, Sweep, Truth};
use snellius::spots::{Spot, SpotSettings, Spots, find_line};
use snellius::vessel::Wall;

// The line in the picture.

/// Where a line is in a row.
type Course<'a> = &'a dyn Fn(f64) -> Option<f64>;

/// A picture of lines: each has its course, its standard deviation and its height.
struct Lines<'a> {
    width: usize,
    height: usize,
    lines: Vec<(Course<'a>, f64, f64)>,
}

impl Lines<'_> {
    fn pair(&self, full_scale: u16, random: &mut Random) -> PicturePair {
        let ambient = |v: usize| 30.0 + 0.1 * v as f64;
        let light = |u: usize, v: usize| {
            let one = |(at, sigma, peak): &(Course, f64, f64)| {
                at(v as f64).map_or(0.0, |at| {
                    let x = (u as f64 - at) / sigma;
                    peak * (-0.5 * x * x).exp()
                })
            };
            self.lines.iter().map(one).sum::<f64>()
        };
        let mut taken = |lit: bool| {
            let grey = (0..self.width * self.height).map(|i| {
                let (u, v) = (i % self.width, i / self.width);
                let grey = ambient(v) + if lit { light(u, v) } else { 0.0 };
                let sigma = (0.64 + 0.02 * grey).sqrt();
                let read = (grey + sigma * random.normal()).round();
                read.clamp(0.0, f64::from(full_scale)) as u16
            });
            Picture {
                width: self.width,
                height: self.height,
                full_scale,
                grey: grey.collect(),
            }
        };
        pair(taken(true), taken(false))
    }
}

fn found(lines: &Lines, seed: u64) -> Spots {
    let pictures = lines.pair(255, &mut Random::seeded(seed));
    find_line(&pictures, Profiles::Rows, &SpotSettings::default())
}

fn normalised(spots: &[Spot], truth: impl Fn(f64) -> f64) -> Vec<f64> {
    let off = |spot: &Spot| (spot.u - truth(spot.v)) / spot.covariance_matrix().m11.sqrt();
    spots.iter().map(off).collect()
}

fn mean_square(values: &[f64]) -> f64 {
    values.iter().map(|z| z * z).sum::<f64>() / values.len() as f64
}

/// A point a row, off by what its variance says, however the line leans.
#[test]
fn a_line_has_a_point_in_every_row_to_its_stated_noise() {
    for (slope, seed) in [(0.0, 1), (0.13, 2), (-0.7, 3)] {
        let place = move |v: f64| 200.3 + slope * (v - 150.0);
        let at = |v: f64| Some(place(v));
        let spots = found(
            &Lines {
                width: 400,
                height: 300,
                lines: vec![(&at, 1.3, 60.0)],
            },
            seed,
        );
        let line = spots.line.as_ref().unwrap();
        assert_eq!(line.curves.len(), 1, "one curve");
        assert_eq!(spots.spots.len(), 300, "one point a row");
        let z = normalised(&spots.spots, place);
        let chi = mean_square(&z);
        assert!((0.7..1.35).contains(&chi), "slope {slope}: {chi}");
        let sigma = spots.spots[0].covariance_matrix().m11.sqrt();
        assert!(sigma < 0.06, "{sigma} px");
    }
}

/// The least that any estimator can reach (Cramér and Rao): of a Gaussian of height a and width s in even
/// noise e, variance 2 s e^2 / (sqrt(pi) a^2).
#[test]
fn the_noise_of_a_point_is_near_the_least_possible() {
    let at = |_: f64| Some(100.4);
    let spots = found(
        &Lines {
            width: 200,
            height: 300,
            lines: vec![(&at, 1.5, 20.0)],
        },
        4,
    );
    // Both pictures have read noise 0.8 and shot noise of some 45 and 55 grey values, and rounding.
    let noise = 2.0 * 0.64 + 0.02 * (45.0 + 55.0) + 2.0 / 12.0;
    let least = 2.0 * 1.5 * noise / (std::f64::consts::PI.sqrt() * 400.0);
    let off: Vec<f64> = spots.spots.iter().map(|spot| spot.u - 100.4).collect();
    let reached = mean_square(&off) / least;
    assert!((0.8..1.35).contains(&reached), "{reached} times the least");
}

/// Two lines in every row, one of them with a gap, are two lines and not one; a hot pixel is none.
#[test]
fn lines_side_by_side_and_broken_ones_are_told_apart() {
    let (left, right) = (|v: f64| 80.2 + 0.05 * v, |v: f64| 90.7 + 0.09 * v);
    let whole = |v: f64| Some(left(v));
    let broken = |v: f64| (!(100.0..140.0).contains(&v)).then(|| right(v));
    let hot = |v: f64| (v == 120.0).then_some(150.0);
    let spots = found(
        &Lines {
            width: 200,
            height: 240,
            lines: vec![
                (&whole, 1.2, 50.0),
                (&broken, 1.2, 40.0),
                (&hot, 0.3, 200.0),
            ],
        },
        5,
    );
    let line = spots.line.as_ref().unwrap();
    assert_eq!(line.curves.len(), 3);
    let of = |curve: usize| &spots.spots[line.curves[curve].range()];
    let truth = |spot: &Spot| {
        if (spot.u - left(spot.v)).abs() < 3.0 {
            left(spot.v)
        } else {
            right(spot.v)
        }
    };
    for spot in &spots.spots {
        assert!(
            (spot.u - truth(spot)).abs() < 0.3,
            "({}, {})",
            spot.u,
            spot.v
        );
    }
    assert_eq!(of(0).len(), 240);
    // The points at the gap's ends are left out: with a blur along the line they would be drawn aside.
    let beside = of(1).len() + of(2).len();
    assert!((190..=200).contains(&beside), "{beside}");
}

/// A line that is too bright is flat on top, still symmetrical, and says so.
#[test]
fn an_overexposed_line_is_found_in_its_middle_and_marked() {
    let at = |v: f64| Some(60.3 + 0.02 * v);
    let spots = found(
        &Lines {
            width: 120,
            height: 100,
            lines: vec![(&at, 1.6, 500.0)],
        },
        6,
    );
    assert_eq!(spots.spots.len(), 100);
    for spot in &spots.spots {
        assert!(spot.saturated);
        assert!((spot.u - 60.3 - 0.02 * spot.v).abs() < 0.1, "{}", spot.u);
    }
}

/// A picture turned by a quarter gives the same points in columns.
#[test]
fn rows_and_columns_are_alike() {
    let at = |v: f64| Some(90.0 + 0.2 * v + 4.0 * (0.05 * v).sin());
    let lines = Lines {
        width: 180,
        height: 150,
        lines: vec![(&at, 1.3, 60.0)],
    };
    let pictures = lines.pair(255, &mut Random::seeded(7));
    let turned = |picture: &Picture| Picture {
        width: picture.height,
        height: picture.width,
        full_scale: picture.full_scale,
        grey: (0..picture.grey.len())
            .map(|i| picture.grey[i % picture.height * picture.width + i / picture.height])
            .collect(),
    };
    let across = pair(turned(&pictures.on), turned(pictures.off.as_ref().unwrap()));
    let settings = SpotSettings::default();
    let rows = find_line(&pictures, Profiles::Rows, &settings);
    let columns = find_line(&across, Profiles::Columns, &settings);
    assert_eq!(rows.spots.len(), columns.spots.len());
    for (row, column) in rows.spots.iter().zip(&columns.spots) {
        assert_eq!(row.v, column.u);
        // The noise is measured on another grid of pixels, and with it the width of the search.
        assert!((row.u - column.v).abs() < 1e-3, "{} {}", row.u, column.v);
    }
}

// The sheet behind the wall.

const MEDIA: Media = Media {
    outside: 1.0,
    wall: 1.5,
    liquid: 1.33,
};

fn rig() -> Rig {
    Rig {
        camera: lens(),
        laser: Laser::Sheet(Sheet {
            apex: Point::new(-160.0, 3.0, 4.0),
            normal: direction([0.942, 0.05, -0.336]),
        }),
        flange_from_camera: Pose::identity(),
    }
}

fn sheet(rig: &Rig) -> Sheet {
    match rig.laser {
        Laser::Sheet(sheet) => sheet,
        Laser::Beam(_) => panic!("a sheet"),
    }
}

/// From 400 mm before a tank's wall; and a jar.
fn walls() -> [(Stack, Pose<World, Camera>); 2] {
    let tank = parallel_layers(1.0, &[(2.1, 1.5), (0.0, 1.33)]);
    let jar = Surface::Cylinder(Cylinder {
        point: Point::new(0.0, 0.0, 70.0),
        axis: direction([0.02, 1.0, -0.05]),
        radius: 70.0,
    });
    let jar = Wall::exact(jar, 2.5, None)
        .stack(&MEDIA, InsideMedium::Liquid)
        .unwrap();
    let pose = Pose::from_parts(
        nalgebra::UnitQuaternion::from_scaled_axis(Vector3::new(0.05, -0.08, 0.03)),
        Vector3::new(10.0, -15.0, -400.0),
    );
    [(tank, pose), (jar, pose)]
}

/// Points on refracted rays of the sheet, projected into the picture by another way (aiming from the
/// camera), are found again from their pixels.
#[test]
fn a_point_that_the_sheet_lights_is_found_from_its_pixel() {
    let rig = rig();
    let mut count = 0;
    for (stack, pose) in walls() {
        let eye = pose.point(Point::origin());
        for step in -12..=12 {
            let angle = f64::from(step) * 0.01;
            let light = stack.trace(&pose.ray(&sheet(&rig).ray_at(angle))).unwrap();
            for depth in [3.0, 20.0, 60.0] {
                let lit = light.at(depth);
                let aim = aim_through(&stack, eye, lit).unwrap();
                let ahead = pose.inverse().direction(aim).vector();
                let pixel = rig.camera.project(Point::from_coords(ahead)).unwrap();
                let meeting = meet(&rig, &pose, &stack, pixel).unwrap();
                assert!(
                    meeting.point().distance(lit) < 1e-6,
                    "{} mm off",
                    meeting.point().distance(lit)
                );
                assert!(meeting.gap().abs() < 1e-9);
                count += 1;
            }
        }
    }
    assert_eq!(count, 150);
}

/// Fermat: of all ways from the laser to the object's point that cross the faces elsewhere, none is faster
/// to first order; and the way begins within the sheet.
#[test]
fn the_light_of_the_sheet_takes_a_path_of_stationary_time() {
    const H: f64 = 1e-3;
    let rig = rig();
    let (stack, pose) = &walls()[0];
    for v in [40.0, 180.0, 333.0, 520.0] {
        let pixel = Pixel::new(430.0, v);
        let lit = meet(&rig, pose, stack, pixel).unwrap().point().coords;
        let ray: Ray<World> = laser_ray(&rig, pose, stack, pixel).unwrap();
        let in_rig = pose.inverse().direction(ray.direction);
        assert!(in_rig.dot(sheet(&rig).normal).abs() < 1e-12, "in the sheet");
        let path = stack.path(&ray).unwrap();
        let [start, a, b] = [0, 1, 2].map(|i| path.vertices[i].coords);
        let time = |a: Vector3<f64>, b: Vector3<f64>| {
            (a - start).norm() + 1.5 * (b - a).norm() + 1.33 * (lit - b).norm()
        };
        for along in [Vector3::x(), Vector3::y()] {
            let slopes = [
                time(a + along * H, b) - time(a - along * H, b),
                time(a, b + along * H) - time(a, b - along * H),
            ];
            for slope in slopes {
                assert!((slope / (2.0 * H)).abs() < 1e-7, "{slope}");
            }
        }
    }
}

/// A line of sight that runs away from the sheet meets none of its rays.
#[test]
fn a_line_of_sight_beside_the_sheet_meets_no_ray() {
    let rig = Rig {
        laser: Laser::Sheet(Sheet {
            apex: Point::new(-160.0, 0.0, 0.0),
            normal: direction([1.0, 0.0, 0.0]),
        }),
        ..rig()
    };
    let (stack, pose) = &walls()[0];
    let away = Pixel::new(700.0, 300.0);
    assert_eq!(
        meet(&rig, pose, stack, away).unwrap_err(),
        MeetingError::NoRayOfSheet
    );
}

// Whole scans.

fn line_scene(normal: [f64; 3]) -> Scene {
    let mut scene = scene();
    scene.laser.kind = LaserKind::Line;
    scene.laser.direction = None;
    scene.laser.normal = Some(normal);
    scene.beam.fan = 34.0;
    scene.brightness = Brightness {
        outer_face: 150.0,
        inner_face: 45.0,
        object: 220.0,
        back: 0.0,
        ..Brightness::default()
    };
    scene
}

/// A ball before a box in the tank; the sheet is upright and moves along.
fn tank() -> Scene {
    let mut scene = line_scene([0.942, 0.012, -0.336]);
    scene.sweeps = vec![Sweep {
        from: [-60.0, 0.0, -400.0],
        to: [20.0, 0.0, -400.0],
        views: 6,
        rotation: [0.0; 3],
        turn: [0.0; 2],
    }];
    scene
}

/// A round vessel about the origin, with a ball in it.
fn round(shape: VesselShape, declared: VesselShape) -> Scene {
    let mut scene = tank();
    scene.vessel.shape = shape;
    scene.vessel.declared = Some(declared);
    scene.vessel.radius = Some(75.0);
    scene.vessel.rotation = [0.5, 0.0, -0.8];
    scene.vessel.wall_thickness = 2.5;
    scene.objects = vec![SceneObject::Sphere {
        centre: [-8.0, 3.0, 5.0],
        radius: 38.0,
    }];
    scene.sweeps[0].from = [-60.0, 4.0, -455.0];
    scene.sweeps[0].to = [30.0, 4.0, -455.0];
    scene.sweeps[0].views = 8;
    scene
}

static TANK: LazyLock<Simulated> = LazyLock::new(|| simulate(tank()));

/// How a result stands to the truth.
#[derive(Default)]
struct Score {
    /// Rows in which the truth has a point of the object.
    wanted: usize,
    /// Errors of the points, mm.
    object: Vec<f64>,
    vessel: Vec<f64>,
    /// In units of their standard deviation, each axis.
    normalised: Vec<f64>,
    /// Points with no truth within three pixels.
    false_points: usize,
}

/// The true place that is seen in the row (or column) of a pixel, and how far from it in that row, px.
fn truth_at(
    profiles: Profiles,
    pixel: [f64; 2],
    pixels: &[[f64; 2]],
    places: &[[f64; 3]],
) -> Option<(f64, Vector3<f64>)> {
    let place = |p: &[f64; 2]| profiles.place(Pixel::new(p[0], p[1]));
    let (lane, at) = place(&pixel);
    let pairs = pixels.windows(2).zip(places.windows(2));
    let crossings = pairs.filter_map(|(p, q)| {
        let ((a, from), (b, to)) = (place(&p[0]), place(&p[1]));
        let part = (lane - a) / (b - a);
        let joined = (a - b).abs() < 3.0 && (from - to).abs() < 3.0;
        (joined && (0.0..=1.0).contains(&part)).then(|| {
            let (from_place, to_place) = (Vector3::from(q[0]), Vector3::from(q[1]));
            let off = (at - from - part * (to - from)).abs();
            (off, from_place + (to_place - from_place) * part)
        })
    });
    crossings.min_by(|a, b| a.0.total_cmp(&b.0))
}

fn score(result: &ReconstructionResult, truth: &Truth, profiles: Profiles) -> Score {
    let mut score = Score::default();
    for (view, truth) in result.views.iter().zip(&truth.views) {
        let line = view.line.as_ref().expect("a line");
        let lanes = truth.object_pixel.iter().map(|p| {
            let (lane, _) = profiles.place(Pixel::new(p[0], p[1]));
            lane.round() as i64
        });
        let mut lanes: Vec<i64> = lanes.collect();
        lanes.dedup();
        score.wanted += lanes.len();
        let (pixels, places) = (truth.vessel_pixel.as_slice(), truth.vessel.as_slice());
        for (pixel, place) in line.vessel.iter().zip(view.vessel.iter()) {
            if let Some((_, there)) = truth_at(profiles, *pixel, pixels, places) {
                score.vessel.push((Vector3::from(*place) - there).norm());
            }
        }
        let (pixels, places) = (truth.object_pixel.as_slice(), truth.object.as_slice());
        let sigmas = view.object_sigma.iter();
        for ((pixel, place), sigma) in line.object.iter().zip(view.object.iter()).zip(sigmas) {
            let there = truth_at(profiles, *pixel, pixels, places);
            let Some((_, there)) = there.filter(|(off, _)| *off < 3.0) else {
                // Of the outermost rows the truth has no two rays to lie between.
                let (lane, _) = profiles.place(Pixel::new(pixel[0], pixel[1]));
                let last = if profiles == Profiles::Rows {
                    239.0
                } else {
                    319.0
                };
                score.false_points += usize::from(lane > 0.0 && lane < last);
                continue;
            };
            let off = Vector3::from(*place) - there;
            score.object.push(off.norm());
            score
                .normalised
                .extend((0..3).map(|axis| off[axis] / sigma[axis]));
        }
    }
    score
}

fn rms(values: &[f64]) -> f64 {
    mean_square(values).sqrt()
}

/// Nearly all points there are, no others, and all as good as they say.
#[track_caller]
fn assert_recovered(simulated: &Simulated, profiles: Profiles, limits: (f64, f64)) -> Score {
    let result = measure(&simulated.archive).unwrap();
    let score = score(&result, &simulated.truth, profiles);
    assert!(score.wanted > 200, "the scene shows its object");
    let found = score.object.len() as f64 / score.wanted as f64;
    assert!(found > 0.93, "{found} of the points");
    let false_points = score.false_points as f64 / score.wanted as f64;
    assert!(false_points < 0.005, "{false_points} are false");
    let (object, vessel) = (rms(&score.object), rms(&score.vessel));
    assert!(object < limits.0, "{object} mm RMS");
    assert!(vessel < limits.1, "the wall: {vessel} mm RMS");
    let within = within(&score.normalised, 2.0);
    assert!(within > 0.88, "{within} within 2 sigma");
    score
}

fn within(normalised: &[f64], limit: f64) -> f64 {
    let close = normalised.iter().filter(|z| z.abs() <= limit).count();
    close as f64 / normalised.len() as f64
}

#[test]
fn a_box_in_a_tank_is_recovered() {
    assert_recovered(&TANK, Profiles::Rows, (0.15, 0.1));
}

/// The laser above the camera, its sheet level: profiles are columns.
#[test]
fn a_level_sheet_measures_as_well() {
    let mut scene = line_scene([0.012, 0.942, -0.336]);
    scene.laser.origin = [3.0, -160.0, 4.0];
    scene.sweeps = vec![Sweep {
        from: [0.0, -50.0, -400.0],
        to: [0.0, 30.0, -400.0],
        views: 5,
        rotation: [0.0; 3],
        turn: [0.0; 2],
    }];
    assert_recovered(&simulate(scene), Profiles::Columns, (0.15, 0.15));
}

#[test]
fn a_ball_in_a_jar_is_recovered() {
    let scene = round(VesselShape::Cylinder, VesselShape::Auto);
    assert_recovered(&simulate(scene), Profiles::Rows, (0.25, 0.12));
}

#[test]
fn a_ball_in_a_bowl_is_recovered() {
    let scene = round(VesselShape::Sphere, VesselShape::Sphere);
    assert_recovered(&simulate(scene), Profiles::Rows, (0.25, 0.12));
}

/// Over scans with other noise the errors in units of their standard deviations are those of a normal
/// distribution. What all points of a scan share (the wall) leaves fewer independent values than points.
#[test]
fn standard_deviations_are_honest() {
    let mut normalised = Vec::new();
    for seed in 20..26 {
        let mut scene = Scene { seed, ..tank() };
        scene.sweeps[0].views = 4;
        let simulated = simulate(scene);
        let result = measure(&simulated.archive).unwrap();
        normalised.extend(score(&result, &simulated.truth, Profiles::Rows).normalised);
    }
    let (one, two) = (within(&normalised, 1.0), within(&normalised, 2.0));
    assert!((0.90..0.99).contains(&two), "{two} within 2 sigma");
    assert!((0.55..0.82).contains(&one), "{one} within 1 sigma");
}

/// The share of the inner face's light in the scene is 45 / 195, and the wall is 2.1 mm thick.
#[test]
fn the_two_glows_of_the_line_are_told_apart() {
    let result = measure(&TANK.archive).unwrap();
    let glow = result.vessel.glow.unwrap();
    let (off, sigma) = (glow.inner_share - 0.2308, glow.inner_share_sigma);
    assert!(
        sigma < 0.07 && off.abs() < 2.5 * sigma,
        "{off}, sigma {sigma}"
    );
    let thickness = glow.thickness.unwrap();
    assert!((thickness - 2.1).abs() < 0.3, "{thickness} mm");
}

/// What stands in front of something else hides it, and where nothing stands there is no point.
#[test]
fn views_that_miss_the_object_say_so() {
    let mut scene = tank();
    scene.objects = vec![SceneObject::Sphere {
        centre: [20.0, 0.0, 90.0],
        radius: 20.0,
    }];
    let simulated = simulate(scene);
    let result = measure(&simulated.archive).unwrap();
    let mut missed = 0;
    for (view, truth) in result.views.iter().zip(&simulated.truth.views) {
        assert_eq!(view.object.iter().len(), view.object_sigma.iter().len());
        assert_eq!(view.object.iter().len(), view.ray_distance.iter().len());
        assert_eq!(
            view.object.iter().len(),
            view.object_sigma_calibration.iter().len()
        );
        assert!(view.spots.is_empty());
        if truth.object.first().is_none() {
            missed += 1;
            assert!(view.object.first().is_none(), "{}", view.id);
            assert_ne!(view.status, Status::Ok);
            assert!(view.reason.is_some());
        }
    }
    assert!((1..6).contains(&missed), "{missed}");
}

/// A false line that is seen beside the object's, or instead of it, passes every test of its own view. The
/// other views' surface tells it.
#[test]
fn false_lines_become_no_points() {
    let (mut found, mut wanted, mut false_points, mut ghosts) = (0, 0, 0, 0);
    for seed in 0..3 {
        let mut scene = Scene { seed, ..tank() };
        scene.sweeps[0].views = 12;
        scene.ghosts.probability = 0.3;
        scene.ghosts.most = 1;
        scene.ghosts.light = [90.0, 250.0];
        scene.ghosts.hides = 0.5;
        let simulated = simulate(scene);
        let views = simulated.truth.views.iter();
        ghosts += views.map(|view| view.ghosts.len()).sum::<usize>();
        let result = measure(&simulated.archive).unwrap();
        let score = score(&result, &simulated.truth, Profiles::Rows);
        found += score.object.len();
        wanted += score.wanted;
        false_points += score.false_points;
    }
    assert!(ghosts >= 6, "{ghosts} false lines");
    let share = |count: usize| count as f64 / wanted as f64;
    assert!(
        share(false_points) < 0.02,
        "{} are false",
        share(false_points)
    );
    assert!(share(found) > 0.85, "{} found", share(found));
}
