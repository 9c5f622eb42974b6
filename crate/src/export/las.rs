use std::io::Cursor;

use las::point::Format;
use las::{Builder, Point, Transform, Vector, Vlr, Writer};

use super::ReconstructionResult;
use super::header::header;
use super::points::{ObjectPoint, object_points};
use crate::VERSION;

/// A tenth of a micrometre: far below any standard deviation, and 32 bits of it reach over 400 m.
const RESOLUTION: f64 = 1e-4;

/// The object's points as LAS 1.4, point format 6, mm, world frame. Standard deviations, ray distance, scan
/// (sweep) and view are extra bytes; the scan is also the point source (counted from 1, as 0 means none). A
/// local coordinate system in WKT says that the unit is the millimetre, a text record what the others say.
pub fn object_las(result: &ReconstructionResult) -> Result<Vec<u8>, las::Error> {
    let points: Vec<ObjectPoint> = object_points(result).collect();
    let mut format = Format::new(6)?;
    format.extra_bytes = ExtraBytes::LENGTH;
    let mut builder = Builder::from((1, 4));
    builder.point_format = format;
    // The day of writing would make different bytes of the same scan.
    builder.date = None;
    builder.generating_software = format!("Snellius {VERSION}");
    builder.system_identifier = "laser range finder".to_owned();
    builder.transforms = transforms(&points);
    fit(&points, &builder.transforms)?;
    builder.vlrs = vec![about(result), extra_bytes_record()];
    let mut las_header = builder.into_header()?;
    las_header.set_wkt_crs(coordinate_system().into_bytes())?;
    let mut writer = Writer::new(Cursor::new(Vec::new()), las_header)?;
    for point in &points {
        writer.write_point(las_point(point))?;
    }
    Ok(writer.into_inner()?.into_inner())
}

fn las_point(point: &ObjectPoint) -> Point {
    let [x, y, z] = point.place;
    Point {
        x,
        y,
        z,
        return_number: 1,
        number_of_returns: 1,
        point_source_id: u16::try_from(point.scan.saturating_add(1)).unwrap_or(u16::MAX),
        // Point format 6 has a time; a scan has none.
        gps_time: Some(0.0),
        extra_bytes: ExtraBytes::of(point),
        ..Point::default()
    }
}

/// Offsets of whole millimetres near the points, so that 32 bits hold them wherever the world's origin is.
fn transforms(points: &[ObjectPoint]) -> Vector<Transform> {
    let axis = |axis: usize| Transform {
        scale: RESOLUTION,
        offset: points.first().map_or(0.0, |p| p.place[axis].round()),
    };
    Vector {
        x: axis(0),
        y: axis(1),
        z: axis(2),
    }
}

/// Holds the points against the 32 bits beforehand: the writer panics if it meets too large a number.
fn fit(points: &[ObjectPoint], transforms: &Vector<Transform>) -> Result<(), las::Error> {
    const MOST_STEPS: f64 = 2e9;
    let transforms = [transforms.x, transforms.y, transforms.z];
    for point in points {
        for (place, transform) in point.place.into_iter().zip(transforms) {
            if (place - transform.offset).abs() > MOST_STEPS * transform.scale {
                return Err(las::Error::InvalidInverseTransform {
                    n: place,
                    transform,
                });
            }
        }
    }
    Ok(())
}

/// What follows each point: the measures as doubles, scan and view as unsigned integers.
struct ExtraBytes;

impl ExtraBytes {
    const LENGTH: u16 = 4 * 8 + 2 * 4;

    fn of(point: &ObjectPoint) -> Vec<u8> {
        let measures = point.measures().into_iter().flat_map(f64::to_le_bytes);
        let numbers = [point.scan, point.view]
            .into_iter()
            .flat_map(u32::to_le_bytes);
        measures.chain(numbers).collect()
    }
}

/// The "Extra Bytes" record (LAS 1.4 R15, section 2.6.1): 192 bytes for each of them.
fn extra_bytes_record() -> Vlr {
    const UNSIGNED_LONG: u8 = 5;
    const DOUBLE: u8 = 10;
    let measures = ObjectPoint::MEASURES.map(|name| (DOUBLE, name, "mm"));
    let numbers = [
        (UNSIGNED_LONG, "scan", "sweep, from 0"),
        (UNSIGNED_LONG, "view", "from 0"),
    ];
    let describe = |(kind, name, description): (u8, &str, &str)| {
        let mut record = [0; 192];
        record[2] = kind;
        record[4..4 + name.len()].copy_from_slice(name.as_bytes());
        record[160..160 + description.len()].copy_from_slice(description.as_bytes());
        record
    };
    Vlr {
        user_id: "LASF_Spec".to_owned(),
        record_id: 4,
        description: "extra bytes".to_owned(),
        data: measures
            .into_iter()
            .chain(numbers)
            .flat_map(describe)
            .collect(),
    }
}

/// The "Text Area Descriptor" record.
fn about(result: &ReconstructionResult) -> Vlr {
    Vlr {
        user_id: "LASF_Spec".to_owned(),
        record_id: 3,
        description: "about".to_owned(),
        data: header(result).join("\n").into_bytes(),
    }
}

/// A coordinate system of its own, in millimetres (OGC 01-009), as a world frame has no place on the globe.
fn coordinate_system() -> String {
    let axes = ["x", "y", "z"].map(|name| format!(r#",AXIS["{name}",OTHER]"#));
    format!(
        "LOCAL_CS[\"world frame of the scan\",LOCAL_DATUM[\"unknown\",32767],\
         UNIT[\"millimetre\",0.001]{}]\0",
        axes.concat()
    )
}
