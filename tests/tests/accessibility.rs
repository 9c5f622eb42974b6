//! Every screen is examined by axe-core: wide and narrow, by day and by night, it finds no fault that is
//! serious or critical.

use std::{
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context, Result, ensure};
use serde_json::Value;
use snellius_tests::{
    PATIENCE, Page,
    places::{axe, samples},
    with_page,
    workbench::{RECONSTRUCTION, Workbench, part, with_workbench},
};

const SIZES: [(u32, u32); 2] = [(360, 740), (1440, 900)];

fn sample(name: &str) -> Result<PathBuf> {
    let found = samples()?.into_iter().find(|path| path.ends_with(name));
    found.with_context(|| format!("no sample {name}"))
}

/// What axe-core says of the page as it is: the rule, the elements, the help.
fn faults(page: &Page) -> Result<Vec<String>> {
    page.value_of(&fs::read_to_string(axe()?)?)?;
    let found = page.value_of(
        "axe.run(document, { resultTypes: ['violations'] }).then(({ violations }) => violations
            .filter(({ impact }) => ['serious', 'critical'].includes(impact))
            .map(({ id, help, nodes }) => `${id}: ${help}: ${nodes.slice(0, 5)
                .map(({ target, failureSummary }) => target.join(' ') + ' (' + failureSummary + ')')}`))",
    )?;
    Ok(serde_json::from_value(found)?)
}

/// Examines a screen in every size and scheme.
fn examine(page: &Page, screen: &str) -> Result<Vec<String>> {
    let mut all = vec![];
    for (width, height) in SIZES {
        page.set_size(width, height)?;
        for scheme in ["light", "dark"] {
            page.prefer_scheme_at_rest(scheme)?;
            let here = format!("{screen}, {width} px, {scheme}");
            all.extend(
                faults(page)?
                    .into_iter()
                    .map(|fault| format!("{here}: {fault}")),
            );
        }
    }
    Ok(all)
}

fn clean(faults: &[String]) -> Result<()> {
    ensure!(faults.is_empty(), "axe-core finds {faults:#?}");
    Ok(())
}

#[test]
fn axe_sees_faults() -> Result<()> {
    with_workbench("axe-sees", |workbench| {
        let page = workbench.page;
        page.value_of(
            "void document.querySelector('main').insertAdjacentHTML('beforeend',
                '<img src=\"data:,\"><button></button>')",
        )?;
        let found = faults(page)?.join("\n");
        ensure!(
            found.contains("image-alt") && found.contains("button-name"),
            "of a picture and a button without a name it says {found:?}"
        );
        Ok(())
    })
}

#[test]
fn the_start_the_run_and_a_refusal_have_no_fault() -> Result<()> {
    with_workbench("axe-start", |workbench| {
        let page = workbench.page;
        page.wait_visible("[data-testid^=sample-]")?;
        let mut found = examine(page, "start")?;
        page.hold_back("*worker*.wasm")?;
        workbench.choose(&sample("jar.zip")?)?;
        workbench.wait_state("running", PATIENCE)?;
        found.extend(examine(page, "running")?);
        page.let_through()?;
        workbench.wait_state("done", RECONSTRUCTION)?;

        let directory = tempfile::tempdir()?;
        let file = directory.path().join("notes.zip");
        fs::write(&file, b"n1 sin t1 = n2 sin t2")?;
        workbench.choose(&file)?;
        workbench.wait_failed(PATIENCE)?;
        found.extend(examine(page, "refusal")?);
        clean(&found)
    })
}

#[test]
fn the_form_of_a_scan_has_no_fault() -> Result<()> {
    with_workbench("axe-making", |workbench| {
        let page = workbench.page;
        page.wait_visible(&part("make-scan"))?;
        workbench.click("make-scan")?;
        page.wait_visible(&part("part-media"))?;
        let directory = tempfile::tempdir()?;
        let names = ["1_on.png", "1_off.png", "2_on.png"];
        let files = names.map(|name| directory.path().join(name));
        for file in &files {
            fs::write(file, b"a picture")?;
        }
        page.choose_files(&part("pictures-input"), &[&files[0], &files[1], &files[2]])?;
        page.wait_visible(&part("unpaired"))?;
        page.value_of("document.querySelectorAll('details').forEach(part => part.open = true)")?;
        clean(&examine(page, "form")?)?;
        let silent = silent_stops(page)?;
        ensure!(silent.is_empty(), "no focus is seen on {silent:#?}");
        Ok(())
    })
}

