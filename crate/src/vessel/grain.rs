//! How much the grain of laser light adds to the noise of a centroid.
//!
//! Coherent light on a rough surface is speckled, and a spot of N speckles has a centroid that is off by
//! about the spot's own width over the square root of N, however little noise the camera has. What
//! N is follows from lens and surface; the scan itself shows it, since the vessel's spots must lie on the
//! epipolar line: with s_i^2 the variance off the line that the camera's noise explains and m_i the
//! spot's second moment across the line,
//!
//! ```text
//! variance of the distance off the line = s_i^2 + g m_i,   g = 1/N
//! ```
//!
//! and g is taken from the spread of the distances about a straight line (a calibration error bends the
//! epipolar line to first order into another straight one).

use nalgebra::Vector2;

/// A vessel spot and its distance off the epipolar line.
#[derive(Clone, Copy, Debug)]
pub(super) struct OffLine {
    /// How far along the beam, mm.
    pub(super) along: f64,
    /// How far off the line, px.
    pub(super) off: f64,
    /// Variance of that from the camera's noise, px^2.
    pub(super) variance: f64,
    /// The spot's second moment across the line, px^2.
    pub(super) width: f64,
}

/// Estimates g; 0 for too few spots to tell.
pub(super) fn estimate(spots: &[OffLine]) -> f64 {
    const LEAST: usize = 8;
    if spots.len() < LEAST {
        return 0.0;
    }
    let mut kept: Vec<OffLine> = spots.to_vec();
    let mut grain = 0.0;
    // Stray spots that only look like the wall's are clipped away.
    for _ in 0..4 {
        let residual = straight_line(&kept);
        grain = excess(&kept, &residual);
        let all = spots.iter().filter(|s| {
            let sigma = (s.variance + grain * s.width).sqrt();
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

/// The g that makes the residuals' mean square what it is; never negative.
fn excess(spots: &[OffLine], residual: &impl Fn(&OffLine) -> f64) -> f64 {
    // Two degrees of freedom went into the line.
    let bias = spots.len() as f64 / (spots.len() as f64 - 2.0);
    let (mut over, mut width) = (0.0, 0.0);
    for s in spots {
        over += residual(s) * residual(s) * bias - s.variance;
        width += s.width;
    }
    (over / width).max(0.0)
}
