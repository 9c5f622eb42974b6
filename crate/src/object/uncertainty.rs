//! First-order propagation: covariance of the point = J covariance J^T, with J by differences.

use nalgebra::{DVector, Matrix2, Matrix3, Vector3};

use super::{Meeting, MeetingError, Setup, laser_ray, line_of_sight, meet};
use crate::camera::Pixel;
use crate::geometry::{Point, World};
use crate::optics::{Media, Path, Stack};
use crate::rig::{Calibration, Rig};
use crate::scan::{InsideMedium, Station};
use crate::spots::Spot;
use crate::vessel::{Told, Wall};

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

/// How the point that a pixel shows, and its gap, change with the pixel and with the wall.
pub(super) struct Slopes {
    by_pixel: [Slope; 2],
    /// Those of the wall's parameters that matter: a free form has hundreds, of which those count that move it
    /// near the two light paths.
    movers: Vec<usize>,
    by_wall: Vec<Slope>,
}

/// Fails where a ray that is moved a little no longer gets through.
pub(super) fn slopes(
    setup: &Setup,
    station: &Station,
    pixel: Pixel,
) -> Result<Slopes, MeetingError> {
    let wall = &setup.vessel.wall;
    let stack = wall.stack(&setup.media, station.inside)?;
    let seen = |du: f64, dv: f64| {
        let pixel = Pixel::new(pixel.u + du, pixel.v + dv);
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
    let movers = wall
        .outer
        .movers(&crossings(setup, station, &stack, pixel)?);
    let through = |parameter: usize, step: f64| {
        let mut steps = DVector::zeros(wall.outer.freedom());
        steps[parameter] = step;
        let stack = wall.nudged(&steps).stack(&setup.media, station.inside)?;
        meet(setup.rig, &station.world_from_camera, &stack, pixel)
    };
    let by_one = |parameter: &usize| {
        Ok(Slope::between(
            &through(*parameter, WALL_STEP)?,
            &through(*parameter, -WALL_STEP)?,
            WALL_STEP,
        ))
    };
    let by_wall = movers
        .iter()
        .map(by_one)
        .collect::<Result<Vec<_>, MeetingError>>()?;
    Ok(Slopes {
        by_pixel,
        movers,
        by_wall,
    })
}

impl Slopes {
    /// The gap's variance from the pixel's covariance.
    pub(super) fn gap_variance(&self, pixel: &Matrix2<f64>) -> f64 {
        propagated(&self.by_pixel, |i, j| pixel[(i, j)]).1
    }

    /// How the gap changes with the wall's parameters.
    pub(super) fn gap_by_wall(&self) -> Vec<(usize, f64)> {
        let slopes = self.by_wall.iter().map(|slope| slope.gap);
        self.movers.iter().copied().zip(slopes).collect()
    }

    /// What it adds to the covariance of the point and to the gap's variance that the wall follows this very
    /// spot: `follows` is how each of the wall's parameters follows the gap.
    fn shared(&self, pixel: &Matrix2<f64>, follows: impl Fn(usize) -> f64) -> (Matrix3<f64>, f64) {
        let mut by_gap = Slope {
            point: Vector3::zeros(),
            gap: 0.0,
        };
        for (parameter, slope) in self.movers.iter().zip(&self.by_wall) {
            by_gap.point -= slope.point * follows(*parameter);
            by_gap.gap -= slope.gap * follows(*parameter);
        }
        let (mut with_gap, mut gap) = (Vector3::zeros(), 0.0);
        for (i, a) in self.by_pixel.iter().enumerate() {
            for (j, b) in self.by_pixel.iter().enumerate() {
                with_gap += a.point * (b.gap * pixel[(i, j)]);
                gap += a.gap * b.gap * pixel[(i, j)];
            }
        }
        let shared = by_gap.point * with_gap.transpose();
        (shared + shared.transpose(), 2.0 * by_gap.gap * gap)
    }
}

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
    let slopes = slopes(setup, station, spot.pixel())?;
    let camera = spot.covariance_matrix();
    let grainy = spot.covariance_with(grain);
    let wall = &setup.vessel.wall.covariance;
    let movers = &slopes.movers;
    let (mut covariance, mut gap) = propagated(&slopes.by_pixel, |i, j| grainy[(i, j)]);
    let (of_wall, wall_gap) = propagated(&slopes.by_wall, |i, j| wall[(movers[i], movers[j])]);
    covariance += of_wall;
    gap += wall_gap;
    let here = |view: usize, pixel: Pixel| {
        pixel == spot.pixel() && setup.stations[view].world_from_flange == station.world_from_flange
    };
    let told = setup.vessel.told();
    if let Some(follows) = told.and_then(|told| told.gain_of(here)) {
        let (shared, shared_gap) = slopes.shared(&grainy, follows);
        covariance += shared;
        gap += shared_gap;
    }
    Ok(Noise {
        covariance,
        gap: gap.max(0.0).sqrt(),
        gap_camera: slopes.gap_variance(&camera),
        gap_grain: slopes.gap_variance(&spot.grain_covariance()),
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
    let none = CommonSigma {
        point: Vector3::zeros(),
        gap: 0.0,
    };
    let mut sums: Vec<Vec<CommonSigma>> = pixels.iter().map(|p| vec![none; p.len()]).collect();
    for changes in calibration_changes(setup, pixels) {
        for (sum, change) in sums.iter_mut().flatten().zip(changes.iter().flatten()) {
            *sum = sum.and(&change.sigma());
        }
    }
    sums
}

/// What one standard deviation of each calibrated number does to the points of each view.
pub(super) fn calibration_changes(
    setup: &Setup,
    pixels: &[Vec<Pixel>],
) -> impl Iterator<Item = Vec<Vec<Change>>> {
    const PART: f64 = 1e-3;
    let follower = Follower::of(setup);
    let base = all_meetings(
        setup.rig,
        &setup.vessel.wall,
        &setup.media,
        setup.stations,
        pixels,
    );
    Calibration::ALL.into_iter().filter_map(move |number| {
        let one = number.sigma(setup.calibration_sigma);
        let off = number.nudge(setup.rig, one * PART);
        let wall = setup.vessel.refitted(&off, setup.stations)?;
        let wall = follower.follow(&off, wall, &setup.media);
        let moved = all_meetings(&off, &wall, &setup.media, setup.stations, pixels);
        Some(changes(&base, &moved, 1.0 / PART))
    })
}

/// What an error of the liquid's index, of one standard deviation, would do to the points of each view.
pub fn index_sigmas(setup: &Setup, pixels: &[Vec<Pixel>], sigma: f64) -> Vec<Vec<CommonSigma>> {
    const STEP: f64 = 1e-5;
    let follower = Follower::of(setup);
    let at = |liquid: f64| {
        let media = Media {
            liquid,
            ..setup.media
        };
        let wall = follower.follow(setup.rig, setup.vessel.wall.clone(), &media);
        all_meetings(setup.rig, &wall, &media, setup.stations, pixels)
    };
    let n = setup.media.liquid;
    let changes = changes(&at(n - STEP), &at(n + STEP), sigma / (2.0 * STEP));
    let sigmas = |view: Vec<Change>| view.iter().map(Change::sigma).collect();
    changes.into_iter().map(sigmas).collect()
}

/// Lets a wall that ray distances have told of follow them.
struct Follower<'a> {
    setup: &'a Setup<'a>,
    /// The ray distances as they are.
    before: Vec<Option<f64>>,
}

impl<'a> Follower<'a> {
    fn of(setup: &'a Setup<'a>) -> Self {
        let told = setup.vessel.told();
        let seen = told.map_or(&[][..], Told::seen);
        let wall = &setup.vessel.wall;
        Self {
            before: ray_distances(setup.rig, wall, &setup.media, setup.stations, seen),
            setup,
        }
    }

    /// The wall with what changed ray distances do to it. One that is gone counts as unchanged.
    fn follow(&self, rig: &Rig, wall: Wall, media: &Media) -> Wall {
        let Some(told) = self.setup.vessel.told() else {
            return wall;
        };
        let after = ray_distances(rig, &wall, media, self.setup.stations, told.seen());
        let change = |(before, after): (&Option<f64>, &Option<f64>)| {
            before
                .zip(*after)
                .map_or(0.0, |(before, after)| after - before)
        };
        let changes = self.before.iter().zip(&after).map(change);
        wall.nudged(&told.following(&DVector::from_iterator(after.len(), changes)))
    }
}

/// How much a point and its ray distance change.
#[derive(Clone, Copy, Debug)]
pub(super) struct Change {
    point: Vector3<f64>,
    pub(super) gap: f64,
}

impl Change {
    fn sigma(&self) -> CommonSigma {
        CommonSigma {
            point: self.point.abs(),
            gap: self.gap.abs(),
        }
    }
}

type Meetings = Vec<Vec<Option<Meeting>>>;

fn changes(before: &Meetings, after: &Meetings, factor: f64) -> Vec<Vec<Change>> {
    let change = |(before, after): (&Option<Meeting>, &Option<Meeting>)| {
        let none = Change {
            point: Vector3::zeros(),
            gap: 0.0,
        };
        before.zip(*after).map_or(none, |(before, after)| Change {
            point: (after.point() - before.point()) * factor,
            gap: (after.gap() - before.gap()) * factor,
        })
    };
    let of_view =
        |(before, after): (&Vec<_>, &Vec<_>)| before.iter().zip(after).map(change).collect();
    before.iter().zip(after).map(of_view).collect()
}

/// The signed ray distances of spots; `None` where the light paths do not meet.
pub(super) fn ray_distances(
    rig: &Rig,
    wall: &Wall,
    media: &Media,
    stations: &[Station],
    seen: &[(usize, Pixel)],
) -> Vec<Option<f64>> {
    let mut pixels = vec![Vec::new(); stations.len()];
    for (view, pixel) in seen {
        pixels[*view].push(*pixel);
    }
    let meetings = all_meetings(rig, wall, media, stations, &pixels);
    let meetings = meetings.into_iter().flatten();
    meetings
        .map(|meeting| meeting.map(|meeting| meeting.gap()))
        .collect()
}

fn all_meetings(
    rig: &Rig,
    wall: &Wall,
    media: &Media,
    stations: &[Station],
    pixels: &[Vec<Pixel>],
) -> Meetings {
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
