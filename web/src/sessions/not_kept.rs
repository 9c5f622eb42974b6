//! What of a session is not kept, told while there is time to save it.

use leptos::prelude::*;
use web_sys::Blob;

use super::record::{Origin, Unkept};
use crate::files;
use crate::number::megabytes;
use crate::run::Problem;
use crate::state::Workbench;

/// What is not kept, and the archive that it is about.
#[derive(Clone)]
pub(crate) struct NotKept {
    pub(super) what: Unkept,
    pub(super) origin: Origin,
    pub(super) name: String,
    pub(super) archive: Blob,
}

impl NotKept {
    fn sentence(&self) -> String {
        let archive = match self.origin {
            Origin::File => format!("\u{201c}{}\u{201d}", self.name),
            Origin::Folder => "what the folder holds".to_owned(),
            Origin::Pictures => "the pictures".to_owned(),
        };
        let bytes = megabytes(self.archive.size());
        match self.what {
            Unkept::LargeArchive => {
                format!("This browser keeps no copy of {archive}: {bytes} are too many.")
            }
            Unkept::Archive => {
                format!(
                    "No copy of {archive}, {bytes}, could be kept: the browser\u{2019}s storage has no room, or fails."
                )
            }
            Unkept::News => {
                "The browser\u{2019}s storage has no room, fails, or is closed as in a private window: what you do \
                 from now on is not kept."
                    .to_owned()
            }
        }
    }

    fn remedy(&self) -> &'static str {
        match (self.what, self.origin) {
            (Unkept::News, _) => {
                "The measurement goes on. Save its result before you close the page."
            }
            (_, Origin::File) => "All else is kept; to go on, the session will ask for the file.",
            (_, Origin::Folder) => {
                "All else is kept; to go on, the session will ask for the folder."
            }
            (_, Origin::Pictures) => {
                "All else is kept; to go on, the session will ask for the scan\u{2019}s archive. Save it now."
            }
        }
    }
}

/// Says it, on any screen, until it is closed.
#[component]
pub(crate) fn NotKeptNote() -> impl IntoView {
    let workbench = Workbench::get();
    let save = move |archive: &Blob, name: &str| {
        if files::save_blob(archive, name).is_err() {
            workbench.fail(Problem::own("The browser did not save the archive."));
        }
    };
    let shown = move |unkept: NotKept| {
        let (sentence, remedy) = (unkept.sentence(), unkept.remedy());
        let to_save = (unkept.origin == Origin::Pictures).then_some((unkept.archive, unkept.name));
        view! {
            <div class="not-kept" role="status" data-testid="not-kept">
                <p>{sentence} " " {remedy}</p>
                {to_save
                    .map(|(archive, name)| {
                        view! {
                            <button type="button" data-testid="save-unkept" on:click=move |_| save(&archive, &name)>
                                "Save the archive"
                            </button>
                        }
                    })}
                <button
                    type="button"
                    class="quiet"
                    aria-label="Close this note"
                    on:click=move |_| workbench.unkept.set(None)
                >
                    "Close"
                </button>
            </div>
        }
    };
    move || workbench.unkept.get().map(shown)
}
