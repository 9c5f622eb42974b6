//! The companion program, as a user or a script calls it.
#![allow(
    clippy::disallowed_methods,
    reason = "expectations may come from the platform"
)]

mod common;

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};

use common::archives::{Entries, Folder, measure, repository, scene, simulate};
use serde_json::{Value, json};
use snellius::scan::Archive;

fn snellius(arguments: &[impl AsRef<OsStr>]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_snellius"))
        .args(arguments)
        .output()
        .unwrap()
}

fn said(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

#[track_caller]
fn assert_ends_with(output: &Output, code: i32) -> String {
    let error = said(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{error}");
    error
}

/// The scan of a small scene: two rows, ten views.
fn small_scan() -> Vec<u8> {
    let mut scene = scene();
    scene.sweeps.truncate(2);
    simulate(scene).archive
}

#[test]
fn index_says_what_a_scan_cannot_tell_and_draws_the_curves() {
    let (folder, scan) = (Folder::new(), small_scan());
    let scan = folder.write("scan.zip", &scan);
    let curves = folder.path("curves");
    let arguments = ["index".into(), scan, "--output".into(), curves.clone()];
    let done = snellius(&arguments);
    assert_ends_with(&done, 0);
    let table = said(&done.stdout);
    for part in [
        "ray-distance",
        "not-determined",
        "(D1)",
        "remedy: pitch",
        "water",
    ] {
        assert!(table.contains(part), "{part}: {table}");
    }
    let csv = fs::read_to_string(curves.join("ray-distance-plain.csv")).unwrap();
    assert_eq!(csv.lines().count(), 202);
    let svg = fs::read_to_string(curves.join("ray-distance-plain.svg")).unwrap();
    assert!(svg.starts_with("<svg") && svg.contains("class=\"line-curve\""));
}

/// Whoever asks for a method by name and gets no answer is told so by the exit code; the files are written.
#[test]
fn an_index_that_was_asked_for_and_is_not_determined_ends_with_1() {
    let (folder, scan) = (Folder::new(), small_scan());
    let scan = folder.write("scan.zip", &scan);
    let output = folder.path("out");
    let arguments = [
        "reconstruct".into(),
        scan,
        "--index".into(),
        "ray-distance".into(),
        "--output".into(),
        output.clone(),
    ];
    let error = assert_ends_with(&snellius(&arguments), 1);
    assert!(error.contains("not determined by ray-distance"), "{error}");
    let result = fs::read_to_string(output.join("result.json")).unwrap();
    let result: Value = serde_json::from_str(&result).unwrap();
    assert!(result["media"]["inside"]["value"].is_null());
}

#[test]
fn reconstruct_writes_four_files_and_says_what_it_found() {
    let (folder, scan) = (Folder::new(), small_scan());
    let output = folder.path("new/out put");
    let arguments = [
        "reconstruct".into(),
        folder.write("sc\u{e4}n 1.zip", &scan),
        "--output".into(),
        output.clone(),
    ];
    let done = snellius(&arguments);
    let summary = assert_ends_with(&done, 0);
    assert!(done.stdout.is_empty(), "results go to files");
    for part in ["A box in a tank", "10 of 10", "vessel", "ray distance"] {
        assert!(summary.contains(part), "{part}: {summary}");
    }
    let read = |name: &str| fs::read_to_string(output.join(name)).unwrap();
    assert_eq!(fs::read_dir(&output).unwrap().count(), 4);
    let result = measure(&scan).unwrap();
    assert_eq!(read("result.json"), result.to_json(), "the library's bytes");

    // What other programs read: the PLY header's counts and columns, one CSV line a view.
    for (name, count, columns) in [("object.ply", 10, 9), ("vessel.ply", 10, 3)] {
        let ply = read(name);
        let (header, body) = ply.split_once("end_header\n").unwrap();
        assert!(header.starts_with("ply\nformat ascii 1.0\n"), "{header}");
        assert!(
            header.contains(&format!("element vertex {count}\n")),
            "{header}"
        );
        assert_eq!(header.matches("\nproperty ").count(), columns);
        assert_eq!(body.lines().count(), count);
        assert!(
            body.lines().all(
                |line| line.split(' ').filter(|n| n.parse::<f64>().is_ok()).count() == columns
            )
        );
    }
    let table = read("points.csv");
    let lines: Vec<&str> = table.split_terminator("\r\n").collect();
    assert_eq!(lines.len(), 11);
    assert!(lines.iter().all(|line| line.split(',').count() == 15));
    let place = result.views[3].object.first().unwrap();
    assert!(lines[4].starts_with("0003,ok,"), "{}", lines[4]);
    assert!(lines[4].contains(&format!(",{},{},{},", place[0], place[1], place[2])));
}

#[test]
fn formats_are_written_as_asked_from_a_scan_and_from_its_result_alike() {
    let folder = Folder::new();
    let scan = folder.write("scan.zip", &small_scan());
    let (from_scan, from_result) = (folder.path("scan"), folder.path("result"));
    let run = |command: &str, input: &std::path::Path, formats: &str, output: &std::path::Path| {
        snellius(&[
            OsStr::new(command),
            input.as_ref(),
            "--formats".as_ref(),
            formats.as_ref(),
            "--output".as_ref(),
            output.as_ref(),
        ])
    };
    let formats = "json,las,e57,glb,html";
    let names = [
        "result.json",
        "object.las",
        "object.e57",
        "scene.glb",
        "report.html",
    ];
    assert_ends_with(&run("reconstruct", &scan, formats, &from_scan), 0);
    let result = from_scan.join("result.json");
    assert_ends_with(&run("export", &result, formats, &from_result), 0);
    for directory in [&from_scan, &from_result] {
        assert_eq!(fs::read_dir(directory).unwrap().count(), names.len());
    }
    for name in names {
        let read = |directory: &std::path::Path| fs::read(directory.join(name)).unwrap();
        assert!(read(&from_scan) == read(&from_result), "{name} differs");
    }

    let wrong = assert_ends_with(&run("export", &result, "docx", &from_result), 2);
    assert!(
        wrong.contains("docx") && wrong.contains("vessel-ply"),
        "{wrong}"
    );
    let archive = assert_ends_with(&run("export", &scan, "las", &from_result), 1);
    assert!(archive.contains("snellius reconstruct"), "{archive}");
    let broken = folder.write(
        "broken.json",
        br#"{"format":"refractive-reconstruction","version":"1"}"#,
    );
    let broken = assert_ends_with(&run("export", &broken, "las", &from_result), 1);
    assert!(broken.contains("broken.json: version: "), "{broken}");
}

/// Where there is no object there is no surface of it.
#[test]
fn a_format_that_cannot_hold_the_result_takes_nothing_from_the_others() {
    let folder = Folder::new();
    let mut scene = scene();
    scene.sweeps.truncate(2);
    scene.objects.clear();
    let scan = folder.write("scan.zip", &simulate(scene).archive);
    let reconstruct = |formats: &str, output: &std::path::Path| {
        snellius(&[
            OsStr::new("reconstruct"),
            scan.as_ref(),
            "--formats".as_ref(),
            formats.as_ref(),
            "--output".as_ref(),
            output.as_ref(),
        ])
    };
    let (all, named) = (folder.path("all"), folder.path("named"));
    let note = assert_ends_with(&reconstruct("all", &all), 0);
    for name in ["surface.stl is left out: ", "surface.obj is left out: "] {
        assert!(note.contains(name), "{note}");
    }
    for name in ["result.json", "object.pcd", "scene.glb", "report.html"] {
        assert!(all.join(name).is_file(), "{name}: {note}");
    }
    assert!(!all.join("surface.stl").exists());

    let error = assert_ends_with(&reconstruct("stl,json", &named), 1);
    assert!(
        error.contains("surface.stl: the object's points"),
        "{error}"
    );
    assert!(named.join("result.json").is_file(), "{error}");
}

#[test]
fn one_thread_or_many_write_the_same_bytes() {
    let folder = Folder::new();
    let scan = folder.write("scan.zip", &small_scan());
    let files: Vec<_> = ["1", "2", "7", "0"]
        .iter()
        .map(|jobs| {
            let output = folder.path(jobs);
            let arguments = [
                OsStr::new("reconstruct"),
                scan.as_ref(),
                "--jobs".as_ref(),
                jobs.as_ref(),
                "-o".as_ref(),
                output.as_ref(),
            ];
            assert_ends_with(&snellius(&arguments), 0);
            ["result.json", "object.ply", "vessel.ply", "points.csv"]
                .map(|name| fs::read(output.join(name)).unwrap())
        })
        .collect();
    assert!(files.iter().all(|other| *other == files[0]));
}

#[test]
fn an_input_at_fault_ends_with_1_and_names_file_and_place() {
    let folder = Folder::new();
    let output = folder.path("out");
    let run = |scan: &std::path::Path, output: &std::path::Path| {
        snellius(&[
            "reconstruct".as_ref(),
            scan.as_os_str(),
            "--output".as_ref(),
            output.as_os_str(),
        ])
    };
    let missing = folder.path("missing.zip");
    assert!(assert_ends_with(&run(&missing, &output), 1).contains("missing.zip"));
    let broken = Entries::of(&small_scan())
        .with_manifest(|scan| scan["views"][3]["on"] = json!("nowhere.png"));
    let broken = folder.write("broken.zip", &broken.zipped());
    let error = assert_ends_with(&run(&broken, &output), 1);
    assert!(
        error.starts_with("error: ")
            && error.contains("broken.zip: views[3].on: no entry \"nowhere.png\""),
        "{error}"
    );
    assert_eq!(error.lines().count(), 1, "{error}");
    assert!(
        !output.exists(),
        "nothing is written where nothing was measured"
    );
    let in_the_way = folder.write("file", b"");
    let scan = folder.write("scan.zip", &small_scan());
    assert!(assert_ends_with(&run(&scan, &in_the_way), 1).contains("file"));
    let no_scene = folder.write("scene.toml", b"name = \"half a scene\"");
    let simulated = snellius(&[
        "simulate".as_ref(),
        no_scene.as_os_str(),
        "-o".as_ref(),
        output.as_os_str(),
    ]);
    assert!(assert_ends_with(&simulated, 1).contains("scene.toml"));
}

/// Whichever thread fails first, the first view at fault is the one that is named.
#[test]
fn of_several_faults_the_first_is_told() {
    let folder = Folder::new();
    let mut entries = Entries::of(&small_scan());
    for view in 2..10 {
        *entries.entry(&format!("images/{view:04}-off.png")) = b"no picture".to_vec();
    }
    let scan = folder.write("scan.zip", &entries.zipped());
    let output = folder.path("out");
    for _ in 0..8 {
        let arguments = [
            "reconstruct".as_ref(),
            scan.as_os_str(),
            "--jobs".as_ref(),
            "4".as_ref(),
            "-o".as_ref(),
            output.as_os_str(),
        ];
        let error = assert_ends_with(&snellius(&arguments), 1);
        assert!(error.contains("views[2].off"), "{error}");
    }
}

#[test]
fn a_wrong_call_ends_with_2() {
    for call in [
        &[][..],
        &["measure"],
        &["reconstruct"],
        &["reconstruct", "x.zip"],
        &["check"],
        &["schema", "picture"],
        &["reconstruct", "x.zip", "-o", "out", "--jobs", "many"],
        &["check", "--loud", "x.zip"],
    ] {
        let error = assert_ends_with(&snellius(call), 2);
        assert!(error.contains("--help"), "{call:?}: {error}");
    }
    for call in [["--help"], ["--version"]] {
        assert_ends_with(&snellius(&call), 0);
    }
}

#[test]
fn check_says_what_is_in_a_scan_and_what_looks_wrong() {
    let folder = Folder::new();
    let good = folder.write("good.zip", &small_scan());
    let report = snellius(&["check".as_ref(), good.as_os_str()]);
    assert_ends_with(&report, 0);
    let report = said(&report.stdout);
    for part in [
        "A box in a tank",
        "10",
        "2 sweeps",
        "320 x 240",
        "wall 2.1 mm",
        "1.33 inside",
        "nothing looks wrong",
    ] {
        assert!(report.contains(part), "{part}: {report}");
    }
    // The pictures of one view are exchanged, another has no laser-off picture, a key is misspelt.
    let odd = Entries::of(&small_scan()).with_manifest(|scan| {
        scan["views"][1]["on"] = scan["views"][1]["off"].clone();
        scan["views"][2].as_object_mut().unwrap().remove("off");
        scan["vessel"]["wall_thicknes"] = json!(3);
    });
    let odd = folder.write("odd.zip", &odd.zipped());
    let report = snellius(&["check".as_ref(), odd.as_os_str()]);
    assert_ends_with(&report, 0);
    let report = said(&report.stdout);
    for part in [
        "looks wrong: no laser spot in 1 view: 0001",
        "vessel.wall_thicknes",
        "without a laser-off picture",
        "0002",
    ] {
        assert!(report.contains(part), "{part}: {report}");
    }
    let broken = folder.write("broken.zip", b"PK");
    assert!(
        assert_ends_with(&snellius(&["check".as_ref(), broken.as_os_str()]), 1)
            .contains("broken.zip")
    );
}

/// The archive beside a scene is the one that the scene makes.
#[test]
fn the_samples_are_made_from_their_scenes() {
    let folder = Folder::new();
    let mut scenes = 0;
    for scene in fs::read_dir(repository("samples/scenes")).unwrap() {
        let scene = scene.unwrap().path();
        let name = scene.file_stem().unwrap().to_str().unwrap();
        let made = folder.path(&format!("{name}.zip"));
        let arguments = [
            "simulate".as_ref(),
            scene.as_os_str(),
            "--output".as_ref(),
            made.as_os_str(),
        ];
        assert_ends_with(&snellius(&arguments), 0);
        let kept = fs::read(repository(&format!("samples/{name}.zip"))).unwrap();
        let same = fs::read(made).unwrap() == kept;
        assert!(
            same,
            "samples/{name}.zip is stale: make it again as samples/README.md says"
        );
        assert!(kept.len() < 4 << 20, "{name} is small enough for the page");
        let truth = fs::read(folder.path(&format!("{name}.truth.json"))).unwrap();
        let truth: Value = serde_json::from_slice(&truth).unwrap();
        let views = Entries::of(&kept).manifest()["views"]
            .as_array()
            .unwrap()
            .len();
        assert_eq!(truth["views"].as_array().unwrap().len(), views, "{name}");
        scenes += 1;
    }
    assert!(scenes >= 1);
}

#[test]
fn scans_and_results_are_what_the_schemas_say() {
    let schema = |which: &str| -> Value {
        let printed = snellius(&["schema", which]);
        assert_ends_with(&printed, 0);
        serde_json::from_slice(&printed.stdout).unwrap()
    };
    let (scan_schema, result_schema) = (schema("scan"), schema("result"));
    let both: Value = serde_json::from_slice(&snellius(&["schema"]).stdout).unwrap();
    assert_eq!(
        both,
        json!({ "scan": scan_schema, "result": result_schema, "settings": schema("settings") })
    );

    let sample = fs::read(repository("samples/tank-paper.zip")).unwrap();
    let manifest = Entries::of(&sample).manifest();
    let result: Value = serde_json::from_str(&measure(&sample).unwrap().to_json()).unwrap();
    assert_eq!(problems(&scan_schema, &manifest), Vec::<String>::new());
    assert_eq!(problems(&result_schema, &result), Vec::<String>::new());

    // And they say no to what is none.
    let change = |document: &Value, place: &str, to: Value| {
        let mut changed = document.clone();
        *changed.pointer_mut(place).unwrap() = to;
        changed
    };
    for (place, to) in [
        ("/camera/fx", json!("wide")),
        ("/format", json!("other")),
        ("/views/3/inside", json!("mud")),
        ("/laser/origin", json!([1, 2])),
        ("/media", json!({ "outside": 1 })),
        ("/views/0/on", json!(null)),
    ] {
        assert_ne!(
            problems(&scan_schema, &change(&manifest, place, to)),
            Vec::<String>::new(),
            "{place}"
        );
    }
    for (place, to) in [
        ("/version", json!("1")),
        ("/views/0/object", json!([1, 2])),
        ("/views/0/status", json!("fine")),
        ("/vessel/shape", json!("cube")),
        ("/media/inside", json!(1.33)),
    ] {
        assert_ne!(
            problems(&result_schema, &change(&result, place, to)),
            Vec::<String>::new(),
            "{place}"
        );
    }
}

/// What of a document breaks its schema. Knows the part of JSON Schema 2020-12 that our schemas use, and
/// panics at any other keyword.
fn problems(schema: &Value, document: &Value) -> Vec<String> {
    check(schema, schema, document, "$")
}

fn check(root: &Value, schema: &Value, value: &Value, at: &str) -> Vec<String> {
    let Some(rules) = schema.as_object() else {
        assert_eq!(*schema, json!(true), "a schema is an object or true");
        return Vec::new();
    };
    let broken = |(keyword, rule): (&String, &Value)| check_rule(root, keyword, rule, value, at);
    rules.iter().flat_map(broken).collect()
}

fn check_rule(root: &Value, keyword: &str, rule: &Value, value: &Value, at: &str) -> Vec<String> {
    let all = || rule.as_array().unwrap().iter();
    let fits = |schema: &Value| check(root, schema, value, at).is_empty();
    let limit = || rule.as_u64().unwrap() as usize;
    let holds = match keyword {
        "$schema" | "$defs" | "title" | "description" | "default" | "format" => true,
        "type" if rule.is_array() => all().any(|name| is_of_type(value, name)),
        "type" => is_of_type(value, rule),
        "const" => value == rule,
        "enum" => all().any(|one| one == value),
        "anyOf" => all().any(fits),
        "oneOf" => all().filter(|one| fits(one)).count() == 1,
        "minimum" => value.as_f64().is_none_or(|n| n >= rule.as_f64().unwrap()),
        "minItems" => value.as_array().is_none_or(|list| list.len() >= limit()),
        "maxItems" => value.as_array().is_none_or(|list| list.len() <= limit()),
        "required" => {
            !value.is_object() || all().all(|key| value.get(key.as_str().unwrap()).is_some())
        }
        "additionalProperties" => *rule == json!(true),
        "$ref" => {
            let target = rule.as_str().unwrap().trim_start_matches('#');
            return check(root, root.pointer(target).unwrap(), value, at);
        }
        "items" => {
            let items = value.as_array().into_iter().flatten().enumerate();
            return items
                .flat_map(|(i, item)| check(root, rule, item, &format!("{at}[{i}]")))
                .collect();
        }
        "properties" => {
            let known = rule.as_object().unwrap().iter();
            let given = known.filter_map(|(key, rule)| Some((key, rule, value.get(key)?)));
            return given
                .flat_map(|(key, rule, inner)| check(root, rule, inner, &format!("{at}.{key}")))
                .collect();
        }
        other => panic!("this test does not know the keyword {other}: teach it"),
    };
    if holds {
        Vec::new()
    } else {
        vec![format!("{at}: {keyword}")]
    }
}

fn is_of_type(value: &Value, name: &Value) -> bool {
    match name.as_str().unwrap() {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "number" => value.is_number(),
        "integer" => value.is_i64() || value.is_u64(),
        "null" => value.is_null(),
        other => panic!("type {other}"),
    }
}

/// `snellius schema | head -1`: the reader has had enough, and that is no fault.
#[test]
fn a_scan_is_repeated_with_views_and_pictures_of_their_own() {
    let folder = Folder::new();
    let faces = json!([{ "kind": "flatness", "views": [["0000", "0001", "0002"]] }]);
    let small = Entries::of(&small_scan()).with_manifest(|m| m["known"] = faces);
    let scan = folder.write("scan.zip", &small.zipped());
    let large = folder.path("large.zip");
    // Ten views of two pictures with 320 x 240 bytes: two repeats are a little more than that.
    let mut arguments: Vec<PathBuf> = vec!["repeat".into(), scan.clone()];
    arguments.extend([
        "--size".into(),
        "3M".into(),
        "--output".into(),
        large.clone(),
    ]);
    assert_ends_with(&snellius(&arguments), 0);

    let open = |path: &PathBuf| Archive::open(fs::File::open(path).unwrap()).unwrap();
    let (mut scan, mut large) = (open(&scan), open(&large));
    let (once, twice) = (scan.scan().manifest.clone(), large.scan().manifest.clone());
    assert_eq!((once.views.len(), twice.views.len()), (10, 20));
    for (index, view) in twice.views.iter().enumerate() {
        let (repeat, of) = (index / 10, index % 10);
        assert_eq!(view.id, format!("{}-{repeat}", once.views[of].id));
        assert_eq!(view.world_from_flange, once.views[of].world_from_flange);
        assert_eq!(large.pictures(index).unwrap(), scan.pictures(of).unwrap());
    }
    let pictures = twice
        .views
        .iter()
        .flat_map(|view| [Some(&view.on), view.off.as_ref()]);
    let different: BTreeSet<_> = pictures.clone().collect();
    assert_eq!((pictures.count(), different.len()), (40, 40));
    let face = &twice.known[0].views.as_ref().unwrap()[0];
    assert_eq!(face.join(" "), "0000-0 0001-0 0002-0 0000-1 0001-1 0002-1");

    arguments[3] = "much".into();
    assert!(assert_ends_with(&snellius(&arguments), 2).contains("500M"));
}

#[test]
fn a_reader_that_stops_early_is_no_fault() {
    let folder = Folder::new();
    let scan = folder.write("scan.zip", &small_scan());
    for call in [
        &["schema".as_ref()][..],
        &["check".as_ref(), scan.as_os_str()],
    ] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let mut program = Command::new(env!("CARGO_BIN_EXE_snellius"));
        let output = program
            .args(call)
            .stdout(writer)
            .stderr(Stdio::piped())
            .output()
            .unwrap();
        assert_eq!(assert_ends_with(&output, 0), "");
    }
}

/// A full disk is a fault.
#[cfg(target_os = "linux")]
#[test]
fn output_that_cannot_be_written_ends_with_1() {
    let full = fs::File::create("/dev/full").unwrap();
    let mut program = Command::new(env!("CARGO_BIN_EXE_snellius"));
    let output = program
        .arg("schema")
        .stdout(full)
        .stderr(Stdio::piped())
        .output()
        .unwrap();
    assert!(assert_ends_with(&output, 1).contains("standard output"));
}

#[test]
fn a_table_is_made_and_measured_with() {
    let (folder, scan) = (Folder::new(), small_scan());
    let scan_file = folder.write("scan.zip", &scan);
    let table = folder.path("table.json");
    let make: [PathBuf; 4] = ["table", "--view", "0002", "--output"].map(Into::into);
    let done = snellius(&[&make[..], &[table.clone(), scan_file.clone()]].concat());
    let summary = assert_ends_with(&done, 0);
    assert!(summary.contains("standard deviations"), "{summary}");

    let output = folder.path("by table");
    let by_table: [PathBuf; 4] = [
        "reconstruct".into(),
        "--table".into(),
        table.clone(),
        "-o".into(),
    ];
    let done = snellius(&[&by_table[..], &[output.clone(), scan_file.clone()]].concat());
    let summary = assert_ends_with(&done, 0);
    assert!(summary.contains("stood elsewhere"), "{summary}");
    let json = fs::read_to_string(output.join("result.json")).unwrap();
    let result: Value = serde_json::from_str(&json).unwrap();
    let traced = measure(&scan).unwrap().views[2].object.first().unwrap();
    for (axis, traced) in traced.iter().enumerate() {
        let found = result["views"][2]["object"][axis].as_f64().unwrap();
        assert!((found - traced).abs() < 0.02, "{found} {traced}");
    }

    let elsewhere: [PathBuf; 4] = ["table", "--view", "none such", "-o"].map(Into::into);
    let done = snellius(&[&elsewhere[..], &[table.clone(), scan_file.clone()]].concat());
    assert!(assert_ends_with(&done, 1).contains("no view has the id"));
    fs::write(&table, "{}").unwrap();
    let done = snellius(&[&by_table[..], &[output, scan_file]].concat());
    assert!(assert_ends_with(&done, 1).contains("table.json: no table"));
}

#[test]
fn share_puts_a_scan_into_the_viewer_beside_the_program_or_named() {
    const VIEWER: &str = "<title>Snellius</title><!-- snellius:data --><!-- snellius:module -->";
    let (folder, scan) = (Folder::new(), small_scan());
    let scan = folder.write("scan.zip", &scan);
    let viewer = folder.write("viewer.html", VIEWER.as_bytes());
    folder.write("viewer.wasm", b"a module");
    let page = folder.path("page.html");
    let words = |more: &[&OsStr]| {
        let mut words = vec![OsStr::new("share"), scan.as_os_str()];
        words.extend([OsStr::new("--output"), page.as_os_str()]);
        words.extend(more);
        snellius(&words)
    };
    let named = [OsStr::new("--viewer"), viewer.as_os_str()];
    let titled = ["--title", "A & B", "--index", "1.4"].map(OsStr::new);
    assert_ends_with(&words(&[&named[..], &titled[..]].concat()), 0);
    let made = fs::read_to_string(&page).unwrap();
    assert!(made.starts_with("<title>A &amp; B</title><script type=\"application/json\""));
    let document = snellius::share::document_in(&made).unwrap();
    assert_eq!(document.title, "A & B");
    assert_eq!(document.result.media.inside.value, Some(1.4));
    assert_eq!(document.scan.unwrap().views.len(), 10);

    let missing = folder.path("nowhere.html");
    let error = words(&[OsStr::new("--viewer"), missing.as_os_str()]);
    let error = assert_ends_with(&error, 1);
    assert!(
        error.contains("nowhere.html") && error.contains("cargo xtask viewer"),
        "{error}"
    );
    let other = folder.write("other.html", b"<html></html>");
    folder.write("other.wasm", b"a module");
    let error = words(&[OsStr::new("--viewer"), other.as_os_str()]);
    let error = assert_ends_with(&error, 1);
    assert!(error.contains("no viewer of Snellius"), "{error}");
}
