use std::io::Cursor;

use e57::{E57Writer, Extension, Record, RecordDataType, RecordName, RecordValue};

use super::ReconstructionResult;
use super::header::{header, in_one_line};
use super::points::{ObjectPoint, object_points};
use crate::VERSION;

const NAMESPACE: &str = "snellius";
const METRES_PER_MILLIMETRE: f64 = 1e-3;

/// The object's points as E57 (ASTM E2807), in the world frame of the scan. The standard's unit is the
/// metre, and so it is for every length of this file; standard deviations, ray distance, scan (sweep) and
/// view are attributes of an extension.
pub fn object_e57(result: &ReconstructionResult) -> Result<Vec<u8>, e57::Error> {
    let mut file = Cursor::new(Vec::new());
    let identity = identity(result);
    let mut writer = E57Writer::new(&mut file, &identity)?;
    writer.register_extension(Extension::new(NAMESPACE, "urn:snellius:e57:1"))?;
    writer.set_coordinate_metadata(Some("local: world frame of the scan".to_owned()));
    let mut cloud = writer.add_pointcloud(&identity, prototype())?;
    cloud.set_name(Some(in_xml(&result.scan)));
    cloud.set_description(Some(in_xml(&description(result))));
    cloud.set_sensor_vendor(Some("Snellius".to_owned()));
    cloud.set_sensor_sw_version(Some(VERSION.to_owned()));
    for point in object_points(result) {
        cloud.add_point(values(&point))?;
    }
    cloud.finalize()?;
    writer.finalize()?;
    drop(writer);
    Ok(file.into_inner())
}

/// The header's lines; of the unit it says what this format makes of it.
fn description(result: &ReconstructionResult) -> String {
    header(result)
        .map(|line| line.replace("unit mm", "unit m (measured in mm)"))
        .join("; ")
}

fn prototype() -> Vec<Record> {
    let double = RecordDataType::Double {
        min: None,
        max: None,
    };
    let number = RecordDataType::Integer {
        min: 0,
        max: i64::from(u32::MAX),
    };
    let record = |name, data_type: &RecordDataType| Record {
        name,
        data_type: data_type.clone(),
    };
    let own = |name: &str| RecordName::Unknown {
        namespace: NAMESPACE.to_owned(),
        name: name.to_owned(),
    };
    let places = [
        RecordName::CartesianX,
        RecordName::CartesianY,
        RecordName::CartesianZ,
    ];
    let measures = ObjectPoint::MEASURES.map(own);
    let doubles = places.into_iter().chain(measures);
    let numbers = ["scan", "view"].map(own);
    doubles
        .map(|name| record(name, &double))
        .chain(numbers.map(|name| record(name, &number)))
        .collect()
}

fn values(point: &ObjectPoint) -> Vec<RecordValue> {
    let lengths = point.place.into_iter().chain(point.measures());
    let lengths = lengths.map(|mm| RecordValue::Double(mm * METRES_PER_MILLIMETRE));
    let numbers = [point.scan, point.view].map(|n| RecordValue::Integer(i64::from(n)));
    lengths.chain(numbers).collect()
}

/// The identity that the format asks of a file and of a cloud, made of the content so that the same scan has
/// the same one: FNV-1a of 128 bits (Fowler, Noll, Vo) in the shape of a UUID of version 8 (RFC 9562).
fn identity(result: &ReconstructionResult) -> String {
    const OFFSET: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;
    const PRIME: u128 = 0x0000_0000_0100_0000_0000_0000_0000_013b;
    let step = |hash: u128, byte| (hash ^ u128::from(byte)).wrapping_mul(PRIME);
    let hash = result.to_json().bytes().fold(OFFSET, step);
    let version = (hash & !(0xf << 76)) | (8 << 76);
    let variant = (version & !(0b11 << 62)) | (0b10 << 62);
    let digits = format!("{variant:032x}");
    let (a, b, c, d, e) = (
        &digits[..8],
        &digits[8..12],
        &digits[12..16],
        &digits[16..20],
        &digits[20..],
    );
    format!("{{{a}-{b}-{c}-{d}-{e}}}")
}

/// A text as a CDATA section can hold it, which is what the writer makes of it: without the characters that
/// XML forbids and without the section's end.
fn in_xml(text: &str) -> String {
    let allowed = |c: &char| !matches!(c, '\u{fffe}' | '\u{ffff}');
    let text: String = in_one_line(text).chars().filter(allowed).collect();
    text.replace("]]>", "]] >")
}
