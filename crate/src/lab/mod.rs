//! The refraction lab: a bench on which one laser, one camera and one point behind a wall can be moved
//! about, with the light between them traced by the very core that measures.
//!
//! | module | what it is for |
//! |---|---|
//! | [`Bench`] | all that can be set, and nothing else |
//! | [`link`] | a bench as a short text for an address, and back |
//! | [`Light`] | both light paths face by face, and the point that they give |
//! | [`Sight`] | the eye, the vessel and the thing of the view through the wall |
//! | [`known_shape`] | an L-shaped object measured at any index, and how well that tells the index |
//! | [`LESSONS`] | short lessons, each with a bench to open |
//!
//! The bench's frame is that of a rig squarely before the wall: x to the right, y down, z into the
//! vessel, with z = 0 where the wall's outer face is nearest. Lengths are millimetres; the bench keeps
//! angles in degrees, as its controls and links do, and everything derived from it in radians.

mod bench;
pub mod known_shape;
mod lesson;
mod light;
pub mod link;
mod parameter;
mod sight;
mod substance;

pub use bench::{Bench, Thing, View, WallShape};
pub use lesson::{Answer, LESSONS, Lesson, Reply};
pub use light::{Bend, End, Light, LightPath, Measurement, NoMeasurement};
pub use parameter::{CHOICES, Choice, MEDIA, MediumRole, QUANTITIES, Quantity, quantity};
pub use sight::{Level, Sight};
pub use substance::{MYSTERIES, Medium, SUBSTANCES, Substance};
