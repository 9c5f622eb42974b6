//! The page is seen before its program has arrived.

use anyhow::{Result, ensure};
use snellius_tests::{PATIENCE, Site, places, with_page, workbench::Workbench};

#[test]
fn the_page_is_seen_before_the_program_is_there() -> Result<()> {
    let site = Site::at_root(&places::dist()?)?;
    with_page("first-paint", |page| {
        page.hold_back("*.wasm")?;
        page.open(&site.url())?;
        page.wait_text("h1", "Measure objects in 3")?;
        page.wait_until(
            "the first paint",
            "performance.getEntriesByName('first-contentful-paint').length === 1",
        )?;
        let workbench = Workbench { page };
        let state = workbench.state()?;
        ensure!(state == "loading", "the state is {state}");
        page.screenshot("first-paint")?;
        page.let_through()?;
        workbench.wait_state("start", PATIENCE)
    })
}
