use super::Station;

/// How far apart two stations are, mm: the way between the cameras, and what turning does at the
/// distance a vessel usually stands at.
fn step(a: &Station, b: &Station) -> f64 {
    const LEVER: f64 = 300.0;
    let (a, b) = (&a.world_from_camera, &b.world_from_camera);
    let way = (a.translation() - b.translation()).norm();
    way + LEVER * a.rotation().angle_to(&b.rotation())
}

/// Sorts stations into sweeps (the paper's "scans": rows of stations along the vessel) and returns each
/// station's sweep, numbered from 0 in order of appearance.
///
/// A manifest does not say which stations make a row, but a row's stations stand close together: a
/// station joins the sweep whose last station is nearest, unless that is more than 2.5 times the scan's
/// usual step away.
pub fn sweeps(stations: &[Station]) -> Vec<usize> {
    let usual = usual_step(stations);
    let mut last_of: Vec<usize> = Vec::new();
    let mut sweep_of = Vec::with_capacity(stations.len());
    for (index, station) in stations.iter().enumerate() {
        let nearest = (0..last_of.len())
            .map(|sweep| (step(&stations[last_of[sweep]], station), sweep))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        let sweep = match nearest {
            Some((distance, sweep)) if distance <= 2.5 * usual => sweep,
            _ => {
                last_of.push(index);
                last_of.len() - 1
            }
        };
        last_of[sweep] = index;
        sweep_of.push(sweep);
    }
    sweep_of
}

/// How many stations before and after are looked at: enough for any order in which rows are
/// interleaved, and few enough for a scan of many thousands.
const WINDOW: usize = 32;

/// The median over the stations of the way to the nearest other one.
fn usual_step(stations: &[Station]) -> f64 {
    let mut nearest: Vec<f64> = (0..stations.len())
        .filter_map(|i| {
            let window = i.saturating_sub(WINDOW)..(i + WINDOW).min(stations.len());
            let others = window.filter(|j| *j != i);
            others
                .map(|j| step(&stations[i], &stations[j]))
                .min_by(f64::total_cmp)
        })
        .collect();
    nearest.sort_by(f64::total_cmp);
    nearest.get(nearest.len() / 2).copied().unwrap_or(0.0)
}
