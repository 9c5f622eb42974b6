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
use super::neighbours::{Forecasts, Misfit, Place, usual_curvature};
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
    /// Sets of views that may have been taken for the wrong medium together.
    sets: Vec<Vec<usize>>,
    /// Those of the sets that follow one another, so that a part may be wrong.
    rows: Vec<Vec<usize>>,
    curvature: f64,
    /// The part of the ray distance's standard deviation that is not noise, mm.
    common: f64,
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
        let rows = rows(setup.stations);
        let mut search = Self {
            sets: sets(&rows),
            rows,
            curvature: 0.0,
            common: scale(0).min(scale(1)),
            readings,
        };
        let as_said = vec![false; setup.stations.len()];
        let places = search.places(&as_said);
        search.curvature = usual_curvature(&search.forecasts(&as_said, &places), &places);
        Some(search)
    }

    /// Flips the set that gains most, again and again.
    fn best(&self) -> Vec<bool> {
        const ROUNDS: usize = 8;
        let mut flipped = vec![false; self.readings.len()];
        let mut before = self.favours(&flipped);
        for _ in 0..ROUNDS {
            let tried = self.tries(&flipped, &before).into_iter();
            let best = tried.max_by(|a, b| sum(&a.1).total_cmp(&sum(&b.1)));
            let Some((next, after)) = best else {
                break;
            };
            if !is_significant(&flipped, &next, sum(&after) - sum(&before)) {
                break;
            }
            (flipped, before) = (next, after);
        }
        flipped
    }

    /// Every set flipped, and of every row the beginning and the end that gain most.
    fn tries(&self, flipped: &[bool], before: &[f64]) -> Vec<(Vec<bool>, Vec<f64>)> {
        let flip = |views: &[usize]| {
            let mut next = flipped.to_vec();
            views.iter().for_each(|view| next[*view] = !next[*view]);
            let favours = self.favours(&next);
            (next, favours)
        };
        let mut tries: Vec<_> = self.sets.iter().map(|set| flip(set)).collect();
        for row in &self.rows {
            let (_, whole) = flip(row);
            let gains: Vec<f64> = row
                .iter()
                .map(|view| whole[*view] - before[*view])
                .collect();
            let (start, end) = (best_start(&gains), gains.len() - best_end(&gains));
            let parts = [&row[..start], &row[end..]];
            let cut = |part: &&[usize]| !part.is_empty() && part.len() < row.len();
            tries.extend(parts.into_iter().filter(cut).map(flip));
        }
        tries
    }

    fn reading(&self, view: usize, flipped: &[bool]) -> Option<&Reading> {
        Some(&self.readings[view].as_ref()?[usize::from(flipped[view])])
    }

    fn places(&self, flipped: &[bool]) -> Vec<Option<Place>> {
        let place = |view| Some(self.reading(view, flipped)?.place);
        (0..self.readings.len()).map(place).collect()
    }

    fn forecasts(&self, flipped: &[bool], places: &[Option<Place>]) -> Vec<Option<Forecasts>> {
        let of_view = |view| {
            Some(Forecasts::of(
                view,
                &self.reading(view, flipped)?.beam,
                places,
            ))
        };
        (0..self.readings.len()).map(of_view).collect()
    }

    /// How well each view fits, with the views that are flipped in the other medium.
    fn favours(&self, flipped: &[bool]) -> Vec<f64> {
        let places = self.places(flipped);
        let forecasts = self.forecasts(flipped, &places);
        let all = (0..self.readings.len()).filter_map(|view| self.reading(view, flipped));
        let middle = median(all.map(|reading| reading.gap).collect());
        let favour = |(view, forecasts): (usize, &Option<Forecasts>)| {
            let reading = self.reading(view, flipped)?;
            let variance = reading.gap_noise * reading.gap_noise + self.common * self.common;
            let gap = reading.gap - middle;
            let square = (gap * gap / variance).min(LOUDEST * LOUDEST);
            let misfits = forecasts.as_ref()?.hold(&reading.place, self.curvature);
            let agreement: f64 = misfits.iter().map(Misfit::agreement).sum();
            Some(agreement - 0.5 * square)
        };
        let views = forecasts.iter().enumerate();
        views.map(|view| favour(view).unwrap_or(0.0)).collect()
    }
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

/// Each row, the first few rows and the last few, and all views.
fn sets(rows: &[Vec<usize>]) -> Vec<Vec<usize>> {
    let mut sets = rows.to_vec();
    for cut in 2..rows.len() {
        sets.push(rows[..cut].concat());
        sets.push(rows[rows.len() - cut..].concat());
    }
    if rows.len() > 1 {
        sets.push(rows.concat());
    }
    sets
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
