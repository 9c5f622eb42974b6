use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::camera::Pixel;
use crate::geometry::{Camera, Direction, Plane, Point, Ray};

/// The laser of a range finder, in the camera frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Laser {
    /// A thin beam: one spot on every surface that it meets.
    Beam(Ray<Camera>),
    /// A sheet of light: a line on every surface.
    Sheet(Sheet),
}

/// A flat fan of light, as a lens in front of a laser spreads it.
///
/// How a ray of it bends at a face depends on the ray's direction within the sheet, so the place that
/// the rays come from belongs to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sheet {
    /// The apex of the fan: every ray of the sheet starts here, mm.
    pub apex: Point<Camera>,
    /// The unit normal of the sheet; its side means nothing.
    pub normal: Direction<Camera>,
}

/// The pixels that a profile across the sheet's line is taken from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Profiles {
    /// One profile a row: the line runs down the picture rather than across.
    Rows,
    /// One profile a column.
    Columns,
}

impl Profiles {
    /// The pixel at a place in a profile.
    pub const fn pixel(self, profile: f64, at: f64) -> Pixel {
        match self {
            Self::Rows => Pixel::new(at, profile),
            Self::Columns => Pixel::new(profile, at),
        }
    }

    /// The pixel's profile, and the place in it.
    pub const fn place(self, pixel: Pixel) -> (f64, f64) {
        match self {
            Self::Rows => (pixel.v, pixel.u),
            Self::Columns => (pixel.u, pixel.v),
        }
    }

    /// The pixel so much farther along its profile.
    pub fn moved(self, pixel: Pixel, step: f64) -> Pixel {
        let (profile, at) = self.place(pixel);
        self.pixel(profile, at + step)
    }
}

impl Laser {
    /// Where the light comes from, mm.
    pub const fn origin(&self) -> Point<Camera> {
        match self {
            Self::Beam(beam) => beam.origin,
            Self::Sheet(sheet) => sheet.apex,
        }
    }

    /// The ray that lights a point in air: the beam itself, or the sheet's ray towards the point.
    /// `None` for the apex itself.
    pub fn ray_to(&self, point: Point<Camera>) -> Option<Ray<Camera>> {
        match self {
            Self::Beam(beam) => Some(*beam),
            Self::Sheet(sheet) => sheet.ray_to(point),
        }
    }

    /// The beam itself, or the ray of a sheet that runs the most as the camera looks.
    pub fn axis(&self) -> Ray<Camera> {
        match self {
            Self::Beam(beam) => *beam,
            Self::Sheet(sheet) => sheet.axis(),
        }
    }

    /// The laser with its origin off by a vector, mm.
    pub(super) fn moved(self, by: Vector3<f64>) -> Self {
        match self {
            Self::Beam(beam) => Self::Beam(Ray::new(beam.origin + by, beam.direction)),
            Self::Sheet(sheet) => Self::Sheet(Sheet {
                apex: sheet.apex + by,
                ..sheet
            }),
        }
    }

    /// The laser turned by small angles, radians, towards the two tangents of the beam, or of the
    /// sheet's normal.
    pub(super) fn tilted(self, a: f64, b: f64) -> Self {
        match self {
            Self::Beam(beam) => Self::Beam(Ray::new(beam.origin, beam.direction.tilted(a, b))),
            Self::Sheet(sheet) => Self::Sheet(Sheet {
                normal: sheet.normal.tilted(a, b),
                ..sheet
            }),
        }
    }
}

impl Sheet {
    /// The plane that carries the sheet.
    pub const fn plane(&self) -> Plane<Camera> {
        Plane::new(self.apex, self.normal)
    }

    /// The sheet's ray towards a point, or towards its foot where it does not lie in the sheet; `None`
    /// for the apex itself.
    pub fn ray_to(&self, point: Point<Camera>) -> Option<Ray<Camera>> {
        let off = self.plane().signed_distance(point);
        let along = point - self.apex - self.normal * off;
        Some(Ray::new(self.apex, Direction::new(along).ok()?))
    }

    /// The sheet's ray that runs the most as the camera looks.
    pub fn axis(&self) -> Ray<Camera> {
        let normal = self.normal.vector();
        let ahead = Vector3::z() - normal * normal.z;
        // A sheet across the line of sight has none ahead; any will do.
        let direction = Direction::new(ahead)
            .unwrap_or_else(|_| Direction::assume_unit(self.normal.tangents().0));
        Ray::new(self.apex, direction)
    }

    /// The ray of the sheet at an angle from its axis, radians.
    pub fn ray_at(&self, angle: f64) -> Ray<Camera> {
        let ahead = self.axis().direction.vector();
        let aside = self.normal.vector().cross(&ahead);
        let turned = ahead * libm::cos(angle) + aside * libm::sin(angle);
        Ray::new(self.apex, Direction::assume_unit(turned))
    }

    /// The angle of the ray towards a point, as [`Sheet::ray_at`] counts it.
    pub fn angle_of(&self, point: Point<Camera>) -> f64 {
        let ahead = self.axis().direction.vector();
        let aside = self.normal.vector().cross(&ahead);
        let to = point - self.apex;
        libm::atan2(to.dot(&aside), to.dot(&ahead))
    }

    /// Along which pixels the line moves with the distance of what it falls on.
    pub fn profiles(&self) -> Profiles {
        let normal = self.normal.vector();
        if normal.x.abs() >= normal.y.abs() {
            Profiles::Rows
        } else {
            Profiles::Columns
        }
    }
}
