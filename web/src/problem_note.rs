//! What went wrong, as a person is told it: the cause, the next step, and the details to be copied.

use leptos::prelude::*;
use wasm_bindgen_futures::spawn_local;

use crate::clipboard::write_to_clipboard;
use crate::run::Problem;
use crate::state::Workbench;

/// Cause and next step, with the details to be copied.
#[component]
pub(crate) fn ProblemText(problem: Problem) -> impl IntoView {
    let (cause, next_step) = (problem.cause.clone(), problem.next_step.clone());
    view! {
        <div class="problem-text">
            <p class="cause">{cause}</p>
            <p>{next_step}</p>
            <CopyDetails problem />
        </div>
    }
}

/// How far the copying is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Copying {
    NotYet,
    Copied,
    /// The browser does not let a page write to the clipboard.
    Refused,
}

#[component]
fn CopyDetails(problem: Problem) -> impl IntoView {
    let workbench = Workbench::get();
    let details = details(&problem, &workbench.file_name.get_untracked());
    let copying = RwSignal::new(Copying::NotYet);
    let text = details.clone();
    let copy = move |_| {
        let text = text.clone();
        spawn_local(async move {
            let copied = write_to_clipboard(&text).await;
            let _ = copying.try_set(match copied {
                Some(()) => Copying::Copied,
                None => Copying::Refused,
            });
        });
    };
    let word = move || match copying.get() {
        Copying::Copied => "Copied",
        _ => "Copy details",
    };
    view! {
        <button type="button" class="chip" data-testid="copy-details" on:click=copy>
            {word}
        </button>
        <Show when=move || copying.get() == Copying::Refused>
            <pre class="problem-details" tabindex="0" aria-label="Details to be copied by hand">
                {details.clone()}
            </pre>
        </Show>
    }
}

/// What whoever looks into it has to know. Nothing of the scan but its file's name.
fn details(problem: &Problem, file: &str) -> String {
    let browser = window().navigator().user_agent().unwrap_or_default();
    let stage = problem.stage.map_or_else(
        || "none".to_owned(),
        |stage| format!("{stage:?}").to_lowercase(),
    );
    format!(
        "Snellius {}\ncause: {}\nnext step: {}\nkind: {:?}\nstage: {stage}\nfile: {file}\nbrowser: {browser}\n",
        snellius::VERSION,
        problem.cause,
        problem.next_step,
        problem.kind,
    )
}
