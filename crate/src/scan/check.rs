//! Checks that several parts of a manifest share.

use super::{Place, ScanError};

/// Checks that a number is a length, a focal length or another thing that cannot be 0.
pub(super) fn positive(value: f64, place: &str) -> Result<(), ScanError> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(ScanError::value(
        Place::key(place),
        format!("{value}; it must be greater than 0"),
    ))
}
