use std::io::{BufRead, Seek};

use image::ImageReader;

/// Width and height of a picture, px, of which only the head is read; nothing if it is no picture.
pub fn picture_size(file: impl BufRead + Seek) -> Option<[u32; 2]> {
    let reader = ImageReader::new(file).with_guessed_format().ok()?;
    let (width, height) = reader.into_dimensions().ok()?;
    Some([width, height])
}
