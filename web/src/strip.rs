//! The strip of thumbnails: a view a picture. Only those that are seen are decoded.

use leptos::html;
use leptos::prelude::*;
use snellius::export::Status;
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::spawn_local;
use web_sys::{
    CanvasRenderingContext2d, Element, HtmlCanvasElement, HtmlElement, ImageData,
    IntersectionObserver, IntersectionObserverEntry, KeyboardEvent,
};

use crate::run::Thumbnail;
use crate::state::Workbench;

/// The strip.
#[component]
pub(crate) fn Strip() -> impl IntoView {
    let workbench = Workbench::get();
    let strip = NodeRef::<html::Div>::new();
    let views = move || {
        let facts = workbench.facts.get();
        facts.map_or(0, |facts| facts.stations.len())
    };
    let seen = Seen::new(workbench);
    keep_chosen_in_sight(workbench, strip);
    let observer = StoredValue::new_local(seen);
    view! {
        <div
            class="strip panel"
            role="listbox"
            aria-label="Views, as pictures"
            aria-orientation="horizontal"
            data-testid="strip"
            node_ref=strip
            on:keydown=move |event| keys(workbench, &event)
        >
            <For each=move || 0..views() key=|view| *view let:view>
                <Thumb view observer />
            </For>
        </div>
    }
}

#[component]
fn Thumb(view: usize, observer: StoredValue<Option<Seen>, LocalStorage>) -> impl IntoView {
    let workbench = Workbench::get();
    let canvas = NodeRef::<html::Canvas>::new();
    Effect::new(move |_| {
        if let Some(canvas) = canvas.get() {
            observer.with_value(|seen| seen.iter().for_each(|seen| seen.observer.observe(&canvas)));
        }
    });
    let id = move || {
        let facts = workbench.facts.get()?;
        Some(facts.stations.get(view)?.id.clone())
    };
    let status = move || {
        let outcome = workbench.outcome.get()?;
        Some(match outcome.views.get(view)?.status {
            Status::Ok => "ok",
            Status::NoVesselSpot | Status::NoObjectSpot => "lacking",
            Status::Rejected => "refused",
        })
    };
    let is_chosen = move || workbench.chosen.get() == Some(view);
    let stop = move || workbench.chosen.get().unwrap_or_default() == view;
    view! {
        <div
            id=thumb_id(view)
            class=move || format!("thumb {}", status().unwrap_or_default())
            role="option"
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
    let view = canvas
        .get_attribute("data-view")
        .and_then(|view| view.parse().ok());
    let Ok(canvas) = canvas.dyn_into::<HtmlCanvasElement>() else {
        return;
    };
    spawn_local(async move {
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

/// Left, right, Home and End.
fn keys(workbench: Workbench, event: &KeyboardEvent) {
    let last = workbench
        .facts
        .with_untracked(|facts| facts.as_ref().map_or(0, |facts| facts.stations.len()))
        .saturating_sub(1);
    let at = workbench.chosen.get_untracked().unwrap_or_default();
    let to = match event.key().as_str() {
        "ArrowRight" => (at + 1).min(last),
        "ArrowLeft" => at.saturating_sub(1),
        "Home" => 0,
        "End" => last,
        "Enter" | " " => at,
        _ => return,
    };
    event.prevent_default();
    workbench.choose(Some(to));
    if let Some(thumb) = thumb_element(to) {
        let _ = thumb.focus();
    }
}

/// A view that is chosen elsewhere comes into sight here.
fn keep_chosen_in_sight(workbench: Workbench, strip: NodeRef<html::Div>) {
    Effect::new(move |_| {
        let chosen = workbench.chosen.get().and_then(thumb_element);
        let (Some(strip), Some(thumb)) = (strip.get(), chosen) else {
            return;
        };
        let (left, width) = (thumb.offset_left(), thumb.offset_width());
        let hidden =
            left < strip.scroll_left() || left + width > strip.scroll_left() + strip.client_width();
        if hidden {
            strip.set_scroll_left(left - (strip.client_width() - width) / 2);
        }
    });
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
