use crate::scan::{Picture, PicturePair};

/// The laser's light alone: on minus off, grey values.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// Width, px.
    pub width: usize,
    /// Height, px.
    pub height: usize,
    /// Row by row from the top left.
    pub grey: Vec<i32>,
}

/// Subtracts the laser-off picture from the laser-on picture. Where none was taken the on picture's own
/// smooth background stands in for it, which leaves the scene's edges behind.
///
/// # Panics
///
/// If the two pictures differ in size; pictures decoded against one camera never do.
pub fn difference(pictures: &PicturePair) -> Difference {
    let on = &pictures.on;
    let background;
    let off = match &pictures.off {
        Some(off) => &off.grey,
        None => {
            background = smooth_background(on);
            &background
        }
    };
    assert_eq!(on.grey.len(), off.len(), "pictures of one camera");
    let subtract = |(on, off): (&u16, &u16)| i32::from(*on) - i32::from(*off);
    Difference {
        width: on.width,
        height: on.height,
        grey: on.grey.iter().zip(off).map(subtract).collect(),
    }
}

/// Blocks of this many pixels: much larger than a spot, smaller than the shading of a scene.
const BLOCK: usize = 32;

/// The medians of blocks, interpolated between their centres.
fn smooth_background(picture: &Picture) -> Vec<u16> {
    let (across, down) = (
        picture.width.div_ceil(BLOCK),
        picture.height.div_ceil(BLOCK),
    );
    let mut medians = Vec::with_capacity(across * down);
    for row in 0..down {
        for column in 0..across {
            medians.push(block_median(picture, column * BLOCK, row * BLOCK));
        }
    }
    let block_of = |at: usize, blocks: usize| {
        let position = (at as f64 + 0.5) / BLOCK as f64 - 0.5;
        let low = position.max(0.0).min((blocks - 1) as f64);
        let first = low as usize;
        (first, (first + 1).min(blocks - 1), low - first as f64)
    };
    let mut background = Vec::with_capacity(picture.grey.len());
    for y in 0..picture.height {
        let (top, bottom, fy) = block_of(y, down);
        for x in 0..picture.width {
            let (left, right, fx) = block_of(x, across);
            let row = |r: usize| {
                medians[r * across + left] * (1.0 - fx) + medians[r * across + right] * fx
            };
            let value = row(top) * (1.0 - fy) + row(bottom) * fy;
            background.push((value + 0.5) as u16);
        }
    }
    background
}

fn block_median(picture: &Picture, left: usize, top: usize) -> f64 {
    let right = (left + BLOCK).min(picture.width);
    let mut values = Vec::with_capacity(BLOCK * BLOCK);
    for y in top..(top + BLOCK).min(picture.height) {
        values
            .extend_from_slice(&picture.grey[y * picture.width + left..y * picture.width + right]);
    }
    let middle = values.len() / 2;
    f64::from(*values.select_nth_unstable(middle).1)
}
