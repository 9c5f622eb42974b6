use std::fmt::Write;

use super::ReconstructionResult;

/// A table of the views, one a line, for spreadsheets: RFC 4180 with a header; empty where there is no
/// value. Lengths in mm, world frame.
pub fn points_csv(result: &ReconstructionResult) -> String {
    let mut table = String::from(
        "view,status,vessel_x,vessel_y,vessel_z,object_x,object_y,object_z,\
         sigma_x,sigma_y,sigma_z,calibration_sigma_x,calibration_sigma_y,calibration_sigma_z,\
         ray_distance\r\n",
    );
    for view in &result.views {
        let status = serde_json::to_value(view.status).unwrap_or_default();
        let _ = write!(
            table,
            "{},{}",
            quoted(&view.id),
            status.as_str().unwrap_or_default()
        );
        let triples = [
            view.vessel,
            view.object,
            view.object_sigma,
            view.object_sigma_calibration,
        ];
        for triple in triples {
            match triple {
                Some([x, y, z]) => {
                    let _ = write!(table, ",{x},{y},{z}");
                }
                None => table.push_str(",,,"),
            }
        }
        let distance = view.ray_distance.map(|l| l.to_string()).unwrap_or_default();
        let _ = write!(table, ",{distance}\r\n");
    }
    table
}

fn quoted(field: &str) -> String {
    if field.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.to_owned()
    }
}
