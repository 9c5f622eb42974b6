//! The npm package in a browser, as a page of other people's uses it (in Node it is tested by
//! `npm/test/node.mjs`).

use anyhow::{Context, Result};
use snellius_tests::{
    PATIENCE, Site,
    companion::Output,
    places::{npm_package, samples},
    with_page,
};

/// A page that measures the archive beside it, and gives up once on the way.
const PAGE: &str = r#"<!doctype html><meta charset="utf-8"><link rel="icon" href="data:,"><script type="module">
import { reconstruct } from "./browser.js";
const scan = await (await fetch("./scan.zip")).blob();
const told = [];
const controller = new AbortController();
const onProgress = (done) => { if (done === 2) controller.abort(new Error("enough")); };
const gaveUp = await reconstruct(scan, { signal: controller.signal, onProgress }).catch((e) => e.message);
const reconstruction = await reconstruct(scan, { onProgress: (...step) => told.push(step) });
const text = (format) => new TextDecoder().decode(reconstruction.write(format));
window.found = { gaveUp, told, views: reconstruction.result.views.length, json: text("json"), ply: text("ply") };
</script>"#;

#[test]
fn a_page_measures_with_the_package_what_the_companion_program_measures() -> Result<()> {
    let archive = samples()?.swap_remove(0);
    let expected = Output::of(&archive, &[])?;
    // Under a path of its own: the package finds its WebAssembly beside itself.
    let site = Site::under("/node_modules/snellius/", &npm_package()?)?;
    site.offer("/node_modules/snellius/scan.zip", std::fs::read(&archive)?);
    let url = site.offer("/node_modules/snellius/page.html", PAGE.as_bytes().to_vec());
    with_page("npm-package", |page| {
        page.open(&url)?;
        page.wait_long(PATIENCE * 4, "the package's result", "window.found")?;
        let found = page.value_of("window.found")?;
        assert_eq!(found["gaveUp"], "enough");
        let views = found["views"].as_u64().context("no views")?;
        let told = found["told"].as_array().context("no progress")?;
        assert_eq!(told.len() as u64, views + 1);
        assert_eq!(told.last(), Some(&serde_json::json!([views, views])));
        for (key, file) in [("json", "result.json"), ("ply", "object.ply")] {
            let bytes = expected.file(file)?;
            let same = found[key].as_str().map(str::as_bytes) == Some(&bytes);
            assert!(same, "{file} differs");
        }
        Ok(())
    })
}
