//! The lens model against OpenCV, and its inverse against itself.
#![cfg(not(target_family = "wasm"))]
#![allow(
    clippy::disallowed_methods,
    reason = "expectations may come from the platform"
)]

mod common;

use common::lens;
use nalgebra::Vector2;
use snellius::camera::{Distortion, Intrinsics, Pixel, Slope};
use snellius::geometry::{Camera, Point};

const FOUR: &[f64] = &[-0.2834, 0.0739, 0.00019, 0.000018];
const FIVE: &[f64] = &[-0.112, 0.061, 0.0006, -0.0004, -0.03];
const EIGHT: &[f64] = &[0.35, -0.12, 0.0009, -0.0012, 0.02, 0.61, -0.05, 0.013];

const POINTS: [[f64; 3]; 4] = [
    [-120.0, -90.0, 350.0],
    [35.0, 60.0, 420.0],
    [101.0, -72.0, 300.0],
    [-8.5, 77.0, 260.0],
];
const PIXELS: [[f64; 2]; 6] = [
    [0.0, 0.0],
    [799.0, 0.0],
    [250.25, 431.75],
    [799.0, 599.0],
    [403.2, 296.4],
    [12.5, 590.1],
];

/// What OpenCV makes of [`POINTS`] (pixels) and [`PIXELS`] (slopes).
struct OpenCv {
    coefficients: &'static [f64],
    projected: [[f64; 2]; 4],
    undistorted: [[f64; 2]; 6],
}

/// Computed by opencv-python-headless 5.0.0 (the default of 5 iterations would leave 1e-4):
///
/// ```python
/// K = np.array([[1102.5, 0, 403.2], [0, 1101.8, 296.4], [0, 0, 1.0]])
/// tight = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 1000, 1e-16)
/// for d in (FOUR, FIVE, EIGHT):
///     print(cv2.projectPoints(POINTS, np.zeros(3), np.zeros(3), K, d)[0])
///     print(cv2.undistortPoints(PIXELS.reshape(-1, 1, 2), K, d, criteria=tight))
/// ```
const OPENCV: [OpenCv; 3] = [
    OpenCv {
        coefficients: FOUR,
        projected: [
            [43.978917153936, 27.190964081093],
            [494.373695547370, 452.603323224770],
            [757.168778322642, 44.264236226297],
            [368.040302188438, 614.737805948550],
        ],
        undistorted: [
            [-0.390112917498165, -0.287005860560305],
            [0.382290221062239, -0.286514364706227],
            [-0.140102576882695, 0.124052418758663],
            [0.382583615871122, 0.292637967166636],
            [0.0, 0.0],
            [-0.376686355301147, 0.283297395001284],
        ],
    },
    OpenCv {
        coefficients: FIVE,
        projected: [
            [32.200343768668, 18.509058615182],
            [494.795240760083, 453.359464935505],
            [767.592321980539, 36.859407659871],
            [367.445632022046, 619.791122572331],
        ],
        undistorted: [
            [-0.373707502008294, -0.275090851373501],
            [0.367078327040797, -0.275130640147629],
            [-0.139209290437376, 0.123260175456464],
            [0.366926638649599, 0.280506257498551],
            [0.0, 0.0],
            [-0.361526911771749, 0.271879989231609],
        ],
    },
    OpenCv {
        coefficients: EIGHT,
        projected: [
            [41.866215991166, 25.935994271474],
            [494.396656587580, 452.726983631063],
            [758.053741781795, 43.603960759399],
            [367.825432101510, 615.673250586293],
        ],
        undistorted: [
            [-0.386927426716340, -0.285054394223590],
            [0.380720567777060, -0.285288896192665],
            [-0.139864606264628, 0.123854703391737],
            [0.380582607789436, 0.290709045069686],
            [0.0, 0.0],
            [-0.373411727669207, 0.280882874556763],
        ],
    },
];

fn camera(coefficients: &[f64]) -> Intrinsics {
    Intrinsics {
        distortion: Distortion::from_opencv(coefficients).unwrap(),
        ..lens()
    }
}

