//! What an estimate of the index is worth.

use serde::{Deserialize, Serialize};

use super::model::Unknown;

/// Where the liquid's index comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum IndexMethod {
    /// The manifest or the user said it.
    Given,
    /// The two rays of each view meet: eq. (3).
    RayDistance,
    /// What several attitudes see of one face coincides.
    Overlap,
    /// The object's known shape comes out: eq. (4).
    KnownShape,
    /// All of these together.
    Joint,
}

impl IndexMethod {
    /// Its name in files and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Given => "given",
            Self::RayDistance => "ray-distance",
            Self::Overlap => "overlap",
            Self::KnownShape => "known-shape",
            Self::Joint => "joint",
        }
    }
}

/// What the index is worth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The manifest or the user said it.
    Given,
    /// To +-0.02 or better, 95 times in 100.
    Determined,
    /// To +-0.05 or better, 95 times in 100.
    Weak,
    /// The scan cannot tell.
    NotDetermined,
}

impl Verdict {
    /// Its name in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Given => "given",
            Self::Determined => "determined",
            Self::Weak => "weak",
            Self::NotDetermined => "not-determined",
        }
    }

    pub(super) fn of_sigma(sigma: f64) -> Self {
        let half_interval = NORMAL_95 * sigma;
        if half_interval <= 0.02 {
            Self::Determined
        } else if half_interval <= WIDEST {
            Self::Weak
        } else {
            Self::NotDetermined
        }
    }
}

/// An interval that reaches farther than this to either side determines nothing.
pub(super) const WIDEST: f64 = 0.05;

/// A normal error lies within this many standard deviations 95 times in 100.
pub(super) const NORMAL_95: f64 = 1.959_964;

/// One method's estimate of the index.
#[derive(Clone, Debug, PartialEq)]
pub struct IndexEstimate {
    /// The method.
    pub method: IndexMethod,
    /// What it is worth.
    pub verdict: Verdict,
    /// The index; `None` where the scan cannot tell.
    pub value: Option<f64>,
    /// One standard deviation: the first of the two below, or the larger where they disagree by more than
    /// chance.
    pub sigma: f64,
    /// One standard deviation from the pictures' noise and calibration, by propagation.
    pub sampling_sigma: f64,
    /// One standard deviation as the scan's rows disagree when they are left out in turn.
    pub model_sigma: Option<f64>,
    /// The least standard deviation that any unbiased estimator of this method can reach on this scan with
    /// the centroids' noise and calibration as they are (C. R. Rao, 1945; H. Cramer, 1946).
    pub floor: f64,
    /// Within it the index lies 95 times in 100, also where there is no value.
    pub interval: [f64; 2],
    /// Why it is not determined.
    pub reason: Option<String>,
    /// What the unknowns came to.
    pub corrections: Vec<Correction>,
}

/// What an unknown of the joint estimate came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correction {
    /// Which.
    pub unknown: Unknown,
    /// By how much it was moved, in its own unit.
    pub by: f64,
    /// Its standard deviation beforehand.
    pub prior_sigma: f64,
    /// Its standard deviation afterwards.
    pub sigma: f64,
}

impl Correction {
    /// Whether the scan says more of it than calibration did; otherwise only the prior holds it.
    pub fn moved_by_data(&self) -> bool {
        self.sigma < 0.8 * self.prior_sigma
    }
}
