//! The result screen: scene, numbers, table and pictures of one measured scan.

use leptos::prelude::*;

use crate::pictures::Pictures;
use crate::plots::Plots;
use crate::scene::Scene;
use crate::share::GuestNote;
use crate::stages::Stages;
use crate::state::Workbench;
use crate::strip::Strip;
use crate::table::ViewsTable;

/// The result screen.
#[component]
pub(crate) fn ResultScreen() -> impl IntoView {
    let workbench = Workbench::get();
    let has_pictures = Memo::new(move |_| workbench.guest.with(Option::is_none));
    let is_measured = Memo::new(move |_| workbench.outcome.with(Option::is_some));
    view! {
        <div class="result" class:waiting=move || !is_measured.get()>
            <Show when=move || is_measured.get()>
                <Scene />
            </Show>
            <div class="side">
                <GuestNote />
                <Stages />
            </div>
            <Show when=move || is_measured.get()>
                <Show when=move || has_pictures.get()>
                    <Strip />
                    <Pictures />
                </Show>
                <Plots />
                <ViewsTable />
            </Show>
        </div>
    }
}
