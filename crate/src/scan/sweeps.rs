use super::Station;
use crate::robust::median;

/// How far apart two stations are, mm: the way between the cameras, and what turning does at the
/// distance a vessel usually stands at.
fn step(a: &Station, b: &Station) -> f64 {
    const LEVER: f64 = 300.0;
    let rotation = |station: &Station| station.world_from_camera.rotation();
    way(a, b) + LEVER * rotation(a).angle_to(&rotation(b))
}

fn way(a: &Station, b: &Station) -> f64 {
    (a.world_from_camera.translation() - b.world_from_camera.translation()).norm()
}

/// Sorts stations into sweeps (the paper's "scans": rows of stations along the vessel) and returns each
/// station's sweep, numbered from 0 in order of appearance.
///
/// A manifest does not say which stations make a row, but within a row they follow one another at even
/// steps: a station joins the latest sweep whose last station is at most 2.5 usual steps away.
pub fn sweeps(stations: &[Station]) -> Vec<usize> {
    let farthest = 2.5 * usual_step(stations);
    let is_near = |a: &Station, b: &Station| way(a, b) <= farthest && step(a, b) <= farthest;
    let mut last_of: Vec<usize> = Vec::new();
    let mut sweep_of = Vec::with_capacity(stations.len());
    for (index, station) in stations.iter().enumerate() {
        let near = |last: usize| is_near(&stations[last], station);
        let latest = (0..last_of.len())
            .filter(|sweep| near(last_of[*sweep]))
            .max_by_key(|sweep| last_of[*sweep]);
        let sweep = latest.unwrap_or_else(|| {
            last_of.push(index);
            last_of.len() - 1
        });
        last_of[sweep] = index;
        sweep_of.push(sweep);
    }
    sweep_of
}

/// The median over the stations of the way to the nearest of the next few: rows may be interleaved.
fn usual_step(stations: &[Station]) -> f64 {
    const NEXT: usize = 4;
    let nearest: Vec<f64> = (0..stations.len())
        .filter_map(|i| {
            let next = stations[i + 1..].iter().take(NEXT);
            next.map(|other| step(&stations[i], other))
                .min_by(f64::total_cmp)
        })
        .collect();
    if nearest.is_empty() {
        return 0.0;
    }
    median(nearest)
}
