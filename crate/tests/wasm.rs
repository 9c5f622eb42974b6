//! The core as the page runs it, compiled to WebAssembly without features, in a browser
//! (`cargo xtask test --only wasm`), and the same tests natively: what they hold is held equal to the last
//! bit on both sides.

use std::io::Cursor;

use nalgebra::{UnitQuaternion, Vector3};
use snellius::geometry::{Direction, Plane, Point, Ray};
use snellius::optics::{Interface, Stack, Surface, aim_through};
use snellius::pipeline::{Settings, observe, reconstruct};
use snellius::scan::{Archive, Picture};

#[cfg(target_family = "wasm")]
use wasm_bindgen_test::wasm_bindgen_test as test;

#[cfg(target_family = "wasm")]
wasm_bindgen_test::wasm_bindgen_test_configure!(run_in_browser);

const SAMPLE: &[u8] = include_bytes!("../../samples/tank-paper.zip");
const LINE_SAMPLE: &[u8] = include_bytes!("../../samples/line.zip");

/// A ray at 30 degrees through 2.1 mm of glass (1.5) into water (1.33). optiland 0.6.3, prysm
/// 0.21.1 and rayoptics 0.9.8 agree on both numbers.
#[test]
fn light_through_the_wall_of_the_paper_bends_as_other_programs_say() {
    let towards_rig = Direction::new(Vector3::new(0.0, 0.0, -1.0)).unwrap();
    let outer = Surface::Plane(Plane::new(Point::origin(), towards_rig));
    let wall = Stack {
        outside: 1.0,
        interfaces: vec![
            Interface {
                surface: outer.clone(),
                index_behind: 1.5,
            },
            Interface {
                surface: outer.behind(2.1).unwrap(),
                index_behind: 1.33,
            },
        ],
    };
    let (sine, cosine) = (0.5, 0.75_f64.sqrt());
    let in_air = Direction::new(Vector3::new(sine, 0.0, cosine)).unwrap();
    let start = Point::new(-100.0 * sine, 0.0, -100.0 * cosine);

    let in_water = wall.trace(&Ray::new(start, in_air)).unwrap();

    let shift = in_water.origin.coords.x;
    let direction = in_water.direction.vector();
    let degrees = libm::atan2(direction.x, direction.z).to_degrees();
    assert!((shift - 0.742_462_120_246).abs() < 1e-12, "{shift} mm");
    assert!((degrees - 22.082_413_194).abs() < 1e-9, "{degrees} degrees");
}

/// The rendered box stands in the tank: most views see it, and there the two light paths meet.
#[test]
fn the_sample_is_read_and_measured() {
    let settings = Settings::default();
    let mut archive = Archive::open(Cursor::new(SAMPLE)).unwrap();
    let views = archive.scan().stations.len();
    let spots: Vec<_> = (0..views)
        .map(|view| observe(&mut archive, view, &settings).unwrap())
        .collect();

    let reconstruction = reconstruct(archive.scan(), &spots, &settings).unwrap();

    let summary = reconstruction.summary();
    let distance = summary.mean_ray_distance.unwrap();
    assert!(
        2 * summary.used > views,
        "{} of {views} views",
        summary.used
    );
    assert!(
        distance < 0.5,
        "the light paths miss each other by {distance} mm"
    );
}

/// The bytes of the sample's result.json, as FNV-1a makes one number of them.
const RESULT: u64 = 0x6d58_1d71_cd24_dcf7;

/// The same of the line laser's sample.
const LINE_RESULT: u64 = 0xf79d_21c7_4db7_ce37;

/// Changes of the core that change its results change these numbers: put the new ones here, from either side.
/// That they are the same for both is what counts.
#[test]
fn the_samples_results_have_the_same_bytes_everywhere() {
    let result = |sample: &'static [u8]| {
        let settings = Settings::default();
        let mut archive = Archive::open(Cursor::new(sample)).unwrap();
        let views = archive.scan().stations.len();
        let spots: Vec<_> = (0..views)
            .map(|view| observe(&mut archive, view, &settings).unwrap())
            .collect();
        let reconstruction = reconstruct(archive.scan(), &spots, &settings).unwrap();
        fnv(reconstruction.result().to_json().bytes())
    };
    let (found, line) = (result(SAMPLE), result(LINE_SAMPLE));
    assert_eq!(found, RESULT, "result.json is now {found:#018x}");
    assert_eq!(line, LINE_RESULT, "the line's is now {line:#018x}");
}

/// Decoders have fast paths of their own on each machine; lossy pictures must not show it.
#[test]
fn lossy_pictures_decode_to_the_same_grey_values_everywhere() {
    let grey = |file: &[u8]| {
        let picture = Picture::decode(file, 120, 90).unwrap();
        fnv(picture.grey.iter().flat_map(|g| g.to_le_bytes()))
    };
    let (jpeg, webp) = (
        grey(include_bytes!("data/spot.jpg")),
        grey(include_bytes!("data/spot.webp")),
    );
    assert_eq!(jpeg, 0x01d1_79e9_b842_ff1c, "the JPEG is now {jpeg:#018x}");
    assert_eq!(webp, 0xc407_5411_d1b8_be8c, "the WebP is now {webp:#018x}");
}

/// Sines and roots, nalgebra's rotations and a search that stops where rounding says, to the last bit.
#[test]
fn mathematics_has_the_same_bits_everywhere() {
    let towards_rig = Direction::new(Vector3::new(0.1, -0.2, -1.0)).unwrap();
    let outer = Surface::Plane(Plane::new(Point::origin(), towards_rig));
    let stack = Stack {
        outside: 1.0,
        interfaces: vec![Interface {
            surface: outer.clone(),
            index_behind: 1.333,
        }],
    };
    let mut bits = Vec::new();
    for k in 0..200 {
        let x = f64::from(k) * 0.37 - 20.0;
        let turn = UnitQuaternion::from_euler_angles(x, 0.3 * x, 1.0 / (x + 30.0));
        let aim = aim_through(&stack, Point::new(x, 5.0, -300.0), Point::new(-x, x, 80.0)).unwrap();
        let turned = turn * aim.vector();
        bits.extend([
            libm::sin(x),
            libm::exp(x),
            libm::acos(x / 60.0),
            turn.angle(),
        ]);
        bits.extend([turned.x, turned.y, turned.z, turned.norm()]);
    }
    let found = fnv(bits.into_iter().flat_map(f64::to_le_bytes));
    assert_eq!(
        found, 0x810a_6322_f86b_c6bd,
        "the bits are now {found:#018x}"
    );
}

/// FNV-1a, 64 bits (Fowler, Noll, Vo).
fn fnv(bytes: impl IntoIterator<Item = u8>) -> u64 {
    let step = |hash: u64, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
    bytes.into_iter().fold(0xcbf2_9ce4_8422_2325, step)
}
