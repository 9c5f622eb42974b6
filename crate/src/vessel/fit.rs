use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};

use super::Wall;
use super::pick::{Candidate, along_epipolar_line, on_beam};
use crate::camera::Pixel;
use crate::geometry::{
    Camera, Direction, FitError, PlaneFit, Point, Pose, WeightedPoint, World, fit_plane,
    weighted_plane,
};
use crate::optics::Surface;
use crate::rig::Rig;
use crate::scan::Station;
use crate::spots::Spots;

/// How the wall is found.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct VesselSettings {
    /// A spot this near the epipolar line may lie on the wall, px.
    pub epipolar_tolerance: f64,
    /// A vessel point this many robust standard deviations off the surface is none.
    pub outlier: f64,
}

impl Default for VesselSettings {
    fn default() -> Self {
        Self {
            epipolar_tolerance: 5.0,
            outlier: 5.0,
        }
    }
}

/// A point of the wall's outer face, as one view shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VesselPoint {
    /// Which of the view's spots.
    pub spot: usize,
    /// Where it was seen.
    pub pixel: Pixel,
    /// The point.
    pub point: Point<World>,
    /// One standard deviation across the wall, from the centroid's noise, mm.
    pub sigma: f64,
    /// How far the spot lies off the epipolar line, px: a health figure of the calibration.
    pub off_line: f64,
    /// How far the point lies in front of the fitted wall, mm.
    pub residual: f64,
}

/// The wall and the points that carry it.
#[derive(Clone, Debug, PartialEq)]
pub struct VesselFit {
    /// The wall.
    pub wall: Wall,
    /// The vessel point of each view, if it has one.
    pub points: Vec<Option<VesselPoint>>,
    /// Root mean square residual of the points, mm.
    pub rms: f64,
    /// The weight of each view's point in the fit, 1/mm^2.
    weights: Vec<f64>,
}

/// Why there is no wall.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum VesselError {
    /// No spot of any view lies near the epipolar line.
    #[error(
        "no view has a spot within {tolerance} px of the epipolar line, so the vessel's wall is not \
         seen; check the laser's calibration and that the on and off pictures are not exchanged"
    )]
    NoSpots {
        /// How near it would have to be, px.
        tolerance: f64,
    },
    /// The points make no surface.
    #[error("the vessel's wall cannot be fitted: {0}")]
    Fit(#[from] FitError),
}

/// Finds the wall: in each view the first spot along the epipolar line, triangulated in air; then a
/// robust plane through these points; then, for each view, the first spot along the line that lies on
/// that plane (a ghost before the wall is passed over), and the plane once more.
pub fn find_vessel(
    rig: &Rig,
    stations: &[Station],
    spots: &[Spots],
    thickness: f64,
    settings: &VesselSettings,
) -> Result<VesselFit, VesselError> {
    let candidates: Vec<Vec<Candidate>> = spots
        .iter()
        .map(|view| along_epipolar_line(rig, &view.spots, settings.epipolar_tolerance))
        .collect();
    if candidates.iter().all(Vec::is_empty) {
        return Err(VesselError::NoSpots {
            tolerance: settings.epipolar_tolerance,
        });
    }
    let front = mean_position(stations);
    let place = |view: usize, c: &Candidate| stations[view].world_from_camera.point(c.point);

    let firsts = candidates.iter().enumerate().filter_map(|(view, list)| {
        let c = list.first()?;
        Some(WeightedPoint {
            point: place(view, c),
            sigma: c.sigma,
        })
    });
    let start = fit_plane(&firsts.collect::<Vec<_>>(), front)?;

    let limit = settings.outlier * start.scale.max(1e-6);
    let picks: Vec<Option<Candidate>> = candidates
        .iter()
        .enumerate()
        .map(|(view, list)| {
            let off = |c: &Candidate| start.plane.signed_distance(place(view, c)).abs();
            let near = |c: &&Candidate| off(c) <= limit.max(settings.outlier * c.sigma);
            list.iter().find(near).copied()
        })
        .collect();

    let across =
        |view: usize| obliquity(rig, &stations[view].world_from_camera, start.plane.normal);
    let points: Vec<WeightedPoint<World>> = picks
        .iter()
        .enumerate()
        .filter_map(|(view, pick)| pick.as_ref().map(|c| (view, c)))
        .map(|(view, c)| WeightedPoint {
            point: place(view, c),
            sigma: c.sigma * across(view),
        })
        .collect();
    let fit = fit_plane(&points, front)?;
    Ok(assemble(&picks, spots, &points, &fit, thickness))
}

fn assemble(
    picks: &[Option<Candidate>],
    spots: &[Spots],
    points: &[WeightedPoint<World>],
    fit: &PlaneFit<World>,
    thickness: f64,
) -> VesselFit {
    let mut next = 0;
    let mut weights = vec![0.0; picks.len()];
    let mut found = vec![None; picks.len()];
    for (view, pick) in picks.iter().enumerate() {
        let Some(c) = pick else { continue };
        let WeightedPoint { point, sigma } = points[next];
        weights[view] = fit.weights[next];
        next += 1;
        // A point that the fit refused is no point of the wall.
        found[view] = (weights[view] > 0.0).then(|| VesselPoint {
            spot: c.spot,
            pixel: spots[view].spots[c.spot].pixel(),
            point,
            sigma,
            off_line: c.off_line,
            residual: fit.plane.signed_distance(point),
        });
    }
    VesselFit {
        wall: Wall {
            outer: Surface::Plane(fit.plane),
            thickness,
            covariance: DMatrix::from_iterator(3, 3, fit.covariance.iter().copied()),
        },
        points: found,
        rms: fit.rms,
        weights,
    }
}

impl VesselFit {
    /// The wall that the same spots, with the same weights, would give if the range finder were `rig`:
    /// how an error of calibration passes into the wall.
    pub fn refitted(&self, rig: &Rig, stations: &[Station]) -> Option<Wall> {
        let mut points = Vec::new();
        let mut weights = Vec::new();
        let measured = self.points.iter().zip(stations).zip(&self.weights);
        for ((point, station), weight) in measured {
            let Some(point) = point else { continue };
            let world_from_camera = rig.station(&station.world_from_flange);
            points.push(WeightedPoint {
                point: world_from_camera.point(on_beam(rig, point.pixel)?.point),
                sigma: point.sigma,
            });
            weights.push(*weight);
        }
        let plane = weighted_plane(&points, &weights, mean_position(stations)).ok()?;
        Some(Wall {
            outer: Surface::Plane(plane),
            ..self.wall.clone()
        })
    }

    /// The median of how far the vessel's spots lie off the epipolar line, px, with its sign: 0 if the
    /// laser's calibration is right.
    pub fn median_off_line(&self) -> Option<f64> {
        let mut off: Vec<f64> = self.points.iter().flatten().map(|p| p.off_line).collect();
        off.sort_by(f64::total_cmp);
        off.get(off.len() / 2).copied()
    }
}

/// What an error along the beam counts across the wall: the cosine of the beam's incidence.
fn obliquity(rig: &Rig, world_from_camera: &Pose<World, Camera>, normal: Direction<World>) -> f64 {
    world_from_camera
        .direction(rig.beam.direction)
        .dot(normal)
        .abs()
}

fn mean_position(stations: &[Station]) -> Point<World> {
    let sum: nalgebra::Vector3<f64> = stations
        .iter()
        .map(|s| s.world_from_camera.translation())
        .sum();
    Point::from_coords(sum / stations.len() as f64)
}
