//! Which way is up, and where the rig stood.

use snellius::geometry::{Camera, Direction, Pose, World};
use snellius::scan::Scan;
use snellius::share::Document;

type Vector = [f64; 3];

/// Up, and from the scene towards the rig: against the pictures' down, and against where the cameras look, on
/// the average. Without a manifest the wall's normal points to the rig, and up is against the world's y.
pub(super) fn sides(document: &Document) -> Vec<f64> {
    let scan = document.scan.clone().and_then(|scan| Scan::new(scan).ok());
    let (up, front) = match scan {
        Some(scan) => {
            let poses = || scan.stations.iter().map(|s| &s.world_from_camera);
            (
                mean(poses().map(|pose| axis(pose, [0.0, -1.0, 0.0]))),
                mean(poses().map(|pose| axis(pose, [0.0, 0.0, -1.0]))),
            )
        }
        None => ([0.0, -1.0, 0.0], normal(document)),
    };
    [up, front].concat()
}

fn normal(document: &Document) -> Vector {
    let mesh = document.result.wall_mesh();
    let nodes = mesh.iter().flat_map(|mesh| mesh.nodes.iter().flatten());
    mean(nodes.map(|node| node.normal.vector().into()))
}

fn axis(pose: &Pose<World, Camera>, axis: Vector) -> Vector {
    Direction::new(axis.into()).map_or(axis, |axis| pose.direction(axis).vector().into())
}

/// The mean of unit vectors, not of unit length; where they cancel out, any.
fn mean(vectors: impl Iterator<Item = Vector>) -> Vector {
    let sum = vectors.fold([0.0; 3], |sum: Vector, v| [0, 1, 2].map(|i| sum[i] + v[i]));
    if sum.iter().all(|part| *part == 0.0) {
        return [0.0, 0.0, -1.0];
    }
    sum
}
