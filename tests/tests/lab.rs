//! The refraction lab as pupils and teachers meet it: by link, by hand, and against the core's numbers.
#![allow(
    clippy::print_stdout,
    reason = "what was measured is told with --nocapture"
)]

use std::time::{Duration, Instant};

use anyhow::{Context, Result, ensure};
use snellius::camera::Pixel;
use snellius::geometry::Point;
use snellius::lab::{Bench, LESSONS, Lesson, Light, Sight, View, link};
use snellius_tests::{Browser, PATIENCE, Page, Site, places, with_page, workbench::part};

/// A page with the lab, opened at what stands behind the page's address.
fn with_lab(
    name: &str,
    address: &str,
    test: impl FnOnce(&Page, &dyn Fn(&str) -> Result<()>) -> Result<()>,
) -> Result<()> {
    let site = Site::under("/", &places::dist()?)?;
    with_page(name, |page| {
        let open = |address: &str| {
            page.open(&format!("{}{address}", site.url()))?;
            page.wait_visible(&part("lab"))
        };
        let open_anew = |address: &str| {
            // Another hash alone would not load the page again.
            page.open("about:blank")?;
            open(address)
        };
        open(address)?;
        test(page, &open_anew)
    })
}

/// The bench that the page's address names, once it rests.
fn bench_of(page: &Page) -> Result<Bench> {
    std::thread::sleep(Duration::from_millis(500));
    let hash = page.value_of("location.hash.slice(1)")?;
    let hash = hash.as_str().context("no hash")?;
    Ok(link::read(hash)?)
}

fn is_shown(page: &Page, name: &str, expected: &str) -> Result<()> {
    let shown = page.text(&part(name))?;
    ensure!(shown == expected, "{name}: {shown:?}, not {expected:?}");
    Ok(())
}

fn angle(radians: f64) -> String {
    format!("{:.2}\u{b0}", radians.to_degrees())
}

/// Every number of the bench is what the core computes for the bench that the address names, once it has
/// followed.
fn numbers_are_the_cores(page: &Page) -> Result<Bench> {
    let end = Instant::now() + PATIENCE;
    loop {
        let numbers = numbers_now(page);
        if numbers.is_ok() || Instant::now() > end {
            return numbers;
        }
    }
}

fn numbers_now(page: &Page) -> Result<Bench> {
    let bench = bench_of(page)?;
    let light = Light::of(&bench);
    for (path, name) in [(&light.beam, "beam"), (&light.sight, "sight")] {
        for (bend, face) in path.bends.iter().zip(["outer", "inner"]) {
            is_shown(
                page,
                &format!("{name}-{face}-before"),
                &angle(bend.angle_before()),
            )?;
            if bend.thrown_back.is_none() {
                is_shown(
                    page,
                    &format!("{name}-{face}-after"),
                    &angle(bend.angle_after()),
                )?;
            }
        }
    }
    if let (Some(error), Some(distance)) = (light.error(), light.ray_distance()) {
        is_shown(page, "measured-error", &format!("{error:.3} mm"))?;
        is_shown(page, "ray-distance", &format!("{distance:.3} mm"))?;
        let equations = page
            .text(&part("equations"))?
            .replace(char::is_whitespace, "");
        let sine = format!("{:.4}", light.beam.bends[0].sine_before());
        ensure!(
            equations.contains(&sine),
            "{sine} is not in the equations: {equations}"
        );
    }
    Ok(bench)
}

#[test]
fn each_lesson_opens_from_its_link_in_the_state_that_it_names() -> Result<()> {
    with_lab("lessons", "#lab/1?view=lessons", |page, open| {
        for (place, lesson) in LESSONS.iter().enumerate() {
            let bench = Lesson::bench(place).context("no such lesson")?;
            let card = part(&format!("lesson-{}", place + 1));
            page.click(&card)?;
            page.wait_text(&part("lesson-title"), lesson.title)?;
            ensure!(bench_of(page)? == bench, "{} by click", lesson.title);

            open(&format!("#{}", link::write(&bench)))?;
            page.wait_text(&part("lesson-title"), lesson.title)?;
            ensure!(bench_of(page)? == bench, "{} by link", lesson.title);
            match bench.view {
                View::Bench => drop(numbers_are_the_cores(page)?),
                View::See => page.wait_visible(&part("sight"))?,
                _ => page.wait_visible(&part("angle-chart"))?,
            }
            page.screenshot(&format!("lab-lesson-{}", place + 1))?;
            open("#lab/1?view=lessons")?;
        }
        Ok(())
    })
}

