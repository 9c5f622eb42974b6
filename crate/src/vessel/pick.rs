//! Which of a view's spots may lie on the wall.

use crate::camera::Pixel;
use crate::geometry::{Camera, Direction, Point};
use crate::rig::{Calibration, CalibrationSigma, LitPoint, Rig};
use crate::robust::sort_stably;
use crate::spots::{Spot, SpotRole, Spots};

/// A spot near the epipolar line, taken for a point of the beam in air.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Candidate {
    /// Which of the view's spots.
    pub(super) spot: usize,
    /// Its place on the beam.
    pub(super) point: Point<Camera>,
    /// How far along the beam, mm.
    pub(super) along: f64,
    /// One standard deviation of that from the centroid's noise, mm.
    pub(super) sigma: f64,
    /// Which way such an error moves the point.
    pub(super) way: Direction<Camera>,
    /// How far off the epipolar line, px, with a sign; a sheet has none.
    pub(super) off_line: Option<f64>,
    /// Whether a person says that it lies on the wall.
    pub(super) said: bool,
}

/// The spots within `tolerance` (px) of the epipolar line, in their order along the beam: the first of
/// them is the wall's, whichever side the laser is on (section II-C). Before them all comes the spot of
/// which a person says so, and those that are said to be something else are left out.
pub(super) fn along_epipolar_line(rig: &Rig, spots: &Spots, tolerance: f64) -> Vec<Candidate> {
    let all = spots.spots.iter().enumerate();
    let mut candidates: Vec<Candidate> = all
        .filter(|(index, _)| spots.may_be(*index, SpotRole::Vessel))
        .filter_map(|(index, spot)| {
            let said = spots.said_of(index).is_some();
            candidate(rig, index, spot, said)
        })
        .filter(|c| c.said || c.off_line.is_some_and(|off| off.abs() <= tolerance))
        .collect();
    sort_stably(&mut candidates, |a, b| {
        b.said.cmp(&a.said).then(a.along.total_cmp(&b.along))
    });
    candidates
}

fn candidate(rig: &Rig, index: usize, spot: &Spot, said: bool) -> Option<Candidate> {
    let here = lit_point(rig, spot.pixel())?;
    Some(Candidate {
        spot: index,
        point: here.point,
        along: here.along,
        sigma: sigma_along(rig, spot, 0.0)?,
        way: rig.laser.ray_to(here.point)?.direction,
        off_line: here.off_line.map(|off| off * rig.camera.mean_focal()),
        said,
    })
}

/// Triangulates a pixel in air.
pub(super) fn lit_point(rig: &Rig, pixel: Pixel) -> Option<LitPoint> {
    rig.triangulate(rig.camera.slope(pixel).ok()?)
}

/// First-order propagation of the centroid's covariance, with the grain of laser light, to the place
/// along the beam.
pub(super) fn sigma_along(rig: &Rig, spot: &Spot, grain: f64) -> Option<f64> {
    const H: f64 = 0.01;
    let Pixel { u, v } = spot.pixel();
    let along = |u, v| lit_point(rig, Pixel::new(u, v)).map(|p| p.along);
    let slope = nalgebra::Vector2::new(
        (along(u + H, v)? - along(u - H, v)?) / (2.0 * H),
        (along(u, v + H)? - along(u, v - H)?) / (2.0 * H),
    );
    Some(
        (slope.transpose() * spot.covariance_with(grain) * slope)
            .x
            .sqrt(),
    )
}

/// First-order propagation of calibration's errors to how far a pixel lies off the epipolar line: one
/// standard deviation, px.
pub(super) fn line_sigma(rig: &Rig, sigma: &CalibrationSigma, pixel: Pixel) -> Option<f64> {
    const STEP: f64 = 1e-3;
    let off = |number: Calibration, step: f64| {
        let moved = number.nudge(rig, step);
        Some(lit_point(&moved, pixel)?.off_line? * moved.camera.mean_focal())
    };
    let mut variance = 0.0;
    for number in Calibration::ALL {
        let h = STEP * number.sigma(sigma);
        let change = (off(number, h)? - off(number, -h)?) / (2.0 * STEP);
        variance += change * change;
    }
    Some(variance.sqrt())
}
