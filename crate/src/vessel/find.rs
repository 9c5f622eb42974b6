use nalgebra::{DVector, Vector2, Vector3};
use serde::{Deserialize, Serialize};

use super::evidence::{Alternative, Told};
use super::glow::{self, Faces, Glows};
use super::grain::{self, OffLine};
use super::pick::{self, Candidate};
use super::refine::{SurfaceFit, hold};
use super::shape::{self, ShapeChoice};
use super::wall::{FarWall, NoRoom, Wall};
use crate::camera::Pixel;
use crate::geometry::{FitError, Point, WeightedPoint, World};
use crate::optics::{Media, Surface};
use crate::rig::{CalibrationSigma, Laser, Rig};
use crate::robust;
use crate::scan::{Scan, Station, VesselShape};
use crate::spots::{Grain, Spot, Spots};

/// How the wall is found.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct VesselSettings {
    /// A spot this near the epipolar line may lie on the wall, px; where few views have one, or all of
    /// them lie to one side, a spot as near as calibration is worth.
    pub epipolar_tolerance: f64,
    /// A vessel point this many robust standard deviations off the surface is none.
    pub outlier: f64,
    /// Whether the glow of the wall's inner face is told from that of the outer one.
    pub separate_glows: bool,
    /// The wall's shape, in place of the manifest's.
    pub shape: Option<VesselShape>,
}

impl Default for VesselSettings {
    fn default() -> Self {
        Self {
            epipolar_tolerance: 5.0,
            outlier: 5.0,
            separate_glows: true,
            shape: None,
        }
    }
}

/// A point of the wall's outer face, as one view shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VesselPoint {
    /// Which of the view's spots.
    pub spot: usize,
    /// Where the outer face's own glow is seen: the spot's centroid less what the inner glow does to it.
    pub pixel: Pixel,
    /// How `pixel` moves back with the inner glow's share, px; zero where both glows are seen in
    /// one place.
    pub by_glow_share: Vector2<f64>,
    /// The point.
    pub point: Point<World>,
    /// One standard deviation across the wall, from the centroid's noise, mm.
    pub sigma: f64,
    /// How far the spot lies off the epipolar line, px: a health figure of the calibration. A sheet has
    /// no such line.
    pub off_line: Option<f64>,
    /// How far the point lies in front of the fitted wall, mm.
    pub residual: f64,
}

/// The wall and the points that carry it.
#[derive(Clone, Debug, PartialEq)]
pub struct VesselFit {
    /// The wall.
    pub wall: Wall,
    /// The vessel points of each view: at most one for a beam.
    pub points: Vec<Vec<VesselPoint>>,
    /// Root mean square residual of the points, mm.
    pub rms: f64,
    /// The grain of the laser's light.
    pub grain: Grain,
    /// What the spots say of the wall's two glows.
    pub glows: Option<Glows>,
    /// What `auto` decided between.
    pub choice: Option<ShapeChoice>,
    /// Whether the wall was known beforehand, so that no error of measurement moves it.
    pub known: bool,
    /// What the fit's rows stand for.
    rows: Vec<Row>,
    fit: SurfaceFit,
    told: Option<Told>,
}

/// A row of the fit: where a view saw the wall.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Row {
    view: usize,
    pixel: Pixel,
    point: Point<World>,
}

/// Why there is no wall.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum VesselError {
    /// No view shows a line long enough to be the wall's.
    #[error(
        "no view shows the laser's line on the vessel's wall; check the laser's calibration and that \
         the on and off pictures are not exchanged"
    )]
    NoLine,
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
    /// A shape needs more points.
    #[error(
        "the vessel's wall cannot be fitted: a {shape} needs at least {needed} vessel points, and there are {found}"
    )]
    TooFewPoints {
        /// The shape.
        shape: &'static str,
        /// How many it needs.
        needed: usize,
        /// How many there are.
        found: usize,
    },
    /// The points leave the shape open.
    #[error(
        "the vessel's wall cannot be fitted: the vessel points do not determine a {shape}; measure a \
         larger part of the wall, or give another vessel.shape"
    )]
    Undetermined {
        /// The shape.
        shape: &'static str,
    },
    /// The wall is thicker than the vessel.
    #[error(transparent)]
    NoRoom(#[from] NoRoom),
    /// The wall is not where the manifest says.
    #[error(
        "vessel: the wall given in scan.json misses the measured vessel points (they lie {median:+.1} mm \
         in front of it, median); check its place and frame, or leave it out to have it measured"
    )]
    KnownWallMisses {
        /// How far in front of the given wall the points lie, median, mm.
        median: f64,
    },
    /// Only flat vessels have a far wall.
    #[error("vessel.far_wall: a far wall is measured through flat vessels alone")]
    FarWallNotFlat,
}

