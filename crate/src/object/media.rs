//! Liquid or air behind the wall: where the manifest seems wrong.
//!
//! In a half-filled vessel the beams of some views enter above the liquid. A view that is taken to be in
//! the wrong medium has its point too near or too deep by a third, and (unless the rig stands square to a
//! flat wall, where it is blind) a ray distance that noise does not explain. Both are tried: for a set of
//! views that follow one another in a sweep, or of sweeps that do, everything is reckoned in the other
//! medium, and the gain is
//!
//! ```text
//! sum over all views of  -gap^2 / (2 sigma^2) + agreement with the neighbours' surface
//! ```
//!
//! in natural logarithms of likelihood, with the gap counted from the median over the views, since an error
//! of calibration shifts all alike. Only a gain that chance does not give is proposed. Where neither
//! the ray distance nor the continuity of the surface can tell, nothing is.

use super::choice::{Choice, ObjectSettings, beam, examine};
use super::neighbours::{Forecasts, Misfit, Place, around, usual_curvature};
use super::{Meeting, Noise, Setup};
use crate::geometry::{Ray, World};
use crate::rig::Laser;
use crate::robust::{median, robust_scale};
use crate::scan::{InsideMedium, Station, sweeps};
use crate::spots::{Spot, Spots};

/// A gain of e^12 : 1, after some hundred sets were tried, is no chance.
const SIGNIFICANT: f64 = 12.0;
/// Fewer views tell neither the usual ray distance nor a surface.
const LEAST_VIEWS: usize = 8;
/// No view speaks louder by its ray distance than this many standard deviations.
const LOUDEST: f64 = 6.0;
/// A forecast more uncertain than this fits either medium, mm.
const VAGUEST: f64 = 10.0;
/// Media whose indices differ by less bend light alike.
const ALIKE: f64 = 0.02;

/// What each view's beam seems to enter, where that is not what its station says.
///
/// `choices` are the points that were found with the media as they are said to be.
pub fn propose_media(
    setup: &Setup,
    spots: &[Spots],
    choices: &[Choice],
    settings: &ObjectSettings,
) -> Vec<Option<InsideMedium>> {
    let none = vec![None; setup.stations.len()];
    if (setup.media.liquid - setup.media.outside).abs() < ALIKE
        || matches!(setup.rig.laser, Laser::Sheet(_))
    {
        return none;
    }
    let Some(search) = Search::new(setup, spots, choices, settings) else {
        return none;
    };
    let flipped = search.best();
    let views = setup.stations.iter().zip(flipped);
    views
        .map(|(station, flipped)| flipped.then_some(other(station.inside)))
        .collect()
}

const fn other(medium: InsideMedium) -> InsideMedium {
    match medium {
        InsideMedium::Liquid => InsideMedium::Air,
        InsideMedium::Air => InsideMedium::Liquid,
    }
}

/// A view's point in one medium.
#[derive(Clone, Copy)]
struct Reading {
    beam: Ray<World>,
    place: Place,
    /// The ray distance with its sign, and its standard deviation from noise, mm.
    gap: f64,
    gap_noise: f64,
}

/// A view's point as its station says, and in the other medium.
type Both = [Reading; 2];

struct Search {
    readings: Vec<Option<Both>>,
    /// Sets of views that follow one another, and may have been taken for the wrong medium together, or in
    /// part.
    rows: Vec<Vec<usize>>,
    /// The views that each view's neighbours are among,
    around: Vec<Vec<usize>>,
    /// and those that each may be a neighbour of.
    beside: Vec<Vec<usize>>,
    curvature: f64,
    /// The part of the ray distance's standard deviation that is not noise, mm.
    common: f64,
}

/// Some views in the other medium.
#[derive(Clone)]
struct Trial {
    /// Which.
    flipped: Vec<bool>,
    /// How each view agrees with its neighbours then.
    agreement: Vec<f64>,
}

impl Search {
    fn new(
        setup: &Setup,
        spots: &[Spots],
        choices: &[Choice],
        settings: &ObjectSettings,
    ) -> Option<Self> {
        let readings: Vec<Option<Both>> = (0..setup.stations.len())
            .map(|view| both(setup, view, &spots[view], &choices[view], settings))
            .collect();
        if readings.iter().flatten().count() < LEAST_VIEWS {
            return None;
        }
        let scale = |medium: usize| {
            let gaps: Vec<f64> = readings.iter().flatten().map(|b| b[medium].gap).collect();
            let middle = median(gaps.clone());
            let off: Vec<f64> = gaps.iter().map(|gap| gap - middle).collect();
            robust_scale(&off)
        };
        let around = around_each(&readings);
        let mut search = Self {
            rows: rows(setup.stations),
            beside: turned_round(&around),
            around,
            curvature: 0.0,
            common: scale(0).min(scale(1)),
            readings,
        };
        search.curvature = search.usual_curvature();
        Some(search)
    }

