use serde::{Deserialize, Serialize};

use super::back::Back;
use super::grain;
use super::line::find_on_line;
use super::select::{Fitting, Look, Selection, select};
use super::uncertainty::{Noise, noise};
use super::{CommonSigma, Meeting, MeetingError, Setup, calibration_sigmas, meet};
use crate::camera::Pixel;
use crate::geometry::{Ray, World};
use crate::optics::{TotalReflection, TraceProblem};
use crate::rig::Laser;
use crate::robust::robust_scale;
use crate::scan::{Station, sweeps};
use crate::spots::{Spot, SpotRole, Spots};

/// How object points are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
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
    /// Another spot of the view fits better.
    Outdone(Option<Neighbourhood>),
    /// No other object points make a surface that it lies on.
    Alone(Neighbourhood),
    /// The beam passed the object, and landed on the tank's back wall.
    BackWall {
        /// How far behind the front wall's inner face, mm.
        depth: f64,
        /// How far behind the rest of what was measured, mm.
        space: f64,
    },
    /// The beam passed the object, and landed on the far side of the round vessel.
    FarSide,
}

/// How a spot stands to the surface that the neighbouring views make.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Neighbourhood {
    /// How far behind that surface it lies (before it, if negative), mm along the beam; `None` where the
    /// neighbours make none.
    pub off: Option<f64>,
    /// One standard deviation of it, mm.
    pub sigma: Option<f64>,
}

impl std::fmt::Display for Neighbourhood {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (Some(off), Some(sigma)) = (self.off, self.sigma) else {
            return f.write_str("no points of neighbouring views are near");
        };
        let side = if off < 0.0 { "before" } else { "behind" };
        let off = off.abs();
        write!(
            f,
            "it lies {off:.1} mm {side} the surface that neighbouring views make, known to {sigma:.1} mm there"
        )
    }
}

impl Refusal {
    /// The total reflection that keeps the laser's light or the line of sight out, if that is why.
    pub const fn total_reflection(&self) -> Option<TotalReflection> {
        let Self::NoMeeting(MeetingError::Beam(stopped) | MeetingError::Sight(stopped)) = self
        else {
            return None;
        };
        match stopped.problem {
            TraceProblem::TotalReflection(reflection) => Some(reflection),
            TraceProblem::Miss | TraceProblem::Unmeasured => None,
        }
    }

    /// Whether such a spot shows that there are ghosts: it is neither the object's nor the wall's own.
    const fn tells_of_ghosts(&self) -> bool {
        /// The inner face's glow lies no farther before the face than this, mm.
        const GLOW: f64 = 10.0;
        match self {
            Self::NoMeeting(_) | Self::RayDistance { .. } => true,
            Self::BeforeInnerFace { depth } => *depth < -GLOW,
            Self::Outdone(_) | Self::Alone(_) | Self::BackWall { .. } | Self::FarSide => false,
        }
    }
}

