use std::fmt::Write;

use super::ReconstructionResult;
use super::header::header;
use super::points::{ObjectPoint, object_points};

/// The object's points as an ASCII PLY point cloud: coordinates, standard deviations, ray distance (mm,
/// world frame), and the scan (sweep) and the view that each comes from, both counted from 0.
pub fn object_ply(result: &ReconstructionResult) -> String {
    let points: Vec<ObjectPoint> = object_points(result).collect();
    let columns = ["x", "y", "z"].into_iter().chain(ObjectPoint::MEASURES);
    let columns = columns.map(|name| ("double", name));
    let columns: Vec<_> = columns
        .chain([("uint", "scan"), ("uint", "view")])
        .collect();
    let mut file = ply_header(result, "object", &columns, points.len());
    for point in points {
        for value in point.place.into_iter().chain(point.measures()) {
            let _ = write!(file, "{value} ");
        }
        let _ = writeln!(file, "{} {}", point.scan, point.view);
    }
    file
}

/// The vessel's points, on the wall's outer face, as an ASCII PLY point cloud. Millimetres, world frame.
pub fn vessel_ply(result: &ReconstructionResult) -> String {
    let columns = ["x", "y", "z"].map(|name| ("double", name));
    let points = result.views.iter().flat_map(|view| view.vessel.iter());
    let mut file = ply_header(result, "vessel", &columns, points.clone().count());
    for [x, y, z] in points {
        let _ = writeln!(file, "{x} {y} {z}");
    }
    file
}

fn ply_header(
    result: &ReconstructionResult,
    what: &str,
    columns: &[(&str, &str)],
    rows: usize,
) -> String {
    let mut file = String::from("ply\nformat ascii 1.0\n");
    let _ = writeln!(file, "comment points of the {what}");
    for line in header(result) {
        let _ = writeln!(file, "comment {line}");
    }
    let _ = writeln!(file, "element vertex {rows}");
    for (kind, name) in columns {
        let _ = writeln!(file, "property {kind} {name}");
    }
    file.push_str("end_header\n");
    file
}
