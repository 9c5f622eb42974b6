use nalgebra::{Matrix3, Matrix3x2, UnitQuaternion, Vector2, Vector3};

use super::{Seen, Table};
use crate::camera::Pixel;
use crate::export::{
    LineResult, OneOrMany, ReconstructionFormat, ReconstructionResult, RefusedResult, SpotResult,
    SpotRole, Status, ViewResult,
};
use crate::geometry::{Camera, Point, Pose, World, ZeroLength};
use crate::object::{ObjectSettings, Refusal, meet_unrefracted};
use crate::rig::Laser;
use crate::scan::{InsideMedium, LengthUnit, Scan, Station, sweeps};
use crate::spots::{Spot, Spots};
use crate::text::{count, some_of};

/// Why a scan cannot be measured with a table.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeasureError {
    /// The table is of a later version.
    #[error("the table is version {0}; this program reads version 1")]
    Version(u32),
    /// The table's numbers do not belong together.
    #[error("the table has {found} nodes, and its grid {expected}; the file was cut or changed")]
    Cut {
        /// Nodes in the file.
        found: usize,
        /// Nodes of the grid.
        expected: usize,
    },
    /// The table's pose is none.
    #[error("the table's world_from_camera.rotation: {0}")]
    Pose(#[from] ZeroLength),
    /// The scan was taken with another camera or laser.
    #[error("{0}: the scan's differs from the table's; make a table for this rig")]
    OtherRig(&'static str),
}

/// Measures a scan with a rig's table: no ray is traced.
///
/// Of a beam's spots the likeliest of those in reach whose ray distance noise, wall and calibration
/// explain is taken; of a sheet's every point in reach. Nearer than that there is the wall's own light.
pub fn measure(
    table: &Table,
    scan: &Scan,
    spots: &[Spots],
    settings: &ObjectSettings,
) -> Result<ReconstructionResult, MeasureError> {
    check(table, scan)?;
    let pose = &table.world_from_camera;
    let tables_pose = Pose::<World, Camera>::new(pose.rotation, pose.translation)?;
    let measurement = Measurement {
        table,
        scan,
        settings,
        tables_rotation: tables_pose.rotation(),
    };
    let views = spots.iter().enumerate();
    Ok(ReconstructionResult {
        format: ReconstructionFormat::RefractiveReconstruction,
        version: 1,
        scan: scan.manifest.name.clone(),
        length_unit: LengthUnit::Millimetre,
        media: table.media.clone(),
        vessel: table.vessel.clone(),
        views: views
            .zip(sweeps(&scan.stations))
            .map(|((view, spots), sweep)| measurement.view(view, sweep as u32, &spots.spots))
            .collect(),
        warnings: warnings(scan, &tables_pose),
    })
}

fn check(table: &Table, scan: &Scan) -> Result<(), MeasureError> {
    if table.version != 1 {
        return Err(MeasureError::Version(table.version));
    }
    let (found, expected) = (
        table.nodes.len(),
        table.grid.columns.checked_mul(table.grid.rows),
    );
    if expected != Some(found) {
        let expected = expected.unwrap_or(usize::MAX);
        return Err(MeasureError::Cut { found, expected });
    }
    if table.camera != scan.manifest.camera {
        return Err(MeasureError::OtherRig("camera"));
    }
    if table.laser != scan.manifest.laser {
        return Err(MeasureError::OtherRig("laser"));
    }
    Ok(())
}

fn warnings(scan: &Scan, tables_pose: &Pose<World, Camera>) -> Vec<String> {
    const SAME: f64 = 1e-6;
    let mut warnings = scan.warnings.clone();
    let stations = || scan.stations.iter().zip(&scan.manifest.views);
    let ids = |wanted: &dyn Fn(&Station) -> bool| -> Vec<&str> {
        let views = stations().filter(|(station, _)| wanted(station));
        views.map(|(_, view)| view.id.as_str()).collect()
    };
    let moved = ids(&|station| {
        let pose = &station.world_from_camera;
        (pose.translation() - tables_pose.translation()).norm() > SAME
            || pose.rotation().angle_to(&tables_pose.rotation()) > SAME
    });
    if !moved.is_empty() {
        warnings.push(format!(
            "{} stood elsewhere than the table's view: that is right only where the wall stood to the \
             rig as it did there: {}",
            count(moved.len(), "view"),
            some_of(&moved)
        ));
    }
    let in_air = ids(&|station| station.inside == InsideMedium::Air);
    if !in_air.is_empty() {
        warnings.push(format!(
            "{} entered air behind the wall, and the table knows one medium alone: {}",
            count(in_air.len(), "view"),
            some_of(&in_air)
        ));
    }
    warnings
}

/// What does not change from view to view.
struct Measurement<'a> {
    table: &'a Table,
    scan: &'a Scan,
    settings: &'a ObjectSettings,
    tables_rotation: UnitQuaternion<f64>,
}

