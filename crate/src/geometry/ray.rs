use super::{Direction, Frame, Point};

/// A half-line: a laser beam or a line of sight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray<F: Frame> {
    /// Where it starts.
    pub origin: Point<F>,
    /// Where it goes.
    pub direction: Direction<F>,
}

impl<F: Frame> Ray<F> {
    /// The ray from `origin` along `direction`.
    pub const fn new(origin: Point<F>, direction: Direction<F>) -> Self {
        Self { origin, direction }
    }

    /// The point `distance` millimetres along the ray.
    pub fn at(&self, distance: f64) -> Point<F> {
        self.origin + self.direction * distance
    }
}
