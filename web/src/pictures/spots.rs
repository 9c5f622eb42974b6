//! The list of a view's spots.

use leptos::prelude::*;
use snellius::export::SpotRole;

use wasm_bindgen::JsCast;
use web_sys::HtmlElement;

use super::Sheet;
use crate::number::fixed;

/// More lines nobody reads.
const MOST_LISTED: usize = 40;

/// The picture in which a spot of the list is told of.
const NOTED: &str = "picture-on";

/// The spots of the view, one a line. A line stays where it is when what it says changes, and keeps the
/// focus.
#[component]
pub(super) fn SpotList(sheet: Sheet) -> impl IntoView {
    view! {
        <Show when=move || sheet.is_of_line() fallback=move || view! { <Spots sheet /> }>
            <LineCounts sheet />
        </Show>
    }
}

/// How many points of a line are what: nobody reads them one by one.
#[component]
fn LineCounts(sheet: Sheet) -> impl IntoView {
    let counted = move || {
        let spots = sheet.spots.get();
        let count = |role| spots.iter().filter(|spot| spot.role == role).count();
        let [wall, object, stray] = ROLES.map(count);
        format!("Points of the line: {wall} on the wall, {object} on the object, {stray} stray")
    };
    view! {
        <p class="help" data-testid="spots">
            {counted}
        </p>
        <Show
            when=move || sheet.marked.get().is_some()
            fallback=|| {
                view! {
                    <p class="help">
                        "Click a place of the line, or press Enter at a pixel, to say what is there."
                    </p>
                }
            }
        >
            <SayAround sheet />
        </Show>
    }
}

/// Says what the points about the marked pixel are.
#[component]
fn SayAround(sheet: Sheet) -> impl IntoView {
    let count = move || {
        let Some([u, v]) = sheet.marked.get() else {
            return 0;
        };
        let reach = sheet.reach.get();
        let near = |spot: &&super::Found| {
            let [du, dv] = [spot.pixel[0] - u as f64, spot.pixel[1] - v as f64];
            (du * du + dv * dv).sqrt() <= reach
        };
        sheet.spots.with(|spots| spots.iter().filter(near).count())
    };
    let say = move |role: Option<SpotRole>| {
        let workbench = sheet.workbench;
        let chosen = workbench.chosen.get_untracked();
        if let (Some(view), Some(pixel)) = (chosen, sheet.marked.get_untracked()) {
            let pixel = pixel.map(|at| at as f64);
            workbench.say_within(view, pixel, sheet.reach.get_untracked(), role);
        }
    };
    let button = move |role: SpotRole| {
        view! {
            <button
                type="button"
                class="chip"
                data-testid=format!("say-{}", role_class(role))
                on:click=move |_| say(Some(role))
            >
                {role_name(role)}
            </button>
        }
    };
    let reached = move |event| {
        if let Ok(reach) = event_target_value(&event).parse() {
            sheet.reach.set(reach);
        }
    };
    view! {
        <div class="say-around" role="group" aria-label="What is about the marked pixel">
            <label class="field">
                <span>{move || format!("{} points within {} px are", count(), sheet.reach.get())}</span>
                <input
                    type="range"
                    min="1"
                    max="100"
                    data-testid="say-reach"
                    prop:value=move || sheet.reach.get().to_string()
                    on:input=reached
                />
            </label>
            {ROLES.map(button).collect_view()}
            <button type="button" class="chip" data-testid="say-nothing" on:click=move |_| say(None)>
                "as found"
            </button>
        </div>
    }
}

#[component]
fn Spots(sheet: Sheet) -> impl IntoView {
    let count = Memo::new(move |_| sheet.spots.with(|spots| spots.len()));
    let lines = move || 0..count.get().min(MOST_LISTED);
    let more = move || count.get().saturating_sub(MOST_LISTED);
    view! {
        <ul class="spot-list" data-testid="spots" aria-label="Spots of this view, brightest first">
            <For each=lines key=|index| *index let:index>
                <SpotLine sheet index />
            </For>
        </ul>
        <Show when=move || more() != 0>
            <p class="help">{move || format!("and {} more", more())}</p>
        </Show>
    }
}

#[component]
fn SpotLine(sheet: Sheet, index: usize) -> impl IntoView {
    let spot = Memo::new(move |_| sheet.spots.with(|spots| spots.get(index).cloned()));
    let point = move || sheet.pointed.set(Some((index, NOTED)));
    let leave = move || sheet.pointed.set(None);
    let place = move || {
        let [u, v] = spot.get()?.pixel.map(|p| fixed(p, 2));
        Some(format!("{u}, {v}"))
    };
    let said = move || {
        let (view, spot) = (sheet.workbench.chosen.get()?, spot.get()?);
        sheet.workbench.said_of(view, spot.pixel)
    };
    let say = move |role: Option<SpotRole>| {
        let chosen = sheet.workbench.chosen.get_untracked();
        if let (Some(view), Some(spot)) = (chosen, spot.get_untracked()) {
            sheet.workbench.say(view, spot.pixel, role);
        }
    };
    let choose = move |event| {
        let word = event_target_value(&event);
        say(ROLES.into_iter().find(|role| role_class(*role) == word));
    };
    let option = move |role: SpotRole| {
        view! {
            <option value=role_class(role) selected=move || spot.get().is_some_and(|s| s.role == role)>
                {role_name(role)}
            </option>
        }
    };
    view! {
        <li
            class:pointed=move || sheet.points_at(index)
            on:pointerenter=move |_| point()
            on:pointerleave=move |_| leave()
            on:focusin=move |_| point()
            on:focusout=move |_| leave()
        >
            <select
                id=role_id(index)
                data-testid=format!("role-{index}")
                aria-label=move || format!("What the spot at {} is", place().unwrap_or_default())
                prop:value=move || spot.get().map(|spot| role_class(spot.role))
                on:change=choose
            >
                {ROLES.map(option).collect_view()}
            </select>
            <span class="value">{place}</span>
            <span class="spot-reason">
                {move || {
                    if said().is_some() { Some("as you say".to_owned()) } else { spot.get()?.reason }
                }}
            </span>
            <Show when=move || said().is_some()>
                <button
                    type="button"
                    class="reset"
                    aria-label="Leave it to the program"
                    title="Leave it to the program"
                    on:click=move |_| say(None)
                >
                    "\u{21ba}"
                </button>
            </Show>
        </li>
    }
}

/// Brings the focus to where a spot's role is chosen.
pub(super) fn focus_role(index: usize) {
    let select = document().get_element_by_id(&role_id(index));
    if let Some(select) = select.and_then(|select| select.dyn_into::<HtmlElement>().ok()) {
        let _ = select.focus();
    }
}

fn role_id(index: usize) -> String {
    format!("spot-role-{index}")
}

const ROLES: [SpotRole; 3] = [SpotRole::Vessel, SpotRole::Object, SpotRole::Stray];

pub(super) const fn role_class(role: SpotRole) -> &'static str {
    match role {
        SpotRole::Vessel => "vessel",
        SpotRole::Object => "object",
        SpotRole::Stray => "stray",
    }
}

pub(super) const fn role_name(role: SpotRole) -> &'static str {
    match role {
        SpotRole::Vessel => "wall",
        SpotRole::Object => "object",
        SpotRole::Stray => "stray",
    }
}
