//! What measuring costs beside reading: a scan's pictures decoded alone, and the whole reconstruction, on
//! one core.
//!
//! ```sh
//! cargo bench -p snellius                      # the sample
//! cargo bench -p snellius -- path/to/scan.zip  # another archive; or SNELLIUS_SCAN=path/to/scan.zip
//! ```
//!
//! The two are timed in turn and the medians compared, so that a busy machine troubles both alike.
#![allow(clippy::print_stdout, reason = "the numbers are this program's output")]

use std::error::Error;
use std::fs::File;
use std::hint::black_box;
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use snellius::pipeline::{Settings, reconstruct};
use snellius::scan::Archive;
use snellius::spots::find_spots;

const ROUNDS: usize = 7;

/// Where the time of one reconstruction goes.
#[derive(Clone, Copy, Default)]
struct Stages {
    /// Opening the archive, reading and decoding its pictures.
    decode: Duration,
    spots: Duration,
    /// Vessel, object, uncertainties and the result's text.
    geometry: Duration,
}

fn main() -> Result<(), Box<dyn Error>> {
    let path = scan();
    let mut alone = Vec::new();
    let mut whole = Vec::new();
    for _ in 0..ROUNDS {
        alone.push(decode(&path)?);
        whole.push(measure(&path)?);
    }
    let total = |s: &Stages| s.decode + s.spots + s.geometry;
    let (decoding, measuring) = (median(&alone, |d| *d), median(&whole, total));
    println!(
        "{}, {ROUNDS} rounds in turn, one core, medians",
        path.display()
    );
    println!("  pictures read and decoded   {}", milliseconds(decoding));
    println!("  whole reconstruction        {}", milliseconds(measuring));
    println!(
        "  ratio                       {:8.3}",
        measuring.as_secs_f64() / decoding.as_secs_f64()
    );
    println!("  of the reconstruction:");
    println!(
        "    reading and decoding      {}",
        milliseconds(median(&whole, |s| s.decode))
    );
    println!(
        "    spots                     {}",
        milliseconds(median(&whole, |s| s.spots))
    );
    println!(
        "    vessel, object, result    {}",
        milliseconds(median(&whole, |s| s.geometry))
    );
    Ok(())
}

/// The archive named by an argument or the environment, or else the sample.
fn scan() -> PathBuf {
    // Cargo adds options of its own, such as --bench.
    let named = std::env::args()
        .skip(1)
        .find(|argument| !argument.starts_with('-'));
    let sample = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../samples/tank-paper.zip");
    named
        .or_else(|| std::env::var("SNELLIUS_SCAN").ok())
        .map_or_else(sample, PathBuf::from)
}

fn open(path: &Path) -> Result<Archive<BufReader<File>>, Box<dyn Error>> {
    Ok(Archive::open(BufReader::new(File::open(path)?))?)
}

fn decode(path: &Path) -> Result<Duration, Box<dyn Error>> {
    let start = Instant::now();
    let mut archive = open(path)?;
    for view in 0..archive.scan().stations.len() {
        black_box(archive.pictures(view)?);
    }
    Ok(start.elapsed())
}

fn measure(path: &Path) -> Result<Stages, Box<dyn Error>> {
    let mut stages = Stages::default();
    let settings = Settings::default();
    let mut archive = timed(&mut stages.decode, || open(path))?;
    let mut spots = Vec::new();
    for view in 0..archive.scan().stations.len() {
        let pictures = timed(&mut stages.decode, || archive.pictures(view))?;
        spots.push(timed(&mut stages.spots, || {
            find_spots(&pictures, &settings.spots)
        }));
    }
    timed(&mut stages.geometry, || {
        reconstruct(archive.scan(), &spots, &settings).map(|r| black_box(r.result().to_json()))
    })?;
    Ok(stages)
}

fn timed<T>(sum: &mut Duration, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let done = work();
    *sum += start.elapsed();
    done
}

fn median<T>(rounds: &[T], duration: impl Fn(&T) -> Duration) -> Duration {
    let mut durations: Vec<Duration> = rounds.iter().map(duration).collect();
    durations.sort();
    durations[durations.len() / 2]
}

fn milliseconds(duration: Duration) -> String {
    format!("{:8.1} ms", duration.as_secs_f64() * 1e3)
}
