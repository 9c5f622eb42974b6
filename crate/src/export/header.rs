use serde::Serialize;

use super::{InsideResult, ReconstructionResult};
use crate::VERSION;

/// What every file says of itself, a line each: program, scan, unit and frame, index. No control characters,
/// so that each line stays one whatever the scan is called.
pub(super) fn header(result: &ReconstructionResult) -> [String; 4] {
    [
        format!("Snellius {VERSION}"),
        format!("scan: {}", in_one_line(&result.scan)),
        "unit mm, world frame of the scan (right-handed)".to_owned(),
        format!("refractive index inside: {}", index(&result.media.inside)),
    ]
}

/// The liquid's index with what it is worth: `1.3327 +- 0.0012 (joint, determined)`.
pub(super) fn index(inside: &InsideResult) -> String {
    let value = inside.value.map_or("unknown".to_owned(), |n| n.to_string());
    let sigma = inside
        .sigma
        .map_or(String::new(), |sigma| format!(" +- {sigma}"));
    let within = match (inside.value, inside.interval) {
        (None, Some([low, high])) => format!(", within {low} to {high}"),
        _ => String::new(),
    };
    let (method, verdict) = (name_of(&inside.method), name_of(&inside.verdict));
    let origin = if method == verdict {
        method
    } else {
        format!("{method}, {verdict}")
    };
    format!("{value}{sigma}{within} ({origin})")
}

/// The name under which a value without fields stands in `result.json`.
pub(super) fn name_of(value: &impl Serialize) -> String {
    let name = serde_json::to_string(value).unwrap_or_default();
    name.trim_matches('"').to_owned()
}

/// A text without line breaks and other control characters.
pub(super) fn in_one_line(text: &str) -> String {
    text.chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect()
}
