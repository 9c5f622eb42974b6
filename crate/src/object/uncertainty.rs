//! First-order propagation: covariance of the point = J covariance J^T, with J by differences.

use nalgebra::{DVector, Matrix3, Vector3};

use super::{Meeting, MeetingError, Setup, laser_ray, line_of_sight, meet};
use crate::camera::Pixel;
use crate::geometry::{Point, World};
use crate::optics::{Media, Path, Stack};
use crate::rig::{Calibration, Rig};
use crate::scan::{InsideMedium, Station};
use crate::spots::Spot;
use crate::vessel::Wall;

/// What the pictures' noise does to one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// Covariance of the point from the centroid's noise and the wall's fit, mm^2.
    pub covariance: Matrix3<f64>,
    /// One standard deviation of the signed ray distance, mm.
    pub gap: f64,
    /// The part of the ray distance's variance that the camera's noise makes at this spot alone, mm^2.
    pub gap_camera: f64,
    /// What one unit of grain adds to the ray distance's variance, mm^2.
    pub gap_grain: f64,
}

impl Noise {
    /// One standard deviation along each axis, mm.
    pub fn sigma(&self) -> Vector3<f64> {
        self.covariance.diagonal().map(f64::sqrt)
    }
}

/// How the point and the gap change with one number.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slope {
    point: Vector3<f64>,
    gap: f64,
}

impl Slope {
    pub(super) fn between(ahead: &Meeting, back: &Meeting, step: f64) -> Self {
        Self {
            point: (ahead.point() - back.point()) / (2.0 * step),
            gap: (ahead.gap() - back.gap()) / (2.0 * step),
        }
    }

    /// How the point changes if something else follows, which alone changes it as `follower` says, so that
    /// the gap stays.
    pub(super) fn following(&self, follower: &Self) -> Vector3<f64> {
        self.point - follower.point * (self.gap / follower.gap)
    }
}

/// Steps for the central differences: px, and radians or mm of the wall's parameters. Far above
/// rounding, far below where the light paths bend noticeably.
pub(super) const PIXEL_STEP: f64 = 1e-3;
pub(super) const WALL_STEP: f64 = 1e-5;

/// Propagates the centroid's covariance and that of the wall's fit to a point.
///
/// `grain` is that of the laser's light, see [`Spot::covariance_with`]. Fails where a ray that is moved a
/// little no longer gets through.
pub fn noise(
    setup: &Setup,
    station: &Station,
    spot: &Spot,
    grain: f64,
) -> Result<Noise, MeetingError> {
    let wall = &setup.vessel.wall;
    let stack = wall.stack(&setup.media, station.inside)?;
    let seen = |du: f64, dv: f64| {
        let pixel = Pixel::new(spot.u + du, spot.v + dv);
        meet(setup.rig, &station.world_from_camera, &stack, pixel)
    };
    let by_pixel = [
        Slope::between(
            &seen(PIXEL_STEP, 0.0)?,
            &seen(-PIXEL_STEP, 0.0)?,
            PIXEL_STEP,
        ),
        Slope::between(
            &seen(0.0, PIXEL_STEP)?,
            &seen(0.0, -PIXEL_STEP)?,
            PIXEL_STEP,
        ),
    ];
    // A free form has hundreds of parameters; what matters are those near the two light paths.
    let movers = wall
        .outer
        .movers(&crossings(setup, station, &stack, spot.pixel())?);
    let through = |parameter: usize, step: f64| {
        let mut steps = DVector::zeros(wall.outer.freedom());
        steps[parameter] = step;
        let stack = wall.nudged(&steps).stack(&setup.media, station.inside)?;
        meet(setup.rig, &station.world_from_camera, &stack, spot.pixel())
    };
    let by_wall = movers
        .iter()
        .map(|p| {
            Ok(Slope::between(
                &through(*p, WALL_STEP)?,
                &through(*p, -WALL_STEP)?,
                WALL_STEP,
            ))
        })
        .collect::<Result<Vec<_>, MeetingError>>()?;
    let camera = spot.covariance_matrix();
    let grainy = spot.covariance_with(grain);
    let (of_spot, gap) = propagated(&by_pixel, |i, j| grainy[(i, j)]);
    let (of_wall, wall_gap) = propagated(&by_wall, |i, j| wall.covariance[(movers[i], movers[j])]);
    let unit_of_grain = spot.grain_covariance();
    Ok(Noise {
        covariance: of_spot + of_wall,
        gap: (gap + wall_gap).sqrt(),
        gap_camera: propagated(&by_pixel, |i, j| camera[(i, j)]).1,
        gap_grain: propagated(&by_pixel, |i, j| unit_of_grain[(i, j)]).1,
    })
}

/// Where the laser's light and the line of sight of a pixel cross the wall's faces.
fn crossings(
    setup: &Setup,
    station: &Station,
    stack: &Stack,
    pixel: Pixel,
) -> Result<Vec<Point<World>>, MeetingError> {
    let pose = &station.world_from_camera;
    let beam = stack
        .path(&laser_ray(setup.rig, pose, stack, pixel)?)
        .map_err(MeetingError::Beam)?;
    let sight = stack
        .path(&line_of_sight(setup.rig, pose, pixel)?)
        .map_err(MeetingError::Sight)?;
    let bends = |path: Path| path.vertices.into_iter().skip(1);
    Ok(bends(beam).chain(bends(sight)).collect())
}

