use serde::{Deserialize, Serialize};

use super::grain;
use super::uncertainty::{Noise, noise};
use super::{CommonSigma, Meeting, MeetingError, Setup, calibration_sigmas, meet};
use crate::camera::Pixel;
use crate::robust::robust_scale;
use crate::scan::{Station, sweeps};
use crate::spots::{Spot, SpotRole, Spots};

/// How object points are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ObjectSettings {
    /// A ray distance of more than this many standard deviations refuses a spot. The standard deviation
    /// holds the pictures' noise and calibration, and is narrowed to what the scan itself shows.
    pub gap_sigmas: f64,
    /// A point nearer to the wall's inner face than this is the glow of that face, mm along the light.
    pub nearest: f64,
}

impl Default for ObjectSettings {
    fn default() -> Self {
        Self {
            gap_sigmas: 4.0,
            nearest: 1.0,
        }
    }
}

/// The object point of a view.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectPoint {
    /// Which of the view's spots.
    pub spot: usize,
    /// Where the two light paths meet.
    pub meeting: Meeting,
    /// What the pictures' noise does to it.
    pub noise: Noise,
}

/// Why a spot of a view is not its object point.
#[derive(Clone, Debug, PartialEq)]
pub enum Refusal {
    /// The light paths do not meet behind the wall.
    NoMeeting(MeetingError),
    /// They meet in or before the wall: the inner face's glow, or a reflection.
    BeforeInnerFace {
        /// How far behind the inner face, mm along the light.
        depth: f64,
    },
    /// The ray distance is too large.
    RayDistance {
        /// The ray distance l, mm.
        distance: f64,
        /// The largest allowed, mm.
        limit: f64,
    },
    /// Another spot fits better.
    Outdone,
}

impl std::fmt::Display for Refusal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NoMeeting(error) => error.fmt(f),
            Self::BeforeInnerFace { depth } => {
                write!(
                    f,
                    "the rays meet {depth:.2} mm behind the wall's inner face: no object, but the wall's own light"
                )
            }
            Self::RayDistance { distance, limit } => {
                write!(
                    f,
                    "ray distance {distance:.3} mm, more than the {limit:.3} mm that noise and calibration explain"
                )
            }
            Self::Outdone => f.write_str("another spot of the view fits better"),
        }
    }
}

/// What became of a view's spots.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Choice {
    /// The object points that were found: at most one for a beam.
    pub points: Vec<ObjectPoint>,
    /// The spots that were refused, and why.
    pub refused: Vec<(usize, Refusal)>,
}

/// Finds each view's object point among the spots that are not its vessel spot.
///
/// A spot is refused where the light paths do not meet behind the wall, or pass each other at more than
/// `gap_sigmas` standard deviations. Of those left the one with the greatest
/// `ln(brightness) - gap^2 / (2 sigma^2)` is taken: a spot is the likelier real the brighter it is and
/// the smaller its ray distance. The standard deviation starts from noise and calibration; when most
/// views agree better than that, it is narrowed to their own spread and the choice made once more.
pub fn find_object(setup: &Setup, spots: &[Spots], settings: &ObjectSettings) -> Vec<Choice> {
    let candidates: Vec<Vec<Candidate>> = (0..setup.stations.len())
        .map(|view| candidates(setup, view, &spots[view], settings))
        .collect();
    let expected = expected_gaps(setup, &candidates);
    let choose_all = |limit: f64| -> Vec<Choice> {
        let views = candidates.iter().zip(&expected);
        views
            .map(|(list, expected)| choose(list, expected.min(limit), settings))
            .collect()
    };
    let first = choose_all(f64::INFINITY);
    let mut choices = match observed_gap(&first) {
        Some(observed) => choose_all(observed),
        None => first,
    };
    insist(&candidates, spots, &mut choices);
    count_grain(setup, spots, &mut choices);
    choices
}

/// A spot of which a person says that it is the object's is taken, whatever speaks against it, if its
/// light paths meet behind the wall.
fn insist(candidates: &[Vec<Candidate>], spots: &[Spots], choices: &mut [Choice]) {
    for ((candidates, spots), choice) in candidates.iter().zip(spots).zip(choices) {
        let said = candidates
            .iter()
            .find(|c| spots.said_of(c.spot) == Some(SpotRole::Object));
        let Some((spot, Ok((meeting, noise)))) = said.map(|c| (c.spot, c.outcome.clone())) else {
            continue;
        };
        let others = choice.points.drain(..).filter(|point| point.spot != spot);
        let outdone = others.map(|point| (point.spot, Refusal::Outdone));
        choice.refused.extend(outdone);
        choice.refused.retain(|(refused, _)| *refused != spot);
        choice.points.push(ObjectPoint {
            spot,
            meeting,
            noise,
        });
    }
}

