//! An L-shaped object behind a flat wall, measured at any index of the liquid: Figs. 8 and 12 of the
//! paper, and its eqs. (3) and (4), to be played with.
//!
//! The range finder passes along the tank at three heights. Its spots lie on the two planes of the L,
//! which meet at a right angle. Reconstructed at a wrong index the L opens or closes (eq. (4) takes the
//! index at which the angle is right), and the two rays of each spot miss each other (eq. (3) takes the
//! index at which they do so least). The second fails where beam, camera and the wall's normal lie in
//! one plane: there the bent rays stay in that plane and meet whatever the index.

use nalgebra::Vector3;

use super::{Bench, WallShape};
use crate::camera::{Pixel, Slope};
use crate::geometry::{
    Camera, Direction, Plane, Point, Pose, Ray, WeightedPoint, World, fit_plane,
};
use crate::object::{Meeting, meet};
use crate::optics::{Stack, aim_through};
use crate::rig::{Laser, Rig};

/// The indices between which the right one is sought.
pub const RANGE: (f64, f64) = (0.9, 1.8);

/// The angle of the L, degrees.
pub const RIGHT_ANGLE: f64 = 90.0;

/// The edge of the L is so far behind the wall's outer face, mm.
const EDGE: f64 = 60.0;
/// Either plane of the L is so wide, mm.
const WIDTH: f64 = 90.0;
/// The rig's camera stands so far before the wall, mm.
const DISTANCE: f64 = 350.0;
/// The laser is so far to the left of the camera, mm.
const BASELINE: f64 = 160.0;
/// The beam crosses the middle of the picture so far from the camera, mm.
const CROSSING: f64 = 420.0;
/// Stations of one pass, and how far they are apart, mm.
const STATIONS: i32 = 16;
const STEP: f64 = 6.0;
/// The heights of the passes, mm.
const HEIGHTS: [f64; 3] = [-30.0, 0.0, 30.0];

/// A spot on the L.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// Where the camera stood.
    pub world_from_camera: Pose<World, Camera>,
    /// Where it sees the spot.
    pub pixel: Pixel,
    /// Which plane of the L it lies on: 0 to the left of the edge, 1 to the right.
    pub plane: usize,
    /// Where it is.
    pub truth: Point<World>,
}

/// Spots on the L, and what the laser is taken to be.
#[derive(Clone, Debug)]
pub struct Experiment {
    beam: Ray<Camera>,
    bench: Bench,
    spots: Vec<Spot>,
}

/// What one noisy measurement says of the index.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Where the angle of the L is right (eq. (4)); `None` if it is nowhere.
    pub by_angle: Option<f64>,
    /// Where the sum of the ray distances is least (eq. (3)).
    pub by_ray_distance: f64,
}

impl Experiment {
    /// Makes the spots of a bench: its media, its wall's thickness (flat, whatever the bench's wall),
    /// its rig's pitch and the turn of its L.
    pub fn new(bench: &Bench) -> Self {
        let bench = Bench {
            wall: WallShape::Plane,
            ..*bench
        };
        let beam = beam();
        let stack = bench.stack();
        let planes = planes(bench.l_turn);
        let rotation = Bench { turn: 0.0, ..bench }.rig_rotation();
        let middle = rotation * Vector3::new(0.0, 0.0, -DISTANCE);
        let mut spots = Vec::new();
        for height in HEIGHTS {
            for station in 0..STATIONS {
                let along = (f64::from(station) - 0.5 * f64::from(STATIONS - 1)) * STEP;
                let place = middle + Vector3::new(along, height, 0.0);
                let world_from_camera = Pose::from_parts(rotation, place);
                spots.extend(spot(&beam, &stack, &planes, world_from_camera));
            }
        }
        Self { beam, bench, spots }
    }

