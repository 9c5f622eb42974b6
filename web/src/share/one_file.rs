//! The one-file page: asked for with a title and notes, made of the viewer that lies beside the page.

use js_sys::Uint8Array;
use leptos::html;
use leptos::prelude::*;
use wasm_bindgen_futures::{JsFuture, spawn_local};

use crate::files::{fetch, save};
use crate::run::{PageWish, Problem};
use crate::state::Workbench;

/// What the file is called.
const FILE_NAME: &str = "reconstruction.html";

/// Title, notes, and the button.
#[component]
pub(super) fn PageMaker() -> impl IntoView {
    let workbench = Workbench::get();
    let title = NodeRef::<html::Input>::new();
    let notes = NodeRef::<html::Textarea>::new();
    let name = move || {
        let facts = workbench.facts.get();
        facts.map(|facts| facts.name.clone()).unwrap_or_default()
    };
    let make = move |_| {
        let title = title.get().map(|field| field.value()).unwrap_or_default();
        let notes = notes.get().map(|field| field.value()).unwrap_or_default();
        spawn_local(async move {
            if let Err(problem) = make(workbench, title, notes).await {
                workbench.fail(problem);
            }
        });
    };
    view! {
        <div class="pass-on one-file">
            <label>
                "Title"
                <input node_ref=title data-testid="page-title" maxlength="200" prop:value=name />
            </label>
            <label>
                "Notes"
                <textarea node_ref=notes data-testid="page-notes" rows="2"></textarea>
            </label>
            <button
                type="button"
                data-testid="download-page"
                title="A page that shows the reconstruction in 3-D, anywhere and without a network"
                disabled=move || workbench.outcome.with(Option::is_none)
                on:click=make
            >
                "One file (HTML)"
            </button>
        </div>
    }
}

async fn make(workbench: Workbench, title: String, notes: String) -> Result<(), Problem> {
    let (viewer, module) = viewer().await.map_err(|cause| {
        Problem::input(
            format!("The viewer that such pages are made of could not be fetched: {cause}."),
            "Check the connection and try again.",
        )
    })?;
    let wish = PageWish {
        viewer,
        module,
        title,
        notes,
    };
    let page = workbench.page(wish).await?;
    save(&page, FILE_NAME, "text/html")
        .map_err(|e| Problem::own(format!("The browser does not save: {e:?}")))
}

/// The viewer's page and its module.
async fn viewer() -> Result<(String, Uint8Array), String> {
    let broken = |_| "the connection broke off".to_owned();
    let text = fetch("viewer.html").await?.text().map_err(broken)?;
    let text = JsFuture::from(text).await.map_err(broken)?;
    let page = text.as_string().ok_or("it is no text")?;
    let bytes = fetch("viewer.wasm").await?.array_buffer().map_err(broken)?;
    let bytes = JsFuture::from(bytes).await.map_err(broken)?;
    Ok((page, Uint8Array::new(&bytes)))
}
