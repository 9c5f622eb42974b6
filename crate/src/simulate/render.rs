use nalgebra::Vector3;

use super::noise::{Grains, Normal};
use super::{INNER, PictureNoise, Simulation, shapes};
use crate::camera::Pixel;
use crate::geometry::{Camera, Direction, Point, Pose, Ray, World};
use crate::object::line_of_sight;
use crate::optics::Surface;
use crate::scan::{InsideMedium, Picture};

/// Light on the sensor, grey values, before noise and rounding.
#[derive(Clone, Debug)]
pub struct Exposure {
    width: usize,
    height: usize,
    light: Vec<f32>,
}

impl Exposure {
    /// Adds a Gaussian spot whose grey values sum up to `total`.
    pub(super) fn add_spot(&mut self, centre: Pixel, sigma: f64, total: f64) {
        let reach = 4.0 * sigma;
        let range = |at: f64, end: usize| {
            let first = (at - reach).ceil().max(0.0) as usize;
            let last = (at + reach).floor().max(-1.0) + 1.0;
            first..(last.max(0.0) as usize).min(end)
        };
        let peak = total / (2.0 * std::f64::consts::PI * sigma * sigma);
        for y in range(centre.v, self.height) {
            for x in range(centre.u, self.width) {
                let (du, dv) = (x as f64 - centre.u, y as f64 - centre.v);
                let fall = libm::exp(-0.5 * (du * du + dv * dv) / (sigma * sigma));
                self.light[y * self.width + x] += (peak * fall) as f32;
            }
        }
    }

    /// Makes light grainy: each pixel's is that of the next grain.
    pub(super) fn speckle(&mut self, grains: &mut Grains) {
        for light in self.light.iter_mut().filter(|light| **light > 0.0) {
            *light *= grains.next() as f32;
        }
    }

    /// Adds other light.
    pub(super) fn add(&mut self, other: &Self) {
        for (light, more) in self.light.iter_mut().zip(&other.light) {
            *light += more;
        }
    }

    /// A sensor of the same size that no light falls on.
    pub(super) fn unlit(&self) -> Self {
        Self {
            light: vec![0.0; self.light.len()],
            ..*self
        }
    }

    /// Reads the sensor out: noise, then rounding to 8 bits.
    pub(super) fn develop(&self, noise: &PictureNoise, seed: u64) -> Picture {
        let mut normal = Normal::new(seed);
        let read = noise.read * noise.read;
        let grey = self.light.iter().map(|light| {
            let light = f64::from(*light);
            let sigma = (read + noise.shot * light).sqrt();
            (light + sigma * normal.next()).round().clamp(0.0, 255.0) as u16
        });
        Picture {
            width: self.width,
            height: self.height,
            full_scale: 255,
            grey: grey.collect(),
        }
    }
}

/// The scene by the light of the room, as a camera sees it through the wall.
pub(super) fn ambient(
    simulation: &Simulation,
    world_from_camera: &Pose<World, Camera>,
) -> Exposure {
    let camera = &simulation.scan.rig.camera;
    let (width, height) = (camera.width as usize, camera.height as usize);
    let mut light = Vec::with_capacity(width * height);
    for y in 0..height {
        for x in 0..width {
            let pixel = Pixel::new(x as f64, y as f64);
            let sight = line_of_sight(&simulation.scan.rig, world_from_camera, pixel);
            light.push(sight.map_or(0.0, |sight| shade(simulation, &sight)) as f32);
        }
    }
    Exposure {
        width,
        height,
        light,
    }
}

/// The light that comes back along a line of sight.
fn shade(simulation: &Simulation, sight: &Ray<World>) -> f64 {
    let scene = &simulation.scene;
    let room = scene.ambient.background;
    let Some(across) = place_on_front(simulation, sight) else {
        return room * (1.0 - 0.25 * sight.direction.vector().y);
    };
    // The tank's edges, seen as bright seams.
    let seam = across.0.max(across.1) > 0.985;
    let medium = match simulation.through(InsideMedium::Liquid).path(sight) {
        Ok(path) => scene.medium_at(path.vertices[INNER]),
        Err(_) => return room,
    };
    let Ok(inside) = simulation.through(medium).trace(sight) else {
        return room;
    };
    let clear = match medium {
        InsideMedium::Air => 1.0,
        InsideMedium::Liquid => 0.85,
    };
    let lit = match shapes::nearest(&simulation.solids, &inside) {
        Some(hit) => scene.ambient.object * lambert(hit.normal),
        None => room,
    };
    let glint = if seam { 0.6 * room } else { 0.0 };
    lit * clear + glint
}

/// Where a line of sight meets the vessel, in half-sizes from its middle; `None` beside it.
fn place_on_front(simulation: &Simulation, sight: &Ray<World>) -> Option<(f64, f64)> {
    let hit = simulation.wall.outer.hit(sight)?;
    let vessel = &simulation.scene.vessel;
    let turn = super::rotation_from_degrees(vessel.rotation);
    let from_middle = hit.point - Point::from(vessel.centre);
    let across = from_middle.dot(&(turn * Vector3::x())).abs() / vessel.half_size[0];
    let down = from_middle.dot(&(turn * Vector3::y())).abs() / vessel.half_size[1];
    let place = match &simulation.wall.outer {
        Surface::Plane(_) => (across, down),
        Surface::Cylinder(_) => (0.0, down),
        Surface::Sphere(_) | Surface::Freeform(_) => (0.0, 0.0),
    };
    (place.0 <= 1.0 && place.1 <= 1.0).then_some(place)
}

/// A soft light from above, left and behind the rig.
fn lambert(normal: Direction<World>) -> f64 {
    let light = Point::<World>::new(-0.45, -0.6, -0.66).coords.normalize();
    0.25 + 0.75 * normal.vector().dot(&light).max(0.0)
}