/// Finds the wall.
///
/// In each view the first spot along the epipolar line is taken and triangulated in air; a robust
/// surface goes through these points. Then each view's first spot that lies on that surface is taken (a
/// ghost before the wall is passed over), the two glows of the wall are told apart, and the surface is
/// fitted once more.
pub fn find_vessel(
    scan: &Scan,
    spots: &[Spots],
    media: &Media,
    settings: &VesselSettings,
) -> Result<VesselFit, VesselError> {
    let finder = Finder {
        rig: &scan.rig,
        calibration_sigma: &scan.calibration_sigma,
        stations: &scan.stations,
        spots,
        media,
        settings,
        shape: settings.shape.unwrap_or(scan.manifest.vessel.shape),
        known: scan.known_wall.clone().filter(|_| settings.shape.is_none()),
        thickness: scan.manifest.vessel.wall_thickness,
        far: scan.manifest.vessel.far_wall.as_ref().map(|far| FarWall {
            distance: far.distance,
            thickness: far.thickness,
        }),
        front: usual_place(&scan.stations),
    };
    match &scan.rig.laser {
        Laser::Beam(_) => finder.find(),
        Laser::Sheet(sheet) => finder.find_on_line(sheet),
    }
}

/// What does not change while the wall is found.
pub(super) struct Finder<'a> {
    pub(super) rig: &'a Rig,
    calibration_sigma: &'a CalibrationSigma,
    pub(super) stations: &'a [Station],
    pub(super) spots: &'a [Spots],
    media: &'a Media,
    pub(super) settings: &'a VesselSettings,
    pub(super) shape: VesselShape,
    pub(super) known: Option<Surface>,
    pub(super) thickness: f64,
    far: Option<FarWall>,
    pub(super) front: Point<World>,
}

/// A view's vessel spot, and where its outer glow is.
#[derive(Clone, Copy)]
pub(super) struct Pick {
    pub(super) view: usize,
    pub(super) candidate: Candidate,
    pub(super) pixel: Pixel,
}

