//! The harness itself, held against a page of its own: what it says it does, it does, and what
//! must fail a test, does.

use std::{
    fs,
    path::{Path, PathBuf},
    sync::{Mutex, PoisonError},
};

use anyhow::Result;
use snellius_tests::{Browser, Page, Site, with_page};

fn fixture() -> Site {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/page");
    Site::at_root(&directory).unwrap()
}

fn opened<'a>(page: &'a Page<'a>, url: &str) -> Result<&'a Page<'a>> {
    page.open(url)?;
    page.wait_until(
        "the script to end",
        "document.documentElement.dataset.ready",
    )?;
    Ok(page)
}

#[test]
fn a_click_waits_until_the_button_is_free() -> Result<()> {
    let site = fixture();
    with_page("harness-click", |page| {
        opened(page, &site.url())?.click("#late")?;
        page.wait_text("#said", "clicked")?;
        page.click("#switch")?;
        page.wait_text("#said", "switch true")
    })
}

#[test]
fn keys_reach_the_focused_element() -> Result<()> {
    let site = fixture();
    with_page("harness-keys", |page| {
        opened(page, &site.url())?.tab_to("#switch")?;
        page.press("Space")?;
        page.wait_text("#said", "switch true")?;
        page.press("Tab")?;
        assert!(page.has_focus("#name")?);
        page.type_text("Willebrord")?;
        page.press("!")?;
        page.press("Enter")?;
        page.wait_text("#said", "name Willebrord!")?;
        page.press("Shift+Tab")?;
        assert!(page.has_focus("#switch")?);
        Ok(())
    })
}

#[test]
fn files_come_in_by_dialog_and_by_drop_and_go_out_by_download() -> Result<()> {
    let site = fixture();
    let directory = tempfile::tempdir()?;
    let file = directory.path().join("note.txt");
    fs::write(&file, "angle of incidence")?;
    with_page("harness-files", |page| {
        opened(page, &site.url())?.choose_files("#file", &[&file])?;
        page.wait_text("#said", "note.txt: angle of incidence")?;

        fs::write(&file, "angle of refraction")?;
        page.drop_files("#zone", &[&file])?;
        page.wait_text("#said", "note.txt: angle of refraction")?;

        let saved = page.download(|| page.click("#save"))?;
        assert_eq!(saved.name, "table.csv");
        assert_eq!(saved.bytes, b"one\ntwo\n");
        Ok(())
    })
}

#[test]
fn a_drawing_in_three_d_is_seen_and_follows_the_mouse() -> Result<()> {
    let site = fixture();
    with_page("harness-canvas", |page| {
        opened(page, &site.url())?;
        let before = page.settled_picture_of("#scene")?;
        assert_eq!(before.size(), (200, 100));
        assert_eq!(before.coloured_pixels(), 200 * 100);
        assert_eq!(before.distinct_colours(), 2);
        assert_eq!(before.region(0, 0, 90, 100).distinct_colours(), 1);

        page.drag("#scene", (0.5, 0.5), (0.25, 0.5))?;
        let after = page.settled_picture_of("#scene")?;
        let changed = after.changed_from(&before);
        assert!((changed - 0.25).abs() < 0.01, "{changed}");

        page.wheel("#scene", 120.0)?;
        page.wait_text("#said", "wheel 120")
    })
}

#[test]
fn size_and_colour_scheme_can_be_chosen() -> Result<()> {
    let site = fixture();
    with_page("harness-scheme", |page| {
        opened(page, &site.url())?.set_size(360, 640)?;
        page.prefer_scheme("light")?;
        let light = page.screenshot("harness-light")?;
        assert_eq!(light.size(), (360, 640));
        page.prefer_scheme("dark")?;
        let dark = page.screenshot("harness-dark")?;
        assert_eq!(light.pixel(350, 600), [255; 3]);
        assert_eq!(dark.pixel(350, 600), [0; 3]);
        Ok(())
    })
}

#[test]
fn a_page_below_the_root_of_a_site_finds_its_files() -> Result<()> {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/page");
    let site = Site::under("/some/where/", &directory)?;
    with_page("harness-sub-path", |page| {
        opened(page, &site.url())?;
        assert!(
            page.requests()
                .iter()
                .all(|url| url.starts_with(&site.url()) || url == "data:,")
        );
        Ok(())
    })
}

#[test]
fn what_is_not_there_is_an_error_that_names_it() -> Result<()> {
    let site = fixture();
    with_page("harness-missing-element", |page| {
        opened(page, &site.url())?;
        let error = page.tab_to("#said").unwrap_err();
        assert!(format!("{error:#}").contains("#said"), "{error:#}");
        Ok(())
    })
}

/// The reason a test fails with when its page does what `fragment` says.
fn failure_of(fragment: &str, sign: impl Fn(&Page) -> bool) -> String {
    let site = fixture();
    let outcome = with_page("harness-expected-failure", |page| {
        opened(page, &format!("{}#{fragment}", site.url()))?;
        for _ in 0..500 {
            if sign(page) {
                return Ok(());
            }
            std::thread::sleep(std::time::Duration::from_millis(20));
        }
        panic!("#{fragment} left no sign");
    });
    format!("{:#}", outcome.expect_err(fragment))
}

#[test]
fn an_error_on_the_console_fails_a_test() {
    let reason = failure_of("console", |page| !page.problems().is_empty());
    assert!(reason.contains("a complaint 7"), "{reason}");
}

#[test]
fn an_exception_in_a_worker_fails_a_test() {
    let reason = failure_of("worker-error", |page| !page.problems().is_empty());
    assert!(reason.contains("from the worker"), "{reason}");
}

#[test]
fn a_file_that_is_not_there_fails_a_test() {
    let reason = failure_of("missing", |page| !page.problems().is_empty());
    assert!(reason.contains("no-such-file"), "{reason}");
}

#[test]
fn a_request_of_a_worker_beyond_this_machine_is_seen() {
    let reason = failure_of("worker-request", |page| !page.foreign_requests().is_empty());
    assert!(reason.contains("far-away.example"), "{reason}");
}

#[test]
fn nothing_is_left_of_a_browser_even_after_a_panic() {
    let left: Mutex<Option<(PathBuf, u32)>> = Mutex::default();
    let panicked = std::panic::catch_unwind(|| {
        let browser = Browser::start().unwrap();
        let page = browser.new_page().unwrap();
        page.open("about:blank").unwrap();
        *left.lock().unwrap() = Some((browser.directory().to_owned(), browser.process_id()));
        panic!("on purpose");
    });
    assert!(panicked.is_err());
    let (directory, process) = left
        .into_inner()
        .unwrap_or_else(PoisonError::into_inner)
        .unwrap();
    assert!(!directory.exists(), "{} is left", directory.display());
    if cfg!(target_os = "linux") {
        assert!(!Path::new("/proc").join(process.to_string()).exists());
    }
}
