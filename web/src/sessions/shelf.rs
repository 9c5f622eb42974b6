//! The sessions that were kept, on the start screen: go on, rename, save as a file, delete and take that back.

use js_sys::Date;
use leptos::prelude::*;
use leptos::{ev, html};
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::spawn_local;
use web_sys::{Blob, HtmlCanvasElement};

use super::record::{HowFar, Origin, Record};
use super::session::{self, Session};
use crate::files;
use crate::making::pack_chosen;
use crate::paint::paint_small;
use crate::run::{Problem, with_note};
use crate::state::Workbench;

/// A session on the shelf: its name among the sessions, and what is written down of it.
type Kept = (String, RwSignal<Record>);

/// The list. Sessions that were deleted before the page was opened are removed now.
#[component]
pub(crate) fn Shelf() -> impl IntoView {
    let kept = RwSignal::new(Vec::<Kept>::new());
    spawn_local(async move {
        // A browser that keeps nothing has an empty shelf.
        let sessions = session::kept().await.unwrap_or_default();
        let sessions = sessions
            .into_iter()
            .map(|(id, record)| (id, RwSignal::new(record)));
        let _ = kept.try_set(sessions.collect());
    });
    view! {
        <Show when=move || !kept.with(Vec::is_empty)>
            <section class="shelf" aria-labelledby="shelf-title" data-testid="sessions">
                <h2 id="shelf-title">"Go on where you were"</h2>
                <ul>
                    <For each=move || kept.get() key=|(id, _)| id.clone() let:kept>
                        <li>
                            <Row id=kept.0 record=kept.1 />
                        </li>
                    </For>
                </ul>
            </section>
        </Show>
    }
}

/// Removes for good what was deleted.
pub(crate) fn sweep() {
    spawn_local(async {
        for (id, record) in session::kept().await.unwrap_or_default() {
            if record.deleted {
                // It is tried again the next time.
                let _ = session::remove(&id).await;
            }
        }
    });
}

#[component]
fn Row(id: String, record: RwSignal<Record>) -> impl IntoView {
    let workbench = Workbench::get();
    let id = StoredValue::new(id);
    let renaming = RwSignal::new(false);
    let archive_again = NodeRef::<html::Input>::new();
    let folder_again = NodeRef::<html::Input>::new();
    let is_deleted = Memo::new(move |_| record.with(|record| record.deleted));
    let delete = move |deleted| {
        change(workbench, id.get_value(), record, move |record| {
            record.deleted = deleted;
        });
    };
    let body = move || {
        if is_deleted.get() {
            view! {
                <span class="kept-name">{move || format!("\u{201c}{}\u{201d} is deleted.", record.get().name)}</span>
                <button type="button" data-testid="undelete" on:click=move |_| delete(false)>
                    "Undo"
                </button>
            }
            .into_any()
        } else if renaming.get() {
            view! { <Rename id=id.get_value() record renaming /> }.into_any()
        } else {
            view! {
                <button type="button" class="kept-open" data-testid="go-on" on:click=move |_| go_on(workbench, id.get_value(), [archive_again, folder_again])>
                    <Picture id=id.get_value() record />
                    <span class="kept-name">{move || record.get().name}</span>
                    <span class="kept-facts">{move || facts(&record.get())}</span>
                </button>
                <button type="button" class="quiet" data-testid="rename" on:click=move |_| renaming.set(true)>
                    "Rename"
                </button>
                <button type="button" class="quiet" data-testid="save-session" on:click=move |_| save(workbench, id.get_value())>
                    "Save as a file"
                </button>
                <button type="button" class="quiet" data-testid="delete" on:click=move |_| delete(true)>
                    "Delete"
                </button>
            }
            .into_any()
        }
    };
    let chosen_again = move |_| {
        let file = archive_again.get().and_then(|input| input.files()?.get(0));
        if let Some(file) = file {
            let name = file.name();
            go_on_with(workbench, id.get_value(), file.into(), name);
        }
    };
    let folder_chosen_again = move |_| {
        // The shelf is gone by the time the folder is packed.
        let id = id.get_value();
        pack_chosen(workbench, folder_again, move |archive, name| {
            go_on_with(workbench, id, archive, name);
        });
    };
    view! {
        <div class="kept">{body}</div>
        <input
            node_ref=archive_again
            type="file"
            accept=".zip,application/zip"
            data-testid="archive-again"
            aria-label="The session's archive"
            hidden
            on:change=chosen_again
        />
        <input
            node_ref=folder_again
            type="file"
            prop:webkitdirectory=true
            data-testid="folder-again"
            aria-label="The session's folder"
            hidden
            on:change=folder_chosen_again
        />
    }
}

