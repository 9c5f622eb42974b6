//! Both faces of the wall glow, and the picture shows one merged spot: how far that lies from the outer
//! face's own.
//!
//! Where the beam enters and leaves the wall it leaves a bright and a fainter spot. The camera sees them
//! a few pixels apart, d, which follows from the wall and the light's path; merged, their centroid lies
//! `q d` off the outer one, with q the inner glow's share of the light. The share shows in the spot's
//! width. With M_along and M_across the spot's second moments along and across d, and e the ratio by
//! which the beam's footprint is drawn out along it,
//!
//! ```text
//! M_along = M_across (1 + f (e^2 - 1)) + q (1 - q) d^2
//! ```
//!
//! where f (0 to 1) is the part of M_across that is the beam and not the lens's blur: not known, but it
//! matters little as e is near 1. Their lopsidedness, `q (1 - q) (1 - 2q) d^3`, is free of it. The share is the
//! same glass's in all views, so the medians over them are taken.
//!
//! Spots are measured in windows that leave out far pixels' noise, and of two glows some light. So what is held
//! against a spot is not these moments but what the same measurement makes of two Gaussians: [`Pair`].

use nalgebra::Vector2;

use super::Wall;
use crate::camera::{Intrinsics, Pixel};
use crate::geometry::{Camera, Point, Pose, Ray, World};
use crate::optics::{Media, aim_through};
use crate::robust::{median, robust_scale};
use crate::scan::InsideMedium;
use crate::spots::{Curve, Spot, ellipse_reach, moment_window};

/// What the wall's geometry says of a vessel spot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Faces {
    /// From the outer face's spot to the inner one's, px.
    pub(super) offset: Vector2<f64>,
    /// How much longer than wide the beam's footprint on the wall is seen, along the offset.
    stretch: f64,
}

/// Faces that are seen nearer together than this, px, glow as one.
const LEAST_OFFSET: f64 = 1e-3;

/// Where the inner face's glow of the laser's ray `beam` is seen, beside the outer one's; `None` where
/// that is the same place.
pub(super) fn faces(
    camera: &Intrinsics,
    beam: &Ray<Camera>,
    world_from_camera: &Pose<World, Camera>,
    wall: &Wall,
    media: &Media,
) -> Option<Faces> {
    let mut stack = wall.stack(media, InsideMedium::Liquid).ok()?;
    stack.interfaces.truncate(2);
    let inside = stack.path(&world_from_camera.ray(beam)).ok()?;
    stack.interfaces.truncate(1);
    let eye = world_from_camera.point(Point::origin());
    let seen = |point: Point<World>, faces: usize| -> Option<Pixel> {
        let mut stack = stack.clone();
        stack.interfaces.truncate(faces);
        let aim = aim_through(&stack, eye, point).ok()?;
        let ahead = world_from_camera.inverse().direction(aim);
        camera.project(Point::from_coords(ahead.vector()))
    };
    let outer = inside.vertices[1];
    let (at_outer, at_inner) = (seen(outer, 0)?, seen(inside.vertices[2], 1)?);
    let offset = Vector2::new(at_inner.u - at_outer.u, at_inner.v - at_outer.v);
    if offset.norm().is_nan() || offset.norm() <= LEAST_OFFSET {
        return None;
    }
    Some(Faces {
        offset,
        stretch: stretch(camera, beam, world_from_camera, wall, (at_outer, offset))?,
    })
}

