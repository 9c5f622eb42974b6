//! The list of a view's spots.

use leptos::prelude::*;
use snellius::export::SpotRole;

use super::{Found, Sheet};
use crate::number::fixed;

/// More lines nobody reads.
const MOST_LISTED: usize = 40;

/// The picture in which a spot of the list is told of.
const NOTED: &str = "picture-on";

/// The spots of the view, one a line.
#[component]
pub(super) fn SpotList(sheet: Sheet) -> impl IntoView {
    let (spots, pointed) = (sheet.spots, sheet.pointed);
    let item = move |(index, spot): (usize, &Found)| {
        let [u, v] = spot.pixel.map(|p| fixed(p, 2));
        let reason = spot.reason.clone().map(|reason| format!(": {reason}"));
        view! {
            <li
                tabindex="0"
                class=role_class(spot.role)
                class:pointed=move || sheet.points_at(index)
                on:pointerenter=move |_| pointed.set(Some((index, NOTED)))
                on:pointerleave=move |_| pointed.set(None)
                on:focus=move |_| pointed.set(Some((index, NOTED)))
                on:blur=move |_| pointed.set(None)
            >
                <strong>{role_name(spot.role)}</strong>
                " at "
                <span class="value">{format!("{u}, {v}")}</span>
                {reason}
            </li>
        }
    };
    let more = move || spots.with(|spots| spots.len()).saturating_sub(MOST_LISTED);
    view! {
        <ul class="spot-list" data-testid="spots" aria-label="Spots of this view, brightest first">
            {move || spots.get().iter().enumerate().take(MOST_LISTED).map(item).collect_view()}
        </ul>
        <Show when=move || more() != 0>
            <p class="help">{move || format!("and {} more", more())}</p>
        </Show>
    }
}

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
