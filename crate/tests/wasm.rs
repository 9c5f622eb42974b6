//! The core as the page runs it: compiled to WebAssembly, without features, in a browser
//! (`cargo xtask test --only wasm`). That its files equal those of the companion program byte for
//! byte is for the end-to-end tests in `tests/` to say.
#![cfg(target_family = "wasm")]

use std::io::Cursor;

use nalgebra::Vector3;
use snellius::geometry::{Direction, Plane, Point, Ray};
use snellius::optics::{Interface, Stack, Surface};
use snellius::pipeline::{Settings, observe, reconstruct};
use snellius::scan::Archive;
use wasm_bindgen_test::{wasm_bindgen_test, wasm_bindgen_test_configure};

wasm_bindgen_test_configure!(run_in_browser);

const SAMPLE: &[u8] = include_bytes!("../../samples/tank-paper.zip");

/// A ray at 30 degrees through 2.1 mm of glass (1.5) into water (1.33). optiland 0.6.3, prysm
/// 0.21.1 and rayoptics 0.9.8 agree on both numbers.
#[wasm_bindgen_test]
fn light_through_the_wall_of_the_paper_bends_as_other_programs_say() {
    let towards_rig = Direction::new(Vector3::new(0.0, 0.0, -1.0)).unwrap();
    let outer = Surface::Plane(Plane::new(Point::origin(), towards_rig));
    let wall = Stack {
        outside: 1.0,
        interfaces: vec![
            Interface {
                surface: outer,
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
    let degrees = direction.x.atan2(direction.z).to_degrees();
    assert!((shift - 0.742_462_120_246).abs() < 1e-12, "{shift} mm");
    assert!((degrees - 22.082_413_194).abs() < 1e-9, "{degrees} degrees");
}

/// The rendered box stands in the tank: most views see it, and there the two light paths meet.
#[wasm_bindgen_test]
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