/// A spot in reach.
struct Found {
    spot: usize,
    seen: Seen,
    /// Covariance of the point from the centroid's noise, mm^2, camera frame.
    of_noise: Matrix3<f64>,
    likelihood: f64,
}

/// What a spot is.
enum Sight {
    /// The wall's own light, at a point in air.
    Wall(Point<Camera>),
    Object(Found),
    Refused(Refusal),
    /// Beyond the table.
    OutOfReach,
}

impl Measurement<'_> {
    fn view(&self, view: usize, sweep: u32, spots: &[Spot]) -> ViewResult {
        let mut sights: Vec<Sight> = (0..spots.len()).map(|i| self.sight(i, &spots[i])).collect();
        if let Laser::Beam(_) = self.scan.rig.laser {
            keep_likeliest(&mut sights);
            keep_first_on_wall(&mut sights, self.scan.rig.laser.origin());
        }
        let station = &self.scan.stations[view];
        let pose = &station.world_from_camera;
        let objects = || {
            sights.iter().filter_map(|sight| match sight {
                Sight::Object(found) => Some(found),
                _ => None,
            })
        };
        let walls = || {
            sights.iter().filter_map(|sight| match sight {
                Sight::Wall(point) => Some(pose.point(*point).to_array()),
                _ => None,
            })
        };
        let status = if objects().next().is_some() {
            Status::Ok
        } else if walls().next().is_none() {
            Status::NoVesselSpot
        } else if spots.len() == walls().count() {
            Status::NoObjectSpot
        } else {
            Status::Rejected
        };
        ViewResult {
            id: self.scan.manifest.views[view].id.clone(),
            sweep,
            status,
            reason: match status {
                Status::Ok => None,
                Status::NoVesselSpot => {
                    Some("no spot lies on the wall, and none behind it".to_owned())
                }
                Status::NoObjectSpot => Some("no spot but the wall's".to_owned()),
                Status::Rejected => sights.iter().find_map(reason),
            },
            inside_proposed: None,
            inside: None,
            vessel: self.of_laser(walls()),
            object: self.of_laser(objects().map(|f| pose.point(f.seen.point).to_array())),
            object_sigma: self.of_laser(objects().map(|f| self.sigma(f, pose))),
            object_sigma_calibration: self
                .of_laser(objects().map(|f| self.turned(&f.seen.of_calibration, pose).into())),
            ray_distance: self.of_laser(objects().map(|f| f.seen.gap.abs())),
            object_unrefracted: self.of_laser(objects().map(|f| {
                let straight = meet_unrefracted(&self.scan.rig, pose, spots[f.spot].pixel());
                straight.ok().map(|meeting| meeting.point().to_array())
            })),
            spots: match self.scan.rig.laser {
                Laser::Beam(_) => spots.iter().zip(&sights).map(spot_result).collect(),
                Laser::Sheet(_) => Vec::new(),
            },
            line: match self.scan.rig.laser {
                Laser::Beam(_) => None,
                Laser::Sheet(_) => Some(line_result(spots, &sights)),
            },
        }
    }

    /// What a view gave, as its laser has it: one or none from a beam, a list from a sheet.
    fn of_laser<T>(&self, mut values: impl Iterator<Item = T>) -> OneOrMany<T> {
        match self.scan.rig.laser {
            Laser::Beam(_) => OneOrMany::One(values.next()),
            Laser::Sheet(_) => OneOrMany::Many(values.collect()),
        }
    }

    fn sight(&self, index: usize, spot: &Spot) -> Sight {
        let Some(seen) = self.table.look_up(spot.pixel()) else {
            return self.on_wall(spot).map_or(Sight::OutOfReach, Sight::Wall);
        };
        if seen.depth < self.table.reach.nearest {
            let refused = Sight::Refused(Refusal::BeforeInnerFace { depth: seen.depth });
            return self.on_wall(spot).map_or(refused, Sight::Wall);
        }
        if seen.depth > self.table.reach.farthest {
            return Sight::OutOfReach;
        }
        let Some((of_noise, gap)) = self.noise(spot) else {
            return Sight::OutOfReach;
        };
        let squares = gap + square(seen.of_wall[3]) + square(seen.of_calibration[3]);
        let (distance, sigma) = (seen.gap.abs(), squares.sqrt());
        let limit = self.settings.gap_sigmas * sigma;
        if let (Laser::Beam(_), true) = (&self.scan.rig.laser, distance > limit) {
            return Sight::Refused(Refusal::RayDistance { distance, limit });
        }
        let z = distance / sigma.max(f64::MIN_POSITIVE);
        Sight::Object(Found {
            spot: index,
            seen,
            of_noise,
            likelihood: libm::log(spot.brightness) - 0.5 * z * z,
        })
    }

    /// The point in air of a spot that may be the wall's.
    fn on_wall(&self, spot: &Spot) -> Option<Point<Camera>> {
        const TOLERANCE: f64 = 5.0;
        let camera = &self.scan.rig.camera;
        let lit = self
            .scan
            .rig
            .triangulate(camera.slope(spot.pixel()).ok()?)?;
        let off = lit.off_line.map_or(0.0, |off| off * camera.mean_focal());
        (off.abs() <= TOLERANCE).then_some(lit.point)
    }

    /// The centroid's covariance carried to the point (camera frame), and the gap's variance, mm^2.
    fn noise(&self, spot: &Spot) -> Option<(Matrix3<f64>, f64)> {
        const H: f64 = 0.05;
        let look = |du: f64, dv: f64| self.table.look_up(Pixel::new(spot.u + du, spot.v + dv));
        let slope = |ahead: Seen, back: Seen| {
            (
                (ahead.point - back.point) / (2.0 * H),
                (ahead.gap - back.gap) / (2.0 * H),
            )
        };
        let (u, gap_u) = slope(look(H, 0.0)?, look(-H, 0.0)?);
        let (v, gap_v) = slope(look(0.0, H)?, look(0.0, -H)?);
        let covariance = spot.covariance_matrix();
        let (point, gap) = (Matrix3x2::from_columns(&[u, v]), Vector2::new(gap_u, gap_v));
        Some((
            point * covariance * point.transpose(),
            (gap.transpose() * covariance * gap).x,
        ))
    }

    /// One standard deviation along the world's axes, from noise and the wall's fit.
    fn sigma(&self, found: &Found, pose: &Pose<World, Camera>) -> [f64; 3] {
        let turn = pose.rotation().to_rotation_matrix();
        let of_noise = (turn.matrix() * found.of_noise * turn.matrix().transpose()).diagonal();
        let of_wall = self.turned(&found.seen.of_wall, pose);
        of_noise
            .zip_map(&of_wall, |noise, wall| (noise + square(wall)).sqrt())
            .into()
    }

    /// Standard deviations along the axes of the table's world, along those of a view's: exact where the
    /// camera stands as the table's did, and else no smaller than they are.
    fn turned(&self, sigma: &[f64; 4], pose: &Pose<World, Camera>) -> Vector3<f64> {
        let turn = pose.rotation() * self.tables_rotation.inverse();
        turn.to_rotation_matrix().matrix().abs() * Vector3::new(sigma[0], sigma[1], sigma[2])
    }
}

