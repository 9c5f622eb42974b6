//! Reconstructions in links: short, no less exact than they say, open for ever, harmless whatever they hold.
#![allow(
    clippy::disallowed_methods,
    reason = "expectations may come from the platform"
)]

mod common;

use std::io::{Read, Write};

use base64::Engine;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;
use common::Random;
use common::archives::repository;
use flate2::Compression;
use flate2::read::DeflateEncoder;
use serde_json::{Value, json};
use snellius::export::{Format, OneOrMany, ReconstructionResult};
use snellius::pipeline::Settings;
use snellius::scan::VesselShape;
use snellius::share::{LONGEST, LinkError, Rounding, SHORT, Shared, decode, encode};

/// A box in a tank as the paper scans one: rows of stations, points with noise of the size they state.
fn paper_size(rows: usize, views: usize, random: &mut Random) -> ReconstructionResult {
    let (mut list, mut number) = (Vec::new(), 0);
    for row in 0..rows {
        for view in 0..views {
            let x = -70.0 + 140.0 * view as f64 / views as f64;
            let y = -90.0 + 180.0 * row as f64 / rows as f64;
            let z = 60.0 + if x < 10.0 { -x } else { x - 20.0 };
            // As the samples have them: a spot's brightness decides, and all axes follow it.
            let bright = random.between(0.8, 1.6);
            let sigma = [0.013, 0.007, 0.037].map(|s| s * bright * random.between(0.95, 1.05));
            let common = [0.95 + 0.002 * z, 1.0, 2.0 + 0.015 * z];
            let mut noisy = |place: [f64; 3], sigma: [f64; 3]| {
                let mut axis = |i: usize| place[i] + sigma[i] * random.normal();
                [axis(0), axis(1), axis(2)]
            };
            let object = noisy([x, y, z], sigma);
            let vessel = noisy([0.7 * x - 20.0, y, 0.05 * x], [0.02; 3]);
            let straight = noisy([1.02 * x, y, 0.72 * z], sigma);
            list.push(json!({
                "id": format!("{number:04}"), "sweep": row, "status": "ok", "vessel": vessel,
                "object": object, "object_sigma": sigma, "object_sigma_calibration": common,
                "ray_distance": (0.012 * random.normal()).abs(), "object_unrefracted": straight,
                "spots": [],
            }));
            number += 1;
        }
    }
    made_up(list)
}

fn made_up(views: Vec<Value>) -> ReconstructionResult {
    let json = json!({
        "format": "refractive-reconstruction", "version": 1,
        "scan": "Box in a half-filled glass tank, fifteen scans", "length_unit": "mm",
        "media": { "outside": 1.0, "wall": 1.5,
                   "inside": { "value": 1.333, "sigma": null, "method": "given", "verdict": "given" } },
        "vessel": { "shape": "plane", "point": [-46.731_349_95, 3.588_777_62, 1.560_890_31],
                    "normal": [-0.035_112_55, -0.026_247_13, -0.999_038_64],
                    "wall_thickness": 2.1, "rms": 0.043_554_425, "points": views.len(),
                    "glow": { "inner_share": 0.208_924_9, "inner_share_sigma": 0.054_022_6,
                              "thickness": 1.963_659_78 } },
        "views": views, "warnings": [],
    });
    ReconstructionResult::from_json(json.to_string().as_bytes()).unwrap()
}

