//! Figures of results made up so that it is known where everything stands.

use serde_json::{Value, json};
use snellius::export::{IndexFigure, ReconstructionResult, ResultFigure};
use snellius::plot::{Axis, Drawing, Mark, PlotError};

/// A flat wall at z = 0, two scans one above the other: the object bends away behind it, and straight rays
/// see it nearer.
fn result() -> ReconstructionResult {
    let view = |number: u32| {
        let (sweep, step) = (number / 5, number % 5);
        let (x, y) = (f64::from(step) * 10.0, f64::from(sweep) * 50.0);
        let z = 80.0 + f64::from(step);
        let bulge = if number == 7 { -0.2 } else { 0.0 };
        json!({ "id": format!("{number:04}"), "sweep": sweep, "status": "ok", "vessel": [x, y, bulge],
                "object": [x, y, z], "object_unrefracted": [x, y, 0.75 * z],
                "object_sigma": [0.1, 0.1, 0.3], "object_sigma_calibration": [0.1, 0.1, 0.3],
                "ray_distance": 0.01 * f64::from(number), "spots": [] })
    };
    let views: Vec<Value> = (0..10).map(view).collect();
    let json = json!({
        "format": "refractive-reconstruction", "version": 1, "scan": "made up", "length_unit": "mm",
        "media": { "outside": 1.0, "wall": 1.5,
                   "inside": { "value": 1.333, "sigma": null, "method": "given", "verdict": "given" } },
        "vessel": { "shape": "plane", "point": [0, 0, 0], "normal": [0, 0, -1],
                    "wall_thickness": 2.0, "rms": 0.05, "points": 10 },
        "views": views, "warnings": [],
    });
    ReconstructionResult::from_json(json.to_string().as_bytes()).unwrap()
}

const SIZE: [u32; 2] = [480, 360];

fn drawn(figure: ResultFigure) -> Drawing {
    result().figure(figure).unwrap().draw(SIZE).unwrap()
}

/// The mark of a view's object point.
fn object(drawing: &Drawing, view: usize) -> &Mark {
    let marks = drawing.marks.iter();
    let mut of_view = marks.filter(|mark| mark.view == Some(view) && mark.words.contains("object"));
    of_view.next().expect("the view has a point")
}

#[test]
fn every_value_stands_within_its_figure() {
    for figure in [
        ResultFigure::TopView,
        ResultFigure::TopViewStraight,
        ResultFigure::BirdsEye,
        ResultFigure::RayDistances,
        ResultFigure::RayDistanceHistogram,
        ResultFigure::WallResiduals,
    ] {
        let drawing = drawn(figure);
        assert!(!drawing.marks.is_empty(), "{figure:?}");
        for mark in &drawing.marks {
            let [x, y] = mark.at;
            let inside = (0.0..=480.0).contains(&x) && (0.0..=360.0).contains(&y);
            assert!(inside, "{figure:?}: {mark:?}");
        }
        assert!(drawing.svg.starts_with("<svg xmlns=") && drawing.svg.ends_with("</svg>\n"));
    }
}

#[test]
fn the_two_top_views_have_one_scale_the_same_across_and_behind() {
    let (bent, straight) = (
        drawn(ResultFigure::TopView),
        drawn(ResultFigure::TopViewStraight),
    );
    let [first, last] = [0, 4].map(|view| object(&bent, view).at);
    let across = f64::from(last[0] - first[0]) / 40.0;
    let behind = f64::from(first[1] - last[1]) / 4.0;
    assert!(
        (across.abs() - behind).abs() < 0.05 * behind,
        "{across} {behind}"
    );
    // Straight rays put the first point 20 mm nearer, and none aside.
    let [seen, wrong] = [&bent, &straight].map(|drawing| object(drawing, 0).at);
    assert_eq!(seen[0], wrong[0]);
    let nearer = f64::from(wrong[1] - seen[1]) / 20.0;
    assert!((nearer - behind).abs() < 0.05 * behind, "{nearer} {behind}");
}

#[test]
fn a_histogram_counts_every_point_once() {
    let plot = result().figure(ResultFigure::RayDistanceHistogram).unwrap();
    let csv = plot.csv();
    let mut lines = csv.lines();
    assert_eq!(
        lines.next(),
        Some("from Ray distance (mm),to Ray distance (mm),Points")
    );
    let counts = lines.map(|line| line.rsplit(',').next().unwrap().parse::<f64>().unwrap());
    assert_eq!(counts.sum::<f64>(), 10.0);
}

#[test]
fn residuals_say_which_way_the_wall_bulges() {
    let plot = result().figure(ResultFigure::WallResiduals).unwrap();
    let told = plot.csv();
    let bulge = told.lines().find(|line| line.contains("0007")).unwrap();
    let residual: f64 = bulge.rsplit(',').next().unwrap().parse().unwrap();
    // The rig stands at negative z.
    assert!((residual - 0.2).abs() < 1e-9, "{bulge}");
}

#[test]
fn the_rays_of_a_line_laser_leave_nothing_to_plot() {
    let mut line = result();
    for view in &mut line.views {
        view.ray_distance = snellius::export::OneOrMany::Many(vec![0.0; 3]);
    }
    for figure in [
        ResultFigure::RayDistances,
        ResultFigure::RayDistanceHistogram,
    ] {
        assert_eq!(line.figure(figure).map(drop), Err(PlotError::Nothing));
    }
}

#[test]
fn a_curve_stands_over_its_interval_and_tells_its_values() {
    let figure = IndexFigure {
        title: "Angle".to_owned(),
        quantity: Axis::new("Angle", "\u{b0}", 1),
        points: (0..=10)
            .map(|k| [1.0 + 0.08 * f64::from(k), 100.0 - 2.5 * f64::from(k)])
            .collect(),
        known: Some(90.0),
        interval: Some([1.3, 1.36]),
        minimum: None,
    };
    let drawing = figure.figure().draw(SIZE).unwrap();
    assert_eq!(drawing.marks.len(), 11);
    assert!(drawing.marks[4].words.contains("1.320, Angle 90.0\u{b0}"));
    for class in ["line-curve", "line-known", "fill-band"] {
        assert!(drawing.svg.contains(class), "{class} is missing");
    }
    assert!(figure.figure().csv().contains("known,,,90"));
}
