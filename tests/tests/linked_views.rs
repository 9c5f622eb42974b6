//! One view is chosen everywhere at once, is looked at as near as a pixel, and what its spots are can be
//! said; what was measured is measured with.

use std::path::PathBuf;

use anyhow::{Context, Result, ensure};
use serde_json::Value;
use snellius_tests::{
    Page,
    copies::line_copies,
    places::samples,
    workbench::{RECONSTRUCTION, Workbench, part, with_workbench},
};

fn jar() -> Result<PathBuf> {
    let samples = samples()?;
    let jar = samples.into_iter().find(|path| path.ends_with("jar.zip"));
    jar.context("no sample jar.zip")
}

/// The view that table, strip and pictures show as chosen.
fn chosen(page: &Page) -> Result<[String; 3]> {
    let views = page.value_of(
        "[
            document.querySelector('tr[aria-selected=true] th').innerText,
            document.querySelector('.thumb[aria-selected=true] .thumb-name').innerText.trim(),
            document.querySelector('#pictures-title').innerText.replace('Pictures of view ', ''),
        ]",
    )?;
    Ok(serde_json::from_value(views)?)
}

fn ensure_chosen(page: &Page, view: &str) -> Result<()> {
    let chosen = chosen(page)?;
    ensure!(
        chosen.iter().all(|shown| shown == view),
        "view {view} is chosen, and {chosen:?} are shown"
    );
    Ok(())
}

fn wait_views_used(workbench: &Workbench, used: &str) -> Result<()> {
    let condition = format!(
        "!document.querySelector('[data-state=running]:not(html)')
            && document.querySelector('[data-testid=summary]').innerText.includes({})",
        Value::from(used)
    );
    let what = format!("{used} views");
    workbench.page.wait_long(RECONSTRUCTION, &what, &condition)
}

#[test]
fn a_view_is_chosen_everywhere_and_what_its_spot_is_can_be_said() -> Result<()> {
    with_workbench("linked-views", |workbench| {
        workbench.reconstruct(&jar()?)?;
        let page = workbench.page;
        workbench.click_row("0003")?;
        ensure_chosen(page, "0003")?;
        page.tab_to(".thumb[aria-selected=true]")?;
        page.press("ArrowRight")?;
        ensure_chosen(page, "0004")?;
        page.press("n")?;
        ensure_chosen(page, "0005")?;
        page.wait_until(
            "the thumbnail of a view",
            "document.querySelector('.thumb[aria-selected=true] canvas').width === 88",
        )?;
        page.screenshot("linked-views")?;

        // As near as a pixel, by keyboard.
        workbench.click("zoom-64")?;
        page.tab_to(&part("picture-on-frame"))?;
        page.press("ArrowRight")?;
        let told = page.text(&part("grey-values"))?;
        let numbers: Vec<i32> = told
            .split(|c: char| !c.is_ascii_digit() && c != '\u{2212}')
            .filter_map(|word| word.replace('\u{2212}', "-").parse().ok())
            .collect();
        let [_, _, on, off, difference] = numbers[..] else {
            anyhow::bail!("{told:?} does not tell the grey values");
        };
        assert_eq!(on - off, difference, "{told}");
        page.screenshot("grey-values")?;
        workbench.click("zoom-2")?;

        // The object's spot is called a stray one: its view has no point any more, until that is undone.
        wait_views_used(workbench, "27 of 27")?;
        page.tab_to("[data-testid=spots] li:has(option[value=object]:checked) select")?;
        page.press("s")?;
        wait_views_used(workbench, "26 of 27")?;
        let row = page.text("tr[aria-selected=true]")?;
        ensure!(row.contains("no object spot"), "the row says {row:?}");
        let spots = page.text(&part("spots"))?;
        ensure!(spots.contains("as you say"), "the list says {spots:?}");
        page.screenshot("spot-said")?;
        page.press("Control+z")?;
        wait_views_used(workbench, "27 of 27")
    })
}

