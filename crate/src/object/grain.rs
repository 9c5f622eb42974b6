//! The grain of laser light as the object's own spots show it.
//!
//! The wall's spots tell the grain on glass; the object's surface may be rougher. The ray distance of a
//! view is noise and what calibration does, and the latter hardly changes from one station to the next of
//! a sweep. So the differences of neighbours show the noise alone (J. von Neumann, 1941):
//!
//! ```text
//! variance of (gap_j - gap_i) = camera_i + camera_j + g (unit_i + unit_j)
//! ```

use super::Choice;

/// Two neighbouring views.
#[derive(Clone, Copy)]
struct Neighbours {
    /// Square of the difference of their gaps, mm^2.
    square: f64,
    /// What the camera's noise makes of it, mm^2.
    camera: f64,
    /// What one unit of grain adds, mm^2.
    unit: f64,
}

/// Estimates g from the chosen points; `sweep_of` gives each view's sweep. `None` for too few neighbours.
pub(super) fn estimate(choices: &[Choice], sweep_of: &[usize]) -> Option<f64> {
    const LEAST: usize = 8;
    const CLIP: f64 = 16.0;
    let all = neighbours(choices, sweep_of);
    let mut kept = all.clone();
    for _ in 0..4 {
        if kept.len() < LEAST {
            return None;
        }
        let grain = excess(&kept);
        // A wrong spot, or an edge of the object, would count for all others.
        let usual = |n: &Neighbours| n.square <= CLIP * (n.camera + grain * n.unit);
        kept = all.iter().copied().filter(usual).collect();
    }
    (kept.len() >= LEAST).then(|| excess(&kept))
}

fn excess(pairs: &[Neighbours]) -> f64 {
    let over: f64 = pairs.iter().map(|n| n.square - n.camera).sum();
    let unit: f64 = pairs.iter().map(|n| n.unit).sum();
    (over / unit).max(0.0)
}

fn neighbours(choices: &[Choice], sweep_of: &[usize]) -> Vec<Neighbours> {
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
        pairs.push(Neighbours {
            square: difference * difference,
            camera: here.noise.gap_camera + there.noise.gap_camera,
            unit: here.noise.gap_grain + there.noise.gap_grain,
        });
    }
    pairs
}
