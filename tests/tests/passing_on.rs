//! Passing a reconstruction on: by link, by a page of one file, by the address of an archive elsewhere.

use std::{fs, io::Write, path::PathBuf};

use anyhow::{Context, Result, ensure};
use base64::{Engine, prelude::BASE64_URL_SAFE_NO_PAD};
use serde_json::Value;
use snellius::export::ReconstructionResult;
use snellius::pipeline::Settings;
use snellius::share::{self, Rounding};
use snellius_tests::{
    Browser, PATIENCE, Page, Site,
    companion::{self, Output},
    places::{dist, samples},
    with_page,
    workbench::{RECONSTRUCTION, Workbench, part, with_workbench},
};
use tempfile::TempDir;

const LINK_1: &str = include_str!("../../crate/tests/data/link-v1.txt");
const PAGE_1: &str = include_str!("../../crate/tests/data/page-v1.json");

fn sample(name: &str) -> Result<PathBuf> {
    let mut found = samples()?.into_iter();
    found
        .find(|path| path.file_stem().is_some_and(|stem| stem == name))
        .with_context(|| format!("no sample {name}"))
}

fn site() -> Result<Site> {
    Site::at_root(&dist()?)
}

fn result_of(bytes: &[u8]) -> Result<ReconstructionResult> {
    Ok(ReconstructionResult::from_json(bytes)?)
}

/// Opens an address and waits until the page has settled.
fn opened<'a>(page: &'a Page<'a>, address: &str) -> Result<Workbench<'a>> {
    page.open(address)?;
    let settled = "['done', 'failed'].includes(document.documentElement.dataset.state)
        && !document.querySelector('main [aria-busy=true]')";
    page.wait_long(RECONSTRUCTION, "the page to settle", settled)?;
    Ok(Workbench { page })
}

/// The points of both results are as near as the link promises, and by far nearer than their noise.
fn assert_within(found: &ReconstructionResult, truth: &ReconstructionResult, rounding: Rounding) {
    assert_eq!(found.views.len(), truth.views.len());
    for (a, b) in found.views.iter().zip(&truth.views) {
        assert_eq!((&a.id, a.status), (&b.id, b.status));
        assert_eq!(a.object.iter().len(), b.object.iter().len());
        let points = a
            .object
            .iter()
            .zip(b.object.iter())
            .zip(b.object_sigma.iter());
        for ((a, b), sigma) in points {
            for axis in 0..3 {
                let off = (a[axis] - b[axis]).abs();
                assert!(
                    off <= rounding.object[axis] && off < sigma[axis],
                    "{a:?} {b:?}"
                );
            }
        }
    }
}

#[test]
fn a_link_copied_in_one_browser_opens_in_another_with_the_same_numbers() -> Result<()> {
    let archive = sample("tank-paper")?;
    let truth = result_of(&Output::of(&archive, &[])?.file("result.json")?)?;
    let site = site()?;
    let mut link = String::new();
    with_page("link-made", |page| {
        page.open(&site.url())?;
        let workbench = Workbench { page };
        workbench.wait_state("start", PATIENCE)?;
        workbench.reconstruct(&archive)?;
        workbench.click("copy-link")?;
        page.wait_text(&part("link-said"), "characters")?;
        let said = page.text(&part("link-said"))?;
        ensure!(
            said.contains("less than their standard deviations"),
            "{said}"
        );
        ensure!(
            !said.contains("Mind"),
            "a short link needs no warning: {said}"
        );
        page.set_size(1280, 1900)?;
        page.screenshot("link-made")?;
        let value = page.value_of("document.querySelector('[data-testid=link]').value")?;
        link = value.as_str().context("no link")?.to_owned();
        Ok(())
    })?;
    ensure!(link.len() <= 2041, "{} characters", link.len());
    let fragment = link.split_once('#').context("no fragment")?.1;
    let shared = share::decode(fragment)?;
    let rounding = shared.rounding.context("no rounding")?;
    assert_within(
        shared.result.as_ref().context("no result")?,
        &truth,
        rounding,
    );

    with_page("link-opened", |page| {
        let workbench = opened(page, &link)?;
        assert_eq!(workbench.state()?, "done", "{}", workbench.alert());
        page.wait_text(&part("guest-note"), "rounded by at most")?;
        assert_eq!(workbench.row_count()?, truth.views.len());
        let scene = page.settled_picture_of(&part("scene"))?;
        ensure!(scene.distinct_colours() > 5, "the scene shows no points");
        page.screenshot("link-opened")?;
        let saved = workbench.download("download-json")?;
        assert_within(&result_of(&saved.bytes)?, &truth, rounding);
        ensure!(
            !page.requests().iter().any(|url| url.contains(".zip")),
            "the archive was asked for: {:?}",
            page.requests()
        );
        page.prefer_scheme("dark")?;
        page.set_size(390, 844)?;
        page.settled_picture_of(&part("scene"))?;
        page.screenshot("link-opened-narrow").map(drop)
    })
}

