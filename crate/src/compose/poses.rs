//! Lists of poses that other programs write: tables with named columns (CSV), trajectories (TUM), and
//! lists in JSON. What their numbers mean, a file rarely says; a [`Reading`] does.

use csv::{ReaderBuilder, StringRecord, Trim};
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use serde_json::{Map, Value};

use super::ImportError;
use super::tree::{self, find, number, numbers, plain};
use crate::scan::InsideMedium;

/// The unit of a list's lengths.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LengthScale {
    /// 1 mm.
    #[default]
    Millimetre,
    /// 10 mm.
    Centimetre,
    /// 1000 mm.
    Metre,
}

impl LengthScale {
    /// How many millimetres it is.
    const fn millimetres(self) -> f64 {
        match self {
            Self::Millimetre => 1.0,
            Self::Centimetre => 10.0,
            Self::Metre => 1000.0,
        }
    }
}

/// What a list's numbers mean where the file leaves it open.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reading {
    /// The unit of lengths.
    pub length: LengthScale,
    /// Rotation vectors are in degrees, not radians.
    pub degrees: bool,
    /// Quaternions whose four numbers have no names end with w, and do not begin with it.
    pub w_last: bool,
}

/// A pose of a list.
#[derive(Clone, Debug, PartialEq)]
pub struct ListedPose {
    /// The view or the picture that it belongs to, if the list says it.
    pub name: Option<String>,
    /// Quaternion `[w, x, y, z]`.
    pub rotation: [f64; 4],
    /// Millimetres.
    pub translation: [f64; 3],
    /// What is behind the wall, if the list says it.
    pub inside: Option<InsideMedium>,
}

/// A list of poses as it was written, in one direction or the other: the list does not say which.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PoseList {
    /// In the file's order.
    pub poses: Vec<ListedPose>,
    /// A name that no view has is an error; times are not names, but may be.
    pub named: bool,
    /// There are rotation vectors, so their unit matters.
    pub has_vectors: bool,
    /// There are quaternions without names for their numbers, so their order matters.
    pub has_bare_quaternions: bool,
}

impl PoseList {
    /// Whether it says of any view what is behind the wall.
    pub fn says_inside(&self) -> bool {
        self.poses.iter().any(|pose| pose.inside.is_some())
    }
}

/// Reads a list of poses. Errors name the line, or the entry.
///
/// ```
/// use snellius::compose::{Reading, read_poses};
///
/// let list = read_poses("id,x,y,z,qw,qx,qy,qz\n7,10,20,30,1,0,0,0\n", Reading::default())?;
/// assert_eq!(list.poses[0].name.as_deref(), Some("7"));
/// assert_eq!(list.poses[0].translation, [10.0, 20.0, 30.0]);
/// # Ok::<(), snellius::compose::ImportError>(())
/// ```
pub fn read_poses(text: &str, reading: Reading) -> Result<PoseList, ImportError> {
    let text = text.trim_start_matches('\u{feff}');
    let is_note = |line: &&str| line.trim().is_empty() || line.trim_start().starts_with('#');
    let list = if text.trim_start().starts_with(['[', '{']) {
        of_json(&tree::json(text)?, reading)
    } else if has_commented_heading(text) {
        of_table(text, reading)
    } else {
        let Some(first) = text.lines().find(|line| !is_note(line)) else {
            return Err(unknown("it is empty"));
        };
        match bare_numbers(first) {
            Some(8) => of_rows(text, Layout::Tum, reading),
            Some(12 | 16) => of_rows(text, Layout::Matrix, reading),
            Some(count) => Err(unknown(&format!(
                "its lines have {count} numbers and no heading: a table needs a first line that names its \
                 columns, a TUM trajectory has 8 numbers a line, a matrix 12 or 16"
            ))),
            None => of_table(text, reading),
        }
    }?;
    match list.poses.is_empty() {
        true => Err(unknown("there is no pose in it")),
        false => Ok(list),
    }
}

/// Some write a table's heading as a comment; that of a TUM file has no signs between the names.
fn has_commented_heading(text: &str) -> bool {
    let comment = text.trim_start().strip_prefix('#');
    let first = comment.and_then(|text| text.lines().next());
    first.is_some_and(|line| line.contains(['\t', ';', ',']))
}

