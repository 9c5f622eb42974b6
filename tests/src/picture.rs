//! Screenshots, and what can be said of them without looking.

use std::collections::HashSet;

use anyhow::{Context, Result};
use image::{Rgb, RgbImage};

/// Least difference between a pixel's strongest and weakest channel for it to count as coloured.
const CHROMA: u8 = 40;

/// Least difference of a channel for two pixels to count as different.
const CHANGE: u8 = 12;

/// A decoded screenshot.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture(RgbImage);

impl Picture {
    /// Decodes a PNG file.
    pub fn from_png(bytes: &[u8]) -> Result<Self> {
        let decoded = image::load_from_memory_with_format(bytes, image::ImageFormat::Png);
        Ok(Self(decoded.context("no PNG")?.into_rgb8()))
    }

    /// Width and height in pixels.
    pub fn size(&self) -> (u32, u32) {
        self.0.dimensions()
    }

    /// One pixel's red, green and blue.
    pub fn pixel(&self, x: u32, y: u32) -> [u8; 3] {
        self.0.get_pixel(x, y).0
    }

    /// A part of the picture; what reaches beyond it is left out.
    pub fn region(&self, x: u32, y: u32, width: u32, height: u32) -> Self {
        Self(image::imageops::crop_imm(&self.0, x, y, width, height).to_image())
    }

    /// How many pixels are neither white, black nor grey.
    pub fn coloured_pixels(&self) -> usize {
        self.0.pixels().filter(|pixel| is_coloured(pixel)).count()
    }

    /// How many different colours those pixels have; neighbouring shades count as one.
    pub fn distinct_colours(&self) -> usize {
        let shades = self.0.pixels().filter(|pixel| is_coloured(pixel));
        let shades: HashSet<_> = shades
            .map(|pixel| pixel.0.map(|channel| channel / 32))
            .collect();
        shades.len()
    }

    /// Whether all pixels look the same, as on a canvas that nothing was drawn on.
    pub fn is_blank(&self) -> bool {
        let first = self.0.get_pixel(0, 0);
        !self.0.pixels().any(|pixel| differ(pixel, first))
    }

    /// The share of pixels that differ from another picture of the same size.
    pub fn changed_from(&self, other: &Self) -> f64 {
        assert_eq!(
            self.size(),
            other.size(),
            "pictures of one size are compared"
        );
        let pairs = self.0.pixels().zip(other.0.pixels());
        let changed = pairs.filter(|(a, b)| differ(a, b)).count();
        changed as f64 / f64::from(self.0.width() * self.0.height())
    }

    /// The mean of all channels of all pixels, 0 black to 255 white.
    pub fn brightness(&self) -> f64 {
        let sum: f64 = self
            .0
            .as_raw()
            .iter()
            .map(|&channel| f64::from(channel))
            .sum();
        sum / self.0.as_raw().len() as f64
    }
}

fn is_coloured(Rgb(channels): &Rgb<u8>) -> bool {
    let [r, g, b] = *channels;
    r.max(g).max(b) - r.min(g).min(b) >= CHROMA
}

fn differ(Rgb(a): &Rgb<u8>, Rgb(b): &Rgb<u8>) -> bool {
    a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) >= CHANGE)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(pixels: &[[u8; 3]]) -> Picture {
        let raw = pixels.concat();
        Picture(RgbImage::from_raw(pixels.len() as u32, 1, raw).unwrap())
    }

    #[test]
    fn grey_is_no_colour_and_shades_are_one() {
        let picture = picture(&[
            [128; 3],
            [255; 3],
            [200, 10, 10],
            [201, 9, 12],
            [10, 10, 200],
        ]);
        assert_eq!(picture.coloured_pixels(), 3);
        assert_eq!(picture.distinct_colours(), 2);
    }

    #[test]
    fn a_change_is_a_share_of_all_pixels() {
        let before = picture(&[[0; 3], [0; 3], [0; 3], [0; 3]]);
        let after = picture(&[[0; 3], [3; 3], [255, 0, 0], [0; 3]]);
        assert_eq!(after.changed_from(&before), 0.25);
        assert_eq!(before.changed_from(&before), 0.0);
    }

    #[test]
    fn one_other_pixel_makes_a_picture_of_a_blank() {
        assert!(picture(&[[9; 3], [10; 3], [9; 3]]).is_blank());
        assert!(!picture(&[[9; 3], [9; 3], [90; 3]]).is_blank());
    }

    #[test]
    fn brightness_runs_from_black_to_white() {
        assert_eq!(picture(&[[0; 3], [255; 3]]).brightness(), 127.5);
    }
}