#[test]
fn a_lab_that_cannot_be_loaded_says_so_and_is_opened_later() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let mut lab = Vec::new();
    for file in std::fs::read_dir(places::dist()?)? {
        let (path, to) = (file?.path(), folder.path());
        let name = path.file_name().context("a file without a name")?;
        if name.to_string_lossy().starts_with("snellius-lab") {
            lab.push((path.clone(), to.join(name)));
        } else if path.is_file() {
            std::fs::copy(&path, to.join(name))?;
        }
    }
    let site = Site::at_root(folder.path())?;
    // Not `with_page`: the browser complains of files that are missing, and rightly.
    let browser = Browser::start()?;
    let page = browser.new_page()?;
    page.open(&site.url())?;
    page.click(&part("open-lab"))?;
    page.wait_visible("#lab-missing")?;
    page.screenshot("lab-missing")?;
    for (from, to) in lab {
        std::fs::copy(from, to)?;
    }
    page.click("#lab-missing a")?;
    page.click(&part("open-lab"))?;
    page.wait_visible(&part("lab"))
}

#[test]
fn an_answer_is_judged() -> Result<()> {
    with_lab("answer", "#lab", |page, open| {
        let bench = Lesson::bench(0).context("no lesson")?;
        open(&format!("#{}", link::write(&bench)))?;
        page.click(&part("answer"))?;
        page.type_text("30")?;
        page.press("Enter")?;
        page.wait_text(&part("reply"), "Not yet")?;
        page.press("Control+a")?;
        page.type_text("40,6")?;
        page.press("Enter")?;
        page.wait_text(&part("reply"), "Right")
    })
}

#[test]
fn dragging_changes_the_numbers_as_the_core_computes_them() -> Result<()> {
    let start = "#lab/1?wall=cylinder&pitch=15&assumed=1.4";
    with_lab("drag", start, |page, _| {
        let before = numbers_are_the_cores(page)?;
        page.drag(&part("handle-camera"), (0.5, 0.5), (1.6, 0.1))?;
        let camera = numbers_are_the_cores(page)?;
        ensure!(
            camera.camera != before.camera,
            "the camera stays where it was"
        );
        page.drag(&part("handle-laser"), (0.5, 0.5), (0.9, 1.2))?;
        let laser = numbers_are_the_cores(page)?;
        ensure!(laser.laser != before.laser, "the laser stays where it was");
        page.drag(&part("handle-object"), (0.5, 0.5), (1.2, 0.9))?;
        let object = numbers_are_the_cores(page)?;
        ensure!(
            object.object != before.object,
            "the object point stays where it was"
        );
        ensure!(
            object
                == Bench {
                    object: object.object,
                    ..laser
                },
            "dragging the object point moves something else"
        );
        page.screenshot("lab-dragged")?;
        Ok(())
    })
}

#[test]
fn the_bench_is_worked_from_the_keyboard() -> Result<()> {
    with_lab("lab-keyboard", "#lab", |page, _| {
        page.tab_to(&part("handle-object"))?;
        page.press("ArrowDown")?;
        page.press("Shift+ArrowRight")?;
        let bench = numbers_are_the_cores(page)?;
        let first = Bench::default().object;
        ensure!(
            bench.object == [first[0] + 1.0, first[1] + 10.0],
            "{:?}",
            bench.object
        );
        page.tab_to(&part("slider-pitch"))?;
        page.press("ArrowRight")?;
        ensure!(
            numbers_are_the_cores(page)?.pitch == 0.1,
            "one step of the slider"
        );
        page.tab_to(&part("lab-reset"))?;
        page.press("Enter")?;
        ensure!(
            bench_of(page)? == Bench::default(),
            "Reset leaves something"
        );
        Ok(())
    })
}

