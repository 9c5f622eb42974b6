use std::fmt::Write;

use super::ReconstructionResult;
use super::header::header;
use super::points::{ObjectPoint, object_points};

/// The object's points as a binary point cloud of the Point Cloud Library, version 0.7: place, standard
/// deviations and ray distance as `float` (mm, world frame), scan (sweep) and view as `uint32` from 0.
pub fn object_pcd(result: &ReconstructionResult) -> Vec<u8> {
    let points: Vec<ObjectPoint> = object_points(result).collect();
    let mut file = pcd_header(result, points.len()).into_bytes();
    for point in points {
        for value in point.place.into_iter().chain(point.measures()) {
            file.extend((value as f32).to_le_bytes());
        }
        file.extend(point.scan.to_le_bytes());
        file.extend(point.view.to_le_bytes());
    }
    file
}

fn pcd_header(result: &ReconstructionResult, points: usize) -> String {
    let mut text = String::from("# .PCD v0.7 - Point Cloud Data file format\n");
    for line in header(result) {
        let _ = writeln!(text, "# {line}");
    }
    let measures = ObjectPoint::MEASURES.join(" ");
    let _ = write!(
        text,
        "VERSION 0.7\n\
         FIELDS x y z {measures} scan view\n\
         SIZE 4 4 4 4 4 4 4 4 4\n\
         TYPE F F F F F F F U U\n\
         COUNT 1 1 1 1 1 1 1 1 1\n\
         WIDTH {points}\n\
         HEIGHT 1\n\
         VIEWPOINT 0 0 0 1 0 0 0\n\
         POINTS {points}\n\
         DATA binary\n"
    );
    text
}
