//! `scan.json` as it stands in the archive. What it means (checked, in radians, with frames) is a
//! [`Scan`](super::Scan).

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// Keys this version does not know: kept and warned of, never an error.
pub type Extra = BTreeMap<String, serde_json::Value>;

/// Generates a struct of the manifest: public, serialisable, with a schema, keeping unknown keys.
macro_rules! manifest {
    ($($(#[$meta:meta])* pub struct $name:ident { $($(#[$field_meta:meta])* pub $field:ident: $type:ty,)* })*) => {$(
        $(#[$meta])*
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        #[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
        pub struct $name {
            $($(#[$field_meta])* pub $field: $type,)*
            /// Keys this version does not know.
            #[serde(flatten)]
            pub extra: Extra,
        }
    )*};
}

/// The format's name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum ScanFormat {
    /// `refractive-scan`
    #[default]
    #[serde(rename = "refractive-scan")]
    RefractiveScan,
}

/// The unit of every length.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum LengthUnit {
    /// Millimetres.
    #[default]
    #[serde(rename = "mm")]
    Millimetre,
}

/// The lens model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum CameraModel {
    /// OpenCV's pinhole with radial and tangential distortion.
    #[default]
    Opencv,
}

/// The vessel's shape.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum VesselShape {
    /// A flat wall.
    #[default]
    Plane,
    /// A round jar.
    Cylinder,
    /// A bowl or flask.
    Sphere,
    /// Any smooth wall.
    Freeform,
    /// Whichever the measured points support.
    Auto,
}

/// What the beam enters behind the wall, view by view.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum InsideMedium {
    /// The vessel's liquid.
    #[default]
    Liquid,
    /// Air above the liquid: the medium outside.
    Air,
}

/// What moves from view to view.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum Motion {
    /// The manipulator carries the rig around the vessel: every view has `world_from_flange`.
    #[default]
    Rig,
    /// A turntable or a stage moves the vessel before the rig: every view has `flange_from_world`, and
    /// the world is the frame that moves with the vessel.
    Vessel,
}

impl Motion {
    /// Whether it is the one that goes without saying.
    fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

/// The kind of laser.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum LaserKind {
    /// A thin beam: needs `direction`.
    Spot,
    /// A sheet of light: needs `normal`.
    Line,
}

/// The kind of knowledge of the object.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum KnownKind {
    /// The angle between two planes: needs `degrees`.
    PlaneAngle,
    /// The distance between two parallel faces: needs `mm`.
    EdgeLength,
    /// A face that is flat.
    Flatness,
    /// The radius of a sphere or cylinder: needs `mm`.
    Radius,
}

const fn one() -> f64 {
    1.0
}

