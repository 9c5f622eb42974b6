//! What the scan tells of the liquid's index: a verdict, every method beside the others, the curves.

use std::sync::Arc;

use leptos::prelude::*;
use snellius::index::{IndexMethod, Observability, Verdict};

use super::curve::CurvePlot;
use super::index::{INDEX, present_index};
use super::numbers::with_sigma;
use crate::number::fixed;
use crate::run::{MethodReport, Problem, Study};
use crate::state::Workbench;

/// Folded away where the scan says the index, so that nothing is computed for nobody.
#[component]
pub(super) fn IndexStudy() -> impl IntoView {
    let workbench = Workbench::get();
    let unknown = Memo::new(move |_| {
        let facts = workbench.facts.get();
        facts.is_some_and(|facts| facts.given_index.is_none())
    });
    let opened = RwSignal::new(false);
    Effect::new(move |_| opened.set(unknown.get()));
    Effect::new(move |_| {
        workbench.settings.track();
        workbench.corrections.track();
        let at_work = workbench.rerun.with(Option::is_some);
        if opened.get() && !at_work {
            workbench.ask_for_study();
        }
    });
    view! {
        <details
            class="index-study"
            data-testid="index-study"
            prop:open=move || opened.get()
            on:toggle=move |event| opened.set(is_open(&event))
        >
            <summary>"What the scan tells of it"</summary>
            {move || {
                let shown = opened.get();
                shown.then(|| match workbench.study.get() {
                    None => view! { <p class="help" role="status">"Every method is being tried."</p> }.into_any(),
                    Some(study) => told(workbench, &study),
                })
            }}
        </details>
    }
}

fn is_open(event: &web_sys::Event) -> bool {
    use wasm_bindgen::JsCast;
    let target = event.target();
    let details = target.and_then(|t| t.dyn_into::<web_sys::Element>().ok());
    details.is_some_and(|details| details.has_attribute("open"))
}

fn told(workbench: Workbench, study: &Arc<Result<Study, Problem>>) -> AnyView {
    let study = match &**study {
        Ok(study) => study.clone(),
        Err(problem) => {
            let cause = problem.cause.clone();
            return view! { <p class="complaint" role="status">{cause}</p> }.into_any();
        }
    };
    let present = Memo::new(move |_| present_index(workbench));
    let curves = study.curves.iter().cloned();
    let curves = curves
        .map(|curve| view! { <CurvePlot curve present /> })
        .collect_view();
    view! {
        {verdict(&study)}
        {study.observability.as_ref().map(signal)}
        {table(workbench, &study)}
        <div class="index-curves">{curves}</div>
    }
    .into_any()
}

/// The verdict in plain words.
fn verdict(study: &Study) -> AnyView {
    let Some(best) = study.best() else {
        return view! {
            <p class="verdict" data-testid="index-verdict">
                "No method applies to this scan, so the index has to be given."
            </p>
        }
        .into_any();
    };
    let value = best.value.map(|value| with_sigma(value, best.sigma));
    let (value, reason) = (
        value.unwrap_or_default(),
        best.reason.clone().unwrap_or_default(),
    );
    let words = match best.verdict {
        Verdict::NotDetermined => format!("The scan cannot tell the index: {reason}."),
        Verdict::Weak => format!(
            "The scan tells the index only roughly: {value}. The true one may lie twice as far off."
        ),
        Verdict::Determined | Verdict::Given => format!("The scan tells the index: {value}."),
    };
    let remedy = best.remedy.clone();
    view! {
        <p class="verdict" data-testid="index-verdict" data-verdict=best.verdict.name()>
            {words}
        </p>
        {remedy
            .map(|remedy| {
                view! {
                    <p class="help" data-testid="index-remedy">
                        {format!("What would tell it: {}.", plus_minus(&remedy))}
                    </p>
                }
            })}
    }
    .into_any()
}

