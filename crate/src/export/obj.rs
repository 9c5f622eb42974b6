use std::fmt::Write;

use super::header::header;
use super::{Mesh, ReconstructionResult};

/// A surface as Wavefront OBJ, mm, world frame.
pub fn mesh_obj(result: &ReconstructionResult, mesh: &Mesh) -> String {
    let mut file = String::new();
    for line in header(result) {
        let _ = writeln!(file, "# {line}");
    }
    file.push_str("o object\n");
    for [x, y, z] in &mesh.vertices {
        let _ = writeln!(file, "v {x} {y} {z}");
    }
    for triangle in &mesh.triangles {
        // Corners count from 1.
        let [a, b, c] = triangle.map(|vertex| vertex + 1);
        let _ = writeln!(file, "f {a} {b} {c}");
    }
    file
}
