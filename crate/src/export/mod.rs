//! What leaves the program: the result file, point clouds, tables.

mod csv;
mod ply;
mod result;

pub use csv::points_csv;
pub use ply::{object_ply, vessel_ply};
pub use result::{
    BaseResult, GlowResult, InsideResult, LineResult, MediaResult, OneOrMany, ReconstructionFormat,
    ReconstructionResult, RefusedResult, ShapeChoiceResult, SpotResult, SpotRole, Status,
    VesselResult, ViewResult, WallResult,
};