impl Finder<'_> {
    fn find(&self) -> Result<VesselFit, VesselError> {
        let (merged, start, choice) = self.pick_spots()?;
        let first = self.refit(&merged, &start.surface)?;
        let faces = self.faces(&merged, &self.wall(first.surface.clone())?);
        let glows = self.glows(&merged, &faces);
        let share = glows.map_or(0.0, |glows| glows.share);
        let mut picks = self.without_inner_glow(&merged, &faces, share);
        let grain = self.add_grain(&mut picks);
        let mut fit = self.refit(&picks, &first.surface)?;
        if let (Some(glows), None) = (&glows, &self.known) {
            let more = self.without_inner_glow(&merged, &faces, share + glows.share_sigma);
            self.add_uncertainty(&mut fit, &more);
        }
        self.assemble(&picks, &faces, fit, (grain, glows, choice))
    }

    /// The spots of each view that may lie on the wall: those near the epipolar line or, where few views
    /// have any or all of them lie to one side, those as near to it as it is known itself.
    fn candidates(&self) -> Result<Vec<Vec<Candidate>>, VesselError> {
        /// Calibration is hardly ever off by more standard deviations than this.
        const SIGMAS: f64 = 4.0;
        let within = |tolerance: f64| -> Vec<Vec<Candidate>> {
            let views = self.spots.iter();
            views
                .map(|view| pick::along_epipolar_line(self.rig, view, tolerance))
                .collect()
        };
        let offs = |views: &[Vec<Candidate>]| -> Vec<f64> {
            let firsts = views.iter().filter_map(|view| view.first());
            firsts.filter_map(|c| c.off_line).collect()
        };
        let mut tolerance = self.settings.epipolar_tolerance;
        let mut candidates = within(tolerance);
        let seen = offs(&candidates);
        let lit = self.spots.iter().filter(|view| !view.spots.is_empty());
        let few = seen.is_empty() || 2 * seen.len() < lit.count();
        if few || 2.0 * robust::median(seen).abs() > tolerance {
            tolerance = tolerance.max(SIGMAS * self.line_sigma());
            candidates = within(tolerance);
        }
        if candidates.iter().all(Vec::is_empty) {
            return Err(VesselError::NoSpots { tolerance });
        }
        Ok(candidates)
    }

    /// How far calibration may put spots off the epipolar line: one standard deviation, px, median over
    /// all spots.
    fn line_sigma(&self) -> f64 {
        let spots = self.spots.iter().flat_map(|view| &view.spots);
        let sigma = |spot: &Spot| pick::line_sigma(self.rig, self.calibration_sigma, spot.pixel());
        let sigmas: Vec<f64> = spots.filter_map(sigma).collect();
        if sigmas.is_empty() {
            0.0
        } else {
            robust::median(sigmas)
        }
    }

    /// Each view's spot on the wall, and a first fit.
    fn pick_spots(&self) -> Result<(Vec<Pick>, SurfaceFit, Option<ShapeChoice>), VesselError> {
        let candidates = self.candidates()?;
        let place =
            |view: usize, c: &Candidate| self.stations[view].world_from_camera.point(c.point);
        let firsts = candidates.iter().enumerate().filter_map(|(view, list)| {
            let c = list.first()?;
            Some(WeightedPoint {
                point: place(view, c),
                sigma: c.sigma,
            })
        });
        let firsts: Vec<_> = firsts.collect();
        let (start, choice) = match &self.known {
            Some(known) => (self.hold_against(known.clone(), &firsts)?, None),
            None => shape::fit(&firsts, self.front, self.shape)?,
        };
        let limit = self.settings.outlier * start.scale.max(1e-6);
        let on_wall = |(view, list): (usize, &Vec<Candidate>)| {
            let off = |c: &Candidate| start.surface.signed_distance(place(view, c)).abs();
            let near =
                |c: &&Candidate| c.said || off(c) <= limit.max(self.settings.outlier * c.sigma);
            let candidate = *list.iter().find(near)?;
            let pixel = self.spot(view, &candidate).pixel();
            Some(Pick {
                view,
                candidate,
                pixel,
            })
        };
        let picks = candidates.iter().enumerate().filter_map(on_wall).collect();
        Ok((picks, start, choice))
    }

    /// Holds the points against a wall that is known beforehand.
    pub(super) fn hold_against(
        &self,
        known: Surface,
        points: &[WeightedPoint<World>],
    ) -> Result<SurfaceFit, VesselError> {
        const FARTHEST: f64 = 5.0;
        let fit = hold(points, known);
        let median = robust::median(fit.residuals.iter().copied().collect());
        if median.abs() > FARTHEST || fit.scale > FARTHEST {
            return Err(VesselError::KnownWallMisses { median });
        }
        Ok(fit)
    }

    /// Estimates the grain of the laser's light and counts it into the picks' standard deviations.
    fn add_grain(&self, picks: &mut [Pick]) -> Grain {
        let Some(line) = self.rig.epipolar_line() else {
            return Grain::default();
        };
        let normal = line.normal();
        let off_line = |pick: &Pick| {
            let spot = self.spot(pick.view, &pick.candidate);
            OffLine {
                along: pick.candidate.along,
                off: pick.candidate.off_line.unwrap_or(0.0),
                variance: (normal.transpose() * spot.covariance_matrix() * normal).x,
                unit: (normal.transpose() * spot.grain_covariance() * normal).x,
            }
        };
        let grain = grain::estimate(&picks.iter().map(off_line).collect::<Vec<_>>());
        for pick in picks {
            let spot = self.spot(pick.view, &pick.candidate);
            if let Some(sigma) = pick::sigma_along(self.rig, spot, grain.value) {
                pick.candidate.sigma = sigma;
            }
        }
        grain
    }

    fn spot(&self, view: usize, candidate: &Candidate) -> &Spot {
        &self.spots[view].spots[candidate.spot]
    }

    /// Triangulates the picks in air.
    fn points(&self, picks: &[Pick], near: &Surface) -> Vec<WeightedPoint<World>> {
        let rig = self.rig;
        let one = |pick: &Pick| {
            let world_from_camera = rig.station(&self.stations[pick.view].world_from_flange);
            let point = match pick::lit_point(rig, pick.pixel) {
                Some(lit) => world_from_camera.point(lit.point),
                None => world_from_camera.point(pick.candidate.point),
            };
            let way = world_from_camera.direction(pick.candidate.way);
            // An error along the light counts across the wall by the cosine of incidence.
            let cosine = near
                .normal_at(point)
                .map_or(1.0, |normal| way.dot(normal).abs());
            WeightedPoint {
                point,
                sigma: pick.candidate.sigma * cosine,
            }
        };
        picks.iter().map(one).collect()
    }

    pub(super) fn refit(&self, picks: &[Pick], start: &Surface) -> Result<SurfaceFit, VesselError> {
        let points = self.points(picks, start);
        if let Some(known) = &self.known {
            return Ok(hold(&points, known.clone()));
        }
        shape::refit(&points, start).ok_or(VesselError::Undetermined { shape: "wall" })
    }

    pub(super) fn wall(&self, outer: Surface) -> Result<Wall, VesselError> {
        if self.far.is_some() && !matches!(outer, Surface::Plane(_)) {
            return Err(VesselError::FarWallNotFlat);
        }
        let wall = Wall::exact(outer, self.thickness, self.far);
        wall.stack(self.media, Default::default())?;
        Ok(wall)
    }

    pub(super) fn faces(&self, picks: &[Pick], wall: &Wall) -> Vec<Option<Faces>> {
        let one = |pick: &Pick| {
            let pose = &self.stations[pick.view].world_from_camera;
            let light = self.rig.laser.ray_to(pick.candidate.point)?;
            glow::faces(&self.rig.camera, &light, pose, wall, self.media)
        };
        picks.iter().map(one).collect()
    }

    fn glows(&self, picks: &[Pick], faces: &[Option<Faces>]) -> Option<Glows> {
        if !self.settings.separate_glows {
            return None;
        }
        let seen: Vec<(&Spot, Faces)> = picks
            .iter()
            .zip(faces)
            .filter_map(|(pick, faces)| Some((self.spot(pick.view, &pick.candidate), (*faces)?)))
            .filter(|(spot, _)| !spot.saturated)
            .collect();
        glow::estimate(&seen, self.thickness)
    }

    /// The picks with the inner glow's part taken out of the centroids.
    fn without_inner_glow(&self, picks: &[Pick], faces: &[Option<Faces>], share: f64) -> Vec<Pick> {
        let one = |(pick, faces): (&Pick, &Option<Faces>)| {
            let mut pick = *pick;
            if let Some(faces) = faces {
                let shift = faces.shift(self.spot(pick.view, &pick.candidate), share);
                pick.pixel.u -= shift.x;
                pick.pixel.v -= shift.y;
            }
            if let Some(lit) = pick::lit_point(self.rig, pick.pixel) {
                pick.candidate.off_line =
                    lit.off_line.map(|off| off * self.rig.camera.mean_focal());
            }
            pick
        };
        picks.iter().zip(faces).map(one).collect()
    }

    /// An error that moves all vessel points to those of `moved` moves the wall with them.
    pub(super) fn add_uncertainty(&self, fit: &mut SurfaceFit, moved: &[Pick]) {
        let points = self.points(moved, &fit.surface);
        let shift = |(p, before): (&WeightedPoint<World>, &f64)| {
            fit.surface.signed_distance(p.point) - before
        };
        let shifts = points.iter().zip(&fit.residuals).map(shift);
        let shifts = DVector::from_iterator(points.len(), shifts);
        if let Some(step) = fit.response(&shifts) {
            fit.add_error(&step);
        }
    }

    pub(super) fn assemble(
        &self,
        picks: &[Pick],
        faces: &[Option<Faces>],
        fit: SurfaceFit,
        (grain, glows, choice): (Grain, Option<Glows>, Option<ShapeChoice>),
    ) -> Result<VesselFit, VesselError> {
        let mut points = vec![Vec::new(); self.stations.len()];
        let places = self.points(picks, &fit.surface);
        let share = glows.map_or(0.0, |glows| glows.share);
        for (row, (pick, place)) in picks.iter().zip(&places).enumerate() {
            // A point that the fit refused is no point of the wall.
            points[pick.view].extend((fit.weights[row] > 0.0).then(|| VesselPoint {
                spot: pick.candidate.spot,
                pixel: pick.pixel,
                by_glow_share: faces[row].map_or_else(Vector2::zeros, |faces| {
                    faces.shift_by_share(self.spot(pick.view, &pick.candidate), share)
                }),
                point: place.point,
                sigma: place.sigma,
                off_line: pick.candidate.off_line,
                residual: fit.residuals[row],
            }));
        }
        let mut wall = self.wall(fit.surface.clone())?;
        wall.covariance = fit.covariance.clone();
        let row = |(pick, place): (&Pick, &WeightedPoint<World>)| Row {
            view: pick.view,
            pixel: pick.pixel,
            point: place.point,
        };
        Ok(VesselFit {
            wall,
            points,
            rms: fit.rms,
            grain,
            glows,
            choice,
            known: self.known.is_some(),
            rows: picks.iter().zip(&places).map(row).collect(),
            fit,
            told: None,
        })
    }
}

