//! What is known of the object, eq. (4): an angle between two planes, an edge, a flat face, a radius.

use super::IndexError;
use super::face::Face;
use crate::geometry::{Plane, Point, World};
use crate::optics::Surface;
use crate::scan::{KnownKind, KnownShape, Manifest};

/// A known shape as the manifest states it, checked.
#[derive(Clone, Debug, PartialEq)]
pub struct Known {
    /// Its place in the manifest's list.
    pub entry: usize,
    /// What it is.
    pub kind: KnownKind,
    /// K of eq. (4): radians or mm; 0 for a flat face.
    pub value: f64,
    /// Alpha of eq. (4).
    pub weight: f64,
    /// The views of each face, where they are given.
    pub views: Option<Vec<Vec<usize>>>,
}

/// A known shape of weight 1 is taken to be made this exactly: mm, and degrees of an angle. Another
/// weight is the inverse of the variance, so it divides this by its root.
pub const KNOWN_TOLERANCE: f64 = 0.05;

impl Known {
    /// Checks the manifest's known shapes. Those of weight 0 are left out.
    pub fn of(manifest: &Manifest) -> Result<Vec<Self>, IndexError> {
        let all = manifest.known.iter().enumerate();
        let checked: Vec<Self> = all
            .map(|(entry, shape)| Self::new(entry, shape, manifest))
            .collect::<Result<_, _>>()?;
        if !checked.is_empty() && checked.iter().all(|known| known.weight == 0.0) {
            return Err(IndexError::AllWeightsZero);
        }
        Ok(checked.into_iter().filter(|k| k.weight > 0.0).collect())
    }

    fn new(entry: usize, shape: &KnownShape, manifest: &Manifest) -> Result<Self, IndexError> {
        let needed = |value: Option<f64>, key: &'static str, range: (f64, f64)| {
            let inside = |v: &f64| *v > range.0 && *v < range.1;
            value.filter(inside).ok_or(IndexError::KnownValue {
                entry,
                key,
                least: range.0,
                greatest: range.1,
            })
        };
        let value = match shape.kind {
            KnownKind::PlaneAngle => needed(shape.degrees, "degrees", (0.0, 180.0))?.to_radians(),
            KnownKind::EdgeLength | KnownKind::Radius => needed(shape.mm, "mm", (0.0, 1e5))?,
            KnownKind::Flatness => 0.0,
        };
        if !(shape.weight >= 0.0 && shape.weight.is_finite()) {
            return Err(IndexError::Weight {
                entry,
                weight: shape.weight,
            });
        }
        let views = shape.views.as_ref();
        let views = views.map(|faces| faces_of_views(entry, shape.kind, faces, manifest));
        Ok(Self {
            entry,
            kind: shape.kind,
            value,
            weight: shape.weight,
            views: views.transpose()?,
        })
    }

    /// One standard deviation of what is known.
    pub(super) fn sigma(&self) -> f64 {
        let exact = match self.kind {
            KnownKind::PlaneAngle => KNOWN_TOLERANCE.to_radians(),
            _ => KNOWN_TOLERANCE,
        };
        exact / self.weight.sqrt()
    }
}

/// How many faces a known shape is about.
pub(super) const fn faces_needed(kind: KnownKind) -> usize {
    match kind {
        KnownKind::PlaneAngle | KnownKind::EdgeLength => 2,
        KnownKind::Flatness | KnownKind::Radius => 1,
    }
}

fn faces_of_views(
    entry: usize,
    kind: KnownKind,
    faces: &[Vec<String>],
    manifest: &Manifest,
) -> Result<Vec<Vec<usize>>, IndexError> {
    if faces.len() != faces_needed(kind) {
        return Err(IndexError::FaceCount {
            entry,
            needed: faces_needed(kind),
            found: faces.len(),
        });
    }
    let view = |id: &String| {
        let position = manifest.views.iter().position(|view| view.id == *id);
        position.ok_or_else(|| IndexError::UnknownView {
            entry,
            id: id.clone(),
        })
    };
    let face = |ids: &Vec<String>| ids.iter().map(view).collect::<Result<Vec<_>, _>>();
    faces.iter().map(face).collect()
}

/// A known shape tied to the faces that it is about.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Constraint {
    pub(super) known: Known,
    /// Which of the faces.
    pub(super) faces: Vec<usize>,
    /// Of the two supplementary angles between two planes: whether that between the normals is meant, or
    /// the other one. Settled once, so that the measure is smooth also at 90 degrees.
    pub(super) supplement: bool,
}

impl Constraint {
    /// Of the two supplementary angles the one nearer to what is known is taken.
    pub(super) fn new(known: &Known, faces: Vec<usize>, all: &[Face]) -> Self {
        let mut constraint = Self {
            known: known.clone(),
            faces,
            supplement: false,
        };
        if let (KnownKind::PlaneAngle, Some(angle)) = (known.kind, constraint.measure(all)) {
            let other = std::f64::consts::PI - angle;
            // At 90 degrees both are as near, and either will do.
            constraint.supplement =
                (other - known.value).abs() < (angle - known.value).abs() - 1e-6;
        }
        constraint
    }

    /// M of eq. (4). `None` where the faces cannot be what they should.
    ///
    /// * The angle between two planes.
    /// * The edge between two parallel faces: the distance of their points' middles along the mean normal.
    /// * A radius.
    pub(super) fn measure(&self, faces: &[Face]) -> Option<f64> {
        let plane = |i: usize| match &faces[self.faces[i]].surface {
            Surface::Plane(plane) => Some(*plane),
            _ => None,
        };
        match self.known.kind {
            KnownKind::PlaneAngle => {
                let angle = angle(&plane(0)?, &plane(1)?);
                Some(if self.supplement {
                    std::f64::consts::PI - angle
                } else {
                    angle
                })
            }
            KnownKind::EdgeLength => edge(&plane(0)?, &plane(1)?),
            KnownKind::Radius => match &faces[self.faces[0]].surface {
                Surface::Sphere(sphere) => Some(sphere.radius),
                Surface::Cylinder(cylinder) => Some(cylinder.radius),
                _ => None,
            },
            // The points' distances from their plane say it.
            KnownKind::Flatness => Some(0.0),
        }
    }
}

/// The angle between the normals of two planes, radians.
pub(super) fn angle(a: &Plane<World>, b: &Plane<World>) -> f64 {
    let sine = a.normal.vector().cross(&b.normal.vector()).norm();
    libm::atan2(sine, a.normal.dot(b.normal))
}

pub(super) fn edge(a: &Plane<World>, b: &Plane<World>) -> Option<f64> {
    let same_side = a.normal.dot(b.normal).signum();
    let mean = (a.normal.vector() + b.normal.vector() * same_side).try_normalize(1e-9)?;
    let between = Point::<World>::from_coords(a.point.coords) - b.point;
    Some(between.dot(&mean).abs())
}
