//! The refraction lab: a bench to play with, reached by the address's hash (`#lab`).
//!
//! The bench itself, its light and its links are the core's (`snellius::lab`); here is what shows them.
//! Pictures are functions from the bench to the text of an SVG; handles and controls change the bench;
//! the address follows.

// What is drawn may differ in a last bit from machine to machine: no result goes through here.
#![allow(clippy::disallowed_methods)]

mod bench;
mod chart;
mod controls;
mod drawing;
mod equations;
mod index;
mod lessons;
mod loupe;
mod measured;
mod section;
mod sheet;
mod sight;
mod space;
mod state;

use leptos::mount;
use leptos::prelude::*;
use snellius::lab::{Bench, View, link};

use self::state::LabState;

/// Whether the lab lies over the workbench, whose keys then mean nothing.
pub(crate) fn is_open() -> bool {
    state::has_mark(OPEN)
}

/// How the page's root is marked while the lab is open.
const OPEN: &str = "data-lab";

/// Puts the lab beside the workbench, over which it lies while the address means it.
pub(crate) fn start() {
    mount::mount_to_body(Lab);
}

#[component]
fn Lab() -> impl IntoView {
    let lab = LabState::new();
    provide_context(lab);
    view! {
        <Show when=move || lab.open.get()>
            <Screen />
        </Show>
    }
}

#[component]
fn Screen() -> impl IntoView {
    let lab = LabState::get();
    let view = Memo::new(move |_| lab.bench.with(|bench| bench.view));
    view! {
        <div class="lab" id="lab" class:embedded=lab.embedded data-testid="lab">
            <Head />
            <main>
                <Trouble />
                <lessons::Banner />
                {move || match view.get() {
                    View::Bench => view! { <bench::BenchView /> }.into_any(),
                    View::See => view! { <sight::SightView /> }.into_any(),
                    View::Index => view! { <index::IndexView /> }.into_any(),
                    View::Lessons => view! { <lessons::List /> }.into_any(),
                    View::Sheet => view! { <sheet::Sheet /> }.into_any(),
                }}
            </main>
        </div>
    }
}

/// The views that have a tab, and its words.
const TABS: [(View, &str, &str); 4] = [
    (View::Bench, "Bench", "tab-bench"),
    (View::See, "See through it", "tab-see"),
    (View::Index, "What is n?", "tab-index"),
    (View::Lessons, "Lessons", "tab-lessons"),
];

#[component]
fn Head() -> impl IntoView {
    let lab = LabState::get();
    let address = move |view| {
        let bench = lab.bench.get();
        format!("#{}", link::write(&Bench { view, ..bench }))
    };
    let current = move |view| (lab.bench.with(|bench| bench.view) == view).then_some("page");
    let tabs = TABS.map(|(view, name, id)| {
        view! {
            <a href=move || address(view) aria-current=move || current(view) data-testid=id>
                {name}
            </a>
        }
    });
    view! {
        <header class="top lab-top">
            <a class="brand" href="#" data-testid="lab-back" title="Back to measuring">
                <svg class="mark" viewBox="0 0 32 32" aria-hidden="true">
                    <path class="water" d="M2 16h28v10a4 4 0 0 1-4 4H6a4 4 0 0 1-4-4z" />
                    <path class="ray" d="M5 3l11 13 4 13" />
                </svg>
                "Snellius"
            </a>
            <h1 class="lab-title">"Refraction lab"</h1>
            <nav class="lab-tabs" aria-label="Refraction lab">
                {tabs}
            </nav>
            <Tools />
        </header>
    }
}

#[component]
fn Tools() -> impl IntoView {
    let lab = LabState::get();
    let said = RwSignal::new(String::new());
    view! {
        <div class="lab-tools">
            <button
                type="button"
                class="quiet"
                data-testid="copy-link"
                title="Copy a link that opens the lab just as it is now"
                on:click=move |_| lab.copy_link(said)
            >
                "Copy link"
            </button>
            <button
                type="button"
                class="quiet"
                data-testid="lab-reset"
                title="Set everything here as it was at first"
                on:click=move |_| {
                    said.set(String::new());
                    lab.reset();
                }
            >
                "Reset"
            </button>
            <button
                type="button"
                class="quiet"
                data-testid="full-screen"
                on:click=move |_| state::toggle_full_screen()
            >
                "Full screen"
            </button>
            <a
                class="leave-frame"
                target="_blank"
                rel="noopener"
                href=move || format!("./#{}", link::write(&lab.bench.get()))
            >
                "Open in a window"
            </a>
            <p class="said" role="status" data-testid="link-status">
                {move || said.get()}
            </p>
        </div>
    }
}

/// What was wrong with the link.
#[component]
fn Trouble() -> impl IntoView {
    let lab = LabState::get();
    let shown = move |cause: String| {
        view! {
            <div class="problem" role="alert" data-testid="lab-problem">
                <div>
                    <p class="cause">"This link cannot be followed: " {cause} "."</p>
                    <p>"Here is the bench as it is at first. Ask whoever sent the link for it again."</p>
                </div>
                <button
                    type="button"
                    class="quiet"
                    aria-label="Close this message"
                    on:click=move |_| lab.trouble.set(None)
                >
                    "Close"
                </button>
            </div>
        }
    };
    move || lab.trouble.get().map(shown)
}