manifest! {
    /// A scan's manifest: `scan.json`.
    pub struct Manifest {
        /// `refractive-scan`.
        pub format: ScanFormat,
        /// The format's version: 1.
        pub version: u32,
        /// What the scan is of.
        #[serde(default)]
        pub name: String,
        /// `mm`.
        pub length_unit: LengthUnit,
        /// What moves from view to view.
        #[serde(default, skip_serializing_if = "Motion::is_default")]
        pub motion: Motion,
        /// The lens.
        pub camera: CameraEntry,
        /// The laser, in the camera frame.
        pub laser: LaserEntry,
        /// Hand-eye calibration.
        pub flange_from_camera: PoseEntry,
        /// One standard deviation of what calibration gave.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub calibration_sigma: Option<CalibrationSigmaEntry>,
        /// The vessel.
        pub vessel: VesselEntry,
        /// Refractive indices.
        pub media: MediaEntry,
        /// What is known of the object.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        pub known: Vec<KnownShape>,
        /// The stations.
        pub views: Vec<ViewEntry>,
    }

    /// A lens.
    pub struct CameraEntry {
        /// `opencv`.
        pub model: CameraModel,
        /// Picture width, px.
        pub width: u32,
        /// Picture height, px.
        pub height: u32,
        /// Focal length across, px.
        pub fx: f64,
        /// Focal length down, px.
        pub fy: f64,
        /// Principal point across, px.
        pub cx: f64,
        /// Principal point down, px.
        pub cy: f64,
        /// k1 k2 p1 p2 [k3 [k4 k5 k6]].
        #[serde(default)]
        pub distortion: Vec<f64>,
    }

    /// A laser, in the camera frame.
    pub struct LaserEntry {
        /// A thin beam or a sheet of light.
        pub kind: LaserKind,
        /// A point of the beam or the sheet, mm.
        pub origin: [f64; 3],
        /// Where a beam goes, any length but zero.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub direction: Option<[f64; 3]>,
        /// A sheet's normal, any length but zero.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub normal: Option<[f64; 3]>,
    }

    /// What is known of the object: a K_j of eq. (4).
    pub struct KnownShape {
        /// What it is.
        pub kind: KnownKind,
        /// The angle of a `plane_angle`, degrees.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub degrees: Option<f64>,
        /// The length of an `edge_length` or `radius`, mm.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub mm: Option<f64>,
        /// Alpha of eq. (4); 1 if left out.
        #[serde(default = "one")]
        pub weight: f64,
        /// One list of view ids a face; without it the faces are found.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub views: Option<Vec<Vec<String>>>,
    }

    /// A rigid motion.
    pub struct PoseEntry {
        /// Quaternion `[w, x, y, z]`.
        pub rotation: [f64; 4],
        /// Millimetres.
        pub translation: [f64; 3],
    }

    /// One standard deviation of what calibration gave; what is left out has a documented default.
    pub struct CalibrationSigmaEntry {
        /// mm; 0.3.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub laser_origin: Option<f64>,
        /// Degrees; 0.1.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub laser_direction: Option<f64>,
        /// px; 0.5.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub focal_length: Option<f64>,
        /// px; 0.5.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub principal_point: Option<f64>,
        /// Degrees; 0.1.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub hand_eye_rotation: Option<f64>,
        /// mm; 0.3.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub hand_eye_translation: Option<f64>,
    }

    /// The vessel.
    pub struct VesselEntry {
        /// Its wall's shape.
        pub shape: VesselShape,
        /// Millimetres.
        pub wall_thickness: f64,
        /// Where the wall is known beforehand: a point of a plane's outer face, world frame, mm.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub point: Option<[f64; 3]>,
        /// With `point`: the plane's normal towards the rig, any length but zero.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub normal: Option<[f64; 3]>,
        /// Where the wall is known beforehand: a point of a cylinder's axis, mm.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub axis_point: Option<[f64; 3]>,
        /// With `axis_point`: along the axis, any length but zero.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub axis: Option<[f64; 3]>,
        /// Where the wall is known beforehand: a sphere's middle, mm.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub center: Option<[f64; 3]>,
        /// With `axis_point` or `center`: the outer face's radius, mm.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub radius: Option<f64>,
        /// A second wall between the liquid and the object.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub far_wall: Option<FarWall>,
    }

    /// The wall behind the liquid, where the object stands behind the tank.
    pub struct FarWall {
        /// From inner face to inner face, mm.
        pub distance: f64,
        /// Millimetres.
        pub thickness: f64,
    }

    /// Refractive indices.
    pub struct MediaEntry {
        /// Around the rig.
        pub outside: f64,
        /// The wall.
        pub wall: f64,
        /// The liquid; `null` if nobody knows.
        // Named so that the key must be there: `null` is said, not forgotten.
        #[serde(deserialize_with = "Option::deserialize")]
        pub inside: Option<f64>,
    }

    /// A station: one pose, one picture with the laser on, one with it off.
    pub struct ViewEntry {
        /// Its name.
        pub id: String,
        /// The archive entry of the picture with the laser on.
        pub on: String,
        /// The archive entry of the picture with the laser off.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub off: Option<String>,
        /// The manipulator's pose, where `motion` is `rig`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub world_from_flange: Option<PoseEntry>,
        /// The vessel's pose in the frame of the rig's mount, where `motion` is `vessel`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub flange_from_world: Option<PoseEntry>,
        /// What the beam enters behind the wall.
        #[serde(default)]
        pub inside: InsideMedium,
    }
}
