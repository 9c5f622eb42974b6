//! How the page looks on a telephone and on a desk, by day and by night. The screenshots are
//! kept in `target/e2e-screenshots` to be looked at; here is only what a program can judge.

use anyhow::{Result, ensure};
use snellius_tests::{
    Page,
    places::samples,
    workbench::{part, with_workbench},
};

const SIZES: [(u32, u32); 2] = [(360, 740), (1440, 900)];

/// No text or button hangs over the right edge.
fn fits(page: &Page, width: u32) -> Result<()> {
    let wide = page.value_of("document.scrollingElement.scrollWidth")?;
    let wide = wide.as_u64().unwrap_or(u64::MAX);
    ensure!(
        wide <= u64::from(width),
        "the page is {wide} pixels wide in a window of {width}"
    );
    Ok(())
}

/// Both schemes at one size; dark is darker than light.
fn both_schemes(page: &Page, stage: &str, (width, height): (u32, u32)) -> Result<()> {
    page.set_size(width, height)?;
    let mut brightness = vec![];
    for scheme in ["light", "dark"] {
        page.prefer_scheme(scheme)?;
        fits(page, width)?;
        // Colours may fade over; the 3-D view may be drawn anew.
        std::thread::sleep(std::time::Duration::from_millis(500));
        let picture = page.screenshot(&format!("{stage}-{width}-{scheme}"))?;
        brightness.push(picture.brightness());
    }
    let (light, dark) = (brightness[0], brightness[1]);
    ensure!(
        dark + 40.0 < light,
        "at {width}: light {light:.0}, dark {dark:.0}"
    );
    Ok(())
}

#[test]
fn the_start_fits_every_width_in_light_and_dark() -> Result<()> {
    with_workbench("start-appearance", |workbench| {
        SIZES
            .into_iter()
            .try_for_each(|size| both_schemes(workbench.page, "start", size))
    })
}

#[test]
fn the_form_of_a_scan_fits_every_width_in_light_and_dark() -> Result<()> {
    with_workbench("making-appearance", |workbench| {
        let page = workbench.page;
        workbench.click("make-scan")?;
        page.wait_visible(&part("part-media"))?;
        page.choose_option(&part("answer-frames"), "world-from-flange")?;
        page.wait_visible(&part("answer-hand-rotation"))?;
        SIZES
            .into_iter()
            .try_for_each(|size| both_schemes(page, "making", size))
    })
}

#[test]
fn the_result_fits_every_width_in_light_and_dark() -> Result<()> {
    let archive = samples()?.swap_remove(0);
    with_workbench("result-appearance", |workbench| {
        workbench.reconstruct(&archive)?;
        for size in SIZES {
            both_schemes(workbench.page, "result", size)?;
            // Whatever the width, what the work was for is there.
            workbench.page.wait_visible(&part("scene"))?;
            workbench.page.wait_visible(&part("download-json"))?;
        }
        Ok(())
    })
}
