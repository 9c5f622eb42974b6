//! One-file pages: what goes in comes out, at another index too, and nothing of ill will does any harm.
#![allow(
    clippy::disallowed_methods,
    reason = "expectations may come from the platform"
)]

mod common;

use std::fs;
use std::io::Cursor;
use std::sync::LazyLock;

use common::archives::{measure_with, repository};
use serde_json::{Value, json};
use snellius::export::{Format, OneOrMany, ReconstructionResult, Status};
use snellius::index::IndexRange;
use snellius::pipeline::Settings;
use snellius::scan::{Archive, InsideMedium, Manifest};
use snellius::share::{Document, DocumentError, Sightlines, Viewer, document_in, one_file};

/// As much of the viewer as matters here.
const VIEWER: Viewer = Viewer {
    page: "<!doctype html><head><title>Snellius</title></head><body><!-- snellius:module --><!-- snellius:data --></body>",
    module: b"module",
};

/// A measured sample, with another index than its own too.
struct Measured {
    document: Document,
    with_another: ReconstructionResult,
}

const ANOTHER: f64 = 1.37;

fn measured(sample: &str) -> Measured {
    let archive = fs::read(repository(&format!("samples/{sample}.zip"))).unwrap();
    let manifest = Archive::open(Cursor::new(&archive))
        .unwrap()
        .scan()
        .manifest
        .clone();
    let settings = Settings::default();
    let another = Settings {
        index: Some(ANOTHER),
        ..settings
    };
    let result = measure_with(&archive, &settings).unwrap();
    Measured {
        document: Document::new(None, String::new(), settings, Some(manifest), result),
        with_another: measure_with(&archive, &another).unwrap(),
    }
}

static TANK: LazyLock<Measured> = LazyLock::new(|| measured("tank-paper"));

fn sightlines(document: &Document) -> Sightlines {
    Sightlines::of(document).unwrap().unwrap()
}

fn objects(result: &ReconstructionResult) -> Vec<(String, [f64; 3], f64)> {
    let views = result.views.iter();
    let points = views.flat_map(|view| {
        let points = view.object.iter().zip(view.ray_distance.iter());
        points.map(|(place, l)| (view.id.clone(), *place, *l))
    });
    points.collect()
}

#[test]
fn a_page_gives_back_what_was_put_in() {
    let document = &TANK.document;
    let page = one_file(&VIEWER, document).unwrap();
    assert_eq!(&document_in(&page).unwrap(), document);
    assert_eq!(page, one_file(&VIEWER, document).unwrap(), "the same again");
    assert_eq!(document.title, document.result.scan);
    assert!(page.contains(&format!("<title>{}</title>", document.title)));
}

/// With the index that was measured the points are those that were measured, and with another one they are
/// those that the pictures give with it: through flat walls and round ones.
#[test]
fn the_points_follow_the_index_as_if_measured_anew() {
    for sample in ["tank-paper", "jar"] {
        let Measured {
            document,
            with_another,
        } = &measured(sample);
        let lines = sightlines(document);
        let index = document.result.media.inside.value.unwrap();
        assert_eq!(lines.result_at(&document.result, index), document.result);

        // A hair beside it everything is traced anew, and hardly moves.
        let beside = objects(&lines.result_at(&document.result, index + 1e-9));
        let truth = objects(&document.result);
        assert_eq!(beside.len(), truth.len());
        for ((_, found, l), (id, expected, length)) in beside.iter().zip(&truth) {
            for axis in 0..3 {
                assert!(
                    (found[axis] - expected[axis]).abs() < 1e-4,
                    "{id}: {found:?} {expected:?}"
                );
            }
            assert!((l - length).abs() < 1e-4, "{id}");
        }

        let moved = objects(&lines.result_at(&document.result, ANOTHER));
        let anew = objects(with_another);
        let mut compared = 0;
        for (id, found, _) in &moved {
            // Which of several spots is the object's may change with the index; those that stay are compared.
            let near = anew.iter().filter(|(other, ..)| other == id);
            let off = near.map(|(_, place, _)| {
                (0..3)
                    .map(|axis| (found[axis] - place[axis]).abs())
                    .fold(0.0, f64::max)
            });
            compared += usize::from(off.fold(f64::INFINITY, f64::min) < 1e-6);
        }
        assert!(
            10 * compared >= 9 * anew.len(),
            "{sample}: {compared} of {}",
            anew.len()
        );
        assert!(anew.len() > 15, "{sample}: {}", anew.len());
    }
}

#[test]
fn the_mean_ray_distance_is_that_of_the_points() {
    let document = &TANK.document;
    let lines = sightlines(document);
    let range = IndexRange {
        from: 1.2,
        to: 1.5,
        count: 4,
    };
    for (index, mean) in range
        .values()
        .iter()
        .zip(lines.mean_ray_distances(&range.values()))
    {
        let result = lines.result_at(&document.result, *index);
        let views = document.scan.iter().flat_map(|scan| &scan.views);
        let in_liquid = views.filter(|view| view.inside == InsideMedium::Liquid);
        let ids: Vec<&str> = in_liquid.map(|view| view.id.as_str()).collect();
        let all = objects(&result).into_iter();
        let all: Vec<f64> = all
            .filter(|(id, ..)| ids.contains(&id.as_str()))
            .map(|(_, _, l)| l)
            .collect();
        let expected = all.iter().sum::<f64>() / all.len() as f64;
        assert!((mean.unwrap() - expected).abs() < 1e-9, "{index}");
    }
}