/// Everything there is, within what the link says.
#[track_caller]
fn assert_within(shared: &Shared, truth: &ReconstructionResult) {
    let (result, rounding) = (shared.result.as_ref().unwrap(), shared.rounding.unwrap());
    let Rounding {
        object,
        ray_distance,
        shown,
        sigma_factor,
    } = rounding;
    assert_eq!((&result.scan, &result.media), (&truth.scan, &truth.media));
    assert_eq!(result.warnings, truth.warnings);
    assert_eq!(result.vessel.points, truth.vessel.points);
    assert_eq!(result.views.len(), truth.views.len());
    let near = |found: &[[f64; 3]], expected: &[[f64; 3]], most: [f64; 3]| {
        assert_eq!(found.len(), expected.len());
        for (a, b) in found.iter().zip(expected) {
            for axis in 0..3 {
                assert!(
                    (a[axis] - b[axis]).abs() <= most[axis],
                    "{a:?} {b:?} {most:?}"
                );
            }
        }
    };
    for (found, expected) in result.views.iter().zip(&truth.views) {
        assert_eq!(
            (&found.id, found.sweep, found.status),
            (&expected.id, expected.sweep, expected.status)
        );
        near(found.object.as_slice(), expected.object.as_slice(), object);
        near(
            found.vessel.as_slice(),
            expected.vessel.as_slice(),
            [shown; 3],
        );
        let straight = |points: &OneOrMany<Option<[f64; 3]>>| -> Vec<[f64; 3]> {
            points.iter().flatten().copied().collect()
        };
        near(
            &straight(&found.object_unrefracted),
            &straight(&expected.object_unrefracted),
            [shown; 3],
        );
        for (a, b) in found.ray_distance.iter().zip(expected.ray_distance.iter()) {
            assert!((a - b).abs() <= ray_distance, "{a} {b}");
        }
        let sigmas = |v: &snellius::export::ViewResult| -> Vec<f64> {
            let both = v
                .object_sigma
                .iter()
                .chain(v.object_sigma_calibration.iter());
            both.flatten().copied().collect()
        };
        for (a, b) in sigmas(found).iter().zip(sigmas(expected)) {
            assert!((a / b).max(b / a) <= sigma_factor, "{a} {b}");
        }
        for sigma in expected.object_sigma.iter() {
            for axis in 0..3 {
                assert!(
                    object[axis] < sigma[axis],
                    "rounded more than the noise: {rounding:?}"
                );
            }
        }
    }
}

#[test]
#[expect(clippy::print_stdout, reason = "docs/exports.md quotes these numbers")]
fn three_hundred_points_make_a_short_link() {
    let mut random = Random::seeded(1);
    for (rows, views) in [(15, 20), (5, 7), (3, 100), (30, 10)] {
        let truth = paper_size(rows, views, &mut random);
        let link = encode(&Settings::default(), Some(&truth)).unwrap();
        println!(
            "{} points: {} characters, {:?}",
            rows * views,
            link.fragment.len(),
            link.rounding
        );
        assert!(
            link.fragment.len() <= SHORT,
            "{} characters",
            link.fragment.len()
        );
        assert_eq!(link.warning(), None);
        let shared = decode(&format!("#{}", link.fragment)).unwrap();
        assert_eq!(shared.settings, Settings::default());
        assert_within(&shared, &truth);
    }
}

#[test]
fn more_points_make_a_long_link_with_a_warning_and_then_none() {
    let mut random = Random::seeded(2);
    let truth = paper_size(40, 50, &mut random);
    let link = encode(&Settings::default(), Some(&truth)).unwrap();
    assert!((SHORT + 1..=LONGEST).contains(&link.fragment.len()));
    assert!(
        link.warning()
            .unwrap()
            .contains(&link.fragment.len().to_string())
    );
    assert_within(&decode(&link.fragment).unwrap(), &truth);

    let too_much = paper_size(150, 100, &mut random);
    let refused = encode(&Settings::default(), Some(&too_much)).unwrap_err();
    assert_eq!(refused, LinkError::TooLong);
    assert!(refused.to_string().contains("use a file"));
}

/// Whatever the numbers are: gaps, views of any number of points, odd ids, far and near.
#[test]
fn any_result_comes_back_within_what_its_link_says() {
    let mut random = Random::seeded(3);
    for case in 0..200 {
        let line = case % 3 == 0;
        let size = [0.1, 10.0, 1000.0, 30_000.0][case % 4];
        let views = (0..random.between(0.0, 25.0) as usize).map(|number| {
            let count = match line {
                true => random.between(0.0, 12.0) as usize,
                false => random.between(0.3, 1.9) as usize,
            };
            let mut triple = |half: f64| -> [f64; 3] { random.vector(half).into() };
            let places: Vec<_> = (0..count).map(|_| triple(size)).collect();
            let walls: Vec<_> = (0..count).map(|_| triple(size)).collect();
            let sigmas: Vec<_> = (0..count).map(|_| triple(1.0).map(|s| 1e-3 + s.abs())).collect();
            let distances: Vec<_> = (0..count).map(|_| triple(1.0)[0].abs()).collect();
            let shape = |values: Value| if line { values } else { values.get(0).cloned().into() };
            let status = ["ok", "no-vessel-spot", "no-object-spot", "rejected"][number % 4];
            json!({
                "id": format!("view {} \u{e4}", case * number), "sweep": number / 5, "status": status,
                "vessel": shape(json!(walls)), "object": shape(json!(places)),
                "object_sigma": shape(json!(sigmas)), "object_sigma_calibration": shape(json!(sigmas)),
                "ray_distance": shape(json!(distances)), "object_unrefracted": shape(json!(walls)),
                "spots": [{ "pixel": [1.0, 2.0], "role": "object" }],
            })
        });
        let truth = made_up(views.collect());
        let link = encode(&Settings::default(), Some(&truth)).unwrap();
        assert_within(&decode(&link.fragment).unwrap(), &truth);
        assert_eq!(
            link,
            encode(&Settings::default(), Some(&truth)).unwrap(),
            "the same again"
        );
    }
}

