//! What is measured is kept in the browser, and the page works without a network.

use std::io::{Read, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use serde_json::Value;
use snellius_tests::{
    Browser, PATIENCE, Page, Site,
    companion::Output,
    places::{self, samples},
    workbench::{KEPT, RECONSTRUCTION, Workbench, part, wait_kept, wait_promise, with_workbench},
};

fn tank() -> Result<PathBuf> {
    let tank = samples()?
        .into_iter()
        .find(|path| path.ends_with("tank-paper.zip"));
    tank.context("no sample tank-paper.zip")
}

fn shelf(page: &Page) -> Result<String> {
    page.text(&part("sessions"))
}

fn result(workbench: &Workbench) -> Result<Value> {
    Ok(serde_json::from_slice(
        &workbench.download("download-json")?.bytes,
    )?)
}

/// Waits until the archive is kept whole, and spots that were found at two times.
fn wait_begun(page: &Page) -> Result<()> {
    let promise = "(async () => {
        const root = await navigator.storage.getDirectory();
        const read = async (folder, name) => (await folder.getFileHandle(name)).getFile();
        try {
            const sessions = await root.getDirectoryHandle('sessions');
            for await (const folder of sessions.values()) {
                const archive = await read(folder, 'scan.zip');
                const record = JSON.parse(await (await read(folder, 'session.json')).text());
                const second = await read(folder, 'found-000001');
                return archive.size === record.archive_bytes && second.size > 0;
            }
        } catch {}
        return false;
    })()";
    wait_promise(page, "the scan and some spots to be kept", promise)
}

/// Loads the page anew and goes on with the only session.
fn come_back(workbench: &Workbench) -> Result<()> {
    workbench.page.reload()?;
    workbench.wait_state("start", PATIENCE)?;
    workbench.click("go-on")?;
    workbench.wait_state("done", RECONSTRUCTION)
}

fn turn_index(workbench: &Workbench, index: &str) -> Result<()> {
    workbench.click("index-input")?;
    workbench.page.press("Control+a")?;
    workbench.page.type_text(index)?;
    workbench.page.press("Enter")
}

#[test]
fn a_session_goes_on_where_it_was_with_its_history() -> Result<()> {
    let archive = tank()?;
    with_workbench("session", |workbench| {
        let page = workbench.page;
        workbench.reconstruct(&archive)?;
        turn_index(workbench, "1.35")?;
        wait_kept(page, "1.35")?;
        let before = result(workbench)?;
        ensure!(before["media"]["inside"]["value"] == 1.35, "{before}");
        come_back(workbench)?;
        ensure!(result(workbench)? == before, "the result is another");
        workbench.click("undo")?;
        page.wait_long(
            RECONSTRUCTION,
            "the change to be taken back",
            "document.querySelector('[data-testid=redo]:not(:disabled)')
                && !document.querySelector('[data-state=running]:not(html)')",
        )?;
        let undone = result(workbench)?;
        let program = Output::of(&archive, &[])?;
        let expected: Value = serde_json::from_slice(&program.file("result.json")?)?;
        ensure!(undone == expected, "undo does not lead back");
        Ok(())
    })
}

#[test]
fn a_session_is_renamed_deleted_and_brought_back() -> Result<()> {
    with_workbench("shelf", |workbench| {
        let page = workbench.page;
        workbench.reconstruct(&tank()?)?;
        wait_kept(page, "Measured")?;
        page.reload()?;
        page.wait_text(&part("sessions"), "points from")?;
        page.screenshot("sessions")?;
        workbench.click("rename")?;
        page.wait_visible(&part("new-name"))?;
        page.type_text("Newt <b>no. 4</b>")?;
        page.press("Enter")?;
        page.wait_text(&part("sessions"), "Newt <b>no. 4</b>")?;
        wait_kept(page, "Newt")?;
        workbench.click("delete")?;
        page.wait_text(&part("sessions"), "is deleted")?;
        workbench.click("undelete")?;
        page.wait_text(&part("sessions"), "points from")?;
        wait_kept(page, "\"deleted\":false")?;
        workbench.click("delete")?;
        wait_kept(page, "\"deleted\":true")?;
        page.reload()?;
        workbench.wait_state("start", PATIENCE)?;
        page.wait_long(
            KEPT,
            "the session to be gone",
            "!document.querySelector('[data-testid=sessions]')",
        )
    })
}

