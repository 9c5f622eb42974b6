//! Hands on the 3-D scene: mouse, keys and fingers; sections, error ellipsoids and pictures of it.

#![allow(
    clippy::print_stdout,
    reason = "what was measured is told with --nocapture"
)]

use std::path::PathBuf;

use anyhow::{Context, Result, ensure};
use serde_json::Value;
use snellius_tests::{
    Page, Picture,
    places::samples,
    workbench::{Workbench, part, with_workbench},
};

fn jar() -> Result<PathBuf> {
    let samples = samples()?;
    let jar = samples.into_iter().find(|path| path.ends_with("jar.zip"));
    jar.context("no sample jar.zip")
}

fn seen(page: &Page) -> Result<Picture> {
    page.settled_picture_of(&part("scene"))
}

fn is_changed(page: &Page, before: &Picture, what: &str) -> Result<Picture> {
    let after = seen(page)?;
    let changed = after.changed_from(before);
    ensure!(changed > 0.002, "{what} changes {changed} of the picture");
    Ok(after)
}

/// Fits: if nothing was turned, that gives back the same picture.
fn fitted_again(page: &Page, before: &Picture) -> Result<f64> {
    page.press("f")?;
    Ok(seen(page)?.changed_from(before))
}

fn chosen(page: &Page) -> Result<String> {
    let row = "document.querySelector('tr[aria-selected=true]')?.dataset.testid";
    Ok(page.value_of(row)?.as_str().unwrap_or_default().to_owned())
}

/// A point of the scene, as shares of its size, and the row of the view that a click on it chooses.
fn a_point(page: &Page) -> Result<((f64, f64), String)> {
    let found = page.value_of(
        "(async () => {
            const scene = document.querySelector('[data-testid=scene]');
            const box = scene.getBoundingClientRect();
            const chosen = () => document.querySelector('tr[aria-selected=true]')?.dataset.testid;
            const before = chosen();
            const send = (kind, x, y) => scene.dispatchEvent(new PointerEvent(kind,
                { clientX: box.x + x, clientY: box.y + y, pointerId: 7, button: 0, bubbles: true }));
            for (let y = 30; y < box.height - 130; y += 12) {
                for (let x = 260; x < box.width - 20; x += 12) {
                    send('pointerdown', x, y);
                    send('pointerup', x, y);
                    await new Promise(done => setTimeout(done));
                    if (chosen() !== before) return [x / box.width, y / box.height, chosen()];
                }
            }
        })()",
    )?;
    let share = |i: usize| found[i].as_f64().context("no point can be clicked");
    let row = found[2].as_str().context("no row")?;
    Ok(((share(0)?, share(1)?), row.to_owned()))
}

/// Chooses some other view in the table.
fn choose_another(workbench: &Workbench, than: &str) -> Result<()> {
    let views = ["0000", "0026"];
    let other = views.into_iter().find(|view| !than.ends_with(view));
    workbench.click_row(other.context("one of two is another")?)?;
    ensure!(chosen(workbench.page)? != than, "{than} is still chosen");
    Ok(())
}

fn click_chooses(workbench: &Workbench, at: (f64, f64), row: &str) -> Result<()> {
    let page = workbench.page;
    choose_another(workbench, row)?;
    page.click_at(&part("scene"), at)?;
    let is =
        format!("document.querySelector('tr[aria-selected=true]')?.dataset.testid === '{row}'");
    page.wait_until(&format!("{row} to be chosen"), &is)
}

#[test]
fn the_mouse_turns_shifts_and_comes_nearer_to_what_it_points_at() -> Result<()> {
    with_workbench("scene-mouse", |workbench| {
        workbench.reconstruct(&jar()?)?;
        let (page, scene) = (workbench.page, part("scene"));
        let (at, row) = a_point(page)?;
        click_chooses(workbench, at, &row)?;

        // What the pointer is at stays there.
        let before = seen(page)?;
        page.wheel_at(&scene, at, -240.0)?;
        is_changed(page, &before, "the wheel")?;
        click_chooses(workbench, at, &row)?;
        // A double click puts it into the middle.
        page.double_click_at(&scene, at)?;
        seen(page)?;
        click_chooses(workbench, (0.5, 0.5), &row)?;
        page.screenshot("scene-focused")?;

        page.press("f")?;
        let fitted = seen(page)?;
        page.drag_right(&scene, (0.5, 0.5), (0.6, 0.6))?;
        is_changed(page, &fitted, "the right button")?;
        let turned = fitted_again(page, &fitted)?;
        ensure!(turned < 0.001, "the right button turned: {turned}");
        page.drag(&scene, (0.6, 0.3), (0.75, 0.4))?;
        let turned = fitted_again(page, &fitted)?;
        ensure!(turned > 0.002, "the left button did not turn: {turned}");
        Ok(())
    })
}

#[test]
fn one_finger_turns_and_two_pinch() -> Result<()> {
    with_workbench("scene-touch", |workbench| {
        workbench.reconstruct(&jar()?)?;
        let (page, scene) = (workbench.page, part("scene"));
        page.press("f")?;
        let fitted = seen(page)?;
        page.touch(
            &scene,
            &[[(0.45, 0.4), (0.35, 0.35)], [(0.6, 0.5), (0.75, 0.55)]],
        )?;
        is_changed(page, &fitted, "a pinch")?;
        let turned = fitted_again(page, &fitted)?;
        ensure!(turned < 0.001, "a pinch turned: {turned}");
        page.touch(&scene, &[[(0.5, 0.4), (0.7, 0.5)]])?;
        let turned = fitted_again(page, &fitted)?;
        ensure!(turned > 0.002, "a finger did not turn: {turned}");
        Ok(())
    })
}