#[component]
fn Rename(id: String, record: RwSignal<Record>, renaming: RwSignal<bool>) -> impl IntoView {
    let workbench = Workbench::get();
    let input = NodeRef::<html::Input>::new();
    Effect::new(move |_| {
        if let Some(input) = input.get() {
            let _ = input.focus();
            input.select();
        }
    });
    let rename = move |event: ev::SubmitEvent| {
        event.prevent_default();
        let name = input.get().map(|input| input.value()).unwrap_or_default();
        if !name.trim().is_empty() {
            change(workbench, id.clone(), record, move |record| {
                name.trim().clone_into(&mut record.name);
            });
        }
        renaming.set(false);
    };
    view! {
        <form class="rename" on:submit=rename>
            <label>
                "Name "
                <input
                    node_ref=input
                    type="text"
                    maxlength="120"
                    data-testid="new-name"
                    value=record.get_untracked().name
                    on:keydown=move |event| {
                        if event.key() == "Escape" {
                            renaming.set(false);
                        }
                    }
                />
            </label>
            <button type="submit">"Rename"</button>
        </form>
    }
}

#[component]
fn Picture(id: String, record: RwSignal<Record>) -> impl IntoView {
    let canvas = NodeRef::<html::Canvas>::new();
    Effect::new(move |_| {
        let (Some(canvas), Some(size)) = (canvas.get(), record.get_untracked().picture) else {
            return;
        };
        let id = id.clone();
        spawn_local(async move {
            // A session without its picture is a whole session.
            let _ = draw(&id, size, &canvas).await;
        });
    });
    view! { <canvas node_ref=canvas class="kept-picture" width="0" height="0" aria-hidden="true"></canvas> }
}

async fn draw(id: &str, size: [u32; 2], canvas: &HtmlCanvasElement) -> Result<(), JsValue> {
    let picture = Session::open(id)
        .await?
        .picture(size)
        .await
        .ok_or("no picture")?;
    paint_small(canvas, &picture)
}

fn facts(record: &Record) -> String {
    let how_far = match record.progress {
        HowFar::Looking { views: 0, .. } => "not measured yet".to_owned(),
        HowFar::Looking { done, views } => format!("stopped at {done} of {views} views"),
        HowFar::Measured { points, views } => format!("{points} points from {views} views"),
        HowFar::Stopped { views } => format!("{views} views, no points yet"),
    };
    let archive = match (record.lacks_archive(), record.origin) {
        (false, _) => "",
        (true, Origin::File) => ", no copy of its archive is kept: it will be asked for",
        (true, Origin::Folder) => ", no copy of its folder is kept: it will be asked for",
        (true, Origin::Pictures) => {
            ", no copy of its pictures is kept: the archive saved of them will be asked for"
        }
    };
    let day = Date::new(&record.changed.into()).to_locale_string("default", &JsValue::UNDEFINED);
    format!("{how_far}, {}{archive}", String::from(day))
}

fn change(
    workbench: Workbench,
    id: String,
    record: RwSignal<Record>,
    change: impl FnOnce(&mut Record),
) {
    record.update(change);
    let record = record.get_untracked();
    spawn_local(async move {
        let written = async { Session::open(&id).await?.write(&record).await };
        if let Err(error) = written.await {
            workbench.fail(Problem::input(
                format!("The change was not kept: {}.", reason(&error)),
                "Make room in the browser's storage and try again.",
            ));
        }
    });
}

