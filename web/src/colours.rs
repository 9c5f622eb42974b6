//! Colours that carry a value: colour-blind-safe maps for quantities and hues for sweeps.

use snellius::plot::sweep_colour;

use crate::run::{Facts, ObjectPoint, Outcome, VesselPoint};
use crate::state::ColourBy;

/// What the colours of a result mean.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Scale {
    /// A quantity, with the colours at both ends of the map.
    Quantity(Quantity),
    /// So many sweeps.
    Sweeps(usize),
}

/// A quantity from `low` to `high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Quantity {
    pub(crate) name: &'static str,
    pub(crate) unit: &'static str,
    pub(crate) low: f32,
    pub(crate) high: f32,
    pub(crate) map: Map,
}

/// From a number to a colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Map {
    /// From little to much.
    Viridis,
    /// Either way from nothing.
    BothWays,
}

/// Where on the scale a point is that has no value: it is never hidden by it.
pub(crate) const MIDDLE: f32 = 0.5;

impl Scale {
    /// The scale that fits a result.
    pub(crate) fn of(facts: &Facts, outcome: &Outcome, by: ColourBy) -> Self {
        let name = match by {
            ColourBy::Sweep => return Self::Sweeps(facts.sweeps),
            ColourBy::RayDistance => "Ray distance",
            ColourBy::Sigma => "Standard deviation",
            ColourBy::Depth => "Depth behind the wall",
            ColourBy::Residual => "Wall residual, + towards the rig",
        };
        let values = values(outcome, by);
        let (low, high) = values.fold((f32::MAX, f32::MIN), |(low, high), value| {
            (low.min(value), high.max(value))
        });
        let (low, high) = if low <= high { (low, high) } else { (0.0, 0.0) };
        let (low, high, map) = if by == ColourBy::Residual {
            let most = usual_most(outcome).min(high.max(-low));
            (-most, most, Map::BothWays)
        } else {
            (low, high, Map::Viridis)
        };
        Self::Quantity(Quantity {
            name,
            unit: "mm",
            low,
            high,
            map,
        })
    }

    /// The colour of a point of the object, and where it lies on the scale (0 to 1); `None` where the
    /// colours are about other points.
    pub(crate) fn of_object(
        &self,
        facts: &Facts,
        by: ColourBy,
        point: &ObjectPoint,
    ) -> Option<([u8; 3], f32)> {
        match self {
            Self::Quantity(quantity) => Some(quantity.colour(value(by, point)?)),
            Self::Sweeps(_) => Some((hue(facts.stations[point.view].sweep), MIDDLE)),
        }
    }

    /// Likewise, of a point of the wall.
    pub(crate) fn of_vessel(&self, by: ColourBy, point: &VesselPoint) -> Option<([u8; 3], f32)> {
        match self {
            Self::Quantity(quantity) if by == ColourBy::Residual => {
                Some(quantity.colour(point.residual))
            }
            _ => None,
        }
    }
}

/// One wild point shall not take the colours from all others: the scale of the residuals ends a little
/// beyond nine tenths of them.
fn usual_most(outcome: &Outcome) -> f32 {
    let mut sizes: Vec<f32> = values(outcome, ColourBy::Residual).map(f32::abs).collect();
    let ninth = sizes.len() * 9 / 10;
    if ninth >= sizes.len() {
        return 0.0;
    }
    1.5 * *sizes.select_nth_unstable_by(ninth, f32::total_cmp).1
}

/// What a point of the object has of a quantity.
pub(crate) fn value(by: ColourBy, point: &ObjectPoint) -> Option<f32> {
    match by {
        ColourBy::RayDistance => Some(point.ray_distance),
        ColourBy::Sigma => Some(point.sigma()),
        ColourBy::Depth => Some(point.depth),
        ColourBy::Sweep | ColourBy::Residual => None,
    }
}

/// All values of a quantity.
pub(crate) fn values(outcome: &Outcome, by: ColourBy) -> impl Iterator<Item = f32> + '_ {
    let of_object = outcome.object.iter().filter_map(move |p| value(by, p));
    let of_vessel = outcome.vessel.iter().map(|point| point.residual);
    of_object.chain(of_vessel.filter(move |_| by == ColourBy::Residual))
}

impl Quantity {
    /// The colour of a value, and where it lies from `low` (0) to `high` (1).
    fn colour(&self, value: f32) -> ([u8; 3], f32) {
        let fraction = self.fraction(value).clamp(0.0, 1.0);
        (self.map.at(fraction), fraction)
    }

    /// Where a value lies from `low` (0) to `high` (1).
    pub(crate) fn fraction(&self, value: f32) -> f32 {
        if self.high > self.low {
            (value - self.low) / (self.high - self.low)
        } else {
            MIDDLE
        }
    }
}

impl Map {
    const fn anchors(self) -> &'static [[u8; 3]] {
        match self {
            Self::Viridis => &VIRIDIS,
            Self::BothWays => &PURPLE_ORANGE,
        }
    }

    /// The colour at a fraction of the map.
    pub(crate) fn at(self, fraction: f32) -> [u8; 3] {
        let anchors = self.anchors();
        let place = fraction.clamp(0.0, 1.0) * (anchors.len() - 1) as f32;
        let below = (place as usize).min(anchors.len() - 2);
        let rest = place - below as f32;
        std::array::from_fn(|i| {
            let (from, to) = (
                f32::from(anchors[below][i]),
                f32::from(anchors[below + 1][i]),
            );
            (from + rest * (to - from)).round() as u8
        })
    }

    /// The map as a CSS gradient, from low to high.
    pub(crate) fn gradient(self) -> String {
        let anchors: Vec<_> = self.anchors().iter().copied().map(css).collect();
        format!("linear-gradient(to right, {})", anchors.join(", "))
    }
}

/// Anchors of Matplotlib's viridis (public domain, CC0), an eighth apart.
const VIRIDIS: [[u8; 3]; 9] = [
    [68, 1, 84],
    [71, 45, 123],
    [59, 82, 139],
    [44, 114, 142],
    [33, 145, 140],
    [40, 174, 128],
    [94, 201, 98],
    [173, 220, 48],
    [253, 231, 37],
];

/// ColorBrewer's PuOr turned round (C. Brewer, Apache License 2.0): purple below nothing, orange above.
const PURPLE_ORANGE: [[u8; 3]; 9] = [
    [84, 39, 136],
    [128, 115, 172],
    [178, 171, 210],
    [216, 218, 235],
    [247, 247, 247],
    [254, 224, 182],
    [253, 184, 99],
    [224, 130, 20],
    [179, 88, 6],
];

/// The colour of a sweep, in the scene as in the plots.
pub(crate) fn hue(sweep: usize) -> [u8; 3] {
    sweep_colour(sweep as u32)
}

/// A colour as CSS writes it.
pub(crate) fn css([red, green, blue]: [u8; 3]) -> String {
    format!("rgb({red} {green} {blue})")
}

/// Whether the system asks for a dark page.
pub(crate) fn is_dark() -> bool {
    asks("(prefers-color-scheme: dark)")
}

/// Whether the system asks for little motion.
pub(crate) fn wants_little_motion() -> bool {
    asks("(prefers-reduced-motion: reduce)")
}

fn asks(query: &str) -> bool {
    web_sys::window()
        .and_then(|window| window.match_media(query).ok().flatten())
        .is_some_and(|list| list.matches())
}
