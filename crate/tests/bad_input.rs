//! Everything that can be wrong with a scan archive: each gives a message that names the place, and
//! nothing panics, hangs or takes a gigabyte.
#![allow(
    clippy::disallowed_methods,
    reason = "expectations may come from the platform"
)]

mod common;

use std::io::{Cursor, Write};
use std::process::{Command, Output};
use std::sync::LazyLock;

use common::Random;
use common::archives::{Entries, Folder, measure, measure_with, refusal, scene, simulate};
use image::{DynamicImage, ImageBuffer, ImageFormat, Luma};
use serde_json::{Value, json};
use snellius::export::ReconstructionResult;
use snellius::pipeline::{Settings, observe, reconstruct};
use snellius::scan::{Archive, Manifest, Scan};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

/// A scan with nothing wrong.
static GOOD: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let mut scene = scene();
    scene.sweeps.truncate(2);
    simulate(scene).archive
});

fn good() -> Entries {
    Entries::of(&GOOD)
}

/// The message with which the good scan is refused once its manifest is changed.
#[track_caller]
fn refusal_of(change: impl FnOnce(&mut Value)) -> String {
    refusal(&good().with_manifest(change).zipped())
}

#[track_caller]
fn assert_says(message: &str, parts: &[&str]) {
    for part in parts {
        assert!(
            message.contains(part),
            "\"{part}\" is missing from: {message}"
        );
    }
}

#[test]
fn the_good_scan_is_good() {
    assert!(measure(&GOOD).is_ok());
}

// The archive

#[test]
fn what_is_no_zip_is_said_to_be_none() {
    for bytes in [
        &b""[..],
        b"PK",
        b"{\"format\": \"refractive-scan\"}",
        &[0; 4096],
        b"\x89PNG\r\n\x1a\n",
    ] {
        assert_says(&refusal(bytes), &["not a whole ZIP archive", "scan.json"]);
    }
}

#[test]
fn no_part_of_an_archive_is_taken_for_the_whole() {
    let mut random = Random::seeded(81);
    let mut cuts: Vec<usize> = (0..50)
        .map(|_| random.between(0.0, GOOD.len() as f64) as usize)
        .collect();
    cuts.extend([1, 4, 30, GOOD.len() - 1, GOOD.len() - 22, GOOD.len() - 23]);
    for cut in cuts {
        assert_says(&refusal(&GOOD[..cut]), &["not a whole ZIP archive"]);
    }
}

/// Whatever the bytes, there is an answer: no panic, no endless loop.
#[test]
fn flipped_bytes_are_survived() {
    let mut random = Random::seeded(82);
    let directory = GOOD.len() - 2000;
    for k in 0..120 {
        let mut bytes = GOOD.clone();
        // Half of them in the pictures, half in the manifest and the directory at the end.
        let from = if k % 2 == 0 { 0 } else { directory };
        for _ in 0..3 {
            let at = random.between(from as f64, bytes.len() as f64) as usize;
            bytes[at] ^= 1 << (k % 8);
        }
        if let Err(error) = measure(&bytes) {
            assert!(!error.to_string().is_empty());
        }
    }
}

/// An end record that promises 65,535 entries in a directory of 4 GB, and one with nothing in it.
#[test]
fn a_lying_directory_is_not_believed() {
    let mut end = b"PK\x05\x06\0\0\0\0\xff\xff\xff\xff".to_vec();
    end.extend([0xff; 8]);
    end.extend([0, 0]);
    assert_says(&refusal(&end), &["not a whole ZIP archive"]);
    let empty = ZipWriter::new(Cursor::new(Vec::new()))
        .finish()
        .unwrap()
        .into_inner();
    assert_says(&refusal(&empty), &["no scan.json", "0 entries"]);
}

#[test]
fn an_archive_without_a_manifest_says_what_it_holds() {
    let message = refusal(&good().without("scan.json").zipped());
    assert_says(
        &message,
        &["no scan.json", "20 entries", "images/0000-on.png"],
    );
    let mut two_folders = good();
    two_folders
        .0
        .iter_mut()
        .for_each(|(name, _)| *name = format!("a/{name}"));
    two_folders.0.push(("b/notes.txt".into(), b"mine".to_vec()));
    assert_says(
        &refusal(&two_folders.zipped()),
        &["no scan.json", "only top-level folder"],
    );
}

