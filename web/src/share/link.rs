//! The link that carries a reconstruction.

use leptos::html;
use leptos::prelude::*;
use wasm_bindgen_futures::spawn_local;

use super::address::{page_address, write_to_clipboard};
use crate::run::{LinkMade, Problem};
use crate::state::Workbench;

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
                            <p class="link-said" role="status" data-testid="link-said">
                                {said}
                            </p>
                        }
                    })
            }}
        </div>
    }
}

async fn make(workbench: Workbench) -> Result<Made, Problem> {
    let LinkMade {
        fragment,
        rounding,
        warning,
    } = workbench.link().await?;
    let Some(fragment) = fragment else {
        return Ok(Made {
            address: None,
            said: "This is too much for a link. Save one file instead, below.".to_owned(),
        });
    };
    let address = page_address(&fragment);
    let copied = match write_to_clipboard(&address).await {
        Some(()) => "Copied",
        None => "The browser forbids copying: take it from the field",
    };
    let warning = warning.map_or(String::new(), |warning| format!(" Mind: {warning}."));
    Ok(Made {
        said: format!(
            "{copied}: {} characters, which hold the reconstruction itself. Its points are rounded by at most \
             {} mm along each axis, less than their standard deviations.{warning}",
            address.len(),
            rounded_up(rounding)
        ),
        address: Some(address),
    })
}

/// A length in two digits, not too small.
pub(super) fn rounded_up(length: f64) -> String {
    const MOST_DIGITS: usize = 6;
    let (mut unit, mut digits) = (1.0, 0);
    while length < 10.0 * unit && digits < MOST_DIGITS {
        unit /= 10.0;
        digits += 1;
    }
    format!("{:.digits$}", (length / unit).ceil() * unit)
}
