//! The formats by name, for those who offer them.

use serde::{Deserialize, Serialize};

use super::{
    ReconstructionResult, mesh_obj, mesh_stl, object_csv, object_mesh, object_pcd, object_ply,
    points_csv, report_html, scene_glb, vessel_ply,
};

/// A file that a reconstruction can be written as.
///
/// To add one: give it a variant here, a line in each method below and a file of its own in this room.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Format {
    /// Everything: `result.json`.
    Json,
    /// The object's points as PLY.
    Ply,
    /// The vessel's points as PLY.
    VesselPly,
    /// A table of the views.
    Csv,
    /// A table of the object's points with a commented header.
    ObjectCsv,
    /// The object's points for the Point Cloud Library.
    Pcd,
    /// The object's points for surveying programs (ASPRS).
    #[cfg(feature = "las")]
    Las,
    /// The object's points for surveying programs (ASTM E2807).
    #[cfg(feature = "e57")]
    E57,
    /// Vessel and object as a 3-D scene (binary glTF).
    Glb,
    /// The object's surface between the scan lines.
    Stl,
    /// The object's surface between the scan lines.
    Obj,
    /// A page to print.
    Html,
}

/// Why a reconstruction cannot be written in a format.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// There is no surface.
    #[error(
        "the object's points make no surface: that takes neighbouring points on at least two \
         neighbouring scan lines; the point formats hold what was measured"
    )]
    NoSurface,
    /// LAS cannot hold it.
    #[cfg(feature = "las")]
    #[error("LAS: {0}")]
    Las(#[from] las::Error),
    /// E57 cannot hold it.
    #[cfg(feature = "e57")]
    #[error("E57: {0}")]
    E57(#[from] e57::Error),
}

impl Format {
    /// All of them.
    pub const ALL: &[Self] = &[
        Self::Json,
        Self::Ply,
        Self::VesselPly,
        Self::Csv,
        Self::ObjectCsv,
        Self::Pcd,
        #[cfg(feature = "las")]
        Self::Las,
        #[cfg(feature = "e57")]
        Self::E57,
        Self::Glb,
        Self::Stl,
        Self::Obj,
        Self::Html,
    ];

    /// Those that are written unless others are asked for.
    pub const USUAL: [Self; 4] = [Self::Json, Self::Ply, Self::VesselPly, Self::Csv];

    /// Its name, as the companion program takes it: `vessel-ply`.
    pub fn name(self) -> String {
        super::header::name_of(&self)
    }

    /// The name of the file.
    pub const fn file_name(self) -> &'static str {
        match self {
            Self::Json => "result.json",
            Self::Ply => "object.ply",
            Self::VesselPly => "vessel.ply",
            Self::Csv => "points.csv",
            Self::ObjectCsv => "object.csv",
            Self::Pcd => "object.pcd",
            #[cfg(feature = "las")]
            Self::Las => "object.las",
            #[cfg(feature = "e57")]
            Self::E57 => "object.e57",
            Self::Glb => "scene.glb",
            Self::Stl => "surface.stl",
            Self::Obj => "surface.obj",
            Self::Html => "report.html",
        }
    }

    /// The media type.
    pub const fn media_type(self) -> &'static str {
        match self {
            Self::Json => "application/json",
            Self::Csv | Self::ObjectCsv => "text/csv",
            Self::Glb => "model/gltf-binary",
            Self::Stl => "model/stl",
            Self::Obj => "model/obj",
            Self::Html => "text/html",
            _ => "application/octet-stream",
        }
    }
}

impl ReconstructionResult {
    /// The bytes of the file. The same reconstruction gives the same bytes everywhere.
    pub fn write(&self, format: Format) -> Result<Vec<u8>, ExportError> {
        let mesh = || object_mesh(self).ok_or(ExportError::NoSurface);
        Ok(match format {
            Format::Json => self.to_json().into_bytes(),
            Format::Ply => object_ply(self).into_bytes(),
            Format::VesselPly => vessel_ply(self).into_bytes(),
            Format::Csv => points_csv(self).into_bytes(),
            Format::ObjectCsv => object_csv(self).into_bytes(),
            Format::Pcd => object_pcd(self),
            #[cfg(feature = "las")]
            Format::Las => super::object_las(self)?,
            #[cfg(feature = "e57")]
            Format::E57 => super::object_e57(self)?,
            Format::Glb => scene_glb(self),
            Format::Stl => mesh_stl(self, &mesh()?),
            Format::Obj => mesh_obj(self, &mesh()?).into_bytes(),
            Format::Html => report_html(self).into_bytes(),
        })
    }
}
