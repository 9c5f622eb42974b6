//! The robust plane: right where the points are, honest where they scatter, an error where they cannot tell.
#![cfg(not(target_family = "wasm"))]
#![allow(
    clippy::disallowed_methods,
    reason = "expectations may come from the platform"
)]

mod common;

use common::{Random, direction};
use nalgebra::Vector3;
use snellius::geometry::{FitError, Plane, PlaneFit, Point, WeightedPoint, World, fit_plane};

const FRONT: Point<World> = Point::new(0.0, 0.0, -400.0);

fn wall() -> Plane<World> {
    Plane::new(Point::new(10.0, -5.0, 3.0), direction([0.1, -0.2, -1.0]))
}

/// Points of `plane`, spread like those of a scan, each off it by what `off` says (mm).
fn points(
    plane: &Plane<World>,
    count: usize,
    random: &mut Random,
    mut off: impl FnMut(usize, &mut Random) -> f64,
    sigma: f64,
) -> Vec<WeightedPoint<World>> {
    let (u, v) = plane.normal.tangents();
    (0..count)
        .map(|k| {
            let across = u * random.between(-60.0, 60.0) + v * random.between(-100.0, 100.0);
            WeightedPoint {
                point: plane.point + across + plane.normal * off(k, random),
                sigma,
            }
        })
        .collect()
}

/// How far the fit is off the truth at the truth's point, and how far turned: mm, radians.
fn errors(fit: &PlaneFit<World>, truth: &Plane<World>) -> (f64, f64) {
    let turned = fit
        .plane
        .normal
        .vector()
        .cross(&truth.normal.vector())
        .norm();
    (truth.signed_distance(fit.plane.point).abs(), turned)
}

#[test]
fn points_of_a_plane_give_that_plane() {
    let mut random = Random::seeded(41);
    for count in [3, 4, 10, 75] {
        let fit = fit_plane(&points(&wall(), count, &mut random, |_, _| 0.0, 0.1), FRONT).unwrap();
        let (off, turned) = errors(&fit, &wall());
        assert!(
            off < 1e-10 && turned < 1e-11,
            "{count} points: {off} mm, {turned} rad"
        );
        assert!(
            fit.plane.signed_distance(FRONT) > 0.0,
            "the normal points to the front"
        );
        assert!(fit.rms < 1e-10);
    }
}

#[test]
fn the_normal_points_to_the_front_whichever_side_that_is() {
    let points = points(&wall(), 20, &mut Random::seeded(42), |_, _| 0.0, 0.1);
    let behind = fit_plane(&points, Point::new(0.0, 0.0, 400.0)).unwrap();
    assert!(behind.plane.normal.dot(wall().normal) < -0.999_999);
}

/// 40 % of the points lie 1 to 50 mm behind the wall, all on one side: where objects' spots were taken for
/// the wall's. Least squares would be pulled back by some 10 mm.
#[test]
fn four_points_in_ten_may_be_wrong() {
    let mut random = Random::seeded(43);
    for _ in 0..20 {
        let sigma = 0.05;
        let off = |k: usize, random: &mut Random| match k % 5 {
            0 | 1 => -random.between(1.0, 50.0),
            _ => sigma * random.normal(),
        };
        let points = points(&wall(), 75, &mut random, off, sigma);
        let fit = fit_plane(&points, FRONT).unwrap();
        let (off, turned) = errors(&fit, &wall());
        // 45 good points: sigma/sqrt(45) = 0.0075 mm, and 0.00013 rad over the spread of 58 mm.
        assert!(off < 0.04 && turned < 7e-4, "{off} mm, {turned} rad");
        assert!(
            fit.weights.iter().step_by(5).all(|w| *w == 0.0),
            "outliers have no say"
        );
    }
}