fn unknown(why: &str) -> ImportError {
    ImportError::Unknown(format!("this is no list of poses: {why}"))
}

/// How many numbers a line has, if it has nothing else.
fn bare_numbers(line: &str) -> Option<usize> {
    let words: Vec<&str> = split(line).collect();
    let all = words.iter().all(|word| word.parse::<f64>().is_ok());
    all.then_some(words.len())
}

fn split(line: &str) -> impl Iterator<Item = &str> {
    line.split([' ', '\t', ',', ';', '\r'])
        .filter(|word| !word.is_empty())
}

/// What the columns of a file without a heading are.
#[derive(Clone, Copy)]
enum Layout {
    /// `t tx ty tz qx qy qz qw`, as the TUM RGB-D benchmark defines it.
    Tum,
    /// A matrix of 3 x 4 or 4 x 4, row by row.
    Matrix,
}

fn of_rows(text: &str, layout: Layout, reading: Reading) -> Result<PoseList, ImportError> {
    let mut list = PoseList::default();
    for (index, line) in text.lines().enumerate() {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let place = format!("line {}", index + 1);
        let words: Vec<&str> = split(line).collect();
        let numbers = words.iter().map(|word| parse(word, &place));
        let numbers: Vec<f64> = numbers.collect::<Result<_, _>>()?;
        list.poses.push(match (layout, numbers.as_slice()) {
            (Layout::Tum, [_, x, y, z, i, j, k, w]) => {
                let rotation = unit([*w, *i, *j, *k], &place)?;
                pose(Some(words[0].to_owned()), rotation, [*x, *y, *z], reading)
            }
            (Layout::Tum, _) => {
                let problem = format!("{} numbers, not 8: t tx ty tz qx qy qz qw", numbers.len());
                return Err(ImportError::value(place, problem));
            }
            (Layout::Matrix, rows) => {
                let (rotation, translation) = of_matrix(rows, &place)?;
                pose(None, rotation, translation, reading)
            }
        });
    }
    Ok(list)
}

fn pose(
    name: Option<String>,
    rotation: [f64; 4],
    translation: [f64; 3],
    reading: Reading,
) -> ListedPose {
    ListedPose {
        name,
        rotation,
        translation: translation.map(|length| length * reading.length.millimetres()),
        inside: None,
    }
}

/// The columns of a table, by what they hold.
struct Columns {
    name: Option<usize>,
    inside: Option<usize>,
    translation: Option<[usize; 3]>,
    rotation: Rotation,
}

enum Rotation {
    Quaternion([usize; 4]),
    Vector([usize; 3]),
    /// Nine numbers of a rotation,
    Rows([usize; 9]),
    /// or twelve of a pose.
    Pose([usize; 12]),
}

impl Columns {
    fn of(heading: &StringRecord) -> Result<Self, ImportError> {
        let names: Vec<String> = heading.iter().map(column_name).collect();
        let at = |name: &str| names.iter().position(|column| column == name);
        let one_of = |names: &[&str]| names.iter().find_map(|name| at(name));
        let triple = |sets: &[[&str; 3]]| {
            let mut found = sets.iter().filter_map(|set| all(set, at));
            found.next()
        };
        let translation = triple(&[
            ["x", "y", "z"],
            ["tx", "ty", "tz"],
            ["px", "py", "pz"],
            ["posx", "posy", "posz"],
        ]);
        let rotation = if let Some(columns) = all(&["qw", "qx", "qy", "qz"], at) {
            Rotation::Quaternion(columns)
        } else if let Some(columns) = all(&["rx", "ry", "rz"], at) {
            Rotation::Vector(columns)
        } else if let Some(columns) = all(&MATRIX, at) {
            Rotation::Pose(columns)
        } else if let Some(columns) = all(&ROTATION, at) {
            Rotation::Rows(columns)
        } else {
            return Err(ImportError::value(
                "line 1",
                "no columns of a rotation: qw qx qy qz (a quaternion), rx ry rz (a rotation vector), r11 to \
                 r33 (a matrix), or m00 to m23 (a whole pose) can be read",
            ));
        };
        if translation.is_none() && !matches!(rotation, Rotation::Pose(_)) {
            let problem = "no columns x, y, z of the position (or tx, ty, tz)";
            return Err(ImportError::value("line 1", problem));
        }
        Ok(Self {
            name: one_of(&["id", "name", "view", "image", "picture", "file", "filename"]),
            inside: at("inside"),
            translation,
            rotation,
        })
    }
}

