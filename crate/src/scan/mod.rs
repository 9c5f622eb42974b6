//! What a scan is: its manifest, the archive that holds it, the pictures of its views.

mod append;
mod archive;
mod check;
mod error;
mod known_wall;
mod manifest;
mod picture;
mod sweeps;
mod validate;
mod write;

pub use append::Tail;
pub use archive::{Archive, MANIFEST_NAME};
pub use error::{Place, ScanError};
pub use manifest::{
    CalibrationSigmaEntry, CameraEntry, CameraModel, Extra, FarWall, InsideMedium, KnownKind,
    KnownShape, LaserEntry, LaserKind, LengthUnit, Manifest, MediaEntry, Motion, PoseEntry,
    ScanFormat, VesselEntry, VesselShape, ViewEntry,
};
pub(crate) use picture::reader;
pub use picture::{Limits, Picture, PicturePair};
pub use sweeps::sweeps;
pub use validate::{Scan, Station};
pub use write::{ArchiveWriter, WriteError};
