//! Files that are no scan: the page says what is wrong and what to do, and goes on working.

use std::{
    fs,
    io::{Cursor, Write},
    path::PathBuf,
};

use anyhow::{Result, ensure};
use snellius_tests::{
    PATIENCE,
    places::samples,
    workbench::{Workbench, part, with_workbench},
};
use zip::{ZipWriter, write::SimpleFileOptions};

/// Words of which one must be in the alert: it shall say what to do next.
const NEXT_STEPS: [&str; 10] = [
    "choose", "try", "export", "copy", "check", "open", "add", "pick", "again", "download",
];

/// Shows a wrong file to the page and gives what the alert says.
fn alert_about(workbench: &Workbench, name: &str, content: &[u8]) -> Result<String> {
    let directory = tempfile::tempdir()?;
    let file = directory.path().join(name);
    fs::write(&file, content)?;
    workbench.choose(&file)?;
    workbench.wait_failed(PATIENCE)?;
    let alert = workbench.page.text(&part("error"))?;
    workbench.page.screenshot(&format!("wrong-file-{name}"))?;
    let role = workbench.page.value_of(
        "document.querySelector('[data-testid=error]').closest('[role=alert]') !== null",
    )?;
    ensure!(role == true, "screen readers are not told of {alert:?}");
    Ok(alert)
}

/// The alert names the cause, by one of some words, and says what to do.
fn helps(alert: &str, causes: &[&str]) -> Result<()> {
    let lower = alert.to_lowercase();
    let says = |words: &[&str]| words.iter().any(|word| lower.contains(word));
    ensure!(
        says(causes),
        "{alert:?} does not name the cause: one of {causes:?}"
    );
    ensure!(says(&NEXT_STEPS), "{alert:?} does not say what to do next");
    Ok(())
}

fn still_works(workbench: &Workbench) -> Result<()> {
    let archive: PathBuf = samples()?.swap_remove(0);
    workbench.reconstruct(&archive)?;
    assert_eq!(workbench.alert(), "", "the alert outlives its cause");
    Ok(())
}

#[test]
fn a_text_that_calls_itself_a_zip() -> Result<()> {
    with_workbench("text-as-zip", |workbench| {
        let alert = alert_about(workbench, "notes.zip", b"n1 sin t1 = n2 sin t2")?;
        helps(&alert, &["zip", "archive"])?;
        still_works(workbench)
    })
}

#[test]
fn an_archive_that_was_cut_off() -> Result<()> {
    let whole = fs::read(&samples()?[0])?;
    with_workbench("cut-off-zip", |workbench| {
        let alert = alert_about(workbench, "cut-off.zip", &whole[..whole.len() / 2])?;
        helps(
            &alert,
            &[
                "cut",
                "truncated",
                "incomplete",
                "damaged",
                "end of central directory",
                "not a zip",
            ],
        )?;
        still_works(workbench)
    })
}

#[test]
fn an_archive_without_a_manifest() -> Result<()> {
    let mut archive = ZipWriter::new(Cursor::new(vec![]));
    archive.start_file("holiday/beach.txt", SimpleFileOptions::default())?;
    archive.write_all(b"sand")?;
    let content = archive.finish()?.into_inner();
    with_workbench("no-manifest", |workbench| {
        let alert = alert_about(workbench, "holiday.zip", &content)?;
        helps(&alert, &["scan.json"])?;
        still_works(workbench)
    })
}

#[test]
fn a_wrong_file_dropped_on_the_page() -> Result<()> {
    let directory = tempfile::tempdir()?;
    let file = directory.path().join("notes.zip");
    fs::write(&file, "no archive")?;
    with_workbench("wrong-drop", |workbench| {
        workbench.page.drop_files(&part("drop-zone"), &[&file])?;
        workbench.wait_failed(PATIENCE)?;
        helps(&workbench.alert(), &["zip", "archive"])?;
        still_works(workbench)
    })
}

#[test]
fn what_went_wrong_is_copied_with_version_and_details() -> Result<()> {
    with_workbench("copy-details", |workbench| {
        let page = workbench.page;
        let alert = alert_about(workbench, "letters.zip", b"n1 sin t1 = n2 sin t2")?;
        page.value_of(
            "void (navigator.clipboard.writeText = text => {
                window.copied = text;
                return Promise.resolve();
            })",
        )?;
        workbench.click("copy-details")?;
        page.wait_text(&part("copy-details"), "Copied")?;
        let copied = page.value_of("window.copied")?;
        let copied = copied.as_str().unwrap_or_default();
        let cause = alert.lines().next().unwrap_or_default();
        for word in [
            cause,
            env!("CARGO_PKG_VERSION"),
            "next step:",
            "letters.zip",
            "Chrome",
        ] {
            ensure!(copied.contains(word), "{copied:?} lacks {word:?}");
        }

        // A browser that forbids it: the details are shown, to be copied by hand.
        page.click("[aria-label='Close this message']")?;
        workbench.wait_state("start", PATIENCE)?;
        alert_about(workbench, "more-letters.zip", b"sin t1 / sin t2 = n2 / n1")?;
        page.value_of(
            "void (navigator.clipboard.writeText = () => Promise.reject(new Error('no')))",
        )?;
        workbench.click("copy-details")?;
        page.wait_text("[data-testid=error] .problem-details", "more-letters.zip")?;
        page.screenshot("details-by-hand").map(drop)
    })
}
