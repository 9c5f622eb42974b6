//! What the page says in words.

use serde_json::{Value, json};
use snellius::export::{ReconstructionResult, Status, ViewResult};
use snellius::share::Document;

pub(super) fn facts(
    document: &Document,
    shown: &ReconstructionResult,
    fixed: Option<&str>,
) -> Value {
    let measured = &document.result;
    let inside = &measured.media.inside;
    let used = shown.views.iter().filter(|v| v.status == Status::Ok);
    let distances = shown.views.iter().flat_map(|v| v.ray_distance.iter());
    let count = distances.clone().count();
    // A sheet of light meets every line of sight.
    let is_line = measured.views.iter().any(|view| view.line.is_some());
    let mean = (count > 0 && !is_line).then(|| distances.sum::<f64>() / count as f64);
    json!({
        "program": snellius::VERSION,
        "title": document.title,
        "notes": document.notes,
        "scan": measured.scan,
        "warnings": measured.warnings,
        "measuredIndex": inside.value,
        "sigma": inside.sigma,
        "method": inside.method,
        "verdict": inside.verdict,
        "outside": measured.media.outside,
        "wall": measured.media.wall,
        "shape": serde_json::to_value(&measured.vessel.wall).map(|wall| wall["shape"].clone()).ok(),
        "wallThickness": measured.vessel.wall_thickness,
        "wallRms": measured.vessel.rms,
        "views": shown.views.len(),
        "used": used.count(),
        "meanRayDistance": mean,
        "isLine": is_line,
        "fixed": fixed,
    })
}

/// What became of a view, in a few words.
pub(super) fn remark(view: &ViewResult) -> String {
    match (&view.reason, view.status) {
        (Some(reason), _) => reason.clone(),
        (None, Status::Ok) => String::new(),
        (None, Status::NoVesselSpot) => "no spot on the wall".to_owned(),
        (None, Status::NoObjectSpot) => "no spot but the wall's".to_owned(),
        (None, Status::Rejected) => "every spot was refused".to_owned(),
    }
}
