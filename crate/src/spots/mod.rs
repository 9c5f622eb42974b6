//! From the pictures of a view to the laser's spots: difference, noise, threshold, regions, sub-pixel
//! centroids with their covariance (section II-B of the paper).
//!
//! The paper undistorts the difference picture and then takes centroids. Here the centroids are taken
//! in the picture as it is and undistorted afterwards: over a spot of a few pixels the lens is linear,
//! and nothing is lost by resampling.

mod difference;
mod grain;
mod line;
mod noise;
mod regions;

pub use difference::Difference;
pub use grain::Grain;
pub(crate) use grain::GrainSample;
pub use line::{Curve, Line, find_line};
pub use noise::Noise;
pub(crate) use regions::{ellipse_reach, moment_window};

use crate::robust::sort_by_number;
use nalgebra::{Matrix2, Vector2};
use serde::{Deserialize, Serialize};

use crate::camera::Pixel;
use crate::rig::Profiles;
use crate::scan::PicturePair;

/// How spots are found.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct SpotSettings {
    /// A spot's smoothed peak stands this many standard deviations of the noise above it.
    pub peak: f64,
    /// A spot's region ends where the smoothed difference falls below this many standard deviations.
    pub edge: f64,
    /// A region of fewer pixels is noise.
    pub smallest_area: usize,
    /// At most this many spots of a view, the brightest, are kept.
    pub most: usize,
}

impl Default for SpotSettings {
    fn default() -> Self {
        Self {
            peak: 9.0,
            edge: 4.0,
            smallest_area: 5,
            most: 64,
        }
    }
}

/// A bright region of the difference picture.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spot {
    /// Centroid across the picture, px.
    pub u: f64,
    /// Centroid down the picture, px.
    pub v: f64,
    /// Covariance of the centroid from the pictures' noise, px^2: uu, uv, vv.
    pub covariance: [f64; 3],
    /// Second central moments of the spot's light, px^2: uu, uv, vv.
    pub shape: [f64; 3],
    /// Third central moments, px^3: uuu, uuv, uvv, vvv.
    pub skew: [f64; 4],
    /// Sum of the difference over the region, grey values.
    pub brightness: f64,
    /// Largest difference, grey values.
    pub peak: f64,
    /// How many pixels.
    pub area: usize,
    /// Whether a pixel reached the top of the grey scale, so that the centroid may be off.
    pub saturated: bool,
}

impl Spot {
    /// The centroid.
    pub const fn pixel(&self) -> Pixel {
        Pixel::new(self.u, self.v)
    }

    /// The centroid's covariance, px^2.
    pub const fn covariance_matrix(&self) -> Matrix2<f64> {
        let [uu, uv, vv] = self.covariance;
        Matrix2::new(uu, uv, uv, vv)
    }

    /// What a unit of grain adds to the centroid's covariance, px^2 (see [`Grain`]).
    ///
    /// A point of a line has no extent along it: there the unit is the second moment across.
    pub fn grain_covariance(&self) -> Matrix2<f64> {
        let [uu, uv, vv] = self.shape;
        let determinant = uu * vv - uv * uv;
        let area = if determinant > 0.0 {
            determinant.sqrt()
        } else {
            1.0
        };
        Matrix2::new(uu, uv, uv, vv) / area
    }

    /// The centroid's covariance, px^2, with what the grain of laser light adds.
    pub fn covariance_with(&self, grain: f64) -> Matrix2<f64> {
        self.covariance_matrix() + self.grain_covariance() * grain
    }

    /// The variance of the place in a profile, px^2, with what the grain adds.
    pub fn variance_along(&self, profiles: Profiles, grain: f64) -> f64 {
        let covariance = self.covariance_with(grain);
        match profiles {
            Profiles::Rows => covariance.m11,
            Profiles::Columns => covariance.m22,
        }
    }

    /// The second moment of the spot's light along a unit vector, px^2.
    pub fn width_along(&self, axis: Vector2<f64>) -> f64 {
        let [uu, uv, vv] = self.shape;
        uu * axis.x * axis.x + 2.0 * uv * axis.x * axis.y + vv * axis.y * axis.y
    }

    /// The third moment of the spot's light along a unit vector, px^3.
    pub fn skew_along(&self, axis: Vector2<f64>) -> f64 {
        let [uuu, uuv, uvv, vvv] = self.skew;
        let (x, y) = (axis.x, axis.y);
        uuu * x * x * x + 3.0 * uuv * x * x * y + 3.0 * uvv * x * y * y + vvv * y * y * y
    }
}

/// What a spot is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum SpotRole {
    /// It lies on the wall's outer face.
    Vessel,
    /// It lies on the object.
    Object,
    /// Neither.
    Stray,
}

/// The spots of one view, or the points of its line.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Spots {
    /// Brightest first, if they are of a beam.
    pub spots: Vec<Spot>,
    /// What a person says that some of them are.
    #[serde(default)]
    pub said: Vec<(usize, SpotRole)>,
    /// Standard deviation of the difference picture's noise in its darker half, grey values.
    pub noise: f64,
    /// Of a sheet of light: how the spots make a line. They stand in its order then.
    #[serde(default)]
    pub line: Option<Line>,
}

impl Spots {
    /// What a person says that a spot is.
    pub fn said_of(&self, spot: usize) -> Option<SpotRole> {
        let said = self.said.iter().find(|(about, _)| *about == spot);
        said.map(|(_, role)| *role)
    }

    /// Whether a spot may be such a one: nobody says that it is another.
    pub fn may_be(&self, spot: usize, role: SpotRole) -> bool {
        self.said_of(spot).is_none_or(|said| said == role)
    }
}

/// Finds the spots of a view.
pub fn find_spots(pictures: &PicturePair, settings: &SpotSettings) -> Spots {
    let difference = Difference::of(pictures);
    let noise = Noise::of(&difference);
    let mut spots: Vec<Spot> = regions::regions(&difference, &noise, settings)
        .iter()
        .map(|region| regions::centroid(region, &difference, &noise))
        .collect();
    sort_by_number(&mut spots, |spot| -spot.brightness);
    spots.truncate(settings.most);
    Spots {
        spots,
        said: Vec::new(),
        noise: noise.typical(),
        line: None,
    }
}
