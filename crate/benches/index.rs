//! What it costs to move the liquid's index: the whole curve, and the object's points for one index.
//!
//! ```sh
//! cargo bench -p snellius --bench index
//! ```
#![allow(clippy::print_stdout, reason = "the numbers are this program's output")]

use std::error::Error;
use std::fs::File;
use std::hint::black_box;
use std::io::BufReader;
use std::path::Path;
use std::time::Instant;

use snellius::camera::Pixel;
use snellius::index::{IndexRange, PreparedSights};
use snellius::pipeline::{Settings, observe, reconstruct};
use snellius::scan::Archive;

const ROUNDS: usize = 7;

fn main() -> Result<(), Box<dyn Error>> {
    let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("../samples/tank-paper.zip");
    let mut archive = Archive::open(BufReader::new(File::open(sample)?))?;
    let settings = Settings::default();
    let views = archive.scan().stations.len();
    let spots = (0..views)
        .map(|view| observe(&mut archive, view, &settings))
        .collect::<Result<Vec<_>, _>>()?;
    let reconstruction = reconstruct(archive.scan(), &spots, &settings)?;
    let setup = reconstruction.setup();
    let seen = reconstruction.object.iter().enumerate();
    let seen: Vec<(usize, Pixel)> = seen
        .flat_map(|(view, choice)| {
            let spots = &spots[view].spots;
            let points = choice.points.iter();
            points.map(move |point| (view, spots[point.spot].pixel()))
        })
        .collect();
    let sights = |count: usize| -> PreparedSights {
        let many: Vec<_> = seen.iter().copied().cycle().take(count).collect();
        PreparedSights::new(&setup, &many)
    };
    let range = IndexRange {
        count: 200,
        ..IndexRange::default()
    };
    let (many, some) = (sights(100_000), sights(10_000));
    let sigmas = vec![0.05; many.len()];
    println!("one core, medians of {ROUNDS} rounds");
    println!(
        "  200 indices x 100,000 sights, plain    {:8.1} ms",
        time(|| many.plain_curve(&range))
    );
    println!(
        "  200 indices x 100,000 sights, robust   {:8.1} ms",
        time(|| many.robust_curve(&range, &sigmas))
    );
    println!(
        "  1 index x 10,000 points                {:8.2} ms",
        time(|| some.points(1.36).collect::<Vec<_>>())
    );
    println!(
        "  10,000 sights prepared                 {:8.1} ms",
        time(|| sights(10_000))
    );
    Ok(())
}

/// Milliseconds.
fn time<T>(work: impl Fn() -> T) -> f64 {
    let mut times: Vec<f64> = (0..ROUNDS)
        .map(|_| {
            let start = Instant::now();
            black_box(work());
            start.elapsed().as_secs_f64() * 1e3
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[ROUNDS / 2]
}
