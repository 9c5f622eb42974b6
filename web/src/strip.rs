//! The strip of thumbnails: a view a picture. Only those that are seen are decoded.

use std::ops::Range;

use leptos::html;
use leptos::prelude::*;
use snellius::export::Status;
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::spawn_local;
use web_sys::{
    CanvasRenderingContext2d, Element, HtmlCanvasElement, HtmlElement, ImageData,
    IntersectionObserver, IntersectionObserverEntry, KeyboardEvent,
};

use crate::in_sight::{Sight, Way};
use crate::run::{Thumbnail, sleep};
use crate::state::Workbench;

/// From one thumbnail to the next, CSS px; `result.css` says the same.
const PITCH: i32 = 84;

/// The strip. Only thumbnails in sight are made.
#[component]
pub(crate) fn Strip() -> impl IntoView {
    let workbench = Workbench::get();
    let views = Memo::new(move |_| {
        let facts = workbench.facts.get();
        facts.map_or(0, |facts| facts.stations.len())
    });
    let sight = Sight::new(Way::Along, PITCH);
    let made = Memo::new(move |_| sight.parts(views.get()));
    let wanted = StoredValue::new(None::<usize>);
    Effect::new(move |_| {
        sight.frame.track();
        if let Some(chosen) = workbench.chosen.get() {
            sight.reveal(chosen, 0);
        }
    });
    let observer = StoredValue::new_local(Seen::new(workbench));
    view! {
        <div
            class="strip panel"
            role="listbox"
            aria-label="Views, as pictures"
            aria-orientation="horizontal"
            data-testid="strip"
            node_ref=sight.frame
            on:scroll=move |_| sight.look()
            on:keydown=move |event| {
                if let Some(view) = key(views.get_untracked(), &event) {
                    wanted.set_value(Some(view));
                    workbench.choose(Some(view));
                    focus(view);
                }
            }
        >
            <div
                class="strip-length"
                role="presentation"
                style:min-width=move || sight.length(views.get())
                style:padding-left=move || sight.length(made.get().start)
            >
                <For each=move || made.get() key=|view| *view let:view>
                    <Thumb view made wanted observer />
                </For>
            </div>
        </div>
    }
}

#[component]
fn Thumb(
    view: usize,
    /// The thumbnails that there are.
    made: Memo<Range<usize>>,
    /// The thumbnail of this view takes the focus when it is made.
    wanted: StoredValue<Option<usize>>,
    observer: StoredValue<Option<Seen>, LocalStorage>,
) -> impl IntoView {
    let workbench = Workbench::get();
    let canvas = NodeRef::<html::Canvas>::new();
    Effect::new(move |_| {
        if let Some(canvas) = canvas.get() {
            observer.with_value(|seen| seen.iter().for_each(|seen| seen.observer.observe(&canvas)));
        }
    });
    let element = NodeRef::<html::Div>::new();
    Effect::new(move |_| {
        if let Some(element) = element.get()
            && wanted.get_value() == Some(view)
        {
            wanted.set_value(None);
            let _ = element.focus();
        }
    });
    let facts = move || workbench.facts.get();
    let id = move || Some(facts()?.stations.get(view)?.id.clone());
    let count = move || facts().map(|facts| facts.stations.len().to_string());
    let status = move || {
        let outcome = workbench.outcome.get()?;
        Some(match outcome.views.get(view)?.status {
            Status::Ok => "ok",
            Status::NoVesselSpot | Status::NoObjectSpot => "lacking",
            Status::Rejected => "refused",
        })
    };
    let is_chosen = move || workbench.chosen.get() == Some(view);
    // Tab stops at the chosen one, or at the first that there is.
    let stop = move || {
        let made = made.get();
        let chosen = workbench.chosen.get();
        chosen
            .filter(|chosen| made.contains(chosen))
            .unwrap_or(made.start)
            == view
    };
    view! {
        <div
            node_ref=element
            id=thumb_id(view)
            class=move || format!("thumb {}", status().unwrap_or_default())
            role="option"
            data-view=view.to_string()
            aria-posinset=(view + 1).to_string()
            aria-setsize=count
            aria-selected=move || is_chosen().to_string()
            aria-label=move || format!("View {}", id().unwrap_or_default())
            tabindex=move || if stop() { "0" } else { "-1" }
            on:click=move |_| workbench.choose(Some(view))
        >
            <canvas node_ref=canvas data-view=view.to_string() aria-hidden="true"></canvas>
            <span class="thumb-name">
                <span class="dot" aria-hidden="true"></span>
                {id}
            </span>
        </div>
    }
}

