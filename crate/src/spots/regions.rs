use nalgebra::{Matrix2, Vector2};

use super::{Difference, Noise, Spot, SpotSettings};

/// The pixels of a spot, as indices into the picture.
pub(super) type Region = Vec<usize>;

/// Binomial 3 x 3 smoothing, 1 2 1 / 2 4 2 / 1 2 1 over 16, turns white noise of standard deviation 1
/// into one of 6/16.
const SMOOTHED_NOISE: f64 = 6.0 / 16.0;

/// Finds the 8-connected regions in which the smoothed difference stands out of the noise.
///
/// Smoothing, the smallest area and what a spot has around its brightest pixel are the noise removal:
/// light through a lens spreads, a hot pixel does not. The threshold follows the noise at each pixel's own
/// brightness.
pub(super) fn regions(
    difference: &Difference,
    noise: &Noise,
    settings: &SpotSettings,
) -> Vec<Region> {
    let field = Field { difference, noise };
    let mut seen = vec![false; difference.len()];
    let mut found = Vec::new();
    for seed in field.candidates(settings.peak) {
        if seen[seed] || field.significance(seed) < settings.peak {
            continue;
        }
        let region = field.grow(seed, settings.edge, &mut seen);
        if region.len() >= settings.smallest_area && field.spreads(&region, settings.edge) {
            found.push(region);
        }
    }
    found
}

/// The centroid of a region with its covariance, and its brightness.
///
/// Weights are the differences above the background within an ellipse of three standard deviations of
/// the spot: a region's own edge follows the noise and would cut the flanks unevenly. With w_i the
/// differences, x_i the pixels, c their centroid and s_i^2 the noise's variance at each pixel,
///
/// ```text
/// c = sum w_i x_i / sum w_i,   cov c = sum s_i^2 (x_i - c)(x_i - c)^T / (sum w_i)^2
/// ```
pub(super) fn centroid(region: &Region, difference: &Difference, noise: &Noise) -> Spot {
    let field = Field { difference, noise };
    let around = field.widened(&field.widened(&field.widened(region)));
    let width = difference.width();
    let at = |i: usize| Vector2::new((i % width) as f64, (i / width) as f64);
    let weight = |i: usize| f64::from(difference.at(i)) - noise.offset();
    let light = around.iter().map(|i| (at(*i), weight(*i)));
    let middle = mean(region.iter().map(|i| (at(*i), weight(*i))));
    let (shape, skew) = higher_moments(light, middle);
    let inside = ellipse(middle, shape);
    let pixels: Vec<usize> = around.iter().copied().filter(|i| inside(at(*i))).collect();
    let centre = mean(pixels.iter().map(|i| (at(*i), weight(*i))));
    // The noise's mean over the ellipse is 0, so its total is that of the light.
    let total: f64 = pixels.iter().map(|i| weight(*i)).sum();
    let mut covariance = Matrix2::zeros();
    for i in &pixels {
        let lever = at(*i) - centre;
        covariance += lever * lever.transpose() * noise.variance(difference.level(*i));
    }
    covariance /= total * total;
    Spot {
        u: centre.x,
        v: centre.y,
        covariance: [covariance.m11, covariance.m12, covariance.m22],
        shape: [shape.m11, shape.m12, shape.m22],
        skew,
        brightness: total,
        peak: region.iter().map(|i| weight(*i)).fold(0.0, f64::max),
        area: region.len(),
        saturated: region.iter().any(|i| difference.saturated(*i)),
    }
}

/// The centroid of light.
fn mean(light: impl Iterator<Item = (Vector2<f64>, f64)>) -> Vector2<f64> {
    let (mut moment, mut total) = (Vector2::zeros(), 0.0);
    for (place, weight) in light {
        moment += place * weight;
        total += weight;
    }
    moment / total
}

/// How far the ellipse in which a centroid is taken reaches along an axis along which the light's second moment is
/// `width` (px^2): three standard deviations. A spot is never taken to be smaller than a pixel.
pub(crate) fn ellipse_reach(width: f64) -> f64 {
    REACH * (width + PIXEL).sqrt()
}

/// How many standard deviations of a spot its ellipse reaches.
const REACH: f64 = 3.0;
/// The least second moment that a spot is taken to have, px^2.
const PIXEL: f64 = 0.5;

/// Whether a place lies within the ellipse of a spot of the given second moments.
fn ellipse(centre: Vector2<f64>, shape: Matrix2<f64>) -> impl Fn(Vector2<f64>) -> bool {
    let metric = (shape + Matrix2::identity() * PIXEL).try_inverse();
    let metric = metric.unwrap_or_else(Matrix2::identity);
    move |place| {
        let d = place - centre;
        (d.transpose() * metric * d).x <= REACH * REACH
    }
}

/// Second and third central moments of the light: how wide and how lopsided a spot is.
///
/// Plain moments drown in the noise of the far pixels. So the light is weighted with a Gaussian window
/// of variance w^2, about twice as wide as the spot, and the window is taken out again as for a Gaussian
/// spot: S = M (1 - M / w^2)^-1 from the weighted second moments M; third moments grow by the third power
/// of the widening.
fn higher_moments(
    light: impl Iterator<Item = (Vector2<f64>, f64)> + Clone,
    centre: Vector2<f64>,
) -> (Matrix2<f64>, [f64; 4]) {
    let (plain, _) = windowed_moments(light.clone(), centre, f64::INFINITY);
    let window = moment_window(plain.trace());
    let (weighted, third) = windowed_moments(light, centre, window);
    let kept = Matrix2::identity() - weighted / window;
    let widened = kept
        .try_inverse()
        .filter(|_| kept.trace() > 0.5)
        .map(|inverse| weighted * inverse);
    let shape = widened.unwrap_or(weighted);
    let gain = shape.trace() / weighted.trace();
    (shape, third.map(|m| m * gain * gain * gain))
}

