//! An axis as plotters asks for it: from values to places, and where numbers stand.

use std::ops::Range;

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};

use super::ticks::{label, ticks};

/// A linear axis with round numbers. plotters' own looks for them by platform mathematics.
#[derive(Clone)]
pub(super) struct Scale {
    range: [f64; 2],
    ticks: Vec<f64>,
}

impl Scale {
    /// A range with about so many numbers.
    pub(super) fn new(range: [f64; 2], count: f64) -> Self {
        Self {
            range,
            ticks: ticks(range, count),
        }
    }
}

impl Ranged for Scale {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (from, to): (i32, i32)) -> i32 {
        let part = (value - self.range[0]) / (self.range[1] - self.range[0]);
        (f64::from(from) + part * f64::from(to - from)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if hint.weight().allow_light_points() {
            Vec::new()
        } else {
            self.ticks.clone()
        }
    }

    fn range(&self) -> Range<f64> {
        self.range[0]..self.range[1]
    }
}

impl ValueFormatter<f64> for Scale {
    fn format(value: &f64) -> String {
        label(*value)
    }
}
