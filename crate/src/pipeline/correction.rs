use serde::{Deserialize, Serialize};

use crate::spots::{Spot, SpotRole, Spots};

/// What a person says of a spot, or of a part of a line.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Correction {
    /// Which view, in the manifest's order.
    pub view: usize,
    /// Where the spot is, px: its number changes with the settings, its place hardly does.
    pub pixel: [f64; 2],
    /// Of a line, every point that is no farther from there is meant, px. Of a beam's spots only the nearest
    /// is.
    #[serde(default = "near")]
    pub reach: f64,
    /// What it is.
    pub role: SpotRole,
}

/// A spot that is found with other settings lies no farther from where it was, px.
const NEAR: f64 = 3.0;

const fn near() -> f64 {
    NEAR
}

impl Correction {
    /// Of a beam's spot.
    pub const fn of_spot(view: usize, pixel: [f64; 2], role: SpotRole) -> Self {
        Self {
            view,
            pixel,
            reach: NEAR,
            role,
        }
    }

    fn distance(&self, spot: &Spot) -> f64 {
        let (du, dv) = (spot.u - self.pixel[0], spot.v - self.pixel[1]);
        (du * du + dv * dv).sqrt()
    }

    /// The spots of its view that are meant.
    fn meant(&self, view: &Spots) -> Vec<usize> {
        let distances = view.spots.iter().map(|spot| self.distance(spot));
        let within = distances
            .enumerate()
            .filter(|(_, distance)| *distance <= self.reach);
        if view.line.is_some() {
            return within.map(|(index, _)| index).collect();
        }
        let nearest = within.min_by(|a, b| a.1.total_cmp(&b.1));
        nearest.map(|(index, _)| index).into_iter().collect()
    }
}

/// Puts into the spots what a person says of them, and nothing that was said before; what is said last counts.
/// A correction whose spot is no longer found within a few pixels says nothing.
pub fn correct(spots: &mut [Spots], corrections: &[Correction]) {
    for view in spots.iter_mut() {
        view.said.clear();
    }
    for correction in corrections {
        let Some(view) = spots.get_mut(correction.view) else {
            continue;
        };
        let meant = correction.meant(view);
        view.said.retain(|(about, _)| !meant.contains(about));
        let said = meant.into_iter().map(|spot| (spot, correction.role));
        view.said.extend(said);
    }
}