/// How the circle in which the wall cuts the beam is seen: its image's half width along the offset over
/// that across it.
fn stretch(
    camera: &Intrinsics,
    beam: &Ray<Camera>,
    world_from_camera: &Pose<World, Camera>,
    wall: &Wall,
    (centre, offset): (Pixel, Vector2<f64>),
) -> Option<f64> {
    const BEAM: f64 = 0.1;
    let (u, v) = beam.direction.tangents();
    let along = offset.normalize();
    let across = Vector2::new(-along.y, along.x);
    let edge = |shift| {
        let beside = Ray::new(beam.origin + shift * BEAM, beam.direction);
        let hit = wall.outer.hit(&world_from_camera.ray(&beside))?;
        let pixel = camera.project(world_from_camera.inverse().point(hit.point))?;
        Some(Vector2::new(pixel.u - centre.u, pixel.v - centre.v))
    };
    let (a, b) = (edge(u)?, edge(v)?);
    let width =
        |axis: Vector2<f64>| (a.dot(&axis) * a.dot(&axis) + b.dot(&axis) * b.dot(&axis)).sqrt();
    Some(width(along) / width(across))
}

/// What the widths and the lopsidedness of the vessel's spots say of the two glows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glows {
    /// The inner face's share q of the light, from 0 (no inner glow) to 1/2 (both alike).
    pub share: f64,
    /// One standard deviation of it.
    pub share_sigma: f64,
    /// The wall's thickness that the glows themselves suggest, mm: from width and lopsidedness together,
    /// with the given thickness serving for scale alone. `None` where they tell nothing.
    pub thickness: Option<f64>,
}

/// Estimates the share from the vessel spots; `None` for too few of them, or where numbers beyond all measure
/// leave none.
///
/// What width, lopsidedness and what is known beforehand say together of the share, whatever f is, is a
/// distribution, of which mean and standard deviation are taken: near q = 1/2 the width hardly depends on
/// the share, and near 1/5 the lopsidedness hardly does.
pub(super) fn estimate(spots: &[(&Spot, Faces)], thickness: f64) -> Option<Glows> {
    const LEAST: usize = 3;
    if spots.len() < LEAST {
        return None;
    }
    let (share, share_sigma) = share(spots);
    if !share.is_finite() || !share_sigma.is_finite() {
        return None;
    }
    let excesses = |beam_part: f64| {
        let of_spot = |(spot, faces): &(&Spot, Faces)| {
            let own = faces.pair(spot, 0.0, beam_part).along;
            faces.measured(spot)[0] - own / faces.offset.norm_squared()
        };
        median_and_sigma(spots.iter().map(of_spot).collect())
    };
    let (skew, _) = median_and_sigma(spots.iter().map(|(s, f)| f.measured(s)[1]).collect());
    let (excess, sampling) = excesses(0.5);
    let slack = BEAM_PART_SIGMA * (excesses(1.0).0 - excesses(0.0).0);
    let sigma = (sampling * sampling + slack * slack).sqrt();
    // q (1 - q) d^2 and q (1 - q) (1 - 2q) d^3 make d^2 = (skew / excess)^2 + 4 excess.
    let ratio = skew / excess;
    let scale = (ratio * ratio + 4.0 * excess).sqrt();
    Some(Glows {
        share,
        share_sigma,
        thickness: (excess > 4.0 * sigma && scale.is_finite()).then_some(thickness * scale),
    })
}

/// Standard deviation of the unknown f, uniform from 0 to 1.
const BEAM_PART_SIGMA: f64 = 0.29;

impl Faces {
    /// How far the merged spot's centroid lies off the outer glow's own, px, for the inner one's share.
    pub(super) fn shift(&self, spot: &Spot, share: f64) -> Vector2<f64> {
        self.offset.normalize() * self.pair(spot, share, 0.5).centroid()
    }

    /// How that changes with the share, px.
    pub(super) fn shift_by_share(&self, spot: &Spot, share: f64) -> Vector2<f64> {
        const STEP: f64 = 1e-4;
        (self.shift(spot, share + STEP) - self.shift(spot, share - STEP)) / (2.0 * STEP)
    }

    /// The two glows that a spot would be of, for a share and a part f of the beam in its width.
    fn pair(&self, spot: &Spot, share: f64, beam_part: f64) -> Pair {
        let distance = self.offset.norm();
        let along = self.offset / distance;
        let across = spot.width_along(Vector2::new(-along.y, along.x));
        let footprint = self.stretch * self.stretch - 1.0;
        Pair {
            share,
            distance,
            along: across * (1.0 + beam_part * footprint),
            across,
        }
    }

