use serde::{Deserialize, Serialize};

use crate::spots::{SpotRole, Spots};

/// What a person says of a spot.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Correction {
    /// Which view, in the manifest's order.
    pub view: usize,
    /// Where the spot is, px: its number changes with the settings, its place hardly does.
    pub pixel: [f64; 2],
    /// What it is.
    pub role: SpotRole,
}

/// Puts into the spots of a beam what a person says of them, and nothing that was said before. A correction
/// whose spot is no longer found within a few pixels says nothing.
pub fn correct(spots: &mut [Spots], corrections: &[Correction]) {
    const REACH: f64 = 3.0;
    for view in spots.iter_mut() {
        view.said.clear();
    }
    for correction in corrections {
        let Some(view) = spots.get_mut(correction.view) else {
            continue;
        };
        let [u, v] = correction.pixel;
        let distance = |(index, spot): (usize, &crate::spots::Spot)| {
            let (du, dv) = (spot.u - u, spot.v - v);
            ((du * du + dv * dv).sqrt(), index)
        };
        let nearest = view.spots.iter().enumerate().map(distance);
        let nearest = nearest.min_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((_, spot)) = nearest.filter(|(distance, _)| *distance <= REACH) {
            view.said.retain(|(about, _)| *about != spot);
            view.said.push((spot, correction.role));
        }
    }
}
