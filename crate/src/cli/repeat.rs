//! A large scan made of a small one, to see what large scans need.

use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use indicatif::ProgressBar;

use super::{Failure, views};
use crate::scan::{Archive, ArchiveWriter, Manifest, ViewEntry};

/// Arguments of `snellius repeat`.
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The scan archive to repeat
    #[arg(value_name = "SCAN.zip")]
    scan: PathBuf,
    /// How many bytes of pictures the new archive shall hold at least: a number, or one with k, M or G
    #[arg(long, short, value_name = "SIZE")]
    size: Size,
    /// The archive to write
    #[arg(long, short, value_name = "LARGE.zip")]
    output: PathBuf,
}

/// A number of bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Size(u64);

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let units = [("k", 1e3), ("M", 1e6), ("G", 1e9)];
        let with_unit = units
            .iter()
            .find_map(|(unit, bytes)| Some((text.strip_suffix(unit)?, *bytes)));
        let (number, unit) = with_unit.unwrap_or((text, 1.0));
        let bytes = number.parse::<f64>().map(|number| number * unit);
        match bytes {
            Ok(bytes) if (1.0..=MOST_BYTES).contains(&bytes) => Ok(Self(bytes as u64)),
            _ => Err("no number of bytes such as 500M or 4.2G".to_owned()),
        }
    }
}

/// More than any disk holds; below 2^53, so that no byte is lost in a floating-point number.
const MOST_BYTES: f64 = 1e15;

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let mut archive = views::open(&arguments.scan)?;
    let output = &arguments.output;
    let file = File::create(output).map_err(|e| Failure::file(output, e))?;
    let large = Large {
        writer: ArchiveWriter::new(BufWriter::new(file)),
        manifest: archive.scan().manifest.clone(),
        bar: views::bytes_bar(arguments.size.0),
        path: output,
    };
    large.fill(&arguments.scan, &mut archive, arguments.size)
}

/// The archive that is being written.
struct Large<'a> {
    writer: ArchiveWriter<BufWriter<File>>,
    /// The manifest of the scan that is repeated.
    manifest: Manifest,
    bar: ProgressBar,
    path: &'a Path,
}

impl Large<'_> {
    /// Writes the scan's views again and again, whole repeats, until there are so many bytes. The poses are
    /// those of the scan: the pictures show the vessel from there, and from nowhere else.
    ///
    /// Every repeat has picture entries of its own, which are read and decoded each by itself as those of a
    /// large scan are. They are not compressed, so that they are many bytes in few views.
    fn fill(
        mut self,
        scan: &Path,
        archive: &mut Archive<impl std::io::Read + std::io::Seek>,
        size: Size,
    ) -> Result<(), Failure> {
        let (mut views, mut bytes, mut repeat) = (Vec::new(), 0, 0);
        while bytes < size.0 {
            for (index, view) in self.manifest.views.iter().enumerate() {
                let pictures = archive
                    .pictures(index)
                    .map_err(|e| Failure::scan(scan, e))?;
                let view = repeated(view, index, repeat);
                let written = self.writer.add_pictures_uncompressed(&view, &pictures);
                bytes += written.map_err(|e| Failure::file(self.path, e))?;
                self.bar.set_position(bytes);
                views.push(view);
            }
            repeat += 1;
        }
        self.bar.finish_and_clear();
        let manifest = of_repeats(self.manifest, views, repeat);
        let finished = self.writer.finish(&manifest);
        finished.map_err(|e| Failure::file(self.path, e)).map(drop)
    }
}

/// A view of a repeat: with an id and pictures of its own.
fn repeated(view: &ViewEntry, index: usize, repeat: usize) -> ViewEntry {
    let name = |which: &str| format!("images/{repeat:05}-{index:05}-{which}.tif");
    ViewEntry {
        id: id(&view.id, repeat),
        on: name("on"),
        off: view.off.as_ref().map(|_| name("off")),
        ..view.clone()
    }
}

fn id(id: &str, repeat: usize) -> String {
    format!("{id}-{repeat}")
}

/// The manifest of all repeats; what is known of the object's faces is known of each.
fn of_repeats(mut manifest: Manifest, views: Vec<ViewEntry>, repeats: usize) -> Manifest {
    for face in manifest
        .known
        .iter_mut()
        .flat_map(|k| &mut k.views)
        .flatten()
    {
        let again = |repeat| face.iter().map(move |view| id(view, repeat));
        *face = (0..repeats).flat_map(again).collect();
    }
    manifest.name = format!("{}, {repeats} times", manifest.name);
    Manifest { views, ..manifest }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_size_is_a_number_with_or_without_a_unit() {
        let size = |text: &str| text.parse::<Size>();
        assert_eq!(size("4.2G"), Ok(Size(4_200_000_000)));
        assert_eq!(size("60M"), Ok(Size(60_000_000)));
        assert_eq!(size("1500"), Ok(Size(1500)));
        for wrong in ["", "G", "0", "-1M", "nanG", "infG", "4 GiB", "1e6G"] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
    }
}
