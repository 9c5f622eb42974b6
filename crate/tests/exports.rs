//! What leaves the program, from results made up so that the answer is known. That other programs read the
//! files is tested by `tests/exports/read_back.py`.

use serde_json::{Value, json};
use snellius::export::{ExportError, Format, ReconstructionResult, object_mesh};

/// A result with a flat wall at z = 0, the rig before it, and these views.
fn result(views: Vec<Value>) -> ReconstructionResult {
    let json = json!({
        "format": "refractive-reconstruction", "version": 1, "scan": "made up", "length_unit": "mm",
        "media": { "outside": 1.0, "wall": 1.5,
                   "inside": { "value": 1.333, "sigma": null, "method": "given", "verdict": "given" } },
        "vessel": { "shape": "plane", "point": [0, 0, 0], "normal": [0, 0, -1],
                    "wall_thickness": 2.0, "rms": 0.05, "points": views.len() },
        "views": views, "warnings": [],
    });
    ReconstructionResult::from_json(json.to_string().as_bytes()).unwrap()
}

fn spot(sweep: u32, x: f64, y: f64, z: f64) -> Value {
    json!({ "id": format!("{sweep}/{x}"), "sweep": sweep, "status": "ok", "vessel": [x, y, 0.0],
            "object": [x, y, z], "object_sigma": [0.1, 0.1, 0.3],
            "object_sigma_calibration": [0.1, 0.1, 0.3], "ray_distance": 0.02, "spots": [] })
}

/// A profile of a line laser: points at these places.
fn profile(points: &[[f64; 3]]) -> Value {
    let each = |value: Value| vec![value; points.len()];
    json!({ "id": "profile", "sweep": 0, "status": "ok", "vessel": [], "object": points,
            "object_sigma": each(json!([0.1, 0.1, 0.3])),
            "object_sigma_calibration": each(json!([0.1, 0.1, 0.3])),
            "ray_distance": each(json!(0.02)), "spots": [] })
}

/// Twice the signed area as the rig sees it; positive: counter-clockwise.
fn area_seen_from_the_rig(corners: [[f64; 3]; 3]) -> f64 {
    let [a, b, c] = corners;
    // The rig looks along +z with y down.
    -((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]))
}

fn triangles(result: &ReconstructionResult) -> Vec<[[f64; 3]; 3]> {
    let mesh = object_mesh(result).expect("a surface");
    let corner = |v: u32| mesh.vertices[v as usize];
    mesh.triangles.iter().map(|t| t.map(corner)).collect()
}

fn total_area(triangles: &[[[f64; 3]; 3]]) -> f64 {
    triangles
        .iter()
        .map(|t| 0.5 * area_seen_from_the_rig(*t))
        .sum()
}

/// Three rows of five points make a sheet of 2 x 4 cells, whichever way each row was swept.
#[test]
fn rows_swept_there_and_back_make_one_sheet() {
    let mut views = Vec::new();
    for row in 0..3 {
        let mut xs: Vec<f64> = (0..5).map(|k| f64::from(k) * 10.0).collect();
        if row == 1 {
            xs.reverse();
        }
        views.extend(
            xs.iter()
                .map(|x| spot(row, *x, f64::from(row) * 20.0, 50.0)),
        );
    }
    let triangles = triangles(&result(views));
    assert_eq!(triangles.len(), 2 * 2 * 4);
    assert!(triangles.iter().all(|t| area_seen_from_the_rig(*t) > 0.0));
    assert!((total_area(&triangles) - 40.0 * 40.0).abs() < 1e-9);
}

/// A step of 200 mm in depth between two halves is a gap, not a face.
#[test]
fn what_lies_far_behind_is_not_joined_to_what_is_before_it() {
    let depth = |x: f64| if x < 45.0 { 50.0 } else { 250.0 };
    let row = |row: u32| {
        (0..10).map(move |k| {
            let x = f64::from(k) * 10.0;
            spot(row, x, f64::from(row) * 10.0, depth(x))
        })
    };
    let triangles = triangles(&result(row(0).chain(row(1)).collect()));
    assert_eq!(triangles.len(), 2 * 2 * 4, "two strips of four cells");
    for t in &triangles {
        assert!(t.iter().all(|corner| corner[2] == t[0][2]), "{t:?}");
    }
}

