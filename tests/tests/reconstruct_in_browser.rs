//! The main job, in a real browser: a scan comes in, is measured, is looked at, and leaves as
//! files that equal those of the companion program byte for byte.

use std::{path::PathBuf, time::Duration};

use anyhow::{Context, Result, ensure};
use snellius_tests::{
    PATIENCE, Picture, Site,
    companion::Output,
    places::{dist, samples},
    with_page,
    workbench::{RECONSTRUCTION, Workbench, part, with_workbench, with_workbench_under},
};

/// Download button, and the file that it and the companion program name alike.
const FILES: [(&str, &str); 12] = [
    ("download-json", "result.json"),
    ("download-object-ply", "object.ply"),
    ("download-vessel-ply", "vessel.ply"),
    ("download-csv", "points.csv"),
    ("download-object-csv", "object.csv"),
    ("download-pcd", "object.pcd"),
    ("download-las", "object.las"),
    ("download-e57", "object.e57"),
    ("download-glb", "scene.glb"),
    ("download-stl", "surface.stl"),
    ("download-obj", "surface.obj"),
    ("download-html", "report.html"),
];

fn smallest_sample() -> Result<PathBuf> {
    Ok(samples()?.swap_remove(0))
}

fn largest_sample() -> Result<PathBuf> {
    samples()?.pop().context("there are samples")
}

/// Every file that the page gives is the one that the companion program writes.
fn files_equal(workbench: &Workbench, expected: &Output) -> Result<()> {
    for (button, name) in FILES {
        let saved = workbench.download(button)?;
        ensure!(
            saved.name.ends_with(name),
            "`{button}` saves {:?}, the companion program {name:?}",
            saved.name
        );
        same_bytes(name, &saved.bytes, &expected.file(name)?)?;
    }
    Ok(())
}

/// Names the first line that differs, which says more than two long texts.
fn same_bytes(name: &str, page: &[u8], program: &[u8]) -> Result<()> {
    if page == program {
        return Ok(());
    }
    let lines = |bytes| -> Vec<String> {
        let text = String::from_utf8_lossy(bytes);
        text.lines().map(str::to_owned).collect()
    };
    let (page, program) = (lines(page), lines(program));
    let number = (0..).find(|&at| page.get(at) != program.get(at));
    let at = number.expect("the files differ");
    anyhow::bail!(
        "{name} differs, first in line {}: the page has {:?}, the program {:?}",
        at + 1,
        page.get(at),
        program.get(at)
    );
}

fn scene(workbench: &Workbench) -> Result<Picture> {
    workbench.page.settled_picture_of(&part("scene"))
}

#[test]
fn every_sample_gives_the_files_of_the_companion_program() -> Result<()> {
    with_workbench("every-sample", |workbench| {
        for archive in samples()? {
            let expected = Output::of(&archive, &[])?;
            workbench.reconstruct(&archive)?;
            files_equal(workbench, &expected)
                .with_context(|| format!("{} in the page", archive.display()))?;
            // The next one must not find the state of this one.
            workbench.page.reload()?;
            workbench.wait_state("start", PATIENCE)?;
        }
        Ok(())
    })
}

#[test]
fn a_scan_can_be_dropped_on_the_page() -> Result<()> {
    let archive = smallest_sample()?;
    with_workbench("dropped-scan", |workbench| {
        workbench.page.drop_files(&part("drop-zone"), &[&archive])?;
        workbench.wait_state("done", RECONSTRUCTION)
    })
}

#[test]
fn one_scan_can_follow_another() -> Result<()> {
    let archive = smallest_sample()?;
    let expected = Output::of(&archive, &[])?;
    let another = largest_sample()?;
    with_workbench("one-after-another", |workbench| {
        workbench.reconstruct(&another)?;
        let before = workbench.page.text(&part("summary"))?;
        workbench.choose(&archive)?;
        if another != archive {
            workbench.page.wait_long(
                RECONSTRUCTION,
                "the other scan's summary",
                &format!(
                    "document.querySelector('[data-testid=summary]')?.innerText.trim() !== {}",
                    serde_json::Value::from(before)
                ),
            )?;
        }
        workbench.wait_state("done", RECONSTRUCTION)?;
        files_equal(workbench, &expected)
    })
}

#[test]
fn every_view_has_its_row_and_its_pictures() -> Result<()> {
    let archive = smallest_sample()?;
    let result = Output::of(&archive, &[])?.file("result.json")?;
    let result: serde_json::Value = serde_json::from_slice(&result)?;
    let views = result["views"].as_array().context("no views")?;
    with_workbench("views", |workbench| {
        workbench.reconstruct(&archive)?;
        let page = workbench.page;
        assert_eq!(workbench.row_count()?, views.len());

        let id = views[0]["id"].as_str().context("a view without id")?;
        workbench.click_row(id)?;
        for canvas in ["picture-on", "picture-off", "picture-difference"] {
            let canvas = part(canvas);
            page.wait_visible(&canvas)?;
            page.drawn_picture_of(&canvas)?;
        }
        page.screenshot("view-selected").map(drop)
    })
}

#[test]
fn the_scene_shows_coloured_points_and_follows_the_mouse() -> Result<()> {
    let archive = smallest_sample()?;
    with_workbench("scene", |workbench| {
        workbench.reconstruct(&archive)?;
        let before = scene(workbench)?;
        workbench.page.screenshot("reconstructed")?;
        assert!(
            before.coloured_pixels() >= 100,
            "{} pixels",
            before.coloured_pixels()
        );
        assert!(
            before.distinct_colours() >= 3,
            "{} colours",
            before.distinct_colours()
        );

        let canvas = part("scene");
        workbench.page.drag(&canvas, (0.4, 0.5), (0.7, 0.4))?;
        let turned = scene(workbench)?;
        assert!(turned.changed_from(&before) > 0.001, "a drag turns nothing");

        workbench.page.wheel(&canvas, -300.0)?;
        let nearer = scene(workbench)?;
        assert!(
            nearer.changed_from(&turned) > 0.001,
            "the wheel zooms nothing"
        );
        Ok(())
    })
}

