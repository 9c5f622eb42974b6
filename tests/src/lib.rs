//! What the end-to-end tests share: the built page is served from a free loopback port, a real
//! headless Chromium uses it as a person would, and what comes out is held against what the
//! companion program says.
//!
//! | file | what it is |
//! |---|---|
//! | `places.rs` | where page, companion program, browser and samples lie |
//! | `server.rs` | a static host |
//! | `browser.rs`, `cdp.rs` | one Chromium, and the protocol it is spoken to in |
//! | `page.rs`, `keys.rs` | mouse, keys, files, downloads, screenshots |
//! | `journal.rs` | what the page and its workers said and asked for |
//! | `copies.rs` | scans as large as one likes |
//! | `picture.rs` | what a screenshot shows |
//! | `companion.rs` | what the companion program makes of the same scan |
//! | `workbench.rs` | the page of this project: its elements and states by name |
#![allow(
    clippy::print_stderr,
    reason = "what a page said is printed where its test fails"
)]

mod browser;
mod cdp;
pub mod companion;
pub mod copies;
mod journal;
mod keys;
mod page;
mod picture;
pub mod places;
mod server;
mod wait;
pub mod workbench;

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

use anyhow::{Result, ensure};

pub use browser::{Browser, Process};
pub use page::{Area, Download, PATIENCE, Page};
pub use picture::Picture;
pub use server::Site;

/// Runs a test with an empty page of a fresh Chromium. When it fails, the console is printed and
/// a screenshot is kept. It also fails when the page had an uncaught error, wrote
/// one to the console, missed a file, or asked for anything beyond this machine.
pub fn with_page(name: &str, test: impl FnOnce(&Page) -> Result<()>) -> Result<()> {
    let browser = Browser::start()?;
    let page = browser.new_page()?;
    // A failing assertion must not end the test before the page has been asked what it said.
    let outcome = catch_unwind(AssertUnwindSafe(|| {
        test(&page)?;
        nothing_went_wrong(&page)
    }));
    if !matches!(outcome, Ok(Ok(()))) {
        report(&page, name);
    }
    outcome.unwrap_or_else(|panic| resume_unwind(panic))
}

fn nothing_went_wrong(page: &Page) -> Result<()> {
    let problems = page.problems();
    ensure!(problems.is_empty(), "the page had errors: {problems:#?}");
    let foreign = page.foreign_requests();
    ensure!(
        foreign.is_empty(),
        "the page asked the network for {foreign:#?}"
    );
    Ok(())
}

fn report(page: &Page, name: &str) {
    eprintln!("{name} failed. Console:");
    for line in page.console() {
        eprintln!("  {line}");
    }
    match page.screenshot(&format!("failed-{name}")) {
        Ok(_) => eprintln!("screenshot: e2e-screenshots/failed-{name}.png"),
        Err(error) => eprintln!("no screenshot: {error:#}"),
    }
}
