//! What each stage found, in a few numbers.

use leptos::prelude::*;
use snellius::pipeline::Stage;
use snellius::scan::VesselShape;

use crate::number::fixed;
use crate::run::{Face, Facts, Index, Outcome, Place, Wall};
use crate::state::{StageState, Workbench};

/// A number with its name and what it means.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Number {
    pub(super) name: &'static str,
    pub(super) value: String,
    pub(super) meaning: &'static str,
}

fn number(name: &'static str, value: impl Into<String>, meaning: &'static str) -> Number {
    Number {
        name,
        value: value.into(),
        meaning,
    }
}

/// A stage's numbers; none before it is done.
pub(super) fn numbers(workbench: Workbench, stage: Stage) -> Vec<Number> {
    let (facts, outcome) = (workbench.facts.get(), workbench.outcome.get());
    match (stage, facts, outcome) {
        (Stage::Scan, Some(facts), _) => of_scan(&facts),
        (Stage::Spots, _, Some(outcome)) => of_spots(&outcome),
        (Stage::Vessel, _, Some(outcome)) => of_vessel(&outcome),
        (Stage::Object, _, Some(outcome)) => of_object(&outcome),
        _ => Vec::new(),
    }
}

/// A stage in a few words, for its heading.
pub(super) fn brief(workbench: Workbench, stage: Stage) -> String {
    if let Some(rerun) = workbench.rerun.get().filter(|rerun| rerun.stage == stage) {
        let progress = rerun.progress;
        return if stage == Stage::Spots && progress.views > 0 {
            format!("{} of {} views", progress.done, progress.views)
        } else {
            "measuring".to_owned()
        };
    }
    if workbench.stage_state(stage) == StageState::Failed {
        return "failed".to_owned();
    }
    let facts = workbench.facts.get();
    let Some(outcome) = workbench.outcome.get() else {
        return match (stage, facts) {
            (Stage::Scan, Some(facts)) => views(&facts),
            _ => String::new(),
        };
    };
    match stage {
        Stage::Scan => facts.map(|facts| views(&facts)).unwrap_or_default(),
        Stage::Spots => format!("{} found", spot_count(&outcome)),
        Stage::Vessel => {
            let Wall { face, rms, .. } = &outcome.wall;
            format!("{}, \u{b1}{} mm", shape_name(face.shape()), fixed(*rms, 3))
        }
        Stage::Object => format!("{} points", outcome.object.len()),
        Stage::Index => index_text(outcome.index),
    }
}

/// An index with its standard deviation, or that it is somebody's word.
pub(super) fn index_text(index: Index) -> String {
    match index.sigma {
        _ if index.value.is_nan() => "not determined".to_owned(),
        Some(sigma) => with_sigma(index.value, sigma),
        None => format!("{}, given", fixed(index.value, 3)),
    }
}

/// A value with its standard deviation.
pub(super) fn with_sigma(value: f64, sigma: f64) -> String {
    format!("{} \u{b1} {}", fixed(value, 4), fixed(sigma, 4))
}

fn views(facts: &Facts) -> String {
    format!("{} views", facts.stations.len())
}

fn spot_count(outcome: &Outcome) -> usize {
    outcome.views.iter().map(|view| view.spots.len()).sum()
}

fn millimetres(value: f64) -> String {
    format!("{} mm", fixed(value, 3))
}

fn of_scan(facts: &Facts) -> Vec<Number> {
    let [width, height] = facts.picture;
    vec![
        number(
            "Views",
            facts.stations.len().to_string(),
            "Stations of the rig",
        ),
        number("Scans", facts.sweeps.to_string(), "Rows of stations"),
        number(
            "Pictures",
            format!("{width} \u{d7} {height} px"),
            "Width and height",
        ),
        number(
            "Vessel, as the scan says",
            shape_name(facts.declared_shape),
            "The shape that scan.json gives",
        ),
    ]
}

