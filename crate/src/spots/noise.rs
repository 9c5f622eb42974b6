use super::Difference;

/// The difference picture's noise, which grows with the light: variance = read + shot * grey value
/// (the photon transfer curve).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    read: f64,
    shot: f64,
    offset: f64,
    typical: f64,
}

/// Rounding to whole grey values, in both pictures.
const ROUNDING: f64 = 2.0 / 12.0;
const BINS: usize = 16;
const LEAST_SAMPLES: usize = 100;

impl Noise {
    /// Measures the noise: the variance of the difference in classes of brightness, spots clipped away,
    /// and the straight line through them.
    pub fn of(difference: &Difference) -> Self {
        let samples = Samples::gather(difference);
        let offset = samples.median();
        let classes = samples.variances(offset);
        let (read, shot) = line_through(&classes);
        let dark = classes.first().map_or(0.0, |c| c.level);
        Self {
            read,
            shot,
            offset: f64::from(offset),
            typical: (read + shot * dark).max(ROUNDING).sqrt(),
        }
    }

    /// Variance of a difference where the picture has this grey value.
    pub fn variance(&self, level: f64) -> f64 {
        (self.read + self.shot * level).max(ROUNDING)
    }

    /// The difference where there is no laser light: not 0 if the ambient light changed.
    pub const fn offset(&self) -> f64 {
        self.offset
    }

    /// Standard deviation in the darker part of the picture, grey values.
    pub const fn typical(&self) -> f64 {
        self.typical
    }
}

/// Differences sorted into classes of brightness.
struct Samples {
    classes: Vec<Vec<i32>>,
    level_sums: Vec<f64>,
}

/// A class of brightness: mean grey value, variance of the difference, and what that weighs: a variance
/// of n samples is known to sqrt(2/n) of itself.
struct Class {
    level: f64,
    variance: f64,
    weight: f64,
}

impl Samples {
    /// At most some 20,000 pixels on a regular grid: enough for the variance to 1 %.
    fn gather(difference: &Difference) -> Self {
        // An odd stride walks through all columns of a picture of even width.
        let stride = (difference.len() / 20_000).max(1) | 1;
        let mut classes = vec![Vec::new(); BINS];
        let mut level_sums = vec![0.0; BINS];
        // To 8 bits: the square root of that has 16 values.
        let shift = difference.full_scale().count_ones() - u8::BITS;
        for pixel in (0..difference.len()).step_by(stride) {
            // Clipped pixels have no noise to measure.
            if difference.saturated(pixel) {
                continue;
            }
            // Both pictures' mean, whose noise tells nothing of the difference's: sorted by one of them,
            // pixels would come into the next class by their noise, and make it seem larger there.
            let level = difference.level(pixel);
            // Square-root spacing: shot noise changes most where it is dark.
            let bin = (level as usize >> shift).isqrt();
            classes[bin].push(difference.at(pixel));
            level_sums[bin] += level;
        }
        Self {
            classes,
            level_sums,
        }
    }

    fn median(&self) -> i32 {
        let mut all: Vec<i32> = self.classes.iter().flatten().copied().collect();
        if all.is_empty() {
            return 0;
        }
        let middle = all.len() / 2;
        *all.select_nth_unstable(middle).1
    }

    fn variances(&self, offset: i32) -> Vec<Class> {
        let filled = self.classes.iter().zip(&self.level_sums);
        filled
            .filter(|(class, _)| class.len() >= LEAST_SAMPLES)
            .map(|(class, sum)| {
                let count = class.len() as f64;
                let variance = clipped_variance(class, offset).max(ROUNDING);
                Class {
                    level: sum / count,
                    variance,
                    weight: count / (variance * variance),
                }
            })
            .collect()
    }
}

/// Variance about `offset` of the samples within four standard deviations of it, found by repetition.
fn clipped_variance(samples: &[i32], offset: i32) -> f64 {
    let mut sizes: Vec<u32> = samples.iter().map(|d| d.abs_diff(offset)).collect();
    let middle = sizes.len() / 2;
    let median = *sizes.select_nth_unstable(middle).1;
    let mut sigma = (1.4826 * f64::from(median)).max(0.5);
    for _ in 0..3 {
        let limit = (4.0 * sigma) as u32;
        let within = |size: &u32| {
            if *size <= limit {
                (u64::from(*size), 1)
            } else {
                (0, 0)
            }
        };
        let (squares, count) = sizes
            .iter()
            .map(within)
            .fold((0, 0_u64), |(sum, n), (size, one)| {
                (sum + size * size, n + one)
            });
        sigma = (squares as f64 / count.max(1) as f64).sqrt().max(0.1);
    }
    sigma * sigma
}

/// Weighted straight line through the classes, neither falling nor below rounding at zero light.
fn line_through(classes: &[Class]) -> (f64, f64) {
    let total: f64 = classes.iter().map(|c| c.weight).sum();
    if total == 0.0 {
        return (ROUNDING, 0.0);
    }
    let mean = |f: fn(&Class) -> f64| classes.iter().map(|c| c.weight * f(c)).sum::<f64>() / total;
    let (level, variance) = (mean(|c| c.level), mean(|c| c.variance));
    let (mut covariance, mut spread) = (0.0, 0.0);
    for c in classes {
        covariance += c.weight * (c.level - level) * (c.variance - variance);
        spread += c.weight * (c.level - level) * (c.level - level);
    }
    let slope = if spread > 0.0 {
        covariance / spread
    } else {
        0.0
    };
    let slope = slope.clamp(0.0, (variance / level.max(1e-9)).max(0.0));
    (variance - slope * level, slope)
}