#[test]
fn an_entry_that_is_not_there_is_named() {
    let message = refusal(&good().without("images/0003-off.png").zipped());
    assert_eq!(message, "views[3].off: no entry \"images/0003-off.png\"");
}

#[test]
fn a_path_that_leaves_the_archive_is_refused() {
    for path in [
        "../secret.png",
        "images/../../x.png",
        "/etc/passwd",
        "C:\\x.png",
        "images\\0000-on.png",
        "",
    ] {
        let message = refusal_of(|scan| scan["views"][2]["on"] = json!(path));
        assert_says(
            &message,
            &["views[2].on", &format!("\"{path}\""), "within the archive"],
        );
    }
    let message = refusal_of(|scan| scan["views"][1]["off"] = json!("a/.."));
    assert_says(&message, &["views[1].off"]);
}

// The manifest

#[test]
fn what_is_no_json_is_placed_by_line_and_column() {
    let with = |text: &str| {
        let mut entries = good();
        *entries.entry("scan.json") = text.as_bytes().to_vec();
        refusal(&entries.zipped())
    };
    assert_says(
        &with("{\n  \"format\": nope\n}"),
        &["scan.json, line 2, column 1"],
    );
    assert_says(&with(""), &["scan.json, line 1"]);
    assert_says(
        &with("{\"format\": \"refractive-scan\""),
        &["scan.json, line 1"],
    );
    assert_says(&with("[]"), &["scan.json"]);
    assert_says(&with("\u{feff}{}"), &["scan.json"]);
    // A thousand open brackets do not overflow the stack.
    assert_says(&with(&"[".repeat(100_000)), &["scan.json"]);
    let text = good().manifest().to_string();
    assert_says(
        &with(&format!("{text} {{}}")),
        &["scan.json, line 1", "trailing"],
    );
    for number in ["NaN", "Infinity", "1e999", "-"] {
        let broken = text.replace(
            "\"wall_thickness\":2.1",
            &format!("\"wall_thickness\":{number}"),
        );
        assert_ne!(broken, text);
        assert_says(&with(&broken), &["scan.json, line 1, column"]);
    }
}

/// Puts a value where a place like `views[3].on` says.
fn put(scan: &mut Value, place: &str, value: Value) {
    let path = place.replace('[', "/").replace(']', "").replace('.', "/");
    let (parent, key) = path.rsplit_once('/').unwrap_or(("", &path));
    let parent = if parent.is_empty() {
        scan
    } else {
        scan.pointer_mut(&format!("/{parent}")).unwrap()
    };
    match key.parse::<usize>() {
        Ok(index) => parent[index] = value,
        Err(_) => parent[key] = value,
    }
}

