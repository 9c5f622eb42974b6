//! How much the grain of laser light adds to the noise of a centroid.
//!
//! Coherent light on a rough surface is speckled, and its grains are of one size in the picture, set by
//! the lens (J. Goodman, Speckle Phenomena in Optics, 2007). So the light of a spot with second moments S
//! comes in about sqrt(det S) / A grains, A being a grain's area, and however little noise the camera has,
//! its centroid has the covariance
//!
//! ```text
//! g S / sqrt(det S),   g = contrast^2 A / (8 pi) for a Gaussian spot
//! ```
//!
//! What g is follows from lens and surface; the scan itself shows it in whatever is zero but for noise:
//! the vessel's spots' distances off the epipolar line, and the object's ray distances. With c_i the variance
//! that the camera's noise explains and m_i what a unit of grain would add,
//!
//! ```text
//! variance of sample i = c_i + g m_i
//! ```

/// What is zero but for noise, squared, and where that comes from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GrainSample {
    pub(crate) square: f64,
    /// The variance from the camera's noise.
    pub(crate) camera: f64,
    /// The variance that a unit of grain would add.
    pub(crate) unit: f64,
}

/// The grain of the laser's light.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Grain {
    /// g, px^2.
    pub value: f64,
    /// One over the estimate's variance; 0 where nothing is known.
    pub information: f64,
}

impl Grain {
    /// The grain that makes the samples' mean square what it is; never negative.
    pub(crate) fn of(samples: &[GrainSample]) -> Self {
        let over: f64 = samples.iter().map(|s| s.square - s.camera).sum();
        let unit: f64 = samples.iter().map(|s| s.unit).sum();
        let value = (over / unit).max(0.0);
        let variance = samples.iter().map(|s| {
            let expected = s.camera + value * s.unit;
            2.0 * expected * expected
        });
        Self {
            value,
            information: unit * unit / variance.sum::<f64>(),
        }
    }

    /// What two independent estimates say together.
    pub(crate) fn and(&self, other: &Self) -> Self {
        let information = self.information + other.information;
        if information.is_nan() || information <= 0.0 {
            return *self;
        }
        let sum = self.value * self.information + other.value * other.information;
        Self {
            value: sum / information,
            information,
        }
    }
}
