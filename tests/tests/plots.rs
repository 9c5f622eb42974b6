//! The plots: drawn with axes and values, linked with everything else, saved as SVG and CSV.

use anyhow::{Context, Result, ensure};
use serde_json::Value;
use snellius_tests::{
    Page,
    places::samples,
    workbench::{part, with_workbench},
};

fn archive(name: &str) -> Result<std::path::PathBuf> {
    let ends = |path: &std::path::PathBuf| path.file_name().is_some_and(|file| file == name);
    let found = samples()?.into_iter().find(ends);
    found.with_context(|| format!("no sample {name}"))
}

/// Waits until a figure is drawn, and says how many values it has within reach of the keyboard.
fn drawn(page: &Page, figure: &str) -> Result<()> {
    page.wait_visible(&format!("{} .plot-drawing svg", part(figure)))
}

fn chosen(page: &Page) -> Result<String> {
    let row = page.value_of("document.querySelector('tr[aria-selected=true] th')?.innerText")?;
    Ok(row.as_str().unwrap_or_default().to_owned())
}

#[test]
fn plots_have_axes_and_values_and_choose_a_view_everywhere() -> Result<()> {
    with_workbench("plots", |workbench| {
        workbench.reconstruct(&archive("tank-paper.zip")?)?;
        let page = workbench.page;
        for figure in ["figure-top-view", "figure-top-view-without-refraction"] {
            drawn(page, figure)?;
            let text = page.value_of(&format!(
                "document.querySelector('{} svg').textContent",
                part(figure)
            ))?;
            let text = text.as_str().unwrap_or_default();
            ensure!(
                text.contains("Along the scan, mm") && text.contains("Behind the wall, mm"),
                "{figure} says {text:?}"
            );
        }
        page.screenshot("plots-top-view")?;

        // By keyboard from value to value; the view of the one that is told is chosen.
        let sheet = format!("{} .plot-sheet", part("figure-top-view"));
        page.tab_to(&sheet)?;
        for _ in 0..3 {
            page.press("ArrowRight")?;
        }
        let told = page.text(&format!("{} .plot-value", part("figure-top-view")))?;
        let view = told
            .strip_prefix("View ")
            .and_then(|rest| rest.split(',').next())
            .with_context(|| format!("{told:?} names no view"))?
            .to_owned();
        ensure!(told.contains(" mm"), "{told:?} has no unit");
        page.press("Enter")?;
        page.wait_until(
            "the row of the view",
            &format!(
                "document.querySelector('tr[aria-selected=true]')?.innerText.includes({})",
                Value::from(view.as_str())
            ),
        )?;

        // Another view is chosen in the table: both drawings ring it.
        workbench.click_row("0010")?;
        page.wait_until(
            "rings around view 0010",
            "document.querySelectorAll('.plot-marks .chosen').length >= 4",
        )?;

        // With the pointer, in the histogram's highest bar.
        workbench.click("plot-ray-distances")?;
        drawn(page, "figure-ray-distance-histogram")?;
        drawn(page, "figure-ray-distances")?;
        page.screenshot("plots-ray-distances")?;
        let before = chosen(page)?;
        let mark = page.value_of(
            "(() => {
                const figure = document.querySelector('[data-testid=figure-ray-distances]');
                const ring = figure.querySelector('.plot-drawing circle');
                const box = ring.getBoundingClientRect();
                const sheet = figure.querySelector('.plot-sheet').getBoundingClientRect();
                return [(box.x + box.width / 2 - sheet.x) / sheet.width,
                        (box.y + box.height / 2 - sheet.y) / sheet.height];
            })()",
        )?;
        let at = |i: usize| mark[i].as_f64().context("no dot");
        page.click_at(
            &format!("{} .plot-sheet", part("figure-ray-distances")),
            (at(0)?, at(1)?),
        )?;
        page.wait_until(
            "the first view to be chosen",
            "document.querySelector('tr[aria-selected=true]')?.innerText.includes('0000')",
        )?;
        ensure!(chosen(page)? != before, "the same view is chosen");

        for (subject, figure) in [
            ("plot-birds-eye", "figure-birds-eye-view"),
            ("plot-wall", "figure-wall-residuals"),
        ] {
            workbench.click(subject)?;
            drawn(page, figure)?;
            page.screenshot(subject)?;
        }
        Ok(())
    })
}

