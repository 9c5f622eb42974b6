//! Lengths, radii and flatness of what is shown, each with its plus and minus.

use serde_json::json;
use snellius::export::ReconstructionResult;
use snellius::measure::{MeasureError, Measured, Sample, distance, flatness, sphere_radius};

/// `points` are pairs of view and index in the view.
pub(super) fn measure(result: &ReconstructionResult, what: &str, points: &[u32]) -> String {
    let samples: Option<Vec<Sample>> = points
        .chunks_exact(2)
        .map(|pair| sample(result, pair[0] as usize, pair[1] as usize))
        .collect();
    let outcome = match samples {
        None => Err("a point is not there with this index".to_owned()),
        Some(samples) => of_samples(what, &samples),
    };
    match outcome {
        Ok(Measured { value, sigma }) => json!({ "value": value, "sigma": sigma }),
        Err(why) => json!({ "why": why }),
    }
    .to_string()
}

fn of_samples(what: &str, samples: &[Sample]) -> Result<Measured, String> {
    let said = |measured: Result<Measured, MeasureError>| measured.map_err(|e| e.to_string());
    match (what, samples) {
        ("distance", [one, other]) => Ok(distance(one, other)),
        ("distance", _) => Err("pick two points".to_owned()),
        ("flatness", [_, _, _, _, ..]) => said(flatness(samples)),
        ("radius", [_, _, _, _, ..]) => said(sphere_radius(samples)),
        _ => Err("pick four points or more".to_owned()),
    }
}

/// A point with the covariance that its standard deviations along the axes make: how these go together is
/// not in a result.
fn sample(result: &ReconstructionResult, view: usize, index: usize) -> Option<Sample> {
    let view = result.views.get(view)?;
    let place = *view.object.as_slice().get(index)?;
    let [x, y, z] = *view.object_sigma.as_slice().get(index)?;
    Some(Sample::new(place, [x * x, 0.0, 0.0, y * y, 0.0, z * z]))
}
