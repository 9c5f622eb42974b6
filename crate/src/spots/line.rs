//! The line of a sheet of light in a picture: one point a row (or column), with its noise.
//!
//! A profile across the line is a bump as wide as lens and sheet make it. Its middle c is where the
//! profile I, smoothed with a Gaussian g of about that width, is highest (the ridge of C. Steger, 1998,
//! along one direction):
//!
//! ```text
//! F(c) = sum I_i (x_i - c) g(x_i - c) = 0
//! var c = sum s_i^2 (x_i - c)^2 g(x_i - c)^2 / F'(c)^2
//! ```
//!
//! with s_i^2 the noise's variance at each pixel. For a Gaussian bump of that width in even noise this is
//! the least-squares fit; and unlike a centroid it hardly feels what else shines nearby. Pixels of one
//! profile serve one point alone, so that the noise of neighbouring points is independent.

use serde::{Deserialize, Serialize};

use super::{Difference, Noise, Spot, SpotSettings, Spots};
use crate::rig::Profiles;
use crate::robust::{median, sort_by_number, sort_stably};
use crate::scan::PicturePair;

/// What a view shows of a sheet's line. Its points are the view's spots, curve by curve.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Line {
    /// What the profiles were taken from.
    pub profiles: Profiles,
    /// Variance of the Gaussian that the profiles were smoothed with, px^2.
    pub kernel: f64,
    /// Points that follow one another from profile to profile.
    pub curves: Vec<Curve>,
}

/// Points that follow one another.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Curve {
    /// The first of its points among the view's spots.
    pub start: usize,
    /// Behind the last of them.
    pub end: usize,
    /// The mean profile about its points, grey values: [`Curve::PER_PIXEL`] samples a pixel, the point in
    /// the middle.
    pub profile: Vec<f64>,
}

impl Curve {
    /// Samples of the mean profile in a pixel.
    pub const PER_PIXEL: usize = 4;

    /// Its points among the view's spots.
    pub const fn range(&self) -> std::ops::Range<usize> {
        self.start..self.end
    }

    /// Where a sample of the mean profile lies, px from the point.
    pub fn place(&self, sample: usize) -> f64 {
        (sample as f64 - (self.profile.len() / 2) as f64) / Self::PER_PIXEL as f64
    }
}

/// Finds the line of a view. The background of a picture alone is taken out as for spots.
pub fn find_line(pictures: &PicturePair, profiles: Profiles, settings: &SpotSettings) -> Spots {
    /// Standard deviation of the first search's Gaussian, px.
    const USUAL: f64 = 1.5;
    let difference = Difference::of(pictures);
    let noise = Noise::of(&difference);
    let search = |sigma: f64| {
        let ridge = Ridge {
            difference: &difference,
            noise: &noise,
            profiles,
            kernel: Kernel::new(sigma),
            least: settings.edge,
        };
        let chains = chains(ridge.all_points(), sigma, settings);
        (ridge, chains)
    };
    // The line's own width, as a first search shows it, is the right one to smooth with.
    let (_, first) = search(USUAL);
    let widths: Vec<f64> = first.iter().flatten().map(|p| p.width).collect();
    let sigma = if widths.is_empty() {
        USUAL
    } else {
        median(widths).sqrt().clamp(0.8, 8.0)
    };
    let (ridge, found) = search(sigma);
    ridge.spots(&found)
}

/// The middle of a profile's bump.
#[derive(Clone, Copy, Debug)]
struct RidgePoint {
    /// Which profile.
    lane: usize,
    /// Where in it, px.
    at: f64,
    /// Variance of that, px^2.
    variance: f64,
    /// The smoothed bump's height in standard deviations of the noise without laser light.
    significance: f64,
    /// Second moment of the bump, px^2.
    width: f64,
    /// Sum of the difference, grey values.
    brightness: f64,
    /// Largest difference, grey values.
    peak: f64,
    saturated: bool,
}

/// A Gaussian, and how far it reaches.
#[derive(Clone, Copy, Debug)]
struct Kernel {
    variance: f64,
    reach: f64,
}

impl Kernel {
    fn new(sigma: f64) -> Self {
        Self {
            variance: sigma * sigma,
            reach: 3.5 * sigma,
        }
    }

    fn at(&self, x: f64) -> f64 {
        libm::exp(-0.5 * x * x / self.variance)
    }

