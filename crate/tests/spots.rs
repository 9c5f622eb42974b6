//! Spots in pictures whose light is known: where they are, how sure that is, and what is none.
#![cfg(not(target_family = "wasm"))]
#![allow(
    clippy::disallowed_methods,
    reason = "expectations may come from the platform"
)]

mod common;

use std::io::Cursor;

use common::Random;
use common::pictures::{Light, pair};
use image::{DynamicImage, ImageBuffer, ImageFormat, Luma, Rgb};
use nalgebra::Vector2;
use snellius::camera::Pixel;
use snellius::scan::{Picture, PicturePair};
use snellius::spots::{Difference, Noise, Spot, SpotSettings, Spots, find_spots};

fn spots(pictures: &PicturePair) -> Spots {
    find_spots(pictures, &SpotSettings::default())
}

#[track_caller]
fn only_spot(pictures: &PicturePair) -> Spot {
    let found = spots(pictures).spots;
    assert_eq!(found.len(), 1, "one spot was drawn: {found:?}");
    found[0]
}

fn error(spot: &Spot, truth: Pixel) -> Vector2<f64> {
    Vector2::new(spot.u - truth.u, spot.v - truth.v)
}

fn somewhere(random: &mut Random) -> Pixel {
    Pixel::new(random.between(20.0, 140.0), random.between(20.0, 100.0))
}

/// A room whose light falls off to one side, as it does.
fn room(full_scale: u16) -> Light {
    let top = f64::from(full_scale);
    Light::of(160, 120, move |u, v| top * (0.05 + 0.0015 * u + 0.0005 * v))
}

/// Without noise a centroid is where the light is, at any sub-pixel place, for spots sharp and blurred.
#[test]
fn a_centroid_is_where_the_light_is() {
    let mut random = Random::seeded(61);
    for full_scale in [255, u16::MAX] {
        let mut bias = Vector2::zeros();
        let count = 120;
        for _ in 0..count {
            let (truth, sigma) = (somewhere(&mut random), random.between(0.7, 2.5));
            let dark = room(full_scale);
            let lit = dark
                .clone()
                .with_spot(truth, 0.5 * f64::from(full_scale), sigma);
            let spot = only_spot(&pair(lit.still(full_scale), dark.still(full_scale)));
            let off = error(&spot, truth);
            // Rounding to 256 steps is a noise of its own.
            let allowed = if full_scale == 255 { 0.05 } else { 0.01 };
            assert!(off.norm() < allowed, "sigma {sigma}: {off:?}");
            bias += off / f64::from(count);
        }
        assert!(bias.norm() < 0.01, "{full_scale}: {bias:?}");
    }
}

/// Full scale, the spot's peak and standard deviation (px), read noise, shot noise.
type Exposure = (u16, f64, f64, f64, f64);

/// e^T C^-1 e summed over N noisy copies follows chi-square with 2N degrees of freedom: mean 2N, standard
/// deviation sqrt(4N).
#[track_caller]
fn assert_scatter_is_as_predicted((full_scale, peak, sigma, read, shot): Exposure) {
    let mut random = Random::seeded(62);
    let copies = 600;
    let (mut sum, mut mean) = (0.0, Vector2::zeros());
    for _ in 0..copies {
        let truth = somewhere(&mut random);
        let dark = room(full_scale);
        let lit = dark.clone().with_spot(truth, peak, sigma);
        let mut take = |light: &Light| light.noisy(full_scale, read, shot, &mut random);
        let spot = only_spot(&pair(take(&lit), take(&dark)));
        let off = error(&spot, truth);
        sum += (off.transpose() * spot.covariance_matrix().try_inverse().unwrap() * off).x;
        mean += off / f64::from(copies);
    }
    let (expected, spread) = (2.0 * f64::from(copies), (4.0 * f64::from(copies)).sqrt());
    assert!(
        (sum - expected).abs() < 4.0 * spread,
        "{sum} for {expected} +- {spread}"
    );
    assert!(mean.norm() < 0.02, "{mean:?}");
}

#[test]
fn centroids_scatter_as_their_covariance_says() {
    assert_scatter_is_as_predicted((255, 30.0, 1.2, 1.0, 0.02));
    assert_scatter_is_as_predicted((255, 120.0, 1.5, 1.0, 0.3));
    assert_scatter_is_as_predicted((255, 80.0, 1.2, 0.8, 0.02));
    assert_scatter_is_as_predicted((u16::MAX, 9000.0, 1.5, 250.0, 8.0));
}

