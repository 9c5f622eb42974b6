//! A grid below the scene, along the world's axes, with its millimetres.

use three_d::{InnerSpace, Vec3, vec3};

use super::labels::Label;
use super::lines::Line;

/// A level grid of round millimetres.
pub(super) struct Grid {
    /// The two axes along which it runs.
    axes: [GridAxis; 2],
    /// The axis across it, and where it lies on that.
    across: usize,
    level: f32,
}

struct GridAxis {
    axis: usize,
    /// The ends, in steps.
    first: i32,
    last: i32,
    step: f32,
    /// Whether the end at `last` is the one towards the viewer.
    near_is_last: bool,
}

const NAMES: [&str; 3] = ["x", "y", "z"];

impl Grid {
    /// A grid below all `places`; `front` says where the viewer starts.
    pub(super) fn below(places: &[Vec3], up: Vec3, front: Vec3) -> Option<Self> {
        let axis_along = |i: usize| component(up, i).abs();
        let across = (0..3).max_by(|a, b| axis_along(*a).total_cmp(&axis_along(*b)))?;
        let range = |i: usize| {
            let values = places.iter().map(|p| component(*p, i));
            values.fold((f32::MAX, f32::MIN), |(low, high), v| {
                (low.min(v), high.max(v))
            })
        };
        let others: Vec<usize> = (0..3).filter(|i| *i != across).collect();
        let widest = others
            .iter()
            .map(|i| range(*i).1 - range(*i).0)
            .fold(0.0, f32::max);
        if !(widest > 0.0 && widest.is_finite()) {
            return None;
        }
        let step = round_step(widest / 5.0);
        let right = up.cross(front);
        let axis = |i: usize| {
            let (low, high) = range(i);
            GridAxis {
                axis: i,
                first: (low / step).floor() as i32,
                last: (high / step).ceil() as i32,
                step,
                near_is_last: component(front * 2.0 + right, i) > 0.0,
            }
        };
        let (low, high) = range(across);
        let lowest = if component(up, across) > 0.0 {
            low
        } else {
            high
        };
        Some(Self {
            axes: [axis(others[0]), axis(others[1])],
            across,
            level: lowest,
        })
    }

    pub(super) fn lines(&self, colour: [f32; 4]) -> Vec<Line> {
        let [a, b] = &self.axes;
        let along = |one: &GridAxis, other: &GridAxis| {
            let ends = (other.at(other.first), other.at(other.last));
            let line = |i| {
                let place = |end| self.place(one, one.at(i), other, end);
                Line::new(place(ends.0), place(ends.1), colour)
            };
            (one.first..=one.last).map(line).collect::<Vec<_>>()
        };
        [along(a, b), along(b, a)].concat()
    }

    /// The millimetres along the two edges towards the viewer, and the axes' names at their ends.
    pub(super) fn labels(&self) -> Vec<Label> {
        let [a, b] = &self.axes;
        let along = |one: &GridAxis, other: &GridAxis| {
            let beside = other.near_end() + 0.3 * other.step.copysign(other.outwards());
            let text = |i: i32| {
                let value = one.at(i);
                let far_end = if one.near_is_last {
                    one.first
                } else {
                    one.last
                };
                let name = NAMES[one.axis];
                if i == far_end {
                    format!("{name} {value} mm")
                } else {
                    format!("{value}")
                }
            };
            let label = |i| Label {
                place: self.place(one, one.at(i), other, beside),
                text: text(i),
            };
            (one.first..=one.last).map(label).collect::<Vec<_>>()
        };
        [along(a, b), along(b, a)].concat()
    }

    fn place(&self, one: &GridAxis, at_one: f32, other: &GridAxis, at_other: f32) -> Vec3 {
        let mut place = [0.0; 3];
        place[one.axis] = at_one;
        place[other.axis] = at_other;
        place[self.across] = self.level;
        place.into()
    }
}

impl GridAxis {
    fn at(&self, steps: i32) -> f32 {
        steps as f32 * self.step
    }

    fn near_end(&self) -> f32 {
        self.at(if self.near_is_last {
            self.last
        } else {
            self.first
        })
    }

    fn outwards(&self) -> f32 {
        if self.near_is_last { 1.0 } else { -1.0 }
    }
}

fn component(vector: Vec3, axis: usize) -> f32 {
    let unit = [
        vec3(1.0, 0.0, 0.0),
        vec3(0.0, 1.0, 0.0),
        vec3(0.0, 0.0, 1.0),
    ];
    vector.dot(unit[axis])
}

/// The nearest of 1, 2, 5, 10, 20, ... that is not smaller.
fn round_step(at_least: f32) -> f32 {
    let power = 10.0_f32.powf(at_least.log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0];
    let step = steps.iter().find(|s| **s * power >= at_least);
    step.copied().unwrap_or(10.0) * power
}