    /// Flips the set that gains most, again and again.
    fn best(&self) -> Vec<bool> {
        const ROUNDS: usize = 8;
        let mut now = self.as_said();
        for _ in 0..ROUNDS {
            let next = self.best_flip(&now);
            let gain = sum(&self.favours(&next)) - sum(&self.favours(&now));
            if !is_significant(&now.flipped, &next.flipped, gain) {
                break;
            }
            now = next;
        }
        now.flipped
    }

    /// Of every set of views in turn the one that fits best when it is flipped: each row, the first few rows
    /// and the last few, all views, and of every row the beginning and the end that gain most.
    fn best_flip(&self, now: &Trial) -> Trial {
        let before = self.favours(now);
        let mut best = (f64::NEG_INFINITY, now.clone());
        let mut consider = |trial: &Trial, favour: f64| {
            if favour >= best.0 {
                best = (favour, trial.clone());
            }
        };
        let mut parts = Vec::new();
        for row in &self.rows {
            let whole = self.flip(now, row);
            let favours = self.favours(&whole);
            consider(&whole, sum(&favours));
            let gains = row.iter().map(|view| favours[*view] - before[*view]);
            parts.extend(gaining_parts(row, &gains.collect::<Vec<f64>>()));
        }
        let mut consider = |trial: &Trial| consider(trial, sum(&self.favours(trial)));
        self.each_run_of_rows(now, &mut consider);
        for part in parts {
            consider(&self.flip(now, part));
        }
        best.1
    }

    /// Flips the first few rows and the last few, ever more of them, and at last all.
    fn each_run_of_rows(&self, now: &Trial, mut then: impl FnMut(&Trial)) {
        let [row, .., last_row] = &self.rows[..] else {
            return;
        };
        let (mut first, mut last) = (self.flip(now, row), self.flip(now, last_row));
        let count = self.rows.len();
        for cut in 2..count {
            first = self.flip(&first, &self.rows[cut - 1]);
            last = self.flip(&last, &self.rows[count - cut]);
            then(&first);
            then(&last);
        }
        then(&self.flip(&first, last_row));
    }

    fn as_said(&self) -> Trial {
        let flipped = vec![false; self.readings.len()];
        let views = 0..flipped.len();
        Trial {
            agreement: views.map(|view| self.agreement(view, &flipped)).collect(),
            flipped,
        }
    }

    /// Flips some views more. Only those beside them agree otherwise with their neighbours then.
    fn flip(&self, trial: &Trial, views: &[usize]) -> Trial {
        let mut next = trial.clone();
        let mut changed = vec![false; self.readings.len()];
        for view in views {
            next.flipped[*view] = !next.flipped[*view];
            changed[*view] = true;
            self.beside[*view].iter().for_each(|v| changed[*v] = true);
        }
        let changed = (0..changed.len()).filter(|view| changed[*view]);
        for view in changed {
            next.agreement[view] = self.agreement(view, &next.flipped);
        }
        next
    }

    fn reading(&self, view: usize, flipped: &[bool]) -> Option<&Reading> {
        Some(&self.readings[view].as_ref()?[usize::from(flipped[view])])
    }

    fn forecasts(&self, view: usize, flipped: &[bool]) -> Option<Forecasts> {
        let around = self.around[view].iter();
        let places = around.filter_map(|other| Some(self.reading(*other, flipped)?.place));
        Some(Forecasts::of(&self.reading(view, flipped)?.beam, places))
    }

    fn usual_curvature(&self) -> f64 {
        let flipped = vec![false; self.readings.len()];
        let views = 0..flipped.len();
        let forecasts: Vec<_> = views.map(|view| self.forecasts(view, &flipped)).collect();
        let places = self.readings.iter();
        let places: Vec<_> = places.map(|both| Some((*both)?[0].place)).collect();
        usual_curvature(&forecasts, &places, VAGUEST)
    }

    /// How a view agrees with its neighbours, with the views that are flipped in the other medium.
    fn agreement(&self, view: usize, flipped: &[bool]) -> f64 {
        let reading = self.reading(view, flipped);
        let Some((reading, forecasts)) = reading.zip(self.forecasts(view, flipped)) else {
            return 0.0;
        };
        let misfits = forecasts.hold(&reading.place, self.curvature, VAGUEST);
        misfits.iter().map(Misfit::agreement).sum()
    }

    /// How well each view fits, with the views that are flipped in the other medium.
    fn favours(&self, trial: &Trial) -> Vec<f64> {
        let views = 0..self.readings.len();
        let reading = |view| self.reading(view, &trial.flipped);
        let gaps = views.clone().filter_map(|view| Some(reading(view)?.gap));
        let middle = median(gaps.collect());
        let favour = |view: usize| {
            let reading = reading(view)?;
            let variance = reading.gap_noise * reading.gap_noise + self.common * self.common;
            let gap = reading.gap - middle;
            let square = (gap * gap / variance).min(LOUDEST * LOUDEST);
            Some(trial.agreement[view] - 0.5 * square)
        };
        views.map(|view| favour(view).unwrap_or(0.0)).collect()
    }
}

