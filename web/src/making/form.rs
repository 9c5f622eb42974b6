//! The form: a panel for each part, drawn from what the worker says of it, and a list of what is missing.

use std::collections::BTreeMap;
use std::sync::Arc;

use leptos::html;
use leptos::prelude::*;
use web_sys::File;

use super::state::Making;
use super::views::ViewList;
use super::{measure, save, taken_from};
use crate::files;
use crate::run::{Drafted, PartShown, QuestionShown};
use crate::state::Workbench;

/// The screen of a scan that is being made.
#[component]
pub(crate) fn MakingScreen() -> impl IntoView {
    let making = Workbench::get().making;
    let ids = Memo::new(move |_| {
        let parts = of_draft(making, |drafted| {
            let parts = drafted.parts.iter();
            parts
                .map(|part| (part.id.clone(), part.title.clone(), part.invitation.clone()))
                .collect()
        });
        parts.unwrap_or_else(Vec::new)
    });
    view! {
        <div class="making" data-testid="making">
            <div class="making-head">
                <h1>"Make a scan from pictures"</h1>
                <p>
                    "Drop or choose pictures with the laser on and off, the camera's calibration and the poses; \
                     answer what they leave open. Nothing is copied, and nothing leaves your machine."
                </p>
            </div>
            <div class="making-parts">
                <For each=move || ids.get() key=|(id, ..)| id.clone() let((id, title, invitation))>
                    <PartPanel id title invitation />
                </For>
            </div>
            <Missing />
        </div>
    }
}

pub(super) fn of_draft<T>(making: Making, what: impl FnOnce(&Arc<Drafted>) -> T) -> Option<T> {
    making.drafted.with(|drafted| drafted.as_ref().map(what))
}

/// One part of what the worker said last.
fn part_of<T: Default>(making: Making, id: &str, what: impl FnOnce(&PartShown) -> T) -> T {
    let found = of_draft(making, |drafted| {
        let part = drafted.parts.iter().find(|part| part.id == id);
        part.map(what)
    });
    found.flatten().unwrap_or_default()
}

#[component]
fn PartPanel(id: String, title: String, invitation: Option<String>) -> impl IntoView {
    let making = Workbench::get().making;
    let heading = format!("making-{id}");
    let labelled_by = heading.clone();
    let test_id = format!("part-{id}");
    let of_part = id.clone();
    let questions = Memo::new(move |_| part_of(making, &of_part, |part| part.questions.clone()));
    let of_part = id.clone();
    let found = Memo::new(move |_| part_of(making, &of_part, |part| part.found.clone()));
    let of_part = id.clone();
    let lacks = Memo::new(move |_| part_of(making, &of_part, |part| !part.gaps.is_empty()));
    let fields = move || {
        view! {
            <div class="making-fields">
                <For each=move || questions.get() key=|question| question.id.clone() let:question>
                    <Field question />
                </For>
            </div>
        }
    };
    let optional = invitation.is_some();
    let files = match id.as_str() {
        "pictures" => view! { <Pictures /> }.into_any(),
        "camera" => {
            let hint = "OpenCV (YAML, XML, JSON) or ROS camera_info (YAML)";
            view! { <OneFile name="calibration file" hint file=making.calibration /> }.into_any()
        }
        "poses" => {
            let hint = "CSV with named columns, TUM, rows of matrices, or a JSON list";
            view! { <OneFile name="poses file" hint file=making.poses /> }.into_any()
        }
        _ => ().into_any(),
    };
    view! {
        <section class="panel making-part" aria-labelledby=labelled_by data-testid=test_id>
            <h2 id=heading>
                {title}
                <span class="making-state" class:lacks=move || lacks.get()>
                    {move || if lacks.get() { "incomplete" } else if optional { "optional" } else { "complete" }}
                </span>
            </h2>
            {files} <p class="making-found">{move || found.get()}</p>
            {match invitation {
                Some(invitation) => {
                    view! {
                        <details>
                            <summary>{invitation}</summary>
                            {fields()}
                        </details>
                    }
                        .into_any()
                }
                None => fields().into_any(),
            }}
        </section>
    }
}

#[component]
fn Field(question: QuestionShown) -> impl IntoView {
    let making = Workbench::get().making;
    let QuestionShown {
        id,
        label,
        unit,
        meaning,
        initial,
        options,
        numbers,
    } = question;
    let name = format!("answer-{id}");
    let help = format!("help-{id}");
    let value = {
        let (id, initial) = (
            id.clone(),
            if options.is_empty() {
                String::new()
            } else {
                initial.clone()
            },
        );
        move || {
            making
                .answers
                .with(|answers| answers.get(&id).cloned().unwrap_or_else(|| initial.clone()))
        }
    };
    let answer = move |event| making.answer(id.clone(), event_target_value(&event));
    let described = help.clone();
    let field = if options.is_empty() {
        view! {
            <span class="number-field">
                <input
                    id=name.clone()
                    type="text"
                    data-testid=name.clone()
                    class:wide=move || numbers != 1
                    inputmode=(numbers == 1).then_some("decimal")
                    autocomplete="off"
                    placeholder=initial
                    aria-describedby=described
                    prop:value=value
                    on:input=answer
                />
                <span class="unit">{unit}</span>
            </span>
        }
        .into_any()
    } else {
        let chosen = value.clone();
        let option = move |(word, name): (String, String)| {
            let (own, chosen) = (word.clone(), chosen.clone());
            view! {
                <option value=word selected=move || chosen() == own>
                    {name}
                </option>
            }
        };
        view! {
            <select
                id=name.clone()
                data-testid=name.clone()
                aria-describedby=described
                prop:value=value
                on:change=answer
            >
                {options.into_iter().map(option).collect_view()}
            </select>
        }
        .into_any()
    };
    view! {
        <div class="making-field">
            <label for=name>{label}</label>
            {field}
            <p class="help" id=help>
                {meaning}
            </p>
        </div>
    }
}