impl Refusal {
    /// As its text, without the numbers that differ from point to point.
    pub fn kind(&self) -> String {
        match self {
            Self::BeforeInnerFace { .. } => {
                "the rays meet before the wall's inner face or on it: the wall's own light"
                    .to_owned()
            }
            Self::RayDistance { .. } => {
                "a greater ray distance than noise and calibration explain".to_owned()
            }
            Self::Outdone(_) => {
                "another point on the same ray of the laser has more light".to_owned()
            }
            Self::Alone(_) => "no other object points make a surface that it lies on".to_owned(),
            Self::BackWall { .. } => "the laser passed the object, and landed behind it".to_owned(),
            Self::NoMeeting(_) | Self::FarSide => self.to_string(),
        }
    }
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
            Self::Outdone(None) => f.write_str("another spot of the view fits better"),
            Self::Outdone(Some(place)) => {
                write!(f, "another spot of the view fits better; {place}")
            }
            Self::BackWall { depth, space } => write!(
                f,
                "the vessel's back wall: one of the points on a face parallel to the front, {depth:.1} mm behind \
                 it and {space:.1} mm behind the object"
            ),
            Self::FarSide => f.write_str("it lies on the far side of the vessel's own wall"),
            Self::Alone(place) => write!(f, "stands alone, as ghosts do: {place}"),
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
/// `gap_sigmas` standard deviations. That standard deviation starts from noise and calibration; when most
/// views agree better than that, it is narrowed to their own spread. Of those left the one is taken for
/// which ray distance, brightness and the neighbouring views speak; where there are ghosts, none with
/// which no neighbours agree.
///
/// Of a sheet of light the light paths always meet. There the point must lie behind the wall, and on each
/// ray that of the curve with the most light is taken.
pub fn find_object(setup: &Setup, spots: &[Spots], settings: &ObjectSettings) -> Vec<Choice> {
    if let Laser::Sheet(sheet) = &setup.rig.laser {
        return find_on_line(setup, sheet, spots, settings);
    }
    let candidates: Vec<Vec<Candidate>> = (0..setup.stations.len())
        .map(|view| candidates(setup, view, &spots[view], settings))
        .collect();
    let expected = expected_gaps(setup, &candidates);
    let judge_all = |limit: f64| -> Vec<Judged> {
        let views = candidates.iter().zip(&expected);
        views
            .map(|(list, expected)| judge_view(list, expected.min(limit), settings))
            .collect()
    };
    let first = judge_all(f64::INFINITY);
    let judged = match observed_gap(&first) {
        Some(observed) => judge_all(observed),
        None => first,
    };
    let mut choices = choose(setup, judged);
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
        let outdone = others.map(|point| (point.spot, Refusal::Outdone(None)));
        choice.refused.extend(outdone);
        choice.refused.retain(|(refused, _)| *refused != spot);
        choice.points.push(ObjectPoint {
            spot,
            meeting,
            noise,
        });
    }
}

/// The grain of laser light as the chosen spots and the wall's show it together; where the former are too
/// few, as the wall's do.
pub fn object_grain(setup: &Setup, choices: &[Choice]) -> f64 {
    let own = grain::estimate(choices, &sweeps(setup.stations));
    let of_wall = setup.vessel.grain;
    own.unwrap_or(of_wall).expected_with(&of_wall)
}

/// Puts the grain that the chosen spots show into their points' standard deviations.
fn count_grain(setup: &Setup, spots: &[Spots], choices: &mut [Choice]) {
    let grain = object_grain(setup, choices);
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
    look: Look,
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
        look: look(spot),
        outcome: examine(setup, &setup.stations[view], spot, settings),
    })
    .collect()
}

/// A spot's light, and its standard deviation over all directions alike.
fn look(spot: &Spot) -> Look {
    // Light of a single pixel has no width.
    const LEAST: f64 = 0.1;
    let [uu, uv, vv] = spot.shape;
    let area = (uu * vv - uv * uv).max(0.0).sqrt();
    Look {
        brightness: spot.brightness,
        width: area.sqrt().max(LEAST),
    }
}