    /// The spot's second and third moments along the offset, over d^2 and d^3.
    fn measured(&self, spot: &Spot) -> [f64; 2] {
        let distance = self.offset.norm();
        let along = self.offset / distance;
        let square = distance * distance;
        [
            spot.width_along(along) / square,
            spot.skew_along(along) / (square * distance),
        ]
    }
}

/// Two Gaussian glows of one width.
struct Pair {
    /// The inner one's share of the light.
    share: f64,
    /// From the outer one to the inner one, px.
    distance: f64,
    /// Variance of either along that way, px^2.
    along: f64,
    /// Variance across it, px^2.
    across: f64,
}

impl Pair {
    /// The whole light's variance along, px^2.
    fn spread(&self) -> f64 {
        self.along + self.share * (1.0 - self.share) * self.distance * self.distance
    }

    /// What is measured as their second and third moments along: taken under a Gaussian window about the
    /// centroid, which is then taken out again as if the light were one Gaussian.
    fn moments(&self) -> [f64; 2] {
        let window = moment_window(self.spread() + self.across);
        let seen_along = self.along + window;
        let centre = self.share * self.distance;
        // A Gaussian under a Gaussian window is another one, nearer to the window's middle.
        let glows = [(1.0 - self.share, 0.0), (self.share, self.distance)].map(|(light, place)| {
            let off = centre - place;
            let seen = light * libm::exp(-0.5 * off * off / seen_along);
            (seen, place + off * self.along / seen_along)
        });
        let total = glows[0].0 + glows[1].0;
        let mean = (glows[0].0 * glows[0].1 + glows[1].0 * glows[1].1) / total;
        let about_mean = |power: i32| -> f64 {
            let of_glow = |(light, place): (f64, f64)| {
                let off = place - mean;
                light
                    * if power == 2 {
                        off * off
                    } else {
                        off * off * off
                    }
            };
            glows.map(of_glow).iter().sum::<f64>() / total
        };
        let second = self.along * window / seen_along + about_mean(2);
        let widened = second / (1.0 - second / window);
        let seen_across = self.across * window / (self.across + window);
        let gain = (widened + self.across) / (second + seen_across);
        [widened, about_mean(3) * gain * gain * gain]
    }

    /// How far their centroid lies off the outer one, px: that of the light in the ellipse that spots have theirs
    /// taken in.
    fn centroid(&self) -> f64 {
        const STRIPS: usize = 48;
        const ROUNDS: usize = 4;
        let [reach, half_width] = [self.moments()[0], self.across].map(ellipse_reach);
        let glow = |x: f64| libm::exp(-0.5 * x * x / self.along);
        let mut centre = self.share * self.distance;
        for _ in 0..ROUNDS {
            let (mut moment, mut total) = (0.0, 0.0);
            for strip in 0..STRIPS {
                let part = (2 * strip + 1) as f64 / STRIPS as f64 - 1.0;
                let x = centre + part * reach;
                let inside = half_width * (1.0 - part * part).sqrt();
                let light = (1.0 - self.share) * glow(x) + self.share * glow(x - self.distance);
                let seen = light * libm::erf(inside / (2.0 * self.across).sqrt());
                moment += x * seen;
                total += seen;
            }
            centre = moment / total;
        }
        centre
    }
}