#[test]
fn settings_travel_alone_in_a_few_characters() {
    let mut settings = Settings::default();
    let none = encode(&settings, None).unwrap();
    assert!(none.fragment.len() < 20, "{}", none.fragment);
    settings.index = Some(1.36);
    settings.vessel.shape = Some(VesselShape::Cylinder);
    settings.object.gap_sigmas += 1.0;
    let link = encode(&settings, None).unwrap();
    assert!(link.fragment.len() < 150, "{}", link.fragment);
    let shared = decode(&link.fragment).unwrap();
    assert_eq!(
        shared,
        Shared {
            settings,
            result: None,
            rounding: None
        }
    );
}

#[test]
fn a_measured_sample_opens_and_can_be_written_in_every_format() {
    for sample in ["tank-paper", "jar"] {
        let archive = std::fs::read(repository(&format!("samples/{sample}.zip"))).unwrap();
        let truth = common::archives::measure(&archive).unwrap();
        let link = encode(&Settings::default(), Some(&truth)).unwrap();
        assert!(
            link.fragment.len() <= SHORT,
            "{sample}: {}",
            link.fragment.len()
        );
        let shared = decode(&link.fragment).unwrap();
        assert_within(&shared, &truth);
        for format in Format::ALL {
            shared.result.as_ref().unwrap().write(*format).unwrap();
        }
    }
}

/// A link that the first program of version 1 made, kept as it was. If this fails, do not
/// change the file: make the program open it.
#[test]
fn a_link_of_version_1_opens_for_ever() {
    let link = include_str!("data/link-v1.txt").trim();
    let shared = decode(link).unwrap();
    let result = shared.result.unwrap();
    assert_eq!(result.scan, "Two points of a ball");
    assert_eq!(shared.settings.index, Some(1.36));
    assert_eq!(result.media.inside.value, Some(1.36));
    assert_eq!(result.views.len(), 3);
    assert_eq!(result.views[1].id, "b");
    let place = result.views[1].object.first().unwrap();
    for (found, expected) in place.iter().zip([-7.5, 2.25, 81.125]) {
        assert!((found - expected).abs() < 0.01, "{place:?}");
    }
    assert_eq!(result.views[2].object.first(), None);
    assert_eq!(result.warnings, ["a <b>warning</b>"]);
}

/// A payload of anyone's making, as a link.
fn forged(head: &str, columns: &[u8]) -> String {
    let mut payload = Vec::new();
    let mut length = head.len();
    while length >= 0x80 {
        payload.push(length as u8 | 0x80);
        length >>= 7;
    }
    payload.push(length as u8);
    payload.extend(head.as_bytes());
    payload.extend(columns);
    in_link(&payload)
}

fn in_link(payload: &[u8]) -> String {
    let mut deflated = Vec::new();
    DeflateEncoder::new(payload, Compression::best())
        .read_to_end(&mut deflated)
        .unwrap();
    format!("r1={}", URL_SAFE_NO_PAD.encode(deflated))
}

const RESULT: &str = r#""res":{"scan":"x","media":{"outside":1,"wall":1.5,"inside":{"value":1.3,"sigma":null,
    "method":"given","verdict":"given"}},"vessel":{"shape":"plane","point":[0,0,0],"normal":[0,0,-1],
    "wall_thickness":2,"rms":0,"points":0},"warnings":[]}"#;

#[test]
fn links_of_others_and_of_later_programs_say_so() {
    for other in [
        "",
        "#",
        "bench=1",
        "r1",
        "rx=AA",
        "r=AA",
        "r99999999=AA",
        "view-3",
    ] {
        assert_eq!(decode(other), Err(LinkError::NotOurs), "{other}");
    }
    assert_eq!(decode("#r2=AAAA"), Err(LinkError::Version("2".to_owned())));
}

#[test]
fn a_link_that_was_cut_off_or_changed_is_an_error_or_another_link_but_no_panic() {
    let mut random = Random::seeded(4);
    let truth = paper_size(5, 7, &mut random);
    let whole = encode(&Settings::default(), Some(&truth)).unwrap().fragment;
    for length in 3..whole.len() {
        let cut = decode(&whole[..length]);
        assert!(
            matches!(cut, Err(LinkError::Damaged(_))),
            "{length}: {cut:?}"
        );
    }
    for _ in 0..3000 {
        let mut bytes = whole.clone().into_bytes();
        let at = random.between(3.0, bytes.len() as f64) as usize;
        bytes[at] = b"ABCxyz019-_=%<"[random.between(0.0, 14.0) as usize];
        let _ = decode(std::str::from_utf8(&bytes).unwrap());
    }
}