#[test]
fn the_scene_is_looked_at_from_all_sides_and_measured_in() -> Result<()> {
    with_workbench("measuring", |workbench| {
        workbench.reconstruct(&jar()?)?;
        let page = workbench.page;
        let saved = workbench.download("download-json")?;
        let result: Value = serde_json::from_slice(&saved.bytes)?;
        let mut seen = vec![page.settled_picture_of(&part("scene"))?];
        for key in ["1", "3", "7", "5"] {
            page.press(key)?;
            let next = page.settled_picture_of(&part("scene"))?;
            let last = seen.last().context("there is a first")?;
            ensure!(next.changed_from(last) > 0.001, "{key} changes nothing");
            seen.push(next);
        }
        page.screenshot("from-above-parallel")?;

        // Points with larger ray distances are hidden.
        page.tab_to(&part("hide-above"))?;
        for _ in 0..50 {
            page.press("ArrowLeft")?;
        }
        let legend = page.text(&part("legend"))?;
        ensure!(
            legend.contains("of 27 points"),
            "the legend says {legend:?}"
        );
        page.press("End")?;

        // From one view's point to the next one's.
        workbench.click_row("0004")?;
        page.tab_to(&part("measure"))?;
        page.press("d")?;
        page.press("Tab")?;
        page.press("m")?;
        page.press("n")?;
        page.press("m")?;
        let told = page.text(&part("measured"))?;
        page.screenshot("measured")?;
        let place = |view: usize, axis: usize| {
            let coordinate = result["views"][view]["object"][axis].as_f64();
            coordinate.context("no object point")
        };
        let mut square = 0.0;
        for axis in 0..3 {
            let apart = place(4, axis)? - place(5, axis)?;
            square += apart * apart;
        }
        let expected = square.sqrt();
        let value: f64 = told.split(' ').next().context("nothing")?.parse()?;
        ensure!(
            (value - expected).abs() < 0.001 && told.contains("\u{b1} 0.0") && told.ends_with("mm"),
            "{told:?} is not {expected} mm with its plus and minus"
        );

        page.press("?")?;
        page.wait_visible(&part("help"))?;
        page.screenshot("keys")?;
        page.press("Escape")?;
        page.wait_until(
            "the sheet to close",
            "!document.querySelector('[data-testid=help]').open",
        )
    })
}

/// The row that has the focus: its number, and whether it is wholly within the frame.
fn focused_row(page: &Page) -> Result<(u64, bool)> {
    let row = page.value_of(
        "(() => {
            const row = document.activeElement;
            const frame = document.querySelector('.table-frame').getBoundingClientRect();
            const head = document.querySelector('.table-frame thead').getBoundingClientRect();
            const { top, bottom } = row.getBoundingClientRect();
            return [Number(row.ariaRowIndex), top >= head.bottom - 1 && bottom <= frame.bottom + 1];
        })()",
    )?;
    Ok(serde_json::from_value(row)?)
}