/// Mean and standard deviation of the share.
fn share(spots: &[(&Spot, Faces)]) -> (f64, f64) {
    const SHARES: usize = 101;
    const BEAM_PARTS: usize = 11;
    /// Third moments are exact for Gaussian spots alone: what else may be in them.
    const SKEW_MODEL: f64 = 0.02;
    let square = |x: f64| x * x;
    let shares = (0..SHARES).map(|i| 0.5 * i as f64 / (SHARES - 1) as f64);
    let beam_parts = |j: usize| j as f64 / (BEAM_PARTS - 1) as f64;
    mean_of(shares.flat_map(|share| {
        let excess = share * (1.0 - share);
        let beforehand = square((excess - PRIOR) / PRIOR_SIGMA);
        (0..BEAM_PARTS).map(move |j| {
            let [wide, skew] = misfits(spots, share, beam_parts(j));
            let sigma = wide.1.max(1e-6);
            let skew_variance = square(skew.1) + square(SKEW_MODEL);
            let all = beforehand + square(wide.0 / sigma) + square(skew.0) / skew_variance;
            (share, 0.5 * all + libm::log(sigma))
        })
    }))
}

/// How far the spots' second and third moments, over d^2 and d^3, lie off those of two glows: medians and their
/// own standard deviations.
fn misfits(spots: &[(&Spot, Faces)], share: f64, beam_part: f64) -> [(f64, f64); 2] {
    let of_spot = |(spot, faces): &(&Spot, Faces)| {
        let square = faces.offset.norm_squared();
        let [width, skew] = faces.pair(spot, share, beam_part).moments();
        let [seen, lopsided] = faces.measured(spot);
        (
            seen - width / square,
            lopsided - skew / (square * square.sqrt()),
        )
    };
    let (wide, skew) = spots.iter().map(of_spot).unzip();
    [median_and_sigma(wide), median_and_sigma(skew)]
}

/// The usual q (1 - q), and one standard deviation of it: the inner face's glow is the fainter one, about a
/// fifth of the light. Where the two glows lie less than a spot's width apart, this is nearly all there is to
/// know.
const PRIOR: f64 = 0.16;
const PRIOR_SIGMA: f64 = 0.06;

/// The median and its own standard deviation, 1.25 times that of a mean.
fn median_and_sigma(values: Vec<f64>) -> (f64, f64) {
    let root = (values.len() as f64).sqrt();
    let middle = median(values.clone());
    let off: Vec<f64> = values.iter().map(|x| x - middle).collect();
    (middle, 1.25 * robust_scale(&off) / root)
}

/// What the profiles across a wall's line say of its two glows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct LineGlow {
    /// Share and thickness; none where the profiles tell nothing.
    pub(super) glows: Option<Glows>,
    /// Variance of one glow's profile, px^2.
    pub(super) width: f64,
}

/// Estimates the share from the mean profiles of the wall's curves, each with the variance of the Gaussian
/// that found its points and the offset of the inner face's line along the profile, px.
///
/// Two Gaussians of one width, `(1 - q) g(x) + q g(x - d)`, are held against every profile for each share q;
/// heights and widths follow the profile. What all profiles say together of q, with what is known
/// beforehand, is a distribution, of which mean and standard deviation are taken: where the glows lie
/// nearer together than a line is wide, shares about 1/5 look nearly alike, and that must show.
pub(super) fn of_profiles(profiles: &[(&Curve, f64, f64)], thickness: f64) -> LineGlow {
    const MOST_PROFILES: usize = 40;
    const SHARES: usize = 26;
    const LN_3: f64 = 1.098_612_288_668_109_8;
    /// Ratios of the glows' distance to that of the given thickness, from 1/3 to 3.
    const RATIOS: usize = 41;
    let stride = profiles.len().div_ceil(MOST_PROFILES).max(1);
    let profiles: Vec<Profile> = profiles
        .iter()
        .step_by(stride)
        .map(|(curve, kernel, offset)| Profile::new(curve, *kernel, *offset))
        .collect();
    if profiles.is_empty() {
        return LineGlow::default();
    }
    let excess = |share: f64| share * (1.0 - share);
    let beforehand = |share: f64| {
        let z = (excess(share) - PRIOR) / PRIOR_SIGMA;
        0.5 * z * z
    };
    let (share, share_sigma) = mean_of((0..SHARES).map(|i| {
        let share = 0.5 * i as f64 / (SHARES - 1) as f64;
        (share, misfit(&profiles, share, 1.0) + beforehand(share))
    }));
    let (ratio, ratio_sigma) = mean_of((0..RATIOS).map(|i| {
        let ratio = libm::exp((2.0 * i as f64 / (RATIOS - 1) as f64 - 1.0) * LN_3);
        (ratio, misfit(&profiles, share, ratio))
    }));
    let widths = profiles.iter().map(|profile| profile.fit(share, 1.0).width);
    LineGlow {
        width: median(widths.collect()),
        glows: Some(Glows {
            share,
            share_sigma,
            thickness: (ratio_sigma < 0.15 * ratio).then_some(thickness * ratio),
        }),
    }
}

