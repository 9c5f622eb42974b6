//! Figures in a plane.

use plotters::chart::{ChartBuilder, ChartContext};
use plotters::coord::cartesian::Cartesian2d;
use plotters::drawing::IntoDrawingArea;
use plotters::element::{Circle, PathElement, Rectangle};
use plotters::style::{Color, IntoFont, ShapeStyle, TextStyle};

use super::canvas::{Canvas, LETTERS, UNITS, file};
use super::figure::{Dot, Figure, Layer, words};
use super::paint::Ink;
use super::scale::Scale;
use super::{Drawing, Mark, PlotError};

type Chart<'a, 'b> = ChartContext<'a, Canvas<'b>, Cartesian2d<Scale, Scale>>;

/// Room for the numbers and names of the axes, and at the other ends, px.
const LEFT: u32 = 64;
const BOTTOM: u32 = 42;
const TOP: u32 = 10;
const RIGHT: u32 = 22;

/// More dots are not told apart in a figure: of more, every so many-th is drawn. The table has all.
pub(super) const MOST_DOTS: usize = 4000;

impl Figure {
    /// Draws it, so many px wide and high.
    pub fn draw(&self, size: [u32; 2]) -> Result<Drawing, PlotError> {
        let mut svg = String::new();
        let marks = self.draw_into(&mut svg, size)?;
        Ok(Drawing {
            title: self.title.clone(),
            svg: file(&self.title, size, &svg),
            size,
            marks,
        })
    }

    fn draw_into(&self, svg: &mut String, size: [u32; 2]) -> Result<Vec<Mark>, PlotError> {
        let [width, height] = [
            size[0].saturating_sub(LEFT + RIGHT),
            size[1].saturating_sub(TOP + BOTTOM),
        ];
        if width == 0 || height == 0 {
            return Err(PlotError::Room("there is no room for a drawing".to_owned()));
        }
        let [x, y] = self.ranges([f64::from(width), f64::from(height)])?;
        let area = Canvas::new(svg, size).into_drawing_area();
        // Numbers about every 45 px across and 32 px upwards, or up to two and a half times that.
        let across = Scale::new(x, (f64::from(width) / 45.0).max(4.0));
        let upwards = Scale::new(y, (f64::from(height) / 32.0).max(4.0));
        let mut chart = ChartBuilder::on(&area)
            .margin_top(TOP * UNITS)
            .margin_right(RIGHT * UNITS)
            .x_label_area_size(BOTTOM * UNITS)
            .y_label_area_size(LEFT * UNITS)
            .build_cartesian_2d(across, upwards)?;
        let text = letters();
        chart
            .configure_mesh()
            .bold_line_style(stroke(Ink::Grid, 1.0))
            .axis_style(stroke(Ink::Axis, 1.0))
            .set_all_tick_mark_size(4 * UNITS)
            .label_style(text.clone())
            .axis_desc_style(text)
            .x_desc(self.x.label())
            .y_desc(self.y.label())
            .draw()?;
        for layer in &self.layers {
            draw_layer(&chart, layer, [x, y])?;
        }
        Ok(self.marks(&chart))
    }

    /// The axes' ranges in a drawing area of some px.
    fn ranges(&self, [width, height]: [f64; 2]) -> Result<[[f64; 2]; 2], PlotError> {
        let values = self.layers.iter().flat_map(Layer::values);
        let values: Vec<[f64; 2]> = values.chain(self.within.iter().copied()).collect();
        let levels = self.layers.iter().filter_map(|layer| match layer {
            Layer::Level(value) => Some(*value),
            _ => None,
        });
        let x = extent(values.iter().map(|at| at[0])).ok_or(PlotError::Nothing)?;
        let y = extent(values.iter().map(|at| at[1]).chain(levels)).ok_or(PlotError::Nothing)?;
        let has_bars = self.layers.iter().any(|l| matches!(l, Layer::Bars(_)));
        let is_curve = self.layers.iter().any(|layer| {
            matches!(
                layer,
                Layer::Line {
                    series: Some(_),
                    ..
                }
            )
        });
        // A curve goes from side to side, and bars stand on the axis.
        let x = if is_curve { x } else { padded(x) };
        let y = match (has_bars, padded(y)) {
            (true, [_, high]) => [0.0, high],
            (false, y) => y,
        };
        Ok(if self.equal {
            let per_px = ((x[1] - x[0]) / width).max((y[1] - y[0]) / height);
            [widened(x, per_px * width), widened(y, per_px * height)]
        } else {
            [x, y]
        })
    }

