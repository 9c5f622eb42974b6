//! The vessel's wall: which spot lies on it, where that is in space, and what surface the points make
//! (sections II-C and III-A of the paper).

mod evidence;
mod find;
mod freeform;
mod glow;
mod grain;
mod line;
mod mesh;
mod pick;
mod refine;
mod shape;
mod start;
mod wall;

pub use evidence::{Alternative, Evidence, Told};
pub use find::{VesselError, VesselFit, VesselPoint, VesselSettings, find_vessel};
pub use glow::Glows;
pub use mesh::{MeshNode, WallMesh};
pub use shape::{ShapeChoice, fit_shape, refit_shape};
pub use wall::{FarWall, NoRoom, Wall};