/// A faint, blurred spot has flanks that drown in the noise: what is taken for the spot must not follow it.
#[test]
fn faint_blurred_centroids_scatter_as_their_covariance_says() {
    assert_scatter_is_as_predicted((255, 60.0, 2.2, 3.0, 0.0));
    assert_scatter_is_as_predicted((255, 25.0, 2.2, 1.0, 0.0));
}

/// Where the room is brighter the picture is noisier, and the threshold rises with it.
#[test]
fn noise_makes_no_spots() {
    let mut random = Random::seeded(63);
    let levels = [
        (0.0, 0.0),
        (0.5, 0.0),
        (1.0, 0.02),
        (2.0, 0.3),
        (6.0, 0.0),
        (3.0, 1.0),
        (12.0, 0.5),
    ];
    for (read, shot) in levels {
        let mut found = 0;
        for _ in 0..50 {
            let light = Light::of(
                320,
                240,
                |u, v| if u > 200.0 { 180.0 } else { 12.0 + 0.2 * v },
            );
            let mut take = || light.noisy(255, read, shot, &mut random);
            found += spots(&pair(take(), take())).spots.len();
        }
        assert_eq!(
            found, 0,
            "false spots in 50 pictures of noise {read}, {shot}"
        );
    }
}

/// Variance of a difference: twice read^2 + shot * grey value + 1/12 for rounding (photon transfer).
#[test]
fn the_noise_is_measured_as_it_is() {
    let mut random = Random::seeded(64);
    for (read, shot) in [(1.0, 0.0), (2.0, 0.1), (1.0, 0.5)] {
        let light = Light::of(400, 300, |u, _| 20.0 + 0.5 * u);
        let mut take = || light.noisy(255, read, shot, &mut random);
        let pictures = pair(take(), take());
        let noise = Noise::of(&Difference::of(&pictures));
        for level in [20.0, 100.0, 200.0] {
            let expected = 2.0 * (read * read + shot * level + 1.0 / 12.0);
            let ratio = noise.variance(level) / expected;
            assert!(
                (0.9..1.1).contains(&ratio),
                "{read}, {shot} at {level}: {ratio}"
            );
        }
    }
}

/// Nearly all of the picture is dark, and a spot's noise follows from what little is bright.
#[test]
fn the_noise_of_bright_spots_shows_in_a_dark_picture() {
    let mut random = Random::seeded(66);
    let light = Light::of(
        440,
        330,
        |u, v| if u < 60.0 && v < 60.0 { 60.0 } else { 14.0 },
    );
    let mut take = || light.noisy(255, 0.5, 0.012, &mut random);
    let noise = Noise::of(&Difference::of(&pair(take(), take())));
    let expected = 2.0 * (0.25 + 0.012 * 150.0 + 1.0 / 12.0);
    let ratio = noise.variance(150.0) / expected;
    assert!((0.75..1.25).contains(&ratio), "{ratio}");
}

/// The lamps were turned up between the two pictures: no new spots, and the old one stays where it is.
#[test]
fn a_change_of_the_rooms_light_moves_nothing() {
    let mut random = Random::seeded(65);
    for change in [-9.0, 7.0, 25.0] {
        let truth = somewhere(&mut random);
        let dark = Light::of(160, 120, |_, _| 60.0);
        let lit = dark.clone().brighter(change).with_spot(truth, 80.0, 1.5);
        let mut take = |light: &Light| light.noisy(255, 1.0, 0.0, &mut random);
        let spot = only_spot(&pair(take(&lit), take(&dark)));
        let off = error(&spot, truth);
        let sigma = spot.covariance_matrix().trace().sqrt();
        assert!(
            off.norm() < 4.0 * sigma && sigma < 0.1,
            "{change}: {off:?}, sigma {sigma}"
        );
    }
}

/// A pixel that is stuck is the same with the laser on and off; one that flickers, or a cosmic ray, is
/// lit alone, while light through a lens always spreads.
#[test]
fn a_hot_pixel_is_no_spot() {
    let mut random = Random::seeded(66);
    for height in [20.0, 60.0, 200.0] {
        let dark = Light::of(160, 120, |_, _| 30.0);
        let mut on = dark.noisy(255, 1.0, 0.0, &mut random);
        let off = dark.noisy(255, 1.0, 0.0, &mut random);
        on.grey[50 * 160 + 70] += height as u16;
        assert_eq!(
            spots(&pair(on, off)).spots,
            [],
            "a pixel {height} too bright"
        );
    }
}