/// Watches which thumbnails come into sight.
struct Seen {
    observer: IntersectionObserver,
    /// Kept as long as the observer may call it.
    _listener: Listener,
}

type Listener = Closure<dyn FnMut(js_sys::Array, IntersectionObserver)>;

impl Seen {
    /// `None` in a browser that cannot watch.
    fn new(workbench: Workbench) -> Option<Self> {
        let listener = Listener::new(move |entries: js_sys::Array, me: IntersectionObserver| {
            for entry in entries.iter() {
                let entry: IntersectionObserverEntry = entry.unchecked_into();
                if entry.is_intersecting() {
                    me.unobserve(&entry.target());
                    fetch(workbench, entry.target());
                }
            }
        });
        let observer = IntersectionObserver::new(listener.as_ref().unchecked_ref()).ok()?;
        Some(Self {
            observer,
            _listener: listener,
        })
    }
}

impl Drop for Seen {
    fn drop(&mut self) {
        self.observer.disconnect();
    }
}

fn fetch(workbench: Workbench, canvas: Element) {
    const REST: i32 = 60;
    let view = canvas
        .get_attribute("data-view")
        .and_then(|view| view.parse().ok());
    let Ok(canvas) = canvas.dyn_into::<HtmlCanvasElement>() else {
        return;
    };
    spawn_local(async move {
        // What only flits past is not decoded.
        sleep(REST).await;
        if !canvas.is_connected() {
            return;
        }
        // A picture that cannot be read says so where it is looked at.
        if let Some(view) = view
            && let Some(Ok(thumbnail)) = workbench.thumbnail(view).await
        {
            paint(&canvas, &thumbnail);
        }
    });
}

fn paint(canvas: &HtmlCanvasElement, thumbnail: &Thumbnail) {
    canvas.set_width(thumbnail.width);
    canvas.set_height(thumbnail.height);
    let context = canvas.get_context("2d").ok().flatten();
    let context = context.and_then(|c| c.dyn_into::<CanvasRenderingContext2d>().ok());
    let image = ImageData::new_with_js_u8_clamped_array_and_sh(
        &thumbnail.pixels,
        thumbnail.width,
        thumbnail.height,
    );
    if let (Some(context), Ok(image)) = (context, image) {
        let _ = context.put_image_data(&image, 0.0, 0.0);
    }
}

/// The view that Left, Right, Home or End leads to.
fn key(views: usize, event: &KeyboardEvent) -> Option<usize> {
    let thumb: Element = event.target()?.dyn_into().ok()?;
    let at: usize = thumb.get_attribute("data-view")?.parse().ok()?;
    let last = views.checked_sub(1)?;
    let to = match event.key().as_str() {
        "ArrowRight" => (at + 1).min(last),
        "ArrowLeft" => at.saturating_sub(1),
        "Home" => 0,
        "End" => last,
        "Enter" | " " => at,
        _ => return None,
    };
    event.prevent_default();
    Some(to)
}

/// A thumbnail that is not made yet takes the focus as soon as it is.
fn focus(view: usize) {
    if let Some(thumb) = thumb_element(view) {
        let _ = thumb.focus();
    }
}

fn thumb_id(view: usize) -> String {
    format!("thumb-{view}")
}

fn thumb_element(view: usize) -> Option<HtmlElement> {
    document()
        .get_element_by_id(&thumb_id(view))?
        .dyn_into()
        .ok()
}