impl VesselFit {
    /// The wall that the same spots, with the same weights, would give if the range finder were `rig`:
    /// how an error of calibration passes into the wall, to first order.
    pub fn refitted(&self, rig: &Rig, stations: &[Station]) -> Option<Wall> {
        if self.known {
            return Some(self.wall.clone());
        }
        let mut shifts = DVector::zeros(self.rows.len());
        let supporting = |row: &usize| self.fit.weights[*row] > 0.0;
        for row in (0..self.rows.len()).filter(supporting) {
            let Row { view, pixel, .. } = self.rows[row];
            let world_from_camera = rig.station(&stations[view].world_from_flange);
            let moved = world_from_camera.point(pick::lit_point(rig, pixel)?.point);
            shifts[row] = self.wall.outer.signed_distance(moved) - self.fit.residuals[row];
        }
        Some(self.wall.nudged(&self.fit.response(&shifts)?))
    }

    /// What else was measured than the wall's own points, and how the wall follows it.
    pub const fn told(&self) -> Option<&Told> {
        self.told.as_ref()
    }

    /// The free forms that its points leave open, as steps from the wall; none where it is of a simple shape.
    pub fn alternatives(&self) -> &[Alternative] {
        &self.fit.alternatives
    }

    /// The wall moved by the step in its parameters that other measurements ask for.
    pub fn told_by(&self, told: Told) -> Self {
        let mut fit = self.clone();
        fit.wall = Wall {
            covariance: told.covariance().clone(),
            ..self.wall.nudged(told.step())
        };
        let outer = &fit.wall.outer;
        for (residual, row) in fit.fit.residuals.iter_mut().zip(&fit.rows) {
            *residual = outer.signed_distance(row.point);
        }
        for point in fit.points.iter_mut().flatten() {
            point.residual = outer.signed_distance(point.point);
        }
        fit.rms = rms(&fit.points);
        fit.fit.alternatives.clear();
        fit.told = Some(told);
        fit
    }

