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

/// The grain of the laser's light, as some samples show it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Grain {
    /// g, px^2.
    pub value: f64,
    shown_by: Samples,
}

/// What the samples weigh: sums over c and m.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Samples {
    m: f64,
    mm: f64,
    cm: f64,
    cc: f64,
    /// The part of them that no other sample shares.
    own: f64,
}

impl Samples {
    /// One over the variance of their estimate, if the grain is g: a square scatters by sqrt(2) of its mean.
    fn information(&self, g: f64) -> f64 {
        let variance = 2.0 * (self.cc + 2.0 * g * self.cm + g * g * self.mm);
        match variance > 0.0 {
            true => self.own * self.m * self.m / variance,
            false => 0.0,
        }
    }
}

impl Grain {
    /// The grain that makes the samples' mean square what it is; never negative. `own` is the part of the
    /// samples that is independent: less than 1 where one spot is in several.
    pub(crate) fn of(samples: &[GrainSample], own: f64) -> Self {
        let sum = |of: fn(&GrainSample) -> f64| -> f64 { samples.iter().map(of).sum() };
        let m = sum(|s| s.unit);
        Self {
            value: (sum(|s| s.square - s.camera) / m).max(0.0),
            shown_by: Samples {
                m,
                mm: sum(|s| s.unit * s.unit),
                cm: sum(|s| s.camera * s.unit),
                cc: sum(|s| s.camera * s.camera),
                own,
            },
        }
    }

    /// A grain that is found otherwise, and weighs nothing beside others.
    pub(crate) fn alone(value: f64) -> Self {
        Self {
            value,
            shown_by: Samples::default(),
        }
    }

    /// The mean of what g may be after two independent estimates, px^2.
    ///
    /// That is more than its likeliest value, for few samples say more often that a variance is small than
    /// that it is large: with n of them the mean is n / (n - 2) as large (the scaled inverse chi-squared
    /// distribution). Where the samples hardly show a grain there may be none, and nothing is added.
    pub(crate) fn expected_with(&self, other: &Self) -> f64 {
        let both = [self, other];
        let mut g = f64::midpoint(self.value, other.value);
        let mut information = 0.0;
        // What an estimate weighs depends on g, not on what it happened to find: small ones would else
        // seem the better ones.
        for _ in 0..8 {
            let weights = both.map(|grain| grain.shown_by.information(g));
            information = weights.iter().sum();
            if information <= 0.0 {
                return self.value;
            }
            let sum: f64 = both.iter().zip(weights).map(|(g, w)| w * g.value).sum();
            g = sum / information;
        }
        let variance = 1.0 / information;
        g + variance * g / (g * g + variance)
    }
}
