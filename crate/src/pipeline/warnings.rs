//! What to know before trusting a reconstruction, in plain sentences.

use super::{Reconstruction, Stage, Warning};
use crate::export::Status;
use crate::index::Verdict;
use crate::object::Choice;
use crate::scan::{InsideMedium, VesselShape};
use crate::text::{count, some_of};

impl Reconstruction<'_> {
    /// What to know before trusting it, that of the scan first.
    pub fn warnings(&self) -> Vec<Warning> {
        let of_scan = self.scan.warnings.iter().cloned();
        let mut warnings: Vec<Warning> = of_scan.map(about(Stage::Scan)).collect();
        warnings.extend(index(self).map(about(Stage::Index)));
        warnings.extend(thrown_back(self).map(about(Stage::Object)));
        warnings.extend(statuses(self));
        warnings.extend(saturated(self).map(about(Stage::Spots)));
        let of_vessel = [off_epipolar_line(self), thickness(self), shape(self)];
        warnings.extend(of_vessel.into_iter().flatten().map(about(Stage::Vessel)));
        warnings.extend(media(self).into_iter().map(about(Stage::Object)));
        warnings
    }
}

fn about(stage: Stage) -> impl Fn(String) -> Warning {
    move |text| Warning { stage, text }
}

/// An index that the scan cannot tell, or tells badly.
fn index(reconstruction: &Reconstruction) -> Option<String> {
    let index = &reconstruction.index;
    match (index.verdict, index.sigma) {
        (Verdict::NotDetermined, _) => Some(format!(
            "the liquid's refractive index is not determined, so there are no object points in it: {}. Or \
             give the index, if you know the liquid",
            index.reason.as_deref().unwrap_or_default()
        )),
        (Verdict::Weak, Some(sigma)) => Some(format!(
            "the liquid's refractive index is weakly determined (standard deviation {sigma:.4})"
        )),
        _ => None,
    }
}

/// A vessel that no light gets into.
fn thrown_back(reconstruction: &Reconstruction) -> Option<String> {
    let views = &reconstruction.object;
    if views.iter().any(|view| !view.points.is_empty()) {
        return None;
    }
    let of_view = |view: &Choice| view.refused.iter().find_map(|(_, r)| r.total_reflection());
    let thrown_back: Vec<_> = views.iter().filter_map(of_view).collect();
    let first = thrown_back.first()?;
    Some(format!(
        "no light gets into the vessel; in {} it is thrown back at the wall ({first}): check \
         media.outside, wall and inside, or look at the wall more squarely",
        count(thrown_back.len(), "view")
    ))
}

fn statuses(reconstruction: &Reconstruction) -> Vec<Warning> {
    let kinds = [
        (
            Status::NoVesselSpot,
            Stage::Vessel,
            "no vessel spot was found",
        ),
        (
            Status::NoObjectSpot,
            Stage::Object,
            "no object spot was found",
        ),
        (
            Status::Rejected,
            Stage::Object,
            "every spot but the wall's was refused",
        ),
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
        .map(|(status, stage, what)| (ids(*status), *stage, what))
        .filter(|(ids, ..)| !ids.is_empty())
        .map(|(ids, stage, what)| Warning {
            stage,
            text: format!("in {} {what}: {}", count(ids.len(), "view"), some_of(&ids)),
        })
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

/// Views that fit another medium far better than the one that the manifest names.
fn media(reconstruction: &Reconstruction) -> Vec<String> {
    let kinds = [
        (InsideMedium::Air, "air", "the liquid"),
        (InsideMedium::Liquid, "the liquid", "air"),
    ];
    let ids = |medium: InsideMedium| -> Vec<&str> {
        let proposed = reconstruction.inside_proposed.iter();
        let views = proposed.zip(&reconstruction.scan.manifest.views);
        views
            .filter(|(proposed, _)| **proposed == Some(medium))
            .map(|(_, entry)| entry.id.as_str())
            .collect()
    };
    let warn = |(medium, seems, says): (InsideMedium, &str, &str)| {
        let ids = ids(medium);
        (!ids.is_empty()).then(|| {
            let look = if ids.len() == 1 { "looks" } else { "look" };
            format!(
                "{} {look} as if the beam entered {seems}, and scan.json says {says}: {}",
                count(ids.len(), "view"),
                some_of(&ids)
            )
        })
    };
    kinds.into_iter().filter_map(warn).collect()
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