/// Over many noisy copies the squared error in units of the predicted covariance follows chi-square with
/// 3 degrees of freedom each: mean 3N, standard deviation sqrt(6N). Tukey's biweight gives away 5 % of
/// least squares' efficiency, so the sum may be larger by 1/0.95 (Huber & Ronchetti, Robust Statistics).
#[test]
fn the_covariance_is_the_scatter_of_many_copies() {
    let mut random = Random::seeded(44);
    let truth = wall();
    let (copies, sigma) = (1500, 0.08);
    let mut sum = 0.0;
    for _ in 0..copies {
        let points = points(
            &truth,
            60,
            &mut random,
            |_, random| sigma * random.normal(),
            sigma,
        );
        let fit = fit_plane(&points, FRONT).unwrap();
        let (u, v) = fit.plane.normal.tangents();
        // How the truth lies to the fit: tilts towards the fit's tangents, offset at the fit's point.
        let normal = truth.normal.vector() / truth.normal.dot(fit.plane.normal);
        let offset = -truth.signed_distance(fit.plane.point) / truth.normal.dot(fit.plane.normal);
        let error = Vector3::new(normal.dot(&u), normal.dot(&v), offset);
        sum += (error.transpose() * fit.covariance.try_inverse().unwrap() * error).x;
    }
    let (mean, spread) = (3.0 * f64::from(copies), (6.0 * f64::from(copies)).sqrt());
    assert!(
        sum > mean - 4.0 * spread && sum < mean / 0.95 + 4.0 * spread,
        "{sum} for {mean} +- {spread}"
    );
}

/// Points that scatter five times as much as their sigma says make the covariance 25 times as large.
#[test]
fn a_covariance_grows_with_the_residuals() {
    let of_scatter = |factor: f64| {
        let mut random = Random::seeded(45);
        let points = points(
            &wall(),
            400,
            &mut random,
            |_, random| factor * 0.05 * random.normal(),
            0.05,
        );
        fit_plane(&points, FRONT).unwrap().covariance[(2, 2)]
    };
    let growth = of_scatter(5.0) / of_scatter(1.0);
    assert!((20.0..30.0).contains(&growth), "{growth}");
}

#[test]
fn two_points_make_no_plane() {
    let mut points = points(&wall(), 2, &mut Random::seeded(46), |_, _| 0.0, 0.1);
    assert_eq!(
        fit_plane(&points, FRONT),
        Err(FitError::TooFewPoints { found: 2 })
    );
    points.clear();
    assert_eq!(
        fit_plane(&points, FRONT),
        Err(FitError::TooFewPoints { found: 0 })
    );
}

#[test]
fn points_in_one_line_leave_the_plane_free_to_turn() {
    let mut random = Random::seeded(47);
    for noise in [0.0, 1e-6, 0.1] {
        let along = Vector3::new(1.0, 0.4, 0.1).normalize();
        let points: Vec<_> = (0..30)
            .map(|k| WeightedPoint {
                point: Point::<World>::from_coords(
                    along * f64::from(5 * k) + random.vector(1.0) * noise,
                ),
                sigma: 0.1,
            })
            .collect();
        let error = fit_plane(&points, FRONT).unwrap_err();
        assert!(
            matches!(error, FitError::Collinear { .. }),
            "noise {noise}: {error}"
        );
        assert!(error.to_string().contains("straight line"), "{error}");
    }
}

#[test]
fn points_in_one_place_make_no_plane() {
    let same = WeightedPoint {
        point: Point::<World>::new(1.0, 2.0, 3.0),
        sigma: 0.1,
    };
    assert!(matches!(
        fit_plane(&[same; 12], FRONT),
        Err(FitError::Collinear { .. })
    ));
}

/// Points all over the place agree on no plane.
#[test]
fn points_without_a_plane_give_none() {
    let mut random = Random::seeded(48);
    let cloud: Vec<_> = (0..60)
        .map(|_| WeightedPoint {
            point: Point::<World>::from_coords(random.vector(100.0)),
            sigma: 0.1,
        })
        .collect();
    assert!(fit_plane(&cloud, FRONT).is_err());
}
