//! The calibration table of a rig that never moves against its window.

mod common;

use std::io::Cursor;
use std::sync::LazyLock;

use common::archives::{Simulated, jar_on_a_turntable, scene, simulate};
use nalgebra::Vector3;
use snellius::export::{ReconstructionResult, Status};
use snellius::pipeline::{Reconstruction, Settings, observe, reconstruct};
use snellius::scan::{Archive, Scan};
use snellius::simulate::{Scene, Truth};
use snellius::spots::Spots;
use snellius::table::{MeasureError, Reach, Table, TableError, build, measure};

const REACH: Reach = Reach {
    nearest: 1.0,
    farthest: 400.0,
};

/// A round jar on a turntable whose axis is the jar's own: the wall stands still before the rig.
fn jar() -> Scene {
    jar_on_a_turntable([0.0; 3], [-14.0, 10.0], 60.0, 13)
}

static TANK: LazyLock<Observed> = LazyLock::new(|| Observed::of(scene()));
static JAR: LazyLock<Observed> = LazyLock::new(|| Observed::of(jar()));

/// A simulated scan, its pictures looked at once for all tests that read it.
struct Observed {
    scan: Scan,
    spots: Vec<Spots>,
    truth: Truth,
}

impl Observed {
    fn of(scene: Scene) -> Self {
        let Simulated { archive, truth } = simulate(scene);
        let mut archive = Archive::open(Cursor::new(archive)).unwrap();
        let settings = Settings::default();
        let views = 0..archive.scan().stations.len();
        let spots = views.map(|view| observe(&mut archive, view, &settings).unwrap());
        Self {
            spots: spots.collect(),
            scan: archive.scan().clone(),
            truth,
        }
    }

    fn traced(&self) -> Reconstruction<'_> {
        reconstruct(&self.scan, &self.spots, &Settings::default()).unwrap()
    }

    fn by(&self, table: &Table) -> Result<ReconstructionResult, MeasureError> {
        measure(table, &self.scan, &self.spots, &Settings::default().object)
    }
}

/// At the view that a table was made for, looking up gives what tracing gives, to a tenth of a standard
/// deviation; and the table says so by itself.
#[track_caller]
fn assert_look_up_agrees(observed: &Observed, views: &[usize]) {
    let traced = observed.traced();
    let expected = traced.result();
    for &view in views {
        let table = build(&traced, view, REACH).unwrap();
        assert!(table.accuracy.places > 50, "{:?}", table.accuracy);
        assert!(table.accuracy.largest_share <= 0.1, "{:?}", table.accuracy);
        let found = &observed.by(&table).unwrap().views[view];
        let expected = &expected.views[view];
        assert_eq!(found.status, Status::Ok, "{:?}", found.reason);
        assert_eq!(found.spots.len(), expected.spots.len());
        for (a, b) in found.spots.iter().zip(&expected.spots) {
            assert_eq!(a.role, b.role);
        }
        let vector = |list: Option<[f64; 3]>| Vector3::from(list.unwrap());
        let off = vector(found.object.first()) - vector(expected.object.first());
        let sigma = vector(expected.object_sigma.first());
        let share = off.norm() / sigma.norm();
        assert!(share < 0.1, "{share} standard deviations off");
        // The grain of laser light shows in a scan, not in a table.
        let claimed = vector(found.object_sigma.first()).norm();
        assert!((0.4..1.05).contains(&(claimed / sigma.norm())), "{claimed}");
        let ratio = vector(found.object_sigma_calibration.first()).norm()
            / vector(expected.object_sigma_calibration.first()).norm();
        assert!((0.99..1.01).contains(&ratio), "{ratio}");
    }
}

#[test]
fn looking_up_agrees_with_tracing_through_a_flat_wall() {
    assert_look_up_agrees(&TANK, &[0, 7, 19]);
}

#[test]
fn looking_up_agrees_with_tracing_through_a_jar() {
    assert_look_up_agrees(&JAR, &[0, 6, 25]);
}

/// One table serves a round jar on its turntable, whatever the angle.
#[test]
fn a_turning_jar_is_measured_with_one_table() {
    let table = build(&JAR.traced(), 6, REACH).unwrap();
    let result = JAR.by(&table).unwrap();
    let mut squares = Vec::new();
    for (view, truth) in result.views.iter().zip(&JAR.truth.views) {
        assert_eq!(view.status, Status::Ok, "{}: {:?}", view.id, view.reason);
        let (found, place) = (view.object.first().unwrap(), truth.object.first().unwrap());
        squares.push((Vector3::from(found) - Vector3::from(place)).norm_squared());
    }
    let rms = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    // Tracing gives some 0.1 mm.
    assert!(rms < 0.2, "{rms} mm RMS");
}

#[test]
fn a_table_survives_its_file() {
    let table = build(&TANK.traced(), 3, REACH).unwrap();
    let read: Table = serde_json::from_str(&table.to_json()).unwrap();
    let (one, other) = (TANK.by(&table).unwrap(), TANK.by(&read).unwrap());
    let (one, other) = (one.views[3].object.first(), other.views[3].object.first());
    let off = Vector3::from(one.unwrap()) - Vector3::from(other.unwrap());
    assert!(off.norm() < 1e-9);
}

#[test]
fn a_table_of_another_rig_is_refused() {
    let table = build(&TANK.traced(), 0, REACH).unwrap();
    let refusal = |change: fn(&mut Table)| {
        let mut table = table.clone();
        change(&mut table);
        TANK.by(&table).unwrap_err()
    };
    assert_eq!(
        refusal(|t| t.camera.fx += 1.0),
        MeasureError::OtherRig("camera")
    );
    assert_eq!(
        refusal(|t| t.laser.origin[0] += 1.0),
        MeasureError::OtherRig("laser")
    );
    assert_eq!(refusal(|t| t.version = 2), MeasureError::Version(2));
    assert!(matches!(
        refusal(|t| t.nodes.truncate(5)),
        MeasureError::Cut { found: 5, .. }
    ));
    assert!(matches!(
        refusal(|t| t.grid.rows = usize::MAX),
        MeasureError::Cut { .. }
    ));
    assert!(matches!(
        refusal(|t| t.world_from_camera.rotation = [0.0; 4]),
        MeasureError::Pose(_)
    ));
}

#[test]
fn a_reach_that_no_pixel_shows_is_refused() {
    let reach = Reach {
        nearest: 1e6,
        farthest: 2e6,
    };
    let refused = build(&TANK.traced(), 0, reach).unwrap_err();
    assert!(
        matches!(refused, TableError::NothingInReach { .. }),
        "{refused}"
    );
}
