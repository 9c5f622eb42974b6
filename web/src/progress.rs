//! While a scan is measured: how far it is, how long it will take, and a way out.

use leptos::prelude::*;

use crate::number::duration;
use crate::run::Progress;
use crate::state::Workbench;

/// The screen of a run under way.
#[component]
pub(crate) fn RunningScreen() -> impl IntoView {
    let workbench = Workbench::get();
    let progress = move || workbench.progress.get().unwrap_or_default();
    // An archive that is being opened has no length yet.
    let value = move || {
        Some(progress())
            .filter(|p| p.views > 0)
            .map(|p| p.done.to_string())
    };
    view! {
        <section class="running panel" aria-labelledby="running-title">
            <h1 id="running-title">{move || if progress().views > 0 { "Measuring" } else { "Opening" }}</h1>
            <p class="file-name">{move || workbench.file_name.get()}</p>
            <progress
                data-testid="progress"
                aria-labelledby="running-title"
                max=move || progress().views.max(1).to_string()
                value=value
            ></progress>
            <p class="status" data-testid="status">
                {move || sentence(progress())}
            </p>
            <button type="button" data-testid="cancel" on:click=move |_| workbench.cancel()>
                "Cancel"
            </button>
        </section>
    }
}

fn sentence(progress: Progress) -> String {
    let Progress {
        done,
        at_hand,
        views,
        seconds,
    } = progress;
    if views == 0 {
        return "Opening the archive".to_owned();
    }
    if done == views {
        return format!("{views} of {views} views, now the vessel and the object");
    }
    let rate = (done - at_hand) as f64 / seconds;
    if done < at_hand + 2 || seconds < 0.3 {
        return format!("{done} of {views} views");
    }
    let left = (views - done) as f64 / rate;
    format!(
        "{done} of {views} views, {rate:.1} a second, {} left",
        duration(left)
    )
}
