//! The strip of thumbnails: a view a picture. Only those that are seen are decoded.

use leptos::html;
use leptos::prelude::*;
use snellius::export::Status;
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::spawn_local;
use web_sys::{Element, HtmlCanvasElement, HtmlElement, KeyboardEvent, ResizeObserver};

use crate::paint::paint_small;
use crate::run::sleep;
use crate::state::Workbench;

/// How far it is from one thumbnail to the next, and where the first is, px; the style sheet says so too.
const PITCH: i32 = 84;
const EDGE: i32 = 8;
/// As many thumbnails beyond either end are ready to be scrolled to.
const BEYOND: usize = 4;

/// The strip. Of thousands of views only the thumbnails in sight are there, and the chosen one.
#[component]
pub(crate) fn Strip() -> impl IntoView {
    let workbench = Workbench::get();
    let strip = NodeRef::<html::Div>::new();
    let views = Memo::new(move |_| {
        let facts = workbench.facts.get();
        facts.map_or(0, |facts| facts.stations.len())
    });
    let sight = RwSignal::new((0, 0));
    let look = move || {
        if let Some(strip) = strip.get_untracked() {
            sight.set((strip.scroll_left(), strip.client_width()));
        }
    };
    let resizes = StoredValue::new_local(Resizes::new(look));
    Effect::new(move |_| {
        if let Some(strip) = strip.get() {
            resizes.with_value(|resizes| resizes.iter().for_each(|r| r.watch(&strip)));
        }
    });
    keep_chosen_in_sight(workbench, strip);
    let there = Memo::new(move |_| there(sight.get(), views.get(), workbench.chosen.get()));
    view! {
        <div
            class="strip panel"
            role="listbox"
            aria-label="Views, as pictures"
            aria-orientation="horizontal"
            data-testid="strip"
            node_ref=strip
            on:scroll=move |_| look()
            on:keydown=move |event| keys(workbench, &event)
        >
            <div
                class="strip-whole"
                role="presentation"
                style:width=move || format!("{}px", PITCH * views.get() as i32)
            >
                <For each=move || there.get() key=|view| *view let:view>
                    <Thumb view views />
                </For>
            </div>
        </div>
    }
}

/// The thumbnails that are wanted: those in sight, and the one that Tab leads to.
fn there((left, width): (i32, i32), views: usize, chosen: Option<usize>) -> Vec<usize> {
    let at = |x: i32| ((x - EDGE).max(0) / PITCH) as usize;
    let from = at(left).saturating_sub(BEYOND);
    let to = (at(left + width) + 1 + BEYOND).min(views);
    let mut there: Vec<usize> = (from..to).collect();
    let stop = chosen.unwrap_or_default();
    if stop < views && !there.contains(&stop) {
        there.push(stop);
    }
    there
}

#[component]
fn Thumb(view: usize, views: Memo<usize>) -> impl IntoView {
    let workbench = Workbench::get();
    let canvas = NodeRef::<html::Canvas>::new();
    Effect::new(move |_| {
        if let Some(canvas) = canvas.get() {
            fetch(workbench, view, canvas);
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
            style:left=format!("{}px", PITCH * view as i32)
            role="option"
            aria-selected=move || is_chosen().to_string()
            aria-label=move || format!("View {}", id().unwrap_or_default())
            aria-posinset=(view + 1).to_string()
            aria-setsize=move || views.get().to_string()
            tabindex=move || if stop() { "0" } else { "-1" }
            on:click=move |_| workbench.choose(Some(view))
        >
            <canvas node_ref=canvas aria-hidden="true"></canvas>
            <span class="thumb-name">
                <span class="dot" aria-hidden="true"></span>
                {id}
            </span>
        </div>
    }
}

/// Tells when the strip is wider or narrower than before.
struct Resizes {
    observer: ResizeObserver,
    /// Kept as long as the observer may call it.
    _listener: Closure<dyn FnMut()>,
}

impl Resizes {
    /// `None` in a browser that cannot tell.
    fn new(then: impl FnMut() + 'static) -> Option<Self> {
        let listener = Closure::<dyn FnMut()>::new(then);
        let observer = ResizeObserver::new(listener.as_ref().unchecked_ref()).ok()?;
        Some(Self {
            observer,
            _listener: listener,
        })
    }

    fn watch(&self, strip: &Element) {
        self.observer.observe(strip);
    }
}

impl Drop for Resizes {
    fn drop(&mut self) {
        self.observer.disconnect();
    }
}

/// Fetches what a thumbnail shows, unless it is only scrolled past.
fn fetch(workbench: Workbench, view: usize, canvas: HtmlCanvasElement) {
    const PASSING: i32 = 60;
    spawn_local(async move {
        sleep(PASSING).await;
        // A picture that cannot be read says so where it is looked at.
        if canvas.is_connected()
            && let Some(Ok(thumbnail)) = workbench.thumbnail(view).await
        {
            // A canvas that shows nothing says enough.
            let _ = paint_small(&canvas, &thumbnail);
        }
    });
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
    // By the next frame the strip shows it.
    request_animation_frame(move || {
        if let Some(thumb) = thumb_element(to) {
            let _ = thumb.focus();
        }
    });
}

/// A view that is chosen elsewhere comes into sight here.
fn keep_chosen_in_sight(workbench: Workbench, strip: NodeRef<html::Div>) {
    Effect::new(move |_| {
        let (Some(strip), Some(chosen)) = (strip.get(), workbench.chosen.get()) else {
            return;
        };
        let (left, width) = (EDGE + PITCH * chosen as i32, PITCH);
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
