//! The files a result can be saved as: the same ones, byte for byte, that the companion program writes.

use leptos::prelude::*;
use snellius::export::Format;
use wasm_bindgen_futures::spawn_local;

use crate::files::save;
use crate::run::Problem;
use crate::state::Workbench;

struct Download {
    format: Format,
    test_id: &'static str,
    what: &'static str,
}

const DOWNLOADS: [Download; 12] = [
    download(Format::Json, "download-json", "everything"),
    download(Format::Ply, "download-object-ply", "object points"),
    download(Format::VesselPly, "download-vessel-ply", "wall points"),
    download(Format::Csv, "download-csv", "table of views"),
    download(Format::ObjectCsv, "download-object-csv", "table of points"),
    download(Format::Pcd, "download-pcd", "object points"),
    download(Format::Las, "download-las", "object points"),
    download(Format::E57, "download-e57", "object points"),
    download(Format::Glb, "download-glb", "3-D scene"),
    download(Format::Stl, "download-stl", "object surface"),
    download(Format::Obj, "download-obj", "object surface"),
    download(Format::Html, "download-html", "to print"),
];

const fn download(format: Format, test_id: &'static str, what: &'static str) -> Download {
    Download {
        format,
        test_id,
        what,
    }
}

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
    let format = download.format;
    let write = move |_| {
        spawn_local(async move {
            let written = workbench.write(format).await.and_then(|bytes| {
                save(&bytes, format.file_name(), format.media_type())
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
            <span class="value">{format.file_name()}</span>
                <span class="what">{download.what}</span>
        </button>
    }
}
