//! The stages as an instrument: what a person turns is measured at once, with no more work than it
//! takes, and can be taken back.

use std::path::PathBuf;

use anyhow::{Context, Result, ensure};
use serde_json::Value;
use snellius_tests::{
    Page,
    companion::Output,
    places::samples,
    workbench::{RECONSTRUCTION, Workbench, part, with_workbench},
};

/// The round jar, whose manifest leaves the wall's shape open.
fn jar() -> Result<PathBuf> {
    let samples = samples()?;
    let jar = samples.into_iter().find(|path| path.ends_with("jar.zip"));
    jar.context("no sample jar.zip")
}

/// From now on, the stages that run are written down.
fn watch_stages(page: &Page) -> Result<()> {
    page.value_of(
        "(() => {
            window.stagesThatRan = new Set();
            const note = ({ target }) => {
                if (target.dataset.state === 'running') stagesThatRan.add(target.dataset.testid);
            };
            new MutationObserver(changes => changes.forEach(note)).observe(
                document.querySelector('.stages'),
                { subtree: true, attributeFilter: ['data-state'] },
            );
        })()",
    )
    .map(drop)
}

fn stages_that_ran(page: &Page) -> Result<Vec<String>> {
    let ran = page.value_of("[...stagesThatRan].sort()")?;
    Ok(serde_json::from_value(ran)?)
}

/// Waits until a stage says something and no stage is at work.
fn wait_stage(workbench: &Workbench, stage: &str, words: &str) -> Result<()> {
    let condition = format!(
        "!document.querySelector('[data-state=running]:not(html)')
            && document.querySelector({}).innerText.includes({})",
        Value::from(part(&format!("stage-{stage}"))),
        Value::from(words),
    );
    let what = format!("stage {stage} to say {words:?}");
    workbench.page.wait_long(RECONSTRUCTION, &what, &condition)
}

fn result(workbench: &Workbench) -> Result<Value> {
    Ok(serde_json::from_slice(
        &workbench.download("download-json")?.bytes,
    )?)
}

/// Types a number into a parameter's field.
fn turn(workbench: &Workbench, parameter: &str, value: &str) -> Result<()> {
    let field = part(parameter);
    workbench.page.click(&field)?;
    workbench.page.press("Control+a")?;
    workbench.page.type_text(value)?;
    workbench.page.press("Tab")
}

#[test]
fn a_turned_parameter_runs_its_stage_and_those_after_it() -> Result<()> {
    let archive = jar()?;
    let expected = Output::of(&archive, &[])?.file("result.json")?;
    with_workbench("parameters", |workbench| {
        workbench.reconstruct(&archive)?;
        let page = workbench.page;
        watch_stages(page)?;
        workbench
            .page
            .click("[data-testid=parameters-object] summary")?;
        turn(workbench, "object.gap_sigmas", "1")?;
        let fewer = "!document.querySelector('[data-state=running]:not(html)')
            && !document.querySelector('[data-testid=summary]').innerText.includes('27 of 27')";
        page.wait_long(RECONSTRUCTION, "fewer points", fewer)?;
        assert_eq!(stages_that_ran(page)?, ["stage-object"]);
        page.wait_text("[data-testid=parameters-object] summary", "1 changed")?;

        workbench.page.click("[data-testid=stage-spots] summary")?;
        workbench
            .page
            .click("[data-testid=parameters-spots] summary")?;
        turn(workbench, "spots.smallest_area", "9")?;
        wait_stage(workbench, "spots", "54 found")?;
        page.screenshot("parameters")?;
        let ran = stages_that_ran(page)?;
        ensure!(ran.contains(&"stage-spots".to_owned()), "only {ran:?} ran");

        // A value beyond the range changes nothing, and gives way to what is used.
        turn(workbench, "spots.smallest_area", "100000")?;
        let used = "document.getElementById('spots.smallest_area').value";
        assert_eq!(page.value_of(used)?, "9");

        workbench.click("reset-spots.smallest_area")?;
        workbench.click("reset-object.gap_sigmas")?;
        wait_stage(workbench, "object", "27 points")?;
        let saved = workbench.download("download-json")?;
        ensure!(
            saved.bytes == expected,
            "with everything reset the result is another"
        );
        Ok(())
    })
}

#[test]
fn another_shape_of_the_wall_is_tried_judged_and_taken_back_by_keyboard() -> Result<()> {
    with_workbench("wall-shape", |workbench| {
        workbench.reconstruct(&jar()?)?;
        let page = workbench.page;
        let vessel = page.text(&part("stage-vessel"))?;
        for words in ["cylinder", "Next best", "Thickness, by the glows"] {
            ensure!(vessel.contains(words), "{vessel:?} does not say {words:?}");
        }

        watch_stages(page)?;
        page.tab_to(&part("vessel.shape"))?;
        page.press("s")?;
        wait_stage(workbench, "vessel", "sphere, ")?;
        assert_eq!(
            stages_that_ran(page)?,
            ["stage-vessel"],
            "the spots were at hand"
        );
        assert_eq!(result(workbench)?["vessel"]["shape"], "sphere");

        page.tab_to(&part("colour-by"))?;
        page.press("w")?;
        let legend = page.text(&part("legend"))?;
        ensure!(
            legend.contains("residual") && legend.contains("mm"),
            "the legend says {legend:?}"
        );
        let residuals = page.settled_picture_of(&part("scene"))?;
        ensure!(residuals.coloured_pixels() >= 100, "no colours");
        page.screenshot("wall-residuals")?;

        // A free form ends where it was measured: beyond it spots are refused, and the page says why.
        page.tab_to(&part("vessel.shape"))?;
        page.press("f")?;
        wait_stage(workbench, "vessel", "free form, ")?;
        page.click("tr.refused")?;
        page.tab_to("[data-testid=spots] li select")?;
        let note = page.text(&part("spot-note"))?;
        page.screenshot("spot-refused")?;
        let refused = "document.querySelector('tr.refused[aria-selected=true] .reason').innerText";
        let reason = page.value_of(refused)?;
        let told = page.text(&part("spots"))?;
        let reason = reason.as_str().context("no reason in the table")?;
        ensure!(told.contains(reason), "{told:?} does not say {reason:?}");
        ensure!(!note.is_empty(), "no note at the spot");

        page.press("Control+z")?;
        wait_stage(workbench, "vessel", "sphere, ")?;
        page.press("Control+Shift+z")?;
        wait_stage(workbench, "vessel", "free form, ")?;
        workbench.click("undo")?;
        workbench.click("undo")?;
        wait_stage(workbench, "vessel", "cylinder, ")?;
        assert_eq!(result(workbench)?["vessel"]["shape"], "cylinder");
        Ok(())
    })
}