    fn marks(&self, chart: &Chart) -> Vec<Mark> {
        let place = |at: [f64; 2]| {
            let (x, y) = chart.backend_coord(&(at[0], at[1]));
            [x, y].map(|part| part as f32 / UNITS as f32)
        };
        let told = |at: [f64; 2]| {
            let [x, y] = [(&self.x, at[0]), (&self.y, at[1])];
            [x, y].map(|(axis, value)| format!("{} {}", axis.name, axis.told(value)))
        };
        let of_dot = |dot: &Dot, series: &'static str| {
            let value = self.value.as_ref().zip(dot.value);
            let value = value.map(|(axis, value)| format!("{} {}", axis.name, axis.told(value)));
            words(
                &self.views,
                (dot.view, series),
                value.into_iter().chain(told(dot.at)),
            )
        };
        let mut marks = Vec::new();
        for layer in &self.layers {
            match layer {
                Layer::Dots { series, dots, .. } => marks.extend(few(dots).map(|dot| Mark {
                    at: place(dot.at),
                    view: dot.view,
                    words: of_dot(dot, series),
                })),
                Layer::Line {
                    series: Some(_),
                    points,
                    ..
                } => marks.extend(points.iter().map(|at| Mark {
                    at: place(*at),
                    view: None,
                    words: words(&[], (None, ""), told(*at)),
                })),
                Layer::Bars(bars) => marks.extend(bars.iter().map(|bar| {
                    let [from, to] = bar.across.map(|x| self.x.told(x));
                    Mark {
                        at: place([0.5 * (bar.across[0] + bar.across[1]), 0.5 * bar.height]),
                        view: bar.view,
                        words: format!(
                            "{} {from} to {to}: {}",
                            self.x.name,
                            self.y.told(bar.height)
                        ),
                    }
                })),
                Layer::Line { .. } | Layer::Band(_) | Layer::Level(_) => {}
            }
        }
        marks
    }
}

impl Layer {
    /// What must be within the axes.
    fn values(&self) -> Vec<[f64; 2]> {
        match self {
            Self::Line {
                series: Some(_),
                points,
                ..
            } => points.clone(),
            Self::Dots { dots, .. } => dots.iter().map(|dot| dot.at).collect(),
            Self::Bars(bars) => {
                let corners = |bar: &super::Bar| bar.across.map(|x| [x, bar.height]);
                bars.iter().flat_map(corners).collect()
            }
            Self::Line { .. } | Self::Band(_) | Self::Level(_) => Vec::new(),
        }
    }
}

fn draw_layer(chart: &Chart, layer: &Layer, [x, y]: [[f64; 2]; 2]) -> Result<(), PlotError> {
    let area = chart.plotting_area();
    match layer {
        Layer::Band(band) => {
            let [from, to] = band.map(|value| value.clamp(x[0], x[1]));
            // However narrow, it is seen.
            let least = 0.003 * (x[1] - x[0]);
            let to = to.max(from + least);
            let corners = [(from, y[1]), (to, y[0])];
            area.draw(&Rectangle::new(corners, fill(Ink::Band)))?;
        }
        Layer::Level(value) => {
            let ends = vec![(x[0], *value), (x[1], *value)];
            area.draw(&PathElement::new(ends, stroke(Ink::Known, 1.4)))?;
        }
        Layer::Line { ink, points, .. } => {
            let width = if *ink == Ink::Wall { 1.2 } else { 2.0 };
            for run in runs(points, [x, y]) {
                area.draw(&PathElement::new(run, stroke(*ink, width)))?;
            }
        }
        Layer::Dots { radius, dots, .. } => {
            let radius = (radius * f64::from(UNITS)) as u32;
            for dot in few(dots) {
                let at = (dot.at[0], dot.at[1]);
                area.draw(&Circle::new(at, radius, fill(dot.ink)))?;
            }
        }
        Layer::Bars(bars) => {
            for bar in bars.iter().filter(|bar| bar.height > 0.0) {
                let [from, to] = bar.across;
                let gap = 0.04 * (to - from);
                let corners = [(from + gap, bar.height), (to - gap, 0.0)];
                area.draw(&Rectangle::new(corners, fill(Ink::Curve)))?;
            }
        }
    }
    Ok(())
}

/// As many dots as are told apart.
pub(super) fn few<T>(dots: &[T]) -> impl Iterator<Item = &T> {
    dots.iter().step_by(dots.len().div_ceil(MOST_DOTS).max(1))
}

/// The parts of a line that lie within the axes.
fn runs(points: &[[f64; 2]], [x, y]: [[f64; 2]; 2]) -> Vec<Vec<(f64, f64)>> {
    let inside = |at: &[f64; 2]| (x[0]..=x[1]).contains(&at[0]) && (y[0]..=y[1]).contains(&at[1]);
    points
        .split(|at| !inside(at))
        .filter(|run| run.len() > 1)
        .map(|run| run.iter().map(|at| (at[0], at[1])).collect())
        .collect()
}

/// The least and the greatest.
pub(super) fn extent(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    let [low, high] = values
        .filter(|value| value.is_finite())
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
            [low.min(value), high.max(value)]
        });
    // One value alone has a neighbourhood, too.
    match high - low {
        spread if spread > 1e-12 => Some([low, high]),
        spread if spread >= 0.0 => Some([low - 0.5, high + 0.5]),
        _ => None,
    }
}

pub(super) fn padded([low, high]: [f64; 2]) -> [f64; 2] {
    let margin = 0.05 * (high - low);
    [low - margin, high + margin]
}

fn widened([low, high]: [f64; 2], length: f64) -> [f64; 2] {
    let middle = 0.5 * (low + high);
    [middle - 0.5 * length, middle + 0.5 * length]
}

pub(super) fn stroke(ink: Ink, px: f64) -> ShapeStyle {
    ink.colour().stroke_width((px * f64::from(UNITS)) as u32)
}

pub(super) fn fill(ink: Ink) -> ShapeStyle {
    ink.colour().filled()
}

pub(super) fn letters() -> TextStyle<'static> {
    ("sans-serif", LETTERS * UNITS)
        .into_font()
        .color(&Ink::Text.colour())
}
