//! `result.json`: the public format of a reconstruction.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::index::{IndexMethod, Verdict};
use crate::json;
use crate::robust::sort_by_number;
use crate::scan::{InsideMedium, LengthUnit, VesselShape};
use crate::spots::SpotRole;

/// Generates a struct of the result: public, serialisable, with a schema.
macro_rules! result {
    ($($(#[$meta:meta])* pub struct $name:ident { $($(#[$field_meta:meta])* pub $field:ident: $type:ty,)* })*) => {$(
        $(#[$meta])*
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        #[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
        pub struct $name {
            $($(#[$field_meta])* pub $field: $type,)*
        }
    )*};
}

/// The format's name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum ReconstructionFormat {
    /// `refractive-reconstruction`
    #[default]
    #[serde(rename = "refractive-reconstruction")]
    RefractiveReconstruction,
}

/// What became of a view.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// It has an object point.
    Ok,
    /// No spot lies on the wall, and no object point was found.
    NoVesselSpot,
    /// There is no spot but the wall's.
    NoObjectSpot,
    /// There are spots, and all of them were refused.
    Rejected,
}

/// What a view gave: of a spot laser one value or none (`null`), of a line laser a list.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(untagged)]
pub enum OneOrMany<T> {
    /// Of a spot laser.
    One(Option<T>),
    /// Of a line laser.
    Many(Vec<T>),
}

impl<T> Default for OneOrMany<T> {
    fn default() -> Self {
        Self::One(None)
    }
}

impl<T> OneOrMany<T> {
    /// All of them, however many there are.
    pub fn as_slice(&self) -> &[T] {
        match self {
            Self::One(one) => one.as_slice(),
            Self::Many(many) => many,
        }
    }

    /// All of them in their order.
    pub fn iter(&self) -> std::slice::Iter<'_, T> {
        self.as_slice().iter()
    }
}

impl<T: Copy> OneOrMany<T> {
    /// The first, which is the only one of a spot laser.
    pub fn first(&self) -> Option<T> {
        self.as_slice().first().copied()
    }
}

/// The wall's outer face, in the world frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "shape", rename_all = "lowercase")]
pub enum WallResult {
    /// A flat wall.
    Plane {
        /// A point of it, mm.
        point: [f64; 3],
        /// Unit normal towards the rig.
        normal: [f64; 3],
    },
    /// A round wall.
    Cylinder {
        /// A point of the axis, mm.
        axis_point: [f64; 3],
        /// Along the axis, unit length.
        axis: [f64; 3],
        /// Millimetres.
        radius: f64,
    },
    /// A ball's wall.
    Sphere {
        /// Its middle, mm.
        center: [f64; 3],
        /// Millimetres.
        radius: f64,
    },
    /// Any smooth wall: a uniform bicubic B-spline of heights over a simple surface. Places on that are
    /// lengths from `origin`: along both tangents (plane); around the axis, which is the second tangent,
    /// and along it (cylinder); as longitude times radius and latitude times radius, with the second
    /// tangent towards the pole (sphere). The control point in column i and row j belongs to the place
    /// `start + ((i - 1) step[0], (j - 1) step[1])`.
    Freeform {
        /// What the heights stand on.
        base: BaseResult,
        /// Its radius, mm, if it is round.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        radius: Option<f64>,
        /// A point of it, mm.
        origin: [f64; 3],
        /// Its unit normal there, towards the rig.
        normal: [f64; 3],
        /// The unit vectors there that places are counted along.
        tangents: [[f64; 3]; 2],
        /// The grid's first place, mm.
        start: [f64; 2],
        /// The grid's spacing, mm.
        step: [f64; 2],
        /// Control points along the first tangent.
        columns: usize,
        /// Control points along the second tangent.
        rows: usize,
        /// Their heights, mm, row by row.
        heights: Vec<f64>,
        /// The corners of the measured patch; beyond it there is no wall.
        patch: Vec<[f64; 2]>,
    },
}

/// The simple surface that a free form's heights stand on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum BaseResult {
    /// Flat.
    Plane,
    /// Round about an axis.
    Cylinder,
    /// Round about a centre.
    Sphere,
}

