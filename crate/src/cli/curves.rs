//! Curves over the index as files: a table, and a drawing.

use std::fmt::Write as _;

use crate::index::IndexCurve;

/// A curve and what to say of it.
pub(super) struct Drawn<'a> {
    pub(super) name: String,
    /// What the vertical axis shows.
    pub(super) quantity: String,
    pub(super) curve: &'a IndexCurve,
    /// A value of the quantity that is known.
    pub(super) level: Option<f64>,
    /// The interval in which the index lies 95 times in 100.
    pub(super) interval: Option<[f64; 2]>,
}

/// The curve as a table.
pub(super) fn csv(drawn: &Drawn) -> String {
    let mut text = format!("index,{}\n", drawn.quantity);
    for (index, value) in drawn.curve.index.iter().zip(&drawn.curve.value) {
        let value = value.map_or_else(String::new, |value| value.to_string());
        let _ = writeln!(text, "{index},{value}");
    }
    text
}

const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 400.0;
const LEFT: f64 = 70.0;
const RIGHT: f64 = 20.0;
const TOP: f64 = 20.0;
const BOTTOM: f64 = 50.0;

/// The curve as a drawing.
pub(super) fn svg(drawn: &Drawn) -> String {
    let points: Vec<(f64, f64)> = drawn
        .curve
        .index
        .iter()
        .zip(&drawn.curve.value)
        .filter_map(|(index, value)| Some((*index, (*value)?)))
        .collect();
    let across = range(points.iter().map(|p| p.0));
    let up = range(points.iter().map(|p| p.1).chain(drawn.level));
    let x = |index: f64| LEFT + (index - across.0) / (across.1 - across.0) * (WIDTH - LEFT - RIGHT);
    let y = |value: f64| HEIGHT - BOTTOM - (value - up.0) / (up.1 - up.0) * (HEIGHT - TOP - BOTTOM);
    let (left, right, top, bottom) = (LEFT, WIDTH - RIGHT, TOP, HEIGHT - BOTTOM);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" \
         font-family=\"sans-serif\" font-size=\"12\">\n\
         <rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"white\"/>\n"
    );
    if let Some([low, high]) = drawn.interval {
        let (from, to) = (x(low.max(across.0)), x(high.min(across.1)));
        let (wide, high) = ((to - from).max(1.0), bottom - top);
        let _ = writeln!(
            svg,
            "<rect x=\"{from:.1}\" y=\"{top}\" width=\"{wide:.1}\" height=\"{high}\" fill=\"#cfe3f5\"/>"
        );
    }
    if let Some(level) = drawn.level {
        let at = y(level);
        let _ = writeln!(
            svg,
            "<path d=\"M{left} {at:.1}H{right}\" stroke=\"#b35900\" stroke-dasharray=\"5 4\"/>"
        );
    }
    let line: Vec<String> = points
        .iter()
        .map(|(index, value)| format!("{:.1},{:.1}", x(*index), y(*value)))
        .collect();
    let _ = writeln!(
        svg,
        "<polyline points=\"{}\" fill=\"none\" stroke=\"#0b5394\" stroke-width=\"2\"/>\n\
         <path d=\"M{left} {top}V{bottom}H{right}\" fill=\"none\" stroke=\"black\"/>",
        line.join(" ")
    );
    for tick in ticks(across) {
        let _ = writeln!(
            svg,
            "<path d=\"M{0:.1} {bottom}v5\" stroke=\"black\"/>\
             <text x=\"{0:.1}\" y=\"{1}\" text-anchor=\"middle\">{tick:.2}</text>",
            x(tick),
            bottom + 18.0
        );
    }
    for tick in ticks(up) {
        let _ = writeln!(
            svg,
            "<path d=\"M{left} {0:.1}h-5\" stroke=\"black\"/>\
             <text x=\"{1}\" y=\"{2:.1}\" text-anchor=\"end\">{tick:.3}</text>",
            y(tick),
            left - 8.0,
            y(tick) + 4.0
        );
    }
    let _ = writeln!(
        svg,
        "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">refractive index</text>\n\
         <text transform=\"translate(14 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n</svg>",
        0.5 * (left + right),
        HEIGHT - 10.0,
        0.5 * (top + bottom),
        drawn.quantity
    );
    svg
}

/// The least and greatest of some values, never the same.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let bounds = |(low, high): (f64, f64), value: f64| (low.min(value), high.max(value));
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), bounds);
    if low < high {
        (low, high)
    } else if low.is_finite() {
        (low - 0.5, low + 0.5)
    } else {
        (0.0, 1.0)
    }
}

/// Four to nine round numbers within a range.
fn ticks((low, high): (f64, f64)) -> Vec<f64> {
    let rough = (high - low) / 5.0;
    let ten = libm::pow(10.0, libm::floor(libm::log10(rough)));
    let steps = [1.0, 2.0, 5.0, 10.0].map(|round| round * ten);
    let step = steps
        .into_iter()
        .find(|step| *step >= rough)
        .unwrap_or(rough);
    let first = (low / step).ceil() as i64;
    let last = (high / step).floor() as i64;
    (first..=last).map(|i| i as f64 * step).collect()
}