/// Made by the first program of version 1, and opened for ever.
#[test]
fn a_link_of_version_1_opens() -> Result<()> {
    let site = site()?;
    with_page("link-v1", |page| {
        let workbench = opened(page, &format!("{}#{}", site.url(), LINK_1.trim()))?;
        assert_eq!(workbench.state()?, "done", "{}", workbench.alert());
        assert_eq!(page.text("h1.scan-name")?, "Two points of a ball");
        assert_eq!(workbench.row_count()?, 3);
        Ok(())
    })
}

/// A link of anyone's making.
fn link_of(payload: &[u8]) -> Result<String> {
    let mut deflated = flate2::write::DeflateEncoder::new(Vec::new(), flate2::Compression::best());
    deflated.write_all(payload)?;
    Ok(format!(
        "r1={}",
        BASE64_URL_SAFE_NO_PAD.encode(deflated.finish()?)
    ))
}

/// Links that were cut off, are of later versions or of ill will: what the page says, and that it goes on.
#[test]
fn links_of_ill_will_give_a_message_and_block_nothing() -> Result<()> {
    let link = LINK_1.trim();
    let deep = [&[0x88, 0x27][..], &[b'['; 5000]].concat();
    let cases = [
        ("cut", link[..link.len() / 2].to_owned(), "damaged"),
        ("later", link.replacen("r1=", "r2=", 1), "version 2"),
        ("noise", "r1=%3Cscript%3E".to_owned(), "damaged"),
        ("empty", "r1=".to_owned(), "damaged"),
        ("long", format!("r1={}", "A".repeat(40_000)), "too much"),
        ("bomb", link_of(&vec![0; 20 << 20])?, "more than any link"),
        ("deep", link_of(&deep)?, "damaged"),
        (
            "settings",
            share::encode(&Settings::default(), None)?.fragment,
            "no reconstruction",
        ),
    ];
    let site = site()?;
    for (name, fragment, words) in cases {
        with_page(&format!("ill-link-{name}"), |page| {
            let workbench = opened(page, &format!("{}#{fragment}", site.url()))?;
            let alert = workbench.alert().to_lowercase();
            ensure!(alert.contains(words), "{alert:?} does not say {words:?}");
            page.wait_visible(&part("drop-zone"))?;
            if name == "cut" {
                page.screenshot("ill-link")?;
                workbench.reconstruct(&sample("tank-paper")?)?;
            }
            Ok(())
        })?;
    }
    Ok(())
}

/// Markup in a link's texts is shown as what it is.
#[test]
fn markup_in_a_link_is_text() -> Result<()> {
    let markup = "<img src=x onerror='window.ran=1'><script>window.ran=2</script>";
    let mut result = share::decode(LINK_1.trim())?.result.context("no result")?;
    result.scan = markup.to_owned();
    result.views[0].id = markup.to_owned();
    result.warnings = vec![markup.to_owned()];
    let fragment = share::encode(&Settings::default(), Some(&result))?.fragment;
    let site = site()?;
    with_page("link-markup", |page| {
        let workbench = opened(page, &format!("{}#{fragment}", site.url()))?;
        assert_eq!(workbench.state()?, "done", "{}", workbench.alert());
        assert_eq!(page.text("h1.scan-name")?, markup);
        assert_eq!(page.count("img")?, 0);
        assert_eq!(page.value_of("typeof window.ran")?, "undefined");
        Ok(())
    })
}

