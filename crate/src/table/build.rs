use nalgebra::{Vector2, Vector3};
use serde::{Deserialize, Serialize};

use super::{Accuracy, Grid, Node, Table, TableFormat};
use crate::camera::Pixel;
use crate::geometry::{Point, World};
use crate::object::{Meeting, MeetingError, Setup, calibration_sigmas, meet, noise};
use crate::optics::{Stack, aim_through};
use crate::pipeline::Reconstruction;
use crate::rig::Laser;
use crate::scan::{LengthUnit, PoseEntry, Station};
use crate::spots::Spot;
use crate::vessel::NoRoom;

/// Which points behind the wall a table is for.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reach {
    /// From here, mm behind the last face along the light: nearer there is the wall's own glow.
    pub nearest: f64,
    /// To here, mm.
    pub farthest: f64,
}

/// Why there is no table.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TableError {
    /// Light does not get through the wall.
    #[error("view \"{view}\": no table, for {problem}")]
    Blocked {
        /// The view's id.
        view: String,
        /// What stops the light.
        problem: MeetingError,
    },
    /// No pixel of the picture shows a point in reach.
    #[error(
        "view \"{view}\": no pixel shows a point of the laser's light between {} and {} mm behind the wall",
        reach.nearest, reach.farthest
    )]
    NothingInReach {
        /// The view's id.
        view: String,
        /// What was asked for.
        reach: Reach,
    },
    /// The nodes would have to lie nearer together than pixels.
    #[error(
        "view \"{view}\": between the nodes of the finest grid points are off by {share:.2} standard \
         deviations, and {LARGEST_SHARE} are allowed; ask for a smaller reach"
    )]
    TooCoarse {
        /// The view's id.
        view: String,
        /// The largest error in standard deviations of the point.
        share: f64,
    },
}

/// The interpolation's error stays below this part of a point's standard deviation.
const LARGEST_SHARE: f64 = 0.1;
/// From node to node, px: the first that is exact enough is taken.
const STEPS: [f64; 6] = [64.0, 32.0, 16.0, 8.0, 4.0, 2.0];
/// How far off the beam's image a table reaches, px: a spot's distance from it is the ray distance.
const BAND: f64 = 8.0;

/// Works out the table for a rig that stands before the wall as it does in a view of a reconstruction.
///
/// The grid is made finer until the points between its nodes lie less than a tenth of their standard
/// deviation off the traced ones.
pub fn build(
    reconstruction: &Reconstruction,
    view: usize,
    reach: Reach,
) -> Result<Table, TableError> {
    let id = &reconstruction.scan.manifest.views[view].id;
    let blocked = |problem: MeetingError| TableError::Blocked {
        view: id.clone(),
        problem,
    };
    let fixed = Fixed::new(reconstruction, view, reach).map_err(|e| blocked(e.into()))?;
    let window = fixed.window().map_err(blocked)?;
    let nothing = || TableError::NothingInReach {
        view: id.clone(),
        reach,
    };
    let window = window.ok_or_else(nothing)?;
    let mut share = f64::INFINITY;
    for step in STEPS {
        let table = fixed.table(Grid::over(window.low, window.high, step));
        if table.accuracy.places == 0 {
            continue;
        }
        share = table.accuracy.largest_share;
        if share <= LARGEST_SHARE {
            return Ok(table);
        }
    }
    if share.is_infinite() {
        return Err(nothing());
    }
    Err(TableError::TooCoarse {
        view: id.clone(),
        share,
    })
}

/// A part of the picture, px.
#[derive(Clone, Copy)]
struct Window {
    low: Vector2<f64>,
    high: Vector2<f64>,
}

/// A rig before a wall.
struct Fixed<'a> {
    reconstruction: &'a Reconstruction<'a>,
    setup: Setup<'a>,
    view: usize,
    station: &'a Station,
    stack: Stack,
    reach: Reach,
    pixel_sigma: f64,
}

impl<'a> Fixed<'a> {
    fn new(
        reconstruction: &'a Reconstruction<'a>,
        view: usize,
        reach: Reach,
    ) -> Result<Self, NoRoom> {
        let station = &reconstruction.scan.stations[view];
        let wall = &reconstruction.vessel.wall;
        Ok(Self {
            setup: reconstruction.setup(),
            view,
            station,
            stack: wall.stack(&reconstruction.media, station.inside)?,
            reach,
            pixel_sigma: finest_spot(reconstruction),
            reconstruction,
        })
    }

