//! What is n? The L-shaped object reconstructed at any index, the two curves that tell the right one, and
//! how many tries scatter.

use std::time::Duration;

use leptos::prelude::*;
use snellius::lab::Bench;
use snellius::lab::known_shape::{Estimate, Experiment, RANGE, RIGHT_ANGLE, outline};

use super::chart::{Chart, SIZE};
use super::controls::{MediumControl, QuantityControl};
use super::drawing::{At, Drawing};
use super::lessons::MysteryCheck;
use super::state::LabState;
use crate::number::fixed;

/// The indices of the paper's Fig. 8.
const FIGURE_8: [f64; 3] = [0.9, 1.3, 1.7];
/// How many tries are made.
const TRIES: u64 = 60;

/// What of the bench the measurement depends on; the rest is as at first.
fn experiment_of(bench: &Bench) -> Bench {
    Bench {
        outside: bench.outside,
        glass: bench.glass,
        liquid: bench.liquid,
        thickness: bench.thickness,
        pitch: bench.pitch,
        l_turn: bench.l_turn,
        noise: bench.noise,
        out_of_plane: bench.out_of_plane,
        in_plane: bench.in_plane,
        ..Bench::default()
    }
}

/// Both curves of one measurement.
#[derive(Clone, PartialEq)]
struct Curves {
    angle: Vec<(f64, f64)>,
    sum: Vec<(f64, f64)>,
    estimate: Estimate,
    /// How far the rays of exact spots miss each other where n is wrong by 0.1, on average, mm.
    signal: f64,
    spots: usize,
}

impl Curves {
    fn of(bench: &Bench) -> Self {
        const STEPS: i32 = 45;
        let exact = Experiment::new(bench);
        let tried = exact.disturbed(0);
        let indices = (0..=STEPS)
            .map(|step| RANGE.0 + (RANGE.1 - RANGE.0) * f64::from(step) / f64::from(STEPS));
        let spots = exact.spots().len();
        let wrong = exact.sum_of_ray_distances(bench.liquid.index() + 0.1);
        Self {
            angle: indices
                .clone()
                .filter_map(|n| Some((n, tried.angle(n)?)))
                .collect(),
            sum: indices
                .map(|n| (n, tried.sum_of_ray_distances(n)))
                .collect(),
            estimate: tried.estimate(),
            signal: wrong / spots.max(1) as f64,
            spots,
        }
    }
}

/// The view.
#[component]
pub(super) fn IndexView() -> impl IntoView {
    let lab = LabState::get();
    let bench = Memo::new(move |_| lab.bench.with(experiment_of));
    let curves = Memo::new(move |_| bench.with(Curves::of));
    let tries = tries(bench);
    view! {
        <div class="bench what-is-n">
            <section class="panel pictures-of-bench" aria-labelledby="l-title">
                <h2 id="l-title">"The L, reconstructed at n"</h2>
                <TopView bench />
            </section>
            <Controls />
            <section class="panel chart-panel" aria-labelledby="angle-title">
                <h2 id="angle-title">"Angle of the L, eq. (4)"</h2>
                <AngleChart curves />
            </section>
            <section class="panel chart-panel" aria-labelledby="sum-title">
                <h2 id="sum-title">"Sum of the ray distances l, eq. (3)"</h2>
                <SumChart curves />
                <Why curves />
            </section>
            <section class="panel chart-panel" aria-labelledby="tries-title">
                <h2 id="tries-title">"The index by many tries"</h2>
                <Tries tries />
            </section>
        </div>
    }
}

#[component]
fn Controls() -> impl IntoView {
    view! {
        <section class="panel controls" aria-label="What can be set">
            <fieldset>
                <legend>"Reconstructed at"</legend>
                <QuantityControl key="n" />
            </fieldset>
            <fieldset>
                <legend>"Set-up"</legend>
                <QuantityControl key="pitch" />
                <QuantityControl key="l" />
                <QuantityControl key="thickness" />
                <MediumControl key="liquid" />
            </fieldset>
            <fieldset>
                <legend>"Errors"</legend>
                <QuantityControl key="noise" />
                <QuantityControl key="out" />
                <QuantityControl key="in" />
            </fieldset>
            <MysteryCheck />
        </section>
    }
}