#[test]
fn beyond_the_critical_angle_the_page_says_what_happens() -> Result<()> {
    let link = "#lab/1?outside=water&liquid=air&lx=-100&lz=-90&aim=60";
    with_lab("thrown-back", link, |page, _| {
        page.wait_text(&part("beam-inner-after"), "thrown back")?;
        let said = page.text(".loupe .trouble")?;
        ensure!(said.contains("Total internal reflection"), "{said}");
        page.screenshot("lab-thrown-back")?;
        Ok(())
    })
}

/// The graphics card's rays, read back from it, held here against the core built for this machine.
#[test]
fn the_rays_of_the_view_through_the_wall_agree_with_the_core() -> Result<()> {
    const MOST: f64 = 0.1;
    with_lab("see-through", "#lab/1?view=see", |page, open| {
        let mut told = Vec::new();
        for vessel in [
            "plane",
            "cylinder&thing=card&radius=75",
            "sphere&thing=ball&liquid=glycerol",
        ] {
            open(&format!(
                "#lab/1?view=see&fill=90&round=20&above=8&wall={vessel}"
            ))?;
            let bench = bench_of(page)?;
            page.click(&part("check-rays"))?;
            page.wait_text(&part("ray-check"), "rays")?;
            let rays = page.value_of("document.querySelector('[data-rays]').dataset.rays")?;
            let (count, worst) = compare(&bench, rays.as_str().context("no rays")?)?;
            told.push(format!("{vessel}: {count} rays, {worst:.5} px"));
            ensure!(count == 100 && worst < MOST, "{told:?}");
            page.screenshot(&format!("lab-see-{}", &vessel[..5]))?;
        }
        println!("{told:#?}");
        Ok(())
    })
}

/// How many rays there are, and by how many pixels the worst one is off.
fn compare(bench: &Bench, rays: &str) -> Result<(usize, f64)> {
    let numbers = |text: &str| -> Result<Vec<f64>> {
        text.split(' ')
            .map(|word| Ok(word.parse::<f64>()?))
            .collect()
    };
    let mut lines = rays.split(';');
    let size = numbers(lines.next().context("no size")?)?;
    let sight = Sight::new(bench, size[0], size[1]);
    let mut worst = 0.0_f64;
    let mut count = 0;
    for line in lines {
        let ray = numbers(line)?;
        ensure!(ray.len() == 5, "{line}");
        let place = Point::new(ray[2], ray[3], ray[4]);
        let off = sight.off_by(Pixel::new(ray[0], ray[1]), place);
        worst = worst.max(off.context("the core's ray does not get in")?);
        count += 1;
    }
    Ok((count, worst))
}

#[test]
fn the_divider_shows_the_vessel_with_and_without_liquid() -> Result<()> {
    with_lab("divider", "#lab/1?view=see&divider=100", |page, open| {
        let full = page.settled_picture_of(&part("sight"))?;
        open("#lab/1?view=see&divider=0")?;
        let empty = page.settled_picture_of(&part("sight"))?;
        ensure!(
            full.changed_from(&empty) > 0.05,
            "the liquid makes no difference"
        );
        page.tab_to(&part("divider"))?;
        page.press("ArrowRight")?;
        ensure!(bench_of(page)?.divider == 1.0, "the divider does not move");
        Ok(())
    })
}

#[test]
fn a_link_opens_elsewhere_with_the_same_numbers() -> Result<()> {
    let mut shown = Vec::new();
    let mut address = "#lab/1?pitch=20&assumed=1.5&liquid=mystery3".to_owned();
    for round in ["first", "second"] {
        let opened = address.clone();
        with_lab(&format!("link-{round}"), &opened, |page, _| {
            if round == "first" {
                page.drag(&part("handle-object"), (0.5, 0.5), (0.9, 1.4))?;
            }
            let bench = bench_of(page)?;
            shown.push([
                page.text(&part("measured-point"))?,
                page.text(&part("apparent-point"))?,
                page.text(&part("equations"))?,
            ]);
            address = format!("#{}", link::write(&bench));
            Ok(())
        })?;
    }
    ensure!(shown[0] == shown[1], "{shown:#?}");
    ensure!(
        !shown[0][2].contains("1.418"),
        "the mystery's index is given away"
    );
    Ok(())
}

