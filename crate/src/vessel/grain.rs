//! The grain of laser light (see [`crate::spots::Grain`]) as the vessel's spots show it: they must lie on the
//! epipolar line, or rather on a straight line, since a calibration error bends the epipolar line to first
//! order into another straight one.

use nalgebra::Vector2;

use crate::spots::{Grain, GrainSample};

/// A vessel spot and its distance off the epipolar line.
#[derive(Clone, Copy, Debug)]
pub(super) struct OffLine {
    /// How far along the beam, mm.
    pub(super) along: f64,
    /// How far off the line, px.
    pub(super) off: f64,
    /// Variance of that from the camera's noise, px^2.
    pub(super) variance: f64,
    /// What a unit of grain adds to it, px^2.
    pub(super) unit: f64,
}

/// Estimates the grain; none for too few spots to tell.
pub(super) fn estimate(spots: &[OffLine]) -> Grain {
    const LEAST: usize = 8;
    if spots.len() < LEAST {
        return Grain::default();
    }
    let mut kept: Vec<OffLine> = spots.to_vec();
    let mut grain = Grain::default();
    // Stray spots that only look like the wall's are clipped away.
    for _ in 0..4 {
        let residual = straight_line(&kept);
        grain = excess(&kept, &residual);
        let all = spots.iter().filter(|s| {
            let sigma = (s.variance + grain.value * s.unit).sqrt();
            residual(s).abs() <= 4.0 * sigma.max(1e-9)
        });
        let next: Vec<OffLine> = all.copied().collect();
        if next.len() < LEAST || next.len() == kept.len() {
            break;
        }
        kept = next;
    }
    grain
}

/// The distances' residuals about their straight line over the way along the beam.
fn straight_line(spots: &[OffLine]) -> impl Fn(&OffLine) -> f64 + use<> {
    let count = spots.len() as f64;
    let middle: Vector2<f64> = spots
        .iter()
        .map(|s| Vector2::new(s.along, s.off))
        .sum::<Vector2<f64>>()
        / count;
    let (mut spread, mut together) = (1e-12, 0.0);
    for s in spots {
        spread += (s.along - middle.x) * (s.along - middle.x);
        together += (s.along - middle.x) * (s.off - middle.y);
    }
    let slope = together / spread;
    move |s: &OffLine| s.off - middle.y - slope * (s.along - middle.x)
}

/// The grain that makes the residuals' mean square what it is.
fn excess(spots: &[OffLine], residual: &impl Fn(&OffLine) -> f64) -> Grain {
    // Two degrees of freedom went into the line.
    let bias = spots.len() as f64 / (spots.len() as f64 - 2.0);
    let sample = |s: &OffLine| GrainSample {
        square: residual(s) * residual(s) * bias,
        camera: s.variance,
        unit: s.unit,
    };
    Grain::of(&spots.iter().map(sample).collect::<Vec<_>>(), 1.0)
}
