use std::borrow::Cow;
use std::ops::Range;

use crate::scan::{Picture, PicturePair};

/// The laser's light alone: on minus off, pixel by pixel, row by row from the top left.
///
/// It is computed where it is asked for: a picture of millions of pixels holds a handful of spots.
#[derive(Clone, Debug)]
pub struct Difference<'a> {
    on: &'a Picture,
    off: Cow<'a, [u16]>,
    /// Whether the off picture was taken, and has noise of its own.
    pair: bool,
}

impl<'a> Difference<'a> {
    /// The difference of a view's pictures. Where no off picture was taken the on picture's own smooth
    /// background stands in for it, which leaves the scene's edges behind.
    ///
    /// # Panics
    ///
    /// If the two pictures differ in size; pictures decoded against one camera never do.
    pub fn of(pictures: &'a PicturePair) -> Self {
        let on = &pictures.on;
        let off = match &pictures.off {
            Some(off) => Cow::Borrowed(off.grey.as_slice()),
            None => Cow::Owned(smooth_background(on)),
        };
        assert_eq!(on.grey.len(), off.len(), "pictures of one camera");
        Self {
            on,
            off,
            pair: pictures.off.is_some(),
        }
    }

    /// Width, px.
    pub const fn width(&self) -> usize {
        self.on.width
    }

    /// Height, px.
    pub const fn height(&self) -> usize {
        self.on.height
    }

    /// How many pixels.
    pub fn len(&self) -> usize {
        self.off.len()
    }

    /// Whether there are no pixels.
    pub fn is_empty(&self) -> bool {
        self.off.is_empty()
    }

    /// The difference at a pixel, grey values.
    #[inline]
    pub fn at(&self, pixel: usize) -> i32 {
        i32::from(self.on.grey[pixel]) - i32::from(self.off[pixel])
    }

    /// The grey value without laser light.
    #[inline]
    pub fn dark_level(&self, pixel: usize) -> u16 {
        self.off[pixel]
    }

    /// The mean grey value of the pictures that went into the difference.
    #[inline]
    pub fn level(&self, pixel: usize) -> f64 {
        let on = f64::from(self.on.grey[pixel]);
        if self.pair {
            0.5 * (on + f64::from(self.off[pixel]))
        } else {
            on
        }
    }

    /// Whether the laser-on picture reached the top of the grey scale.
    #[inline]
    pub fn saturated(&self, pixel: usize) -> bool {
        self.on.grey[pixel] == self.on.full_scale
    }

    /// The largest grey value.
    pub const fn full_scale(&self) -> u16 {
        self.on.full_scale
    }

    /// The pixels whose difference is at least `least` (and above 0), in picture order.
    pub fn at_least(&self, least: i32) -> Vec<usize> {
        /// Runs that fit into a few vector registers: most hold no bright pixel and are passed at once.
        const RUN: usize = 64;
        let least = u16::try_from(least.max(1)).unwrap_or(u16::MAX);
        let mut bright = Vec::new();
        let runs = self.on.grey.chunks(RUN).zip(self.off.chunks(RUN));
        for (run, (on, off)) in runs.enumerate() {
            let rise = |(on, off): (&u16, &u16)| on.saturating_sub(*off);
            let highest = on.iter().zip(off).map(rise).fold(0, u16::max);
            if highest >= least {
                let rises = on.iter().zip(off).map(rise).enumerate();
                bright.extend(
                    rises
                        .filter(|(_, r)| *r >= least)
                        .map(|(i, _)| run * RUN + i),
                );
            }
        }
        bright
    }

    /// The whole difference picture.
    pub fn to_vec(&self) -> Vec<i32> {
        (0..self.len()).map(|pixel| self.at(pixel)).collect()
    }
}

/// Blocks of this many pixels: much larger than a spot, smaller than the shading of a scene.
const BLOCK: usize = 32;

/// The medians of blocks of equal size, interpolated between their centres and carried on to the borders.
fn smooth_background(picture: &Picture) -> Vec<u16> {
    let (across, down) = (
        (picture.width / BLOCK).max(1),
        (picture.height / BLOCK).max(1),
    );
    let mut medians = Vec::with_capacity(across * down);
    let edge = |block: usize, blocks: usize, size: usize| block * size / blocks;
    for row in 0..down {
        let rows = edge(row, down, picture.height)..edge(row + 1, down, picture.height);
        for column in 0..across {
            let columns =
                edge(column, across, picture.width)..edge(column + 1, across, picture.width);
            medians.push(block_median(picture, columns, rows.clone()));
        }
    }
    let block_of = |at: usize, blocks: usize, size: usize| {
        let position = (at as f64 + 0.5) * blocks as f64 / size as f64 - 0.5;
        let first = (position.max(0.0) as usize).min(blocks.saturating_sub(2));
        (first, (first + 1).min(blocks - 1), position - first as f64)
    };
    let mut background = Vec::with_capacity(picture.grey.len());
    for y in 0..picture.height {
        let (top, bottom, fy) = block_of(y, down, picture.height);
        for x in 0..picture.width {
            let (left, right, fx) = block_of(x, across, picture.width);
            let row = |r: usize| {
                medians[r * across + left] * (1.0 - fx) + medians[r * across + right] * fx
            };
            let value = row(top) * (1.0 - fy) + row(bottom) * fy;
            background.push((value + 0.5) as u16);
        }
    }
    background
}

fn block_median(picture: &Picture, columns: Range<usize>, rows: Range<usize>) -> f64 {
    let mut values = Vec::with_capacity(columns.len() * rows.len());
    for y in rows {
        let row = &picture.grey[y * picture.width..];
        values.extend_from_slice(&row[columns.clone()]);
    }
    let middle = values.len() / 2;
    f64::from(*values.select_nth_unstable(middle).1)
}
