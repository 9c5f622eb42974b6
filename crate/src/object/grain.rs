//! The grain of laser light (see [`crate::spots::Grain`]) as the object's own spots show it.
//!
//! The ray distance of a view is noise and what calibration does, and the latter hardly changes from one
//! station to the next of a sweep. So the differences of neighbours show the noise alone (J. von Neumann,
//! 1941):
//!
//! ```text
//! variance of (gap_j - gap_i) = camera_i + camera_j + g (unit_i + unit_j)
//! ```

use super::Choice;
use crate::spots::{Grain, GrainSample};

/// Estimates the grain from the chosen points; `sweep_of` gives each view's sweep. `None` for too few
/// neighbours.
pub(super) fn estimate(choices: &[Choice], sweep_of: &[usize]) -> Option<Grain> {
    const LEAST: usize = 8;
    /// Neighbouring differences share a view: they say two thirds of what as many samples of their own would.
    const OWN: f64 = 2.0 / 3.0;
    const CLIP: f64 = 16.0;
    let all = neighbours(choices, sweep_of);
    let mut kept = all.clone();
    for _ in 0..4 {
        if kept.len() < LEAST {
            return None;
        }
        let grain = Grain::of(&kept, OWN).value;
        // A wrong spot, or an edge of the object, would count for all others.
        let usual = |s: &GrainSample| s.square <= CLIP * (s.camera + grain * s.unit);
        kept = all.iter().copied().filter(usual).collect();
    }
    (kept.len() >= LEAST).then(|| Grain::of(&kept, OWN))
}

fn neighbours(choices: &[Choice], sweep_of: &[usize]) -> Vec<GrainSample> {
    let sweeps = sweep_of.iter().max().map_or(0, |last| last + 1);
    let mut before: Vec<Option<usize>> = vec![None; sweeps];
    let mut pairs = Vec::new();
    for (view, choice) in choices.iter().enumerate() {
        let last = before[sweep_of[view]].replace(view);
        let (Some(here), Some(last)) = (choice.points.first(), last) else {
            continue;
        };
        let Some(there) = choices[last].points.first() else {
            continue;
        };
        let difference = here.meeting.gap() - there.meeting.gap();
        pairs.push(GrainSample {
            square: difference * difference,
            camera: here.noise.gap_camera + there.noise.gap_camera,
            unit: here.noise.gap_grain + there.noise.gap_grain,
        });
    }
    pairs
}
