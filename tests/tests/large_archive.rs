//! Archives beyond what memory holds and a ZIP file without Zip64 can count, and views beyond what a screen
//! shows.

use std::fs::File;
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use serde_json::Value;
use snellius_tests::{
    PATIENCE,
    companion::Output,
    places::samples,
    workbench::{RECONSTRUCTION, Workbench, part, wait_kept, with_workbench},
};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

/// Where 32 bits of a file's length end.
const ZIP32: u64 = 1 << 32;

fn sample(name: &str) -> Result<PathBuf> {
    let mut samples = samples()?.into_iter();
    samples
        .find(|path| path.ends_with(name))
        .with_context(|| format!("no sample {name}"))
}

/// Writes a file in which zeros are holes, which take no room on a disk.
struct WithHoles(File);

impl Write for WithHoles {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if bytes.iter().any(|byte| *byte != 0) {
            return self.0.write(bytes);
        }
        self.0.seek_relative(bytes.len() as i64)?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

impl Seek for WithHoles {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.0.seek(to)
    }
}

/// The scan behind an entry of zeros of more than 4 GiB, so that nothing of it can be found without Zip64.
fn behind_4_gib(scan: &Path, at: &Path) -> Result<()> {
    let mut zip = ZipWriter::new(WithHoles(File::create(at)?));
    let stored = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
    zip.start_file("zeros", stored.large_file(true))?;
    let zeros = vec![0; 1 << 20];
    for _ in 0..=ZIP32 / zeros.len() as u64 {
        zip.write_all(&zeros)?;
    }
    let mut scan = ZipArchive::new(File::open(scan)?)?;
    for index in 0..scan.len() {
        zip.raw_copy_file(scan.by_index_raw(index)?)?;
    }
    zip.finish()?;
    ensure!(std::fs::metadata(at)?.len() > ZIP32);
    Ok(())
}

fn result(workbench: &Workbench) -> Result<Value> {
    Ok(serde_json::from_slice(
        &workbench.download("download-json")?.bytes,
    )?)
}

#[test]
fn an_archive_of_more_than_4_gib_is_measured_and_gone_on_with_when_it_is_chosen_again() -> Result<()>
{
    let folder = tempfile::tempdir()?;
    let archive = folder.path().join("large.zip");
    let tank = sample("tank-paper.zip")?;
    behind_4_gib(&tank, &archive)?;
    let expected: Value = serde_json::from_slice(&Output::of(&tank, &[])?.file("result.json")?)?;
    with_workbench("large-archive", |workbench| {
        let page = workbench.page;
        workbench.reconstruct(&archive)?;
        ensure!(result(workbench)? == expected, "the result is another");

        // No copy is kept; the page says so, and so does the list.
        page.wait_text(
            &part("not-kept"),
            "This browser keeps no copy of \u{201c}large.zip\u{201d}: 4.3 GB are too many.",
        )?;
        wait_kept(page, "Measured")?;
        page.reload()?;
        page.wait_text(&part("sessions"), "35 points")?;
        page.wait_text(&part("sessions"), "no copy of its archive is kept")?;
        page.screenshot("session-without-archive")?;
        page.choose_files(&part("archive-again"), &[&tank])?;
        workbench.wait_failed(PATIENCE)?;
        ensure!(
            workbench.alert().contains("another file"),
            "{}",
            workbench.alert()
        );
        page.choose_files(&part("archive-again"), &[&archive])?;
        page.wait_long(
            RECONSTRUCTION,
            "the result",
            "document.documentElement.dataset.state === 'done'",
        )?;
        ensure!(result(workbench)? == expected, "the result is another");
        Ok(())
    })
}

#[test]
fn thumbnails_are_there_where_they_are_seen_and_keys_reach_all() -> Result<()> {
    with_workbench("strip", |workbench| {
        let page = workbench.page;
        workbench.reconstruct(&sample("tank-paper.zip")?)?;
        let views = 35;
        page.tab_to(".thumb[aria-selected=true]")?;
        for (key, view) in [("End", views), ("Home", 1), ("ArrowRight", 2)] {
            page.press(key)?;
            let focused = format!(
                "document.activeElement.matches('.thumb[aria-selected=true][aria-posinset=\"{view}\"]')
                    && document.activeElement.querySelector('canvas').width === 88"
            );
            page.wait_until(&format!("the picture of view {view}"), &focused)?;
            ensure!(page.count(".thumb")? < views, "all thumbnails are there");
        }
        page.screenshot("strip").map(drop)
    })
}
