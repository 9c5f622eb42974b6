//! How one thing is drawn over another.

use three_d::{Blend, BlendEquationType, BlendMultiplierType};

/// As light is held back by what is not wholly clear. Opacity adds up likewise, so that a picture without a
/// ground is right over any: three-d's own way leaves it as clear as it was.
pub(super) const OVER: Blend = Blend::Enabled {
    source_rgb_multiplier: BlendMultiplierType::SrcAlpha,
    source_alpha_multiplier: BlendMultiplierType::One,
    destination_rgb_multiplier: BlendMultiplierType::OneMinusSrcAlpha,
    destination_alpha_multiplier: BlendMultiplierType::OneMinusSrcAlpha,
    rgb_equation: BlendEquationType::Add,
    alpha_equation: BlendEquationType::Add,
};
