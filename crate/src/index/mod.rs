//! The refractive index of the liquid: from the ray distance (eq. (3)), from the overlap of what several
//! attitudes see, from known shapes (eq. (4)), and from all of it together with what calibration may be
//! off by; and what a scan can tell of it at all (sections II-E and III-B of the paper).
//!
//! All methods are one: robust least squares over the index and everything else that is uncertain, with
//! priors from calibration. They differ in what part of the evidence counts.
//!
//! | evidence | residual |
//! |---|---|
//! | always | a vessel spot's distance from the epipolar line in air, and its point's from the wall |
//! | ray distance | the gap of the two refracted rays |
//! | overlap | an object point's distance from the face that it shares with others |
//! | known shape | an angle, an edge or a radius of these faces |

mod curve;
mod error;
mod estimate;
mod face;
mod given;
mod known;
mod last_bend;
mod look_up;
mod model;
mod observability;
mod remedy;
mod segment;
mod sights;
mod solve;
mod study;

pub use curve::{CurveMinimum, IndexCurve, IndexRange, PreparedSights};
pub use error::IndexError;
pub use estimate::{Correction, IndexEstimate, IndexMethod, Verdict};
pub use known::{KNOWN_TOLERANCE, Known};
pub use look_up::{LIQUIDS, Liquid};
pub use observability::{Blindness, Observability};
pub use remedy::Remedy;
pub use sights::{ObjectSight, Sights, VesselSight};
pub use study::{IndexStudy, KnownCurve, study};