#[test]
fn points_are_seen_where_opencv_sees_them() {
    for case in OPENCV {
        let camera = camera(case.coefficients);
        for (point, [u, v]) in POINTS.into_iter().zip(case.projected) {
            let seen = camera.project(Point::from(point)).unwrap();
            assert!(seen.distance(Pixel::new(u, v)) < 1e-9, "{seen:?} {u} {v}");
        }
    }
}

#[test]
fn lines_of_sight_are_those_of_opencv() {
    for case in OPENCV {
        let camera = camera(case.coefficients);
        for ([u, v], [x, y]) in PIXELS.into_iter().zip(case.undistorted) {
            let sight = camera.slope(Pixel::new(u, v)).unwrap();
            assert!(
                (sight.x - x).abs() < 1e-13 && (sight.y - y).abs() < 1e-13,
                "{sight:?} {x} {y}"
            );
        }
    }
}

#[test]
fn a_pixel_is_the_image_of_its_line_of_sight() {
    for coefficients in [&[][..], FOUR, FIVE, EIGHT] {
        let camera = camera(coefficients);
        for (u, v) in
            (0..=80).flat_map(|i| (0..=60).map(move |j| (f64::from(10 * i), f64::from(10 * j))))
        {
            let pixel = Pixel::new(u - 0.5, v - 0.5);
            let sight = camera.slope(pixel).unwrap();
            assert!(camera.pixel(sight).distance(pixel) < 1e-10, "{pixel:?}");
        }
    }
}

#[test]
fn a_line_of_sight_is_that_of_its_pixel() {
    for coefficients in [&[][..], FOUR, FIVE, EIGHT] {
        let camera = camera(coefficients);
        for (i, j) in (-10..=10).flat_map(|i| (-10..=10).map(move |j| (f64::from(i), f64::from(j))))
        {
            let sight = Slope {
                x: 0.036 * i,
                y: 0.027 * j,
            };
            let back = camera.slope(camera.pixel(sight)).unwrap();
            assert!((back.x - sight.x).abs() < 1e-13 && (back.y - sight.y).abs() < 1e-13);
        }
    }
}

/// With k1 = -0.3 alone the image radius r (1 - 0.3 r^2) grows up to r = 1/sqrt(0.9), where it is
/// 2/3 of that: 0.702728. No line of sight is seen farther out.
#[test]
fn beyond_the_radius_where_the_model_folds_back_there_is_no_line_of_sight() {
    let barrel = Distortion::from_opencv(&[-0.3, 0.0, 0.0, 0.0]).unwrap();
    let fold = 2.0 / 3.0 / 0.9_f64.sqrt();
    for turn in 0..12 {
        let around = f64::from(turn) * 0.5;
        let at = |radius: f64| barrel.remove(Vector2::new(around.cos(), around.sin()) * radius);
        for part in [0.3, 0.9, 0.99, 0.9999] {
            let ideal = at(part * fold).expect("within the fold");
            assert!(
                ideal.norm() < 1.0 / 0.9_f64.sqrt(),
                "on this side of the fold"
            );
            assert!((barrel.apply(ideal).norm() - part * fold).abs() < 1e-12);
        }
        for part in [1.0001, 1.01, 1.5, 4.0, 1e6] {
            assert_eq!(at(part * fold), None, "{part}");
        }
    }
    let camera = Intrinsics {
        distortion: barrel,
        ..lens()
    };
    let outside = camera.slope(Pixel::new(1500.0, 296.4)).unwrap_err();
    assert!(outside.to_string().contains("(1500.0, 296.4)"), "{outside}");
}

#[test]
fn what_is_not_before_the_camera_has_no_pixel() {
    for z in [0.0, -1.0, f64::NAN] {
        assert_eq!(lens().project(Point::<Camera>::new(1.0, 2.0, z)), None);
    }
}

#[test]
fn opencv_has_4_5_or_8_coefficients() {
    for count in 0..=14 {
        let known = matches!(count, 0 | 4 | 5 | 8);
        assert_eq!(
            Distortion::from_opencv(&vec![0.01; count]).is_some(),
            known,
            "{count}"
        );
    }
}