fn of_spots(outcome: &Outcome) -> Vec<Number> {
    let empty = outcome.views.iter().filter(|view| view.spots.is_empty());
    vec![
        number(
            "Spots",
            spot_count(outcome).to_string(),
            "Bright regions of all difference pictures",
        ),
        number(
            "Views without any",
            empty.count().to_string(),
            "Views in whose pictures the laser is not seen",
        ),
    ]
}

fn of_vessel(outcome: &Outcome) -> Vec<Number> {
    let Outcome { wall, summary, .. } = outcome;
    let mut numbers = vec![number(
        "Shape",
        shape_name(wall.face.shape()),
        "The surface that is laid through the vessel points",
    )];
    if let Some(choice) = &wall.choice {
        numbers.push(number(
            "Next best",
            format!(
                "{}, behind by {}",
                shape_name(choice.runner_up),
                fixed(choice.margin, 1)
            ),
            "By how much the shape's information criterion is lower than the next one's; above 10 the \
             matter is settled",
        ));
    }
    if wall.known {
        numbers.push(number(
            "Place",
            "as the scan says",
            "The wall was known beforehand and is only held against the points",
        ));
    }
    numbers.extend([
        number(
            "Fit, RMS",
            millimetres(wall.rms),
            "Root mean square distance of the vessel points from the wall",
        ),
        number(
            "Wall points",
            wall.points.to_string(),
            "Vessel points that carry the wall",
        ),
    ]);
    numbers.extend(of_face(&wall.face));
    let glows = wall.thickness_of_glows;
    numbers.push(number(
        "Thickness, given",
        format!("{} mm", fixed(wall.thickness, 2)),
        "As the scan gives it; it is what is used",
    ));
    numbers.push(number(
        "Thickness, by the glows",
        glows.map_or("not told".to_owned(), |glows| {
            format!("about {} mm", fixed(glows, 1))
        }),
        "What the glows of the wall's two faces suggest by themselves: a check of the given one",
    ));
    if let Some(off_line) = summary.median_off_line {
        numbers.push(number(
            "Off the epipolar line",
            format!("{} px", fixed(off_line, 2)),
            "Median distance of the wall's spots from the epipolar line: near 0 if the calibration is right",
        ));
    }
    numbers
}

fn of_face(face: &Face) -> Vec<Number> {
    let vector = |vector: Place| vector.map(|part| fixed(part, 3)).join(" ");
    let round = |radius: f64| {
        number(
            "Outer radius",
            format!("{} mm", fixed(radius, 2)),
            "Of the wall's outer face",
        )
    };
    match face {
        Face::Freeform(_) => Vec::new(),
        Face::Plane { normal, .. } => vec![number(
            "Normal",
            vector(*normal),
            "x y z of the unit vector across the wall, towards the rig",
        )],
        Face::Cylinder { axis, radius, .. } => vec![
            round(*radius),
            number(
                "Axis",
                vector(*axis),
                "x y z of the unit vector along the axis",
            ),
        ],
        Face::Sphere { radius, .. } => vec![round(*radius)],
    }
}

fn of_object(outcome: &Outcome) -> Vec<Number> {
    let summary = &outcome.summary;
    vec![
        number(
            "Views used",
            format!("{} of {}", summary.used, outcome.views.len()),
            "Views that gave a point of the object",
        ),
        number(
            "Mean ray distance",
            summary
                .mean_ray_distance
                .map_or("none".to_owned(), millimetres),
            "How far beam and line of sight pass each other at the object, on the average: small if \
             calibration and index are right",
        ),
    ]
}

/// A shape's name.
pub(crate) const fn shape_name(shape: VesselShape) -> &'static str {
    match shape {
        VesselShape::Auto => "whichever fits",
        VesselShape::Plane => "plane",
        VesselShape::Cylinder => "cylinder",
        VesselShape::Sphere => "sphere",
        VesselShape::Freeform => "free form",
    }
}