/// A file to be chosen.
#[component]
fn OneFile(
    name: &'static str,
    hint: &'static str,
    file: RwSignal<Option<File>, LocalStorage>,
) -> impl IntoView {
    let making = Workbench::get().making;
    let input = NodeRef::<html::Input>::new();
    let id = name.split(' ').next().unwrap_or(name);
    let choose = move |_| {
        if let Some(arrived) = taken_from(input).pop() {
            file.set(Some(arrived.file));
            making.files_changed();
        }
    };
    let chosen =
        move || file.with(|file| file.as_ref().map_or_else(|| hint.to_owned(), File::name));
    view! {
        <div class="making-file">
            <button type="button" data-testid=format!("choose-{id}") on:click=move |_| files::click(input)>
                {format!("Choose the {name}")}
            </button>
            <input
                node_ref=input
                type="file"
                data-testid=format!("{id}-input")
                aria-label=name
                hidden
                on:change=choose
            />
            <span class="making-chosen">{chosen}</span>
        </div>
    }
}

/// The pictures, and how they go together.
#[component]
fn Pictures() -> impl IntoView {
    let making = Workbench::get().making;
    let (loose, folder) = (NodeRef::<html::Input>::new(), NodeRef::<html::Input>::new());
    let clear = move |_| {
        making.pictures.update(BTreeMap::clear);
        making.files_changed();
    };
    let count = move || making.pictures.with(BTreeMap::len);
    let unpaired = Memo::new(move |_| {
        of_draft(making, |drafted| drafted.unpaired.clone()).unwrap_or_default()
    });
    view! {
        <div class="making-file">
            <button type="button" data-testid="choose-pictures" on:click=move |_| files::click(loose)>
                "Choose pictures"
            </button>
            <input
                node_ref=loose
                type="file"
                multiple
                accept=".png,.tif,.tiff,.jpg,.jpeg,.webp,.bmp"
                data-testid="pictures-input"
                aria-label="Pictures"
                hidden
                on:change=move |_| making.take(taken_from(loose))
            />
            <button type="button" data-testid="choose-picture-folder" on:click=move |_| files::click(folder)>
                "Choose their folder"
            </button>
            <input
                node_ref=folder
                type="file"
                prop:webkitdirectory=true
                data-testid="picture-folder-input"
                aria-label="Folder with pictures"
                hidden
                on:change=move |_| making.take(taken_from(folder))
            />
            <span class="making-chosen" data-testid="picture-count">
                {move || match count() {
                    0 => "on and off told by the names: view01_on.png, view01_off.png; on/01.png, off/01.png".to_owned(),
                    1 => "1 picture".to_owned(),
                    many => format!("{many} pictures"),
                }}
            </span>
            <Show when=move || { count() > 0 }>
                <button type="button" class="quiet" data-testid="clear-pictures" on:click=clear>
                    "Take them out"
                </button>
            </Show>
        </div>
        <Show when=move || !unpaired.with(Vec::is_empty)>
            <details class="making-list" open data-testid="unpaired">
                <summary>"Without a partner"</summary>
                <ul>
                    {move || {
                        let line = |[picture, lack]: [String; 2]| {
                            view! {
                                <li>
                                    <code>{picture}</code>
                                    " "
                                    {lack}
                                </li>
                            }
                        };
                        unpaired.get().into_iter().map(line).collect_view()
                    }}
                </ul>
            </details>
        </Show>
        <ViewList />
    }
}

/// What is missing, and what can be done once nothing is.
#[component]
fn Missing() -> impl IntoView {
    let workbench = Workbench::get();
    let making = workbench.making;
    let gaps = Memo::new(move |_| {
        let gaps = of_draft(making, |drafted| {
            let parts = drafted.parts.iter();
            let of = |part: &PartShown| {
                let title = part.title.clone();
                let gaps = part.gaps.clone().into_iter();
                gaps.map(move |gap| (title.clone(), gap))
                    .collect::<Vec<_>>()
            };
            parts.flat_map(of).collect::<Vec<_>>()
        });
        gaps.unwrap_or_default()
    });
    let ready = move || of_draft(making, |drafted| drafted.ready).unwrap_or_default();
    let saving = move || making.saving.get();
    view! {
        <section class="panel making-missing" aria-labelledby="making-missing">
            <h2 id="making-missing">{move || if ready() { "Everything is there" } else { "What is missing" }}</h2>
            <div role="status" data-testid="missing">
                <ul>
                    {move || {
                        let line = |(title, gap): (String, String)| {
                            view! {
                                <li>
                                    <b>{title}</b>
                                    " "
                                    {gap}
                                </li>
                            }
                        };
                        gaps.get().into_iter().map(line).collect_view()
                    }}
                </ul>
            </div>
            <div class="making-actions">
                <button
                    type="button"
                    class="primary"
                    data-testid="measure-scan"
                    disabled=move || !ready()
                    on:click=move |_| measure(workbench)
                >
                    "Measure it"
                </button>
                <button
                    type="button"
                    data-testid="save-scan"
                    disabled=move || !ready() || saving().is_some()
                    on:click=move |_| save(workbench)
                >
                    {move || match saving() {
                        Some([done, files]) => format!("Packing {done} of {files}"),
                        None => "Save the archive".to_owned(),
                    }}
                </button>
                <button type="button" class="quiet" data-testid="leave-making" on:click=move |_| making.shown.set(false)>
                    "Back"
                </button>
            </div>
        </section>
    }
}
