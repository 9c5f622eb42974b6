//! The result in a few numbers, and what to know before trusting it.

use leptos::prelude::*;

use crate::number::fixed;
use crate::run::{Face, Outcome, Place};
use crate::state::Workbench;

/// The numbers.
#[component]
pub(crate) fn Summary() -> impl IntoView {
    let workbench = Workbench::get();
    let numbers = move || workbench.outcome.get().map(|outcome| numbers(&outcome));
    view! {
        <section class="summary panel" data-testid="summary" aria-labelledby="summary-title">
            <h2 id="summary-title">"Result"</h2>
            <dl>
                {move || {
                    let entries = numbers().unwrap_or_default().into_iter();
                    entries
                        .map(|(name, value, meaning)| {
                            view! {
                                <div title=meaning>
                                    <dt>{name}</dt>
                                    <dd>{value}</dd>
                                </div>
                            }
                        })
                        .collect_view()
                }}
            </dl>
        </section>
    }
}

type Number = (&'static str, String, &'static str);

fn numbers(outcome: &Outcome) -> Vec<Number> {
    let Outcome { wall, summary, .. } = outcome;
    let millimetres = |value: f64| format!("{} mm", fixed(value, 3));
    let mut numbers = vec![
        (
            "Views used",
            format!("{} of {}", summary.used, outcome.views.len()),
            "Views that gave a point of the object",
        ),
        (
            "Mean ray distance",
            summary
                .mean_ray_distance
                .map_or("none".to_owned(), millimetres),
            "How far beam and line of sight pass each other at the object, on the average: small if \
             calibration and index are right",
        ),
        (
            "Wall fit, RMS",
            millimetres(wall.rms),
            "Root mean square distance of the vessel points from the fitted wall",
        ),
        (
            "Wall points",
            wall.points.to_string(),
            "Vessel points that carry the wall",
        ),
    ];
    numbers.extend(shape(&wall.face));
    numbers.push((
        "Wall thickness",
        format!("{} mm", fixed(wall.thickness, 2)),
        "As the scan gives it",
    ));
    if let Some(off_line) = summary.median_off_line {
        numbers.push((
            "Off the epipolar line",
            format!("{} px", fixed(off_line, 2)),
            "Median distance of the wall's spots from the epipolar line: near 0 if the calibration is right",
        ));
    }
    numbers
}

fn shape(face: &Face) -> Vec<Number> {
    let vector = |vector: Place| vector.map(|part| fixed(part, 3)).join(" ");
    let round = |radius: f64| {
        (
            "Outer radius",
            format!("{} mm", fixed(radius, 2)),
            "Of the wall's outer face",
        )
    };
    match face {
        Face::Freeform(_) => vec![(
            "Wall shape",
            "free form".to_owned(),
            "A smooth wall, as the vessel points show it",
        )],
        Face::Plane { normal, .. } => vec![(
            "Wall normal",
            vector(*normal),
            "x y z of the unit vector across the wall, towards the rig",
        )],
        Face::Cylinder { axis, radius, .. } => vec![
            round(*radius),
            (
                "Axis",
                vector(*axis),
                "x y z of the unit vector along the axis",
            ),
        ],
        Face::Sphere { radius, .. } => vec![round(*radius)],
    }
}

/// The warnings, if there are any.
#[component]
pub(crate) fn Warnings() -> impl IntoView {
    let workbench = Workbench::get();
    let warnings = move || {
        let outcome = workbench.outcome.get();
        outcome
            .map(|outcome| outcome.warnings.clone())
            .unwrap_or_default()
    };
    view! {
        <Show when=move || !warnings().is_empty()>
            <section class="warnings panel" data-testid="warnings" aria-labelledby="warnings-title">
                <h2 id="warnings-title">"Worth knowing"</h2>
                <ul>
                    {move || warnings().into_iter().map(|text| view! { <li>{text}</li> }).collect_view()}
                </ul>
            </section>
        </Show>
    }
}