/// The page makes the one-file page that the companion program makes, and opens it again.
#[test]
fn the_page_makes_the_companions_one_file_and_opens_it() -> Result<()> {
    let archive = sample("tank-paper")?;
    let (title, notes) = ("A box, <i>again</i>", "Measured twice.");
    let expected = companion::share(&archive, &["--title", title, "--notes", notes])?;
    let result = Output::of(&archive, &[])?.file("result.json")?;
    with_workbench("one-file-made", |workbench| {
        let page = workbench.page;
        workbench.reconstruct(&archive)?;
        page.click(&part("page-title"))?;
        page.value_of("document.querySelector('[data-testid=page-title]').select()")?;
        page.type_text(title)?;
        page.click(&part("page-notes"))?;
        page.type_text(notes)?;
        let saved = workbench.download("download-page")?;
        ensure!(saved.name.ends_with(".html"), "{}", saved.name);
        ensure!(saved.bytes == expected, "it is not the companion program's");

        let directory = TempDir::new()?;
        let file = directory.path().join("page.html");
        fs::write(&file, &saved.bytes)?;
        page.reload()?;
        workbench.wait_state("start", PATIENCE)?;
        page.drop_files(&part("drop-zone"), &[&file])?;
        workbench.wait_state("done", PATIENCE)?;
        assert_eq!(page.text("h1.scan-name")?, title);
        page.wait_text(&part("guest-note"), notes)?;
        let scene = page.settled_picture_of(&part("scene"))?;
        ensure!(scene.distinct_colours() > 5, "the scene shows no points");
        page.screenshot("one-file-dropped")?;
        let again = workbench.download("download-json")?;
        ensure!(again.bytes == result, "the result differs");
        // What was passed on can be passed on.
        workbench.click("copy-link")?;
        page.wait_text(&part("link-said"), "characters")?;
        page.click(&part("page-notes"))?;
        page.type_text(notes)?;
        let again = workbench.download("download-page")?;
        ensure!(again.bytes == expected, "it changed on the way");
        Ok(())
    })
}

