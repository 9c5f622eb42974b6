//! The liquid's refractive index: asked for if nobody knows it, and free to be changed, live.

use leptos::prelude::*;

use super::index_is_wanted;
use crate::number::fixed;
use crate::run::ProblemKind;
use crate::state::Workbench;

/// What a change of the index is called in the history.
const INDEX: &str = "index";

/// Liquids at 20 degrees Celsius and 589 nm.
const LIQUIDS: [(&str, f64); 4] = [
    ("Water", 1.333),
    ("Ethanol", 1.361),
    ("Sugar syrup", 1.44),
    ("Glycerol", 1.473),
];

/// The index, its explanation and some liquids.
#[component]
pub(super) fn IndexControl() -> impl IntoView {
    let workbench = Workbench::get();
    let given = move || workbench.facts.get().and_then(|facts| facts.given_index);
    let own = move || workbench.settings.with(|settings| settings.index);
    let wanted = Memo::new(move |_| index_is_wanted(workbench));
    let text = RwSignal::new(String::new());
    // Whatever sets the index, the field shows it; what is being typed stays as it is.
    Effect::new(move |_| {
        let index = own().or_else(given);
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
    let choose = move |index| {
        unreadable.set(false);
        workbench.change(INDEX, |settings| settings.index = index);
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
                <Show when=move || own().is_some() && given().is_some()>
                    <button type="button" class="quiet" on:click=move |_| choose(None)>
                        {move || format!("Back to {}", given().map(|n| fixed(n, 3)).unwrap_or_default())}
                    </button>
                </Show>
            </div>
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
