//! A liquid that nobody knows: the page says what the scan tells of its refractive index, and why, and a
//! person takes a method's value or gives another.

use std::{
    fs::{self, File},
    io::{Read, Write},
    path::{Path, PathBuf},
};

use anyhow::{Context, Result, ensure};
use serde_json::{Value, json};
use snellius_tests::{
    companion::Output,
    places::samples,
    workbench::{RECONSTRUCTION, Workbench, part, with_workbench},
};
use tempfile::TempDir;
use zip::{ZipArchive, ZipWriter, write::SimpleFileOptions};

/// The sample of a ball in a jar with another manifest.
fn jar_with(change: impl FnOnce(&mut Value)) -> Result<(TempDir, PathBuf)> {
    let samples = samples()?;
    let jar = samples.into_iter().find(|path| path.ends_with("jar.zip"));
    let jar = jar.context("no sample jar.zip")?;
    let directory = tempfile::tempdir()?;
    let changed = directory.path().join("unknown.zip");
    fs::write(&changed, with_manifest(&jar, change)?)?;
    Ok((directory, changed))
}

fn with_manifest(archive: &Path, change: impl FnOnce(&mut Value)) -> Result<Vec<u8>> {
    let mut from = ZipArchive::new(File::open(archive)?)?;
    let mut manifest: Value = serde_json::from_reader(from.by_name("scan.json")?)?;
    change(&mut manifest);
    let mut to = ZipWriter::new(std::io::Cursor::new(vec![]));
    for index in 0..from.len() {
        let mut entry = from.by_index(index)?;
        let mut content = Vec::new();
        entry.read_to_end(&mut content)?;
        if entry.name() == "scan.json" {
            content = serde_json::to_vec(&manifest)?;
        }
        to.start_file(entry.name(), SimpleFileOptions::default())?;
        to.write_all(&content)?;
    }
    Ok(to.finish()?.into_inner())
}

/// The jar's scan as a rig gives it that is calibrated well, of a ball whose radius is known.
fn told_by_its_radius(manifest: &mut Value) {
    manifest["media"]["inside"] = Value::Null;
    manifest["known"] = json!([{ "kind": "radius", "mm": 27.0 }]);
    manifest["calibration_sigma"] = json!({
        "laser_origin": 0.02,
        "laser_direction": 0.005,
        "focal_length": 0.05,
        "principal_point": 0.05,
        "hand_eye_rotation": 0.005,
        "hand_eye_translation": 0.02,
    });
}

fn inside(workbench: &Workbench) -> Result<Value> {
    let json = workbench.download("download-json")?.bytes;
    let mut result: Value = serde_json::from_slice(&json)?;
    Ok(result["media"]["inside"].take())
}

/// The number in the field.
fn index_in_field(workbench: &Workbench) -> Result<f64> {
    let field = format!("document.querySelector('{}').value", part("index-input"));
    let text = workbench.page.value_of(&field)?;
    Ok(text.as_str().context("no text in the field")?.parse()?)
}

/// Waits until everything is measured and the words beside the field are these.
fn wait_worth(workbench: &Workbench, words: &str) -> Result<()> {
    let condition = format!(
        "!document.querySelector('[data-state=running]:not(html)')
            && document.querySelector({})?.innerText.includes({})",
        Value::from(part("index-worth")),
        Value::from(words),
    );
    let what = format!("the index to be {words:?}");
    workbench.page.wait_long(RECONSTRUCTION, &what, &condition)
}

#[test]
fn a_methods_value_is_used_and_the_slider_takes_over() -> Result<()> {
    let (_directory, archive) = jar_with(told_by_its_radius)?;
    let by_companion = Output::of(&archive, &["--index", "known-shape"])?.file("result.json")?;
    with_workbench("unknown-index", |workbench| {
        workbench.reconstruct(&archive)?;
        let page = workbench.page;
        page.wait_text(&part("index-verdict"), "tells the index")?;
        page.wait_text(&part("index-methods"), "Joint estimate")?;
        let table = page.text(&part("index-methods"))?;
        for words in ["Ray distance", "Overlap", "Known shape", "weak", "\u{b1}"] {
            ensure!(table.contains(words), "{table:?} does not say {words:?}");
        }
        ensure!(
            page.count(&part("use-ray-distance"))? == 0,
            "a value that the scan cannot tell is offered"
        );
        let radius = page.text(&part("curve-known"))?;
        ensure!(radius.contains("27.000 mm"), "the curve says {radius:?}");
        wait_worth(workbench, "joint estimate")?;
        assert_eq!(inside(workbench)?["method"], "joint");

        workbench.click("use-known-shape")?;
        wait_worth(workbench, "known shape")?;
        page.screenshot("unknown-index")?;
        let saved = workbench.download("download-json")?;
        ensure!(
            saved.bytes == by_companion,
            "the companion program makes another result of the known shape"
        );

        let before = index_in_field(workbench)?;
        page.drag(&part("index-slider"), (0.42, 0.5), (0.6, 0.5))?;
        wait_worth(workbench, "given")?;
        let after = index_in_field(workbench)?;
        ensure!(
            after > before + 0.05,
            "the slider moved n from {before} to {after}"
        );
        assert_eq!(inside(workbench)?["value"], after);
        page.wait_text(&part("curve-known"), &format!("At n = {after:.3}"))?;

        workbench.click("undo")?;
        wait_worth(workbench, "known shape")?;
        workbench.click("undo")?;
        wait_worth(workbench, "joint estimate")
    })
}

#[test]
fn where_the_scan_cannot_tell_the_page_says_why_and_asks() -> Result<()> {
    let (_directory, archive) = jar_with(|manifest| manifest["media"]["inside"] = Value::Null)?;
    with_workbench("index-not-determined", |workbench| {
        workbench.reconstruct(&archive)?;
        let page = workbench.page;
        page.wait_text(&part("index-verdict"), "cannot tell")?;
        page.wait_text(&part("index-remedy"), "degrees")?;
        ensure!(page.is_visible(&part("curve-ray-distance"))?, "no curve");
        ensure!(
            page.count("[data-testid^=use-]")? == 0,
            "a value is offered that the scan cannot tell"
        );
        ensure!(
            page.count(&part("scene"))? == 0,
            "an object is shown without an index"
        );
        page.screenshot("index-not-determined")?;

        page.drag(&part("index-slider"), (0.46, 0.5), (0.42, 0.5))?;
        page.wait_long(
            RECONSTRUCTION,
            "the object",
            &format!("document.querySelector('{}') !== null", part("scene")),
        )?;
        wait_worth(workbench, "given")?;
        ensure!(
            page.is_visible(&part("index-verdict"))?,
            "the panel is gone"
        );
        assert_eq!(inside(workbench)?["method"], "given");
        Ok(())
    })
}