/// The points from above at the index that is tried, with those of Fig. 8.
#[component]
fn TopView(bench: Memo<Bench>) -> impl IntoView {
    let lab = LabState::get();
    let trial = Memo::new(move |_| lab.bench.with(|bench| bench.trial));
    let tried = Memo::new(move |_| bench.with(|bench| Tried::of(bench, trial.get())));
    let angle = move || {
        let angle = tried.with(|tried| tried.angle);
        angle.map_or("\u{2013}".to_owned(), |angle| {
            format!("{}\u{b0}", fixed(angle, 2))
        })
    };
    view! {
        <svg
            class="lab-svg top-view"
            viewBox=format!("0 0 {} {}", TOP_VIEW[0], TOP_VIEW[1])
            role="img"
            aria-label="From above: the wall, the L, and the points reconstructed at n"
        >
            <g inner_html=move || bench.with(|bench| tried.with(|tried| draw(bench, tried)))></g>
        </svg>
        <p class="l-angle">
            "At n = " <span class="value">{move || fixed(trial.get(), 3)}</span> " the angle is "
            <strong class="value" data-testid="l-angle">
                {angle}
            </strong> "; in truth it is 90\u{b0}."
        </p>
    }
}

const TOP_VIEW: At = [540.0, 330.0];

/// The L at the index that is tried, and at those of Fig. 8: x and z of each point.
#[derive(Clone, PartialEq)]
struct Tried {
    points: Vec<[f64; 2]>,
    figure_8: [Vec<[f64; 2]>; 3],
    angle: Option<f64>,
}

impl Tried {
    fn of(bench: &Bench, trial: f64) -> Self {
        let experiment = Experiment::new(bench).disturbed(0);
        let points = |index: f64| {
            let meetings = experiment.meetings(index);
            let points = meetings
                .iter()
                .flatten()
                .map(|meeting| meeting.point().coords);
            points.map(|p| [p.x, p.z]).collect()
        };
        Self {
            points: points(trial),
            figure_8: FIGURE_8.map(points),
            angle: experiment.angle(trial),
        }
    }
}

fn draw(bench: &Bench, tried: &Tried) -> String {
    // z upwards, as the paper's figure has it; the rig stands below.
    let place = |[x, z]: [f64; 2]| [270.0 + 2.4 * x, 300.0 - 2.0 * z];
    let mut drawing = Drawing::default();
    let (front, back) = (place([0.0, 0.0])[1], place([0.0, bench.thickness])[1]);
    drawing.rect("liquid", [0.0, 0.0], [TOP_VIEW[0], back]);
    drawing.rect("glass", [0.0, back], [TOP_VIEW[0], front - back]);
    drawing.line("face", [0.0, front], [TOP_VIEW[0], front]);
    drawing.line("face", [0.0, back], [TOP_VIEW[0], back]);
    drawing.path("true-shape", &outline(bench.l_turn).map(place), false);
    for ((class, points), index) in [("first", 0), ("second", 1), ("third", 2)]
        .map(|(class, at)| (class, &tried.figure_8[at]))
        .into_iter()
        .zip(FIGURE_8)
    {
        for point in points {
            drawing.circle(&format!("cloud {class}"), place(*point), 2.2);
        }
        // The name stands beside the rightmost point.
        if let Some(end) = points.iter().max_by(|a, b| a[0].total_cmp(&b[0])) {
            let [x, y] = place(*end);
            let text = format!("{index:.1}");
            drawing.text(&format!("cloud-name {class}"), [x + 8.0, y + 4.0], &text);
        }
    }
    for point in &tried.points {
        drawing.circle("cloud trial", place(*point), 3.4);
    }
    drawing.text(
        "medium",
        [12.0, TOP_VIEW[1] - 8.0],
        "The rig passes below, at three heights",
    );
    drawing.text("medium end", [TOP_VIEW[0] - 12.0, 22.0], "From above");
    drawing.text_of()
}