/// Puts the grain that the object's own spots show into their points' standard deviations, where there
/// are enough of them to show it.
fn count_grain(setup: &Setup, spots: &[Spots], choices: &mut [Choice]) {
    let Some(grain) = grain::estimate(choices, &sweeps(setup.stations)) else {
        return;
    };
    for (view, choice) in choices.iter_mut().enumerate() {
        for point in &mut choice.points {
            let spot = &spots[view].spots[point.spot];
            if let Ok(noise) = noise(setup, &setup.stations[view], spot, grain) {
                point.noise = noise;
            }
        }
    }
}

/// A spot that may be the object's.
struct Candidate {
    spot: usize,
    pixel: Pixel,
    brightness: f64,
    outcome: Result<(Meeting, Noise), Refusal>,
}

fn candidates(
    setup: &Setup,
    view: usize,
    spots: &Spots,
    settings: &ObjectSettings,
) -> Vec<Candidate> {
    let taken = |spot: usize| setup.vessel.points[view].iter().any(|p| p.spot == spot);
    let may_be = |spot: usize| !taken(spot) && spots.may_be(spot, SpotRole::Object);
    let free = spots.spots.iter().enumerate().filter(|(i, _)| may_be(*i));
    free.map(|(index, spot)| Candidate {
        spot: index,
        pixel: spot.pixel(),
        brightness: spot.brightness,
        outcome: examine(setup, &setup.stations[view], spot, settings),
    })
    .collect()
}

fn examine(
    setup: &Setup,
    station: &Station,
    spot: &Spot,
    settings: &ObjectSettings,
) -> Result<(Meeting, Noise), Refusal> {
    let stack = setup.vessel.wall.stack(&setup.media, station.inside);
    let stack = stack.map_err(|e| Refusal::NoMeeting(e.into()))?;
    let meeting = meet(setup.rig, &station.world_from_camera, &stack, spot.pixel())
        .map_err(Refusal::NoMeeting)?;
    let depth = meeting.depth();
    if depth.is_nan() || depth < settings.nearest {
        return Err(Refusal::BeforeInnerFace { depth });
    }
    let noise = noise(setup, station, spot, setup.vessel.grain).map_err(Refusal::NoMeeting)?;
    Ok((meeting, noise))
}

/// The standard deviation of each view's ray distance that calibration explains. It is taken at one of
/// the view's spots, as it hardly differs between them.
fn expected_gaps(setup: &Setup, candidates: &[Vec<Candidate>]) -> Vec<f64> {
    let usable = |list: &Vec<Candidate>| {
        let first = list.iter().find(|c| c.outcome.is_ok());
        first.map(|c| c.pixel).into_iter().collect()
    };
    let measured: Vec<Vec<Pixel>> = candidates.iter().map(usable).collect();
    let gap = |sigmas: Vec<CommonSigma>| sigmas.first().map_or(0.0, |s| s.gap);
    let sigmas = calibration_sigmas(setup, &measured);
    sigmas.into_iter().map(gap).collect()
}

/// The spread of the ray distances about zero that the views themselves show, as a standard deviation;
/// `None` for too few views to tell.
fn observed_gap(choices: &[Choice]) -> Option<f64> {
    const LEAST_VIEWS: usize = 8;
    let points = choices.iter().flat_map(|c| &c.points);
    let gaps: Vec<f64> = points.map(|p| p.meeting.gap()).collect();
    (gaps.len() >= LEAST_VIEWS).then(|| robust_scale(&gaps))
}

/// Chooses among a view's candidates; `common` is the part of the ray distance's standard deviation that
/// is not the pictures' noise.
fn choose(candidates: &[Candidate], common: f64, settings: &ObjectSettings) -> Choice {
    let mut refused = Vec::new();
    let mut fitting = Vec::new();
    for candidate in candidates {
        match judge(candidate, common, settings) {
            Ok((likelihood, point)) => fitting.push((likelihood, point)),
            Err(refusal) => refused.push((candidate.spot, refusal)),
        }
    }
    fitting.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut fitting = fitting.into_iter().map(|(_, point)| point);
    let points = fitting.next().into_iter().collect();
    refused.extend(fitting.map(|p| (p.spot, Refusal::Outdone)));
    Choice { points, refused }
}

/// How likely a candidate is the object's spot (up to a constant, as a logarithm).
fn judge(
    candidate: &Candidate,
    common: f64,
    settings: &ObjectSettings,
) -> Result<(f64, ObjectPoint), Refusal> {
    let (meeting, noise) = candidate.outcome.clone()?;
    let sigma = (common * common + noise.gap * noise.gap).sqrt();
    let limit = settings.gap_sigmas * sigma;
    let distance = meeting.gap().abs();
    if distance > limit {
        return Err(Refusal::RayDistance { distance, limit });
    }
    let z = distance / sigma;
    let point = ObjectPoint {
        spot: candidate.spot,
        meeting,
        noise,
    };
    Ok((libm::log(candidate.brightness) - 0.5 * z * z, point))
}
