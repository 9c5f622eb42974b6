use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use crate::camera::Pixel;

/// Pixels at even steps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Grid {
    /// The first node, px.
    pub start: [f64; 2],
    /// From node to node, px.
    pub step: f64,
    /// Nodes across.
    pub columns: usize,
    /// Nodes down.
    pub rows: usize,
}

impl Grid {
    /// The grid over a part of the picture, px: at least four nodes each way.
    pub(super) fn over(low: Vector2<f64>, high: Vector2<f64>, step: f64) -> Self {
        let nodes = |extent: f64| ((extent / step).ceil() as usize + 1).max(4);
        Self {
            start: low.into(),
            step,
            columns: nodes(high.x - low.x),
            rows: nodes(high.y - low.y),
        }
    }

    /// How many nodes.
    pub const fn len(&self) -> usize {
        self.columns * self.rows
    }

    /// Whether there are none.
    pub const fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The pixel of a node.
    pub fn pixel(&self, node: usize) -> Pixel {
        self.place((node % self.columns) as f64, (node / self.columns) as f64)
    }

    /// The pixel at a place given in steps from the first node.
    pub(super) fn place(&self, across: f64, down: f64) -> Pixel {
        Pixel::new(
            self.start[0] + across * self.step,
            self.start[1] + down * self.step,
        )
    }

    /// The 4 x 4 nodes around a pixel with the weights of cubic Lagrange interpolation. At the border, and
    /// where a node is not `usable`, the square is moved aside as long as it still holds the pixel; `None`
    /// where it cannot be.
    pub(super) fn stencil(
        &self,
        pixel: Pixel,
        usable: impl Fn(usize) -> bool,
    ) -> Option<[(usize, f64); 16]> {
        let across = (pixel.u - self.start[0]) / self.step;
        let down = (pixel.v - self.start[1]) / self.step;
        let firsts = |at: f64, nodes: usize| {
            let cell = at.floor();
            let inside = at >= 0.0 && at <= (nodes - 1) as f64;
            // The cell in the middle of the square first, then at its sides.
            let candidates = [cell - 1.0, cell, cell - 2.0, cell - 3.0];
            let fits = move |first: &f64| inside && *first >= 0.0 && *first as usize + 4 <= nodes;
            candidates
                .into_iter()
                .filter(fits)
                .map(|first| first as usize)
        };
        for row in firsts(down, self.rows) {
            for column in firsts(across, self.columns) {
                let node = |i: usize| (row + i / 4) * self.columns + column + i % 4;
                if (0..16).all(|i| usable(node(i))) {
                    let (u, v) = (
                        lagrange(across - column as f64),
                        lagrange(down - row as f64),
                    );
                    return Some(std::array::from_fn(|i| (node(i), u[i % 4] * v[i / 4])));
                }
            }
        }
        None
    }
}

/// The four cubics through nodes at 0, 1, 2, 3, at a place.
fn lagrange(t: f64) -> [f64; 4] {
    let (a, b, c, d) = (t, t - 1.0, t - 2.0, t - 3.0);
    [
        -b * c * d / 6.0,
        a * c * d / 2.0,
        -a * b * d / 2.0,
        a * b * c / 6.0,
    ]
}