/// Files with a reconstruction that is damaged, of ill will or of version 1.
#[test]
fn pages_dropped_on_the_page_open_or_say_what_is_wrong() -> Result<()> {
    let block = |data: &str| {
        format!(
            "<title>x</title><script type=\"application/json\" id=\"snellius-data\">{data}</script>"
        )
    };
    let whole = block(PAGE_1);
    let deep = format!(r#""scan":{{"x":{}{},"#, "[".repeat(5000), "]".repeat(5000));
    let cases = [
        (
            "holiday.html",
            "<html>holiday</html>".to_owned(),
            "no reconstruction",
        ),
        ("cut.html", whole[..whole.len() / 2].to_owned(), "cut off"),
        (
            "later.html",
            block(&PAGE_1.replacen(r#""version":1"#, r#""version":2"#, 1)),
            "version 2",
        ),
        (
            "deep.html",
            block(&PAGE_1.replacen(r#""scan":{"#, &deep, 1)),
            "recursion",
        ),
        ("other.json", r#"{"holiday": true}"#.to_owned(), "format"),
    ];
    let directory = TempDir::new()?;
    with_workbench("dropped-pages", |workbench| {
        for (name, content, words) in cases {
            let file = directory.path().join(name);
            fs::write(&file, content)?;
            workbench.choose(&file)?;
            workbench.page.wait_text(&part("error"), words)?;
        }
        for (name, content) in [("page.html", whole.as_str()), ("data.json", PAGE_1)] {
            let file = directory.path().join(name);
            fs::write(&file, content)?;
            workbench.choose(&file)?;
            workbench.wait_state("done", PATIENCE)?;
            assert_eq!(workbench.page.text("h1.scan-name")?, "A box in a tank");
            workbench
                .page
                .wait_text(&part("guest-note"), "A note with a <b>tag</b>.")?;
            workbench.page.reload()?;
            workbench.wait_state("start", PATIENCE)?;
        }
        workbench.reconstruct(&sample("tank-paper")?)
    })
}

/// An archive, and a one-file page, that lie on another host which allows it.
#[test]
fn an_archive_of_another_host_opens() -> Result<()> {
    let archive = sample("tank-paper")?;
    let (site, other) = (site()?, Site::at_root(&dist()?)?);
    other.allow_other_hosts();
    let scan = other.offer("/data/scan.zip", fs::read(&archive)?);
    let shared = other.offer(
        "/data/page.html",
        companion::share(&archive, &["--title", "Elsewhere"])?,
    );
    let notes = other.offer("/data/notes.zip", b"no archive".to_vec());
    let result = Output::of(&archive, &[])?.file("result.json")?;
    with_page("source", |page| {
        let workbench = opened(page, &format!("{}#src={scan}", site.url()))?;
        assert_eq!(workbench.state()?, "done", "{}", workbench.alert());
        let saved = workbench.download("download-json")?;
        ensure!(saved.bytes == result, "the result differs");
        // Written as programs write it; and once more to the same page.
        let escaped = shared.replace(':', "%3A").replace('/', "%2F");
        page.open("about:blank")?;
        opened(page, &format!("{}#src={escaped}", site.url()))?;
        page.wait_text("h1.scan-name", "Elsewhere")?;
        page.open("about:blank")?;
        let workbench = opened(page, &format!("{}#src={notes}", site.url()))?;
        ensure!(
            workbench.alert().contains("archive"),
            "{}",
            workbench.alert()
        );
        for (address, words) in [
            ("javascript:alert(1)", "no address of the web"),
            ("file:///etc/passwd", "no address of the web"),
            ("data:text/html,x", "no address of the web"),
            ("http://%", "no address"),
        ] {
            page.open("about:blank")?;
            let workbench = opened(page, &format!("{}#src={address}", site.url()))?;
            ensure!(
                workbench.alert().contains(words),
                "{address}: {}",
                workbench.alert()
            );
        }
        Ok(())
    })
}

/// Hosts that forbid it, that have no such file, that are not there. Chromium itself writes these to the
/// console as errors, so they are not held against the page.
#[test]
fn a_host_that_forbids_reading_is_told_apart_from_one_that_is_silent() -> Result<()> {
    let (site, closed, open) = (site()?, Site::at_root(&dist()?)?, Site::at_root(&dist()?)?);
    open.allow_other_hosts();
    let forbidden = closed.offer("/data/scan.zip", fs::read(sample("tank-paper")?)?);
    let silent = {
        let gone = Site::at_root(&dist()?)?;
        gone.offer("/scan.zip", Vec::new())
    };
    let browser = Browser::start()?;
    for (address, words) in [
        (forbidden, "forbids"),
        (format!("{}missing.zip", open.url()), "404"),
        (silent, "does not answer"),
    ] {
        let page = browser.new_page()?;
        let workbench = opened(&page, &format!("{}#src={address}", site.url()))?;
        let alert = workbench.alert();
        ensure!(alert.contains(words), "{address}: {alert:?}");
        let host = address.split('/').nth(2).context("no host")?;
        ensure!(alert.contains(host), "{alert:?} does not name {host}");
        workbench.reconstruct(&sample("tank-paper")?)?;
        ensure!(
            page.foreign_requests().is_empty(),
            "{:?}",
            page.foreign_requests()
        );
    }
    Ok(())
}

/// More points than a link holds: the page says so, and offers a file.
#[test]
fn what_is_too_much_for_a_link_is_offered_as_a_file() -> Result<()> {
    let directory = TempDir::new()?;
    let mut whole: Value = serde_json::from_str(PAGE_1)?;
    let result = &mut whole["result"];
    // The same views again and again, at places of their own: nothing a link could save on.
    let views = result["views"].as_array().context("no views")?.clone();
    let mut many = Vec::new();
    for number in 0..9000_u64 {
        let mut view = views[number as usize % views.len()].clone();
        view["id"] = format!("view {number}").into();
        for axis in 0..3 {
            let noise = number
                .wrapping_mul(2_654_435_761)
                .rotate_left(7 * axis as u32)
                % 100_003;
            view["object"][axis] = (noise as f64 * 1e-3).into();
        }
        many.push(view);
    }
    result["views"] = many.into();
    let file = directory.path().join("result.json");
    fs::write(&file, result.to_string())?;
    with_workbench("too-much-for-a-link", |workbench| {
        workbench.choose(&file)?;
        workbench.wait_state("done", PATIENCE)?;
        workbench.click("copy-link")?;
        workbench
            .page
            .wait_text(&part("link-said"), "too much for a link")?;
        workbench.page.wait_visible(&part("download-page"))
    })
}

#[test]
fn a_scan_that_was_opened_since_takes_the_link_out_of_the_address() -> Result<()> {
    let site = site()?;
    with_page("link-left", |page| {
        let workbench = opened(page, &format!("{}#{}", site.url(), LINK_1.trim()))?;
        let fragment = || page.value_of("location.hash.slice(0, 4)");
        ensure!(fragment()? == "#r1=", "the link has left the address");
        workbench.reconstruct(&sample("jar")?)?;
        ensure!(fragment()? == "", "the link is still in the address");
        page.reload()?;
        workbench.wait_state("start", PATIENCE)
    })
}