#[test]
fn the_light_ends_at_the_point() {
    let document = &TANK.document;
    let lines = sightlines(document);
    let index = document.result.media.inside.value.unwrap();
    let view = document
        .result
        .views
        .iter()
        .position(|v| v.object.first().is_some())
        .unwrap();
    let light = lines.light(view, 0, index).unwrap();
    let place = document.result.views[view].object.first().unwrap();
    let ends = [&light.beam, &light.sight].map(|path| path.last().unwrap().to_array());
    for axis in 0..3 {
        assert!((0.5 * (ends[0][axis] + ends[1][axis]) - place[axis]).abs() < 1e-6);
    }
    assert!(light.beam.len() >= 4, "laser, two faces, point: {light:?}");
    assert_eq!(lines.light(view, 1, index), None);
    assert_eq!(lines.light(usize::MAX, 0, index), None);
}

/// An index with which light is thrown back leaves no half a point behind, and every format can be written.
#[test]
fn any_index_gives_a_whole_result() {
    let document = &TANK.document;
    let lines = sightlines(document);
    for index in [0.5, 0.9, 1.0, 1.7, 4.0] {
        let result = lines.result_at(&document.result, index);
        for view in &result.views {
            let count = view.object.iter().len();
            assert_eq!(view.ray_distance.iter().len(), count);
            assert_eq!(view.object_sigma.iter().len(), count);
            assert_eq!(view.status == Status::Ok, count > 0);
            assert!(matches!(view.object, OneOrMany::One(_)));
        }
        for format in [Format::Csv, Format::Ply, Format::Json, Format::ObjectCsv] {
            result.write(format).unwrap();
        }
    }
}

/// A document that the first program of version 1 made, kept as it was. If this fails, do not change the
/// file: make the program open it.
#[test]
fn a_page_of_version_1_opens_for_ever() {
    let data = include_str!("data/page-v1.json").trim();
    let page = format!(
        "<!doctype html><title>x</title><script type=\"application/json\" id=\"snellius-data\">{data}</script>"
    );
    let document = document_in(&page).unwrap();
    assert_eq!(document.title, "A box in a tank");
    assert_eq!(document.notes, "A note with a <b>tag</b>.");
    assert_eq!(document.settings.index, Some(1.36));
    assert_eq!(document.result.views.len(), 35);
    let lines = sightlines(&document);
    let place = |result: &ReconstructionResult| result.views[17].object.first().unwrap();
    let (here, there) = (
        place(&document.result),
        place(&lines.result_at(&document.result, 1.5)),
    );
    // Behind a denser liquid the same light meets farther away.
    assert!((there[2] - here[2]).abs() > 1.0, "{here:?} {there:?}");
}

/// Markup is text: it neither ends the data block nor begins anything in the title.
#[test]
fn markup_in_names_stays_text() {
    let markup =
        "</script></title><script>alert(1)</script><!-- <img src=x onerror=alert(2)> & \u{2028}";
    let mut document = TANK.document.clone();
    document.title = format!("{markup} <!-- snellius:data -->");
    document.notes = markup.to_owned();
    document.result.scan = markup.to_owned();
    document.result.views[0].id = markup.to_owned();
    let page = one_file(&VIEWER, &document).unwrap();
    assert_eq!(
        page.matches("<script").count(),
        2,
        "the module's and the data's"
    );
    assert_eq!(page.matches("</script").count(), 2);
    assert!(!page.contains("<img"));
    assert_eq!(document_in(&page).unwrap(), document);
}

#[test]
fn what_is_no_viewer_is_refused() {
    for (viewer, place) in [
        ("", "<title>"),
        ("<title>Snellius</title>", "snellius:data"),
        (
            "<title>Snellius</title><!-- snellius:data --><!-- snellius:data -->",
            "2 times",
        ),
        (
            "<title>Snellius</title><!-- snellius:data -->",
            "snellius:module",
        ),
    ] {
        let viewer = Viewer {
            page: viewer,
            ..VIEWER
        };
        let refused = one_file(&viewer, &TANK.document).unwrap_err();
        assert!(refused.to_string().contains(place), "{refused}");
    }
}