    fn meet(&self, pixel: Pixel) -> Result<Meeting, MeetingError> {
        let rig = self.setup.rig;
        meet(rig, &self.station.world_from_camera, &self.stack, pixel)
    }

    fn in_reach(&self, meeting: &Meeting) -> bool {
        (self.reach.nearest..=self.reach.farthest).contains(&meeting.depth())
    }

    /// The part of the picture in which points in reach are seen.
    fn window(&self) -> Result<Option<Window>, MeetingError> {
        let camera = &self.setup.rig.camera;
        let picture = Window {
            low: Vector2::zeros(),
            high: Vector2::new(f64::from(camera.width - 1), f64::from(camera.height - 1)),
        };
        match &self.setup.rig.laser {
            Laser::Sheet(_) => Ok(Some(picture)),
            Laser::Beam(beam) => {
                let beam = self.station.world_from_camera.ray(beam);
                let light = self.stack.trace(&beam).map_err(MeetingError::Beam)?;
                let seen = evenly(self.reach).filter_map(|depth| self.seen(light.at(depth)));
                Ok(around(seen).and_then(|window| window.within(&picture)))
            }
        }
    }

    /// The pixel at which a point behind the wall is seen.
    fn seen(&self, point: Point<World>) -> Option<Pixel> {
        let pose = &self.station.world_from_camera;
        let eye = pose.point(Point::origin());
        let aim = aim_through(&self.stack, eye, point).ok()?;
        let ahead = pose.inverse().direction(aim);
        let camera = &self.setup.rig.camera;
        camera.project(Point::from_coords(ahead.vector()))
    }

    fn table(&self, grid: Grid) -> Table {
        let scan = self.reconstruction.scan;
        let result = self.reconstruction.result();
        let mut table = Table {
            format: TableFormat::RefractiveTable,
            version: 1,
            scan: scan.manifest.name.clone(),
            view: scan.manifest.views[self.view].id.clone(),
            length_unit: LengthUnit::Millimetre,
            camera: scan.manifest.camera.clone(),
            laser: scan.manifest.laser.clone(),
            media: result.media,
            vessel: result.vessel,
            world_from_camera: PoseEntry {
                rotation: self.station.world_from_camera.quaternion(),
                translation: self.station.world_from_camera.translation().into(),
                extra: Default::default(),
            },
            reach: self.reach,
            accuracy: Accuracy {
                largest_error: 0.0,
                largest_share: 0.0,
                pixel_sigma: self.pixel_sigma,
                places: 0,
            },
            nodes: self.nodes(&grid),
            grid,
        };
        table.accuracy = self.compare(&table);
        table
    }

    fn nodes(&self, grid: &Grid) -> Vec<Option<Node>> {
        let pixels: Vec<Pixel> = (0..grid.len()).map(|node| grid.pixel(node)).collect();
        let mut of_views = vec![Vec::new(); self.setup.stations.len()];
        of_views[self.view].clone_from(&pixels);
        let calibration = calibration_sigmas(&self.setup, &of_views).swap_remove(self.view);
        let nodes = pixels.iter().zip(calibration);
        let nodes = nodes.map(|(pixel, common)| {
            // What a spot that is located exactly leaves is the wall's.
            let of_wall = noise(&self.setup, self.station, &spot(*pixel, 0.0), 0.0).ok()?;
            Some(Node {
                meeting: self.over_depth(&self.meet(*pixel).ok()?)?,
                of_wall: with_gap(of_wall.sigma(), of_wall.gap),
                of_calibration: with_gap(common.point, common.gap),
            })
        });
        nodes.collect()
    }

    /// A meeting as a node keeps it; `None` where the rays would have met halfway back to the camera or
    /// nearer: there 1/z runs off, and no table needs it.
    fn over_depth(&self, meeting: &Meeting) -> Option<[f64; 5]> {
        let camera_from_world = self.station.world_from_camera.inverse();
        let point = camera_from_world.point(meeting.point()).coords;
        let z = point.z;
        let near_camera = z > 0.0 && meeting.approach.along_second < -z;
        let kept = [
            point.x / z,
            point.y / z,
            1.0 / z,
            meeting.gap() / z,
            meeting.depth() / z,
        ];
        (!near_camera && kept.iter().all(|x| x.is_finite())).then_some(kept)
    }