#[test]
fn a_section_shows_a_slab_and_ellipsoids_the_noise() -> Result<()> {
    with_workbench("scene-section", |workbench| {
        workbench.reconstruct(&jar()?)?;
        let page = workbench.page;
        // All of the scene is in the window, wherever the focus goes.
        page.set_size(1280, 1800)?;
        page.click(&format!("{} summary", part("scene-more")))?;
        let whole = seen(page)?;
        page.choose_option(&part("section"), "height")?;
        let cut = is_changed(page, &whole, "a section")?;
        page.screenshot("scene-section")?;
        page.tab_to(&part("section-middle"))?;
        page.press("Home")?;
        is_changed(page, &cut, "another place of the section")?;
        page.choose_option(&part("section"), "off")?;
        page.wait_until(
            "the section's sliders to go",
            "!document.querySelector('[data-testid=section-middle]')",
        )?;
        let back = seen(page)?.changed_from(&whole);
        ensure!(back < 0.001, "the section leaves traces: {back}");

        page.choose_option(&part("ellipsoids"), "100")?;
        is_changed(page, &whole, "ellipsoids")?;
        page.screenshot("scene-ellipsoids")?;
        Ok(())
    })
}

/// A picture's pixels: so many in all, wholly clear, wholly opaque.
fn opacity(png: &[u8]) -> Result<[usize; 3]> {
    let pixels = image::load_from_memory(png)?.into_rgba8();
    let of = |opacity: u8| pixels.pixels().filter(|pixel| pixel[3] == opacity).count();
    Ok([pixels.pixels().len(), of(0), of(255)])
}

#[test]
fn a_picture_of_the_scene_is_saved_with_and_without_its_ground() -> Result<()> {
    with_workbench("scene-picture", |workbench| {
        workbench.reconstruct(&jar()?)?;
        let page = workbench.page;
        page.click(&format!("{} summary", part("scene-more")))?;
        let saved = workbench.download("save-picture")?;
        assert_eq!(saved.name, "scene.png");
        let [all, _, opaque] = opacity(&saved.bytes)?;
        assert_eq!(
            opaque, all,
            "the picture with its ground lets light through"
        );
        // The legend stands at the lower left, with both ends of the colours.
        let pixels = image::load_from_memory(&saved.bytes)?.into_rgb8();
        let (right, top) = (240, pixels.height().saturating_sub(90));
        for end in [[68, 1, 84], [253, 231, 37]] {
            let shown = pixels
                .enumerate_pixels()
                .any(|(x, y, pixel)| x < right && y > top && pixel.0 == end);
            ensure!(shown, "the legend lacks the colour {end:?}");
        }
        workbench.click("picture-transparent")?;
        let saved = workbench.download("save-picture")?;
        let [all, clear, opaque] = opacity(&saved.bytes)?;
        ensure!(
            clear > all / 4 && opaque > 100,
            "of {all} pixels {clear} are clear, {opaque} opaque"
        );
        let shown = seen(page)?;
        ensure!(!shown.is_blank(), "the scene is gone after the picture");
        Ok(())
    })
}

#[test]
fn the_radius_of_a_cylinder_is_measured_with_its_plus_and_minus() -> Result<()> {
    with_workbench("scene-cylinder", |workbench| {
        workbench.reconstruct(&jar()?)?;
        let page = workbench.page;
        page.choose_option(&part("measure"), "rod-radius")?;
        page.wait_text(&part("measured"), "six or more points")?;
        // The middle scan of the ball: nine points on a circle, which many cylinders share.
        for view in 9..18 {
            workbench.click_row(&format!("{view:04}"))?;
            page.press("m")?;
        }
        page.wait_text(&part("face-1"), "9 points")?;
        let told = page.text(&part("measured"))?;
        ensure!(
            told.contains('\u{b1}') || told.contains("do not determine"),
            "{told:?}"
        );
        page.screenshot("scene-cylinder")?;
        Ok(())
    })
}

#[test]
fn the_longest_task_of_a_run_is_told() -> Result<()> {
    with_workbench("scene-tasks", |workbench| {
        let page = workbench.page;
        page.value_of(
            "(() => {
                window.longTasks = [];
                new PerformanceObserver(list => longTasks.push(...list.getEntries().map(t => t.duration)))
                    .observe({ type: 'longtask' });
            })()",
        )?;
        let samples = samples()?;
        let line = samples.iter().find(|path| path.ends_with("line.zip"));
        workbench.choose(line.context("no sample line.zip")?)?;
        page.wait_until(
            "the run to be under way",
            "['running', 'done'].includes(document.documentElement.dataset.state)",
        )?;
        let during = "document.documentElement.dataset.state === 'running'";
        let mut longest_while_running = 0.0_f64;
        while page.value_of(during)? == Value::Bool(true) {
            let longest = page.value_of("Math.max(0, ...longTasks)")?;
            longest_while_running = longest_while_running.max(longest.as_f64().unwrap_or(0.0));
        }
        workbench.wait_state("done", snellius_tests::workbench::RECONSTRUCTION)?;
        seen(page)?;
        let all = page.value_of("Math.max(0, ...longTasks)")?;
        println!(
            "longest task of the main thread: {longest_while_running} ms while the scan ran, {all} ms with the \
             first picture of the result"
        );
        Ok(())
    })
}
