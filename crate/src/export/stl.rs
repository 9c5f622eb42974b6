use nalgebra::Vector3;

use super::header::index;
use super::{Mesh, ReconstructionResult};
use crate::VERSION;

/// A surface as binary STL, mm, world frame. Its header has 80 bytes: program, unit, frame, index.
pub fn mesh_stl(result: &ReconstructionResult, mesh: &Mesh) -> Vec<u8> {
    let says = format!(
        "Snellius {VERSION}, mm, world frame, n inside {}",
        index(&result.media.inside)
    );
    let mut header = says.into_bytes();
    header.resize(80, b' ');
    let mut file = header;
    file.extend((mesh.triangles.len() as u32).to_le_bytes());
    for triangle in &mesh.triangles {
        let corners = triangle.map(|v| Vector3::from(mesh.vertices[v as usize]));
        let across = (corners[1] - corners[0]).cross(&(corners[2] - corners[0]));
        // A triangle without area has no normal; the format then has zeros.
        let normal = across.try_normalize(0.0).unwrap_or_default();
        for vector in [normal, corners[0], corners[1], corners[2]] {
            for value in vector.iter() {
                file.extend((*value as f32).to_le_bytes());
            }
        }
        file.extend([0, 0]);
    }
    file
}