    /// The pixels of a profile within reach of a place.
    fn around(&self, place: f64, length: usize) -> std::ops::Range<usize> {
        let first = (place - self.reach).ceil().max(0.0) as usize;
        let end = ((place + self.reach).floor() + 1.0).max(0.0) as usize;
        first.min(length)..end.min(length)
    }
}

/// Searches the profiles of a difference picture.
struct Ridge<'a> {
    difference: &'a Difference<'a>,
    noise: &'a Noise,
    profiles: Profiles,
    kernel: Kernel,
    /// A point stands out by as many standard deviations.
    least: f64,
}

impl Ridge<'_> {
    /// How many profiles there are, and how long they are.
    fn size(&self) -> (usize, usize) {
        let (width, height) = (self.difference.width(), self.difference.height());
        match self.profiles {
            Profiles::Rows => (height, width),
            Profiles::Columns => (width, height),
        }
    }

    /// The index of a profile's pixel in the picture.
    fn index(&self, lane: usize, i: usize) -> usize {
        match self.profiles {
            Profiles::Rows => lane * self.difference.width() + i,
            Profiles::Columns => i * self.difference.width() + lane,
        }
    }

    /// The points of all profiles, in the profiles' order.
    fn all_points(&self) -> Vec<Vec<RidgePoint>> {
        let (lanes, length) = self.size();
        let mut light = vec![0.0; length];
        let one = |lane: usize| {
            for (i, light) in light.iter_mut().enumerate() {
                let difference = self.difference.at(self.index(lane, i));
                *light = f64::from(difference) - self.noise.offset();
            }
            self.points(lane, &light)
        };
        (0..lanes).map(one).collect()
    }

    /// The points of a profile.
    fn points(&self, lane: usize, light: &[f64]) -> Vec<RidgePoint> {
        /// Without a pixel this far out of the noise nearby there is no line.
        const BRIGHT: f64 = 2.5;
        let bright = BRIGHT * self.noise.variance(0.0).sqrt();
        let reach = self.kernel.reach.ceil() as usize;
        let mut points = Vec::new();
        let mut slope_before = f64::NAN;
        let mut searched = 0;
        for seed in (0..light.len()).filter(|i| light[*i] >= bright) {
            let first = seed.saturating_sub(reach);
            if first > searched {
                slope_before = f64::NAN;
            }
            for i in first.max(searched)..(seed + reach).min(light.len()) {
                let (slope, _) = self.slope(light, i as f64);
                if slope_before > 0.0 && slope <= 0.0 {
                    points.extend(self.point(lane, light, i as f64 - 0.5));
                }
                slope_before = slope;
                searched = i + 1;
            }
        }
        points
    }

    /// F and F' of a place in a profile.
    fn slope(&self, light: &[f64], c: f64) -> (f64, f64) {
        let (mut slope, mut bend) = (0.0, 0.0);
        for i in self.kernel.around(c, light.len()) {
            let x = i as f64 - c;
            let weighted = light[i] * self.kernel.at(x);
            slope += weighted * x;
            bend += weighted * (x * x / self.kernel.variance - 1.0);
        }
        (slope, bend)
    }

    /// The bump near `start`, if it stands out.
    fn point(&self, lane: usize, light: &[f64], start: f64) -> Option<RidgePoint> {
        const STEPS: usize = 8;
        let mut at = start;
        let mut bend = f64::NAN;
        for _ in 0..STEPS {
            let (slope, b) = self.slope(light, at);
            bend = b;
            let step = (-slope / bend).clamp(-0.5, 0.5);
            at += step;
            if step.abs() < 1e-6 {
                break;
            }
        }
        let inside = at >= 0.0 && at <= (light.len() - 1) as f64;
        if !(bend < 0.0 && inside && (at - start).abs() <= 1.5) {
            return None;
        }
        let mut point = self.measured(lane, light, at);
        point.variance /= bend * bend;
        (point.significance >= self.least).then_some(point)
    }

    /// What the pixels around a bump's middle say of it; the variance is that of F.
    fn measured(&self, lane: usize, light: &[f64], at: f64) -> RidgePoint {
        // A window twice as wide as the kernel shows the bump's width, and is taken out of it again.
        let window = Kernel::new(2.0 * self.kernel.variance.sqrt());
        let (mut height, mut dark, mut variance) = (0.0, 0.0, 0.0);
        let (mut total, mut second, mut brightness) = (0.0, 0.0, 0.0);
        let mut peak = 0.0_f64;
        let mut saturated = false;
        for i in window.around(at, light.len()) {
            let x = i as f64 - at;
            let windowed = light[i] * window.at(x);
            total += windowed;
            second += windowed * x * x;
            if x.abs() > self.kernel.reach {
                continue;
            }
            let g = self.kernel.at(x);
            let pixel = self.index(lane, i);
            let dark_level = f64::from(self.difference.dark_level(pixel));
            height += light[i] * g;
            dark += self.noise.variance(dark_level) * g * g;
            variance += self.noise.variance(self.difference.level(pixel)) * x * x * g * g;
            brightness += light[i];
            peak = peak.max(light[i]);
            saturated |= self.difference.saturated(pixel);
        }
        let weighted = (second / total).clamp(0.1, 0.9 * window.variance);
        RidgePoint {
            lane,
            at,
            variance,
            significance: height / dark.sqrt(),
            width: weighted / (1.0 - weighted / window.variance),
            brightness,
            peak,
            saturated,
        }
    }

    /// The chains of points as the view's spots.
    fn spots(&self, chains: &[Vec<RidgePoint>]) -> Spots {
        let mut spots = Vec::new();
        let mut curves = Vec::new();
        for chain in chains {
            let start = spots.len();
            spots.extend(chain.iter().map(|point| self.spot(point)));
            curves.push(Curve {
                start,
                end: spots.len(),
                profile: self.mean_profile(chain),
            });
        }
        Spots {
            spots,
            said: Vec::new(),
            noise: self.noise.typical(),
            line: Some(Line {
                profiles: self.profiles,
                kernel: self.kernel.variance,
                curves,
            }),
        }
    }

    fn spot(&self, point: &RidgePoint) -> Spot {
        let lane = point.lane as f64;
        let ((u, v), covariance, shape) = match self.profiles {
            Profiles::Rows => (
                (point.at, lane),
                [point.variance, 0.0, 0.0],
                [point.width, 0.0, 0.0],
            ),
            Profiles::Columns => (
                (lane, point.at),
                [0.0, 0.0, point.variance],
                [0.0, 0.0, point.width],
            ),
        };
        Spot {
            u,
            v,
            covariance,
            shape,
            skew: [0.0; 4],
            brightness: point.brightness,
            peak: point.peak,
            area: self.kernel.around(point.at, self.size().1).len(),
            saturated: point.saturated,
        }
    }

    /// The mean of the profiles about a chain's points.
    fn mean_profile(&self, chain: &[RidgePoint]) -> Vec<f64> {
        /// Room for the wall's other face beside the line's own width, px.
        const ROOM: f64 = 8.0;
        let samples = Curve::PER_PIXEL as f64;
        let half = ((self.kernel.reach + ROOM) * samples).ceil();
        let (_, length) = self.size();
        let mut sums = vec![(0.0, 0.0); 2 * half as usize + 1];
        for point in chain {
            let reach = half / samples;
            let first = (point.at - reach).ceil().max(0.0) as usize;
            let end = ((point.at + reach).floor() as usize + 1).min(length);
            for i in first..end {
                let sample = (half + (i as f64 - point.at) * samples).round() as usize;
                let difference = self.difference.at(self.index(point.lane, i));
                sums[sample].0 += f64::from(difference) - self.noise.offset();
                sums[sample].1 += 1.0;
            }
        }
        let mean = |(sum, count): (f64, f64)| sum / f64::max(count, 1.0);
        sums.into_iter().map(mean).collect()
    }
}