    /// The same spots as a camera and a laser would see them that are off by the bench's noise and
    /// calibration error; each number gives another draw, always the same one.
    pub fn disturbed(&self, number: u64) -> Self {
        let mut normal = Normal::seeded(number);
        let bench = &self.bench;
        let mut out = self.clone();
        // The rig that measures is not quite the one that the calibration says.
        let beam = &mut out.beam;
        let plane = beam
            .origin
            .coords
            .cross(&beam.direction.vector())
            .normalize();
        let within = plane.cross(&beam.direction.vector());
        let tilt = plane * (normal.draw() * bench.out_of_plane.to_radians())
            + within * (normal.draw() * bench.in_plane.to_radians());
        beam.direction = Direction::assume_unit((beam.direction.vector() + tilt).normalize());
        for spot in &mut out.spots {
            spot.pixel.u += normal.draw() * bench.noise;
            spot.pixel.v += normal.draw() * bench.noise;
        }
        out
    }

    /// The spots.
    pub fn spots(&self) -> &[Spot] {
        &self.spots
    }

    /// Every spot's meeting of rays at an index; `None` where the light would not get through.
    pub fn meetings(&self, index: f64) -> Vec<Option<Meeting>> {
        let stack = self.bench.stack_with(index);
        let rig = Rig {
            camera: Bench::intrinsics(),
            laser: Laser::Beam(self.beam),
            flange_from_camera: Pose::identity(),
        };
        let at = |spot: &Spot| meet(&rig, &spot.world_from_camera, &stack, spot.pixel).ok();
        self.spots.iter().map(at).collect()
    }

    /// The angle between the planes through the points reconstructed at an index, degrees: K of eq. (4).
    pub fn angle(&self, index: f64) -> Option<f64> {
        let meetings = self.meetings(index);
        let plane = |which: usize| {
            let points: Vec<_> = self
                .spots
                .iter()
                .zip(&meetings)
                .filter(|(spot, _)| spot.plane == which)
                .filter_map(|(_, meeting)| meeting.as_ref())
                .map(|meeting| WeightedPoint {
                    point: meeting.point(),
                    sigma: 1.0,
                })
                .collect();
            fit_plane(&points, Point::new(0.0, 0.0, -DISTANCE)).ok()
        };
        let cosine = plane(0)?.plane.normal.dot(plane(1)?.plane.normal);
        Some(180.0 - libm::acos(cosine.clamp(-1.0, 1.0)).to_degrees())
    }

    /// The sum of all ray distances at an index, mm: the sum of eq. (3).
    pub fn sum_of_ray_distances(&self, index: f64) -> f64 {
        let meetings = self.meetings(index);
        meetings.iter().flatten().map(|m| m.gap().abs()).sum()
    }

    /// The index by either equation.
    pub fn estimate(&self) -> Estimate {
        Estimate {
            by_angle: self.by_angle(),
            by_ray_distance: self.by_ray_distance(),
        }
    }

    /// Halves the range until the index is found at which the angle is right.
    fn by_angle(&self) -> Option<f64> {
        const HALVINGS: usize = 14;
        let excess = |index| self.angle(index).map(|angle| angle - RIGHT_ANGLE);
        let (mut low, mut high) = RANGE;
        let rises = excess(high)? > 0.0;
        if (excess(low)? > 0.0) == rises {
            return None;
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if (excess(middle)? > 0.0) == rises {
                high = middle;
            } else {
                low = middle;
            }
        }
        Some(0.5 * (low + high))
    }

    /// The least of a row of indices, then ever closer round it (golden section).
    fn by_ray_distance(&self) -> f64 {
        const STEPS: i32 = 30;
        const CUTS: usize = 12;
        const GOLDEN: f64 = 0.618_033_988_749_894_9;
        let width = (RANGE.1 - RANGE.0) / f64::from(STEPS);
        let sum = |index| self.sum_of_ray_distances(index);
        let best = (0..=STEPS)
            .map(|step| RANGE.0 + f64::from(step) * width)
            .map(|index| (index, sum(index)))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map_or(RANGE.0, |(index, _)| index);
        let (mut low, mut high) = ((best - width).max(RANGE.0), (best + width).min(RANGE.1));
        for _ in 0..CUTS {
            let (a, b) = (high - GOLDEN * (high - low), low + GOLDEN * (high - low));
            if sum(a) <= sum(b) {
                high = b;
            } else {
                low = a;
            }
        }
        0.5 * (low + high)
    }
}