/// What the ray distance can tell, before any search.
fn signal(seen: &Observability) -> impl IntoView + use<> {
    let words = format!(
        "If the index were off by 0.1, the spots would leave their places by {} px (median). A laser that \
         points 0.05\u{b0} beside its calibration shifts the ray distance's index by {} within the plane of the \
         rays, by {} across it, if nothing corrects for that.",
        fixed(0.1 * seen.median_pixels, 3),
        fixed(seen.shift_in_plane.abs(), 3),
        fixed(seen.shift_out_of_plane.abs(), 3),
    );
    view! { <p class="help">{words}</p> }
}

/// All methods beside each other.
fn table(workbench: Workbench, study: &Study) -> impl IntoView + use<> {
    let rows = study.methods.iter().map(|method| row(workbench, method));
    let rows = rows.collect_view();
    let others = study.not_applicable.iter().map(|(method, why)| {
        view! {
            <tr class="not-applicable">
                <th scope="row">{name(*method)}</th>
                <td colspan="5">{format!("does not apply: {why}")}</td>
            </tr>
        }
    });
    let others = others.collect_view();
    view! {
        <div class="index-methods" tabindex="0" role="region" aria-label="Methods">
            <table data-testid="index-methods">
                <thead>
                    <tr>
                        <th scope="col">"Method"</th>
                        <th scope="col" title="One standard deviation">"n \u{b1} \u{3c3}"</th>
                        <th scope="col" title="From noise and calibration, by propagation">
                            "\u{3c3} by sampling"
                        </th>
                        <th scope="col" title="By how much rows of views disagree, left out in turn">
                            "\u{3c3} by model"
                        </th>
                        <th scope="col">"Verdict"</th>
                        <th scope="col">"Use"</th>
                    </tr>
                </thead>
                <tbody>{rows} {others}</tbody>
            </table>
        </div>
    }
}

fn row(workbench: Workbench, report: &MethodReport) -> impl IntoView + use<> {
    let method = report.method;
    let value = match report.value {
        Some(value) => with_sigma(value, report.sigma),
        None => format!("\u{2013} (\u{3c3} {})", fixed(report.sigma, 3)),
    };
    let usable = report.value.is_some();
    let used = move || {
        let settings = workbench.settings.get();
        settings.index.is_none() && settings.index_method == Some(method)
    };
    // The method is set, not the bare number: the result keeps the standard deviation, and says whence.
    let choose = move |_| {
        workbench.change(INDEX, |settings| {
            settings.index = None;
            settings.index_method = Some(method);
        });
        workbench.let_go();
    };
    let test_id = format!("use-{}", method.name());
    view! {
        <tr data-verdict=report.verdict.name() title=report.reason.clone()>
            <th scope="row">{name(method)}</th>
            <td class="value">{value}</td>
            <td class="value">{fixed(report.sampling_sigma, 4)}</td>
            <td class="value">
                {report.model_sigma.map_or("\u{2013}".to_owned(), |sigma| fixed(sigma, 4))}
            </td>
            <td>{word(report.verdict)}</td>
            <td>
                {usable
                    .then(|| {
                        view! {
                            <button
                                type="button"
                                class="chip"
                                data-testid=test_id
                                aria-pressed=move || used().to_string()
                                on:click=choose
                            >
                                "Use this value"
                            </button>
                        }
                    })}
            </td>
        </tr>
    }
}

/// A method's name.
pub(super) const fn name(method: IndexMethod) -> &'static str {
    match method {
        IndexMethod::Given => "Given",
        IndexMethod::RayDistance => "Ray distance",
        IndexMethod::Overlap => "Overlap",
        IndexMethod::KnownShape => "Known shape",
        IndexMethod::Joint => "Joint estimate",
    }
}

const fn word(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Given => "given",
        Verdict::Determined => "determined",
        Verdict::Weak => "weak",
        Verdict::NotDetermined => "not determined",
    }
}

/// The core's plain text with the sign that people read.
fn plus_minus(text: &str) -> String {
    text.replace("+-", "\u{b1}")
}