/// Goes on with a session; if no copy of its archive was kept, with the archive or the folder that is chosen
/// now.
fn go_on(
    workbench: Workbench,
    id: String,
    [archive_again, folder_again]: [NodeRef<html::Input>; 2],
) {
    spawn_local(async move {
        match kept(&id).await {
            Ok((session, record, Some(archive))) => {
                let found = session.found().await;
                workbench.comes_by_address(false);
                workbench.go_on(archive, record, found, Some(session));
            }
            Ok((_, record, None)) => files::click(match record.origin {
                Origin::File | Origin::Pictures => archive_again,
                Origin::Folder => folder_again,
            }),
            Err(problem) => workbench.fail(problem),
        }
    });
}

/// Goes on with a session and its archive, which was chosen again.
fn go_on_with(workbench: Workbench, id: String, archive: Blob, name: String) {
    spawn_local(async move {
        match kept(&id).await {
            Ok((session, record, _)) if record.is_of(&archive) => {
                let found = session.found().await;
                workbench.go_on(archive, record, found, Some(session));
            }
            Ok((_, record, _)) => workbench.fail(another(&name, &record)),
            Err(problem) => workbench.fail(problem),
        }
    });
}

/// What was chosen again is not the session's.
fn another(name: &str, record: &Record) -> Problem {
    let own = &record.file_name;
    let [what, remedy] = match record.origin {
        Origin::File => [
            "file",
            "Choose the file that the session was begun with, or open this one as a new scan.",
        ],
        Origin::Folder => [
            "folder",
            "Choose the folder that the session was begun with, as it was then.",
        ],
        Origin::Pictures => [
            "file",
            "Choose the archive that was saved of the session's pictures, or make the scan again of them.",
        ],
    };
    Problem::input(
        format!(
            "\u{201c}{name}\u{201d} is another {what} than the session's \u{201c}{own}\u{201d}: it is larger or \
             smaller."
        ),
        remedy,
    )
}

fn save(workbench: Workbench, id: String) {
    spawn_local(async move {
        if let Err(problem) = try_to_save(&id).await {
            workbench.fail(problem);
        }
    });
}

async fn try_to_save(id: &str) -> Result<(), Problem> {
    let (_, record, archive) = kept(id).await?;
    let archive = archive.ok_or_else(|| {
        Problem::input(
            format!(
                "The browser keeps no copy of \u{201c}{}\u{201d}, which the file would hold.",
                record.file_name
            ),
            match record.origin {
                Origin::File => {
                    "Keep the archive itself: the session goes on with it when it is chosen again."
                }
                Origin::Folder => {
                    "Keep the folder as it is: the session goes on with it when it is chosen again."
                }
                Origin::Pictures => {
                    "Keep the archive that was saved of the pictures: the session goes on with it when it is \
                     chosen. Who has none makes the scan again from the pictures."
                }
            },
        )
    })?;
    let note = record.to_text().unwrap_or_default();
    let whole = with_note(&archive, note).await?;
    files::save_blob(&whole, &format!("{}.snellius.zip", record.name))
        .map_err(|error| Problem::own(reason(&error)))
}

/// A session with all that is needed to go on; without the archive, if no copy of it was kept.
async fn kept(id: &str) -> Result<(Session, Record, Option<Blob>), Problem> {
    const AGAIN: &str = "Open the scan's archive again; other sessions are not touched.";
    let session = Session::open(id).await.map_err(|error| {
        Problem::input(
            format!("The session cannot be read: {}.", reason(&error)),
            AGAIN,
        )
    })?;
    let record = session.record().await;
    let record = record.ok_or_else(|| Problem::input("The session cannot be read.", AGAIN))?;
    let archive = session.archive().await.map(Into::into);
    Ok((session, record, archive))
}

fn reason(error: &JsValue) -> String {
    let message = js_sys::Reflect::get(error, &"message".into()).ok();
    let message = message.and_then(|message| message.as_string());
    message.unwrap_or_else(|| error.as_string().unwrap_or_default())
}
