use super::{Direction, Frame, Point, Ray};

/// A plane with a side: its normal points to the front.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane<F: Frame> {
    /// A point of the plane.
    pub point: Point<F>,
    /// The unit normal.
    pub normal: Direction<F>,
}

impl<F: Frame> Plane<F> {
    /// The plane through `point` across `normal`.
    pub const fn new(point: Point<F>, normal: Direction<F>) -> Self {
        Self { point, normal }
    }

    /// The distance of `point`, positive in front.
    pub fn signed_distance(&self, point: Point<F>) -> f64 {
        (point - self.point).dot(&self.normal.vector())
    }

    /// The parallel plane `distance` in front (behind, if negative).
    pub fn offset(&self, distance: f64) -> Self {
        Self::new(self.point + self.normal * distance, self.normal)
    }

    /// How far along the line that carries `ray` the plane is met; `None` if they are parallel.
    pub fn distance_along(&self, ray: &Ray<F>) -> Option<f64> {
        let closing = -ray.direction.dot(self.normal);
        let along = self.signed_distance(ray.origin) / closing;
        along.is_finite().then_some(along)
    }
}