/// The views that each view's neighbours are among.
fn around_each(readings: &[Option<Both>]) -> Vec<Vec<usize>> {
    let places: Vec<_> = readings
        .iter()
        .map(|both| Some((*both)?[0].place))
        .collect();
    let views = readings.iter().enumerate();
    let around = |(view, both): (usize, &Option<Both>)| {
        let [as_said, _] = both.as_ref()?;
        Some(around(view, &as_said.beam, &places))
    };
    views.map(|view| around(view).unwrap_or_default()).collect()
}

/// For each view those in whose lists it is.
fn turned_round(lists: &[Vec<usize>]) -> Vec<Vec<usize>> {
    let mut turned = vec![Vec::new(); lists.len()];
    for (view, list) in lists.iter().enumerate() {
        list.iter().for_each(|other| turned[*other].push(view));
    }
    turned
}

/// The beginning and the end of a row that gain most by being flipped, where these are not all of it.
fn gaining_parts<'a>(row: &'a [usize], gains: &[f64]) -> impl Iterator<Item = &'a [usize]> {
    let (start, end) = (best_start(gains), gains.len() - best_end(gains));
    let parts = [&row[..start], &row[end..]].into_iter();
    parts.filter(|part| !part.is_empty() && part.len() < row.len())
}

fn sum(values: &[f64]) -> f64 {
    values.iter().sum()
}

/// Whether a flip gains more than chance would give, for as many views as it changes.
fn is_significant(flipped: &[bool], next: &[bool], gain: f64) -> bool {
    // In other units of depth all noise is a little more or less.
    const EACH: f64 = 0.5;
    let changed = flipped.iter().zip(next).filter(|(now, then)| now != then);
    gain > SIGNIFICANT.max(EACH * changed.count() as f64)
}

/// How many of the first gains make the greatest sum.
fn best_start(gains: &[f64]) -> usize {
    let mut total = 0.0;
    let sums = gains.iter().enumerate().map(|(index, gain)| {
        total += gain;
        (index + 1, total)
    });
    let best = sums.max_by(|a, b| a.1.total_cmp(&b.1));
    best.filter(|(_, sum)| *sum > 0.0)
        .map_or(0, |(count, _)| count)
}

fn best_end(gains: &[f64]) -> usize {
    let backwards: Vec<f64> = gains.iter().rev().copied().collect();
    best_start(&backwards)
}

/// The views of each sweep, split where the medium changes; all views in one row where there are hardly
/// any sweeps of several stations.
fn rows(stations: &[Station]) -> Vec<Vec<usize>> {
    const SHORT: usize = 3;
    let sweep_of = sweeps(stations);
    let count = sweep_of.iter().max().map_or(0, |last| last + 1);
    if count * SHORT > stations.len() {
        return vec![(0..stations.len()).collect()];
    }
    let mut rows = Vec::new();
    for sweep in 0..count {
        let views: Vec<usize> = (0..stations.len())
            .filter(|v| sweep_of[*v] == sweep)
            .collect();
        let same = |a: &usize, b: &usize| stations[*a].inside == stations[*b].inside;
        rows.extend(views.chunk_by(same).map(<[usize]>::to_vec));
    }
    rows
}

/// The view's point in both media: that of the spot that was chosen, or else of the one with the least ray
/// distance in either.
fn both(
    setup: &Setup,
    view: usize,
    spots: &Spots,
    choice: &Choice,
    settings: &ObjectSettings,
) -> Option<Both> {
    let station = &setup.stations[view];
    let flipped = Station {
        inside: other(station.inside),
        ..*station
    };
    let read = |spot: &Spot| {
        Some([
            reading(setup, station, spot, settings)?,
            reading(setup, &flipped, spot, settings)?,
        ])
    };
    if let Some(point) = choice.points.first() {
        return read(&spots.spots[point.spot]);
    }
    let taken = |spot: usize| setup.vessel.points[view].iter().any(|p| p.spot == spot);
    let free = spots
        .spots
        .iter()
        .enumerate()
        .filter(|(spot, _)| !taken(*spot));
    let least = |both: &Both| both[0].gap.abs().min(both[1].gap.abs());
    free.filter_map(|(_, spot)| read(spot))
        .min_by(|a, b| least(a).total_cmp(&least(b)))
}

fn reading(
    setup: &Setup,
    station: &Station,
    spot: &Spot,
    settings: &ObjectSettings,
) -> Option<Reading> {
    let beam = beam(setup, station)?;
    let (meeting, noise): (Meeting, Noise) = examine(setup, station, spot, settings).ok()?;
    Some(Reading {
        place: Place::new(&meeting, &noise, &beam),
        beam,
        gap: meeting.gap(),
        gap_noise: noise.gap,
    })
}
