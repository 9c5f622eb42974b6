//! From the manifest as it was written to a scan that can be measured.

use super::check::positive;
use super::{
    CalibrationSigmaEntry, Extra, InsideMedium, LaserEntry, LaserKind, Limits, Manifest, Motion,
    Place, PoseEntry, ScanError, ViewEntry, known_wall,
};
use crate::camera::{Distortion, Intrinsics, Pixel};
use crate::geometry::{Camera, Direction, Flange, Frame, Point, Pose, Ray, World};
use crate::json;
use crate::optics::Surface;
use crate::rig::{CalibrationSigma, Laser, Rig, Sheet};

/// A checked scan: the manifest, and what it means in the units and frames of the mathematics.
#[derive(Clone, Debug, PartialEq)]
pub struct Scan {
    /// As it stands in the archive.
    pub manifest: Manifest,
    /// The range finder.
    pub rig: Rig,
    /// What calibration gave, to one standard deviation.
    pub calibration_sigma: CalibrationSigma,
    /// The wall's outer face, where it is known beforehand.
    pub known_wall: Option<Surface>,
    /// The views' poses and media, in the manifest's order.
    pub stations: Vec<Station>,
    /// What is odd but no error.
    pub warnings: Vec<String>,
}

/// Where a view was taken from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Station {
    /// The manipulator's pose; where the vessel moves, the rig's mount as seen from the vessel.
    pub world_from_flange: Pose<World, Flange>,
    /// The camera's pose.
    pub world_from_camera: Pose<World, Camera>,
    /// What the beam enters behind the wall.
    pub inside: InsideMedium,
}

impl Manifest {
    /// Reads `scan.json`; an error names the line, or the key.
    pub fn from_json(json: &[u8]) -> Result<Self, ScanError> {
        json::read(json, "scan.json").map_err(|json::Misread { place, problem }| {
            match problem.classify() {
                serde_json::error::Category::Data => {
                    ScanError::value(Place::key(place), json::without_position(&problem))
                }
                _ => syntax(&problem),
            }
        })
    }
}

fn syntax(problem: &serde_json::Error) -> ScanError {
    ScanError::Syntax {
        line: problem.line(),
        column: problem.column(),
        problem: format!(
            "{} (JSON has no NaN, no comments and no trailing commas)",
            json::without_position(problem)
        ),
    }
}

impl Scan {
    /// Checks a manifest. The error names the first key that cannot be used.
    pub fn new(manifest: Manifest) -> Result<Self, ScanError> {
        check_version(&manifest)?;
        let rig = Rig {
            camera: intrinsics(&manifest)?,
            laser: laser(&manifest)?,
            flange_from_camera: pose(&manifest.flange_from_camera, "flange_from_camera")?,
        };
        check_media(&manifest)?;
        check_vessel(&manifest)?;
        let calibration_sigma = calibration_sigma(manifest.calibration_sigma.as_ref())?;
        let known_wall = known_wall::of(&manifest.vessel)?;
        let stations = stations(&manifest, &rig)?;
        let warnings = warnings(&manifest);
        Ok(Self {
            manifest,
            rig,
            calibration_sigma,
            known_wall,
            stations,
            warnings,
        })
    }
}

fn check_version(manifest: &Manifest) -> Result<(), ScanError> {
    if manifest.version == 1 {
        return Ok(());
    }
    Err(ScanError::value(
        Place::key("version"),
        format!(
            "this program reads version 1, and the file is version {}",
            manifest.version
        ),
    ))
}

fn intrinsics(manifest: &Manifest) -> Result<Intrinsics, ScanError> {
    let entry = &manifest.camera;
    let limit = Limits::default().pixels;
    let pixels = u64::from(entry.width) * u64::from(entry.height);
    if pixels == 0 || pixels > limit {
        return Err(ScanError::value(
            Place::key("camera.width"),
            format!(
                "a picture of {} x {} pixels; between 1 and {} million can be measured",
                entry.width,
                entry.height,
                limit / 1_000_000
            ),
        ));
    }
    positive(entry.fx, "camera.fx")?;
    positive(entry.fy, "camera.fy")?;
    let distortion = Distortion::from_opencv(&entry.distortion).ok_or_else(|| {
        ScanError::value(
            Place::key("camera.distortion"),
            format!(
                "{} coefficients; OpenCV's order k1 k2 p1 p2 [k3 [k4 k5 k6]] has 4, 5 or 8",
                entry.distortion.len()
            ),
        )
    })?;
    let camera = Intrinsics {
        width: entry.width,
        height: entry.height,
        focal: [entry.fx, entry.fy],
        centre: Pixel::new(entry.cx, entry.cy),
        distortion,
    };
    // The lens must be usable where the pictures are.
    let (right, bottom) = (f64::from(entry.width) - 1.0, f64::from(entry.height) - 1.0);
    for (u, v) in [(0.0, 0.0), (right, 0.0), (0.0, bottom), (right, bottom)] {
        camera.slope(Pixel::new(u, v)).map_err(|e| {
            ScanError::value(
                Place::key("camera.distortion"),
                format!("{e}: the picture's corner"),
            )
        })?;
    }
    Ok(camera)
}

