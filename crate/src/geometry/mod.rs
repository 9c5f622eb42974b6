//! Points, rays and poses whose frames the compiler keeps apart, the closest approach of two
//! lines, and planes fitted to points.
//!
//! Every frame is right-handed and every length is in millimetres.

mod approach;
mod fit;
mod frame;
mod plane;
mod pose;
mod ray;

pub use approach::{Approach, ParallelRays, closest_approach};
pub(crate) use fit::spread_out;
pub use fit::{FitError, PlaneFit, WeightedPoint, fit_plane};
pub use frame::{Camera, Direction, Flange, Frame, Point, World, ZeroLength};
pub(crate) use frame::{length, unit};
pub use plane::Plane;
pub use pose::Pose;
pub use ray::Ray;
