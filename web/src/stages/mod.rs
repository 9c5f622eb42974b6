//! The stages from scan to result: how it stands with each, what it found, and what can be turned.

mod control;
mod curve;
mod downloads;
mod index;
mod numbers;
mod study;

use leptos::prelude::*;
use snellius::pipeline::Stage;

use self::control::{Choices, Parameters};
use self::downloads::Downloads;
use self::index::IndexControl;
use self::numbers::{Number, brief, numbers};
use self::study::IndexStudy;
use crate::problem_note::ProblemText;
use crate::run::ProblemKind;
use crate::share::PassOn;
use crate::state::{StageState, Workbench};

/// What a section of the panel is about.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Section {
    Of(Stage),
    Share,
}

/// The sections in the order of the work, with their names and what they are for.
const SECTIONS: [(Section, &str, &str); 6] = [
    (Section::Of(Stage::Scan), "Scan", "scan"),
    (Section::Of(Stage::Spots), "Spots", "spots"),
    (Section::Of(Stage::Vessel), "Vessel", "vessel"),
    (Section::Of(Stage::Object), "Object", "object"),
    (Section::Of(Stage::Index), "Index", "index"),
    (Section::Share, "Share", "share"),
];

/// The stages, one below the other.
#[component]
pub(crate) fn Stages() -> impl IntoView {
    let is_guest = Memo::new(move |_| Workbench::get().guest.with(Option::is_some));
    // Of a reconstruction without its archive there is nothing to say of scan and spots.
    let shown = move |section| match section {
        Section::Of(stage) => stage >= Stage::Vessel || !is_guest.get(),
        Section::Share => true,
    };
    view! {
        <section class="stages panel" aria-label="Stages">
            {SECTIONS
                .map(|(section, name, id)| {
                    view! {
                        <Show when=move || shown(section)>
                            <StageSection section name id />
                        </Show>
                    }
                })
                .collect_view()}
        </section>
    }
}

#[component]
fn StageSection(section: Section, name: &'static str, id: &'static str) -> impl IntoView {
    let workbench = Workbench::get();
    let state = Memo::new(move |_| match section {
        Section::Of(stage) => workbench.stage_state(stage),
        Section::Share => share_state(workbench),
    });
    // What needs a person is opened; a person may close it again.
    let opened = Memo::new(move |_| {
        let needs_person = matches!(state.get(), StageState::Warning | StageState::Failed);
        let usually = match section {
            Section::Of(stage) => stage >= Stage::Vessel && workbench.outcome.with(Option::is_some),
            Section::Share => true,
        };
        needs_person || usually
    });
    view! {
        <details
            class="stage-section"
            data-testid=format!("stage-{id}")
            data-state=move || state_word(state.get())
            prop:open=move || opened.get()
        >
            <summary>
                <span class="stage-icon" aria-hidden="true"></span>
                <h2>{name}</h2>
                <span class="brief">
                    {move || match section {
                        Section::Of(stage) => brief(workbench, stage),
                        Section::Share => String::new(),
                    }}
                </span>
                <span class="state-word">{move || state_word(state.get())}</span>
            </summary>
            <div class="stage-body">
                {match section {
                    Section::Of(stage) => view! { <StageBody stage /> }.into_any(),
                    Section::Share => {
                        view! {
                            <Downloads />
                            <PassOn />
                        }
                            .into_any()
                    }
                }}
            </div>
        </details>
    }
}

#[component]
fn StageBody(stage: Stage) -> impl IntoView {
    let workbench = Workbench::get();
    let can_change = Memo::new(move |_| workbench.guest.with(Option::is_none));
    view! {
        <Complaint stage />
        <Warnings stage />
        <Show when=move || can_change.get() && stage == Stage::Index>
            <IndexControl />
            <IndexStudy />
        </Show>
        <Show when=move || can_change.get()>
            <Choices stage />
        </Show>
        <Numbers stage />
        <Show when=move || can_change.get()>
            <Parameters stage />
        </Show>
    }
}

/// Why the stage could not be done.
#[component]
fn Complaint(stage: Stage) -> impl IntoView {
    let workbench = Workbench::get();
    let complaint = move || {
        let problem = workbench.stage_problem.get()?;
        // The index says by itself what is the matter with it.
        (problem.stage == Some(stage) && stage != Stage::Index).then_some(problem)
    };
    move || {
        complaint().map(|problem| {
            let earlier = workbench.outcome.with(Option::is_some);
            view! {
                <div class="complaint" role="alert" data-testid="stage-problem">
                    <ProblemText problem />
                    {earlier.then_some(view! { <p>"What is shown is the result before the change."</p> })}
                </div>
            }
        })
    }
}

/// What to know before trusting it.
#[component]
fn Warnings(stage: Stage) -> impl IntoView {
    let workbench = Workbench::get();
    let warnings = Memo::new(move |_| {
        let outcome = workbench.outcome.get();
        let all = outcome.iter().flat_map(|outcome| &outcome.warnings);
        let own = all.filter(|warning| warning.stage == stage);
        own.map(|warning| warning.text.clone()).collect::<Vec<_>>()
    });
    view! {
        <Show when=move || !warnings.with(Vec::is_empty)>
            <ul class="warnings" aria-label="Worth knowing">
                {move || warnings.get().into_iter().map(|text| view! { <li>{text}</li> }).collect_view()}
            </ul>
        </Show>
    }
}

#[component]
fn Numbers(stage: Stage) -> impl IntoView {
    let workbench = Workbench::get();
    let entries = Memo::new(move |_| numbers(workbench, stage));
    let entry = |number: Number| {
        view! {
            <div title=number.meaning>
                <dt>{number.name}</dt>
                <dd>{number.value}</dd>
            </div>
        }
    };
    let test_id = (stage == Stage::Object).then_some("summary");
    view! {
        <Show when=move || !entries.with(Vec::is_empty)>
            <dl class="numbers" data-testid=test_id>
                {move || entries.get().into_iter().map(entry).collect_view()}
            </dl>
        </Show>
    }
}

fn share_state(workbench: Workbench) -> StageState {
    if workbench.outcome.with(Option::is_none) || workbench.rerun.with(Option::is_some) {
        StageState::Waiting
    } else {
        StageState::Done
    }
}

const fn state_word(state: StageState) -> &'static str {
    match state {
        StageState::Waiting => "waiting",
        StageState::Running => "running",
        StageState::Done => "done",
        StageState::Warning => "warning",
        StageState::Failed => "failed",
    }
}

/// Whether the liquid's index is all that is missing.
fn index_is_wanted(workbench: Workbench) -> bool {
    workbench.stage_problem.with(|problem| {
        problem
            .as_ref()
            .is_some_and(|problem| problem.kind == ProblemKind::IndexWanted)
    })
}
