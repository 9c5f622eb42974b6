//! Which of the object's points lie on a common face: found by themselves, or told by view.

use super::IndexError;
use super::face::Face;
use super::known::{Constraint, Known, angle, edge};
use super::sights::Sights;
use crate::geometry::{Direction, Plane, Point, WeightedPoint, World, fit_plane};
use crate::optics::Surface;
use crate::robust::{Choice, tukey_loss};
use crate::scan::{KnownKind, VesselShape};
use crate::vessel::fit_shape;

/// The object's points for one index, and what to hold them to.
pub(super) struct Cloud<'a> {
    /// The point of each sight, where its light gets through.
    pub(super) points: &'a [Option<Point<World>>],
    /// One standard deviation along its line of sight, mm.
    pub(super) sigmas: &'a [f64],
    /// The sights.
    pub(super) sights: &'a Sights,
    /// Where the rig is.
    pub(super) front: Point<World>,
    /// Where the camera of each view is.
    pub(super) eyes: &'a [Point<World>],
    /// The mean normal of the wall, along which a wrong index draws space out.
    pub(super) axis: Direction<World>,
    /// A point nearer to a face than this may lie on it, mm.
    pub(super) tolerance: f64,
}

/// The least number of points that make a face.
pub(super) const LEAST_POINTS: usize = 6;
const MOST_PLANES: usize = 6;

