//! The views that the pictures make, each with its pair of pictures, small, and with what is behind the wall.

use std::ops::Range;

use leptos::html;
use leptos::prelude::*;
use snellius::compose::ViewNumbers;
use wasm_bindgen_futures::spawn_local;
use web_sys::{HtmlCanvasElement, MouseEvent};

use super::form::of_draft;
use super::state::Making;
use crate::in_sight::{Sight, letter};
use crate::paint::paint_small;
use crate::run::{ViewShown, sleep};
use crate::state::Workbench;

/// How high a row is, in the page's letters; `making.css` says the same.
const ROW: f64 = 4.0;

/// The list. Only rows in sight are asked for and made, and only their pictures decoded.
#[component]
pub(super) fn ViewList() -> impl IntoView {
    let making = Workbench::get().making;
    let count =
        Memo::new(move |_| of_draft(making, |drafted| drafted.view_count).unwrap_or_default());
    let sight = Sight::new((ROW * letter()).round() as i32);
    let made = Memo::new(move |_| match sight.is_open() {
        true => sight.parts(count.get()),
        false => 0..0,
    });
    let rows = RwSignal::new(Vec::new());
    Effect::new(move |_| {
        making.drafted.track();
        let made = made.get();
        if !made.is_empty() {
            ask(making, made, rows);
        }
    });
    let last = StoredValue::new(None::<usize>);
    view! {
        <details
            class="making-list"
            data-testid="pairs"
            hidden=move || count.get() == 0
            on:toggle=move |_| sight.look()
        >
            <summary>"The pairs"</summary>
            <div
                class="making-pairs"
                tabindex="0"
                role="region"
                aria-label="Pairs of pictures"
                node_ref=sight.frame
                on:scroll=move |_| sight.look()
            >
                <div
                    style:min-height=move || sight.length(count.get())
                    style:padding-top=move || sight.length(made.get().start)
                >
                    <table class:asks-air=move || asks_air(making).is_some()>
                        <thead>
                            <tr>
                                <th scope="col" class="number">"No."</th>
                                <th scope="col">"Laser on"</th>
                                <th scope="col">"Laser off"</th>
                                <th scope="col" class="air">"In air"</th>
                            </tr>
                        </thead>
                        <tbody>
                            <For each=move || rows.get() key=Clone::clone let((number, view))>
                                {row(making, number, view, last)}
                            </For>
                        </tbody>
                    </table>
                </div>
            </div>
        </details>
    }
}

/// Asks for the views of some rows. A worker that gives none says why at the next answer.
fn ask(making: Making, made: Range<usize>, rows: RwSignal<Vec<(usize, ViewShown)>>) {
    spawn_local(async move {
        if let Ok(views) = making.views(made.clone()).await {
            // The form may have been left by now.
            let _ = rows.try_set(made.zip(views).collect());
        }
    });
}

fn row(
    making: Making,
    number: usize,
    view: ViewShown,
    last: StoredValue<Option<usize>>,
) -> impl IntoView {
    let (on, off) = (
        NodeRef::<html::Canvas>::new(),
        NodeRef::<html::Canvas>::new(),
    );
    let name = view.id.clone();
    let (on_name, off_name) = (view.on.clone(), view.off.clone());
    Effect::new(move |_| {
        if let Some(on) = on.get() {
            fetch(making, view.clone(), on, off.get());
        }
    });
    let in_air = move || numbers(making).is_ok_and(|numbers| numbers.has(number));
    let choose = move |event: MouseEvent| {
        let before = last.get_value().filter(|_| event.shift_key());
        last.set_value(Some(number));
        set_air(making, before.unwrap_or(number), number, !in_air());
    };
    let picture = |canvas, name: Option<String>| {
        view! {
            <td>
                <div class="making-picture">
                    <canvas node_ref=canvas width="0" height="0" aria-hidden="true"></canvas>
                    <span>{name.unwrap_or_else(|| "none".to_owned())}</span>
                </div>
            </td>
        }
    };
    view! {
        <tr>
            <th scope="row" class="number">{number + 1}</th>
            {picture(on, Some(on_name))}
            {picture(off, off_name)}
            <td class="air">
                <input
                    type="checkbox"
                    data-testid=format!("air-{}", number + 1)
                    aria-label=format!("View {}, {name}, is in air", number + 1)
                    title="With Shift, all from the one before up to here"
                    prop:checked=in_air
                    disabled=move || numbers(making).is_err()
                    on:click=choose
                />
            </td>
        </tr>
    }
}

/// Fetches what a row shows, unless it is only scrolled past.
fn fetch(making: Making, view: ViewShown, on: HtmlCanvasElement, off: Option<HtmlCanvasElement>) {
    const PASSING: i32 = 60;
    spawn_local(async move {
        sleep(PASSING).await;
        if !on.is_connected() {
            return;
        }
        // A picture that cannot be read says so when the scan is measured.
        if let Ok((small_on, small_off)) = making.thumbnails(view).await {
            let _ = paint_small(&on, &small_on);
            if let Some((off, small)) = off.zip(small_off) {
                let _ = paint_small(&off, &small);
            }
        }
    });
}

/// The question that takes the views in air, where the poses leave open what is behind the wall.
fn asks_air(making: Making) -> Option<String> {
    of_draft(making, |drafted| drafted.asks_air.clone()).flatten()
}

/// The views in air, as they were typed.
fn numbers(making: Making) -> Result<ViewNumbers, String> {
    let all = of_draft(making, |drafted| drafted.view_count).unwrap_or_default();
    let question = asks_air(making).unwrap_or_default();
    making.answers.with(|answers| {
        let typed = answers.get(&question).map(String::as_str);
        ViewNumbers::read(typed.unwrap_or_default(), all)
    })
}

/// Types views, from one to another, in or out of air.
fn set_air(making: Making, one: usize, other: usize, in_air: bool) {
    let (Some(question), Ok(mut numbers)) = (asks_air(making), numbers(making)) else {
        return;
    };
    for number in one.min(other)..=one.max(other) {
        numbers.set(number, in_air);
    }
    making.answer(question, numbers.to_string());
}
