use std::io::{BufRead, Seek};

use crate::scan::reader;

/// Width and height of a picture, px, of which only the head is read; nothing if it is no picture.
pub fn picture_size(mut file: impl BufRead + Seek) -> Option<[u32; 2]> {
    let (width, height) = reader(&mut file).ok()?.into_dimensions().ok()?;
    Some([width, height])
}
