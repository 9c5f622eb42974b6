//! How light bends: Snell's law, surfaces that part two media, and light traced through a stack of
//! them.
//!
//! Indices of refraction are relative to vacuum at the laser's wavelength. Normals point towards the
//! rig, so that light from the rig meets every interface from its front.

mod aim;
mod base;
mod freeform;
mod media;
mod snell;
mod stack;
mod surface;

pub use aim::{AimError, aim_through};
pub use base::{Base, BaseShape};
pub use freeform::{Freeform, Grid, Sheet, convex_hull};
pub use media::Media;
pub use snell::{TotalReflection, refract};
pub use stack::{Interface, Path, Stack, TraceError, TraceProblem};
pub use surface::{Cylinder, Hit, Sphere, Surface};
