//! The lens model: from a point before the camera to its pixel, and back to a line of sight.
//!
//! A pixel `(0, 0)` is the centre of the top-left pixel. The model is OpenCV's: pinhole with radial
//! (k1..k6) and tangential (p1, p2) distortion.

mod distortion;
mod intrinsics;

pub use distortion::Distortion;
pub use intrinsics::{Intrinsics, OutsideLens, Pixel, Slope};
