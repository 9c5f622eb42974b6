//! The liquid's refractive index: asked for if nobody knows it, and free to be changed, live.

use leptos::prelude::*;

use super::index_is_wanted;
use super::study::name;
use crate::number::fixed;
use crate::run::ProblemKind;
use crate::state::Workbench;

/// What a change of the index is called in the history.
pub(super) const INDEX: &str = "index";

/// Liquids at 20 degrees Celsius and 589 nm.
const LIQUIDS: [(&str, f64); 4] = [
    ("Water", 1.333),
    ("Ethanol", 1.361),
    ("Sugar syrup", 1.44),
    ("Glycerol", 1.473),
];

/// What the slider goes through, and where it stands while nobody knows the index.
const SLIDER: [f64; 2] = [1.0, 1.8];
const USUAL: f64 = 1.37;

/// The index that is set, or else that the object shown was measured with; none while it is asked for.
pub(super) fn present_index(workbench: Workbench) -> Option<f64> {
    let settings = workbench.settings.get();
    let given = workbench.facts.get().and_then(|facts| facts.given_index);
    let said = settings
        .index
        .or(given.filter(|_| settings.index_method.is_none()));
    let used = || {
        let outcome = workbench.outcome.get()?;
        (!index_is_wanted(workbench)).then_some(outcome.index.value)
    };
    said.or_else(used)
}

/// As many digits as any scan tells.
fn rounded(index: f64) -> f64 {
    (index * 1e4).round() / 1e4
}

/// What the index is worth that is used.
fn worth(workbench: Workbench) -> Option<String> {
    let index = workbench.outcome.get()?.index;
    let settled = workbench.rerun.with(Option::is_none) && !index_is_wanted(workbench);
    settled.then(|| match index.sigma {
        Some(sigma) => format!(
            "\u{b1} {}, {}",
            fixed(sigma, 4),
            name(index.method).to_lowercase()
        ),
        None => "given; its \u{b1} is not known".to_owned(),
    })
}

/// The index, its explanation and some liquids.
#[component]
pub(super) fn IndexControl() -> impl IntoView {
    let workbench = Workbench::get();
    let given = move || workbench.facts.get().and_then(|facts| facts.given_index);
    let own = move || workbench.settings.with(|settings| settings.index);
    let method = move || workbench.settings.with(|settings| settings.index_method);
    let wanted = Memo::new(move |_| index_is_wanted(workbench));
    let present = Memo::new(move |_| present_index(workbench).map(rounded));
    let text = RwSignal::new(String::new());
    // Whatever sets the index, the field shows it; what is being typed stays as it is.
    Effect::new(move |_| {
        let index = present.get();
        if text.with_untracked(|text| text.trim().parse().ok()) != index {
            text.set(index.map(|n| n.to_string()).unwrap_or_default());
        }
    });
    let unreadable = RwSignal::new(false);
    let typed = move |event| {
        let typed = event_target_value(&event).replace(',', ".");
        let index = typed.trim().parse::<f64>();
        unreadable.set(index.is_err());
        text.set(typed);
        if let Ok(index) = index {
            workbench.change(INDEX, |settings| settings.index = Some(index));
        }
    };
    let slide = move |event| {
        if let Ok(index) = event_target_value(&event).parse::<f64>() {
            unreadable.set(false);
            workbench.change(INDEX, |settings| settings.index = Some(index));
        }
    };
    let choose = move |index| {
        unreadable.set(false);
        workbench.change(INDEX, |settings| {
            settings.index = index;
            settings.index_method = None;
        });
        workbench.let_go();
    };
    let complaint = move || {
        if unreadable.get() && !wanted.get() {
            return Some("This is no number; the last one is still used.".to_owned());
        }
        let problem = workbench.stage_problem.get()?;
        if problem.kind != ProblemKind::IndexImpossible {
            return None;
        }
        Some(format!(
            "{}. {}",
            problem.cause.trim_end_matches('.'),
            problem.next_step
        ))
    };
    view! {
        <div class="index" class:wanted=move || wanted.get()>
            <Show when=move || wanted.get()>
                <p class="question">"Which liquid is it?"</p>
            </Show>
            <p id="index-help" class="help">
                {move || {
                    if wanted.get() {
                        "The spots are found, but the scan does not say how strongly the liquid bends \
                         light. Give its refractive index, and the object appears at once."
                    } else {
                        "How strongly the liquid bends light. A change is measured at once."
                    }
                }}
            </p>
            <div class="index-row">
                <label for="index-input">"Refractive index"</label>
                <input
                    id="index-input"
                    data-testid="index-input"
                    type="text"
                    inputmode="decimal"
                    autocomplete="off"
                    placeholder="1.333"
                    aria-describedby="index-help index-complaint"
                    aria-invalid=move || complaint().is_some().to_string()
                    prop:value=move || text.get()
                    on:input=typed
                    on:change=move |_| workbench.let_go()
                />
                <span class="value" data-testid="index-worth">
                    {move || worth(workbench)}
                </span>
                <Show when=move || (own().is_some() || method().is_some()) && given().is_some()>
                    <button type="button" class="quiet" on:click=move |_| choose(None)>
                        {move || format!("Back to {}", given().map(|n| fixed(n, 3)).unwrap_or_default())}
                    </button>
                </Show>
            </div>
            <input
                class="index-slider"
                type="range"
                data-testid="index-slider"
                aria-label="Refractive index"
                min=SLIDER[0].to_string()
                max=SLIDER[1].to_string()
                step="0.001"
                prop:value=move || present.get().unwrap_or(USUAL).to_string()
                on:input=slide
                on:change=move |_| workbench.let_go()
            />
            <div class="liquids" role="group" aria-label="Common liquids">
                {LIQUIDS
                    .map(|(name, index)| {
                        view! {
                            <button type="button" class="chip" on:click=move |_| choose(Some(index))>
                                {name}
                                " "
                                <span class="value">{index.to_string()}</span>
                            </button>
                        }
                    })
                    .collect_view()}
            </div>
            <p id="index-complaint" class="complaint" role="status">
                {complaint}
            </p>
        </div>
    }
}