#[test]
fn a_hostile_link_gets_a_message_and_the_default_bench() -> Result<()> {
    let long = format!("#lab/1?pitch={}", "1".repeat(5000));
    let links = [
        ("#lab/1?pitch=99", "pitch"),
        ("#lab/7", "version"),
        ("#lab/1?%3Cimg%20src=x%20onerror=alert(1)%3E", "parameter"),
        ("#lab/1?liquid=NaN", "liquid"),
        (long.as_str(), "characters"),
    ];
    with_lab("hostile-links", "#lab", |page, open| {
        for (link, word) in links {
            open(link)?;
            page.wait_text(&part("lab-problem"), word)?;
            is_shown(
                page,
                "beam-outer-before",
                &angle(Light::of(&Bench::default()).beam.bends[0].angle_before()),
            )?;
        }
        Ok(())
    })
}

#[test]
fn the_lab_is_reached_from_the_start_and_left_again() -> Result<()> {
    snellius_tests::workbench::with_workbench("lab-and-back", |workbench| {
        let page = workbench.page;
        workbench.click("open-lab")?;
        page.wait_visible(&part("lab"))?;
        ensure!(
            !page.is_visible(&part("drop-zone"))?,
            "the start shows through"
        );
        workbench.click("lab-back")?;
        page.wait_visible(&part("drop-zone"))?;
        ensure!(!page.is_visible(&part("lab"))?, "the lab stays");
        Ok(())
    })
}

#[test]
fn within_another_page_the_bench_stands_alone() -> Result<()> {
    with_lab("embedded", "?embed#lab/1?pitch=10", |page, _| {
        page.wait_visible(&part("handle-laser"))?;
        ensure!(!page.is_visible(&part("tab-lessons"))?, "there are tabs");
        page.wait_visible(".leave-frame")?;
        ensure!(bench_of(page)?.pitch == 10.0);
        ensure!(page.value_of("location.search")? == "?embed");
        Ok(())
    })
}

#[test]
fn the_two_curves_tell_the_index_or_that_they_cannot() -> Result<()> {
    with_lab("what-is-n", "#lab/1?view=index&noise=0.2", |page, open| {
        page.wait_text(&part("index-by-ray-distance"), "end of the range")?;
        page.wait_text(&part("why-flat"), "squarely")?;
        page.wait_text(&part("tries"), "60 tries")?;
        open("#lab/1?view=index&noise=0&pitch=30&n=1.332")?;
        page.wait_text(&part("index-by-ray-distance"), "n = 1.332")?;
        page.wait_text(&part("index-by-angle"), "n = 1.332")?;
        page.wait_text(&part("l-angle"), "90.00")?;
        page.wait_text(&part("tries"), "60 tries")
    })
}

#[test]
fn every_view_fits_every_width_in_light_and_dark() -> Result<()> {
    with_lab("lab-appearance", "#lab", |page, open| {
        for view in ["bench", "see", "index", "lessons", "sheet"] {
            open(&format!("#lab/1?view={view}"))?;
            for (width, height) in [(360, 740), (1440, 900)] {
                page.set_size(width, height)?;
                let mut brightness = vec![];
                for scheme in ["light", "dark"] {
                    page.prefer_scheme(scheme)?;
                    std::thread::sleep(Duration::from_millis(500));
                    let wide = page.value_of("document.scrollingElement.scrollWidth")?;
                    let wide = wide.as_u64().unwrap_or(u64::MAX);
                    ensure!(
                        wide <= u64::from(width),
                        "{view} is {wide} px wide in {width}"
                    );
                    let picture = page.screenshot(&format!("lab-{view}-{width}-{scheme}"))?;
                    brightness.push(picture.brightness());
                }
                let (light, dark) = (brightness[0], brightness[1]);
                ensure!(
                    dark + 40.0 < light,
                    "{view} at {width}: {light:.0}, {dark:.0}"
                );
            }
        }
        Ok(())
    })
}
