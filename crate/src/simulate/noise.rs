use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Gamma, StandardNormal};

use super::Scene;

/// A seed of its own for each picture, so that pictures may be taken in any order. Scenes whose seeds are neighbours
/// share most of them: scans that are to have nothing in common take seeds farther apart than they have pictures.
pub(super) fn seed(scene: u64, view: usize, lit: bool) -> u64 {
    // The odd factor of splitmix64 keeps neighbouring numbers apart.
    let picture = 2 * view as u64 + u64::from(lit);
    scene
        .wrapping_add(picture)
        .wrapping_mul(0x9E37_79B9_7F4A_7C15)
}

/// Normally distributed numbers.
pub(super) struct Normal(ChaCha8Rng);

impl Normal {
    pub(super) fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    pub(super) fn next(&mut self) -> f64 {
        self.0.sample(StandardNormal)
    }
}

/// The light of speckle's grains over its mean: Gamma distributed, as that of several independent patterns
/// that add up (J. Goodman, 1975).
pub(super) struct Grains {
    random: ChaCha8Rng,
    light: Option<Gamma<f64>>,
}

impl Grains {
    pub(super) fn of(scene: &Scene, view: usize) -> Self {
        // A stream of its own, so that noise and ghosts are those of the same scene without speckle.
        let mut random = ChaCha8Rng::seed_from_u64(seed(scene.seed, view, true));
        random.set_stream(2);
        let variance = scene.beam.speckle * scene.beam.speckle;
        Self {
            random,
            light: Gamma::new(1.0 / variance, variance).ok(),
        }
    }

    /// The next grain's, 1 where there is no speckle.
    pub(super) fn next(&mut self) -> f64 {
        self.light.map_or(1.0, |light| self.random.sample(light))
    }
}