#[test]
fn the_result_with_everything_open_has_no_fault() -> Result<()> {
    with_workbench("axe-result", |workbench| {
        let page = workbench.page;
        workbench.reconstruct(&sample("jar.zip")?)?;
        page.prefer_scheme_at_rest("light")?;
        open_everything(page)?;
        let mut found = vec![];
        for subject in ["top-view", "birds-eye", "ray-distances", "wall", "index"] {
            workbench.click(&format!("plot-{subject}"))?;
            page.wait_visible(".plot-drawing svg")?;
            found.extend(
                faults(page)?
                    .into_iter()
                    .map(|fault| format!("{subject}: {fault}")),
            );
        }
        page.choose_option(&part("measure"), "angle")?;
        found.extend(examine(page, "result")?);
        page.press("?")?;
        page.wait_visible(&part("help"))?;
        found.extend(examine(page, "keys")?);
        clean(&found)
    })
}

#[test]
fn a_stage_that_fails_has_no_fault() -> Result<()> {
    with_workbench("axe-stage", |workbench| {
        let page = workbench.page;
        workbench.reconstruct(&sample("tank-paper.zip")?)?;
        open_everything(page)?;
        fail_the_spots(workbench)?;
        clean(&examine(page, "failed stage")?)
    })
}

/// Asks for spots so large that there are none.
fn fail_the_spots(workbench: &Workbench) -> Result<()> {
    let page = workbench.page;
    let area = part("spots.smallest_area");
    page.wait_visible(&area)?;
    page.value_of(&format!(
        "(() => {{
            const field = document.querySelector({});
            field.value = field.max;
            field.dispatchEvent(new Event('input', {{ bubbles: true }}));
            field.dispatchEvent(new Event('change', {{ bubbles: true }}));
        }})()",
        Value::from(area.as_str())
    ))?;
    page.wait_long(
        RECONSTRUCTION,
        "a stage to fail",
        "document.querySelector('[data-testid=stage-problem]')?.checkVisibility()",
    )
}

/// Opens whatever can be folded.
fn open_everything(page: &Page) -> Result<()> {
    page.value_of("document.querySelectorAll('details').forEach(part => part.open = true)")?;
    page.wait_long(
        RECONSTRUCTION,
        "the table of methods",
        "document.querySelector('[data-testid=index-methods]')?.checkVisibility()",
    )
}

#[test]
fn the_lab_has_no_fault() -> Result<()> {
    with_workbench("axe-lab", |workbench| {
        let page = workbench.page;
        page.wait_visible(&part("open-lab"))?;
        page.click(&part("open-lab"))?;
        page.wait_visible(&part("lab"))?;
        let mut found = vec![];
        for tab in ["bench", "see", "index", "lessons"] {
            page.click(&part(&format!("tab-{tab}")))?;
            found.extend(examine(page, &format!("lab, {tab}"))?);
        }
        page.click(&part("lesson-1"))?;
        page.wait_visible(&part("lesson"))?;
        found.extend(examine(page, "lesson")?);
        clean(&found)
    })
}

/// Goes once round the page by Tab, and gives the elements that do not show that they have the focus.
fn silent_stops(page: &Page) -> Result<Vec<String>> {
    const MOST: usize = 250;
    let mut silent = vec![];
    let mut stops = 0;
    for _ in 0..MOST {
        page.press("Tab")?;
        let stop = page.value_of(
            "(() => {
                const element = document.activeElement;
                if (!element || element === document.body) return null;
                if (element.stopped) return 'again';
                element.stopped = true;
                const style = getComputedStyle(element);
                const shows = style.outlineStyle !== 'none' && parseFloat(style.outlineWidth) >= 1;
                return shows ? 'shown' : element.outerHTML.slice(0, 120);
            })()",
        )?;
        match stop.as_str() {
            None => {}
            Some("again") => break,
            Some("shown") => stops += 1,
            Some(element) => silent.push(element.to_owned()),
        }
    }
    ensure!(stops > 5, "Tab stops at {stops} elements");
    Ok(silent)
}

