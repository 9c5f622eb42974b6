//! The wall, told by the object: where light bends otherwise than was thought, the two light paths do not meet.

use nalgebra::DVector;

use super::uncertainty::{calibration_changes, ray_distances, slopes};
use super::{Choice, Setup, object_grain};
use crate::camera::Pixel;
use crate::rig::Laser;
use crate::robust::biweight;
use crate::spots::{Spot, Spots};
use crate::vessel::{Evidence, Told, VesselFit};

/// The wall that its own points and the ray distances of the object's points support together.
///
/// The light paths of each chosen point should meet. By how much they do not tells how the wall stands where
/// they cross it, above all how it is inclined there, which its own points, each a little off, tell worst. A
/// ray distance that neither noise nor calibration nor the wall's own uncertainty explains loses weight by
/// Tukey's biweight.
///
/// `None` where ray distances say nothing new: the wall is known or of a simple shape, whose few numbers its own
/// points tell better; there is no object; the laser's light is a sheet, which always meets the line of sight.
pub fn settle_wall(setup: &Setup, spots: &[Spots], choices: &[Choice]) -> Option<VesselFit> {
    const ROUNDS: usize = 4;
    let alternatives = setup.vessel.alternatives();
    if alternatives.is_empty() || matches!(setup.rig.laser, Laser::Sheet(_)) {
        return None;
    }
    let mut evidence = evidence(setup, spots, choices);
    let own: Vec<f64> = evidence.iter().map(|one| one.variance).collect();
    let mut told = None;
    for _ in 0..ROUNDS {
        let numbers = weigh_anew(setup, &mut evidence, &own, told.as_ref());
        told = Some(Told::weigh(alternatives, &evidence, &numbers)?);
    }
    Some(setup.vessel.told_by(told?))
}

/// Weighs the ray distances by how large they are at the wall as it has been `told`, and gives what they would
/// be at the wall before, were they straight in its parameters.
fn weigh_anew(
    setup: &Setup,
    evidence: &mut [Evidence],
    own: &[f64],
    told: Option<&Told>,
) -> DVector<f64> {
    let before = &setup.vessel.wall;
    let none = DVector::zeros(before.outer.freedom());
    let step = told.map_or(&none, Told::step);
    let covariance = told.map_or(&before.covariance, Told::covariance);
    let seen: Vec<(usize, Pixel)> = evidence.iter().map(|one| (one.view, one.pixel)).collect();
    let wall = before.nudged(step);
    let distances = ray_distances(setup.rig, &wall, &setup.media, setup.stations, &seen);
    let mut numbers = DVector::zeros(evidence.len());
    for (row, one) in evidence.iter_mut().enumerate() {
        let spread = (own[row] + one.variance_of_others(covariance)).sqrt();
        let weight = distances[row].map_or(0.0, |distance| biweight(distance / spread));
        one.variance = own[row] / weight.max(f64::EPSILON);
        numbers[row] = distances[row].map_or(0.0, |distance| distance - one.following(step));
    }
    numbers
}

/// The ray distances of the chosen points, and what they depend on.
fn evidence(setup: &Setup, spots: &[Spots], choices: &[Choice]) -> Vec<Evidence> {
    let grain = object_grain(setup, choices);
    let of_view = |(choice, view): (&Choice, &Spots)| -> Vec<Spot> {
        let points = choice.points.iter();
        points.map(|point| view.spots[point.spot]).collect()
    };
    let chosen: Vec<Vec<Spot>> = choices.iter().zip(spots).map(of_view).collect();
    let pixels: Vec<Vec<Pixel>> = chosen
        .iter()
        .map(|chosen| chosen.iter().map(Spot::pixel).collect())
        .collect();
    let common: Vec<_> = calibration_changes(setup, &pixels).collect();
    let one = |view: usize, at: usize| {
        let spot = &chosen[view][at];
        let slopes = slopes(setup, &setup.stations[view], spot.pixel()).ok()?;
        let variance = slopes.gap_variance(&spot.covariance_with(grain));
        (variance > 0.0).then(|| Evidence {
            view,
            pixel: spot.pixel(),
            slopes: slopes.gap_by_wall(),
            variance,
            common: common.iter().map(|number| number[view][at].gap).collect(),
        })
    };
    let views = chosen.iter().enumerate();
    let all = views.flat_map(|(view, chosen)| (0..chosen.len()).map(move |at| (view, at)));
    all.filter_map(|(view, at)| one(view, at)).collect()
}