/// A line laser's points lie 20 times denser along the line than from view to view.
#[test]
fn profiles_of_a_line_laser_make_a_surface() {
    let view = |x: f64| {
        let points: Vec<[f64; 3]> = (0..60)
            .map(|k| [x, f64::from(k) * 0.5, 60.0 + 0.1 * x])
            .collect();
        profile(&points)
    };
    let triangles = triangles(&result((0..4).map(|k| view(f64::from(k) * 10.0)).collect()));
    assert_eq!(triangles.len(), 3 * 2 * 59);
    assert!((total_area(&triangles) - 30.0 * 29.5).abs() < 1e-9);
}

/// Twelve profiles around a cylinder: the last is as near to the first as any to the next.
#[test]
#[allow(
    clippy::disallowed_methods,
    reason = "expectations may come from the platform"
)]
fn a_full_turn_is_closed() {
    let view = |k: u32| {
        let (sine, cosine) = (f64::from(k) * std::f64::consts::TAU / 12.0).sin_cos();
        let points: Vec<[f64; 3]> = (0..8)
            .map(|j| [20.0 * cosine, f64::from(j) * 5.0, 100.0 + 20.0 * sine])
            .collect();
        profile(&points)
    };
    let turn = triangles(&result((0..12).map(view).collect()));
    assert_eq!(turn.len(), 12 * 2 * 7);
    let half = triangles(&result((0..7).map(view).collect()));
    assert_eq!(half.len(), 6 * 2 * 7, "half a turn stays open");
}

#[test]
fn points_that_allow_no_surface_are_an_error_for_meshes_alone() {
    let one_row = result((0..5).map(|k| spot(0, f64::from(k), 0.0, 50.0)).collect());
    let empty = result(Vec::new());
    for result in [one_row, empty] {
        for format in Format::ALL {
            let written = result.write(*format);
            match format {
                Format::Stl | Format::Obj => {
                    assert!(matches!(written, Err(ExportError::NoSurface)), "{format:?}");
                }
                _ => assert!(!written.unwrap().is_empty(), "{format:?}"),
            }
        }
    }
}

/// A wall that a file from elsewhere may describe: no normal, no radius, a grid of the wrong size.
#[test]
fn an_impossible_wall_is_left_out_and_harms_nothing() {
    let walls = [
        json!({ "shape": "plane", "point": [0, 0, 0], "normal": [0, 0, 0] }),
        json!({ "shape": "cylinder", "axis_point": [0, 0, 0], "axis": [0, 1, 0], "radius": 0 }),
        json!({ "shape": "sphere", "center": [0, 0, 0], "radius": -1 }),
        json!({ "shape": "freeform", "base": "plane", "origin": [0, 0, 0], "normal": [0, 0, -1],
                "tangents": [[1, 0, 0], [0, 1, 0]], "start": [0, 0], "step": [1, 1],
                "columns": 4, "rows": 5, "heights": [0.0], "patch": [] }),
    ];
    for wall in walls {
        let views =
            (0..2).flat_map(|y| (0..3).map(move |x| spot(y, f64::from(x), f64::from(y), 9.0)));
        let mut json = serde_json::to_value(result(views.collect())).unwrap();
        let mut vessel = wall.clone();
        for (key, value) in [("wall_thickness", 1.0), ("rms", 0.1)] {
            vessel[key] = json!(value);
        }
        vessel["points"] = json!(6);
        json["vessel"] = vessel;
        let result = ReconstructionResult::from_json(json.to_string().as_bytes()).unwrap();
        assert!(result.vessel.surface().is_none(), "{wall}");
        for format in Format::ALL {
            result.write(*format).unwrap();
        }
    }
}

#[test]
fn a_result_of_another_version_or_with_more_behind_it_is_refused() {
    let good = result(Vec::new()).to_json();
    let refuse = |text: &str| match ReconstructionResult::from_json(text.as_bytes()) {
        Ok(_) => panic!("read: {text}"),
        Err(error) => error.to_string(),
    };
    assert!(refuse(&good.replace("\"version\": 1", "\"version\": 2")).contains("version: 2"));
    assert!(refuse(&format!("{good}{{}}")).contains("after the result"));
    assert!(refuse(&good.replace("1.333", "\"water\"")).contains("media.inside.value"));
    for nested in [
        format!("{{\"x\":{}", "[".repeat(100_000)),
        "[".repeat(100_000),
    ] {
        assert!(!refuse(&nested).is_empty());
    }
}
