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
use crate::geometry::{Camera, Direction, Plane, Point, Ray, World};
use crate::optics::Surface;
use crate::rig::Laser;
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
    /// Their least and greatest width over that of the lens's blur; a spot is some 1.3 wide. Light that a
    /// curved wall has mirrored is out of focus.
    pub width: [f64; 2],
    /// How likely the object's own spot is missing in such a view (a scratch, a drop on the glass), 0 to 1.
    pub hides: f64,
    /// Which part of the light of the object's spot is seen in each mirror, 0 to 1.
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
            width: [USUAL_WIDTH; 2],
            hides: 0.0,
            mirrored: 0.0,
        }
    }
}

/// How much wider than the lens's blur a spot is.
const USUAL_WIDTH: f64 = 1.3;

const fn usual_width() -> f64 {
    USUAL_WIDTH
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

/// A false spot, or a false line of a line laser.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ghost {
    /// Where it is seen, px; of a line, where its middle is.
    pub pixel: [f64; 2],
    /// Its light: grey values summed over its pixels; of a line, over a profile across it.
    pub light: f64,
    /// How much wider than the lens's blur it is.
    #[serde(default = "usual_width")]
    pub width: f64,
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
        if !(0.0 < self.width[0] && self.width[0] <= self.width[1]) {
            return wrong(
                "ghosts.width",
                "must be two numbers greater than 0, the less first",
            );
        }
        if !(self.reach > 0.0 && self.span.iter().all(|way| *way > 0.0)) {
            return wrong("ghosts.span and ghosts.reach", "must be greater than 0");
        }
        Ok(())
    }
}

/// What is wrong in a view's light.
#[derive(Clone, Debug, Default)]
pub(super) struct FalseLight {
    /// What stands for reflections of unknown cause.
    pub(super) invented: Vec<Invented>,
    /// The object's spot in mirrors.
    mirrored: Vec<Ghost>,
    /// Whether the object's own spot is missing.
    pub(super) object_hidden: bool,
}

/// False light whose cause is outside the scene.
#[derive(Clone, Copy, Debug)]
pub(super) struct Invented {
    /// Where it is seen, for the laser's axis.
    pub(super) ghost: Ghost,
    source: Source,
}

#[derive(Clone, Copy, Debug)]
enum Source {
    /// On each of the laser's rays that far before the wall (negative) or behind its inner face, mm.
    Along(f64),
    /// Beside the light on the wall or, if `of_object`, on the object; px.
    Beside { of_object: bool, by: [f64; 2] },
}

impl FalseLight {
    /// All that is seen of it in the picture.
    pub(super) fn spots(&self, simulation: &Simulation) -> Vec<Ghost> {
        let invented = self.invented.iter().map(|invented| invented.ghost);
        let all = invented.chain(self.mirrored.iter().copied());
        all.filter(|ghost| simulation.in_picture(ghost.pixel))
            .collect()
    }
}

/// The false light of a view; the same whenever it is asked for.
pub(super) fn of(simulation: &Simulation, view: usize) -> FalseLight {
    let ghosts = &simulation.scene.ghosts;
    let axis = simulation.scan.rig.laser.axis();
    let landing = simulation.landing(view, &axis);
    let mut random = Dice::of(simulation, view);
    let mut light = FalseLight::default();
    if random.places.random_bool(ghosts.probability) {
        light.object_hidden = random.places.random_bool(ghosts.hides);
        for _ in 0..random.places.random_range(1..=ghosts.most) {
            let invented = Invented::new(simulation, view, &axis, &landing, &mut random);
            light.invented.extend(invented);
        }
    }
    let is_spot = matches!(simulation.scan.rig.laser, Laser::Beam(_));
    if is_spot && !light.object_hidden {
        light.mirrored = mirror_images(simulation, view, &landing);
    }
    light
}

/// Streams of their own, so that the pictures' noise is that of the same scene without ghosts, and ghosts
/// are where they are whatever their width.
struct Dice {
    places: ChaCha8Rng,
    widths: ChaCha8Rng,
}

impl Dice {
    fn of(simulation: &Simulation, view: usize) -> Self {
        let stream = |number: u64| {
            let seed = noise::seed(simulation.scene.seed, view, true);
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            random.set_stream(number);
            random
        };
        Self {
            places: stream(1),
            widths: stream(3),
        }
    }
}

impl Invented {
    fn new(
        simulation: &Simulation,
        view: usize,
        axis: &Ray<Camera>,
        landing: &Landing,
        random: &mut Dice,
    ) -> Option<Self> {
        let ghosts = &simulation.scene.ghosts;
        let [least, most] = ghosts.width;
        let width = random.widths.random_range(least..=most);
        let random = &mut random.places;
        let light = random.random_range(ghosts.light[0]..ghosts.light[1]);
        let on_line = random.random_bool(ghosts.on_line);
        let (kind, source) = if on_line {
            let along = random.random_range(-ghosts.span[0]..ghosts.span[1]);
            (GhostKind::OnLine, Source::Along(along))
        } else {
            let of_object = random.random_range(0..2) == 1 && landing.object.is_some();
            beside(simulation, view, landing, of_object)?;
            let (turn, part): (f64, f64) =
                (random.random_range(0.0..1.0), random.random_range(0.0..1.0));
            let (sine, cosine) = libm::sincos(std::f64::consts::TAU * turn);
            // The root makes every place in the circle as likely.
            let way = ghosts.reach * part.sqrt();
            let by = [way * cosine, way * sine];
            (GhostKind::NearSpot, Source::Beside { of_object, by })
        };
        let pixel = source.seen(simulation, view, axis, landing)?;
        Some(Self {
            ghost: Ghost {
                pixel: [pixel.u, pixel.v],
                light,
                width,
                kind,
            },
            source,
        })
    }

    /// Where it is seen for one of the laser's rays, which lands there.
    pub(super) fn seen(
        &self,
        simulation: &Simulation,
        view: usize,
        ray: &Ray<Camera>,
        landing: &Landing,
    ) -> Option<Pixel> {
        self.source.seen(simulation, view, ray, landing)
    }
}

impl Source {
    fn seen(
        &self,
        simulation: &Simulation,
        view: usize,
        ray: &Ray<Camera>,
        landing: &Landing,
    ) -> Option<Pixel> {
        match self {
            Self::Along(along) => on_ray(simulation, view, ray, *along),
            Self::Beside { of_object, by } => {
                let near = beside(simulation, view, landing, *of_object)?;
                Some(Pixel::new(near.u + by[0], near.v + by[1]))
            }
        }
    }
}

/// Where the true light is seen beside which there is a false one.
fn beside(
    simulation: &Simulation,
    view: usize,
    landing: &Landing,
    of_object: bool,
) -> Option<Pixel> {
    match of_object {
        true => simulation.seen(view, landing.object?, simulation.faces()),
        false => simulation.seen(view, landing.outer()?, 0),
    }
}

/// The image of a place on a ray of the laser: `along` mm before the wall (negative) or behind its inner
/// face.
fn on_ray(simulation: &Simulation, view: usize, ray: &Ray<Camera>, along: f64) -> Option<Pixel> {
    let ray = simulation.scan.stations[view].world_from_camera.ray(ray);
    let path = simulation.stack(view).path(&ray).ok()?;
    if along < 0.0 {
        let outer = path.vertices.get(1)?;
        return simulation.image(view, *outer + ray.direction * along, 0);
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
                width: USUAL_WIDTH,
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