result! {
    /// A reconstruction: `result.json`.
    pub struct ReconstructionResult {
        /// `refractive-reconstruction`.
        pub format: ReconstructionFormat,
        /// The format's version: 1.
        pub version: u32,
        /// The scan's name.
        pub scan: String,
        /// `mm`.
        pub length_unit: LengthUnit,
        /// Refractive indices.
        pub media: MediaResult,
        /// The vessel.
        pub vessel: VesselResult,
        /// The views, in the manifest's order.
        pub views: Vec<ViewResult>,
        /// What to know before trusting it.
        pub warnings: Vec<String>,
    }

    /// Refractive indices.
    pub struct MediaResult {
        /// Around the rig.
        pub outside: f64,
        /// The wall.
        pub wall: f64,
        /// The liquid.
        pub inside: InsideResult,
    }

    /// The liquid's refractive index.
    pub struct InsideResult {
        /// The index; `null` where the scan cannot tell.
        pub value: Option<f64>,
        /// One standard deviation; `null` where none is known.
        pub sigma: Option<f64>,
        /// Where it comes from.
        pub method: IndexMethod,
        /// What it is worth.
        pub verdict: Verdict,
        /// Within it the index lies 95 times in 100, where it was estimated; also where there is no value.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub interval: Option<[f64; 2]>,
        /// Why the scan cannot tell, and what would let it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub reason: Option<String>,
    }

    /// The vessel's wall.
    pub struct VesselResult {
        /// Shape and place of the outer face.
        #[serde(flatten)]
        pub wall: WallResult,
        /// Millimetres.
        pub wall_thickness: f64,
        /// Root mean square distance of the vessel points from the face, mm.
        pub rms: f64,
        /// How many vessel points carry it.
        pub points: usize,
        /// What the two glows of the wall say.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub glow: Option<GlowResult>,
        /// What `auto` decided between.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub choice: Option<ShapeChoiceResult>,
    }

    /// What the two glows of the wall say.
    pub struct GlowResult {
        /// The inner face's share of the light of a vessel spot.
        pub inner_share: f64,
        /// One standard deviation of it.
        pub inner_share_sigma: f64,
        /// The wall's thickness that the glows suggest by themselves, mm; `null` where they tell nothing.
        pub thickness: Option<f64>,
    }

    /// What `auto` decided between.
    pub struct ShapeChoiceResult {
        /// The shape that was chosen.
        pub chosen: VesselShape,
        /// The next best.
        pub runner_up: VesselShape,
        /// By how much the chosen one's information criterion is lower; above 10 the matter is settled.
        pub margin: f64,
    }

    /// A view.
    pub struct ViewResult {
        /// Its id in the manifest.
        pub id: String,
        /// The sweep (row of stations) it belongs to, from 0.
        #[serde(default)]
        pub sweep: u32,
        /// What became of it.
        pub status: Status,
        /// Why it has no object point.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub reason: Option<String>,
        /// What the beam enters behind the wall, by what was measured, where the manifest says otherwise.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub inside_proposed: Option<InsideMedium>,
        /// What the view was measured in, where a proposal was accepted.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub inside: Option<InsideMedium>,
        /// The point on the wall's outer face, world frame, mm.
        pub vessel: OneOrMany<[f64; 3]>,
        /// The point on the object, world frame, mm.
        pub object: OneOrMany<[f64; 3]>,
        /// One standard deviation along each axis, mm, from the pictures' noise and the wall's fit.
        pub object_sigma: OneOrMany<[f64; 3]>,
        /// What an error of calibration and of the index adds, common to all points, mm.
        pub object_sigma_calibration: OneOrMany<[f64; 3]>,
        /// l of Fig. 7, mm.
        pub ray_distance: OneOrMany<f64>,
        /// Where the point would lie if refraction were ignored (Fig. 11 b), world frame, mm; `null` where
        /// the straight rays do not meet.
        #[serde(default)]
        pub object_unrefracted: OneOrMany<Option<[f64; 3]>>,
        /// The spots that were found; of a line laser none, see `line`.
        pub spots: Vec<SpotResult>,
        /// Of a line laser: the points of its line in the picture.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub line: Option<LineResult>,
    }

    /// A line laser's line in the picture, px: one point a row or column.
    pub struct LineResult {
        /// Where the points of `vessel` are seen, in their order.
        pub vessel: Vec<[f64; 2]>,
        /// Where the points of `object` are seen, in their order.
        pub object: Vec<[f64; 2]>,
        /// Points that are neither.
        pub stray: Vec<[f64; 2]>,
        /// Why points are not the object's, and how many.
        pub refused: Vec<RefusedResult>,
    }

    /// Points that were refused alike.
    pub struct RefusedResult {
        /// Why.
        pub reason: String,
        /// How many points.
        pub points: usize,
    }

    /// A spot.
    pub struct SpotResult {
        /// Its centroid, px.
        pub pixel: [f64; 2],
        /// What it is.
        pub role: SpotRole,
        /// Why it is not the object's.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub reason: Option<String>,
    }
}

impl RefusedResult {
    /// Equal reasons counted, most frequent first.
    pub fn alike(reasons: impl Iterator<Item = String>) -> Vec<Self> {
        let mut counts = BTreeMap::new();
        for reason in reasons {
            *counts.entry(reason).or_insert(0) += 1;
        }
        let counted = counts.into_iter();
        let mut refused: Vec<_> = counted
            .map(|(reason, points)| Self { reason, points })
            .collect();
        sort_by_number(&mut refused, |refused| -(refused.points as f64));
        refused
    }
}

/// Why a file is no result.
#[derive(Debug, thiserror::Error)]
pub enum ResultError {
    /// It is no JSON, or not of this format.
    #[error("{place}: {problem}")]
    Format {
        /// Where in the file.
        place: String,
        /// What is wrong there.
        problem: String,
    },
    /// A later program wrote it.
    #[error("version: {0} is not known; this program reads version 1")]
    Version(u32),
}

impl ReconstructionResult {
    /// Reads `result.json`.
    pub fn from_json(bytes: &[u8]) -> Result<Self, ResultError> {
        let result: Self =
            json::read(bytes, "the result").map_err(|error| ResultError::Format {
                place: error.place,
                problem: error.problem.to_string(),
            })?;
        match result.version {
            1 => Ok(result),
            other => Err(ResultError::Version(other)),
        }
    }

    /// The file's bytes: JSON, indented, with a final line break.
    ///
    /// The same reconstruction gives the same bytes everywhere.
    pub fn to_json(&self) -> String {
        let mut json = serde_json::to_string_pretty(self)
            .expect("strings and numbers alone, with string keys, always serialise");
        json.push('\n');
        json
    }
}
