//! A quantity over the refractive index, as a small plot.

use std::fmt::Write;

use leptos::prelude::*;
use snellius::scan::KnownKind;

use crate::number::fixed;
use crate::run::{CurveKind, StudyCurve};

const WIDTH: f64 = 360.0;
const HEIGHT: f64 = 190.0;
const LEFT: f64 = 52.0;
const RIGHT: f64 = 10.0;
const TOP: f64 = 10.0;
const BOTTOM: f64 = 36.0;

/// What a curve shows: its title, and its unit with a space before it.
const fn words(kind: CurveKind) -> (&'static str, &'static str) {
    match kind {
        CurveKind::RayDistance => ("Mean ray distance, eq. (3)", " mm"),
        CurveKind::WeightedRayDistance => ("Ray distance over its \u{3c3}, robust", ""),
        CurveKind::Known(KnownKind::PlaneAngle) => ("Angle of two faces, eq. (4)", "\u{b0}"),
        CurveKind::Known(KnownKind::EdgeLength) => ("Length of an edge, eq. (4)", " mm"),
        CurveKind::Known(KnownKind::Flatness) => ("Unevenness of a flat face, RMS", " mm"),
        CurveKind::Known(KnownKind::Radius) => ("Radius, eq. (4)", " mm"),
    }
}

/// Where indices and quantities lie in the plot.
#[derive(Clone, Copy)]
struct Axes {
    across: (f64, f64),
    up: (f64, f64),
}

impl Axes {
    fn of(curve: &StudyCurve) -> Self {
        let quantities = curve.points.iter().map(|(_, value)| *value);
        Self {
            across: range(curve.points.iter().map(|(index, _)| *index)),
            up: range(quantities.chain(curve.known)),
        }
    }

    fn x(&self, index: f64) -> f64 {
        let part = (index - self.across.0) / (self.across.1 - self.across.0);
        LEFT + part.clamp(0.0, 1.0) * (WIDTH - LEFT - RIGHT)
    }

    fn y(&self, value: f64) -> f64 {
        let part = (value - self.up.0) / (self.up.1 - self.up.0);
        HEIGHT - BOTTOM - part * (HEIGHT - TOP - BOTTOM)
    }
}

/// The least and the greatest, never the same.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    if low < high {
        (low, high)
    } else if low.is_finite() {
        (low - 0.5, low + 0.5)
    } else {
        (0.0, 1.0)
    }
}

/// The curve, its minimum, the interval of the index, and where the present index stands.
#[component]
pub(super) fn CurvePlot(curve: StudyCurve, present: Memo<Option<f64>>) -> impl IntoView {
    let axes = Axes::of(&curve);
    let (title, unit) = words(curve.kind);
    let told = {
        let curve = curve.clone();
        move || told(&curve, unit, present.get())
    };
    let marker = {
        let curve = curve.clone();
        move || {
            let index = present.get()?;
            let at = (axes.x(index), axes.y(curve.at(index)?));
            Some(view! {
                <line class="present" x1=at.0 x2=at.0 y1=TOP y2=HEIGHT - BOTTOM />
                <circle class="present" cx=at.0 cy=at.1 r="4" />
            })
        }
    };
    let test_id = match curve.kind {
        CurveKind::RayDistance => "curve-ray-distance",
        CurveKind::WeightedRayDistance => "curve-weighted",
        CurveKind::Known(_) => "curve-known",
    };
    view! {
        <figure class="index-curve" data-testid=test_id>
            <figcaption>{title}</figcaption>
            <svg viewBox=format!("0 0 {WIDTH} {HEIGHT}") role="img" aria-label=format!("{title}, over the index")>
                {interval(&curve, axes)} {ticks(axes, unit)}
                {curve
                    .known
                    .map(|known| {
                        let y = axes.y(known);
                        view! { <line class="known" x1=LEFT x2=WIDTH - RIGHT y1=y y2=y /> }
                    })}
                <path class="curve" d=line(&curve, axes) />
                {curve
                    .minimum
                    .map(|(index, value)| {
                        view! { <circle class="minimum" cx=axes.x(index) cy=axes.y(value) r="4" /> }
                    })} {marker}
            </svg>
            <p class="help">{told}</p>
        </figure>
    }
}

