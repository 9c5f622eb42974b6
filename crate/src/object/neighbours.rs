//! The surface that neighbouring views make, against which a view's spots are held.
//!
//! A small ray distance is no proof: a reflection that happens to lie on the beam's image passes, with a
//! depth that is off by centimetres. But surfaces are smooth nearly everywhere, and the beams of nearby
//! stations land side by side. Seen along a view's beam, two neighbours at the places s_a, s_b beside it
//! (s = 0) and the depths t_a, t_b foretell the depth
//!
//! ```text
//! t = (t_a s_b - t_b s_a) / (s_b - s_a),   off by at most  1/2 |s_a s_b| k (1 + m^2)^(3/2)
//! ```
//!
//! on a surface of curvature k and slope m (the error of a chord). Every pair of neighbours that has the
//! beam on its line foretells a depth of its own, and of those along one axis across the beam a spot need
//! agree with one alone: so at an edge the face on either side speaks for its own points, and a step or an
//! outline costs nothing as long as two neighbours lie on the same side. What curvature is usual, the scan
//! itself tells.

use nalgebra::Vector3;

use super::{Meeting, Noise};
use crate::geometry::{Point, Ray, World};

/// A view's beam behind the wall, and a place on it where the object may be.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// The point.
    pub(super) point: Point<World>,
    /// One standard deviation of its depth along the beam, mm.
    pub(super) sigma: f64,
    /// The probability that the object is there.
    pub(super) trust: f64,
}

impl Place {
    pub(super) fn new(meeting: &Meeting, noise: &Noise, beam: &Ray<World>) -> Self {
        let along = beam.direction.vector();
        let variance = (along.transpose() * noise.covariance * along).x;
        Self {
            point: meeting.point(),
            sigma: variance.sqrt(),
            trust: 1.0,
        }
    }

    /// A place that is the object's with that probability only.
    pub(super) fn trusted(self, trust: f64) -> Self {
        Self { trust, ..self }
    }
}

/// What the neighbours say of a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Misfit {
    /// How far behind (or before, if negative) the foretold place along the beam, mm.
    pub(super) off: f64,
    /// One standard deviation of that, mm.
    pub(super) sigma: f64,
    /// The probability that those who foretell it lie on the object themselves.
    pub(super) trust: f64,
}

impl Misfit {
    /// How much likelier the place is on the object than to be a ghost's, which lies anywhere: as a
    /// logarithm.
    ///
    /// The object is where the forecast says, but for an edge between; and there were a few forecasts to
    /// choose from.
    pub(super) fn favour(&self) -> f64 {
        let trust = (1.0 - EDGE) * self.trust;
        libm::log(1.0 - trust + trust * self.likelihood())
    }

    /// How much likelier the place is where the forecast holds than as a ghost's, which lies anywhere.
    fn likelihood(&self) -> f64 {
        /// Ghosts seem to lie anywhere within this, mm.
        const ANYWHERE: f64 = 100.0;
        /// Forecasts of an axis that differ.
        const CHOICE: f64 = 3.0;
        /// Student's density at 0.
        const TOP: f64 = 0.353_553_390_593_273_8;
        TOP * self.student() / self.sigma * ANYWHERE / CHOICE
    }

    /// How well the place agrees, as a logarithm: 0 where it is as foretold. Unlike [`Misfit::favour`] it
    /// does not reward a forecast for being sharp, so that it compares one place in different media.
    pub(super) fn agreement(&self) -> f64 {
        libm::log(EDGE + (1.0 - EDGE) * self.student())
    }

    /// Student's distribution with two degrees of freedom, 1 at its top: where a surface bends more than
    /// elsewhere, a forecast is off by more than its sigma more often than a normal distribution allows.
    fn student(&self) -> f64 {
        let z = self.off / self.sigma;
        let tail = 1.0 + 0.5 * z * z;
        1.0 / (tail * tail.sqrt())
    }
}

/// How often an edge of the object spoils the forecasts of an axis.
const EDGE: f64 = 0.3;
/// Along the sweep, across it, and between.
const AXES: usize = 4;
/// As many neighbours are asked on each side: two make a line.
const EACH_SIDE: usize = 3;
/// No surface is as smooth as its points are exact: texture, mm.
const TEXTURE: f64 = 0.15;
/// Faces steeper than this against the beam are hardly lit.
const STEEPEST: f64 = 4.0;

/// A depth foretold by two neighbours.
#[derive(Clone, Copy, Debug)]
struct Forecast {
    depth: f64,
    /// Variance from the neighbours' own, and from their line's passing beside the beam, mm^2.
    variance: f64,
    /// The probability that the neighbours lie on the object.
    trust: f64,
    /// What the error of the chord is for a curvature of 1 / mm, mm.
    chord: f64,
}

/// A neighbour, as seen along a beam.
#[derive(Clone, Copy, Debug)]
struct Beside {
    across: Vector3<f64>,
    /// How far across, squared.
    square: f64,
    depth: f64,
    sigma: f64,
    trust: f64,
}

