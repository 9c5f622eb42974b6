//! What of a session is not kept, told while there is time to save it.

use leptos::prelude::*;

use super::record::{Origin, Record, Unkept};
use crate::files;
use crate::number::megabytes;
use crate::run::Problem;
use crate::state::Workbench;

/// What is not kept, why, and what to do.
pub(super) fn words(what: Unkept, record: &Record) -> String {
    let archive = match record.origin {
        Origin::File => format!("\u{201c}{}\u{201d}", record.file_name),
        Origin::Folder => "what the folder holds".to_owned(),
        Origin::Pictures => "the pictures".to_owned(),
    };
    let bytes = megabytes(record.archive_bytes.unwrap_or_default());
    let sentence = match what {
        Unkept::LargeArchive => {
            format!("This browser keeps no copy of {archive}: {bytes} are too many.")
        }
        Unkept::Archive => format!(
            "No copy of {archive}, {bytes}, could be kept: the browser\u{2019}s storage has no room, or fails."
        ),
        Unkept::News => {
            return "The browser\u{2019}s storage has no room, fails, or is closed as in a private window: what \
                    you do from now on is not kept. The measurement goes on. Save its result before you close \
                    the page."
                .to_owned();
        }
    };
    let remedy = match record.origin {
        Origin::File => "the file.",
        Origin::Folder => "the folder.",
        Origin::Pictures => "the scan\u{2019}s archive. Save it now.",
    };
    format!("{sentence} All else is kept; to go on, the session will ask for {remedy}")
}

/// Says it, on any screen, until it is closed.
#[component]
pub(crate) fn NotKeptNote() -> impl IntoView {
    let workbench = Workbench::get();
    let save = move |_| {
        let Some(keeping) = workbench.keeping() else {
            return;
        };
        if files::save_blob(keeping.archive(), &keeping.record().file_name).is_err() {
            workbench.fail(Problem::own("The browser did not save the archive."));
        }
    };
    view! {
        <div
            class="not-kept"
            role="status"
            data-testid="not-kept"
            hidden=move || workbench.unkept.with(String::is_empty)
        >
            <p>{move || workbench.unkept.get()}</p>
            <button
                type="button"
                data-testid="save-unkept"
                hidden=move || !workbench.offers_archive.get()
                on:click=save
            >
                "Save the archive"
            </button>
            <button
                type="button"
                class="quiet"
                aria-label="Close this note"
                on:click=move |_| workbench.unkept.set(String::new())
            >
                "Close"
            </button>
        </div>
    }
}
