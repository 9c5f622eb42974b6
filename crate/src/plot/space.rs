//! Figures in space: a box with axes, seen from above and aside.

use plotters::chart::ChartBuilder;
use plotters::coord::ranged3d::ProjectionMatrix;
use plotters::drawing::IntoDrawingArea;
use plotters::element::{Circle, Text};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, TRANSPARENT};

use super::canvas::{Canvas, UNITS, file};
use super::figure::{Axis, SpaceFigure, words};
use super::flat::{MOST_DOTS, extent, few, fill, letters, padded, stroke};
use super::paint::Ink;
use super::scale::Scale;
use super::{Drawing, Mark, PlotError};
use crate::robust::sort_by_number;

/// Where it is seen from: so far aside and above, radians.
const YAW: f64 = 0.6;
const PITCH: f64 = 0.45;

/// The box's greatest size as a part of the drawing's least: turned, its corners need the rest.
const SHARE: f64 = 0.62;

/// The rows that make of a place in the box (right, up, away) one in the drawing (right, down) and how far
/// away it is. plotters' own matrices come from platform mathematics.
fn projection(middle: [f64; 3], place: [f64; 2]) -> ProjectionMatrix {
    let (sin_yaw, cos_yaw) = libm::sincos(YAW);
    let (sin_pitch, cos_pitch) = libm::sincos(PITCH);
    let right = [cos_yaw, 0.0, sin_yaw];
    // By depth plotters chooses the edges that carry numbers: of those below, the nearest. Height shall not
    // count, but for telling floor from ceiling.
    let away = [-sin_yaw, -0.01, cos_yaw];
    let down = [sin_yaw * sin_pitch, -cos_pitch, -cos_yaw * sin_pitch];
    let row = |axis: [f64; 3], at: f64| {
        let moved = at - (0..3).map(|i| axis[i] * middle[i]).sum::<f64>();
        [axis[0], axis[1], axis[2], moved]
    };
    ProjectionMatrix::from([
        row(right, place[0]),
        row(down, place[1]),
        row(away, 0.0),
        [0.0, 0.0, 0.0, 1.0],
    ])
}

impl SpaceFigure {
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
        let of = |axis: usize| extent(self.dots.iter().map(|dot| dot.at[axis])).map(padded);
        let (Some(x), Some(y), Some(z)) = (of(0), of(1), of(2)) else {
            return Err(PlotError::Nothing);
        };
        let lengths = [x, y, z].map(|[low, high]| high - low);
        let longest = lengths.into_iter().fold(0.0, f64::max);
        let room = f64::from(size[0].min(size[1]) * UNITS) * SHARE;
        let [width, height, depth] = lengths.map(|length| (length / longest * room) as i32);
        let scale = |range: [f64; 2]| {
            let length = (range[1] - range[0]) / longest * room / f64::from(UNITS);
            Scale::new(range, (length / 50.0).max(1.5))
        };
        let area = Canvas::new(svg, size).into_drawing_area();
        let mut chart = ChartBuilder::on(&area).build_cartesian_3d(scale(x), scale(y), scale(z))?;
        chart.set_3d_pixel_range((width.max(1), height.max(1), depth.max(1)));
        let middle_px = size.map(|side| f64::from(side * UNITS) / 2.0);
        let box_middle = [width, height, depth].map(|side| f64::from(side) / 2.0);
        chart.with_projection(|_| projection(box_middle, middle_px));
        let text = letters();
        chart
            .configure_axes()
            .axis_panel_style(fill(Ink::Panel))
            .bold_grid_style(stroke(Ink::Grid, 1.0))
            .light_grid_style(TRANSPARENT.stroke_width(0))
            .tick_size(4 * UNITS)
            .label_style(text.clone())
            .draw()?;
        let drawing = chart.plotting_area();
        let radius = if self.dots.len() > MOST_DOTS {
            1.2
        } else {
            2.4
        };
        // What is farther away is drawn first.
        let mut dots: Vec<_> = few(&self.dots).collect();
        sort_by_number(&mut dots, |dot| -dot.at[2]);
        for dot in &dots {
            let at = (dot.at[0], dot.at[1], dot.at[2]);
            let circle = Circle::new(at, (radius * f64::from(UNITS)) as u32, fill(dot.ink));
            drawing.draw(&circle)?;
        }
        let name = |axis: &Axis, at: (f64, f64, f64), aside: [i32; 2], pos: Pos| {
            let (across, down) = drawing.map_coordinate(&at);
            let [right, lower] = aside.map(|px| px * UNITS as i32);
            // Wholly within the drawing.
            let (letters, _) = area.estimate_text_size(&axis.label(), &text)?;
            let half = letters.div_ceil(2) as i32;
            let last = (size[0] * UNITS) as i32 - half;
            let at = ((across + right).clamp(half, last.max(half)), down + lower);
            area.draw(&Text::new(axis.label(), at, text.clone().pos(pos)))
        };
        let [x_axis, y_axis, z_axis] = &self.axes;
        let middle = |[low, high]: [f64; 2]| 0.5 * (low + high);
        let (below, above) = (
            Pos::new(HPos::Center, VPos::Top),
            Pos::new(HPos::Center, VPos::Bottom),
        );
        name(x_axis, (middle(x), y[0], z[0]), [-30, 34], below)?;
        name(z_axis, (x[1], y[0], middle(z)), [62, 32], below)?;
        name(y_axis, (x[0], y[1], z[0]), [0, -8], above)?;
        let mark = |dot: &&super::SpaceDot| {
            let (across, down) = drawing.map_coordinate(&(dot.at[0], dot.at[1], dot.at[2]));
            let told = [0, 1, 2].map(|axis| {
                let (axis, value) = (&self.axes[axis], dot.at[axis]);
                format!("{} {}", axis.name, axis.told(value))
            });
            Mark {
                at: [across, down].map(|part| part as f32 / UNITS as f32),
                view: dot.view,
                words: words(&self.views, (dot.view, dot.series), told),
            }
        };
        Ok(dots.iter().map(mark).collect())
    }
}
