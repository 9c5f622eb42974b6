use std::fmt::Write;

use super::ReconstructionResult;

/// The object's points as an ASCII PLY point cloud: coordinates, standard deviations, ray distance.
pub fn object_ply(result: &ReconstructionResult) -> String {
    let rows: Vec<[f64; 7]> = result
        .views
        .iter()
        .flat_map(|view| {
            let points = view.object.iter().zip(view.object_sigma.iter());
            points.zip(view.ray_distance.iter())
        })
        .map(|(([x, y, z], [sx, sy, sz]), l)| [*x, *y, *z, *sx, *sy, *sz, *l])
        .collect();
    ply(
        result,
        "object",
        [
            "x",
            "y",
            "z",
            "sigma_x",
            "sigma_y",
            "sigma_z",
            "ray_distance",
        ],
        &rows,
    )
}

/// The vessel's points, on the wall's outer face, as an ASCII PLY point cloud.
pub fn vessel_ply(result: &ReconstructionResult) -> String {
    let points = result.views.iter().flat_map(|view| view.vessel.iter());
    let rows: Vec<[f64; 3]> = points.copied().collect();
    ply(result, "vessel", ["x", "y", "z"], &rows)
}

fn ply<const N: usize>(
    result: &ReconstructionResult,
    what: &str,
    columns: [&str; N],
    rows: &[[f64; N]],
) -> String {
    let mut file = String::from("ply\nformat ascii 1.0\n");
    let name: String = result
        .scan
        .chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect();
    let index = result
        .media
        .inside
        .value
        .map_or("unknown".to_owned(), |n| n.to_string());
    let _ = writeln!(file, "comment {what} of scan: {name}");
    let _ = writeln!(
        file,
        "comment unit mm, world frame, refractive index inside {index}"
    );
    let _ = writeln!(file, "element vertex {}", rows.len());
    for column in columns {
        let _ = writeln!(file, "property double {column}");
    }
    file.push_str("end_header\n");
    for row in rows {
        let row = row.map(|value| value.to_string());
        let _ = writeln!(file, "{}", row.join(" "));
    }
    file
}
