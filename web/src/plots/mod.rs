//! Plots: the paper's figures of the measured scan, and what tells how far to trust it. A worker draws
//! them; a point in one is a point everywhere.

mod figure;

use leptos::html;
use leptos::prelude::*;
use snellius::export::ResultFigure;

use self::figure::FigureView;
use crate::run::{CurveKind, FigureOf};
use crate::state::Workbench;

/// What is plotted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Subject {
    TopView,
    BirdsEye,
    RayDistances,
    Wall,
    Index,
}

const SUBJECTS: [(Subject, &str, &str); 5] = [
    (Subject::TopView, "top-view", "Top view"),
    (Subject::BirdsEye, "birds-eye", "Bird's eye"),
    (Subject::RayDistances, "ray-distances", "Ray distances"),
    (Subject::Wall, "wall", "Wall residuals"),
    (Subject::Index, "index", "Over the index"),
];

/// The plots, one subject at a time.
#[component]
pub(crate) fn Plots() -> impl IntoView {
    let workbench = Workbench::get();
    let frame = NodeRef::<html::Div>::new();
    let subject = RwSignal::new(Subject::TopView);
    Effect::new(move |_| {
        workbench.settings.track();
        workbench.corrections.track();
        let at_work = workbench.rerun.with(Option::is_some);
        if subject.get() == Subject::Index && !at_work {
            workbench.ask_for_study();
        }
    });
    let figures = Memo::new(move |_| figures(workbench, subject.get()));
    let tab = move |(of, word, name): (Subject, &'static str, &'static str)| {
        view! {
            <button
                type="button"
                class="chip"
                data-testid=format!("plot-{word}")
                aria-pressed=move || (subject.get() == of).to_string()
                on:click=move |_| subject.set(of)
            >
                {name}
            </button>
        }
    };
    view! {
        <section class="plots panel" aria-labelledby="plots-title" data-testid="plots">
            <div class="panel-head">
                <h2 id="plots-title">"Plots"</h2>
                <div class="plot-subjects" role="group" aria-label="What is plotted">
                    {SUBJECTS.map(tab).collect_view()}
                </div>
            </div>
            <div class="plot-row" node_ref=frame>
                <For each=move || figures.get() key=|figure| figure.id() let:figure>
                    <FigureView figure frame />
                </For>
            </div>
            {move || remark(workbench, subject.get()).map(|words| view! { <p class="help">{words}</p> })}
        </section>
    }
}

/// A figure with its name for tests and files.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Shown {
    of: FigureOf,
    name: String,
    /// Height over width.
    tall: Tall,
}

/// The shape of a figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Tall {
    /// Wider than high.
    Low,
    /// About square.
    Square,
}

impl Shown {
    fn id(&self) -> String {
        self.name.clone()
    }
}

fn figures(workbench: Workbench, subject: Subject) -> Vec<Shown> {
    let of = |figure: ResultFigure, name: &str, tall| Shown {
        of: FigureOf::Result(figure),
        name: name.to_owned(),
        tall,
    };
    match subject {
        Subject::TopView => vec![
            of(ResultFigure::TopView, "top-view", Tall::Square),
            of(
                ResultFigure::TopViewStraight,
                "top-view-without-refraction",
                Tall::Square,
            ),
        ],
        Subject::BirdsEye => vec![of(ResultFigure::BirdsEye, "birds-eye-view", Tall::Square)],
        Subject::RayDistances => vec![
            of(
                ResultFigure::RayDistanceHistogram,
                "ray-distance-histogram",
                Tall::Low,
            ),
            of(ResultFigure::RayDistances, "ray-distances", Tall::Low),
        ],
        Subject::Wall => vec![of(ResultFigure::WallResiduals, "wall-residuals", Tall::Low)],
        Subject::Index => curves(workbench),
    }
}

fn curves(workbench: Workbench) -> Vec<Shown> {
    let Some(study) = workbench.study.get() else {
        return Vec::new();
    };
    let Ok(study) = &*study else {
        return Vec::new();
    };
    let curves = study.curves.iter().enumerate();
    curves
        .map(|(number, curve)| {
            let what = match curve.kind {
                CurveKind::RayDistance => "ray-distance".to_owned(),
                CurveKind::WeightedRayDistance => "weighted-ray-distance".to_owned(),
                CurveKind::Known(_) => format!("known-shape-{number}"),
            };
            Shown {
                of: FigureOf::Curve(number),
                name: format!("{what}-against-n"),
                tall: Tall::Low,
            }
        })
        .collect()
}

/// What is to be said of a subject.
fn remark(workbench: Workbench, subject: Subject) -> Option<String> {
    match subject {
        Subject::TopView => Some(
            "The rig is below. Grey: the wall and the points on it. Colours: the scans, which fall on one \
             another where refraction is counted in (Fig. 11)."
                .to_owned(),
        ),
        Subject::BirdsEye => Some("Grey: the points on the wall. Colours: the scans (Fig. 10).".to_owned()),
        Subject::RayDistances | Subject::Wall => None,
        Subject::Index => match workbench.study.get() {
            None => Some("Every index is being tried.".to_owned()),
            Some(study) => match &*study {
                Err(problem) => Some(problem.cause.clone()),
                Ok(study) => {
                    let has_known = |curve: &crate::run::StudyCurve| {
                        matches!(curve.kind, CurveKind::Known(_))
                    };
                    let none = !study.curves.iter().any(has_known);
                    none.then(|| {
                        "An angle, an edge, a radius or a flat face against n (Fig. 12) needs a known shape: \
                         say it under known in scan.json."
                            .to_owned()
                    })
                }
            },
        },
    }
}
