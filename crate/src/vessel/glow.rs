//! Both faces of the wall glow, and the picture shows one merged spot: how far that lies from the outer
//! face's own.
//!
//! Where the beam enters and leaves the wall it leaves a bright and a fainter spot. The camera sees them
//! a few pixels apart, d, which follows from the wall and the light's path; merged, their centroid lies
//! `q d` off the outer one, with q the inner glow's share of the light. The share shows in the spot's
//! width. With M_along and M_across the spot's second moments along and across d, and e the ratio by
//! which the beam's footprint is drawn out along it,
//!
//! ```text
//! M_along = M_across (1 + f (e^2 - 1)) + q (1 - q) d^2
//! ```
//!
//! where f (0 to 1) is the part of M_across that is the beam and not the lens's blur: not known, taken
//! as 1/2, which matters little as e is near 1. The share is the same glass's in all views, so the
//! median over them is taken.

use nalgebra::Vector2;

use super::Wall;
use crate::camera::{Intrinsics, Pixel};
use crate::geometry::{Camera, Point, Pose, Ray, World};
use crate::optics::{Media, aim_through};
use crate::robust::{median, robust_scale};
use crate::scan::InsideMedium;
use crate::spots::Spot;

/// What the wall's geometry says of a vessel spot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Faces {
    /// From the outer face's spot to the inner one's, px.
    pub(super) offset: Vector2<f64>,
    /// How much longer than wide the beam's footprint on the wall is seen, along the offset.
    stretch: f64,
}

/// Faces that are seen nearer together than this, px, glow as one.
const LEAST_OFFSET: f64 = 1e-3;

/// Where the inner face's glow of the laser's ray `beam` is seen, beside the outer one's; `None` where
/// that is the same place.
pub(super) fn faces(
    camera: &Intrinsics,
    beam: &Ray<Camera>,
    world_from_camera: &Pose<World, Camera>,
    wall: &Wall,
    media: &Media,
) -> Option<Faces> {
    let mut stack = wall.stack(media, InsideMedium::Liquid).ok()?;
    stack.interfaces.truncate(2);
    let inside = stack.path(&world_from_camera.ray(beam)).ok()?;
    stack.interfaces.truncate(1);
    let eye = world_from_camera.point(Point::origin());
    let seen = |point: Point<World>, faces: usize| -> Option<Pixel> {
        let mut stack = stack.clone();
        stack.interfaces.truncate(faces);
        let aim = aim_through(&stack, eye, point).ok()?;
        let ahead = world_from_camera.inverse().direction(aim);
        camera.project(Point::from_coords(ahead.vector()))
    };
    let outer = inside.vertices[1];
    let (at_outer, at_inner) = (seen(outer, 0)?, seen(inside.vertices[2], 1)?);
    let offset = Vector2::new(at_inner.u - at_outer.u, at_inner.v - at_outer.v);
    if offset.norm().is_nan() || offset.norm() <= LEAST_OFFSET {
        return None;
    }
    Some(Faces {
        offset,
        stretch: stretch(camera, beam, world_from_camera, wall, (at_outer, offset))?,
    })
}

/// How the circle in which the wall cuts the beam is seen: its image's half width along the offset over
/// that across it.
fn stretch(
    camera: &Intrinsics,
    beam: &Ray<Camera>,
    world_from_camera: &Pose<World, Camera>,
    wall: &Wall,
    (centre, offset): (Pixel, Vector2<f64>),
) -> Option<f64> {
    const BEAM: f64 = 0.1;
    let (u, v) = beam.direction.tangents();
    let along = offset.normalize();
    let across = Vector2::new(-along.y, along.x);
    let edge = |shift| {
        let beside = Ray::new(beam.origin + shift * BEAM, beam.direction);
        let hit = wall.outer.hit(&world_from_camera.ray(&beside))?;
        let pixel = camera.project(world_from_camera.inverse().point(hit.point))?;
        Some(Vector2::new(pixel.u - centre.u, pixel.v - centre.v))
    };
    let (a, b) = (edge(u)?, edge(v)?);
    let width =
        |axis: Vector2<f64>| (a.dot(&axis) * a.dot(&axis) + b.dot(&axis) * b.dot(&axis)).sqrt();
    Some(width(along) / width(across))
}

