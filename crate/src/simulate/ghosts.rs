//! False spots: light that reaches the camera by another way than beam, object, camera.
//!
//! Two kinds. *Invented* spots stand for reflections whose cause is outside the scene: they are put into
//! the picture with a given probability, on the beam's image (where neither the epipolar line nor the ray
//! distance betrays them) or anywhere near a true spot. *Mirror images* are made by the scene itself: the
//! liquid's surface and the sides of a tank mirror the spot on the object.

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

use super::{Landing, SceneError, Simulation, noise, rotation_from_degrees, shapes};
use crate::camera::Pixel;
use crate::geometry::{Direction, Plane, Point, Ray, World};
use crate::optics::Surface;
use crate::scan::VesselShape;

/// The false spots of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Ghosts {
    /// How likely a view has invented spots, 0 to 1.
    pub probability: f64,
    /// At most this many in such a view; every number from 1 on is as likely.
    pub most: usize,
    /// Their least and greatest light: grey values summed over a spot's pixels.
    pub light: [f64; 2],
    /// Which part of them lies on the beam's image, 0 to 1; the others lie within `reach` of a true spot.
    pub on_line: f64,
    /// How far a spot on the beam's image seems to lie before the wall, and behind it, at most, mm.
    pub span: [f64; 2],
    /// How far the other spots lie from a true one at most, px.
    pub reach: f64,
    /// How likely the object's own spot is missing in such a view (a scratch, a drop on the glass), 0 to 1.
    pub hides: f64,
    /// Which part of the object's light is seen in each mirror, 0 to 1.
    pub mirrored: f64,
}

impl Default for Ghosts {
    fn default() -> Self {
        Self {
            probability: 0.0,
            most: 2,
            light: [200.0, 1200.0],
            on_line: 0.5,
            span: [60.0, 180.0],
            reach: 40.0,
            hides: 0.0,
            mirrored: 0.0,
        }
    }
}

/// Where a false spot comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum GhostKind {
    /// Invented, on the beam's image.
    OnLine,
    /// Invented, near a true spot.
    NearSpot,
    /// The object's spot, mirrored in the liquid's surface.
    InSurface,
    /// The object's spot, mirrored in a side of the tank.
    InSide,
}

/// A false spot.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ghost {
    /// Where it is seen, px.
    pub pixel: [f64; 2],
    /// Its light: grey values summed over its pixels.
    pub light: f64,
    /// Where it comes from.
    pub kind: GhostKind,
}

impl Ghosts {
    pub(super) fn check(&self) -> Result<(), SceneError> {
        let part = |value: f64, key| {
            let problem = "must be from 0 to 1";
            if (0.0..=1.0).contains(&value) {
                Ok(())
            } else {
                Err(SceneError::Value { key, problem })
            }
        };
        part(self.probability, "ghosts.probability")?;
        part(self.on_line, "ghosts.on_line")?;
        part(self.hides, "ghosts.hides")?;
        part(self.mirrored, "ghosts.mirrored")?;
        let wrong = |key, problem| Err(SceneError::Value { key, problem });
        if !(0.0 < self.light[0] && self.light[0] < self.light[1]) {
            return wrong(
                "ghosts.light",
                "must be two numbers greater than 0, the less first",
            );
        }
        if self.most == 0 {
            return wrong("ghosts.most", "must be greater than 0");
        }
        if !(self.reach > 0.0 && self.span.iter().all(|way| *way > 0.0)) {
            return wrong("ghosts.span and ghosts.reach", "must be greater than 0");
        }
        Ok(())
    }
}

/// What is wrong in a view's light.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct FalseLight {
    /// The false spots.
    pub(super) spots: Vec<Ghost>,
    /// Whether the object's own spot is missing.
    pub(super) object_hidden: bool,
}

/// The false light of a view; the same whenever it is asked for.
pub(super) fn of(simulation: &Simulation, view: usize) -> FalseLight {
    let ghosts = &simulation.scene.ghosts;
    let landing = simulation.landing(view, &simulation.scan.rig.laser.axis());
    // A stream of its own, so that the pictures' noise is that of the same scene without ghosts.
    let mut random = ChaCha8Rng::seed_from_u64(noise::seed(simulation.scene.seed, view, true));
    random.set_stream(1);
    let mut light = FalseLight::default();
    if random.random_bool(ghosts.probability) {
        light.object_hidden = random.random_bool(ghosts.hides);
        for _ in 0..random.random_range(1..=ghosts.most) {
            light
                .spots
                .extend(invented(simulation, view, &landing, &mut random));
        }
    }
    if !light.object_hidden {
        light
            .spots
            .extend(mirror_images(simulation, view, &landing));
    }
    light
        .spots
        .retain(|ghost| simulation.in_picture(ghost.pixel));
    light
}

