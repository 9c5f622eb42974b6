//! The camera that looks at the scene: it circles a target and keeps upright.

use std::f32::consts::FRAC_PI_2;

use three_d::{Camera, InnerSpace, Vec2, Vec3, Viewport, degrees, vec3};

use crate::state::Look;

/// Vertical field of view, degrees.
const FIELD: f32 = 32.0;

/// As far up as the camera goes, radians: straight from above there is no upright.
const STEEPEST: f32 = 1.5705;

/// Where the camera is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Orbit {
    /// What it looks at.
    target: Vec3,
    /// How far away it is, mm.
    distance: f32,
    /// Round to the right of the front, radians.
    azimuth: f32,
    /// Above the front, radians.
    elevation: f32,
    /// The scene's up.
    up: Vec3,
    /// From the scene to the rig, across `up`.
    front: Vec3,
    /// Without perspective.
    pub(super) orthographic: bool,
}

impl Default for Orbit {
    fn default() -> Self {
        Self::facing(vec3(0.0, -1.0, 0.0), vec3(0.0, 0.0, -1.0))
    }
}

impl Orbit {
    /// A camera on the rig's side of the wall, to the right and a little above: light runs from left to
    /// right through the picture.
    pub(super) fn facing(up: Vec3, front: Vec3) -> Self {
        Self {
            target: vec3(0.0, 0.0, 0.0),
            distance: 500.0,
            azimuth: 0.7,
            elevation: 0.36,
            up,
            front,
            orthographic: false,
        }
    }

    /// The matrices.
    pub(super) fn camera(&self, viewport: Viewport) -> Camera {
        let (eye, far) = (
            self.target + self.back() * self.distance,
            self.distance * 50.0,
        );
        if self.orthographic {
            // What lies at the target's distance keeps its size; what lies behind the eye is seen too.
            // The height is that at a distance of 1: three-d counts the distance in.
            let height = 2.0 * half_field();
            return Camera::new_orthographic(
                viewport,
                eye,
                self.target,
                self.up,
                height,
                -far,
                far,
            );
        }
        let near = self.distance * 0.01;
        Camera::new_perspective(
            viewport,
            eye,
            self.target,
            self.up,
            degrees(FIELD),
            near,
            far,
        )
    }

    /// Turns to look from the rig, from the side, or from above.
    pub(super) fn look(&mut self, from: Look) {
        (self.azimuth, self.elevation) = match from {
            Look::Front => (0.0, 0.0),
            Look::Side => (FRAC_PI_2, 0.0),
            Look::Above => (0.0, STEEPEST),
        };
    }

    /// Looks at a place, from nearer.
    pub(super) fn focus(&mut self, place: Vec3) {
        self.target = place;
        self.distance *= 0.5;
    }

    /// From the target to the camera.
    fn back(&self) -> Vec3 {
        let level =
            self.front * self.azimuth.cos() + self.up.cross(self.front) * self.azimuth.sin();
        level * self.elevation.cos() + self.up * self.elevation.sin()
    }

    /// To the right, and upwards, in the picture.
    fn across(&self) -> (Vec3, Vec3) {
        let back = self.back();
        let right = self.up.cross(back).normalize();
        (right, back.cross(right))
    }

    /// Turns with a drag across the picture (CSS px): a drag of its height is half a turn.
    pub(super) fn turn(&mut self, drag: Vec2, picture: Vec2) {
        let per_px = std::f32::consts::PI / picture.y.max(200.0);
        self.azimuth -= drag.x * per_px;
        self.elevation = (self.elevation + drag.y * per_px).clamp(-STEEPEST, STEEPEST);
    }

    /// Shifts with a drag: what lies at the target's distance stays under the pointer.
    pub(super) fn pan(&mut self, drag: Vec2, picture: Vec2) {
        self.target += self.shift(-drag, picture);
    }

    /// Comes nearer (`ratio` below 1) or goes away; what lies `off_centre` (CSS px) stays there.
    pub(super) fn zoom(&mut self, ratio: f32, off_centre: Vec2, picture: Vec2) {
        let ratio = (self.distance * ratio).clamp(1.0, 1e6) / self.distance;
        self.target += self.shift(off_centre, picture) * (1.0 - ratio);
        self.distance *= ratio;
    }

    /// A way across the picture (CSS px, y down) as a way in the world, at the target's distance.
    fn shift(&self, px: Vec2, picture: Vec2) -> Vec3 {
        let (right, up) = self.across();
        let per_px = 2.0 * self.distance * half_field() / picture.y;
        (right * px.x - up * px.y) * per_px
    }

    /// Moves, without turning, until all `places` just fill the picture.
    pub(super) fn fit(&mut self, places: &[Vec3], aspect: f32) {
        const MARGIN: f32 = 1.08;
        if places.is_empty() {
            return;
        }
        let (right, up) = self.across();
        let back = self.back();
        let (half_height, half_width) = (half_field() / MARGIN, half_field() * aspect / MARGIN);
        self.target = middle(places);
        // The picture's middle moves with the distance and the other way round; it settles fast.
        for _ in 0..4 {
            let local = |p: &Vec3| {
                let from = *p - self.target;
                vec3(from.dot(right), from.dot(up), from.dot(back))
            };
            let needed = places.iter().map(local).map(|p| {
                let sideways = (p.x.abs() / half_width).max(p.y.abs() / half_height);
                p.z + sideways
            });
            let distance = needed.fold(1.0, f32::max);
            let seen = places.iter().map(local).map(|p| {
                let depth = (distance - p.z).max(1e-3);
                Vec2::new(p.x / depth, p.y / depth)
            });
            let (low, high) = seen.fold(
                (Vec2::new(f32::MAX, f32::MAX), Vec2::new(f32::MIN, f32::MIN)),
                |(low, high), p| {
                    (
                        Vec2::new(low.x.min(p.x), low.y.min(p.y)),
                        Vec2::new(high.x.max(p.x), high.y.max(p.y)),
                    )
                },
            );
            let centre = (low + high) * 0.5 * distance;
            self.target += right * centre.x + up * centre.y;
            self.distance = distance;
        }
    }
}

fn half_field() -> f32 {
    (FIELD.to_radians() / 2.0).tan()
}

fn middle(places: &[Vec3]) -> Vec3 {
    let sum = places.iter().fold(vec3(0.0, 0.0, 0.0), |sum, p| sum + *p);
    sum / places.len() as f32
}