/// Variance of the window in which the higher moments of light are taken whose second ones add up to `trace`, px^2.
pub(crate) fn moment_window(trace: f64) -> f64 {
    const LEAST: f64 = 4.0;
    (2.0 * trace).max(LEAST)
}

/// Second and third central moments under a Gaussian window of variance `window`.
fn windowed_moments(
    light: impl Iterator<Item = (Vector2<f64>, f64)> + Clone,
    centre: Vector2<f64>,
    window: f64,
) -> (Matrix2<f64>, [f64; 4]) {
    let weighted = light.map(|(place, w)| {
        let from_centre = place - centre;
        (
            from_centre,
            w * libm::exp(-0.5 * from_centre.norm_squared() / window),
        )
    });
    let total: f64 = weighted.clone().map(|(_, w)| w).sum();
    let middle = weighted
        .clone()
        .fold(Vector2::zeros(), |sum, (x, w)| sum + x * w)
        / total;
    let (mut second, mut third) = (Matrix2::zeros(), [0.0; 4]);
    for (place, w) in weighted {
        let d = place - middle;
        second += d * d.transpose() * (w / total);
        let cubes = [
            d.x * d.x * d.x,
            d.x * d.x * d.y,
            d.x * d.y * d.y,
            d.y * d.y * d.y,
        ];
        third
            .iter_mut()
            .zip(cubes)
            .for_each(|(sum, m)| *sum += m * (w / total));
    }
    (second, third)
}

/// A difference picture with its noise.
struct Field<'a> {
    difference: &'a Difference<'a>,
    noise: &'a Noise,
}

impl Field<'_> {
    /// Pixels that may seed a region: those that stand out by themselves as far as a smoothed peak must.
    fn candidates(&self, peak: f64) -> Vec<usize> {
        let darkest = self.noise.variance(0.0).sqrt();
        let least = self.noise.offset() + peak * SMOOTHED_NOISE * darkest;
        self.difference.at_least(least.ceil() as i32)
    }

    /// The smoothed difference in standard deviations of its noise without laser light.
    fn significance(&self, i: usize) -> f64 {
        (self.smoothed(i) - self.noise.offset()) / (self.dark_sigma(i) * SMOOTHED_NOISE)
    }

    /// Whether there is light around the brightest pixel of a region, too: the smoothing without its
    /// middle, 1 2 1 / 2 0 2 / 1 2 1 over 16, has the noise sqrt(20)/16.
    fn spreads(&self, region: &Region, edge: f64) -> bool {
        let brightest = region.iter().max_by_key(|i| self.difference.at(**i));
        brightest.is_some_and(|&i| {
            let middle = f64::from(self.difference.at(i)) - self.noise.offset();
            let around = self.smoothed(i) - self.noise.offset() - 0.25 * middle;
            around >= edge * self.dark_sigma(i) * 20.0_f64.sqrt() / 16.0
        })
    }

    /// The difference smoothed 1 2 1 / 2 4 2 / 1 2 1 over 16; at the picture's border nothing stands out.
    fn smoothed(&self, i: usize) -> f64 {
        let (width, height) = (self.difference.width(), self.difference.height());
        let (x, y) = (i % width, i / width);
        if x == 0 || y == 0 || x + 1 == width || y + 1 == height {
            return self.noise.offset();
        }
        let d = |i: usize| self.difference.at(i);
        let row = |i: usize| d(i - 1) + 2 * d(i) + d(i + 1);
        f64::from(row(i - width) + 2 * row(i) + row(i + width)) / 16.0
    }

    /// Standard deviation of the difference at a pixel, without laser light. It follows the brightness
    /// around it, too: where a pixel is dark by its own noise, that would seem small, and the difference large.
    fn dark_sigma(&self, i: usize) -> f64 {
        let (dark, count) = self
            .neighbourhood(i)
            .map(|near| f64::from(self.difference.dark_level(near)))
            .fold((0.0, 0.0), |(sum, count), level| (sum + level, count + 1.0));
        self.noise.variance(dark / count).sqrt()
    }

    /// The 8-connected pixels around `seed` that stand `edge` deviations out.
    fn grow(&self, seed: usize, edge: f64, seen: &mut [bool]) -> Region {
        let mut region = vec![seed];
        seen[seed] = true;
        let mut next = 0;
        while let Some(&at) = region.get(next) {
            next += 1;
            for neighbour in self.neighbourhood(at) {
                if !seen[neighbour] && self.significance(neighbour) >= edge {
                    seen[neighbour] = true;
                    region.push(neighbour);
                }
            }
        }
        region
    }

    /// The region and one pixel around it, in picture order.
    fn widened(&self, region: &Region) -> Vec<usize> {
        let mut pixels: Vec<usize> = region.iter().flat_map(|i| self.neighbourhood(*i)).collect();
        pixels.sort_unstable();
        pixels.dedup();
        pixels
    }

    /// A pixel and the up to eight around it.
    fn neighbourhood(&self, i: usize) -> impl Iterator<Item = usize> + use<> {
        let (width, height) = (self.difference.width(), self.difference.height());
        let (x, y) = (i % width, i / width);
        let rows = y.saturating_sub(1)..(y + 2).min(height);
        let columns = x.saturating_sub(1)..(x + 2).min(width);
        rows.flat_map(move |row| columns.clone().map(move |column| row * width + column))
    }
}