#[test]
fn a_session_as_a_file_opens_elsewhere() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let file = folder.path().join("session.snellius.zip");
    let mut before = Value::Null;
    with_workbench("session-saved", |workbench| {
        workbench.reconstruct(&tank()?)?;
        turn_index(workbench, "1.36")?;
        wait_kept(workbench.page, "1.36")?;
        before = result(workbench)?;
        workbench.page.reload()?;
        workbench.wait_state("start", PATIENCE)?;
        let saved = workbench.download("save-session")?;
        ensure!(saved.name.ends_with(".snellius.zip"), "{}", saved.name);
        Ok(std::fs::write(&file, saved.bytes)?)
    })?;
    with_workbench("session-opened", |workbench| {
        workbench.reconstruct(&file)?;
        ensure!(result(workbench)? == before, "the result is another");
        Ok(())
    })
}

#[test]
fn a_session_that_cannot_be_read_blocks_nothing() -> Result<()> {
    with_workbench("broken-session", |workbench| {
        let page = workbench.page;
        page.value_of(
            "(async () => {
                const root = await navigator.storage.getDirectory();
                const sessions = await root.getDirectoryHandle('sessions', { create: true });
                for (const [id, text] of [['1', '{\"version\":99}'], ['2', '\\u0000'], ['3', null]]) {
                    const folder = await sessions.getDirectoryHandle(id, { create: true });
                    if (text === null) continue;
                    const file = await folder.getFileHandle('session.json', { create: true });
                    const stream = await file.createWritable();
                    await stream.write(text);
                    await stream.close();
                }
            })()",
        )?;
        page.reload()?;
        workbench.wait_state("start", PATIENCE)?;
        workbench.reconstruct(&tank()?)?;
        wait_kept(page, "Measured")?;
        page.reload()?;
        page.wait_text(&part("sessions"), "points from")
    })
}

/// The sample with its views many times over, so that measuring it takes a while.
fn long_scan(at: &Path, times: usize) -> Result<usize> {
    let mut sample = zip::ZipArchive::new(std::fs::File::open(tank()?)?)?;
    let mut manifest = String::new();
    sample.by_name("scan.json")?.read_to_string(&mut manifest)?;
    let mut manifest: Value = serde_json::from_str(&manifest)?;
    let views = manifest["views"].as_array().context("no views")?.clone();
    let again = (0..times).flat_map(|time| {
        views.iter().cloned().map(move |mut view| {
            view["id"] = format!("{}-{time}", view["id"].as_str().unwrap_or_default()).into();
            view
        })
    });
    manifest["views"] = again.collect();
    let mut long = zip::ZipWriter::new(std::fs::File::create(at)?);
    for index in 0..sample.len() {
        let entry = sample.by_index_raw(index)?;
        if entry.name()? != "scan.json" {
            long.raw_copy_file(entry)?;
        }
    }
    long.start_file("scan.json", zip::write::SimpleFileOptions::default())?;
    long.write_all(manifest.to_string().as_bytes())?;
    long.finish()?;
    Ok(views.len() * times)
}

/// Opens a scan of so many views, kills the browser in the middle of the run, and goes on.
fn killed_and_gone_on(views: usize, open: impl FnOnce(&Workbench) -> Result<()>) -> Result<()> {
    let site = Site::at_root(&places::dist()?)?;
    let mut browser = Browser::start()?;
    {
        let page = browser.new_page()?;
        page.open(&site.url())?;
        let workbench = Workbench { page: &page };
        workbench.wait_state("start", PATIENCE)?;
        open(&workbench)?;
        wait_begun(&page)?;
        let state = workbench.state()?;
        ensure!(
            state == "running",
            "it was {state} before it could be killed"
        );
    }
    browser.kill_and_restart()?;
    let page = browser.new_page()?;
    page.open(&site.url())?;
    let workbench = Workbench { page: &page };
    workbench.wait_state("start", PATIENCE)?;
    let kept = shelf(&page)?;
    ensure!(kept.contains("stopped at"), "{kept}");
    ensure!(kept.contains(&format!("of {views} views")), "{kept}");
    page.screenshot("session-after-kill")?;
    workbench.click("go-on")?;
    // What was found before the end is not looked for again.
    let first = page.value_of(
        "new Promise(found => {
            const look = () => {
                const value = document.querySelector('[data-testid=progress]')?.value;
                value > 0 ? found(value) : setTimeout(look, 5);
            };
            look();
        })",
    )?;
    ensure!(
        first.as_f64().unwrap_or_default() > 1.5,
        "it began with {first}"
    );
    workbench.wait_state("done", RECONSTRUCTION)?;
    ensure!(page.problems().is_empty(), "{:#?}", page.problems());
    Ok(())
}

#[test]
fn a_browser_killed_in_the_middle_of_a_run_goes_on() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let archive = folder.path().join("long.zip");
    let views = long_scan(&archive, 20)?;
    killed_and_gone_on(views, |workbench| workbench.choose(&archive))
}

