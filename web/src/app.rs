//! The page: which screen is shown, what went wrong, and files dropped anywhere.

use leptos::prelude::*;
use leptos::{ev, html, mount};
use web_sys::DragEvent;

use crate::files::FILE_INPUT;
use crate::history::History;
use crate::launch;
use crate::making::{self, MakingScreen};
use crate::problem_note::ProblemText;
use crate::progress::RunningScreen;
use crate::result::ResultScreen;
use crate::run::Problem;
use crate::sessions::{self, NotKeptNote};
use crate::share;
use crate::shortcuts::{self, HelpSheet};
use crate::start::StartScreen;
use crate::state::{Screen, Workbench};

/// Puts the page in the place of what was shown while it loaded.
pub(crate) fn start() {
    if let Some(shell) = document().get_element_by_id("shell") {
        shell.remove();
    }
    sessions::sweep();
    mount::mount_to_body(App);
}

#[component]
fn App() -> impl IntoView {
    let workbench = Workbench::new();
    provide_context(workbench);
    Effect::new(move |_| {
        let word = workbench.word();
        if let Some(root) = document().document_element() {
            let _ = root.set_attribute("data-state", word);
        }
    });
    accept_drops(workbench);
    shortcuts::listen(workbench);
    share::follow_address(workbench);
    launch::accept(workbench);
    let screen = Memo::new(move |_| workbench.screen());
    view! {
        <Header />
        <HelpSheet />
        <FileInput />
        <main id="main">
            <ProblemNote />
            <NotKeptNote />
            {move || match screen.get() {
                Screen::Start => view! { <StartScreen /> }.into_any(),
                Screen::Making => view! { <MakingScreen /> }.into_any(),
                Screen::Running => view! { <RunningScreen /> }.into_any(),
                Screen::Result => view! { <ResultScreen /> }.into_any(),
            }}
        </main>
    }
}

#[component]
fn Header() -> impl IntoView {
    let workbench = Workbench::get();
    let screen = Memo::new(move |_| workbench.screen());
    let name = move || {
        let facts = workbench.facts.get();
        facts.map(|facts| facts.name.clone()).unwrap_or_default()
    };
    view! {
        <header class="top">
            <span class="brand">
                <Mark />
                "Snellius"
            </span>
            <Show when=move || screen.get() == Screen::Result>
                <h1 class="scan-name">{name}</h1>
                <HistoryButtons />
                <button type="button" on:click=move |_| workbench.go_to_start()>
                    "Open another scan"
                </button>
            </Show>
        </header>
    }
}

/// Undo and redo, and the keys.
#[component]
fn HistoryButtons() -> impl IntoView {
    let workbench = Workbench::get();
    let can_undo = move || workbench.history.with(History::can_undo);
    let can_redo = move || workbench.history.with(History::can_redo);
    view! {
        <div class="history">
            <button
                type="button"
                class="quiet"
                title="Take the last change back (Ctrl Z)"
                data-testid="undo"
                disabled=move || !can_undo()
                on:click=move |_| workbench.undo()
            >
                "Undo"
            </button>
            <button
                type="button"
                class="quiet"
                title="Make it again (Ctrl Shift Z)"
                data-testid="redo"
                disabled=move || !can_redo()
                on:click=move |_| workbench.redo()
            >
                "Redo"
            </button>
            <button
                type="button"
                class="quiet"
                title="Keys and gestures (?)"
                aria-label="Keys and gestures"
                on:click=move |_| workbench.help.set(true)
            >
                "?"
            </button>
        </div>
    }
}

/// A ray that is bent at a face.
#[component]
fn Mark() -> impl IntoView {
    view! {
        <svg class="mark" viewBox="0 0 32 32" aria-hidden="true">
            <path class="water" d="M2 16h28v10a4 4 0 0 1-4 4H6a4 4 0 0 1-4-4z" />
            <path class="ray" d="M5 3l11 13 4 13" />
        </svg>
    }
}

/// The browser's file chooser, on every screen; the start screen's button opens it.
#[component]
fn FileInput() -> impl IntoView {
    let workbench = Workbench::get();
    let input = NodeRef::<html::Input>::new();
    let choose = move |_| making::open_chosen(workbench, input);
    view! {
        <input
            node_ref=input
            id=FILE_INPUT
            type="file"
            accept=".zip,application/zip,.html,.json"
            data-testid="file-input"
            aria-label="Scan archive"
            hidden
            on:change=choose
        />
    }
}

#[component]
fn ProblemNote() -> impl IntoView {
    let workbench = Workbench::get();
    let shown = move |problem: Problem| {
        view! {
            <div class="problem" role="alert" data-testid="error">
                <ProblemText problem />
                <button
                    type="button"
                    class="quiet"
                    aria-label="Close this message"
                    on:click=move |_| workbench.problem.set(None)
                >
                    "Close"
                </button>
            </div>
        }
    };
    move || workbench.problem.get().map(shown)
}

/// A file may be dropped anywhere, whatever is shown.
fn accept_drops(workbench: Workbench) {
    let over = window_event_listener(ev::dragover, |event: DragEvent| event.prevent_default());
    let drop = window_event_listener(ev::drop, move |event: DragEvent| {
        event.prevent_default();
        if let Some(data) = event.data_transfer() {
            making::open_dropped(workbench, &data);
        }
    });
    on_cleanup(move || {
        over.remove();
        drop.remove();
    });
}