/// Pages and data of ill will: what is done to a good one, and what the message must say.
#[test]
fn pages_of_ill_will_are_errors() {
    let good = one_file(&VIEWER, &TANK.document).unwrap();
    let message = |page: &str| document_in(page).unwrap_err().to_string();
    assert!(message("").contains("no reconstruction"));
    assert!(message("<html>holiday</html>").contains("no reconstruction"));
    let end = good.rfind("</script>").unwrap();
    assert!(message(&good[..end]).contains("cut off"));
    for cut in (0..end).step_by(good.len() / 200) {
        if good.is_char_boundary(cut) {
            document_in(&good[..cut]).unwrap_err();
        }
    }
    let page = |data: &str| {
        format!("<script type=\"application/json\" id=\"snellius-data\">{data}</script>")
    };
    const DEEP: usize = 100_000;
    assert!(message(&page(&"[".repeat(DEEP))).contains("the data"));
    let nested = format!("{}{}", "[".repeat(DEEP), "]".repeat(DEEP));
    let deep = TANK.document.to_json();
    let deep = deep.replacen(r#""scan":{"#, &format!(r#""scan":{{"x":{nested},"#), 1);
    assert!(message(&page(&deep)).contains("recursion"));
    assert!(message(&page("{}")).contains("format"));
    assert!(message(&page(r#"{"format":"snellius-page","version":2}"#)).contains("version 2"));

    type Harm = fn(&mut Value);
    let harms: [(Harm, &str); 12] = [
        (|d| d["version"] = json!(99_999_999_999_u64), "99999999999"),
        (|d| d["version"] = json!(-1), "the data"),
        (|d| d["title"] = json!(["a"]), "title"),
        (|d| d["result"]["version"] = json!(7), "version"),
        (|d| d["scan"]["version"] = json!(7), "version"),
        (|d| d["scan"]["camera"]["fx"] = json!(0), "camera.fx"),
        (|d| d["scan"]["views"] = json!([]), "views"),
        (|d| d["result"]["views"] = json!([]), "result.views"),
        (
            |d| d["result"]["views"][3]["object"] = json!("x"),
            "result.views[3].object",
        ),
        (
            |d| d["result"]["media"]["inside"]["value"] = json!("much"),
            "result.media",
        ),
        (
            |d| d["settings"] = json!({ "index": "much" }),
            "settings.index",
        ),
        (|d| d["scan"]["media"]["wall"] = json!(-1), "media.wall"),
    ];
    let whole: Value = serde_json::from_str(&TANK.document.to_json()).unwrap();
    for (harm, word) in harms {
        let mut data = whole.clone();
        harm(&mut data);
        let said = message(&page(&data.to_string()));
        assert!(said.contains(word), "{word}: {said}");
    }
}

/// Numbers that are no wall's or no spots' open, but cannot be measured again.
#[test]
fn what_cannot_be_measured_again_says_why() {
    let mut document = TANK.document.clone();
    document.result.views[5].spots.clear();
    let refused = Sightlines::of(&document).unwrap_err();
    assert!(matches!(refused, DocumentError::Format { .. }));
    assert!(refused.to_string().contains("views[5]"), "{refused}");

    let mut whole: Value = serde_json::from_str(&TANK.document.to_json()).unwrap();
    whole["result"]["vessel"]["normal"] = json!([0, 0, 0]);
    let document = Document::from_json(whole.to_string().as_bytes()).unwrap();
    let refused = Sightlines::of(&document).unwrap_err().to_string();
    assert!(refused.contains("vessel"), "{refused}");

    let mut document = TANK.document.clone();
    document.scan = None::<Manifest>;
    assert!(Sightlines::of(&document).unwrap().is_none());
}

/// Whatever numbers a page holds, opening it, measuring it again and writing it ends, and without a panic.
#[test]
fn numbers_of_ill_will_do_no_harm() {
    const EXTREMES: [f64; 8] = [0.0, -1.0, 1e-300, 1e300, -1e300, 4_294_967_295.0, 1e16, 0.1];
    let whole: Value = serde_json::from_str(&TANK.document.to_json()).unwrap();
    let count = numbers(&mut whole.clone()).len();
    let mut opened = 0;
    for case in 0..600 {
        let mut data = whole.clone();
        let mut places = numbers(&mut data);
        // Every few cases several numbers at once.
        for k in 0..=case % 3 {
            let at = (case * 7919 + k * 104_729) % count;
            let extreme = EXTREMES[(case / 3 + k) % EXTREMES.len()];
            *places[at] = match extreme.fract() == 0.0 && extreme.abs() < 1e10 {
                true => json!(extreme as i64),
                false => json!(extreme),
            };
        }
        let Ok(document) = Document::from_json(data.to_string().as_bytes()) else {
            continue;
        };
        opened += 1;
        let result = match Sightlines::of(&document) {
            Ok(Some(lines)) => {
                lines.light(case % 35, 0, 1.33);
                lines.mean_ray_distances(&[1.0, 1.5]);
                lines.result_at(&document.result, 1.4)
            }
            _ => document.result,
        };
        let _ = result.wall_mesh();
        for format in Format::ALL {
            let _ = result.write(*format);
        }
    }
    assert!(opened > 300, "{opened}");
}

/// All numbers of a JSON.
fn numbers(value: &mut Value) -> Vec<&mut Value> {
    match value {
        Value::Number(_) => vec![value],
        Value::Array(list) => list.iter_mut().flat_map(numbers).collect(),
        Value::Object(map) => map.values_mut().flat_map(numbers).collect(),
        _ => Vec::new(),
    }
}