/// The laser as its calibration says it is.
fn beam() -> Ray<Camera> {
    let origin = Point::new(-BASELINE, 0.0, 0.0);
    let aim = Vector3::new(BASELINE, 0.0, CROSSING).normalize();
    Ray::new(origin, Direction::assume_unit(aim))
}

/// The L as seen from above: its edge, and the ends of its left and right planes, x and z.
pub fn outline(l_turn: f64) -> [[f64; 2]; 3] {
    let end = |side: f64| {
        let (sine, cosine) = libm::sincos((side * 45.0 - l_turn).to_radians());
        [WIDTH * sine, EDGE + WIDTH * cosine]
    };
    [end(-1.0), [0.0, EDGE], end(1.0)]
}

/// The two upright planes of the L, left and right, with normals towards the rig.
fn planes(l_turn: f64) -> [Plane<World>; 2] {
    let edge = Point::new(0.0, 0.0, EDGE);
    let [left, _, right] = outline(l_turn);
    [left, right].map(|[x, z]| {
        let along = Vector3::new(x, 0.0, z - EDGE).normalize();
        let across = Vector3::new(along.z, 0.0, -along.x);
        let normal = if across.z > 0.0 { -across } else { across };
        Plane::new(edge, Direction::assume_unit(normal))
    })
}

/// The spot of a station on the plane that its beam meets first, if there is one and it is seen.
fn spot(
    beam: &Ray<Camera>,
    stack: &Stack,
    planes: &[Plane<World>; 2],
    world_from_camera: Pose<World, Camera>,
) -> Option<Spot> {
    let beam = stack.trace(&world_from_camera.ray(beam)).ok()?;
    let on = |(which, plane): (usize, &Plane<World>)| {
        let along = plane.distance_along(&beam).filter(|along| *along > 0.0)?;
        let truth = beam.at(along);
        let from_edge = truth.coords - Vector3::new(0.0, truth.coords.y, EDGE);
        let behind_edge = planes[1 - which].signed_distance(truth) <= 0.0;
        (from_edge.norm() <= WIDTH && behind_edge).then_some((along, which, truth))
    };
    let hits = planes.iter().enumerate().filter_map(on);
    let (_, plane, truth) = hits.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let eye = Point::from_coords(world_from_camera.translation());
    let aim = aim_through(stack, eye, truth).ok()?;
    let ahead = Point::origin() + world_from_camera.inverse().direction(aim).vector();
    Some(Spot {
        world_from_camera,
        pixel: Bench::intrinsics().pixel(Slope::of(ahead)?),
        plane,
        truth,
    })
}

/// Normal deviates that are the same everywhere: Steele, Lea and Flood's SplitMix64 through the
/// transformation of Box and Muller.
struct Normal(u64);

impl Normal {
    const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;

    /// Numbers that follow each other must not give sequences that do.
    fn seeded(number: u64) -> Self {
        let mut seed = Self(number);
        Self(seed.bits() ^ Self::GOLDEN.rotate_left(17))
    }

    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(Self::GOLDEN);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Above 0, up to 1.
    fn uniform(&mut self) -> f64 {
        ((self.bits() >> 11) + 1) as f64 / (1_u64 << 53) as f64
    }

    fn draw(&mut self) -> f64 {
        let radius = (-2.0 * libm::log(self.uniform())).sqrt();
        radius * libm::cos(std::f64::consts::TAU * self.uniform())
    }
}