/// Every place, given its value, is what the refusal begins with.
#[track_caller]
fn assert_each_is_named(cases: impl IntoIterator<Item = (&'static str, Value)>) {
    for (place, value) in cases {
        let message = refusal_of(|scan| put(scan, place, value.clone()));
        assert!(
            message.starts_with(&format!("{place}: ")),
            "{place} = {value}: {message}"
        );
    }
}

#[test]
fn a_value_of_the_wrong_type_is_named() {
    assert_each_is_named([
        ("camera.fx", json!("wide")),
        ("camera.width", json!(-3)),
        ("camera.distortion[1]", json!(null)),
        ("media.inside", json!("water")),
        ("views", json!("all")),
        ("views[3].on", json!(7)),
        ("views[4].world_from_flange.rotation[2]", json!("0")),
    ]);
    // A list that is too short is named by itself or by its first missing number.
    for (place, value) in [
        ("laser.origin", json!([1, 2])),
        ("laser.direction", json!({"x": 1})),
        ("views[4].world_from_flange.rotation", json!([1, 0, 0])),
    ] {
        let message = refusal_of(|scan| put(scan, place, value));
        assert!(message.starts_with(place), "{place}: {message}");
    }
}

#[test]
fn a_missing_key_is_named_with_its_place() {
    let cases: [(&[&str], &[&str]); 7] = [
        (
            &[],
            &[
                "camera",
                "views",
                "media",
                "laser",
                "vessel",
                "format",
                "version",
                "length_unit",
                "flange_from_camera",
            ],
        ),
        (
            &["camera"],
            &["model", "width", "height", "fx", "fy", "cx", "cy"],
        ),
        (&["laser"], &["kind", "origin", "direction"]),
        (&["media"], &["outside", "wall", "inside"]),
        (&["vessel"], &["shape", "wall_thickness"]),
        (&["views", "1"], &["id", "on", "world_from_flange"]),
        (
            &["views", "1", "world_from_flange"],
            &["rotation", "translation"],
        ),
    ];
    for (path, keys) in cases {
        for key in keys {
            let message = refusal_of(|scan| {
                let entry = path
                    .iter()
                    .fold(scan, |entry, step| match step.parse::<usize>() {
                        Ok(index) => &mut entry[index],
                        Err(_) => &mut entry[*step],
                    });
                entry
                    .as_object_mut()
                    .unwrap()
                    .remove(*key)
                    .expect("the good scan has it");
            });
            let place = path.join(".").replace(".1", "[1]");
            assert_says(&message, &[&place, key, "missing"]);
        }
    }
}

#[test]
fn an_impossible_value_is_named() {
    assert_each_is_named([
        ("format", json!("point-cloud")),
        ("version", json!(2)),
        ("length_unit", json!("inch")),
        ("camera.model", json!("fisheye")),
        ("camera.fx", json!(0)),
        ("camera.fy", json!(-480)),
        ("camera.width", json!(0)),
        ("camera.distortion", json!([0.1, 0.2])),
        // A lens that folds the picture's corners.
        ("camera.distortion", json!([-9, 0, 0, 0])),
        ("laser.kind", json!("maser")),
        ("laser.direction", json!([0, 0, 0])),
        // A beam through the camera's centre makes no triangle.
        ("laser.origin", json!([0, 0, 0])),
        ("flange_from_camera.rotation", json!([0, 0, 0, 0])),
        ("views[2].world_from_flange.rotation", json!([0, 0, 0, 0])),
        ("media.outside", json!(0.5)),
        ("media.wall", json!(-1.5)),
        ("media.inside", json!(133)),
        ("vessel.shape", json!("cube")),
        ("vessel.wall_thickness", json!(0)),
        ("views", json!([])),
        ("views[3].id", json!("0001")),
        ("views[1].inside", json!("vacuum")),
    ]);
    for (place, key, value) in [
        // A line laser needs its sheet's normal.
        ("laser.normal: missing", "origin", json!([-160, 3, 4])),
        ("laser.normal", "normal", json!([0, 0, 0])),
        // A sheet through the camera's centre makes no triangle, wherever its rays start.
        ("laser.origin", "normal", json!([3, 160, 0])),
    ] {
        let message = refusal_of(|scan| {
            scan["laser"]["kind"] = json!("line");
            scan["laser"][key] = value;
        });
        assert!(message.starts_with(place), "{place}: {message}");
    }
    let half_a_wall = refusal_of(|scan| put(scan, "vessel.point", json!([0, 0, 0])));
    assert_says(&half_a_wall, &["vessel.normal: missing"]);
    let negative = refusal_of(|scan| put(scan, "calibration_sigma", json!({"laser_origin": -1})));
    assert_says(&negative, &["calibration_sigma.laser_origin: -1"]);
    let unknown = refusal_of(|scan| put(scan, "known", json!([{"kind": "colour"}])));
    assert_says(&unknown, &["known[0].kind: "]);
}

#[test]
fn an_index_that_nobody_knows_and_the_scan_cannot_tell_is_not_made_up() {
    let unknown = good()
        .with_manifest(|scan| scan["media"]["inside"] = json!(null))
        .zipped();
    let inside = measure(&unknown).unwrap().media.inside;
    assert_eq!(inside.value, None);
    assert_says(&inside.reason.unwrap(), &["standard deviation"]);
    let given = |index| {
        measure_with(
            &unknown,
            &Settings {
                index: Some(index),
                ..Settings::default()
            },
        )
    };
    assert_eq!(given(1.33).unwrap().media.inside.value, Some(1.33));
    for absurd in [0.0, -1.33, 0.99, 4.01, 1e300, f64::NAN, f64::INFINITY] {
        assert_says(
            &given(absurd).unwrap_err().to_string(),
            &["refractive index", "between 1 and 4"],
        );
    }
}

/// Any number may be any number, whatever the vessel: there is a result without NaN, or an error, and never
/// a panic.
#[test]
fn extreme_numbers_are_survived() {
    let mut archive = Archive::open(Cursor::new(&GOOD[..])).unwrap();
    let settings = Settings::default();
    let spots: Vec<_> = (0..10)
        .map(|view| observe(&mut archive, view, &settings).unwrap())
        .collect();
    let vessels = [
        json!({ "shape": "plane", "wall_thickness": 2.1 }),
        json!({ "shape": "plane", "wall_thickness": 2.1, "far_wall": { "distance": 200, "thickness": 2.1 } }),
        json!({ "shape": "plane", "wall_thickness": 2.1, "point": [1, 2, 3], "normal": [0.03, 0.02, -1] }),
        json!({ "shape": "cylinder", "wall_thickness": 2.1, "axis_point": [1, 2, 900], "axis": [0.1, 1, 0.2], "radius": 900 }),
        json!({ "shape": "sphere", "wall_thickness": 2.1, "center": [1, 2, 900], "radius": 900 }),
        json!({ "shape": "auto", "wall_thickness": 2.1 }),
        json!({ "shape": "freeform", "wall_thickness": 2.1 }),
    ];
    let mut measured = 0;
    for (k, vessel) in vessels.into_iter().enumerate() {
        let mut manifest = good().manifest();
        manifest["vessel"] = vessel;
        let mut paths = Vec::new();
        numbers("", &manifest, &mut paths);
        // Two views stand for all, and one vessel for all where the vessel is not concerned.
        let views = ["/views/0/", "/views/7/"];
        paths.retain(|path| {
            path.starts_with("/vessel/")
                || k == 0
                    && (!path.starts_with("/views/") || views.iter().any(|v| path.starts_with(v)))
        });
        for path in paths {
            for extreme in [0.0, -1.0, 1e-300, 1e9, 1e150, -1e150, 1e300, f64::MAX] {
                let mut changed = manifest.clone();
                *changed.pointer_mut(&path).unwrap() = json!(extreme);
                let text = changed.to_string();
                let Ok(scan) = Manifest::from_json(text.as_bytes()).and_then(Scan::new) else {
                    continue;
                };
                let Ok(reconstruction) = reconstruct(&scan, &spots, &settings) else {
                    continue;
                };
                measured += 1;
                let json = reconstruction.result().to_json();
                // serde_json writes what is no number as null, which no coordinate may be.
                let read: Result<ReconstructionResult, _> = serde_json::from_str(&json);
                assert!(
                    read.is_ok(),
                    "{path} = {extreme:e} in {}: {read:?}",
                    manifest["vessel"]
                );
            }
        }
    }
    assert!(
        measured > 100,
        "{measured} of them are measured all the same"
    );
}

/// The places of all numbers, as JSON pointers.
fn numbers(at: &str, value: &Value, found: &mut Vec<String>) {
    match value {
        Value::Number(_) => found.push(at.to_owned()),
        Value::Array(list) => {
            for (i, value) in list.iter().enumerate() {
                numbers(&format!("{at}/{i}"), value, found);
            }
        }
        Value::Object(map) => {
            for (key, value) in map {
                numbers(&format!("{at}/{key}"), value, found);
            }
        }
        _ => {}
    }
}

#[test]
fn unknown_keys_are_kept_and_warned_of() {
    let mut entries = good().with_manifest(|scan| {
        scan["operator"] = json!({"name": "Willebrord", "years": [1580, 1626]});
        scan["camera"]["serial"] = json!("A-7");
        scan["vessel"]["made_of"] = json!("glass");
        scan["views"][2]["note"] = json!("blurred?");
        scan["views"][2]["world_from_flange"]["stamp"] = json!(3.5);
    });
    let result = measure(&entries.zipped()).unwrap();
    for key in [
        "operator",
        "camera.serial",
        "vessel.made_of",
        "views[2].note",
        "views[2].world_from_flange.stamp",
    ] {
        let warned = result
            .warnings
            .iter()
            .any(|w| w.starts_with(&format!("{key}: ")));
        assert!(warned, "{key}: {:?}", result.warnings);
    }
    let text = entries.manifest();
    let manifest = Manifest::from_json(text.to_string().as_bytes()).unwrap();
    assert_eq!(
        serde_json::to_value(&manifest).unwrap(),
        text,
        "there and back"
    );
}

// The pictures

fn encoded(width: u32, height: u32, format: ImageFormat) -> Vec<u8> {
    let image = ImageBuffer::from_fn(width, height, |x, y| Luma([(x ^ y) as u8]));
    let mut file = Cursor::new(Vec::new());
    DynamicImage::from(image)
        .write_to(&mut file, format)
        .unwrap();
    file.into_inner()
}

#[track_caller]
fn refusal_of_picture(bytes: Vec<u8>) -> String {
    let mut entries = good();
    *entries.entry("images/0002-off.png") = bytes;
    let message = refusal(&entries.zipped());
    assert_says(&message, &["views[2].off", "\"images/0002-off.png\""]);
    message
}

#[test]
fn a_picture_of_another_size_is_named_with_both_sizes() {
    for (width, height) in [(319, 240), (240, 320), (1, 1), (640, 480)] {
        let message = refusal_of_picture(encoded(width, height, ImageFormat::Png));
        assert_says(&message, &[&format!("{width} x {height}"), "320 x 240"]);
    }
}

#[test]
fn a_broken_picture_is_named() {
    for format in [
        ImageFormat::Png,
        ImageFormat::Tiff,
        ImageFormat::WebP,
        ImageFormat::Bmp,
    ] {
        let whole = encoded(320, 240, format);
        for part in [1, 9, 40] {
            refusal_of_picture(whole[..whole.len() * part / 41].to_vec());
        }
    }
    for bytes in [
        &b""[..],
        b"not a picture at all",
        b"\x89PNG\r\n\x1a\n",
        b"GIF89a\x40\x01\xf0\0\0\0\0;",
    ] {
        assert_says(
            &refusal_of_picture(bytes.to_vec()),
            &["PNG, TIFF, JPEG, WebP or BMP"],
        );
    }
    let mut flipped = encoded(320, 240, ImageFormat::Png);
    let middle = flipped.len() / 2;
    flipped[middle] ^= 0x55;
    refusal_of_picture(flipped);
}

/// Every kind of picture that the format allows is read as the same grey values.
#[test]
fn every_lossless_kind_of_picture_is_read() {
    let expected = measure(&GOOD).unwrap().to_json();
    for format in [ImageFormat::Tiff, ImageFormat::WebP, ImageFormat::Bmp] {
        let mut entries = good();
        for (name, bytes) in &mut entries.0 {
            if name.ends_with(".png") {
                let picture = image::load_from_memory(bytes).unwrap();
                let picture = if format == ImageFormat::WebP {
                    picture.to_rgb8().into()
                } else {
                    picture
                };
                let mut file = Cursor::new(Vec::new());
                picture.write_to(&mut file, format).unwrap();
                *bytes = file.into_inner();
            }
        }
        assert_eq!(
            measure(&entries.zipped()).unwrap().to_json(),
            expected,
            "{format:?}"
        );
    }
}

#[test]
fn a_scan_without_any_spot_says_so() {
    let mut entries = good();
    for view in 0..10 {
        let dark = entries.entry(&format!("images/{view:04}-off.png")).clone();
        *entries.entry(&format!("images/{view:04}-on.png")) = dark;
    }
    assert_says(
        &refusal(&entries.zipped()),
        &["no laser spot in any of the 10 views", "laser was on"],
    );
}

#[test]
fn exchanged_pictures_give_no_spots() {
    let message = refusal_of(|scan| {
        for view in scan["views"].as_array_mut().unwrap() {
            let on = view["on"].take();
            view["on"] = view["off"].take();
            view["off"] = on;
        }
    });
    assert_says(&message, &["exchanged"]);
}

// Sizes. The program is given 1 GiB of address space in all and must answer in words.

/// A PNG whose header claims a size, with hardly any data behind it.
fn claiming(width: u32, height: u32) -> Vec<u8> {
    let mut png = b"\x89PNG\r\n\x1a\n".to_vec();
    let mut header = width.to_be_bytes().to_vec();
    header.extend(height.to_be_bytes());
    header.extend([8, 0, 0, 0, 0]);
    for (kind, data) in [
        (b"IHDR", &header[..]),
        (b"IDAT", b"\x78\x9c\x03\0\0\0\0\x01"),
        (b"IEND", b""),
    ] {
        png.extend((data.len() as u32).to_be_bytes());
        let start = png.len();
        png.extend(kind);
        png.extend(data);
        png.extend(crc32(&png[start..]).to_be_bytes());
    }
    png
}

/// ISO 3309, as PNG and ZIP use it.
fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32, _| (crc >> 1) ^ if crc & 1 == 1 { 0xEDB8_8320 } else { 0 };
    !bytes
        .iter()
        .fold(!0, |crc, byte| (0..8).fold(crc ^ u32::from(*byte), step))
}