const MATRIX: [&str; 12] = [
    "m00", "m01", "m02", "m03", "m10", "m11", "m12", "m13", "m20", "m21", "m22", "m23",
];
const ROTATION: [&str; 9] = [
    "r11", "r12", "r13", "r21", "r22", "r23", "r31", "r32", "r33",
];

fn all<const N: usize>(
    names: &[&str; N],
    at: impl Fn(&str) -> Option<usize>,
) -> Option<[usize; N]> {
    let mut columns = [0; N];
    for (column, name) in columns.iter_mut().zip(names) {
        *column = at(name)?;
    }
    Some(columns)
}

/// `Tx [mm]` is `tx`.
fn column_name(heading: &str) -> String {
    plain(heading.split(['[', '(']).next().unwrap_or_default())
}

fn of_table(text: &str, reading: Reading) -> Result<PoseList, ImportError> {
    let text = text.trim_start().trim_start_matches('#');
    let first = text.lines().next().unwrap_or_default();
    let delimiter = [b'\t', b';', b','];
    let delimiter = delimiter
        .into_iter()
        .find(|sign| first.as_bytes().contains(sign));
    let mut reader = ReaderBuilder::new()
        .delimiter(delimiter.unwrap_or(b' '))
        .comment(Some(b'#'))
        .trim(Trim::All)
        .from_reader(text.as_bytes());
    let columns = Columns::of(reader.headers().map_err(|error| of_csv(&error))?)?;
    let mut list = PoseList {
        named: columns.name.is_some(),
        has_vectors: matches!(columns.rotation, Rotation::Vector(_)),
        ..PoseList::default()
    };
    for record in reader.records() {
        let record = record.map_err(|error| of_csv(&error))?;
        list.poses.push(of_record(&columns, &record, reading)?);
    }
    Ok(list)
}

fn of_csv(error: &csv::Error) -> ImportError {
    match error.position() {
        Some(position) => ImportError::value(
            format!("line {}", position.line()),
            match error.kind() {
                csv::ErrorKind::UnequalLengths {
                    expected_len, len, ..
                } => {
                    format!("{len} columns, and the heading has {expected_len}")
                }
                _ => error.to_string(),
            },
        ),
        None => unknown(&error.to_string()),
    }
}

fn of_record(
    columns: &Columns,
    record: &StringRecord,
    reading: Reading,
) -> Result<ListedPose, ImportError> {
    let line = record.position().map_or(0, csv::Position::line);
    let place = format!("line {line}");
    let text = |column: usize| record.get(column).unwrap_or_default();
    let (rotation, translation) = match &columns.rotation {
        Rotation::Quaternion(columns) => (unit(pick(record, columns, &place)?, &place)?, None),
        Rotation::Vector(columns) => {
            let vector = pick(record, columns, &place)?;
            (of_vector(vector, reading.degrees), None)
        }
        Rotation::Rows(columns) => {
            let rows = pick(record, columns, &place)?;
            (of_rotation(&rows, &place)?, None)
        }
        Rotation::Pose(columns) => {
            let rows = pick(record, columns, &place)?;
            let (rotation, translation) = of_matrix(&rows, &place)?;
            (rotation, Some(translation))
        }
    };
    let translation = match (translation, &columns.translation) {
        (None, Some(columns)) => pick(record, columns, &place)?,
        (translation, _) => translation.unwrap_or_default(),
    };
    let name = columns.name.map(|column| text(column).to_owned());
    let inside = columns.inside.map(|column| inside(text(column), &place));
    Ok(ListedPose {
        inside: inside.transpose()?.flatten(),
        ..pose(name, rotation, translation, reading)
    })
}

