//! A scan made of what somebody has: pictures, a calibration file, a list of poses, and answers to a few
//! [questions](QUESTIONS). A [`Draft`] says what is missing, and once nothing is, it gives a manifest
//! that passes the checks of an archive's own; a [`Packer`] lays out the archive around the pictures.

mod calibration;
mod draft;
mod error;
mod matching;
mod names;
mod packer;
mod pairs;
mod poses;
mod question;
mod size;
mod tree;
mod view_numbers;

pub use calibration::{Lens, read_calibration};
pub use draft::{Composed, Draft, Gap};
pub use error::ImportError;
pub use packer::{Packer, Piece};
pub use pairs::{Lack, Pair, Pairing, Unpaired, is_picture, pair};
pub use poses::{LengthScale, ListedPose, PoseList, Reading, read_poses};
pub use question::{Answers, Key, Part, QUESTIONS, Question, QuestionKind};
pub use size::picture_size;
pub use view_numbers::ViewNumbers;
