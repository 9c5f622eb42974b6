//! Pictures made by hand: light on a sensor, then noise and rounding.

use snellius::camera::Pixel;
use snellius::scan::{Picture, PicturePair};

use super::Random;

/// Light on a sensor, grey values.
#[derive(Clone)]
pub struct Light {
    pub width: usize,
    pub grey: Vec<f64>,
}

impl Light {
    /// Light that falls on each pixel as `ambient(u, v)` says.
    pub fn of(width: usize, height: usize, ambient: impl Fn(f64, f64) -> f64) -> Self {
        let at = |i: usize| ambient((i % width) as f64, (i / width) as f64);
        Self {
            width,
            grey: (0..width * height).map(at).collect(),
        }
    }

    /// The same with a Gaussian spot: its peak in grey values, its standard deviation in pixels.
    pub fn with_spot(mut self, at: Pixel, peak: f64, sigma: f64) -> Self {
        for (i, grey) in self.grey.iter_mut().enumerate() {
            let (du, dv) = (
                (i % self.width) as f64 - at.u,
                (i / self.width) as f64 - at.v,
            );
            *grey += peak * (-0.5 * (du * du + dv * dv) / (sigma * sigma)).exp();
        }
        self
    }

    /// The same with so much more light everywhere.
    pub fn brighter(mut self, by: f64) -> Self {
        self.grey.iter_mut().for_each(|grey| *grey += by);
        self
    }

    /// Read out without noise, rounded to whole grey values.
    pub fn still(&self, full_scale: u16) -> Picture {
        self.read_out(full_scale, |grey| grey)
    }

    /// Read out with noise of variance read^2 + shot * grey value.
    pub fn noisy(&self, full_scale: u16, read: f64, shot: f64, random: &mut Random) -> Picture {
        self.read_out(full_scale, |grey| {
            grey + (read * read + shot * grey).sqrt() * random.normal()
        })
    }

    fn read_out(&self, full_scale: u16, mut sensor: impl FnMut(f64) -> f64) -> Picture {
        let top = f64::from(full_scale);
        let grey = self
            .grey
            .iter()
            .map(|g| sensor(*g).round().clamp(0.0, top) as u16);
        Picture {
            width: self.width,
            height: self.grey.len() / self.width,
            full_scale,
            grey: grey.collect(),
        }
    }
}

pub fn pair(on: Picture, off: Picture) -> PicturePair {
    PicturePair { on, off: Some(off) }
}
