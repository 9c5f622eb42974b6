//! Snellius measures objects in 3-D through glass and liquid with a laser range finder.
//!
//! A camera and a laser, fixed to each other on a manipulator, look into a vessel from outside. From
//! pictures with the laser on and off, [`spots`] finds the laser's spots, [`vessel`] the wall they lie
//! on, and [`object`] the points of the object behind it, with the light bent at every face as
//! [`optics`] says. [`pipeline`] puts the stages in order; [`scan`] reads what they need, [`export`]
//! writes what they found.
//!
//! The method is that of A. Yamashita et al., *3-D Measurement of Objects in Unknown Aquatic
//! Environments with a Laser Range Finder* ("the paper" in these pages).
//!
//! The core does no input or output beyond the `Read + Seek` handed to it, starts no threads and uses
//! no platform mathematics: the same scan gives the same bytes on every machine and in every browser.

pub mod camera;
#[cfg(feature = "cli")]
pub mod cli;
pub mod compose;
pub mod export;
pub mod geometry;
pub mod index;
mod json;
pub mod lab;
pub mod measure;
pub mod object;
pub mod optics;
pub mod pipeline;
pub mod plot;
pub mod rig;
mod robust;
pub mod scan;
pub mod share;
#[cfg(feature = "simulate")]
pub mod simulate;
pub mod spots;
pub mod table;
mod text;
pub mod vessel;

/// The version of the program.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");