#[test]
fn of_many_views_only_those_in_sight_are_made_and_all_can_be_reached() -> Result<()> {
    const COPIES: usize = 8;
    const VIEWS: u64 = 22 * COPIES as u64;
    let folder = tempfile::tempdir()?;
    let scan = line_copies(folder.path(), COPIES)?;
    with_workbench("many-views", |workbench| {
        workbench.reconstruct(&scan)?;
        let page = workbench.page;
        assert_eq!(workbench.row_count()? as u64, VIEWS);
        let made = page.count("[data-testid^=view-row-]")?;
        ensure!((10..80).contains(&made), "{made} rows are made");
        let thumbs = page.count(".thumb")?;
        ensure!((5..60).contains(&thumbs), "{thumbs} thumbnails are made");

        // By keyboard to the last row and back.
        page.tab_to("tr[aria-selected=true]")?;
        for (key, expected) in [
            ("End", VIEWS + 1),
            ("ArrowUp", VIEWS),
            ("PageUp", VIEWS - 10),
            ("Home", 2),
            ("PageDown", 12),
            ("ArrowDown", 13),
        ] {
            page.press(key)?;
            let (row, in_sight) = focused_row(page)?;
            assert_eq!(row, expected, "after {key}");
            ensure!(in_sight, "row {row} is out of sight after {key}");
        }
        ensure_chosen(page, "0011-0")?;
        page.screenshot("many-views")?;

        // The other way round: what is chosen last comes first.
        page.click("thead th:first-child button")?;
        page.value_of("void (document.querySelector('.table-frame').scrollTop = 0)")?;
        page.wait_until(
            "the last view in the first row",
            "document.querySelector('[data-testid=views-table] tbody tr')?.innerText.startsWith('0021-7')",
        )?;

        // In the strip, too.
        page.tab_to(".thumb[aria-selected=true]")?;
        page.press("End")?;
        ensure_chosen(page, "0021-7")?;
        // A canvas that nothing was painted on is 300 px wide.
        page.wait_until(
            "the thumbnail of the last view",
            "document.querySelector('.thumb[aria-selected=true] canvas').width <= 96",
        )
    })
}

#[test]
fn what_a_part_of_a_line_is_can_be_said_and_taken_back() -> Result<()> {
    let samples = samples()?;
    let line = samples.iter().find(|path| path.ends_with("line.zip"));
    with_workbench("line-said", |workbench| {
        workbench.reconstruct(line.context("no sample line.zip")?)?;
        let page = workbench.page;
        workbench.click_row("0013")?;
        let counts = || -> Result<Vec<u32>> {
            let told = page.text(&part("spots"))?;
            let words = told.split(|c: char| !c.is_ascii_digit());
            Ok(words.filter_map(|word| word.parse().ok()).collect())
        };
        let before = counts()?;
        let [wall, object, stray] = before[..] else {
            anyhow::bail!("{before:?} are not three counts");
        };
        // In the middle of the object's part of the line.
        let at = page.value_of(
            "(() => {
                const picture = document.querySelector('[data-testid=picture-on-frame]');
                picture.scrollIntoView({ block: 'center' });
                const part = picture.querySelector('[data-testid=line-object] path');
                const points = part.getAttribute('d').match(/M[^M]+/g);
                const box = picture.getBoundingClientRect();
                const shares = points.map(point => {
                    const [u, v] = point.match(/[\\d.]+/g).map(Number);
                    const place = new DOMPoint(u, v).matrixTransform(part.getScreenCTM());
                    return [(place.x - box.x) / box.width, (place.y - box.y) / box.height];
                });
                // The picture shows a part: a point well within it.
                return shares.find(([x, y]) => Math.abs(x - 0.5) < 0.3 && Math.abs(y - 0.6) < 0.2);
            })()",
        )?;
        let share = |i: usize| at[i].as_f64().context("no point of the object");
        page.click_at(&part("picture-on-frame"), (share(0)?, share(1)?))?;
        page.wait_visible(&part("say-stray"))?;
        page.screenshot("line-marked")?;
        workbench.click("say-stray")?;
        let is = |what: &str, condition: String| page.wait_long(RECONSTRUCTION, what, &condition);
        let told = format!("document.querySelector('{}').innerText", part("spots"));
        is(
            "fewer points of the object",
            format!("!{told}.includes('{object} on the object')"),
        )?;
        let after = counts()?;
        ensure!(
            after[0] == wall && after[1] + 3 < object && after[2] > stray,
            "{before:?} are {after:?} by now"
        );
        page.screenshot("line-said")?;
        page.press("Control+z")?;
        is(
            "the points to be back",
            format!("{told}.includes('{object} on the object')"),
        )?;
        assert_eq!(counts()?, before);
        Ok(())
    })
}