#[test]
fn pixels_that_touch_at_a_corner_are_one_spot() {
    let dark = Light::of(80, 60, |_, _| 30.0);
    let mut on = dark.still(255);
    for (u, v) in [
        (30, 30),
        (31, 30),
        (30, 31),
        (31, 31),
        (32, 32),
        (33, 32),
        (32, 33),
        (33, 33),
    ] {
        on.grey[v * 80 + u] += 100;
    }
    let spot = only_spot(&pair(on, dark.still(255)));
    assert!(
        error(&spot, Pixel::new(31.5, 31.5)).norm() < 0.02,
        "{spot:?}"
    );
}

/// Ten pixels apart is twice a blurred spot's reach.
#[test]
fn spots_apart_are_told_apart_and_the_brightest_comes_first() {
    let dark = room(255);
    let lit = dark
        .clone()
        .with_spot(Pixel::new(60.3, 40.8), 40.0, 1.2)
        .with_spot(Pixel::new(70.3, 40.8), 90.0, 1.2);
    let found = spots(&pair(lit.still(255), dark.still(255))).spots;
    assert_eq!(found.len(), 2);
    assert!(found[0].brightness > found[1].brightness);
    assert!(error(&found[0], Pixel::new(70.3, 40.8)).norm() < 0.05);
    assert!(error(&found[1], Pixel::new(60.3, 40.8)).norm() < 0.05);
    // A Gaussian's light is 2 pi sigma^2 times its peak.
    let light = 2.0 * std::f64::consts::PI * 1.2 * 1.2 * 90.0;
    assert!(
        (found[0].brightness / light - 1.0).abs() < 0.03,
        "{}",
        found[0].brightness
    );
}

#[test]
fn a_spot_at_the_top_of_the_scale_is_marked() {
    let dark = room(255);
    let at = Pixel::new(60.3, 40.8);
    let view = |peak: f64| {
        pair(
            dark.clone().with_spot(at, peak, 1.5).still(255),
            dark.still(255),
        )
    };
    assert!(only_spot(&view(400.0)).saturated);
    assert!(!only_spot(&view(100.0)).saturated);
}

/// Without a picture taken with the laser off, the room's light must be guessed from around the spot.
#[test]
fn a_spot_is_found_in_a_picture_taken_alone() {
    let mut random = Random::seeded(67);
    for _ in 0..20 {
        let truth = somewhere(&mut random);
        let on = room(255)
            .with_spot(truth, 90.0, 1.5)
            .noisy(255, 1.0, 0.0, &mut random);
        let spot = only_spot(&PicturePair { on, off: None });
        assert!(error(&spot, truth).norm() < 0.1, "{spot:?} {truth:?}");
    }
}

fn encoded(image: impl Into<DynamicImage>) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    image.into().write_to(&mut file, ImageFormat::Png).unwrap();
    file.into_inner()
}

/// A laser has one colour: the mean of red, green and blue keeps a third of any, rounded to the nearest.
#[test]
fn colours_are_averaged_and_16_bits_are_kept() {
    let colour = ImageBuffer::from_fn(3, 1, |x, _| {
        [Rgb([240_u8, 0, 0]), Rgb([10, 20, 36]), Rgb([1, 1, 0])][x as usize]
    });
    let picture = Picture::decode(&encoded(colour), 3, 1).unwrap();
    assert_eq!((picture.full_scale, picture.grey), (255, vec![80, 22, 1]));
    let deep = ImageBuffer::from_fn(2, 1, |x, _| Luma([[40_000_u16, 7][x as usize]]));
    let picture = Picture::decode(&encoded(deep), 2, 1).unwrap();
    assert_eq!(
        (picture.full_scale, picture.grey),
        (u16::MAX, vec![40_000, 7])
    );
    let deep = ImageBuffer::from_fn(1, 1, |_, _| Rgb([65_535_u16, 0, 3]));
    let picture = Picture::decode(&encoded(deep), 1, 1).unwrap();
    assert_eq!((picture.full_scale, picture.grey), (u16::MAX, vec![21_846]));
}

/// A red spot of a colour camera is where a grey one's is.
#[test]
fn a_red_spot_is_found_in_colour_pictures() {
    let truth = Pixel::new(47.3, 61.8);
    let dark = Light::of(160, 120, |_, _| 20.0);
    let decoded = |light: &Light| {
        let grey = light.still(255);
        let colour = ImageBuffer::from_fn(160, 120, |u, v| {
            Rgb([grey.grey[(v * 160 + u) as usize] as u8, 20, 20])
        });
        Picture::decode(&encoded(colour), 160, 120).unwrap()
    };
    let lit = dark.clone().with_spot(truth, 200.0, 1.5);
    let spot = only_spot(&pair(decoded(&lit), decoded(&dark)));
    assert!(error(&spot, truth).norm() < 0.03, "{spot:?}");
}