fn invented(
    simulation: &Simulation,
    view: usize,
    landing: &Landing,
    random: &mut ChaCha8Rng,
) -> Option<Ghost> {
    let ghosts = &simulation.scene.ghosts;
    let light = random.random_range(ghosts.light[0]..ghosts.light[1]);
    let on_line = random.random_bool(ghosts.on_line);
    let (kind, pixel) = if on_line {
        let along = random.random_range(-ghosts.span[0]..ghosts.span[1]);
        (GhostKind::OnLine, on_beam(simulation, view, along)?)
    } else {
        let truth = [
            landing.faces.first().map(|p| (*p, 0)),
            landing.object.map(|p| (p, simulation.faces())),
        ];
        let (point, faces) = truth[random.random_range(0..2)].or(truth[0])?;
        let near = simulation.seen(view, point, faces)?;
        let (turn, part): (f64, f64) =
            (random.random_range(0.0..1.0), random.random_range(0.0..1.0));
        let (sine, cosine) = libm::sincos(std::f64::consts::TAU * turn);
        // The root makes every place in the circle as likely.
        let way = ghosts.reach * part.sqrt();
        let pixel = Pixel::new(near.u + way * cosine, near.v + way * sine);
        (GhostKind::NearSpot, pixel)
    };
    Some(Ghost {
        pixel: [pixel.u, pixel.v],
        light,
        kind,
    })
}

/// The image of a place on the beam: `along` mm before the wall (negative) or behind its inner face.
fn on_beam(simulation: &Simulation, view: usize, along: f64) -> Option<Pixel> {
    let beam = simulation.beam(view);
    let path = simulation.stack(view).path(&beam).ok()?;
    if along < 0.0 {
        let outer = path.vertices.get(1)?;
        return simulation.image(view, *outer + beam.direction * along, 0);
    }
    simulation.image(view, path.last.at(along), 2)
}

/// The object's spot as the liquid's surface and the tank's sides show it.
fn mirror_images(simulation: &Simulation, view: usize, landing: &Landing) -> Vec<Ghost> {
    let scene = &simulation.scene;
    let (Some(spot), true) = (landing.object, scene.ghosts.mirrored > 0.0) else {
        return Vec::new();
    };
    let light = scene.ghosts.mirrored * scene.brightness.object;
    let images = mirrors(simulation)
        .into_iter()
        .filter_map(|(mirror, kind)| {
            let pixel = mirrored(simulation, view, spot, &mirror)?;
            Some(Ghost {
                pixel: [pixel.u, pixel.v],
                light,
                kind,
            })
        });
    images.collect()
}

/// The planes that mirror light within the vessel; their normals point to the liquid.
fn mirrors(simulation: &Simulation) -> Vec<(Plane<World>, GhostKind)> {
    let vessel = &simulation.scene.vessel;
    let mut mirrors = Vec::new();
    if let Some(level) = vessel.level {
        let down = Direction::assume_unit(Vector3::y());
        let surface = Plane::new(Point::new(0.0, level, 0.0), down);
        mirrors.push((surface, GhostKind::InSurface));
    }
    if vessel.shape == VesselShape::Plane {
        let across = rotation_from_degrees(vessel.rotation) * Vector3::x();
        for side in [-1.0, 1.0] {
            let place = Vector3::from(vessel.centre) + across * (side * vessel.half_size[0]);
            let normal = Direction::assume_unit(across * -side);
            let plane = Plane::new(Point::from_coords(place), normal);
            mirrors.push((plane, GhostKind::InSide));
        }
    }
    mirrors
}

/// Where a spot is seen in a mirror; `None` if a solid or the spot's place hides it.
fn mirrored(
    simulation: &Simulation,
    view: usize,
    spot: Point<World>,
    mirror: &Plane<World>,
) -> Option<Pixel> {
    const SAME_PLACE: f64 = 0.01;
    let height = mirror.signed_distance(spot);
    if height <= 0.0 {
        return None;
    }
    let image = spot + mirror.normal * (-2.0 * height);
    let aim = simulation.aim(view, image, 2)?;
    let arriving = simulation.arriving(view, aim, 2)?;
    let way = mirror.distance_along(&arriving).filter(|way| *way > 0.0)?;
    let turning = arriving.at(way);
    let back = Ray::new(turning, Direction::new(spot - turning).ok()?);
    let free = |ray: &Ray<World>, way: f64| {
        shapes::nearest(&simulation.solids, ray).is_none_or(|hit| hit.distance > way - SAME_PLACE)
    };
    let clear = free(&arriving, way) && free(&back, turning.distance(spot));
    clear.then(|| simulation.project(view, aim))?
}

/// Where light from within meets the vessel's back: the far side of a round wall's inner face, or the
/// back wall of a tank of that depth.
pub(super) fn back(simulation: &Simulation, light: &Ray<World>) -> Option<Point<World>> {
    let inner = simulation.wall.outer.behind(simulation.wall.thickness)?;
    let (middle, along, radius) = match &inner {
        Surface::Plane(plane) => {
            let wall = plane.offset(-simulation.scene.vessel.depth?);
            return wall.distance_along(light).map(|way| light.at(way));
        }
        Surface::Cylinder(c) => (c.point, Some(c.axis.vector()), c.radius),
        Surface::Sphere(s) => (s.centre, None, s.radius),
        Surface::Freeform(_) => return None,
    };
    let across = |v: Vector3<f64>| along.map_or(v, |axis| v - axis * v.dot(&axis));
    let (from, to) = (
        across(light.origin - middle),
        across(light.direction.vector()),
    );
    let (square, half) = (to.norm_squared(), from.dot(&to));
    let root = half * half - square * (from.norm_squared() - radius * radius);
    (root > 0.0).then(|| light.at((root.sqrt() - half) / square))
}