#[component]
fn ChartPicture(
    label: &'static str,
    id: &'static str,
    drawn: impl Fn() -> String + Send + Sync + 'static,
) -> impl IntoView {
    view! {
        <svg
            class="lab-svg chart"
            viewBox=format!("0 0 {} {}", SIZE[0], SIZE[1])
            role="img"
            aria-label=label
            data-testid=id
        >
            <g inner_html=drawn></g>
        </svg>
    }
}

/// The index that is tried, and the right one unless it is to be found out.
fn uprights(chart: &mut Chart, bench: &Bench) {
    if !bench.hides_index() {
        chart.upright("truth", bench.liquid.index(), "true n");
    }
    chart.upright("trial", bench.trial, "n tried");
}

#[component]
fn AngleChart(curves: Memo<Curves>) -> impl IntoView {
    let lab = LabState::get();
    let drawn = move || {
        lab.bench.with(|bench| {
            curves.with(|curves| {
                let mut chart = Chart::new((60.0, 140.0), 0);
                chart.level("wanted", RIGHT_ANGLE);
                uprights(&mut chart, bench);
                chart.curve("curve", &curves.angle);
                if let Some(index) = curves.estimate.by_angle {
                    chart.dot("found", index, RIGHT_ANGLE, 5.0);
                }
                chart.text_of()
            })
        })
    };
    let found = move || {
        curves.with(|curves| match curves.estimate.by_angle {
            Some(index) => format!("It is 90\u{b0} at n = {}.", fixed(index, 3)),
            None => "It is 90\u{b0} nowhere between 0.9 and 1.8.".to_owned(),
        })
    };
    view! {
        <ChartPicture label="The angle of the L over the index" id="angle-chart" drawn />
        <p class="help" data-testid="index-by-angle">
            {found}
        </p>
    }
}

#[component]
fn SumChart(curves: Memo<Curves>) -> impl IntoView {
    let lab = LabState::get();
    let drawn = move || {
        lab.bench.with(|bench| {
            curves.with(|curves| {
                let top = curves.sum.iter().map(|(_, sum)| *sum).fold(4.0, f64::max);
                let mut chart = Chart::new((0.0, top), 1);
                uprights(&mut chart, bench);
                chart.curve("curve", &curves.sum);
                let index = curves.estimate.by_ray_distance;
                let least = curves
                    .sum
                    .iter()
                    .min_by(|a, b| (a.0 - index).abs().total_cmp(&(b.0 - index).abs()));
                if let Some((_, sum)) = least.filter(|_| !at_an_end(index)) {
                    chart.dot("found", index, *sum, 5.0);
                }
                chart.text_of()
            })
        })
    };
    let found = move || {
        curves.with(|curves| {
            let index = curves.estimate.by_ray_distance;
            if at_an_end(index) {
                format!(
                    "It is least at {}, an end of the range: that is no index.",
                    fixed(index, 2)
                )
            } else {
                format!("It is least at n = {}.", fixed(index, 3))
            }
        })
    };
    view! {
        <ChartPicture label="The sum of the ray distances, in millimetres, over the index" id="sum-chart" drawn />
        <p class="help" data-testid="index-by-ray-distance">
            {found}
        </p>
    }
}

/// Whether a least sum lies where the search stopped, and so means nothing.
fn at_an_end(index: f64) -> bool {
    index - RANGE.0 < 0.02 || RANGE.1 - index < 0.02
}

/// Why the sum is flat, or how much of it is.
#[component]
fn Why(curves: Memo<Curves>) -> impl IntoView {
    let lab = LabState::get();
    let why = move || {
        let (pitch, noise) = lab.bench.with(|bench| (bench.pitch, bench.noise));
        let (signal, spots) = curves.with(|curves| (curves.signal, curves.spots));
        if pitch.abs() < 0.5 {
            return "The rig stands squarely before the tank: beam, camera and the wall's normal lie in one \
                    plane. Bent, both rays stay in that plane, and two lines in a plane meet, whatever n is. \
                    All that is left in the curve is noise and calibration error. Pitch the rig."
                .to_owned();
        }
        format!(
            "Pitched by {}\u{b0}, the rays leave their common plane: where n is wrong by 0.1, those of the {spots} \
             spots miss each other by {} mm on average. Noise of {} px makes about {} mm.",
            fixed(pitch.abs(), 1),
            fixed(signal, 3),
            fixed(noise, 2),
            fixed(noise * MM_PER_PX, 3)
        )
    };
    view! {
        <p class="help" data-testid="why-flat">
            {why}
        </p>
    }
}

