//! One-file pages: opened from disk, with no network, they show what was measured and measure on.

use std::{fs, path::PathBuf};

use anyhow::{Context, Result, ensure};
use serde_json::Value;
use snellius_tests::{
    PATIENCE, Page,
    companion::{Output, share},
    places::samples,
    with_page,
    workbench::part,
};
use tempfile::TempDir;

/// Another index than any sample's.
const ANOTHER: &str = "1.37";

fn sample(name: &str) -> Result<PathBuf> {
    let mut found = samples()?.into_iter();
    found
        .find(|path| path.file_stem().is_some_and(|stem| stem == name))
        .with_context(|| format!("no sample {name}"))
}

/// Opens a page from disk, in a browser that has no network, and waits until it shows something.
fn opened(name: &str, html: &[u8], test: impl FnOnce(&Page) -> Result<()>) -> Result<()> {
    let directory = TempDir::new()?;
    let file = directory.path().join("page.html");
    fs::write(&file, html)?;
    with_page(name, |page| {
        page.open(&format!("file://{}", file.display()))?;
        page.wait_long(
            PATIENCE * 3,
            "the page to show something",
            "['done', 'failed'].includes(document.body.dataset.state)",
        )?;
        test(page)
    })
}

fn is_shown(page: &Page) -> Result<()> {
    let state = page.value_of("document.body.dataset.state")?;
    let problem = page.value_of("document.getElementById('problem').textContent")?;
    ensure!(state == "done", "{problem}");
    Ok(())
}

/// Sets the index as at the keyboard.
fn set_index(page: &Page, index: &str) -> Result<()> {
    page.click(&part("index"))?;
    page.value_of("document.querySelector('[data-testid=index]').select()")?;
    page.type_text(index)
}

/// The numbers of a point's row: x, y, z, their standard deviations, l.
fn row(page: &Page, id: &str) -> Result<Vec<f64>> {
    let cells = page.value_of(&format!(
        "[...document.querySelectorAll('[data-testid=\"point-{id}-0\"] td')].slice(3, 10).map(cell => Number(cell.textContent))"
    ))?;
    let cells = cells.as_array().context("no row")?;
    Ok(cells.iter().filter_map(Value::as_f64).collect())
}

fn result_of(output: &Output) -> Result<Value> {
    Ok(serde_json::from_slice(&output.file("result.json")?)?)
}

/// The views with an object point: id and point.
fn objects(result: &Value) -> Vec<(String, [f64; 3])> {
    let views = result["views"].as_array().into_iter().flatten();
    let point = |view: &Value| {
        let place = [0, 1, 2].map(|axis| view["object"][axis].as_f64());
        let [Some(x), Some(y), Some(z)] = place else {
            return None;
        };
        Some((view["id"].as_str()?.to_owned(), [x, y, z]))
    };
    views.filter_map(point).collect()
}

#[test]
fn a_page_on_disk_shows_the_reconstruction_and_gives_its_data() -> Result<()> {
    let archive = sample("tank-paper")?;
    let html = share(
        &archive,
        &["--title", "A box", "--notes", "One line.\nAnother."],
    )?;
    let expected = Output::of(&archive, &[])?;
    let points = objects(&result_of(&expected)?);
    ensure!(html.len() < 1_200_000, "{} bytes", html.len());
    opened("one-file", &html, |page| {
        is_shown(page)?;
        assert_eq!(page.text(&part("title"))?, "A box");
        assert_eq!(page.text(&part("notes"))?, "One line.\nAnother.");
        assert_eq!(page.count("[data-testid^=point-]")?, points.len());
        for (id, place) in &points {
            let shown = row(page, id)?;
            for axis in 0..3 {
                ensure!(
                    (shown[axis] - place[axis]).abs() < 6e-4,
                    "{id}: {shown:?} {place:?}"
                );
            }
        }
        for (button, name) in [
            ("download-csv", "points.csv"),
            ("download-object-ply", "object.ply"),
            ("download-json", "result.json"),
            ("download-las", "object.las"),
            ("download-e57", "object.e57"),
        ] {
            let saved = page.download(|| page.click(&part(button)))?;
            assert_eq!(saved.name, name);
            ensure!(saved.bytes == expected.file(name)?, "{name} differs");
        }
        let scene = page.settled_picture_of(&part("scene"))?;
        ensure!(
            scene.distinct_colours() > 5,
            "the scene has no points in their colours"
        );
        ensure!(scene.coloured_pixels() > 2000, "the scene is empty");
        for (scheme, width, height) in [
            ("light", 1280, 900),
            ("dark", 1280, 900),
            ("dark", 390, 844),
            ("light", 390, 844),
        ] {
            page.prefer_scheme(scheme)?;
            page.set_size(width, height)?;
            page.click("#fit")?;
            page.settled_picture_of(&part("scene"))?;
            page.screenshot(&format!("one-file-{scheme}-{width}"))?;
            let overflow = page.value_of("document.documentElement.scrollWidth > innerWidth")?;
            ensure!(overflow == false, "wider than {width} px");
        }
        Ok(())
    })
}

