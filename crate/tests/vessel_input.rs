//! Vessels that cannot be measured, or not as the manifest says: a clear message each.

mod common;

use std::sync::LazyLock;

use common::archives::{Entries, measure, refusal, repository, scene, simulate};
use serde_json::{Value, json};
use snellius::export::Status;

/// A tank seen from four rows of five stations.
static TANK: LazyLock<Vec<u8>> = LazyLock::new(|| simulate(scene()).archive);

fn changed(change: impl FnOnce(&mut Value)) -> Vec<u8> {
    Entries::of(&TANK).with_manifest(change).zipped()
}

/// The tank's archive with these views alone.
fn with_views(shape: &str, views: &[usize]) -> Vec<u8> {
    changed(|scan| {
        let all = scan["views"].as_array().unwrap();
        scan["views"] = views.iter().map(|view| all[*view].clone()).collect();
        scan["vessel"]["shape"] = json!(shape);
    })
}

#[track_caller]
fn assert_says(message: &str, parts: &[&str]) {
    for part in parts {
        assert!(
            message.contains(part),
            "\"{part}\" is missing from: {message}"
        );
    }
}

#[test]
fn a_wall_thicker_than_the_vessels_radius_is_refused() {
    for shape in [
        json!({ "shape": "cylinder", "wall_thickness": 901.0, "axis_point": [0, 0, 900], "axis": [0.026, 1, -0.03], "radius": 900 }),
        json!({ "shape": "sphere", "wall_thickness": 901.0, "center": [31, 23, 899], "radius": 900 }),
    ] {
        let message = refusal(&changed(|scan| scan["vessel"] = shape.clone()));
        assert_says(&message, &["vessel.wall_thickness", "901", "radius", "900"]);
    }
}

#[test]
fn a_wall_thicker_than_the_radius_that_was_measured_is_refused() {
    let jar = std::fs::read(repository("samples/jar.zip")).unwrap();
    for shape in ["cylinder", "auto"] {
        let archive = Entries::of(&jar).with_manifest(|scan| {
            scan["vessel"] = json!({ "shape": shape, "wall_thickness": 80.0 });
        });
        let message = refusal(&archive.zipped());
        assert_says(
            &message,
            &["vessel.wall_thickness", "80", "measured", "smaller radius"],
        );
    }
}

#[test]
fn a_known_wall_that_misses_the_points_is_refused_with_how_far() {
    let behind = changed(|scan| {
        scan["vessel"]["point"] = json!([0, 0, 40]);
        scan["vessel"]["normal"] = json!([-0.035, -0.026, -1]);
    });
    let message = refusal(&behind);
    assert_says(
        &message,
        &[
            "vessel: the wall given in scan.json misses",
            "mm in front of it",
            "frame",
        ],
    );
    let millimetres = message
        .split_once("lie ")
        .unwrap()
        .1
        .split_once(' ')
        .unwrap()
        .0;
    let off: f64 = millimetres.parse().unwrap();
    assert!((off - 40.0).abs() < 1.0, "{message}");
}

#[test]
fn too_few_vessel_points_are_counted() {
    assert_says(
        &refusal(&with_views("plane", &[0, 7])),
        &["a plane needs at least 3", "there are 2"],
    );
    assert_says(
        &refusal(&with_views("cylinder", &[0, 2, 6, 12])),
        &["a cylinder needs at least 5", "there are 4"],
    );
    assert_says(
        &refusal(&with_views("sphere", &[0, 6, 12])),
        &["a sphere needs at least 4", "there are 3"],
    );
    let few = [0, 1, 2, 5, 6, 7, 10, 11];
    assert_says(
        &refusal(&with_views("freeform", &few)),
        &["free-form wall needs at least 12", "there are 8"],
    );
}

/// One row of stations leaves the wall free to turn about it.
#[test]
fn vessel_points_on_a_line_are_refused() {
    let mut row = scene();
    row.sweeps.truncate(1);
    row.sweeps[0].views = 12;
    let row = Entries::of(&simulate(row).archive);
    for shape in ["plane", "cylinder", "sphere", "freeform", "auto"] {
        let archive = row
            .clone()
            .with_manifest(|scan| scan["vessel"]["shape"] = json!(shape));
        let message = refusal(&archive.zipped());
        assert_says(
            &message,
            &["on a straight line", "measure at another height"],
        );
    }
}

/// A tank of air in a dense liquid, looked at so askew that no light gets in.
#[test]
fn total_internal_reflection_everywhere_is_said_once_and_of_every_view() {
    let mut scene = scene();
    scene.vessel.rotation = [-1.5, -32.0, 0.0];
    let archive = Entries::of(&simulate(scene).archive).with_manifest(|scan| {
        scan["media"] = json!({ "outside": 1.5, "wall": 1.5, "inside": 1.0 });
    });
    let result = measure(&archive.zipped()).unwrap();
    let mut thrown_back = 0;
    for view in &result.views {
        assert_ne!(view.status, Status::Ok, "{}", view.id);
        if view.status == Status::Rejected {
            thrown_back += 1;
            assert_says(
                view.reason.as_deref().unwrap(),
                &["total internal reflection", "critical angle"],
            );
        }
    }
    assert!(thrown_back >= 10, "{thrown_back}");
    let said = result
        .warnings
        .iter()
        .filter(|w| w.contains("total internal reflection"));
    let said: Vec<_> = said.collect();
    assert_eq!(said.len(), 1, "{:?}", result.warnings);
    assert_says(said[0], &["media.outside", "critical angle"]);
}