impl Cloud<'_> {
    /// The faces that the points themselves show: planes, one after the other as long as enough points
    /// agree on one, or one round face if that explains the points better.
    pub(super) fn faces(&self) -> Vec<Face> {
        self.faces_of(self.kind())
    }

    /// Which kind of faces explains the points best.
    pub(super) fn kind(&self) -> VesselShape {
        [
            VesselShape::Plane,
            VesselShape::Sphere,
            VesselShape::Cylinder,
        ]
        .into_iter()
        .map(|kind| (self.criterion(&self.faces_of(kind)), kind))
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map_or(VesselShape::Plane, |(_, kind)| kind)
    }

    /// Faces of one kind.
    pub(super) fn faces_of(&self, kind: VesselShape) -> Vec<Face> {
        match kind {
            VesselShape::Sphere | VesselShape::Cylinder => self.round(kind).into_iter().collect(),
            _ => self.planes(),
        }
    }

    /// The mean robust loss of the points about the faces: how badly these explain them.
    pub(super) fn loss(&self, faces: &[Face]) -> f64 {
        let far = tukey_loss(f64::INFINITY);
        let mut nearest = vec![far; self.points.len()];
        for face in faces {
            for &member in &face.members {
                if let Some(point) = self.points[member] {
                    nearest[member] = tukey_loss(face.distance(point) / self.scale(member));
                }
            }
        }
        nearest.iter().sum::<f64>() / nearest.len().max(1) as f64
    }

    /// Schwarz's criterion: a face must earn the numbers that it takes.
    fn criterion(&self, faces: &[Face]) -> f64 {
        let count = self.points.len() as f64;
        let numbers: usize = faces.iter().map(Face::freedom).sum();
        count * self.loss(faces) + numbers as f64 * libm::log(count.max(1.0))
    }

    /// A standard deviation that reaches the tolerance at four of it.
    fn scale(&self, sight: usize) -> f64 {
        self.sigmas[sight].max(0.25 * self.tolerance)
    }

    fn weighted(&self, members: &[usize]) -> Vec<WeightedPoint<World>> {
        let one = |i: &usize| {
            Some(WeightedPoint {
                point: self.points[*i]?,
                sigma: self.scale(*i),
            })
        };
        members.iter().filter_map(one).collect()
    }

    fn planes(&self) -> Vec<Face> {
        let mut free: Vec<usize> = (0..self.points.len())
            .filter(|i| self.points[*i].is_some())
            .collect();
        let least = LEAST_POINTS.max(free.len() / 12);
        let mut planes: Vec<Plane<World>> = Vec::new();
        while planes.len() < MOST_PLANES && free.len() >= least {
            let Some(plane) = self.consensus(&free, least) else {
                break;
            };
            free.retain(|i| !self.near(&plane, *i));
            planes.push(plane);
        }
        self.assigned(planes.into_iter().map(Surface::Plane).collect())
    }

    fn near(&self, plane: &Plane<World>, sight: usize) -> bool {
        self.points[sight].is_some_and(|p| plane.signed_distance(p).abs() <= self.tolerance)
    }

    /// Whether a plane is seen on edge where a sight meets it. No face of the object is; but the plane that
    /// a row of views sweeps is, and all points of the row lie in it.
    fn edge_on(&self, plane: &Plane<World>, sight: usize) -> bool {
        const LEAST_SINE: f64 = 0.2;
        let eye = self.eyes[self.sights.object[sight].view];
        self.points[sight].is_none_or(|point| {
            let way = point - eye;
            plane.normal.vector().dot(&way).abs() < LEAST_SINE * way.norm()
        })
    }

    /// The plane on which the most of some points agree.
    fn consensus(&self, free: &[usize], least: usize) -> Option<Plane<World>> {
        const SAMPLES: usize = 600;
        let mut choice = Choice::new();
        let mut best: (usize, Vec<usize>) = (0, Vec::new());
        for _ in 0..SAMPLES {
            let corners = choice.distinct(free.len())?.map(|i: usize| free[i]);
            let [a, b, c] = corners.map(|i| self.points[i]);
            let (a, b, c) = (a?, b?, c?);
            let Ok(normal) = Direction::new((b - a).cross(&(c - a))) else {
                continue;
            };
            let plane = Plane::new(a, normal);
            if corners.iter().any(|i| self.edge_on(&plane, *i)) {
                continue;
            }
            let members: Vec<usize> = free
                .iter()
                .copied()
                .filter(|i| self.near(&plane, *i))
                .collect();
            if members.len() > best.0 {
                best = (members.len(), members);
            }
        }
        if best.0 < least {
            return None;
        }
        let fit = fit_plane(&self.weighted(&best.1), self.front).ok()?;
        Some(fit.plane)
    }

    /// Gives each point to the nearest of the surfaces, if it is near enough.
    fn assigned(&self, surfaces: Vec<Surface>) -> Vec<Face> {
        let mut members = vec![Vec::new(); surfaces.len()];
        for (sight, point) in self.points.iter().enumerate() {
            let Some(point) = point else { continue };
            let off = |s: &Surface| s.signed_distance(*point).abs();
            let nearest = surfaces.iter().map(off).enumerate();
            let nearest = nearest.min_by(|a, b| a.1.total_cmp(&b.1));
            if let Some((face, _)) = nearest.filter(|(_, off)| *off <= self.tolerance) {
                members[face].push(sight);
            }
        }
        let faces = surfaces.into_iter().zip(members);
        faces
            .filter(|(_, members)| members.len() >= LEAST_POINTS)
            .map(|(surface, members)| self.face(surface, members))
            .collect()
    }

    fn face(&self, surface: Surface, members: Vec<usize>) -> Face {
        let round = !matches!(surface, Surface::Plane(_));
        Face {
            surface,
            stretch: round.then_some(0.0),
            axis: self.axis,
            members,
        }
    }

    fn round(&self, shape: VesselShape) -> Option<Face> {
        const LEAST: usize = 12;
        let all: Vec<usize> = (0..self.points.len())
            .filter(|i| self.points[*i].is_some())
            .collect();
        if all.len() < LEAST {
            return None;
        }
        let surface = fit_shape(&self.weighted(&all), self.front, shape)?;
        self.assigned(vec![surface]).pop()
    }

    /// The face on the object's points of given views.
    fn told(&self, known: &Known, views: &[usize]) -> Result<Face, IndexError> {
        let members: Vec<usize> = (0..self.points.len())
            .filter(|i| views.contains(&self.sights.object[*i].view) && self.points[*i].is_some())
            .collect();
        let too_few = IndexError::TooFewPoints {
            entry: known.entry,
            needed: LEAST_POINTS,
            found: members.len(),
        };
        if members.len() < LEAST_POINTS {
            return Err(too_few);
        }
        let points = self.weighted(&members);
        let surface = match known.kind {
            KnownKind::Radius => [VesselShape::Sphere, VesselShape::Cylinder]
                .into_iter()
                .filter_map(|shape| fit_shape(&points, self.front, shape))
                .map(|surface| self.face(surface, members.clone()))
                .min_by(|a, b| self.criterion_of(a).total_cmp(&self.criterion_of(b)))
                .map(|face| face.surface),
            _ => fit_plane(&points, self.front)
                .ok()
                .map(|fit| Surface::Plane(fit.plane)),
        };
        let surface = surface.ok_or(too_few)?;
        Ok(self.face(surface, members))
    }

    fn criterion_of(&self, face: &Face) -> f64 {
        self.criterion(std::slice::from_ref(face))
    }

    /// The faces, and each known shape tied to those that it is about. Faces that are told by view stand
    /// beside those that are found, and take their points.
    pub(super) fn with_known(
        &self,
        knowns: &[Known],
    ) -> Result<(Vec<Face>, Vec<Constraint>), IndexError> {
        let mut told: Vec<(Vec<usize>, Face)> = Vec::new();
        let mut tied: Vec<(&Known, Vec<usize>)> = Vec::new();
        for known in knowns {
            let Some(views) = &known.views else { continue };
            let mut faces = Vec::new();
            for views in views {
                let position = told.iter().position(|(v, _)| v == views);
                let face = match position {
                    Some(face) => face,
                    None => {
                        told.push((views.clone(), self.told(known, views)?));
                        told.len() - 1
                    }
                };
                faces.push(face);
            }
            tied.push((known, faces));
        }
        let mut faces: Vec<Face> = told.into_iter().map(|(_, face)| face).collect();
        let taken: Vec<usize> = faces.iter().flat_map(|f| f.members.clone()).collect();
        faces.extend(self.faces().into_iter().filter_map(|mut face| {
            face.members.retain(|m| !taken.contains(m));
            (face.members.len() >= LEAST_POINTS).then_some(face)
        }));
        for known in knowns.iter().filter(|known| known.views.is_none()) {
            tied.push((known, find_faces(known, &faces)?));
        }
        let constraints: Vec<Constraint> = tied
            .into_iter()
            .map(|(known, about)| Constraint::new(known, about, &faces))
            .collect();
        for constraint in &constraints {
            if constraint.known.kind == KnownKind::Radius {
                faces[constraint.faces[0]].stretch = None;
            }
        }
        Ok((faces, constraints))
    }
}