/// What a view's neighbours foretell for it, by the axis across the beam along which they lie.
pub(super) struct Forecasts {
    beam: Ray<World>,
    axes: [Vec<Forecast>; AXES],
}

impl Forecasts {
    /// Asks the neighbours: on every side those of `others` that lie nearest to the beam.
    pub(super) fn of(beam: &Ray<World>, others: impl Iterator<Item = Place>) -> Self {
        let beside: Vec<Beside> = others.map(|place| seen_along(beam, place)).collect();
        Self {
            beam: *beam,
            axes: axes(beam, &beside).map(|beside| forecasts(&beside)),
        }
    }

    /// How a place agrees with the forecast of each axis that suits it best. Forecasts more uncertain than
    /// `vaguest`, mm, are left out.
    pub(super) fn hold(&self, place: &Place, curvature: f64, vaguest: f64) -> Vec<Misfit> {
        let depth = (place.point - self.beam.origin).dot(&self.beam.direction.vector());
        let own = place.sigma * place.sigma + TEXTURE * TEXTURE;
        let of_axis = |forecasts: &Vec<Forecast>| {
            let misfits = forecasts.iter().filter_map(|forecast| {
                let bend = curvature * forecast.chord;
                let sigma = (own + forecast.variance + bend * bend).sqrt();
                (sigma < vaguest).then_some(Misfit {
                    off: depth - forecast.depth,
                    sigma,
                    trust: forecast.trust,
                })
            });
            misfits.max_by(|a, b| a.favour().total_cmp(&b.favour()))
        };
        self.axes.iter().filter_map(of_axis).collect()
    }
}

/// The views whose places lie around a beam, from which neighbours are taken in whatever medium they turn
/// out to be: all, or in a large scan on every side the nearest of them.
pub(super) fn around(view: usize, beam: &Ray<World>, places: &[Option<Place>]) -> Vec<usize> {
    /// Four times as many as are asked, for the places move when the medium changes.
    const EACH: usize = 4 * EACH_SIDE;
    let (views, beside): (Vec<usize>, Vec<Beside>) = places
        .iter()
        .enumerate()
        .filter(|(other, _)| *other != view)
        .filter_map(|(other, place)| Some((other, seen_along(beam, (*place)?))))
        .unzip();
    if views.len() <= EACH * SIDES {
        return views;
    }
    let mut around: Vec<usize> = sides(beam, &beside, EACH).concat();
    around.sort_unstable();
    around.into_iter().map(|index| views[index]).collect()
}

const SIDES: usize = 2 * AXES;

/// Sorts neighbours by the axis across the beam on which they lie: that of the nearest one, the one at
/// right angles to it, and those between. On each side of an axis the nearest few count.
fn axes(beam: &Ray<World>, beside: &[Beside]) -> [Vec<Beside>; AXES] {
    let sides = sides(beam, beside, EACH_SIDE);
    let of_side = |side: usize| sides[side].iter().map(|index| beside[*index]);
    std::array::from_fn(|axis| of_side(axis).chain(of_side(axis + AXES)).collect())
}

/// On every side of the beam the nearest `each` neighbours, by their index, the nearest first.
///
/// One pass, as this is done for every view of what may be thousands: once every side has its fill, of most
/// neighbours not more is looked at than how far away they are.
fn sides(beam: &Ray<World>, beside: &[Beside], each: usize) -> [Vec<usize>; SIDES] {
    let mut sides: [Vec<usize>; SIDES] = Default::default();
    let by_distance = |a: &&Beside, b: &&Beside| a.square.total_cmp(&b.square);
    let Some(nearest) = beside.iter().min_by(by_distance) else {
        return sides;
    };
    let upwards = beam.direction.vector().cross(&nearest.across);
    let mut too_far = f64::INFINITY;
    for (index, neighbour) in beside.iter().enumerate() {
        if neighbour.square >= too_far {
            continue;
        }
        let (x, y) = (
            neighbour.across.dot(&nearest.across) * nearest.across.norm(),
            neighbour.across.dot(&upwards),
        );
        let side = &mut sides[side(x, y)];
        let nearer = |other: &usize| beside[*other].square <= neighbour.square;
        side.insert(side.partition_point(nearer), index);
        side.truncate(each);
        let last = |side: &Vec<usize>| side.get(each - 1).map(|last| beside[*last].square);
        let lasts = sides.iter().map(|side| last(side).unwrap_or(f64::INFINITY));
        too_far = lasts.fold(0.0, f64::max);
    }
    sides
}

/// In which of the eight directions a place lies, each an eighth of the turn about an axis or between two.
fn side(x: f64, y: f64) -> usize {
    /// The tangent of half an eighth.
    const HALF: f64 = 0.414_213_562_373_095_03;
    let (far_x, far_y) = (x.abs(), y.abs());
    if far_y <= HALF * far_x {
        return if x >= 0.0 { 0 } else { 4 };
    }
    if far_x <= HALF * far_y {
        return if y >= 0.0 { 2 } else { 6 };
    }
    match (x >= 0.0, y >= 0.0) {
        (true, true) => 1,
        (false, true) => 3,
        (false, false) => 5,
        (true, false) => 7,
    }
}