/// Runs `snellius reconstruct` on an archive within 1 GiB.
fn reconstruct_within_1_gib(archive: &[u8]) -> Output {
    let folder = Folder::new();
    let scan = folder.write("scan.zip", archive);
    let program = env!("CARGO_BIN_EXE_snellius");
    let mut command = if cfg!(target_os = "linux") {
        let mut shell = Command::new("sh");
        shell.args(["-c", "ulimit -v 1048576 && exec \"$0\" \"$@\"", program]);
        shell
    } else {
        Command::new(program)
    };
    let command = command
        .arg("reconstruct")
        .arg(scan)
        .args(["--jobs", "2", "--output"]);
    command.arg(folder.path("out")).output().unwrap()
}

#[track_caller]
fn assert_refused_within_1_gib(archive: &[u8], parts: &[&str]) {
    let output = reconstruct_within_1_gib(archive);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert_says(&said, parts);
}

#[test]
fn a_picture_that_claims_to_be_gigantic_is_not_believed() {
    let mut entries = good();
    *entries.entry("images/0001-on.png") = claiming(60_000, 60_000);
    assert_refused_within_1_gib(
        &entries.zipped(),
        &["views[1].on", "60000 x 60000", "320 x 240"],
    );
    let agreeing = entries.with_manifest(|scan| {
        scan["camera"]["width"] = json!(60_000);
        scan["camera"]["height"] = json!(60_000);
    });
    assert_refused_within_1_gib(&agreeing.zipped(), &["camera.width", "60000 x 60000"]);
}