/// A sample's, or another scan's, files in a folder of that name.
fn unpacked(archive: &Path, folder: &Path) -> Result<()> {
    Ok(zip::ZipArchive::new(std::fs::File::open(archive)?)?.extract(folder)?)
}

#[test]
fn a_dropped_folder_is_gone_on_with_after_the_browser_was_killed() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let archive = folder.path().join("long.zip");
    let views = long_scan(&archive, 20)?;
    let scan = folder.path().join("long");
    unpacked(&archive, &scan)?;
    killed_and_gone_on(views, |workbench| {
        workbench
            .page
            .drop_files(&part("drop-zone"), &[scan.as_path()])
    })
}

#[test]
fn a_dropped_folder_without_room_is_told_and_asked_for_again() -> Result<()> {
    let archive = tank()?;
    let expected: Value = serde_json::from_slice(&Output::of(&archive, &[])?.file("result.json")?)?;
    let folder = tempfile::tempdir()?;
    let scan = folder.path().join("tank");
    unpacked(&archive, &scan)?;
    with_workbench("session-folder-without-room", |workbench| {
        let page = workbench.page;
        wait_cached(page)?;
        page.leave_room(2_000_000)?;
        page.drop_files(&part("drop-zone"), &[scan.as_path()])?;
        workbench.wait_state("done", RECONSTRUCTION)?;
        page.wait_text(&part("not-kept"), "will ask for the folder")?;
        wait_kept(page, "Measured")?;
        page.reload()?;
        page.wait_text(&part("sessions"), "no copy of its folder is kept")?;
        page.choose_files(&part("folder-again"), &[scan.as_path()])?;
        workbench.wait_state("done", RECONSTRUCTION)?;
        ensure!(result(workbench)? == expected, "the result is another");
        Ok(())
    })
}

#[test]
fn after_a_first_visit_the_page_works_without_a_network() -> Result<()> {
    let archive = tank()?;
    let expected: Value = serde_json::from_slice(&Output::of(&archive, &[])?.file("result.json")?)?;
    let site = Site::at_root(&places::dist()?)?;
    let address = site.url();
    let browser = Browser::start()?;
    let page = browser.new_page()?;
    page.open(&address)?;
    page.wait_long(
        PATIENCE,
        "the page to be kept",
        "navigator.serviceWorker.controller?.state === 'activated'",
    )?;
    drop(site);
    page.open(&address)?;
    let workbench = Workbench { page: &page };
    workbench.wait_state("start", PATIENCE)?;
    workbench.reconstruct(&archive)?;
    ensure!(result(&workbench)? == expected, "the result is another");
    Ok(())
}

/// Waits until the page is cached, which takes room as well.
fn wait_cached(page: &Page) -> Result<()> {
    wait_promise(
        page,
        "the page to be cached",
        "navigator.serviceWorker.ready.then(() => true)",
    )
}

#[test]
fn an_archive_without_room_is_told_and_asked_for_again() -> Result<()> {
    let archive = tank()?;
    let expected: Value = serde_json::from_slice(&Output::of(&archive, &[])?.file("result.json")?)?;
    with_workbench("session-without-room", |workbench| {
        let page = workbench.page;
        wait_cached(page)?;
        page.leave_room(2_000_000)?;
        workbench.reconstruct(&archive)?;
        page.wait_text(
            &part("not-kept"),
            "No copy of \u{201c}tank-paper.zip\u{201d}",
        )?;
        page.wait_text(&part("not-kept"), "will ask for the file")?;
        page.screenshot("session-without-room")?;
        ensure!(result(workbench)? == expected, "the result is another");
        wait_kept(page, "Measured")?;
        page.reload()?;
        page.wait_text(&part("sessions"), "no copy of its archive is kept")?;
        page.choose_files(&part("archive-again"), &[&archive])?;
        workbench.wait_state("done", RECONSTRUCTION)?;
        ensure!(result(workbench)? == expected, "the result is another");
        Ok(())
    })
}

#[test]
fn without_any_room_the_measurement_goes_on() -> Result<()> {
    with_workbench("session-without-any-room", |workbench| {
        let page = workbench.page;
        wait_cached(page)?;
        page.leave_room(0)?;
        workbench.reconstruct(&tank()?)?;
        page.wait_text(&part("not-kept"), "what you do from now on is not kept")?;
        page.click("[aria-label='Close this note']")?;
        page.wait_until(
            "the note to be closed",
            "!document.querySelector('[data-testid=not-kept]').checkVisibility()",
        )?;
        turn_index(workbench, "1.34")?;
        page.wait_text(&part("stage-index"), "1.34")
    })
}