/// Dragging the index gives what the companion program measures with that index.
#[test]
fn the_points_follow_the_index() -> Result<()> {
    let archive = sample("tank-paper")?;
    let another = objects(&result_of(&Output::of(&archive, &["--index", ANOTHER])?)?);
    opened("one-file-index", &share(&archive, &[])?, |page| {
        is_shown(page)?;
        let before = page.settled_picture_of(&part("scene"))?;
        let first = row(page, &another[0].0)?;
        set_index(page, ANOTHER)?;
        let mut equal = 0;
        for (id, place) in &another {
            let shown = row(page, id)?;
            let same = (0..3).all(|axis| (shown[axis] - place[axis]).abs() < 6e-4);
            equal += usize::from(same);
        }
        // Which of several spots is the object's may change with the index.
        ensure!(
            10 * equal >= 9 * another.len(),
            "{equal} of {}",
            another.len()
        );
        let after = page.settled_picture_of(&part("scene"))?;
        ensure!(before != after, "the object does not follow");
        page.screenshot("one-file-another-index")?;

        let saved = page.download(|| page.click(&part("download-json")))?;
        let saved: Value = serde_json::from_slice(&saved.bytes)?;
        assert_eq!(saved["media"]["inside"]["value"], 1.37);
        page.click(&part("index-reset"))?;
        assert_eq!(row(page, &another[0].0)?, first);
        Ok(())
    })
}

#[test]
fn two_points_are_measured_from_the_table_and_in_the_scene() -> Result<()> {
    let archive = sample("tank-paper")?;
    let points = objects(&result_of(&Output::of(&archive, &[])?)?);
    let (one, other) = (&points[0], points.last().context("no points")?);
    let length = (0..3)
        .map(|axis| one.1[axis] - other.1[axis])
        .map(|way| way * way)
        .sum::<f64>()
        .sqrt();
    opened("one-file-measure", &share(&archive, &[])?, |page| {
        is_shown(page)?;
        for (id, _) in [one, other] {
            page.click(&format!("[data-testid=\"point-{id}-0\"] button"))?;
        }
        page.wait_text(&part("measured"), "distance:")?;
        let said = page.text(&part("measured"))?;
        ensure!(
            said.contains(&format!("{length:.3} \u{b1} ")),
            "{said:?} is not {length:.3}"
        );
        page.click("#measure-clear")?;
        page.wait_text(&part("measured"), "Pick points")?;

        // A click on a point of the scene chooses and picks it.
        let place = page.value_of(
            "(() => { const { scene } = page, box = scene.canvas.getBoundingClientRect();
               const at = scene.seenAt(scene.places[5]); return [at[0] / box.width, at[1] / box.height]; })()",
        )?;
        let share = |at: usize| place[at].as_f64().context("no place");
        let at = (share(0)?, share(1)?);
        page.drag(&part("scene"), at, at)?;
        page.wait_text(&part("measured"), "1 picked")?;
        page.wait_visible("tr.chosen")?;
        page.screenshot("one-file-chosen")?;

        let before = page.settled_picture_of(&part("scene"))?;
        page.drag(&part("scene"), (0.3, 0.4), (0.6, 0.6))?;
        ensure!(
            before != page.settled_picture_of(&part("scene"))?,
            "dragging turns nothing"
        );
        Ok(())
    })
}

