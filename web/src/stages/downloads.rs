//! The files a result can be saved as: the same ones, byte for byte, that the companion program writes.

use leptos::prelude::*;
use wasm_bindgen_futures::spawn_local;

use crate::files::save;
use crate::run::{FileKind, Problem};
use crate::state::Workbench;

struct Download {
    kind: FileKind,
    name: &'static str,
    media_type: &'static str,
    test_id: &'static str,
    what: &'static str,
}

const DOWNLOADS: [Download; 4] = [
    Download {
        kind: FileKind::Result,
        name: "result.json",
        media_type: "application/json",
        test_id: "download-json",
        what: "everything",
    },
    Download {
        kind: FileKind::Object,
        name: "object.ply",
        media_type: "application/octet-stream",
        test_id: "download-object-ply",
        what: "object points",
    },
    Download {
        kind: FileKind::Vessel,
        name: "vessel.ply",
        media_type: "application/octet-stream",
        test_id: "download-vessel-ply",
        what: "wall points",
    },
    Download {
        kind: FileKind::Table,
        name: "points.csv",
        media_type: "text/csv",
        test_id: "download-csv",
        what: "table of views",
    },
];

/// A button a file.
#[component]
pub(super) fn Downloads() -> impl IntoView {
    view! {
        <div class="download-buttons" role="group" aria-label="Download">
            {DOWNLOADS.map(button).collect_view()}
        </div>
    }
}

fn button(download: Download) -> impl IntoView {
    let workbench = Workbench::get();
    let write = move |_| {
        spawn_local(async move {
            let written = workbench.write(download.kind).await.and_then(|text| {
                save(&text, download.name, download.media_type)
                    .map_err(|e| Problem::own(format!("The browser does not save: {e:?}")))
            });
            if let Err(problem) = written {
                workbench.fail(problem);
            }
        });
    };
    view! {
        <button
            type="button"
            class="download"
            data-testid=download.test_id
            disabled=move || workbench.outcome.with(Option::is_none)
            on:click=write
        >
            <span class="value">{download.name}</span>
            <span class="what">{download.what}</span>
        </button>
    }
}
