//! What to know before trusting a reconstruction, in plain sentences.

use super::Reconstruction;
use crate::export::Status;
use crate::scan::VesselShape;
use crate::text::{count, some_of};

/// Every warning of a reconstruction, those of the scan first.
pub(super) fn of(reconstruction: &Reconstruction) -> Vec<String> {
    let mut warnings = reconstruction.scan.warnings.clone();
    warnings.extend(statuses(reconstruction));
    warnings.extend(saturated(reconstruction));
    warnings.extend(off_epipolar_line(reconstruction));
    warnings.extend(thickness(reconstruction));
    warnings.extend(shape(reconstruction));
    warnings
}

fn statuses(reconstruction: &Reconstruction) -> Vec<String> {
    let kinds = [
        (Status::NoVesselSpot, "no vessel spot was found"),
        (Status::NoObjectSpot, "no object spot was found"),
        (Status::Rejected, "every spot but the wall's was refused"),
    ];
    let ids = |status: Status| -> Vec<&str> {
        let views = reconstruction.scan.manifest.views.iter().enumerate();
        views
            .filter(|(view, _)| reconstruction.status(*view) == status)
            .map(|(_, entry)| entry.id.as_str())
            .collect()
    };
    kinds
        .iter()
        .map(|(status, what)| (ids(*status), what))
        .filter(|(ids, _)| !ids.is_empty())
        .map(|(ids, what)| format!("in {} {what}: {}", count(ids.len(), "view"), some_of(&ids)))
        .collect()
}

fn saturated(reconstruction: &Reconstruction) -> Option<String> {
    let spots = reconstruction.spots.iter().enumerate();
    let used = spots.flat_map(|(view, spots)| {
        let vessel = reconstruction.vessel.points[view].iter().map(|p| p.spot);
        let object = reconstruction.object[view].points.iter().map(|p| p.spot);
        vessel.chain(object).map(|spot| &spots.spots[spot])
    });
    let saturated = used.filter(|spot| spot.saturated).count();
    (saturated > 0).then(|| {
        format!(
            "{} overexposed (grey values at the top of the scale), so its centroid may be off; \
             expose for a shorter time",
            count(saturated, "spot that was used is")
        )
    })
}

/// A laser that misses its calibrated epipolar line by more than the centroids' noise allows.
fn off_epipolar_line(reconstruction: &Reconstruction) -> Option<String> {
    const NOTABLE: f64 = 0.5;
    let off = reconstruction.vessel.median_off_line()?;
    (off.abs() > NOTABLE).then(|| {
        format!(
            "the vessel's spots lie {off:+.2} px off the epipolar line (median): the laser's direction \
             or origin has moved since calibration"
        )
    })
}

/// A wall whose glows lie much nearer or farther apart than its thickness makes them.
fn thickness(reconstruction: &Reconstruction) -> Option<String> {
    const NOTABLE: f64 = 1.6;
    let given = reconstruction.vessel.wall.thickness;
    let seen = reconstruction.vessel.glows?.thickness?;
    let ratio = f64::max(seen / given, given / seen);
    (ratio > NOTABLE).then(|| {
        format!(
            "the glows of the wall's two faces suggest a wall of about {seen:.1} mm, and {given} mm are \
             given"
        )
    })
}

/// A shape that `auto` chose by a hair. A free form can be anything, so it is never far from a simple shape
/// that is right.
fn shape(reconstruction: &Reconstruction) -> Option<String> {
    const SETTLED: f64 = 10.0;
    let choice = reconstruction
        .vessel
        .choice
        .filter(|choice| choice.margin < SETTLED && choice.runner_up != VesselShape::Freeform)?;
    Some(
        format!(
            "the vessel points support a {:?} hardly better than a {:?}; give vessel.shape if you know it",
            choice.chosen, choice.runner_up
        )
        .to_lowercase(),
    )
}