/// Of several spots that may be a beam's on the object, the likeliest.
fn keep_likeliest(sights: &mut [Sight]) {
    let found = sights.iter().filter_map(|sight| match sight {
        Sight::Object(found) => Some(found),
        _ => None,
    });
    let best = found
        .max_by(|a, b| a.likelihood.total_cmp(&b.likelihood))
        .map(|found| found.spot);
    for (index, sight) in sights.iter_mut().enumerate() {
        if matches!(sight, Sight::Object(_)) && Some(index) != best {
            *sight = Sight::Refused(Refusal::Outdone(None));
        }
    }
}

/// Of several spots of the wall's light the first along the beam (section II-C).
fn keep_first_on_wall(sights: &mut [Sight], laser: Point<Camera>) {
    let walls = sights
        .iter()
        .enumerate()
        .filter_map(|(index, sight)| match sight {
            Sight::Wall(point) => Some((index, point.distance(laser))),
            _ => None,
        });
    let first = walls
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(index, _)| index);
    for (index, sight) in sights.iter_mut().enumerate() {
        if matches!(sight, Sight::Wall(_)) && Some(index) != first {
            *sight = Sight::OutOfReach;
        }
    }
}

fn line_result(spots: &[Spot], sights: &[Sight]) -> LineResult {
    let pixels = |is: fn(&Sight) -> bool| {
        let those = spots.iter().zip(sights).filter(|(_, sight)| is(sight));
        those.map(|(spot, _)| [spot.u, spot.v]).collect()
    };
    LineResult {
        vessel: pixels(|sight| matches!(sight, Sight::Wall(_))),
        object: pixels(|sight| matches!(sight, Sight::Object(_))),
        stray: pixels(|sight| matches!(sight, Sight::Refused(_) | Sight::OutOfReach)),
        refused: RefusedResult::alike(sights.iter().filter_map(|sight| match sight {
            Sight::Refused(refusal) => Some(refusal.kind()),
            other => reason(other),
        })),
    }
}

fn reason(sight: &Sight) -> Option<String> {
    match sight {
        Sight::Refused(refusal) => Some(refusal.to_string()),
        Sight::OutOfReach => Some("outside what the table covers".to_owned()),
        Sight::Wall(_) | Sight::Object(_) => None,
    }
}

fn spot_result((spot, sight): (&Spot, &Sight)) -> SpotResult {
    SpotResult {
        pixel: [spot.u, spot.v],
        role: match sight {
            Sight::Wall(_) => SpotRole::Vessel,
            Sight::Object(_) => SpotRole::Object,
            Sight::Refused(_) | Sight::OutOfReach => SpotRole::Stray,
        },
        reason: reason(sight),
    }
}

fn square(x: f64) -> f64 {
    x * x
}
