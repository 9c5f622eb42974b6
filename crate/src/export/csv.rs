use std::fmt::Write;

use super::header::{header, name_of};
use super::points::{ObjectPoint, object_points};
use super::{ReconstructionResult, ViewResult};

/// A table of the views for spreadsheets: RFC 4180 with a header; empty where there is no value. Lengths
/// in mm, world frame.
///
/// A view has one line; of a line laser as many as it has points of the wall or of the object, whichever
/// are more, and those that stand in one line have nothing else in common.
pub fn points_csv(result: &ReconstructionResult) -> String {
    let mut table = String::from(
        "view,status,vessel_x,vessel_y,vessel_z,object_x,object_y,object_z,\
         sigma_x,sigma_y,sigma_z,calibration_sigma_x,calibration_sigma_y,calibration_sigma_z,\
         ray_distance\r\n",
    );
    for view in &result.views {
        let most = view.vessel.iter().len().max(view.object.iter().len());
        for line in 0..most.max(1) {
            write_line(&mut table, view, line);
        }
    }
    table
}

/// The object's points as a table for programs that compute: lines that begin with `#` say what it is,
/// then a header, then a line a point. Lengths in mm, world frame; scan (sweep) and view from 0.
pub fn object_csv(result: &ReconstructionResult) -> String {
    let mut table = String::new();
    for line in header(result) {
        let _ = write!(table, "# {line}\r\n");
    }
    let _ = write!(
        table,
        "x,y,z,{},scan,view\r\n",
        ObjectPoint::MEASURES.join(",")
    );
    for point in object_points(result) {
        for value in point.place.into_iter().chain(point.measures()) {
            let _ = write!(table, "{value},");
        }
        let _ = write!(table, "{},{}\r\n", point.scan, point.view);
    }
    table
}

fn write_line(table: &mut String, view: &ViewResult, line: usize) {
    let status = name_of(&view.status);
    let _ = write!(table, "{},{status}", quoted(&view.id));
    let triples = [
        &view.vessel,
        &view.object,
        &view.object_sigma,
        &view.object_sigma_calibration,
    ];
    for triple in triples {
        match triple.as_slice().get(line) {
            Some([x, y, z]) => {
                let _ = write!(table, ",{x},{y},{z}");
            }
            None => table.push_str(",,,"),
        }
    }
    let distance = view.ray_distance.as_slice().get(line);
    let distance = distance.map(f64::to_string).unwrap_or_default();
    let _ = write!(table, ",{distance}\r\n");
}

fn quoted(field: &str) -> String {
    if field.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.to_owned()
    }
}