/// Where the index lies 95 times in 100.
fn interval(curve: &StudyCurve, axes: Axes) -> impl IntoView + use<> {
    curve.interval.map(|interval| {
        let [from, to] = interval.map(|index| axes.x(index));
        let width = (to - from).max(1.0);
        view! { <rect class="interval" x=from y=TOP width=width height=HEIGHT - TOP - BOTTOM /> }
    })
}

fn line(curve: &StudyCurve, axes: Axes) -> String {
    let mut d = String::new();
    for (i, (index, value)) in curve.points.iter().enumerate() {
        let command = if i == 0 { 'M' } else { 'L' };
        let _ = write!(d, "{command}{:.1} {:.1}", axes.x(*index), axes.y(*value));
    }
    d
}

fn ticks(axes: Axes, unit: &'static str) -> impl IntoView + use<> {
    let foot = HEIGHT - BOTTOM;
    let between = |(low, high): (f64, f64), step: i32| low + (high - low) * f64::from(step) / 4.0;
    let spread = axes.up.1 - axes.up.0;
    let digits = [10.0, 1.0, 0.1]
        .iter()
        .filter(|d| spread < **d * 4.0)
        .count();
    let across = (0..=4).map(|step| {
        let index = between(axes.across, step);
        let x = axes.x(index);
        view! {
            <line class="tick" x1=x x2=x y1=foot y2=foot + 4.0 />
            <text x=x y=foot + 16.0 text-anchor="middle">
                {fixed(index, 2)}
            </text>
        }
    });
    let up = (0..=4).step_by(2).map(|step| {
        let value = between(axes.up, step);
        let y = axes.y(value);
        view! {
            <line class="tick" x1=LEFT - 4.0 x2=LEFT y1=y y2=y />
            <text x=LEFT - 7.0 y=y + 4.0 text-anchor="end">
                {fixed(value, digits)}
            </text>
        }
    });
    let unit = unit.trim();
    view! {
        <path class="axes" d=format!("M{LEFT} {TOP}V{foot}H{}", WIDTH - RIGHT) />
        {across.collect_view()}
        {up.collect_view()}
        <text x=LEFT + 6.0 y=TOP + 8.0>
            {unit}
        </text>
        <text x=WIDTH - RIGHT y=HEIGHT - 4.0 text-anchor="end">
            "refractive index n"
        </text>
    }
}

/// The plot in words.
fn told(curve: &StudyCurve, unit: &str, present: Option<f64>) -> String {
    let mut words = Vec::new();
    let value = |value: f64| format!("{}{unit}", fixed(value, 3));
    if let Some((index, at)) = present.and_then(|n| Some((n, curve.at(n)?))) {
        words.push(format!("At n = {} it is {}.", fixed(index, 3), value(at)));
    }
    match (curve.known, curve.kind) {
        (_, CurveKind::Known(KnownKind::Flatness)) | (None, _) => {}
        (Some(known), _) => words.push(format!("It ought to be {}.", value(known))),
    }
    let has_minimum = match curve.kind {
        CurveKind::Known(kind) => kind == KnownKind::Flatness,
        CurveKind::RayDistance | CurveKind::WeightedRayDistance => true,
    };
    if has_minimum {
        words.push(match curve.minimum {
            Some(_) => "The dot is its minimum, worth no more than the table says.".to_owned(),
            None => "It is least at an end of the range, which tells nothing.".to_owned(),
        });
    }
    if let Some([low, high]) = curve.interval {
        let least = curve.points.first().map_or(low, |first| first.0);
        let most = curve.points.last().map_or(high, |last| last.0);
        words.push(if low <= least && high >= most {
            "The interval covers the whole range.".to_owned()
        } else {
            format!(
                "Shaded: the index lies between {} and {} 95 times in 100.",
                fixed(low, 3),
                fixed(high, 3)
            )
        });
    }
    words.join(" ")
}
