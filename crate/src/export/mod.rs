//! What leaves the program: the result file, point clouds, meshes, tables, a report.
//!
//! Every file is a pure function of the result ([`ReconstructionResult::write`]); every file says the
//! program's version, the unit, the frame and the liquid's index with what it is worth.

mod csv;
#[cfg(feature = "e57")]
mod e57;
mod figures;
mod format;
mod glb;
mod header;
#[cfg(feature = "las")]
mod las;
mod mesh;
mod obj;
mod pcd;
mod ply;
mod points;
mod report;
mod result;
mod stl;
mod wall;

#[cfg(feature = "e57")]
pub use self::e57::object_e57;
#[cfg(feature = "las")]
pub use self::las::object_las;
pub use crate::spots::SpotRole;
pub use csv::{object_csv, points_csv};
pub use figures::{IndexFigure, ResultFigure};
pub use format::{ExportError, Format};
pub use glb::scene_glb;
pub use mesh::{Mesh, object_mesh};
pub use obj::mesh_obj;
pub use pcd::object_pcd;
pub use ply::{object_ply, vessel_ply};
pub use report::{report_figures, report_html};
pub use result::{
    BaseResult, GlowResult, InsideResult, LineResult, MediaResult, OneOrMany, ReconstructionFormat,
    ReconstructionResult, RefusedResult, ResultError, ShapeChoiceResult, SpotResult, Status,
    VesselResult, ViewResult, WallResult,
};
pub use stl::mesh_stl;
