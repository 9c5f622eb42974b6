//! Curves and dots over the refractive index.

use snellius::lab::known_shape::RANGE;

use super::drawing::{At, Drawing};

/// The size of a chart, px.
pub(super) const SIZE: At = [420.0, 210.0];
const LEFT: f64 = 52.0;
const RIGHT: f64 = 12.0;
const TOP: f64 = 14.0;
const BOTTOM: f64 = 34.0;

/// A chart over the index, as it is drawn.
pub(super) struct Chart {
    drawing: Drawing,
    y: (f64, f64),
}

impl Chart {
    /// Axes with numbers; `y` is the range upwards.
    pub(super) fn new(y: (f64, f64), decimals: usize) -> Self {
        let mut chart = Self {
            drawing: Drawing::default(),
            y,
        };
        for step in 0..=4 {
            let value = y.0 + f64::from(step) * 0.25 * (y.1 - y.0);
            let [left, height] = chart.at(RANGE.0, value);
            chart
                .drawing
                .line("grid", [left, height], [SIZE[0] - RIGHT, height]);
            let text = format!("{value:.decimals$}");
            chart
                .drawing
                .text("tick end", [left - 6.0, height + 4.0], &text);
        }
        for tenth in 9..=18 {
            let index = f64::from(tenth) / 10.0;
            let at = chart.at(index, y.0);
            chart.drawing.line("grid", at, [at[0], at[1] + 4.0]);
            if tenth % 2 == 1 || tenth == 18 {
                let text = format!("{index:.1}");
                chart
                    .drawing
                    .text("tick middle", [at[0], at[1] + 17.0], &text);
            }
        }
        chart.drawing.text(
            "tick end",
            [SIZE[0] - RIGHT, SIZE[1] - 3.0],
            "refractive index n",
        );
        chart
    }

    fn at(&self, index: f64, value: f64) -> At {
        let across = (index - RANGE.0) / (RANGE.1 - RANGE.0);
        let up = (value - self.y.0) / (self.y.1 - self.y.0);
        [
            LEFT + across * (SIZE[0] - LEFT - RIGHT),
            SIZE[1] - BOTTOM - up.clamp(-0.02, 1.02) * (SIZE[1] - TOP - BOTTOM),
        ]
    }

    pub(super) fn curve(&mut self, class: &str, points: &[(f64, f64)]) {
        let places: Vec<At> = points
            .iter()
            .map(|(n, value)| self.at(*n, *value))
            .collect();
        self.drawing.path(class, &places, false);
    }

    /// An upright at an index, with a word at its head: on its left for what is tried, or else on its
    /// right, so that the two do not meet.
    pub(super) fn upright(&mut self, class: &str, index: f64, word: &str) {
        let (foot, head) = (self.at(index, self.y.0), self.at(index, self.y.1));
        self.drawing.line(class, foot, head);
        let left = class == "trial" && index > RANGE.0 + 0.15;
        let (side, aside) = if left {
            ("tick end", -5.0)
        } else {
            ("tick", 5.0)
        };
        self.drawing
            .text(side, [head[0] + aside, head[1] + 9.0], word);
    }

    pub(super) fn level(&mut self, class: &str, value: f64) {
        let (from, to) = (self.at(RANGE.0, value), self.at(RANGE.1, value));
        self.drawing.line(class, from, to);
    }

    pub(super) fn dot(&mut self, class: &str, index: f64, value: f64, radius: f64) {
        let at = self.at(index, value);
        self.drawing.circle(class, at, radius);
    }

    pub(super) fn text_of(self) -> String {
        self.drawing.text_of()
    }
}