    /// Takes all points of a line in place of those few that the fit was made with.
    pub(super) fn replace_points(&mut self, points: Vec<Vec<VesselPoint>>) {
        self.rms = rms(&points);
        self.points = points;
    }

    /// The median of how far the vessel's spots lie off the epipolar line, px, with its sign: 0 if the
    /// laser's calibration is right.
    pub fn median_off_line(&self) -> Option<f64> {
        let points = self.points.iter().flatten();
        let off: Vec<f64> = points.filter_map(|p| p.off_line).collect();
        (!off.is_empty()).then(|| robust::median(off))
    }
}

/// Root mean square residual, mm.
fn rms(points: &[Vec<VesselPoint>]) -> f64 {
    let squares = points.iter().flatten().map(|p| p.residual * p.residual);
    let count = points.iter().flatten().count();
    (squares.sum::<f64>() / count.max(1) as f64).sqrt()
}

/// Where the rig usually stands: the station nearest to the mean of all. The mean itself may lie within
/// the vessel, where the rig went all the way around it.
fn usual_place(stations: &[Station]) -> Point<World> {
    let places = stations.iter().map(|s| s.world_from_camera.translation());
    let mean = places.clone().sum::<Vector3<f64>>() / stations.len() as f64;
    let nearest = places.min_by(|a, b| (a - mean).norm().total_cmp(&(b - mean).norm()));
    Point::from_coords(nearest.unwrap_or(mean))
}