#[test]
fn plots_are_saved_as_drawing_and_table() -> Result<()> {
    with_workbench("plots-saved", |workbench| {
        workbench.reconstruct(&archive("jar.zip")?)?;
        let page = workbench.page;
        let saved = workbench.download("download-json")?;
        let result: Value = serde_json::from_slice(&saved.bytes)?;
        workbench.click("plot-ray-distances")?;
        drawn(page, "figure-ray-distances")?;
        let drawing = workbench.download("save-ray-distances.svg")?;
        ensure!(drawing.name == "ray-distances.svg", "{}", drawing.name);
        let drawing = String::from_utf8(drawing.bytes)?;
        ensure!(
            drawing.starts_with("<svg xmlns=") && drawing.contains("Ray distance, mm"),
            "{drawing:.200}"
        );
        let table = workbench.download("save-ray-distances.csv")?;
        let table = String::from_utf8(table.bytes)?;
        let mut lines = table.lines();
        assert_eq!(
            lines.next(),
            Some("series,view,Views in their order,Ray distance (mm)")
        );
        let views = result["views"].as_array().context("no views")?;
        for (line, view) in lines.zip(views) {
            let told: f64 = line.rsplit(',').next().unwrap_or_default().parse()?;
            assert_eq!(Some(told), view["ray_distance"].as_f64(), "{line}");
        }
        assert_eq!(table.lines().count(), views.len() + 1);

        // The curves over the index are computed when they are asked for.
        workbench.click("plot-index")?;
        drawn(page, "figure-ray-distance-against-n")?;
        page.screenshot("plot-index")?;
        Ok(())
    })
}

#[test]
fn plots_are_read_on_a_telephone_and_in_the_dark() -> Result<()> {
    with_workbench("plots-narrow", |workbench| {
        let page = workbench.page;
        page.set_size(360, 740)?;
        page.prefer_scheme("dark")?;
        workbench.reconstruct(&archive("line.zip")?)?;
        drawn(page, "figure-top-view")?;
        let letters = page.value_of(
            "(() => {
                const text = document.querySelector('.plot-drawing text');
                return text.getBoundingClientRect().height;
            })()",
        )?;
        let letters = letters.as_f64().context("no text")?;
        ensure!(letters > 9.0, "letters are {letters} px high");
        page.area(&part("figure-top-view"))?;
        page.screenshot("plots-360-dark")?;
        workbench.click("plot-ray-distances")?;
        page.wait_text(&part("figure-ray-distance-histogram"), "nothing to plot")?;
        workbench.click("plot-birds-eye")?;
        drawn(page, "figure-birds-eye-view")?;
        page.screenshot("plots-360-dark-birds-eye")?;
        Ok(())
    })
}

#[test]
fn the_angle_of_two_faces_is_drawn_against_the_index() -> Result<()> {
    with_workbench("plots-angle", |workbench| {
        workbench.reconstruct(&archive("angle.zip")?)?;
        let page = workbench.page;
        workbench.click("plot-index")?;
        let figure = "[data-testid^=figure-known-shape]";
        page.wait_long(
            snellius_tests::workbench::RECONSTRUCTION,
            "the curve of the angle",
            &format!("document.querySelector('{figure} svg')"),
        )?;
        let words = page.value_of(&format!("document.querySelector('{figure}').textContent"))?;
        let words = words.as_str().unwrap_or_default();
        ensure!(
            words.contains("Angle of two faces against n") && words.contains("\u{b0}"),
            "the figure says {words:?}"
        );
        // The angle falls or rises with n, all the way: Fig. 12.
        let table =
            page.download(|| page.click("[data-testid^=save-known-shape][data-testid$=csv]"))?;
        let table = String::from_utf8(table.bytes)?;
        let angles: Vec<f64> = table
            .lines()
            .skip(1)
            .filter_map(|line| line.rsplit(',').next()?.parse().ok())
            .collect();
        ensure!(angles.len() > 10, "the table says {table:.300}");
        page.screenshot("plots-angle").map(drop)
    })
}
