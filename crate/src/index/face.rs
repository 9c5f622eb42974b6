//! Faces of the object that several points share.

use nalgebra::DVector;

use crate::geometry::{Direction, Point, World};
use crate::optics::Surface;

/// A face of the object, as the points show it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Face {
    /// The surface.
    pub(super) surface: Surface,
    /// How much longer than its surface it may be drawn out along `axis`: what a wrong index does to a
    /// face seen from one side. A flat face stays flat under it and has none; where the radius of a round
    /// face is known it is 0.
    pub(super) stretch: Option<f64>,
    /// The direction of the stretch.
    pub(super) axis: Direction<World>,
    /// Which of the object's sights lie on it.
    pub(super) members: Vec<usize>,
}

impl Face {
    /// How far in front of the face a point lies, mm.
    pub(super) fn distance(&self, point: Point<World>) -> f64 {
        let Some((stretch, centre)) = self.stretch.zip(self.centre()) else {
            return self.surface.signed_distance(point);
        };
        let along = (point - centre).dot(&self.axis.vector());
        let back = self.axis * (along * (1.0 / (1.0 + stretch) - 1.0));
        self.surface.signed_distance(point + back)
    }

    fn centre(&self) -> Option<Point<World>> {
        match &self.surface {
            Surface::Sphere(sphere) => Some(sphere.centre),
            Surface::Cylinder(cylinder) => Some(cylinder.point),
            Surface::Plane(_) | Surface::Freeform(_) => None,
        }
    }

    /// How many numbers move it.
    pub(super) fn freedom(&self) -> usize {
        self.surface.freedom() + usize::from(self.stretch.is_some())
    }

    /// The face with one of its numbers moved.
    pub(super) fn nudged(&self, number: usize, step: f64) -> Self {
        let mut face = self.clone();
        if number < self.surface.freedom() {
            let mut steps = DVector::zeros(self.surface.freedom());
            steps[number] = step;
            face.surface = self.surface.nudged(&steps);
        } else if let Some(stretch) = &mut face.stretch {
            *stretch += step;
        }
        face
    }
}