fn laser(manifest: &Manifest) -> Result<Laser, ScanError> {
    match manifest.laser.kind {
        LaserKind::Spot => beam(&manifest.laser).map(Laser::Beam),
        LaserKind::Line => sheet(&manifest.laser).map(Laser::Sheet),
    }
}

fn beam(laser: &LaserEntry) -> Result<Ray<Camera>, ScanError> {
    let place = Place::key("laser.direction");
    let along = laser
        .direction
        .ok_or_else(|| ScanError::value(place.clone(), "missing; a spot laser needs it"))?;
    let direction = direction(along, place)?;
    let origin = Point::<Camera>::from(laser.origin);
    if origin.coords.cross(&direction.vector()).norm() < 1e-6 {
        return Err(ScanError::value(
            Place::key("laser.origin"),
            "the beam goes through the camera's centre, so nothing can be triangulated",
        ));
    }
    Ok(Ray::new(origin, direction))
}

fn sheet(laser: &LaserEntry) -> Result<Sheet, ScanError> {
    let place = Place::key("laser.normal");
    let across = laser
        .normal
        .ok_or_else(|| ScanError::value(place.clone(), "missing; a line laser needs it"))?;
    let sheet = Sheet {
        apex: Point::from(laser.origin),
        normal: direction(across, place)?,
    };
    if sheet.plane().signed_distance(Point::origin()).abs() < 1e-6 {
        return Err(ScanError::value(
            Place::key("laser.origin"),
            "the sheet goes through the camera's centre, so nothing can be triangulated",
        ));
    }
    Ok(sheet)
}

fn direction(along: [f64; 3], place: Place) -> Result<Direction<Camera>, ScanError> {
    Direction::new(along.into())
        .map_err(|_| ScanError::value(place, "a vector of length zero has no direction"))
}

fn pose<A: Frame, B: Frame>(entry: &PoseEntry, place: &str) -> Result<Pose<A, B>, ScanError> {
    Pose::new(entry.rotation, entry.translation).map_err(|_| {
        ScanError::value(
            Place::key(format!("{place}.rotation")),
            "a quaternion of length zero is no rotation",
        )
    })
}

fn check_media(manifest: &Manifest) -> Result<(), ScanError> {
    let media = &manifest.media;
    refractive_index(media.outside, "media.outside")?;
    refractive_index(media.wall, "media.wall")?;
    media
        .inside
        .map_or(Ok(()), |n| refractive_index(n, "media.inside"))
}

/// Checks that a number can be an index of refraction.
fn refractive_index(value: f64, place: &str) -> Result<(), ScanError> {
    if (1.0..=4.0).contains(&value) {
        return Ok(());
    }
    Err(ScanError::value(
        Place::key(place),
        format!("{value} is no refractive index of a clear medium; these lie between 1 and 4"),
    ))
}

fn check_vessel(manifest: &Manifest) -> Result<(), ScanError> {
    positive(manifest.vessel.wall_thickness, "vessel.wall_thickness")?;
    if let Some(far) = &manifest.vessel.far_wall {
        positive(far.distance, "vessel.far_wall.distance")?;
        positive(far.thickness, "vessel.far_wall.thickness")?;
    }
    Ok(())
}

fn calibration_sigma(entry: Option<&CalibrationSigmaEntry>) -> Result<CalibrationSigma, ScanError> {
    let mut sigma = CalibrationSigma::default();
    let Some(entry) = entry else {
        return Ok(sigma);
    };
    let take = |given: Option<f64>, place: &str, into: &mut f64, unit: f64| {
        let Some(value) = given else { return Ok(()) };
        if !(value >= 0.0 && value.is_finite()) {
            return Err(ScanError::value(
                Place::key(format!("calibration_sigma.{place}")),
                format!("{value}; a standard deviation is 0 or more"),
            ));
        }
        *into = value * unit;
        Ok(())
    };
    let degree = 1.0_f64.to_radians();
    take(
        entry.laser_origin,
        "laser_origin",
        &mut sigma.laser_origin,
        1.0,
    )?;
    take(
        entry.laser_direction,
        "laser_direction",
        &mut sigma.laser_direction,
        degree,
    )?;
    take(
        entry.focal_length,
        "focal_length",
        &mut sigma.focal_length,
        1.0,
    )?;
    take(
        entry.principal_point,
        "principal_point",
        &mut sigma.principal_point,
        1.0,
    )?;
    take(
        entry.hand_eye_rotation,
        "hand_eye_rotation",
        &mut sigma.hand_eye_rotation,
        degree,
    )?;
    take(
        entry.hand_eye_translation,
        "hand_eye_translation",
        &mut sigma.hand_eye_translation,
        1.0,
    )?;
    Ok(sigma)
}