fn pick<const N: usize>(
    record: &StringRecord,
    columns: &[usize; N],
    place: &str,
) -> Result<[f64; N], ImportError> {
    let mut numbers = [0.0; N];
    for (number, column) in numbers.iter_mut().zip(columns) {
        *number = parse(record.get(*column).unwrap_or_default(), place)?;
    }
    Ok(numbers)
}

fn parse(word: &str, place: &str) -> Result<f64, ImportError> {
    let number = word.parse().ok().filter(|number: &f64| number.is_finite());
    number.ok_or_else(|| ImportError::value(place, format!("\"{word}\" is no number")))
}

fn inside(word: &str, place: &str) -> Result<Option<InsideMedium>, ImportError> {
    match plain(word).as_str() {
        "" => Ok(None),
        "liquid" => Ok(Some(InsideMedium::Liquid)),
        "air" => Ok(Some(InsideMedium::Air)),
        _ => {
            let problem = format!("\"{word}\" is behind no wall; liquid or air can be");
            Err(ImportError::value(place, problem))
        }
    }
}

/// A list, or a mapping from names to poses.
fn of_json(tree: &Value, reading: Reading) -> Result<PoseList, ImportError> {
    let mut list = PoseList::default();
    match tree {
        Value::Array(entries) => {
            for (index, entry) in entries.iter().enumerate() {
                let place = format!("[{index}]");
                let pose = of_entry(entry, &place, reading, &mut list)?;
                list.poses.push(pose);
            }
            list.named = list.poses.iter().all(|pose| pose.name.is_some());
        }
        Value::Object(file) => {
            if let Some((_, poses)) = find(file, &["poses", "views"]) {
                return of_json(poses, reading);
            }
            for (name, entry) in file {
                let pose = of_entry(entry, name, reading, &mut list)?;
                list.poses.push(ListedPose {
                    name: Some(name.clone()),
                    ..pose
                });
            }
            list.named = true;
        }
        _ => return Err(unknown("a list is wanted")),
    }
    Ok(list)
}

/// A matrix, or a mapping with rotation and translation, or with a matrix.
fn of_entry(
    entry: &Value,
    place: &str,
    reading: Reading,
    list: &mut PoseList,
) -> Result<ListedPose, ImportError> {
    let Some(keys) = entry.as_object() else {
        let (rotation, translation) = of_matrix(&numbers(entry, place)?, place)?;
        return Ok(pose(None, rotation, translation, reading));
    };
    let name = find(
        keys,
        &["id", "name", "view", "image", "picture", "file", "filename"],
    );
    let name = name.map(|(_, name)| {
        name.as_str()
            .map_or_else(|| name.to_string(), str::to_owned)
    });
    let (rotation, translation) = match find(keys, &["matrix", "pose", "transform"]) {
        Some((key, matrix)) => {
            let place = format!("{place}.{key}");
            of_matrix(&numbers(matrix, &place)?, &place)?
        }
        None => of_parts(keys, place, reading, list)?,
    };
    let inside = keys.get("inside").and_then(Value::as_str);
    let inside = inside.map(|word| inside_of(word, place)).transpose()?;
    Ok(ListedPose {
        inside: inside.flatten(),
        ..pose(name, rotation, translation, reading)
    })
}

fn inside_of(word: &str, place: &str) -> Result<Option<InsideMedium>, ImportError> {
    inside(word, &format!("{place}.inside"))
}

type Parts = ([f64; 4], [f64; 3]);

