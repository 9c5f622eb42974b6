//! Making a scan in the page of pictures, a calibration file and a list of poses, and opening folders: as a
//! person would, with a sample that is taken apart. What comes out is the sample's own result.

use std::{
    fs::{self, File},
    io::{Cursor, Read},
    path::{Path, PathBuf},
};

use anyhow::{Context, Result, ensure};
use serde_json::Value;
use snellius_tests::{
    PATIENCE, Page,
    companion::Output,
    places::samples,
    workbench::{RECONSTRUCTION, Workbench, part, wait_kept, wait_promise, with_workbench},
};
use tempfile::TempDir;
use zip::ZipArchive;

fn sample(name: &str) -> Result<PathBuf> {
    let found = samples()?.into_iter().find(|path| path.ends_with(name));
    found.with_context(|| format!("no sample {name}"))
}

fn jar() -> Result<PathBuf> {
    sample("jar.zip")
}

/// A sample's files in a folder: pictures in `scan/images`, `scan/scan.json`.
struct Parts {
    folder: TempDir,
    manifest: Value,
}

impl Parts {
    fn of(archive: &Path) -> Result<Self> {
        let folder = tempfile::tempdir()?;
        let scan = folder.path().join("scan");
        ZipArchive::new(File::open(archive)?)?.extract(&scan)?;
        let manifest = serde_json::from_slice(&fs::read(scan.join("scan.json"))?)?;
        Ok(Self { folder, manifest })
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn pictures(&self) -> Result<Vec<PathBuf>> {
        let entries = fs::read_dir(self.path("scan/images"))?;
        let mut paths = vec![];
        for entry in entries {
            paths.push(entry?.path());
        }
        paths.sort();
        Ok(paths)
    }

    /// The lens, as OpenCV 4 writes it.
    fn calibration(&self) -> Result<PathBuf> {
        let camera = &self.manifest["camera"];
        let [width, height, fx, fy, cx, cy] =
            ["width", "height", "fx", "fy", "cx", "cy"].map(|key| camera[key].to_string());
        let distortion = numbers(&camera["distortion"]);
        let text = format!(
            "%YAML:1.0\n---\ncalibration_time: \"Sun Nov 22 15:43:51 2026\"\nimage_width: {width}\n\
             image_height: {height}\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   \
             data: [ {fx}, 0., {cx}, 0.,\n       {fy}, {cy}, 0., 0., 1. ]\n\
             distortion_coefficients: !!opencv-matrix\n   rows: 5\n   cols: 1\n   dt: d\n   \
             data: [ {distortion} ]\n"
        );
        let path = self.path("camera.yml");
        fs::write(&path, text)?;
        Ok(path)
    }

    /// The robot's poses as a table.
    fn poses(&self) -> Result<PathBuf> {
        let mut table = "image,qw,qx,qy,qz,x [mm],y [mm],z [mm]\n".to_owned();
        for view in self.manifest["views"].as_array().context("no views")? {
            let pose = &view["world_from_flange"];
            let picture = view["on"].as_str().context("no picture")?;
            let (rotation, translation) =
                (numbers(&pose["rotation"]), numbers(&pose["translation"]));
            table += &format!("{picture},{rotation},{translation}\n");
        }
        let path = self.path("poses.csv");
        fs::write(&path, table)?;
        Ok(path)
    }

    /// What is typed into the form, by question.
    fn answers(&self) -> Vec<(&str, String)> {
        let manifest = &self.manifest;
        let hand = &manifest["flange_from_camera"];
        let mut answers = vec![
            (
                "name",
                manifest["name"].as_str().unwrap_or_default().to_owned(),
            ),
            ("hand-rotation", numbers(&hand["rotation"])),
            ("hand-translation", numbers(&hand["translation"])),
            ("laser-origin", numbers(&manifest["laser"]["origin"])),
            ("laser-direction", numbers(&manifest["laser"]["direction"])),
            (
                "wall-thickness",
                manifest["vessel"]["wall_thickness"].to_string(),
            ),
            ("index-wall", manifest["media"]["wall"].to_string()),
        ];
        if let Some(index) = manifest["media"]["inside"].as_f64() {
            answers.push(("index-inside", index.to_string()));
        }
        answers
    }
}

/// `1.5,-2.0,3.0`.
fn numbers(list: &Value) -> String {
    list.to_string().trim_matches(['[', ']']).to_owned()
}

fn answer(name: &str) -> String {
    part(&format!("answer-{name}"))
}

/// Writes into a field in place of what is there.
fn fill(page: &Page, name: &str, text: &str) -> Result<()> {
    page.click(&answer(name))?;
    page.press("Control+a")?;
    page.type_text(text)
}

fn missing(page: &Page, words: &str) -> Result<()> {
    page.wait_text(&part("missing"), words)
}

fn not_missing(page: &Page, words: &str) -> Result<()> {
    let gone = format!(
        "!document.querySelector('[data-testid=missing]').innerText.includes({})",
        Value::from(words)
    );
    page.wait_until(&format!("{words:?} to be there"), &gone)
}

/// Gives the form what a sample has.
fn give(workbench: &Workbench, parts: &Parts) -> Result<()> {
    let page = workbench.page;
    let pictures = parts.pictures()?;
    let pictures: Vec<&Path> = pictures.iter().map(PathBuf::as_path).collect();
    page.choose_files(&part("pictures-input"), &pictures)?;
    page.choose_files(&part("calibration-input"), &[&parts.calibration()?])?;
    page.choose_files(&part("poses-input"), &[&parts.poses()?])?;
    page.choose_option(&answer("frames"), "world-from-flange")?;
    for (name, text) in parts.answers() {
        fill(page, name, &text)?;
    }
    Ok(())
}

fn complete(page: &Page) -> Result<()> {
    page.wait_text(".making-missing h2", "Everything is there")
}

/// What somebody typed.
fn typed(page: &Page, name: &str) -> Result<String> {
    let value = page.value_of(&format!("document.querySelector('{}').value", answer(name)))?;
    Ok(value.as_str().context("no field")?.to_owned())
}

fn wait_checked(page: &Page, view: usize, is: bool) -> Result<()> {
    page.wait_until(
        &format!("view {view} in air: {is}"),
        &format!("document.querySelector('[data-testid=air-{view}]').checked === {is}"),
    )
}

/// The page shows the result that the companion program gives for the sample.
fn measured_like(workbench: &Workbench, archive: &Path) -> Result<()> {
    workbench.wait_state("done", RECONSTRUCTION)?;
    let expected = Output::of(archive, &[])?.file("result.json")?;
    let saved = workbench.download("download-json")?;
    ensure!(saved.bytes == expected, "the result is not the sample's");
    Ok(())
}

#[test]
fn a_scan_is_made_measured_and_saved() -> Result<()> {
    let archive = jar()?;
    let parts = Parts::of(&archive)?;
    with_workbench("make-a-scan", |workbench| {
        let page = workbench.page;
        workbench.click("make-scan")?;
        for gap in [
            "No pictures",
            "No camera calibration",
            "No poses",
            "Index in the vessel: missing",
        ] {
            missing(page, gap)?;
        }
        give(workbench, &parts)?;
        complete(page)?;
        page.wait_text(&part("picture-count"), "54 pictures")?;
        page.wait_text(&part("part-camera"), "fx 661.5")?;

        let saved = workbench.download("save-scan")?;
        ensure!(saved.name == "Ball in a round jar.zip", "{}", saved.name);
        let mut zip = ZipArchive::new(Cursor::new(saved.bytes))?;
        let mut entry = |name: &str| -> Result<Vec<u8>> {
            let mut bytes = vec![];
            zip.by_name(name)?.read_to_end(&mut bytes)?;
            Ok(bytes)
        };
        for picture in parts.pictures()? {
            let name = picture
                .file_name()
                .and_then(|name| name.to_str())
                .context("no name")?;
            ensure!(
                entry(name)? == fs::read(&picture)?,
                "{name} is not the file that was chosen"
            );
        }
        let manifest: Value = serde_json::from_slice(&entry("scan.json")?)?;
        for key in ["camera", "laser", "flange_from_camera", "vessel", "media"] {
            ensure!(
                manifest[key] == parts.manifest[key],
                "{key}: {}",
                manifest[key]
            );
        }

        workbench.click("measure-scan")?;
        measured_like(workbench, &archive)?;

        // The form is as it was left.
        page.click("header button:not(.quiet)")?;
        workbench.click("make-scan")?;
        let typed = page.value_of(&format!(
            "document.querySelector('{}').value",
            answer("index-inside")
        ))?;
        ensure!(typed == "1.333", "{typed}");
        page.wait_text(&part("picture-count"), "54 pictures")
    })
}

#[test]
fn a_half_filled_tank_with_a_known_wall_is_made_and_measured() -> Result<()> {
    let archive = sample("tank-paper.zip")?;
    let parts = Parts::of(&archive)?;
    let result: Value = serde_json::from_slice(&Output::of(&archive, &[])?.file("result.json")?)?;
    let [point, normal] = ["point", "normal"].map(|key| numbers(&result["vessel"][key]));
    with_workbench("make-known-wall", |workbench| {
        let page = workbench.page;
        workbench.click("make-scan")?;
        give(workbench, &parts)?;
        page.choose_option(&answer("shape"), "plane")?;
        page.choose_option(&answer("wall-known"), "yes")?;
        missing(page, "A point of the wall: missing")?;
        missing(page, "The wall's normal: missing")?;
        fill(page, "wall-point", &point)?;
        fill(page, "wall-normal", &normal)?;
        page.choose_option(&answer("far-wall"), "yes")?;
        missing(page, "Between the two walls: missing")?;
        page.choose_option(&answer("far-wall"), "no")?;
        complete(page)?;

        // What is behind the wall: typed, or chosen beside the pictures.
        page.click("[data-testid=pairs] > summary")?;
        page.wait_until(
            "the pictures of the first pair",
            "[...document.querySelectorAll('.making-pairs tbody tr:first-child canvas')]
                .filter(canvas => canvas.width > 0).length === 2",
        )?;
        workbench.click("air-1")?;
        page.wait_until(
            "the number in the field",
            &format!(
                "document.querySelector('{}').value === '1'",
                answer("in-air")
            ),
        )?;
        fill(page, "in-air", "1-36")?;
        missing(
            page,
            "Views in air: there is no view 36; they go from 1 to 35",
        )?;
        fill(page, "in-air", "1-3, 5-14")?;
        wait_checked(page, 3, true)?;
        wait_checked(page, 4, false)?;
        workbench.click("air-4")?;
        wait_checked(page, 4, true)?;
        ensure!(
            typed(page, "in-air")? == "1-14",
            "{}",
            typed(page, "in-air")?
        );
        complete(page)?;
        for (scheme, width) in [("light", 1280), ("dark", 360)] {
            page.prefer_scheme(scheme)?;
            page.set_size(width, 900)?;
            for part_of_form in ["part-pictures", "part-vessel", "part-media", "part-known"] {
                page.picture_of(&part(part_of_form))?;
                page.screenshot(&format!("making-{part_of_form}-{scheme}"))?;
            }
        }
        page.set_size(1280, 900)?;

        let saved = workbench.download("save-scan")?;
        let made = parts.path("made.zip");
        fs::write(&made, &saved.bytes)?;
        let manifest: Value =
            serde_json::from_reader(ZipArchive::new(File::open(&made)?)?.by_name("scan.json")?)?;
        for key in ["point", "normal"] {
            ensure!(
                manifest["vessel"][key] == result["vessel"][key],
                "{}",
                manifest["vessel"]
            );
        }
        let inside = |manifest: &Value| -> Vec<Value> {
            let views = manifest["views"].as_array().into_iter().flatten();
            views.map(|view| view["inside"].clone()).collect()
        };
        ensure!(
            inside(&manifest) == inside(&parts.manifest),
            "the media are others"
        );
        workbench.click("measure-scan")?;
        measured_like(workbench, &made)
    })
}

#[test]
fn a_known_angle_is_asked_for_and_tells_the_index() -> Result<()> {
    let archive = sample("angle.zip")?;
    let parts = Parts::of(&archive)?;
    with_workbench("make-known-angle", |workbench| {
        let page = workbench.page;
        workbench.click("make-scan")?;
        give(workbench, &parts)?;
        page.choose_option(&answer("shape"), "plane")?;
        page.choose_option(&answer("index-known"), "no")?;
        // What lies below moves up then.
        page.wait_until(
            "the index to be asked for no more",
            "!document.querySelector('[data-testid=answer-index-inside]')",
        )?;
        page.click("[data-testid=part-known] summary")?;
        fill(page, "known-angle", "190")?;
        missing(
            page,
            "Angle between two flat faces: 190; it is more than 0 and less than 180.",
        )?;
        fill(page, "known-angle", "90")?;
        complete(page)?;
        workbench.click("measure-scan")?;
        measured_like(workbench, &archive)
    })
}

#[test]
fn a_scan_of_pictures_without_room_is_saved_and_gone_on_with() -> Result<()> {
    let parts = Parts::of(&jar()?)?;
    with_workbench("make-without-room", |workbench| {
        let page = workbench.page;
        wait_promise(
            page,
            "the page to be cached",
            "navigator.serviceWorker.ready.then(() => true)",
        )?;
        page.leave_room(2_000_000)?;
        workbench.click("make-scan")?;
        give(workbench, &parts)?;
        complete(page)?;
        workbench.click("measure-scan")?;
        workbench.wait_state("done", RECONSTRUCTION)?;
        page.wait_text(&part("not-kept"), "the scan\u{2019}s archive. Save it now.")?;
        page.screenshot("making-without-room")?;
        let saved = workbench.download("save-unkept")?;
        let made = parts.path("made.zip");
        fs::write(&made, &saved.bytes)?;
        wait_kept(page, "Measured")?;
        page.reload()?;
        page.wait_text(
            &part("sessions"),
            "the archive saved of them will be asked for",
        )?;
        page.choose_files(&part("archive-again"), &[&made])?;
        measured_like(workbench, &made)
    })
}

#[test]
fn what_is_wrong_is_said_and_what_was_typed_stays() -> Result<()> {
    let parts = Parts::of(&jar()?)?;
    with_workbench("make-wrongly", |workbench| {
        let page = workbench.page;
        workbench.click("make-scan")?;
        give(workbench, &parts)?;
        complete(page)?;

        fill(page, "index-inside", "13,33")?;
        missing(page, "media.inside: 13.33 is no refractive index")?;
        fill(page, "index-inside", "1,333")?;
        not_missing(page, "media.inside")?;

        let fisheye = parts.path("fisheye.yml");
        let text = fs::read_to_string(parts.calibration()?)?;
        fs::write(&fisheye, format!("{text}fisheye_model: 1\n"))?;
        page.choose_files(&part("calibration-input"), &[&fisheye])?;
        missing(page, "fisheye_model: \"fisheye\" is another lens model")?;
        page.choose_files(&part("calibration-input"), &[&parts.calibration()?])?;
        not_missing(page, "fisheye_model")?;

        let fewer = parts.path("fewer.csv");
        let table = fs::read_to_string(parts.poses()?)?;
        fs::write(
            &fewer,
            table.replace("images/0003-on.png", "images/0077-on.png"),
        )?;
        page.choose_files(&part("poses-input"), &[&fewer])?;
        missing(page, "1 view without a pose: 0003.")?;
        missing(page, "1 pose for no view: images/0077-on.png.")?;
        page.choose_files(&part("poses-input"), &[&parts.poses()?])?;
        not_missing(page, "without a pose")?;

        // A picture of that name that is none.
        let broken = parts.path("0005-on.png");
        fs::write(&broken, b"no picture")?;
        page.choose_files(&part("pictures-input"), &[&broken])?;
        complete(page)?;
        workbench.click("measure-scan")?;
        workbench.wait_failed(RECONSTRUCTION)?;
        ensure!(
            workbench.alert().contains("views[5].on: \"0005-on.png\""),
            "{}",
            workbench.alert()
        );
        page.screenshot("making-failed")?;
        let typed = page.value_of(&format!(
            "document.querySelector('{}').value",
            answer("index-inside")
        ))?;
        ensure!(typed == "1,333", "{typed}");

        // The good one in its place.
        page.choose_files(
            &part("pictures-input"),
            &[&parts.path("scan/images/0005-on.png")],
        )?;
        page.click("[aria-label='Close this message']")?;
        complete(page)?;
        workbench.click("measure-scan")?;
        measured_like(workbench, &jar()?)
    })
}

#[test]
fn pictures_without_a_partner_are_told() -> Result<()> {
    let parts = Parts::of(&jar()?)?;
    with_workbench("make-unpaired", |workbench| {
        let page = workbench.page;
        workbench.click("make-scan")?;
        fs::remove_file(parts.path("scan/images/0003-off.png"))?;
        give(workbench, &parts)?;
        missing(page, "1 picture has no partner: 0003-on.png.")?;
        page.wait_text(
            &part("unpaired"),
            "no picture of that name with the laser off",
        )?;
        page.choose_option(&answer("alone"), "skip")?;
        not_missing(page, "no partner")?;
        page.choose_option(&answer("alone"), "alone")?;
        complete(page)?;
        workbench.click("measure-scan")?;
        workbench.wait_state("done", RECONSTRUCTION)?;
        page.wait_until(
            "the warning of the picture alone",
            "document.body.textContent.includes('without a laser-off picture, taken alone: 0003')",
        )
    })
}

#[test]
fn a_folder_with_a_manifest_is_opened_like_its_archive() -> Result<()> {
    let archive = jar()?;
    let parts = Parts::of(&archive)?;
    with_workbench("folder", |workbench| {
        let page = workbench.page;
        page.drop_files(&part("drop-zone"), &[&parts.path("scan")])?;
        measured_like(workbench, &archive)?;
        page.click("header button:not(.quiet)")?;
        page.choose_files(&part("folder-input"), &[&parts.path("scan")])?;
        workbench.wait_state("done", RECONSTRUCTION)
    })
}

#[test]
fn a_folder_that_lacks_a_picture_is_refused_by_its_name() -> Result<()> {
    let parts = Parts::of(&jar()?)?;
    fs::remove_file(parts.path("scan/images/0003-off.png"))?;
    with_workbench("folder-lacks", |workbench| {
        workbench
            .page
            .drop_files(&part("drop-zone"), &[&parts.path("scan")])?;
        workbench.wait_failed(PATIENCE)?;
        let alert = workbench.alert();
        ensure!(
            alert.contains("views[3].off: no entry \"images/0003-off.png\""),
            "{alert}"
        );
        Ok(())
    })
}

#[test]
fn pictures_and_folders_of_pictures_lead_to_the_form() -> Result<()> {
    let parts = Parts::of(&jar()?)?;
    with_workbench("pictures-dropped", |workbench| {
        let page = workbench.page;
        page.drop_files(&part("drop-zone"), &[&parts.path("scan/images")])?;
        page.wait_text(&part("picture-count"), "54 pictures")?;
        page.wait_text(&part("part-pictures"), "27 pairs")?;
        page.screenshot("making-pictures")?;
        // Dropped onto the form, each file finds its place.
        let files = [parts.calibration()?, parts.poses()?];
        let files: Vec<&Path> = files.iter().map(PathBuf::as_path).collect();
        page.drop_files(&part("part-pictures"), &files)?;
        page.wait_text(&part("part-camera"), "fx 661.5")?;
        page.wait_text(&part("part-poses"), "27 poses")?;
        workbench.click("clear-pictures")?;
        missing(page, "No pictures")?;
        workbench.click("leave-making")?;
        let pictures = parts.pictures()?;
        page.drop_files(&part("drop-zone"), &[&pictures[0], &pictures[1]])?;
        page.wait_text(&part("picture-count"), "2 pictures")
    })
}

#[test]
fn all_pairs_are_listed_however_many_there_are() -> Result<()> {
    const PAIRS: usize = 700;
    let parts = Parts::of(&jar()?)?;
    let picture = parts.path("scan/images/0000-on.png");
    let many = parts.path("many");
    fs::create_dir(&many)?;
    for pair in 0..PAIRS {
        for light in ["on", "off"] {
            fs::hard_link(&picture, many.join(format!("{pair:04}-{light}.png")))?;
        }
    }
    with_workbench("make-many", |workbench| {
        let page = workbench.page;
        page.drop_files(&part("drop-zone"), &[many.as_path()])?;
        page.wait_text(&part("part-pictures"), &format!("{PAIRS} pairs"))?;
        page.click("[data-testid=pairs] > summary")?;
        page.wait_text(".making-pairs tbody tr:first-child", "0000-on.png")?;
        page.value_of(
            "(frame => { frame.scrollTop = frame.scrollHeight })(document.querySelector('.making-pairs'))",
        )?;
        let last = ".making-pairs tbody tr:last-child";
        page.wait_text(last, "0699-off.png")?;
        page.wait_until(
            "the last pair's pictures",
            &format!("[...document.querySelectorAll('{last} canvas')].every(one => one.width > 0)"),
        )?;
        let made = page.count(".making-pairs tbody tr")?;
        ensure!(made < 100, "{made} rows are made of {PAIRS}");
        page.screenshot("making-many-pairs").map(drop)
    })
}

#[test]
fn the_form_is_filled_in_by_keyboard_alone() -> Result<()> {
    with_workbench("make-by-keyboard", |workbench| {
        let page = workbench.page;
        page.tab_to(&part("make-scan"))?;
        page.press("Enter")?;
        missing(page, "No pictures")?;
        page.tab_to(&part("choose-pictures"))?;
        page.tab_to(&answer("laser-origin"))?;
        page.type_text("1 2")?;
        missing(page, "Origin: 2 numbers; 3 wanted.")?;
        page.type_text(" 3")?;
        not_missing(page, "Origin")?;
        ensure!(
            page.has_focus(&answer("laser-origin"))?,
            "the focus went away"
        );
        page.tab_to(&part("leave-making"))?;
        page.press("Enter")?;
        page.wait_visible(&part("drop-zone"))
    })
}
