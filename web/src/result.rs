//! The result screen: scene, numbers, table and pictures of one measured scan.

use leptos::prelude::*;
use wasm_bindgen_futures::spawn_local;

use crate::pictures::Pictures;
use crate::plots::Plots;
use crate::run::sleep;
use crate::scene::Scene;
use crate::share::GuestNote;
use crate::stages::Stages;
use crate::state::Workbench;
use crate::strip::Strip;
use crate::table::ViewsTable;

/// Stages, scene, thumbnails, pictures, plots, table: in this order they come,
const PARTS: usize = 6;
/// with time between them for a frame, ms.
const FRAME: i32 = 20;

/// The result screen. Its parts come one after the other, each in a task of its own: all in one would keep the
/// page from whoever uses it.
#[component]
pub(crate) fn ResultScreen() -> impl IntoView {
    let workbench = Workbench::get();
    let has_pictures = Memo::new(move |_| workbench.guest.with(Option::is_none));
    let is_measured = Memo::new(move |_| workbench.outcome.with(Option::is_some));
    let come = RwSignal::new(0);
    spawn_local(async move {
        // The screen may be left before all have come.
        while come.try_get_untracked().is_some_and(|parts| parts < PARTS) {
            sleep(FRAME).await;
            come.try_update(|parts| *parts += 1);
        }
    });
    let has = move |part: usize| is_measured.get() && come.get() >= part;
    view! {
        <div
            class="result"
            class:waiting=move || !is_measured.get()
            aria-busy=move || (come.get() < PARTS).to_string()
        >
            <Show when=move || has(2)>
                <Scene />
            </Show>
            <div class="side">
                <GuestNote />
                <Show when=move || { come.get() > 0 }>
                    <Stages />
                </Show>
            </div>
            <Show when=move || has(3) && has_pictures.get()>
                <Strip />
            </Show>
            <Show when=move || has(4) && has_pictures.get()>
                <Pictures />
            </Show>
            <Show when=move || has(5)>
                <Plots />
            </Show>
            <Show when=move || has(6)>
                <ViewsTable />
            </Show>
        </div>
    }
}