/// What the widths and the lopsidedness of the vessel's spots say of the two glows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glows {
    /// The inner face's share q of the light, from 0 (no inner glow) to 1/2 (both alike).
    pub share: f64,
    /// One standard deviation of it.
    pub share_sigma: f64,
    /// The wall's thickness that the glows themselves suggest, mm: from width and lopsidedness together,
    /// with the given thickness serving for scale alone. `None` where they tell nothing.
    pub thickness: Option<f64>,
}

/// Estimates the share from the vessel spots; `None` for too few of them.
pub(super) fn estimate(spots: &[(&Spot, Faces)], thickness: f64) -> Option<Glows> {
    const LEAST: usize = 3;
    /// Standard deviation of the unknown f, uniform from 0 to 1.
    const BEAM_PART_SIGMA: f64 = 0.29;
    if spots.len() < LEAST {
        return None;
    }
    let mut excesses = Vec::new();
    let mut skews = Vec::new();
    let mut slack = 0.0;
    for (spot, faces) in spots {
        let distance = faces.offset.norm();
        let along = faces.offset / distance;
        let across = Vector2::new(-along.y, along.x);
        let wide = spot.width_along(across);
        let footprint = faces.stretch * faces.stretch - 1.0;
        let own = wide * (1.0 + 0.5 * footprint);
        let square = distance * distance;
        excesses.push((spot.width_along(along) - own) / square);
        skews.push(spot.skew_along(along) / (square * distance));
        slack += (BEAM_PART_SIGMA * footprint * wide / square).abs();
    }
    let count = spots.len() as f64;
    let (excess, sampling) = median_and_sigma(excesses);
    let (skew, _) = median_and_sigma(skews);
    let sigma = (sampling * sampling + (slack / count) * (slack / count)).sqrt();
    // q (1 - q) d^2 and q (1 - q) (1 - 2q) d^3 make d^2 = (skew / excess)^2 + 4 excess.
    let ratio = skew / excess;
    let scale = (ratio * ratio + 4.0 * excess).sqrt();
    let (share, share_sigma) = with_prior(excess, sigma);
    Some(Glows {
        share,
        share_sigma,
        thickness: (excess > 4.0 * sigma && scale.is_finite()).then_some(thickness * scale),
    })
}

/// The share from the measured q (1 - q), together with what is known beforehand: the inner face's glow
/// is the fainter one, about a fifth of the light. Where the two glows lie less than a spot's width
/// apart, this is nearly all there is to know.
fn with_prior(excess: f64, sigma: f64) -> (f64, f64) {
    const PRIOR: f64 = 0.16;
    const PRIOR_SIGMA: f64 = 0.06;
    let (measured, prior) = (1.0 / (sigma * sigma), 1.0 / (PRIOR_SIGMA * PRIOR_SIGMA));
    let excess = (excess * measured + PRIOR * prior) / (measured + prior);
    let sigma = 1.0 / (measured + prior).sqrt();
    (
        share(excess),
        0.5 * (share(excess + sigma) - share(excess - sigma)),
    )
}

/// The smaller q with q (1 - q) = excess.
fn share(excess: f64) -> f64 {
    0.5 * (1.0 - (1.0 - 4.0 * excess.clamp(0.0, 0.25)).sqrt())
}

/// The median and its own standard deviation, 1.25 times that of a mean.
fn median_and_sigma(values: Vec<f64>) -> (f64, f64) {
    let root = (values.len() as f64).sqrt();
    let middle = median(values.clone());
    let off: Vec<f64> = values.iter().map(|x| x - middle).collect();
    (middle, 1.25 * robust_scale(&off) / root)
}
