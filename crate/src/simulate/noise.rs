use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

/// A seed of its own for each picture, so that pictures may be taken in any order.
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