/// Links points of neighbouring profiles into chains, and drops what is too short or too faint to be a line.
fn chains(
    lanes: Vec<Vec<RidgePoint>>,
    sigma: f64,
    settings: &SpotSettings,
) -> Vec<Vec<RidgePoint>> {
    /// A chain goes on over so many profiles without a point.
    const GAP: usize = 2;
    let count = lanes.len();
    let mut open: Vec<Vec<RidgePoint>> = Vec::new();
    let mut closed = Vec::new();
    for points in lanes {
        let Some(lane) = points.first().map(|p| p.lane) else {
            continue;
        };
        let (ended, going): (Vec<_>, Vec<_>) = open
            .into_iter()
            .partition(|chain| last(chain).lane + GAP + 1 < lane);
        closed.extend(ended);
        open = going;
        let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
        for (p, point) in points.iter().enumerate() {
            for (c, chain) in open.iter().enumerate() {
                let off = (point.at - expected(chain, lane)).abs();
                if off <= 2.0 * sigma && is_alike(point, last(chain)) {
                    pairs.push((off, p, c));
                }
            }
        }
        sort_by_number(&mut pairs, |pair| pair.0);
        let chains_before = open.len();
        let (mut taken, mut grown) = (vec![false; points.len()], vec![false; chains_before]);
        for (_, p, c) in pairs {
            if !taken[p] && !grown[c] {
                (taken[p], grown[c]) = (true, true);
                open[c].push(points[p]);
            }
        }
        let alone = points.iter().zip(&taken).filter(|(_, taken)| !**taken);
        open.extend(alone.map(|(point, _)| vec![*point]));
    }
    closed.extend(open);
    let whole = closed
        .iter()
        .map(|chain| without_ends(&straightened(chain), sigma, count));
    let mut found: Vec<_> = whole.filter(|chain| is_line(chain, settings)).collect();
    let first = |chain: &[RidgePoint]| (chain[0].lane, chain[0].at);
    sort_stably(&mut found, |a, b| {
        let (a, b) = (first(a), first(b));
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
    found
}

/// Light through a lens spreads along a line, noise does not.
fn is_line(chain: &[RidgePoint], settings: &SpotSettings) -> bool {
    let brightest = chain.iter().map(|p| p.significance).fold(0.0, f64::max);
    chain.len() >= settings.smallest_area && brightest >= settings.peak
}

/// A chain without the points at its ends, which the blur along the line draws aside: there light comes from
/// one side alone, or from beyond the end. The picture's border is no end.
fn without_ends(chain: &[RidgePoint], sigma: f64, lanes: usize) -> Vec<RidgePoint> {
    let ends = (1.5 * sigma).ceil() as usize;
    let first = if chain[0].lane > ends { ends } else { 0 };
    let last = if last(chain).lane + ends + 1 < lanes {
        chain.len().saturating_sub(ends)
    } else {
        chain.len()
    };
    chain.get(first..last).unwrap_or_default().to_vec()
}

/// A chain without what the blur along the line does where the line bends.
///
/// A blur of variance b moves the ridge of a line x(y) by b x'' / 2, to second order. Of the profile's
/// width the part f from 0 to 1 is the lens's blur, the rest the sheet's own thickness: not known, taken
/// as 1/2, with the standard deviation 0.29 of an even distribution.
fn straightened(chain: &[RidgePoint]) -> Vec<RidgePoint> {
    const REACH: usize = 3;
    const BENT: f64 = 4.0;
    const BLUR_PART: f64 = 0.5;
    const BLUR_PART_SIGMA: f64 = 0.29;
    let mut straightened = chain.to_vec();
    if chain.len() < 2 * REACH + 1 {
        return straightened;
    }
    for (i, point) in straightened.iter_mut().enumerate() {
        let middle = i.clamp(REACH, chain.len() - 1 - REACH);
        let [a, b, c] = [middle - REACH, middle, middle + REACH].map(|i| &chain[i]);
        let (before, after) = ((b.lane - a.lane) as f64, (c.lane - b.lane) as f64);
        let slopes = ((b.at - a.at) / before, (c.at - b.at) / after);
        let run = 0.5 * (before + after);
        let bend = (slopes.1 - slopes.0) / run;
        let variance = (a.variance + 4.0 * b.variance + c.variance) / (run * run * run * run);
        // What noise bends is left as it is.
        if bend * bend < BENT * BENT * variance {
            continue;
        }
        let whole = 0.5 * bend * point.width;
        point.at -= BLUR_PART * whole;
        point.variance += (BLUR_PART_SIGMA * whole) * (BLUR_PART_SIGMA * whole);
    }
    straightened
}

fn last(chain: &[RidgePoint]) -> &RidgePoint {
    &chain[chain.len() - 1]
}

/// Where a chain is expected in a later profile: straight on.
fn expected(chain: &[RidgePoint], lane: usize) -> f64 {
    const BACK: usize = 4;
    let here = last(chain);
    let there = &chain[chain.len().saturating_sub(BACK + 1)];
    let lanes = here.lane - there.lane;
    let slope = if lanes >= 2 {
        (here.at - there.at) / lanes as f64
    } else {
        0.0
    };
    here.at + slope * (lane - here.lane) as f64
}

/// Whether two neighbouring points may be of one line: it does not turn many times brighter from one profile
/// to the next.
fn is_alike(a: &RidgePoint, b: &RidgePoint) -> bool {
    const MOST: f64 = 4.0;
    a.brightness < MOST * b.brightness && b.brightness < MOST * a.brightness
}