fn of_parts(
    keys: &Map<String, Value>,
    place: &str,
    reading: Reading,
    list: &mut PoseList,
) -> Result<Parts, ImportError> {
    let missing = |key: &str, problem| ImportError::value(format!("{place}.{key}"), problem);
    let (key, translation) = find(keys, &["translation", "position", "t", "tvec"])
        .ok_or_else(|| missing("translation", "missing; the position has three numbers"))?;
    let translation = by_names(translation, ["x", "y", "z"], &format!("{place}.{key}"))?;
    let (key, rotation) = find(
        keys,
        &[
            "quaternion",
            "q",
            "rotation",
            "orientation",
            "rvec",
            "rotationvector",
            "r",
        ],
    )
    .ok_or_else(|| missing("quaternion", "missing; the rotation has four numbers"))?;
    let place = format!("{place}.{key}");
    if rotation.is_object() {
        let quaternion = by_names(rotation, ["w", "x", "y", "z"], &place)?;
        return Ok((unit(quaternion, &place)?, translation));
    }
    let numbers = numbers(rotation, &place)?;
    let rotation = match *numbers.as_slice() {
        [a, b, c, d] => {
            list.has_bare_quaternions = true;
            unit(
                if reading.w_last {
                    [d, a, b, c]
                } else {
                    [a, b, c, d]
                },
                &place,
            )?
        }
        [x, y, z] => {
            list.has_vectors = true;
            of_vector([x, y, z], reading.degrees)
        }
        _ if numbers.len() == 9 => of_rotation(&numbers, &place)?,
        _ => {
            let problem = format!("{} numbers; a rotation has 3, 4 or 9", numbers.len());
            return Err(ImportError::value(place, problem));
        }
    };
    Ok((rotation, translation))
}

/// The numbers of a list, or of a mapping that names each.
fn by_names<const N: usize>(
    value: &Value,
    names: [&str; N],
    place: &str,
) -> Result<[f64; N], ImportError> {
    let found = match value.as_object() {
        Some(keys) => {
            let each = names.iter().map(|name| {
                let place = format!("{place}.{name}");
                number(keys.get(*name).unwrap_or(&Value::Null), &place)
            });
            each.collect::<Result<Vec<_>, _>>()?
        }
        None => numbers(value, place)?,
    };
    let count = found.len();
    found
        .try_into()
        .map_err(|_| ImportError::value(place, format!("{count} numbers, not {N}")))
}

/// A quaternion as it was written; its length tells whether it is one.
fn unit(quaternion: [f64; 4], place: &str) -> Result<[f64; 4], ImportError> {
    const TOLERANCE: f64 = 0.01;
    let length = quaternion
        .iter()
        .map(|part| part * part)
        .sum::<f64>()
        .sqrt();
    if (length - 1.0).abs() <= TOLERANCE {
        return Ok(quaternion);
    }
    let problem = format!("a quaternion of length {length:.3}; a rotation's is 1");
    Err(ImportError::value(place, problem))
}

/// The axis times the angle.
fn of_vector(vector: [f64; 3], degrees: bool) -> [f64; 4] {
    let unit = if degrees { 1.0_f64.to_radians() } else { 1.0 };
    let rotation = UnitQuaternion::from_scaled_axis(Vector3::from(vector) * unit);
    [rotation.w, rotation.i, rotation.j, rotation.k]
}

/// The nine numbers of a rotation matrix, row by row.
fn of_rotation(rows: &[f64], place: &str) -> Result<[f64; 4], ImportError> {
    const TOLERANCE: f64 = 0.01;
    let matrix = Matrix3::from_row_slice(rows);
    let off = (matrix * matrix.transpose() - Matrix3::identity()).norm();
    if off > TOLERANCE || matrix.determinant() < 0.0 {
        let problem =
            "no rotation: its rows are not of length 1 and square to each other, or it mirrors";
        return Err(ImportError::value(place, problem));
    }
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(matrix));
    Ok([rotation.w, rotation.i, rotation.j, rotation.k])
}

/// 3 x 4 or 4 x 4 numbers, row by row.
fn of_matrix(numbers: &[f64], place: &str) -> Result<Parts, ImportError> {
    let (pose, last) = numbers.split_at(numbers.len().min(12));
    let is_pose = pose.len() == 12 && (last.is_empty() || last.len() == 4);
    if !is_pose {
        let problem = format!("{} numbers; a pose's matrix has 12 or 16", numbers.len());
        return Err(ImportError::value(place, problem));
    }
    if !last.is_empty() && last != [0.0, 0.0, 0.0, 1.0] {
        let problem = "the last row is not 0 0 0 1; are rows and columns exchanged?";
        return Err(ImportError::value(place, problem));
    }
    let rows: Vec<f64> = pose.chunks(4).flat_map(|row| row[..3].to_vec()).collect();
    Ok((of_rotation(&rows, place)?, [pose[3], pose[7], pose[11]]))
}