#[test]
fn payloads_of_ill_will_are_errors() {
    let mut random = Random::seeded(5);
    let steps = r#""steps":[0.1,0.1,0.1,0.1]"#;
    let heads = [
        "[".repeat(100_000),
        format!(r#"{{"set":{}"#, r#"{"a":"#.repeat(10_000)),
        r#"{"set":{"object":{"gap_sigmas":-4}}}"#.to_owned(),
        r#"{"set":{"spots":{"peak":1e300}}}"#.to_owned(),
        r#"{"set":{"index_range":{"from":1.2,"to":1.6,"count":4000000000}}}"#.to_owned(),
        r#"{"set":{"index":-1}}"#.to_owned(),
        r#"{"set":[]}"#.to_owned(),
        format!("{{{RESULT}}}"),
        format!(r#"{{{RESULT},"steps":[0,0.1,0.1,0.1]}}"#),
        format!(r#"{{{RESULT},"steps":[-1,0.1,0.1,0.1]}}"#),
        format!(r#"{{{RESULT},{steps},"ids":[4000000000,0]}}"#),
        r#"{"res":{"scan":7},"steps":[0.1,0.1,0.1,0.1]}"#.to_owned(),
        "\u{0}".to_owned(),
    ];
    for head in &heads {
        let found = decode(&forged(head, &[2, 0, 0, 0, 0, 0, 0, 0, 0]));
        assert!(
            matches!(found, Err(LinkError::Damaged(_))),
            "{head:.80}: {found:?}"
        );
    }
    // A claim of many views, points or a long head, and numbers without end.
    let good = format!(r#"{{{RESULT},{steps}}}"#);
    let huge = [0xff; 9];
    for columns in [
        &huge[..],
        &[0xff, 0xff, 0xff, 0x7f],
        &[2, 0, 0],
        &[0x80; 200],
        &[0, 1, 2],
        &[1],
    ] {
        let found = decode(&forged(&good, columns));
        assert!(
            matches!(found, Err(LinkError::Damaged(_))),
            "{columns:?}: {found:?}"
        );
    }
    assert!(decode(&in_link(&huge)).is_err());
    assert!(decode(&in_link(&[])).is_err());
    // Whatever follows a good head.
    for _ in 0..3000 {
        let length = random.between(0.0, 60.0) as usize;
        let bytes: Vec<u8> = (0..length)
            .map(|_| random.between(0.0, 256.0) as u8)
            .collect();
        let small: Vec<u8> = bytes.iter().map(|b| b % 5).collect();
        let _ = decode(&forged(&good, &bytes));
        let _ = decode(&forged(&good, &small));
    }
}

/// 24 kB that inflate to 20 MB.
#[test]
fn a_bomb_is_not_inflated() {
    let mut bomb = Vec::new();
    bomb.write_all(&vec![0; 20 << 20]).unwrap();
    let link = in_link(&bomb);
    assert!(link.len() <= LONGEST, "{}", link.len());
    let refused = decode(&link).unwrap_err();
    assert!(
        refused.to_string().contains("more than any link"),
        "{refused}"
    );
    let long = format!("r1={}", "A".repeat(LONGEST));
    assert_eq!(decode(&long), Err(LinkError::TooLong));
}

/// Markup is text: it comes out as it went in, and the page to print shows it as text.
#[test]
fn markup_in_names_stays_text() {
    let markup = "<img src=x onerror=alert(1)></title><script>alert(2)</script>";
    let mut truth = paper_size(1, 3, &mut Random::seeded(6));
    truth.scan = markup.to_owned();
    truth.views[0].id = markup.to_owned();
    truth.warnings = vec![markup.to_owned()];
    let link = encode(&Settings::default(), Some(&truth)).unwrap();
    assert!(
        link.fragment
            .bytes()
            .all(|b| b.is_ascii_alphanumeric() || b"-_=".contains(&b))
    );
    let result = decode(&link.fragment).unwrap().result.unwrap();
    assert_eq!(result.scan, markup);
    let report = String::from_utf8(result.write(Format::Html).unwrap()).unwrap();
    assert!(!report.contains("<script") && !report.contains("<img"));
    assert!(report.contains("&lt;script&gt;"));
}