/// What a pixel across the beam's plane is in the ray distance: 430 mm away at a focal length of 1,100 px,
/// times the mean size of a normal deviate.
const MM_PER_PX: f64 = 430.0 / 1100.0 * 0.8;

/// Many tries, some at a time, so that the page stays alive; begun anew whenever the bench changes.
fn tries(bench: Memo<Bench>) -> RwSignal<Vec<Estimate>> {
    const REST: Duration = Duration::from_millis(250);
    let tries = RwSignal::new(Vec::new());
    let run = StoredValue::new(0_u32);
    let mut begin = debounce(REST, move |number: u32| {
        let Some(bench) = bench.try_get_untracked() else {
            return;
        };
        go_on(Experiment::new(&bench), tries, run, number);
    });
    Effect::new(move |_| {
        bench.track();
        tries.set(Vec::new());
        run.update_value(|run| *run += 1);
        begin(run.get_value());
    });
    tries
}

fn go_on(
    experiment: Experiment,
    tries: RwSignal<Vec<Estimate>>,
    run: StoredValue<u32>,
    number: u32,
) {
    const AT_ONCE: u64 = 3;
    // The view may be gone, or the bench another one.
    if run.try_get_value() != Some(number) {
        return;
    }
    let Some(done) = tries.try_with_untracked(|tries| tries.len() as u64) else {
        return;
    };
    let next = done..(done + AT_ONCE).min(TRIES);
    let estimates: Vec<_> = next
        .map(|try_number| experiment.disturbed(try_number).estimate())
        .collect();
    if estimates.is_empty() {
        return;
    }
    tries.update(|tries| tries.extend(estimates));
    set_timeout(
        move || go_on(experiment, tries, run, number),
        Duration::ZERO,
    );
}

#[component]
fn Tries(tries: RwSignal<Vec<Estimate>>) -> impl IntoView {
    let lab = LabState::get();
    let drawn = move || {
        lab.bench
            .with(|bench| tries.with(|tries| draw_tries(bench, tries)))
    };
    let spread = move |of: fn(&Estimate) -> Option<f64>| {
        tries.with(|tries| {
            let found: Vec<f64> = tries.iter().filter_map(of).collect();
            let count = found.len() as f64;
            if found.len() < 2 {
                return "\u{2013}".to_owned();
            }
            let mean = found.iter().sum::<f64>() / count;
            let squares: f64 = found.iter().map(|n| (n - mean) * (n - mean)).sum();
            format!(
                "{} \u{b1} {}",
                fixed(mean, 3),
                fixed((squares / (count - 1.0)).sqrt(), 3)
            )
        })
    };
    let at_ends = move || {
        let count = tries.with(|tries| {
            tries
                .iter()
                .filter(|t| at_an_end(t.by_ray_distance))
                .count()
        });
        if count == 0 {
            String::new()
        } else {
            format!(" {count} tries by eq. (3) ended at an end of the range.")
        }
    };
    view! {
        <ChartPicture label="The indices that each try gives, by either equation" id="tries-chart" drawn />
        <p class="help" data-testid="tries">
            {move || tries.with(Vec::len)} " tries, one above the other. "
            <span class="key by-angle">"By the angle, eq. (4): "</span>
            <span class="value">{move || spread(|t| t.by_angle)}</span> ". "
            <span class="key by-distance">"By the ray distances, eq. (3): "</span>
            <span class="value">{move || spread(|t| Some(t.by_ray_distance))}</span> "." {at_ends}
        </p>
    }
}

fn draw_tries(bench: &Bench, tries: &[Estimate]) -> String {
    let mut chart = Chart::new((0.0, 60.0), 0);
    uprights(&mut chart, bench);
    for (number, estimate) in tries.iter().enumerate() {
        let height = number as f64 + 0.5;
        if let Some(index) = estimate.by_angle {
            chart.dot("by-angle", index, height, 2.6);
        }
        chart.dot("by-distance", estimate.by_ray_distance, height, 2.6);
    }
    chart.text_of()
}