/// What the misfits along several axes say together: either every axis speaks for itself, or the place is at
/// an edge or on the object's outline, where one of them is right and the others say nothing. Where nobody
/// foretells anything, nothing speaks for a place nor against it.
pub(super) fn together(misfits: &[Misfit]) -> f64 {
    /// How many points of an object lie beside an edge.
    const BESIDE_EDGE: f64 = 0.3;
    if misfits.is_empty() {
        return 0.0;
    }
    let all: f64 = misfits.iter().map(Misfit::favour).sum();
    let right = |misfit: &Misfit| 1.0 - misfit.trust + misfit.trust * misfit.likelihood();
    let one = misfits.iter().map(right).sum::<f64>() / misfits.len() as f64;
    libm::log((1.0 - BESIDE_EDGE) * libm::exp(all) + BESIDE_EDGE * one)
}

/// The curvature under which the places that were chosen agree best with each other, 1/mm.
pub(super) fn usual_curvature(
    forecasts: &[Option<Forecasts>],
    places: &[Option<Place>],
    vaguest: f64,
) -> f64 {
    /// From 5 m to 20 mm of radius, in doubles.
    const FLATTEST: f64 = 2e-4;
    const DOUBLES: i32 = 9;
    let agreement = |curvature: f64| -> f64 {
        let views = forecasts.iter().zip(places);
        views
            .filter_map(|(forecasts, place)| {
                Some(together(&forecasts.as_ref()?.hold(
                    place.as_ref()?,
                    curvature,
                    vaguest,
                )))
            })
            .sum()
    };
    let curvatures = (0..DOUBLES).map(|power| FLATTEST * f64::from(1 << power));
    curvatures
        .map(|curvature| (agreement(curvature), curvature))
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map_or(FLATTEST, |(_, curvature)| curvature)
}

fn seen_along(beam: &Ray<World>, place: Place) -> Beside {
    let from = place.point - beam.origin;
    let depth = from.dot(&beam.direction.vector());
    let across = from - beam.direction.vector() * depth;
    Beside {
        across,
        square: across.norm_squared(),
        depth,
        sigma: place.sigma,
        trust: place.trust,
    }
}

/// What the neighbours along an axis foretell: every two of them, and the nearest one by itself.
fn forecasts(beside: &[Beside]) -> Vec<Forecast> {
    let pairs = beside.iter().enumerate();
    let of_two = pairs.flat_map(|(i, a)| beside[i + 1..].iter().filter_map(|b| forecast(a, b)));
    let of_one = beside.iter().map(|neighbour| {
        // The surface may rise as fast as it reaches.
        let rise = neighbour.across.norm();
        Forecast {
            depth: neighbour.depth,
            variance: neighbour.sigma * neighbour.sigma + rise * rise,
            trust: neighbour.trust,
            chord: 0.0,
        }
    });
    let nearest = of_one.min_by(|a, b| a.variance.total_cmp(&b.variance));
    of_two.chain(nearest).collect()
}

/// What two neighbours foretell; `None` where their line leads nowhere near the beam.
fn forecast(a: &Beside, b: &Beside) -> Option<Forecast> {
    /// A line may pass this part of its shorter arm beside the beam.
    const BESIDE: f64 = 0.35;
    /// And reach out this many times its own length.
    const REACH: f64 = 2.5;
    let line = b.across - a.across;
    let length = line.norm();
    let along = line / length;
    let (sa, sb) = (a.across.dot(&along), b.across.dot(&along));
    let beside = (a.across - along * sa).norm();
    let near = sa.abs().min(sb.abs());
    let slope = (b.depth - a.depth) / length;
    let fits = beside <= BESIDE * near && sa.abs().max(sb.abs()) <= REACH * length;
    // `fits` is false for a length of zero, which makes everything not a number.
    if !fits || slope.abs() > STEEPEST {
        return None;
    }
    let (wa, wb) = (sb / length, -sa / length);
    let noise = |weight: f64, sigma: f64| weight * weight * (sigma * sigma + TEXTURE * TEXTURE);
    let steep = (1.0 + slope * slope).sqrt();
    Some(Forecast {
        depth: wa * a.depth + wb * b.depth,
        // Across its line the surface may rise as it does along it.
        variance: noise(wa, a.sigma) + noise(wb, b.sigma) + (0.5 * beside) * (0.5 * beside),
        trust: a.trust * b.trust,
        chord: 0.5 * (sa * sb).abs() * steep * steep * steep,
    })
}

#[cfg(test)]
mod tests {
    use super::side;

    #[test]
    fn a_place_lies_on_the_side_of_its_angle() {
        for degrees in -180..540 {
            let angle = f64::from(degrees).to_radians();
            let expected = libm::round(f64::from(degrees + 360) / 45.0) as usize % 8;
            let there = side(3.0 * libm::cos(angle), 3.0 * libm::sin(angle));
            assert_eq!(there, expected, "{degrees} degrees");
        }
    }
}
