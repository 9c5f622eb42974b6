//! The link that carries a reconstruction.

use leptos::html;
use leptos::prelude::*;
use snellius::export::{Format, ReconstructionResult};
use snellius::share::{Link, LinkError, Rounding, encode};
use wasm_bindgen_futures::spawn_local;

use super::address::{page_address, write_to_clipboard};
use crate::run::Problem;
use crate::state::Workbench;

/// No link holds more points; their result is not even asked for.
const MOST_POINTS: usize = 20_000;

/// What came of the wish for a link.
#[derive(Clone)]
struct Made {
    /// The whole address, if there is one.
    address: Option<String>,
    /// What to know of it.
    said: String,
}

/// The button that makes a link and copies it, and what to know of it.
#[component]
pub(super) fn LinkMaker() -> impl IntoView {
    let workbench = Workbench::get();
    let made = RwSignal::new(None::<Made>);
    let field = NodeRef::<html::Input>::new();
    // A link is of what was shown when it was made.
    Effect::new(move |_| {
        workbench.outcome.track();
        made.set(None);
    });
    let copy = move |_| {
        spawn_local(async move {
            match make(workbench).await {
                Ok(new) => made.set(Some(new)),
                Err(problem) => workbench.fail(problem),
            }
        });
    };
    view! {
        <div class="pass-on">
            <button
                type="button"
                data-testid="copy-link"
                title="A link that holds the reconstruction itself: nothing is uploaded"
                disabled=move || workbench.outcome.with(Option::is_none)
                on:click=copy
            >
                "Copy link"
            </button>
            {move || {
                made.get()
                    .map(|Made { address, said }| {
                        view! {
                            {address
                                .map(|address| {
                                    view! {
                                        <input
                                            node_ref=field
                                            readonly
                                            class="link"
                                            data-testid="link"
                                            aria-label="The link"
                                            prop:value=address
                                            on:focus=move |_| {
                                                if let Some(field) = field.get() {
                                                    field.select();
                                                }
                                            }
                                        />
                                    }
                                })}
                            <p class="said" role="status" data-testid="link-said">
                                {said}
                            </p>
                        }
                    })
            }}
        </div>
    }
}

async fn make(workbench: Workbench) -> Result<Made, Problem> {
    let points = workbench
        .outcome
        .with_untracked(|outcome| outcome.as_ref().map_or(0, |outcome| outcome.object.len()));
    let link = if points > MOST_POINTS {
        Err(LinkError::TooLong)
    } else {
        let json = workbench.write(Format::Json).await?.to_vec();
        let result = ReconstructionResult::from_json(&json).map_err(own)?;
        encode(&workbench.shown_settings(), Some(&result))
    };
    match link {
        Ok(link) => Ok(copied(link).await),
        Err(LinkError::TooLong) => Ok(Made {
            address: None,
            said: format!("{points} points are too much for a link. Save one file instead, below."),
        }),
        Err(error) => Err(own(error)),
    }
}

async fn copied(link: Link) -> Made {
    let address = page_address(&link.fragment);
    let copied = match write_to_clipboard(&address).await {
        Some(()) => "Copied",
        None => "The browser forbids copying: take it from the field",
    };
    let rounding = link.rounding.map_or(String::new(), |rounding| {
        format!(
            " Its points are rounded by at most {} mm along each axis, less than their standard deviations.",
            largest(rounding)
        )
    });
    let warning = link
        .warning()
        .map_or(String::new(), |warning| format!(" Mind: {warning}."));
    Made {
        said: format!(
            "{copied}: {} characters, which hold the reconstruction itself.{rounding}{warning}",
            address.len()
        ),
        address: Some(address),
    }
}

/// By how much a point may be off along an axis, in words: two digits, not too small.
pub(super) fn largest(rounding: Rounding) -> String {
    const MOST_DIGITS: usize = 6;
    let largest = rounding.object.into_iter().fold(0.0, f64::max);
    let (mut unit, mut digits) = (1.0, 0);
    while largest < 10.0 * unit && digits < MOST_DIGITS {
        unit /= 10.0;
        digits += 1;
    }
    format!("{:.digits$}", (largest / unit).ceil() * unit)
}

fn own(error: impl ToString) -> Problem {
    Problem::own(error.to_string())
}
