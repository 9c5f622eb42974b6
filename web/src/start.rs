//! The start screen: what this is, and the ways to give it a scan.

use leptos::html;
use leptos::prelude::*;
use serde::Deserialize;
use wasm_bindgen_futures::spawn_local;
use web_sys::DragEvent;

use crate::files;
use crate::making::open_chosen;
use crate::number::megabytes;
use crate::run::Problem;
use crate::sessions::{Origin, Shelf};
use crate::state::Workbench;

/// A scan that comes with the page: an entry of `samples/index.json`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
struct Sample {
    id: String,
    title: String,
    description: String,
    file: String,
    /// Its size, if the index says it.
    #[serde(default)]
    bytes: Option<f64>,
}

/// The start screen.
#[component]
pub(crate) fn StartScreen() -> impl IntoView {
    let workbench = Workbench::get();
    view! {
        <div class="start">
            <div class="purpose">
                <h1>"Measure objects in 3\u{2011}D through glass and liquid"</h1>
                <p>
                    "Snellius takes pictures of a laser's spots on a vessel and on what stands in it, bends \
                     every ray of light as glass and liquid do, and gives the object's points in millimetres."
                </p>
            </div>
            <DropZone />
            <FoldersAndPictures />
            <p class="privacy">
                <Lock />
                "Nothing leaves your machine: the scan is read and measured by this page, in your browser."
            </p>
            <Show when=move || workbench.has_result()>
                <button type="button" class="quiet" on:click=move |_| workbench.go_to_result()>
                    "Back to the result"
                </button>
            </Show>
            <Shelf />
            <Samples />
            <p class="to-the-lab">
                <a href="#lab" data-testid="open-lab">
                    "Refraction lab"
                </a> ": bend light with your own hands, see through glass and water, and find out what n is."
            </p>
        </div>
    }
}

#[component]
fn Lock() -> impl IntoView {
    view! {
        <svg class="icon" viewBox="0 0 16 16" aria-hidden="true">
            <path d="M4.5 7V5a3.5 3.5 0 0 1 7 0v2M3 7h10v7H3z" />
        </svg>
    }
}

#[component]
fn DropZone() -> impl IntoView {
    let hovered = RwSignal::new(false);
    view! {
        <div
            class="drop-zone"
            class:hovered=move || hovered.get()
            data-testid="drop-zone"
            on:click=move |_| files::ask_for_one()
            on:dragover=move |event: DragEvent| {
                event.prevent_default();
                hovered.set(true);
            }
            on:dragleave=move |_| hovered.set(false)
            on:drop=move |_| hovered.set(false)
        >
            <svg class="drop-picture" viewBox="0 0 64 48" aria-hidden="true">
                <path class="water" d="M12 22h40v18a4 4 0 0 1-4 4H16a4 4 0 0 1-4-4z" />
                <path class="glass" d="M12 10v30a4 4 0 0 0 4 4h32a4 4 0 0 0 4-4V10" />
                <path class="ray" d="M4 4l22 18 7 14" />
                <circle class="spot" cx="33" cy="36" r="2.6" />
            </svg>
            <p class="drop-title">"Drop a scan archive here"</p>
            <button type="button" class="primary">
                "Choose a file"
            </button>
            <p class="drop-hint">
                "A .zip, or a folder, with " <code>"scan.json"</code> " and pictures with the laser on and off"
            </p>
        </div>
    }
}

/// The other ways in: a folder, and pictures without a manifest.
#[component]
fn FoldersAndPictures() -> impl IntoView {
    let workbench = Workbench::get();
    let folder = NodeRef::<html::Input>::new();
    view! {
        <div class="other-ways">
            <button type="button" data-testid="choose-folder" on:click=move |_| files::click(folder)>
                "Choose a folder"
            </button>
            <input
                node_ref=folder
                type="file"
                prop:webkitdirectory=true
                data-testid="folder-input"
                aria-label="Folder with a scan"
                hidden
                on:change=move |_| open_chosen(workbench, folder)
            />
            <button type="button" data-testid="make-scan" on:click=move |_| workbench.making.show()>
                "Make a scan from pictures"
            </button>
        </div>
    }
}

#[component]
fn Samples() -> impl IntoView {
    let samples = RwSignal::new(Vec::<Sample>::new());
    spawn_local(async move {
        // A page without samples is a whole page.
        if let Ok(json) = files::fetch_json("samples/index.json").await {
            samples.set(serde_wasm_bindgen::from_value(json).unwrap_or_default());
        }
    });
    view! {
        <Show when=move || !samples.with(Vec::is_empty)>
            <section class="samples" aria-labelledby="samples-title">
                <h2 id="samples-title">"No scan at hand? Try one of these"</h2>
                <ul>
                    <For each=move || samples.get() key=|sample| sample.id.clone() let:sample>
                        <li>
                            <SampleButton sample />
                        </li>
                    </For>
                </ul>
            </section>
        </Show>
    }
}

#[component]
fn SampleButton(sample: Sample) -> impl IntoView {
    let workbench = Workbench::get();
    let loading = RwSignal::new(false);
    let (file, title) = (sample.file.clone(), sample.title.clone());
    let open = move |_| {
        let (file, title) = (file.clone(), title.clone());
        loading.set(true);
        spawn_local(async move {
            let fetched = files::fetch_blob(&format!("samples/{file}")).await;
            let _ = loading.try_set(false);
            match fetched {
                Ok(blob) => {
                    workbench.comes_by_address(false);
                    workbench.open(blob, title, Origin::File);
                }
                Err(cause) => workbench.fail(Problem::input(
                    format!("The sample \"{title}\" could not be fetched: {cause}."),
                    "Check the connection and click it again.",
                )),
            }
        });
    };
    view! {
        <button
            type="button"
            class="sample"
            data-testid=format!("sample-{}", sample.id)
            disabled=move || loading.get()
            on:click=open
        >
            <span class="sample-title">{sample.title}</span>
            <span class="sample-size">{sample.bytes.map(megabytes)}</span>
            <span class="sample-text">{sample.description}</span>
        </button>
    }
}