/// With refraction left out the points move by up to tens of millimetres (the paper's Figs. 10
/// and 11); back on, they are where they were.
#[test]
fn leaving_refraction_out_moves_the_points_and_back() -> Result<()> {
    let archive = smallest_sample()?;
    with_workbench("refraction", |workbench| {
        workbench.reconstruct(&archive)?;
        let with = scene(workbench)?;
        workbench.click("refraction-without")?;
        let without = scene(workbench)?;
        workbench.page.screenshot("without-refraction")?;
        assert!(
            without.changed_from(&with) > 0.0005,
            "leaving it out moves nothing"
        );
        workbench.click("refraction-with")?;
        let again = scene(workbench)?;
        assert!(
            again.changed_from(&with) < 0.0005,
            "the points do not come back"
        );
        Ok(())
    })
}

#[test]
fn another_index_gives_what_the_companion_program_gives_for_it() -> Result<()> {
    let archive = smallest_sample()?;
    let given = Output::of(&archive, &[])?;
    let other = Output::of(&archive, &["--index", "1.4"])?;
    assert_ne!(given.file("object.ply")?, other.file("object.ply")?);
    with_workbench("another-index", |workbench| {
        workbench.reconstruct(&archive)?;
        let page = workbench.page;
        let before = page.text(&part("views-table"))?;
        workbench.click("index-input")?;
        page.press("Control+a")?;
        page.type_text("1.4")?;
        page.press("Enter")?;
        page.wait_long(
            RECONSTRUCTION,
            "other points in the table",
            &format!(
                "document.querySelector('[data-testid=views-table]')?.innerText.trim() !== {}",
                serde_json::Value::from(before)
            ),
        )?;
        workbench.wait_state("done", RECONSTRUCTION)?;
        files_equal(workbench, &other)
    })
}

#[test]
fn a_cancelled_run_stops_and_the_next_one_works() -> Result<()> {
    let archive = largest_sample()?;
    let expected = Output::of(&archive, &[])?;
    with_workbench("cancel", |workbench| {
        workbench.cancel_as_soon_as_possible()?;
        workbench.choose(&archive)?;
        workbench
            .page
            .wait_until("the click on `cancel`", "window.cancelClicked")?;
        workbench.wait_state("start", Duration::from_secs(5))?;
        // A run that went on behind the scenes would end within this time.
        std::thread::sleep(Duration::from_secs(4));
        assert_eq!(workbench.state()?, "start");
        assert_eq!(workbench.alert(), "", "being cancelled is no error");

        workbench.reconstruct(&archive)?;
        files_equal(workbench, &expected)
    })
}

#[test]
fn the_page_works_below_the_root_of_a_site() -> Result<()> {
    let archive = smallest_sample()?;
    let base = "/lab/tools/snellius/";
    with_workbench_under(base, "sub-path", |workbench| {
        let sample = "[data-testid^=\"sample-\"]";
        workbench.page.click(sample)?;
        workbench.wait_state("done", RECONSTRUCTION)?;
        let network = |url: &&String| url.starts_with("http");
        let requests = workbench.page.requests();
        for url in requests.iter().filter(network) {
            ensure!(url.contains(base), "{url} lies outside {base}");
        }
        workbench.reconstruct(&archive)
    })
}

#[test]
fn the_whole_job_can_be_done_from_the_keyboard() -> Result<()> {
    with_workbench("keyboard", |workbench| {
        let page = workbench.page;
        page.tab_to("[data-testid^=\"sample-\"]")?;
        page.press("Enter")?;
        workbench.wait_state("done", RECONSTRUCTION)?;

        let with = scene(workbench)?;
        page.tab_to(&part("refraction-slider"))?;
        page.press("Home")?;
        let without = scene(workbench)?;
        assert!(
            without.changed_from(&with) > 0.0005,
            "the slider moves nothing"
        );

        page.tab_to(&part("colour-by"))?;
        let chosen = "document.querySelector('[data-testid=colour-by]').value";
        let before = page.value_of(chosen)?;
        page.press("ArrowDown")?;
        assert_ne!(page.value_of(chosen)?, before, "ArrowDown chooses nothing");

        page.tab_to(&part("download-json"))?;
        let saved = page.download(|| page.press("Enter"))?;
        let result: serde_json::Value = serde_json::from_slice(&saved.bytes)?;
        assert_eq!(result["format"], "refractive-reconstruction");
        Ok(())
    })
}

#[test]
fn a_file_that_the_system_hands_over_is_opened() -> Result<()> {
    let site = Site::at_root(&dist()?)?;
    with_page("launched", |page| {
        // As the browser does when the installed page is chosen to open a file.
        page.run_before_all(
            "Object.defineProperty(window, 'launchQueue', { value: {
                setConsumer(consumer) { window.consumer = consumer; },
            } });",
        )?;
        page.open(&site.url())?;
        let workbench = Workbench { page };
        workbench.wait_state("start", PATIENCE)?;
        page.value_of(
            "(async () => {
                const archive = await (await fetch('samples/jar.zip')).blob();
                const getFile = async () => new File([archive], 'handed-over.zip');
                consumer({ files: [{ kind: 'file', name: 'handed-over.zip', getFile }] });
            })()",
        )?;
        workbench.wait_state("running", PATIENCE)?;
        workbench.wait_state("done", RECONSTRUCTION)?;
        ensure!(workbench.row_count()? == 27, "another scan is shown");
        Ok(())
    })
}