fn stations(manifest: &Manifest, rig: &Rig) -> Result<Vec<Station>, ScanError> {
    if manifest.views.is_empty() {
        return Err(ScanError::value(
            Place::key("views"),
            "the scan has no views",
        ));
    }
    let mut ids = std::collections::HashMap::new();
    let mut stations = Vec::with_capacity(manifest.views.len());
    for (index, view) in manifest.views.iter().enumerate() {
        if let Some(first) = ids.insert(view.id.as_str(), index) {
            return Err(ScanError::value(
                Place::view(index, "id"),
                format!("\"{}\" is the id of views[{first}] already", view.id),
            ));
        }
        check_name(&view.on, Place::view(index, "on"))?;
        if let Some(off) = &view.off {
            check_name(off, Place::view(index, "off"))?;
        }
        let world_from_flange = world_from_flange(manifest.motion, view, index)?;
        stations.push(Station {
            world_from_flange,
            world_from_camera: rig.station(&world_from_flange),
            inside: view.inside,
        });
    }
    Ok(stations)
}

/// Where the rig stands in the frame of the vessel, whichever of the two moves.
fn world_from_flange(
    motion: Motion,
    view: &ViewEntry,
    index: usize,
) -> Result<Pose<World, Flange>, ScanError> {
    let (key, entry, other_key, other) = match motion {
        Motion::Rig => (
            "world_from_flange",
            &view.world_from_flange,
            "flange_from_world",
            &view.flange_from_world,
        ),
        Motion::Vessel => (
            "flange_from_world",
            &view.flange_from_world,
            "world_from_flange",
            &view.world_from_flange,
        ),
    };
    if other.is_some() {
        let problem = format!("\"motion\" says that the view's pose is given as {key}");
        return Err(ScanError::value(Place::view(index, other_key), problem));
    }
    let place = format!("views[{index}].{key}");
    let entry = entry.as_ref().ok_or_else(|| {
        ScanError::value(Place::key(place.clone()), "missing; every view needs it")
    })?;
    match motion {
        Motion::Rig => pose(entry, &place),
        Motion::Vessel => pose::<Flange, World>(entry, &place).map(|pose| pose.inverse()),
    }
}

/// An entry's name must stay within the archive.
fn check_name(name: &str, place: Place) -> Result<(), ScanError> {
    let outside = name.starts_with('/')
        || name.contains('\\')
        || name.contains(':')
        || name.split('/').any(|part| part == "..");
    if name.is_empty() || outside {
        return Err(ScanError::value(
            place,
            format!("\"{name}\" is not a path within the archive (relative, with /, without ..)"),
        ));
    }
    Ok(())
}

fn warnings(manifest: &Manifest) -> Vec<String> {
    let mut warnings = Vec::new();
    let mut unknown = |place: &str, extra: &Extra| {
        warnings.extend(extra.keys().map(|key| {
            format!("{place}{key}: this key is not known to this version and was left alone")
        }));
    };
    unknown("", &manifest.extra);
    unknown("camera.", &manifest.camera.extra);
    unknown("laser.", &manifest.laser.extra);
    unknown("flange_from_camera.", &manifest.flange_from_camera.extra);
    unknown("vessel.", &manifest.vessel.extra);
    if let Some(far) = &manifest.vessel.far_wall {
        unknown("vessel.far_wall.", &far.extra);
    }
    unknown("media.", &manifest.media.extra);
    if let Some(sigma) = &manifest.calibration_sigma {
        unknown("calibration_sigma.", &sigma.extra);
    }
    for (index, known) in manifest.known.iter().enumerate() {
        unknown(&format!("known[{index}]."), &known.extra);
    }
    for (index, view) in manifest.views.iter().enumerate() {
        unknown(&format!("views[{index}]."), &view.extra);
        let poses = [
            ("world_from_flange", &view.world_from_flange),
            ("flange_from_world", &view.flange_from_world),
        ];
        for (key, pose) in poses {
            if let Some(pose) = pose {
                unknown(&format!("views[{index}].{key}."), &pose.extra);
            }
        }
    }
    let alone: Vec<&str> = manifest
        .views
        .iter()
        .filter(|v| v.off.is_none())
        .map(|v| v.id.as_str())
        .collect();
    if !alone.is_empty() {
        warnings.push(format!(
            "{} without a laser-off picture, taken alone: {}",
            crate::text::count(alone.len(), "view"),
            crate::text::some_of(&alone)
        ));
    }
    warnings
}