/// Mean and standard deviation of a value whose negative log-likelihood is known at even steps.
fn mean_of(values: impl Iterator<Item = (f64, f64)>) -> (f64, f64) {
    let values: Vec<(f64, f64)> = values.collect();
    let least = values
        .iter()
        .map(|(_, loss)| *loss)
        .fold(f64::INFINITY, f64::min);
    let (mut total, mut first, mut second) = (0.0, 0.0, 0.0);
    for (value, loss) in values {
        let weight = libm::exp(least - loss);
        total += weight;
        first += weight * value;
        second += weight * value * value;
    }
    let mean = first / total;
    (mean, (second / total - mean * mean).max(0.0).sqrt())
}

/// The negative log-likelihood of a share and a distance of the glows, up to a constant.
fn misfit(profiles: &[Profile], share: f64, ratio: f64) -> f64 {
    profiles
        .iter()
        .map(|profile| 0.5 * profile.fit(share, ratio).squares / profile.noise)
        .sum()
}

/// A mean profile, the outer face's side first.
struct Profile {
    /// Places, px from the ridge, and light.
    samples: Vec<(f64, f64)>,
    kernel: f64,
    /// From the outer face's line to the inner one's, px.
    offset: f64,
    /// Variance of a sample.
    noise: f64,
}

/// How well two glows make a profile.
#[derive(Clone, Copy)]
struct ProfileFit {
    width: f64,
    /// Sum of the squared residuals.
    squares: f64,
}

impl Profile {
    fn new(curve: &Curve, kernel: f64, offset: f64) -> Self {
        /// No real profile is a sum of Gaussians to better than this part of its height.
        const MODEL: f64 = 0.005;
        let side = offset.signum();
        let reach = 3.0 * kernel.sqrt();
        let samples = curve.profile.iter().enumerate();
        let samples: Vec<(f64, f64)> = samples
            .map(|(i, light)| (side * curve.place(i), *light))
            .filter(|(x, _)| (-reach..=reach + offset.abs()).contains(x))
            .collect();
        let height = samples.iter().map(|(_, light)| *light).fold(0.0, f64::max);
        let mut profile = Self {
            samples,
            kernel,
            offset: offset.abs(),
            noise: 1.0,
        };
        let typical = profile.fit(0.2, 1.0).squares / profile.samples.len().max(1) as f64;
        profile.noise = typical
            .max(MODEL * height * MODEL * height)
            .max(f64::MIN_POSITIVE);
        profile
    }

    /// The best width for a share and a distance, by golden sections.
    fn fit(&self, share: f64, ratio: f64) -> ProfileFit {
        const STEPS: usize = 18;
        const GOLDEN: f64 = 0.618_033_988_749_895;
        let distance = ratio * self.offset;
        let at = |width: f64| self.squares(share, distance, width);
        let (mut low, mut high) = (0.3 * self.kernel, 1.6 * self.kernel);
        for _ in 0..STEPS {
            let step = GOLDEN * (high - low);
            if at(high - step) < at(low + step) {
                high = low + step;
            } else {
                low = high - step;
            }
        }
        let width = 0.5 * (low + high);
        ProfileFit {
            width,
            squares: at(width),
        }
    }