/// The faces that a known shape is most likely about: those whose measure comes nearest to it.
fn find_faces(known: &Known, faces: &[Face]) -> Result<Vec<usize>, IndexError> {
    let plane = |face: &Face| match &face.surface {
        Surface::Plane(plane) => Some(*plane),
        _ => None,
    };
    let planes: Vec<(usize, Plane<World>)> = faces
        .iter()
        .enumerate()
        .filter_map(|(i, face)| Some((i, plane(face)?)))
        .collect();
    let pairs = || {
        let first = planes.iter().enumerate();
        first.flat_map(|(i, a)| planes[i + 1..].iter().map(move |b| (a, b)))
    };
    let nearest = |measured: Vec<(f64, Vec<usize>)>| {
        measured
            .into_iter()
            .min_by(|a, b| {
                (a.0 - known.value)
                    .abs()
                    .total_cmp(&(b.0 - known.value).abs())
            })
            .map(|(_, faces)| faces)
    };
    /// Faces of less than this angle are parallel; of more, they make an angle. Radians.
    const PARALLEL: f64 = 0.2;
    // Seen from the rig, a face and one turned away from it have normals that differ by 180 degrees.
    let apart = |a: &Plane<World>, b: &Plane<World>| libm::sin(angle(a, b));
    let found = match known.kind {
        KnownKind::PlaneAngle => nearest(
            pairs()
                .map(|(a, b)| (Constraint::new(known, vec![a.0, b.0], faces), a.0, b.0))
                .filter_map(|(constraint, a, b)| Some((constraint.measure(faces)?, vec![a, b])))
                .collect(),
        ),
        KnownKind::EdgeLength => nearest(
            pairs()
                .filter(|(a, b)| apart(&a.1, &b.1) < PARALLEL)
                .filter_map(|(a, b)| Some((edge(&a.1, &b.1)?, vec![a.0, b.0])))
                .collect(),
        ),
        KnownKind::Flatness => planes
            .iter()
            .max_by_key(|(i, _)| faces[*i].members.len())
            .map(|(i, _)| vec![*i]),
        KnownKind::Radius => {
            let radius = |face: &Face| match &face.surface {
                Surface::Sphere(sphere) => Some(sphere.radius),
                Surface::Cylinder(cylinder) => Some(cylinder.radius),
                _ => None,
            };
            let round = faces.iter().enumerate();
            nearest(
                round
                    .filter_map(|(i, face)| Some((radius(face)?, vec![i])))
                    .collect(),
            )
        }
    };
    found.ok_or(IndexError::NoFace {
        entry: known.entry,
        kind: known.kind,
    })
}