/// J C J^T for the point, and the same for the gap, a variance.
fn propagated(slopes: &[Slope], covariance: impl Fn(usize, usize) -> f64) -> (Matrix3<f64>, f64) {
    let (mut point, mut gap) = (Matrix3::zeros(), 0.0);
    for (i, a) in slopes.iter().enumerate() {
        for (j, b) in slopes.iter().enumerate() {
            point += a.point * b.point.transpose() * covariance(i, j);
            gap += a.gap * b.gap * covariance(i, j);
        }
    }
    (point, gap)
}

/// What an error common to all views does to a point and its ray distance: standard deviations, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CommonSigma {
    /// Of each coordinate.
    pub point: Vector3<f64>,
    /// Of the signed ray distance.
    pub gap: f64,
}

impl CommonSigma {
    /// Together with an independent error.
    pub fn and(&self, other: &Self) -> Self {
        let sum = |a: f64, b: f64| (a * a + b * b).sqrt();
        Self {
            point: self.point.zip_map(&other.point, sum),
            gap: sum(self.gap, other.gap),
        }
    }
}

/// What an error of calibration would do to the points of each view, given the pixels of their spots.
///
/// Each calibrated number is moved by a small part of its sigma, and everything that follows is done
/// again with the same spots: vessel points, the wall's fit, the light paths. So what an error does to
/// the wall is in it. A spot whose light paths do not meet counts as unmoved.
pub fn calibration_sigmas(setup: &Setup, pixels: &[Vec<Pixel>]) -> Vec<Vec<CommonSigma>> {
    const PART: f64 = 1e-3;
    let base = all_meetings(
        setup.rig,
        &setup.vessel.wall,
        &setup.media,
        setup.stations,
        pixels,
    );
    let none = CommonSigma {
        point: Vector3::zeros(),
        gap: 0.0,
    };
    let mut sums: Vec<Vec<CommonSigma>> = pixels.iter().map(|p| vec![none; p.len()]).collect();
    for number in Calibration::ALL {
        let one = number.sigma(setup.calibration_sigma);
        let off = number.nudge(setup.rig, one * PART);
        let Some(wall) = setup.vessel.refitted(&off, setup.stations) else {
            continue;
        };
        let moved = all_meetings(&off, &wall, &setup.media, setup.stations, pixels);
        let meetings = base.iter().flatten().zip(moved.iter().flatten());
        for (sum, meetings) in sums.iter_mut().flatten().zip(meetings) {
            if let (Some(before), Some(after)) = meetings {
                *sum = sum.and(&change(before, after, 1.0 / PART));
            }
        }
    }
    sums
}

/// What an error of the liquid's index, of one standard deviation, would do to the points of each view.
pub fn index_sigmas(setup: &Setup, pixels: &[Vec<Pixel>], sigma: f64) -> Vec<Vec<CommonSigma>> {
    const STEP: f64 = 1e-5;
    let at = |liquid: f64| {
        let media = Media {
            liquid,
            ..setup.media
        };
        let wall = &setup.vessel.wall;
        all_meetings(setup.rig, wall, &media, setup.stations, pixels)
    };
    let n = setup.media.liquid;
    let ends = at(n - STEP).into_iter().zip(at(n + STEP));
    let one = |(back, ahead): (Option<Meeting>, Option<Meeting>)| {
        let none = CommonSigma {
            point: Vector3::zeros(),
            gap: 0.0,
        };
        let both = back.zip(ahead);
        both.map_or(none, |(back, ahead)| {
            change(&back, &ahead, sigma / (2.0 * STEP))
        })
    };
    ends.map(|(back, ahead)| back.into_iter().zip(ahead).map(one).collect())
        .collect()
}

fn change(before: &Meeting, after: &Meeting, factor: f64) -> CommonSigma {
    CommonSigma {
        point: (after.point() - before.point()).abs() * factor,
        gap: (after.gap() - before.gap()).abs() * factor,
    }
}

fn all_meetings(
    rig: &Rig,
    wall: &Wall,
    media: &Media,
    stations: &[Station],
    pixels: &[Vec<Pixel>],
) -> Vec<Vec<Option<Meeting>>> {
    let liquid = wall.stack(media, InsideMedium::Liquid);
    let air = wall.stack(media, InsideMedium::Air);
    let of_view = |(station, pixels): (&Station, &Vec<Pixel>)| {
        let stack = match station.inside {
            InsideMedium::Liquid => liquid.as_ref().ok(),
            InsideMedium::Air => air.as_ref().ok(),
        };
        let pose = rig.station(&station.world_from_flange);
        let one = |pixel: &Pixel| meet(rig, &pose, stack?, *pixel).ok();
        pixels.iter().map(one).collect()
    };
    stations.iter().zip(pixels).map(of_view).collect()
}