    /// What two glows of the best height leave. Their place follows from the ridge, which is at 0.
    fn squares(&self, share: f64, distance: f64, width: f64) -> f64 {
        let place = -ridge_shift(share, distance, width + self.kernel);
        let model = |x: f64| {
            let (near, far) = (x - place, x - place - distance);
            (1.0 - share) * libm::exp(-0.5 * near * near / width)
                + share * libm::exp(-0.5 * far * far / width)
        };
        let (mut light, mut own, mut both) = (0.0, 0.0, 0.0);
        for (x, seen) in &self.samples {
            let model = model(*x);
            light += seen * seen;
            own += model * model;
            both += model * seen;
        }
        light - both * both / own
    }
}

/// How far the ridge of two merged lines lies from the outer one's middle, along the profile, px.
///
/// `variance` is that of one line smoothed with the Gaussian that found the ridge. The ridge is where the
/// sum `(1 - q) g(x) + q g(x - d)` is highest: x is the mean of 0 and d, weighted with either's light there.
pub(super) fn ridge_shift(share: f64, offset: f64, variance: f64) -> f64 {
    const STEPS: usize = 60;
    let mut x = 0.0;
    for _ in 0..STEPS {
        let ratio = libm::exp((x * offset - 0.5 * offset * offset) / variance);
        let next = offset * share * ratio / (1.0 - share + share * ratio);
        let step: f64 = next - x;
        x = next;
        if step.abs() < 1e-9 {
            break;
        }
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scan::{Picture, PicturePair};
    use crate::spots::{SpotSettings, find_spots};

    const WIDTH: u32 = 120;
    const HEIGHT: u32 = 80;
    /// Variance of either glow, px^2.
    const ONE: f64 = 1.8;
    const OUTER: (f64, f64) = (60.2, 40.4);

    /// Two round glows side by side, photographed without noise but for rounding.
    fn photographed(share: f64, distance: f64) -> Spot {
        let light = |x: u32, y: u32, at: f64| {
            let (dx, dy) = (f64::from(x) - at, f64::from(y) - OUTER.1);
            libm::exp(-0.5 * (dx * dx + dy * dy) / ONE)
        };
        let picture = |laser: f64| {
            let pixel = |i: u32| {
                let (x, y) = (i % WIDTH, i / WIDTH);
                let (outer, inner) = (light(x, y, OUTER.0), light(x, y, OUTER.0 + distance));
                let glow = (1.0 - share) * outer + share * inner;
                // A picture without noise would have none to hold spots against.
                let ripple = f64::from((x * 7 + y * 13) % 5 * 40);
                (2_000.0 + laser * (ripple + 40_000.0 * glow)) as u16
            };
            Picture {
                width: WIDTH as usize,
                height: HEIGHT as usize,
                full_scale: u16::MAX,
                grey: (0..WIDTH * HEIGHT).map(pixel).collect(),
            }
        };
        let pictures = PicturePair {
            on: picture(1.0),
            off: Some(picture(0.0)),
        };
        find_spots(&pictures, &SpotSettings::default()).spots[0]
    }

    #[test]
    fn a_pair_says_what_is_measured_of_two_glows() {
        for share in [0.1, 0.25, 0.4] {
            for distance in [1.0, 2.0, 3.0, 4.0] {
                let spot = photographed(share, distance);
                let pair = Pair {
                    share,
                    distance,
                    along: ONE,
                    across: ONE,
                };
                let [width, skew] = pair.moments();
                let off = spot.u - OUTER.0;
                assert!((off - pair.centroid()).abs() < 0.004, "{share} {distance}");
                assert!(
                    (spot.shape[0] / width - 1.0).abs() < 2e-3,
                    "{share} {distance}"
                );
                assert!(
                    (spot.skew[0] - skew).abs() < 0.005 * distance,
                    "{share} {distance}"
                );
            }
        }
    }
}
