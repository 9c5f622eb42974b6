//! Calibration files of other programs: OpenCV's (YAML, XML, JSON) and ROS's `camera_info`.
//!
//! All of them mean the same lens, OpenCV's: the matrix `[[fx, 0, cx], [0, fy, cy], [0, 0, 1]]` in pixels,
//! pixel (0, 0) being the centre of the top-left one, and the coefficients k1 k2 p1 p2 [k3 [k4 k5 k6]].

use serde_json::{Map, Value};

use super::ImportError;
use super::tree::{self, find, number, numbers};
use crate::scan::{CameraEntry, CameraModel};

/// What a calibration file says of a lens, px.
#[derive(Clone, Debug, PartialEq)]
pub struct Lens {
    /// Width and height of the pictures it was calibrated with, where the file says it.
    pub size: Option<[u32; 2]>,
    /// fx, fy.
    pub focal: [f64; 2],
    /// cx, cy.
    pub centre: [f64; 2],
    /// None, 4, 5 or 8 numbers.
    pub distortion: Vec<f64>,
}

impl Lens {
    /// The manifest's entry, for pictures of a size.
    pub fn entry(&self, [width, height]: [u32; 2]) -> CameraEntry {
        CameraEntry {
            model: CameraModel::Opencv,
            width,
            height,
            fx: self.focal[0],
            fy: self.focal[1],
            cx: self.centre[0],
            cy: self.centre[1],
            distortion: self.distortion.clone(),
            extra: Default::default(),
        }
    }
}

/// Reads a calibration file. A lens of another model than OpenCV's is an error that names the key.
///
/// ```
/// let text = "image_width: 440\nimage_height: 330\ncamera_matrix:\n  data: [661.5, 0, 221.9, 0, 661.1, \
///             162.8, 0, 0, 1]\ndistortion_model: plumb_bob\ndistortion_coefficients:\n  data: [0, 0, 0, 0, 0]\n";
/// let lens = snellius::compose::read_calibration(text)?;
/// assert_eq!(lens.size, Some([440, 330]));
/// assert_eq!(lens.focal, [661.5, 661.1]);
/// # Ok::<(), snellius::compose::ImportError>(())
/// ```
pub fn read_calibration(text: &str) -> Result<Lens, ImportError> {
    let tree = tree::read(text)?;
    let file = tree.as_object().ok_or_else(|| {
        ImportError::Unknown(
            "this is no calibration file: it has no keys; OpenCV's YAML, XML and JSON and ROS's camera_info \
             can be read"
                .to_owned(),
        )
    })?;
    check_model(file)?;
    let [focal, centre] = matrix(file)?;
    Ok(Lens {
        size: size(file)?,
        focal,
        centre,
        distortion: distortion(file)?,
    })
}

/// Refuses lenses of other models.
fn check_model(file: &Map<String, Value>) -> Result<(), ImportError> {
    const OURS: [&str; 6] = [
        "",
        "plumbbob",
        "rationalpolynomial",
        "pinhole",
        "opencv",
        "radtan",
    ];
    for name in ["distortionmodel", "cameramodel", "cameratype"] {
        if let Some((key, Value::String(model))) = find(file, &[name])
            && !OURS.contains(&tree::plain(model).as_str())
        {
            return Err(unsupported(key, model));
        }
    }
    match find(file, &["fisheyemodel", "fisheye"]) {
        Some((key, said))
            if said.as_f64().is_some_and(|n| n != 0.0) || said == &Value::Bool(true) =>
        {
            Err(unsupported(key, "fisheye"))
        }
        _ => Ok(()),
    }
}

fn unsupported(key: &str, model: &str) -> ImportError {
    ImportError::value(
        key,
        format!(
            "\"{model}\" is another lens model; scans take OpenCV's, with radial (k1 to k6) and tangential \
             (p1, p2) distortion: calibrate with that"
        ),
    )
}

/// Focal lengths and principal point.
fn matrix(file: &Map<String, Value>) -> Result<[[f64; 2]; 2], ImportError> {
    let (key, value) = find(file, &["cameramatrix", "k", "intrinsicmatrix", "mtx"])
        .ok_or_else(|| ImportError::value("camera_matrix", "missing; it has fx, fy, cx, cy"))?;
    let numbers = numbers(value, key)?;
    let [fx, skew, cx, zero, fy, cy, low @ ..] = numbers.as_slice() else {
        return Err(nine(key, numbers.len()));
    };
    if low.len() != 3 {
        return Err(nine(key, numbers.len()));
    }
    if low != [0.0, 0.0, 1.0] || *zero != 0.0 {
        let problem = "not of the form [fx 0 cx, 0 fy cy, 0 0 1]";
        return Err(ImportError::value(key, problem));
    }
    if *skew != 0.0 {
        let problem =
            format!("a skew of {skew}; scans take lenses without, as OpenCV calibrates them");
        return Err(ImportError::value(key, problem));
    }
    Ok([[*fx, *fy], [*cx, *cy]])
}

fn nine(key: &str, count: usize) -> ImportError {
    ImportError::value(key, format!("{count} numbers; a 3 x 3 matrix has 9"))
}

/// Newer flags of OpenCV write coefficients that are all 0 behind those that scans take.
fn distortion(file: &Map<String, Value>) -> Result<Vec<f64>, ImportError> {
    const NAMES: [&str; 6] = [
        "distortioncoefficients",
        "distortioncoeffs",
        "distcoeffs",
        "distcoeff",
        "dist",
        "d",
    ];
    const TAKEN: usize = 8;
    let Some((key, value)) = find(file, &NAMES) else {
        let problem = "missing; a lens without distortion has an empty list there";
        return Err(ImportError::value("distortion_coefficients", problem));
    };
    let mut numbers = numbers(value, key)?;
    match numbers.len() {
        0 | 4 | 5 | TAKEN => Ok(numbers),
        12 | 14 if numbers[TAKEN..].iter().all(|number| *number == 0.0) => {
            numbers.truncate(TAKEN);
            Ok(numbers)
        }
        12 | 14 => Err(ImportError::value(
            format!("{key}[{TAKEN}]"),
            "thin-prism or tilt coefficients that are not 0; calibrate without CALIB_THIN_PRISM_MODEL and \
             CALIB_TILTED_MODEL",
        )),
        count => Err(ImportError::value(
            key,
            format!("{count} coefficients; k1 k2 p1 p2 [k3 [k4 k5 k6]] are 4, 5 or 8"),
        )),
    }
}

fn size(file: &Map<String, Value>) -> Result<Option<[u32; 2]>, ImportError> {
    let width = find(file, &["imagewidth", "width"]);
    let height = find(file, &["imageheight", "height"]);
    if let (Some((wide, width)), Some((high, height))) = (width, height) {
        return Ok(Some([pixels(width, wide)?, pixels(height, high)?]));
    }
    let Some((key, value)) = find(file, &["imagesize", "resolution"]) else {
        return Ok(None);
    };
    match value.as_array().map(Vec::as_slice) {
        Some([width, height]) => Ok(Some([pixels(width, key)?, pixels(height, key)?])),
        _ => Err(ImportError::value(key, "width and height are two numbers")),
    }
}

fn pixels(value: &Value, place: &str) -> Result<u32, ImportError> {
    let number = number(value, place)?;
    if (1.0..=1e6).contains(&number) && number.floor() == number {
        Ok(number as u32)
    } else {
        let problem = format!("{number} is no number of pixels");
        Err(ImportError::value(place, problem))
    }
}