/// Just within what may be measured, but with nothing behind the header.
#[test]
fn a_large_picture_without_data_is_named() {
    let mut entries = good().with_manifest(|scan| {
        scan["camera"] = json!({ "model": "opencv", "width": 7000, "height": 7000,
            "fx": 9000, "fy": 9000, "cx": 3500, "cy": 3500 });
    });
    for (name, bytes) in &mut entries.0 {
        if name.ends_with(".png") {
            *bytes = claiming(7000, 7000);
        }
    }
    assert_refused_within_1_gib(&entries.zipped(), &["views[", "images/"]);
}

/// 1.25 GiB of zeros in little more than a megabyte.
static BOMB: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let deflated = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    zip.start_file("bomb", deflated).unwrap();
    let zeros = vec![0; 1 << 20];
    (0..1280).for_each(|_| zip.write_all(&zeros).unwrap());
    zip.finish().unwrap().into_inner()
});

/// The good scan with the bomb for an entry, whose size the headers say to be `claimed`.
fn with_bomb(name: &str, claimed: Option<u32>) -> Vec<u8> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    let mut bomb = zip::ZipArchive::new(Cursor::new(&BOMB[..])).unwrap();
    zip.raw_copy_file_rename(bomb.by_index(0).unwrap(), name)
        .unwrap();
    for (other, bytes) in good().without(name).0 {
        zip.start_file(other, SimpleFileOptions::default()).unwrap();
        zip.write_all(&bytes).unwrap();
    }
    let mut bytes = zip.finish().unwrap().into_inner();
    let truth = (1280_u32 << 20).to_le_bytes();
    if let Some(claimed) = claimed {
        let places: Vec<usize> = bytes
            .windows(4)
            .enumerate()
            .filter(|(_, w)| *w == truth)
            .map(|(i, _)| i)
            .collect();
        assert!(!places.is_empty(), "the size stands in the headers");
        for at in places {
            bytes[at..at + 4].copy_from_slice(&claimed.to_le_bytes());
        }
    }
    bytes
}

#[test]
fn an_entry_that_inflates_without_end_is_stopped() {
    let picture = "images/0000-on.png";
    assert_refused_within_1_gib(
        &with_bomb(picture, None),
        &["views[0].on", picture, "larger than 256 MB"],
    );
    assert_refused_within_1_gib(&with_bomb(picture, Some(5000)), &["views[0].on", picture]);
    assert_refused_within_1_gib(&with_bomb("scan.json", Some(5000)), &["scan.json"]);
    assert_refused_within_1_gib(
        &with_bomb("scan.json", None),
        &["scan.json", "larger than 64 MB"],
    );
}
