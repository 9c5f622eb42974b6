//! The vessel's wall: which spot lies on it, where that is in space, and what surface the points make
//! (sections II-C and III-A of the paper).

mod fit;
mod pick;
mod wall;

pub use fit::{VesselError, VesselFit, VesselPoint, VesselSettings, find_vessel};
pub use wall::Wall;
