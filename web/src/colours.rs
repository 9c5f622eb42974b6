//! Colours that carry a value: a viridis map for quantities, colour-blind-safe hues for sweeps.

use crate::run::{Facts, Outcome, ViewOutcome};
use crate::state::ColourBy;

/// What the colours of a result mean.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Scale {
    /// A quantity from `low` to `high`, with the colours at both ends of the map.
    Quantity {
        name: &'static str,
        unit: &'static str,
        low: f64,
        high: f64,
    },
    /// So many sweeps.
    Sweeps(usize),
}

impl Scale {
    /// The scale that fits a result.
    pub(crate) fn of(facts: &Facts, outcome: &Outcome, by: ColourBy) -> Self {
        let (name, unit) = match by {
            ColourBy::Sweep => return Self::Sweeps(facts.sweeps),
            ColourBy::RayDistance => ("Ray distance", "mm"),
            ColourBy::Depth => ("Depth behind the wall", "mm"),
        };
        let values = outcome.views.iter().flat_map(|view| values(view, by));
        let (low, high) = values.fold((f64::MAX, f64::MIN), |(low, high), value| {
            (low.min(*value), high.max(*value))
        });
        let (low, high) = if low <= high { (low, high) } else { (0.0, 0.0) };
        Self::Quantity {
            name,
            unit,
            low,
            high,
        }
    }

    /// The colour of a view's point, if it has the value.
    pub(crate) fn colour(
        &self,
        facts: &Facts,
        outcome: &Outcome,
        by: ColourBy,
        (view, point): (usize, usize),
    ) -> Option<[u8; 3]> {
        match self {
            Self::Quantity { low, high, .. } => {
                let value = values(&outcome.views[view], by).get(point)?;
                Some(viridis(fraction(*value, *low, *high)))
            }
            Self::Sweeps(_) => Some(hue(facts.stations[view].sweep)),
        }
    }
}

/// What a view's points are coloured by.
fn values(view: &ViewOutcome, by: ColourBy) -> &[f64] {
    match by {
        ColourBy::Depth => &view.depth,
        _ => view.result.ray_distance.as_slice(),
    }
}

fn fraction(value: f64, low: f64, high: f64) -> f64 {
    if high > low {
        (value - low) / (high - low)
    } else {
        0.5
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

/// The colour at a fraction of the map.
fn viridis(fraction: f64) -> [u8; 3] {
    let steps = (VIRIDIS.len() - 1) as f64;
    let place = fraction.clamp(0.0, 1.0) * steps;
    let below = (place as usize).min(VIRIDIS.len() - 2);
    let rest = place - below as f64;
    std::array::from_fn(|i| {
        let (from, to) = (VIRIDIS[below][i], VIRIDIS[below + 1][i]);
        (f64::from(from) + rest * (f64::from(to) - f64::from(from))).round() as u8
    })
}

/// The map as a CSS gradient, from low to high.
pub(crate) fn viridis_gradient() -> String {
    let anchors = VIRIDIS.map(css);
    format!("linear-gradient(to right, {})", anchors.join(", "))
}

/// The hues of Okabe and Ito, which the common kinds of colour blindness keep apart; the first ones are
/// those that differ most.
const HUES: [[u8; 3]; 7] = [
    [0, 114, 178],
    [230, 159, 0],
    [0, 158, 115],
    [204, 121, 167],
    [86, 180, 233],
    [213, 94, 0],
    [240, 228, 66],
];

/// The colour of a sweep.
pub(crate) fn hue(sweep: usize) -> [u8; 3] {
    HUES[sweep % HUES.len()]
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