    /// Holds the table against traced light between its nodes.
    fn compare(&self, table: &Table) -> Accuracy {
        let mut accuracy = table.accuracy;
        for cell in 0..table.grid.len() {
            let (column, row) = (cell % table.grid.columns, cell / table.grid.columns);
            // Off the middle, so that no symmetry of the weights hides an error.
            for (across, down) in [(0.5, 0.45), (0.21, 0.7), (0.8, 0.27)] {
                let pixel = table.grid.place(column as f64 + across, row as f64 + down);
                let Some((error, sigma)) = self.error(table, pixel) else {
                    continue;
                };
                accuracy.places += 1;
                accuracy.largest_error = accuracy.largest_error.max(error);
                accuracy.largest_share = accuracy.largest_share.max(error / sigma);
            }
        }
        accuracy
    }

    /// How far off the table is at a pixel, and one standard deviation of the point from the noise of the
    /// finest spot, mm; `None` where one of both has nothing in reach.
    fn error(&self, table: &Table, pixel: Pixel) -> Option<(f64, f64)> {
        let meeting = self.meet(pixel).ok().filter(|m| self.in_reach(m))?;
        let camera_from_world = self.station.world_from_camera.inverse();
        let exact = camera_from_world.point(meeting.point());
        let found = table.look_up(pixel)?.point;
        let by_noise = noise(
            &self.setup,
            self.station,
            &spot(pixel, self.pixel_sigma * self.pixel_sigma),
            0.0,
        );
        let of_wall = noise(&self.setup, self.station, &spot(pixel, 0.0), 0.0);
        let variance = by_noise.ok()?.covariance.trace() - of_wall.ok()?.covariance.trace();
        Some((found.distance(exact), variance.sqrt()))
    }
}

/// One standard deviation of the best located spot of a scan along the worse of its axes, px; a point of
/// a line has but one.
fn finest_spot(reconstruction: &Reconstruction) -> f64 {
    let spots = reconstruction.spots.iter().flat_map(|view| &view.spots);
    let worse = |spot: &Spot| spot.covariance_matrix().symmetric_eigenvalues().max();
    spots.map(worse).fold(f64::INFINITY, f64::min).sqrt()
}

/// A spot at a pixel, located to a variance, px^2, each way.
const fn spot(pixel: Pixel, variance: f64) -> Spot {
    Spot {
        u: pixel.u,
        v: pixel.v,
        covariance: [variance, 0.0, variance],
        shape: [0.0; 3],
        skew: [0.0; 4],
        brightness: 0.0,
        peak: 0.0,
        area: 0,
        saturated: false,
    }
}

fn with_gap(sigma: Vector3<f64>, gap: f64) -> [f64; 4] {
    [sigma.x, sigma.y, sigma.z, gap]
}

/// Depths through a reach, the nearer ones denser, as they are farther apart in the picture.
fn evenly(reach: Reach) -> impl Iterator<Item = f64> {
    const PLACES: i32 = 100;
    (0..=PLACES).map(move |place| {
        let part = f64::from(place) / f64::from(PLACES);
        reach.nearest + (reach.farthest - reach.nearest) * part * part
    })
}

/// The window around pixels, with the band beside a beam's image.
fn around(pixels: impl Iterator<Item = Pixel>) -> Option<Window> {
    let band = Vector2::repeat(BAND);
    let places = pixels.map(|pixel| Vector2::new(pixel.u, pixel.v));
    places.fold(None, |window, place| {
        let window = window.unwrap_or(Window {
            low: place + band,
            high: place - band,
        });
        Some(Window {
            low: window.low.inf(&(place - band)),
            high: window.high.sup(&(place + band)),
        })
    })
}

impl Window {
    /// The part of it that lies in another; `None` where they lie apart.
    fn within(&self, other: &Self) -> Option<Self> {
        let (low, high) = (self.low.sup(&other.low), self.high.inf(&other.high));
        (low.x < high.x && low.y < high.y).then_some(Self { low, high })
    }
}
