//! A vessel that moves before a rig that stands still: the same mathematics, poses inverted.

mod common;

use common::archives::{Entries, Simulated, jar_on_a_turntable, measure, refusal, scene, simulate};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use serde_json::{Value, json};
use snellius::export::Status;
use snellius::simulate::Scene;

/// The jar stands beside the turntable's axis.
fn jar() -> Scene {
    jar_on_a_turntable([3.0, 0.0, -2.0], [-14.0, 6.0], 40.0, 9)
}

#[test]
fn an_object_in_a_jar_on_a_turntable_is_recovered() {
    assert_recovered(jar());
}

/// The rig's places, seen from the jar, lie all around it: their mean is within.
#[test]
fn a_jar_may_turn_all_the_way_around() {
    let mut scene = jar();
    for sweep in &mut scene.sweeps {
        sweep.turn = [-180.0, 140.0];
    }
    assert_recovered(scene);
}

#[track_caller]
fn assert_recovered(scene: Scene) {
    let Simulated { archive, truth } = simulate(scene);
    let mut first = Entries::of(&archive);
    assert_eq!(first.manifest()["motion"], "vessel");
    let result = measure(&archive).unwrap();
    let mut squares = Vec::new();
    for (view, truth) in result.views.iter().zip(&truth.views) {
        assert_eq!(view.status, Status::Ok, "{}: {:?}", view.id, view.reason);
        let (found, place) = (view.object.first().unwrap(), truth.object.first().unwrap());
        squares.push((Vector3::from(found) - Vector3::from(place)).norm_squared());
    }
    let rms = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    // One standard deviation here is some 0.1 mm.
    assert!(rms < 0.2, "{rms} mm RMS");
}

/// The same pictures with every pose read the other way round are the same scan.
#[test]
fn inverted_poses_make_the_same_scan() {
    let by_rig = simulate(scene()).archive;
    let turned = Entries::of(&by_rig)
        .with_manifest(|scan| {
            scan["motion"] = json!("vessel");
            for view in scan["views"].as_array_mut().unwrap() {
                let pose = view.as_object_mut().unwrap().remove("world_from_flange");
                view["flange_from_world"] = inverse(&pose.unwrap());
            }
        })
        .zipped();
    let (one, other) = (measure(&by_rig).unwrap(), measure(&turned).unwrap());
    for (a, b) in one.views.iter().zip(&other.views) {
        let (a, b) = (a.object.first().unwrap(), b.object.first().unwrap());
        assert!((Vector3::from(a) - Vector3::from(b)).norm() < 1e-6);
    }
}

fn inverse(pose: &Value) -> Value {
    let numbers = |key: &str| -> Vec<f64> {
        let list = pose[key].as_array().unwrap();
        list.iter().map(|x| x.as_f64().unwrap()).collect()
    };
    let (q, t) = (numbers("rotation"), numbers("translation"));
    let back = UnitQuaternion::new_normalize(Quaternion::new(q[0], q[1], q[2], q[3])).inverse();
    let translation = -(back * Vector3::new(t[0], t[1], t[2]));
    json!({
        "rotation": [back.w, back.i, back.j, back.k],
        "translation": [translation.x, translation.y, translation.z],
    })
}

#[test]
fn a_pose_of_the_other_motion_is_refused() {
    let archive = Entries::of(
        &simulate(Scene {
            sweeps: scene().sweeps[..1].to_vec(),
            ..scene()
        })
        .archive,
    );
    let table = archive
        .clone()
        .with_manifest(|scan| scan["motion"] = json!("vessel"));
    let message = refusal(&table.zipped());
    assert!(
        message.starts_with("views[0].world_from_flange: "),
        "{message}"
    );
    assert!(message.contains("flange_from_world"), "{message}");
    let neither = archive.with_manifest(|scan| {
        scan["motion"] = json!("vessel");
        scan["views"][0]
            .as_object_mut()
            .unwrap()
            .remove("world_from_flange");
    });
    let message = refusal(&neither.zipped());
    assert!(
        message.starts_with("views[0].flange_from_world: missing"),
        "{message}"
    );
}