/// The point that a spot would make, were it the object's.
pub(super) fn examine(
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
    let noise =
        noise(setup, station, spot, setup.vessel.grain.value).map_err(Refusal::NoMeeting)?;
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

/// A view's spots, held against their ray distances.
#[derive(Clone, Default)]
struct Judged {
    fitting: Vec<Fitting>,
    refused: Vec<(usize, Refusal)>,
}

impl Judged {
    /// Refuses what lies on the vessel's back.
    fn refuse_on(&mut self, back: &Back, beam: Option<&Ray<World>>) {
        let refused = &mut self.refused;
        self.fitting.retain(|spot| {
            let refusal = beam.and_then(|beam| back.refuse(&spot.point.meeting, beam));
            let is_free = refusal.is_none();
            refused.extend(refusal.map(|refusal| (spot.point.spot, refusal)));
            is_free
        });
    }
}

/// The spread of the ray distances about zero that the views themselves show, as a standard deviation;
/// `None` for too few views to tell. A view speaks by its likeliest spot: the brighter and the nearer.
fn observed_gap(views: &[Judged]) -> Option<f64> {
    const LEAST_VIEWS: usize = 8;
    let likelihood = |spot: &Fitting| libm::log(spot.look.brightness) - 0.5 * spot.gap * spot.gap;
    let likeliest = |view: &Judged| {
        let spots = view.fitting.iter();
        let best = spots.max_by(|a, b| likelihood(a).total_cmp(&likelihood(b)))?;
        Some(best.point.meeting.gap())
    };
    let gaps: Vec<f64> = views.iter().filter_map(likeliest).collect();
    (gaps.len() >= LEAST_VIEWS).then(|| robust_scale(&gaps))
}

/// Holds a view's candidates against their ray distances; `common` is the part of the ray distance's
/// standard deviation that is not the pictures' noise.
fn judge_view(candidates: &[Candidate], common: f64, settings: &ObjectSettings) -> Judged {
    let mut judged = Judged::default();
    for candidate in candidates {
        match judge(candidate, common, settings) {
            Ok(fitting) => judged.fitting.push(fitting),
            Err(refusal) => judged.refused.push((candidate.spot, refusal)),
        }
    }
    judged
}

fn judge(
    candidate: &Candidate,
    common: f64,
    settings: &ObjectSettings,
) -> Result<Fitting, Refusal> {
    let (meeting, noise) = candidate.outcome.clone()?;
    let sigma = (common * common + noise.gap * noise.gap).sqrt();
    let limit = settings.gap_sigmas * sigma;
    let distance = meeting.gap().abs();
    if distance > limit {
        return Err(Refusal::RayDistance { distance, limit });
    }
    Ok(Fitting {
        point: ObjectPoint {
            spot: candidate.spot,
            meeting,
            noise,
        },
        look: candidate.look,
        gap: distance / sigma,
    })
}

/// Chooses among the spots that pass by their ray distances: among all, and, where the likeliest show the
/// vessel's back, among those that do not lie on it.
fn choose(setup: &Setup, judged: Vec<Judged>) -> Vec<Choice> {
    let beams: Vec<Option<Ray<World>>> = setup.stations.iter().map(|s| beam(setup, s)).collect();
    let selections = selected(&judged, &beams);
    let likeliest = |((view, selection), beam): ((&Judged, &Selection), &Option<Ray<World>>)| {
        let spot = &view.fitting[selection.likeliest()?];
        Some((spot.point.meeting, (*beam)?))
    };
    let views = judged.iter().zip(&selections).zip(&beams);
    let likeliest: Vec<(Meeting, Ray<World>)> = views.filter_map(likeliest).collect();
    if let Some(back) = Back::find(&setup.vessel.wall, &likeliest) {
        let mut before_it = judged.clone();
        for (view, beam) in before_it.iter_mut().zip(&beams) {
            view.refuse_on(&back, beam.as_ref());
        }
        let selections = selected(&before_it, &beams);
        if back.is_behind(selections.iter().filter(|s| s.chosen.is_some()).count()) {
            return choices(before_it, &selections);
        }
    }
    choices(judged, &selections)
}

fn selected(judged: &[Judged], beams: &[Option<Ray<World>>]) -> Vec<Selection> {
    let strays = judged.iter().flat_map(|view| &view.refused);
    let strays = strays
        .filter(|(_, refusal)| refusal.tells_of_ghosts())
        .count();
    let fitting: Vec<&[Fitting]> = judged.iter().map(|view| &view.fitting[..]).collect();
    select(&fitting, beams, strays)
}

fn choices(judged: Vec<Judged>, selections: &[Selection]) -> Vec<Choice> {
    let views = judged.into_iter().zip(selections);
    views
        .map(|(view, selection)| chosen(view.fitting, view.refused, selection))
        .collect()
}

fn chosen(
    fitting: Vec<Fitting>,
    mut refused: Vec<(usize, Refusal)>,
    selection: &Selection,
) -> Choice {
    let mut points = Vec::new();
    for (index, spot) in fitting.into_iter().enumerate() {
        let place = selection.evidence[index].neighbourhood();
        match selection.chosen {
            Some(chosen) if chosen == index => points.push(spot.point),
            Some(_) => refused.push((spot.point.spot, Refusal::Outdone(Some(place)))),
            None => refused.push((spot.point.spot, Refusal::Alone(place))),
        }
    }
    Choice { points, refused }
}

/// A view's beam behind the wall.
pub(super) fn beam(setup: &Setup, station: &Station) -> Option<Ray<World>> {
    let stack = setup.vessel.wall.stack(&setup.media, station.inside).ok()?;
    let beam = station.world_from_camera.ray(&setup.rig.laser.axis());
    stack.trace(&beam).ok()
}