#[test]
fn the_data_of_version_1_is_shown_for_ever() -> Result<()> {
    let page = share(&sample("tank-paper")?, &[])?;
    opened(
        "one-file-v1",
        with_data(&page, VERSION_1)?.as_bytes(),
        |page| {
            is_shown(page)?;
            assert_eq!(page.text(&part("title"))?, "A box in a tank");
            assert_eq!(page.text(&part("notes"))?, "A note with a <b>tag</b>.");
            ensure!(
                page.count("[data-testid^=point-]")? > 20,
                "points are missing"
            );
            Ok(())
        },
    )
}

const VERSION_1: &str = include_str!("../../crate/tests/data/page-v1.json");

/// A page with data of anyone's making in place of its own.
fn with_data(page: &[u8], data: &str) -> Result<String> {
    const BEGIN: &str = "<script type=\"application/json\" id=\"snellius-data\">";
    let page = str::from_utf8(page)?;
    let (before, own) = page.split_once(BEGIN).context("no data in the page")?;
    let (_, behind) = own.split_once("</script>").context("no end of the data")?;
    Ok(format!("{before}{BEGIN}{data}</script>{behind}"))
}

/// Data of ill will: it is told what is wrong, and nothing in it runs.
#[test]
fn pages_of_ill_will_say_what_is_wrong() -> Result<()> {
    let page = share(&sample("tank-paper")?, &[])?;
    let deep = format!(r#""scan":{{"x":{}{},"#, "[".repeat(5000), "]".repeat(5000));
    let cases = [
        ("empty", String::new(), "cannot be shown"),
        (
            "cut-off",
            VERSION_1[..VERSION_1.len() / 2].to_owned(),
            "cannot be shown",
        ),
        (
            "later",
            VERSION_1.replacen(r#""version":1"#, r#""version":2"#, 1),
            "version 2",
        ),
        (
            "deep",
            VERSION_1.replacen(r#""scan":{"#, &deep, 1),
            "recursion",
        ),
        (
            "markup",
            VERSION_1.replacen(
                r#""title":"A box in a tank""#,
                r#""title":["\u003cimg src=x onerror='window.ran=1'>"]"#,
                1,
            ),
            "title",
        ),
    ];
    for (name, data, words) in cases {
        let name = format!("one-file-ill-{name}");
        opened(&name, with_data(&page, &data)?.as_bytes(), |page| {
            page.wait_text(&part("error"), words)?;
            Ok(())
        })?;
    }
    let without = String::from_utf8(page)?.replace("id=\"snellius-data\"", "id=\"other\"");
    opened("one-file-ill-without", without.as_bytes(), |page| {
        page.wait_text(&part("error"), "no reconstruction")
    })
}

/// Markup in names is shown as what it is.
#[test]
fn markup_in_names_is_text() -> Result<()> {
    let markup = "<img src=x onerror='window.ran=1'></title></script><script>window.ran=2</script>";
    let page = share(&sample("tank-paper")?, &[])?;
    let mut data: Value = serde_json::from_str(VERSION_1)?;
    data["title"] = markup.into();
    data["notes"] = markup.into();
    data["result"]["scan"] = markup.into();
    data["result"]["warnings"] = serde_json::json!([markup]);
    for which in ["id", "reason"] {
        data["result"]["views"][0][which] = markup.into();
    }
    let data = data.to_string().replace('<', "\\u003c");
    opened(
        "one-file-markup",
        with_data(&page, &data)?.as_bytes(),
        |page| {
            is_shown(page)?;
            assert_eq!(page.text(&part("title"))?, markup);
            assert_eq!(page.count("img")?, 0);
            assert_eq!(page.value_of("typeof window.ran")?, "undefined");
            page.screenshot("one-file-markup").map(drop)
        },
    )
}