#[test]
fn whatever_has_the_focus_shows_it() -> Result<()> {
    with_workbench("focus-shown", |workbench| {
        let page = workbench.page;
        page.wait_visible("[data-testid^=sample-]")?;
        let at_start = silent_stops(page)?;
        ensure!(at_start.is_empty(), "no focus is seen on {at_start:#?}");
        workbench.reconstruct(&sample("jar.zip")?)?;
        page.value_of("document.querySelectorAll('details').forEach(part => part.open = true)")?;
        let in_result = silent_stops(page)?;
        ensure!(in_result.is_empty(), "no focus is seen on {in_result:#?}");
        Ok(())
    })
}

#[test]
fn nothing_moves_for_those_who_do_not_wish_it() -> Result<()> {
    with_workbench("no-motion", |workbench| {
        let page = workbench.page;
        page.prefer_scheme_at_rest("light")?;
        workbench.reconstruct(&sample("jar.zip")?)?;
        let moving = page.value_of(
            "[...document.querySelectorAll('*')].filter(element => {
                const style = getComputedStyle(element);
                const lasts = times => times.split(',').some(time => parseFloat(time) > 0);
                return lasts(style.transitionDuration)
                    || (style.animationName !== 'none' && lasts(style.animationDuration));
            }).map(element => element.outerHTML.slice(0, 120))",
        )?;
        let moving: Vec<String> = serde_json::from_value(moving)?;
        ensure!(moving.is_empty(), "these move: {moving:#?}");
        Ok(())
    })
}

/// The page that waits for the liquid's index, and the refusal of a file in front of a result.
#[test]
fn a_scan_that_wants_its_index_has_no_fault() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let scan = folder.path().join("unknown.zip");
    without_index(&sample("jar.zip")?, &scan)?;
    with_workbench("axe-index", |workbench| {
        let page = workbench.page;
        workbench.choose(&scan)?;
        workbench.wait_state("done", RECONSTRUCTION)?;
        page.wait_visible(&part("index-input"))?;
        clean(&examine(page, "index wanted")?)
    })
}

/// A scan whose manifest does not say the liquid's index.
fn without_index(from: &Path, to: &Path) -> Result<()> {
    let mut archive = zip::ZipArchive::new(fs::File::open(from)?)?;
    let mut manifest: Value = serde_json::from_reader(archive.by_name("scan.json")?)?;
    manifest["media"]["inside"] = Value::Null;
    let mut changed = zip::ZipWriter::new(fs::File::create(to)?);
    for index in 0..archive.len() {
        let entry = archive.by_index_raw(index)?;
        if entry.name()? != "scan.json" {
            changed.raw_copy_file(entry)?;
        }
    }
    changed.start_file("scan.json", zip::write::SimpleFileOptions::default())?;
    serde_json::to_writer(&mut changed, &manifest)?;
    changed.finish()?;
    Ok(())
}

#[test]
fn the_shelf_of_sessions_has_no_fault() -> Result<()> {
    with_workbench("axe-shelf", |workbench| {
        let page = workbench.page;
        workbench.reconstruct(&sample("jar.zip")?)?;
        page.click("header button:last-child")?;
        page.wait_text(&part("sessions"), "points from")?;
        let mut found = examine(page, "shelf")?;
        workbench.click("rename")?;
        page.wait_visible(&part("new-name"))?;
        found.extend(examine(page, "shelf, renaming")?);
        page.press("Escape")?;
        clean(&found)
    })
}

#[test]
fn a_line_with_a_marked_part_has_no_fault() -> Result<()> {
    with_workbench("axe-line", |workbench| {
        let page = workbench.page;
        workbench.reconstruct(&sample("line.zip")?)?;
        page.tab_to(&part("picture-on-frame"))?;
        page.press("ArrowRight")?;
        page.press("Enter")?;
        page.wait_visible(&part("say-stray"))?;
        clean(&examine(page, "line, marked")?)
    })
}

#[test]
fn a_page_of_one_file_has_no_fault() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let file = folder.path().join("page.html");
    with_workbench("axe-one-file-made", |workbench| {
        workbench.reconstruct(&sample("jar.zip")?)?;
        let page = workbench.download("download-page")?;
        Ok(fs::write(&file, page.bytes)?)
    })?;
    with_page("axe-one-file", |page| {
        page.open(&format!("file://{}", file.display()))?;
        page.wait_long(
            RECONSTRUCTION,
            "the page to show something",
            "document.body.dataset.state === 'done'",
        )?;
        clean(&examine(page, "page of one file")?)
    })
}
