//! The chosen view's pictures, with what was found in them drawn over.

use std::sync::Arc;

use leptos::html;
use leptos::prelude::*;
use snellius::export::SpotRole;
use wasm_bindgen::JsCast;
use web_sys::{CanvasRenderingContext2d, HtmlCanvasElement, ImageData, PointerEvent};

use crate::number::fixed;
use crate::run::{PictureSet, Spot};
use crate::state::Workbench;

/// The part of the pictures that is shown, px; the same in all three.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Window {
    left: f64,
    top: f64,
    width: f64,
    height: f64,
}

/// How the pictures are looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Look {
    /// How many times larger than the whole picture.
    zoom: f64,
    /// What is in the middle, px; the spots, unless it was dragged.
    centre: Option<[f64; 2]>,
}

/// More marks would be a colour over the picture.
const MOST_MARKS: usize = 300;
/// More lines nobody reads.
const MOST_LISTED: usize = 40;

/// A spot, and why it was refused.
#[derive(Clone, Debug, PartialEq)]
struct Found {
    pixel: [f64; 2],
    role: SpotRole,
    reason: Option<String>,
}

fn found(spots: &[Spot], reasons: &[(usize, String)]) -> Vec<Found> {
    let one = |spot: &Spot| Found {
        pixel: spot.pixel.map(f64::from),
        role: spot.role,
        reason: None,
    };
    let mut found: Vec<Found> = spots.iter().map(one).collect();
    for (index, reason) in reasons {
        found[*index].reason = Some(reason.clone());
    }
    found
}

const ZOOMS: [f64; 4] = [1.0, 2.0, 4.0, 8.0];

/// The pictures of the chosen view.
#[component]
pub(crate) fn Pictures() -> impl IntoView {
    let workbench = Workbench::get();
    let look = RwSignal::new(Look {
        zoom: 2.0,
        centre: None,
    });
    Effect::new(move |_| {
        workbench.chosen.track();
        look.update(|look| look.centre = None);
    });
    let spots = Memo::new(move |_| {
        let (chosen, outcome) = (workbench.chosen.get()?, workbench.outcome.get()?);
        let view = outcome.views.get(chosen)?;
        Some(Arc::new(found(&view.spots, &view.reasons)))
    });
    let spots = Signal::derive(move || spots.get().unwrap_or_default());
    let size = move || {
        workbench
            .facts
            .get()
            .map_or([1.0, 1.0], |f| f.picture.map(f64::from))
    };
    let window = Memo::new(move |_| window(size(), look.get(), &spots.get()));
    let id = move || {
        let chosen = workbench.chosen.get()?;
        Some(workbench.facts.get()?.stations.get(chosen)?.id.clone())
    };
    let pointed = RwSignal::new(None);
    Effect::new(move |_| {
        spots.track();
        pointed.set(None);
    });
    let show = Sheet {
        workbench,
        look,
        window,
        spots,
        pointed,
    };
    view! {
        <section class="pictures panel" aria-labelledby="pictures-title">
            <div class="panel-head">
                <h2 id="pictures-title">
                    {move || id().map_or("Pictures".to_owned(), |id| format!("Pictures of view {id}"))}
                </h2>
                <ZoomButtons look />
            </div>
            <Show
                when=move || workbench.chosen.get().is_some()
                fallback=|| view! { <p class="help">"Choose a view in the table or a point in the scene."</p> }
            >
                <div class="picture-row">
                    {picture(show, "Laser on", "picture-on", |set| Some(set.on.clone()))}
                    {picture(show, "Laser off", "picture-off", PictureSet::off)}
                    {picture(show, "Difference", "picture-difference", |set| Some(set.difference.clone()))}
                </div>
                <Key workbench />
                <SpotList spots pointed />
            </Show>
        </section>
    }
}

#[component]
fn ZoomButtons(look: RwSignal<Look>) -> impl IntoView {
    let button = move |zoom: f64| {
        view! {
            <button
                type="button"
                class="chip"
                aria-pressed=move || (look.get().zoom == zoom).to_string()
                on:click=move |_| look.update(|look| look.zoom = zoom)
            >
                {format!("{zoom}\u{d7}")}
            </button>
        }
    };
    view! {
        <div class="zooms" role="group" aria-label="Zoom, around the spots">
            {ZOOMS.map(button).collect_view()}
        </div>
    }
}

/// What the three pictures share.
#[derive(Clone, Copy)]
struct Sheet {
    workbench: Workbench,
    look: RwSignal<Look>,
    window: Memo<Window>,
    spots: Signal<Arc<Vec<Found>>>,
    /// The spot that is pointed at, in the picture or in the list.
    pointed: RwSignal<Option<usize>>,
}

fn picture(
    sheet: Sheet,
    title: &'static str,
    test_id: &'static str,
    of: fn(&PictureSet) -> Option<js_sys::Uint8ClampedArray>,
) -> impl IntoView {
    let canvas = NodeRef::<html::Canvas>::new();
    let missing = RwSignal::new(false);
    Effect::new(move |_| {
        let Some(canvas) = canvas.get() else { return };
        sheet.workbench.pictures.with(|set| {
            let Some(set) = set else { return };
            let pixels = of(set);
            missing.set(pixels.is_none());
            if let Some(pixels) = pixels {
                paint(&canvas, set, &pixels);
            }
        });
    });
    let size = move || {
        sheet
            .workbench
            .facts
            .get()
            .map_or([4, 3], |facts| facts.picture)
    };
    let ratio = move || {
        let [width, height] = size();
        format!("{width} / {height}")
    };
    view! {
        <figure>
            <figcaption>{title}</figcaption>
            <div
                class="picture"
                style:aspect-ratio=ratio
                on:pointerdown=hold
                on:pointermove=move |event| drag(sheet, &event)
            >
                <canvas
                    node_ref=canvas
                    data-testid=test_id
                    role="img"
                    aria-label=title
                    style:width=move || percent(f64::from(size()[0]) / sheet.window.get().width)
                    style:height=move || percent(f64::from(size()[1]) / sheet.window.get().height)
                    style:left=move || percent(-sheet.window.get().left / sheet.window.get().width)
                    style:top=move || percent(-sheet.window.get().top / sheet.window.get().height)
                ></canvas>
                <Overlay sheet />
                <Note sheet />
                <Show when=move || missing.get()>
                    <p class="missing">"Not taken"</p>
                </Show>
            </div>
        </figure>
    }
}

fn paint(canvas: &HtmlCanvasElement, set: &PictureSet, pixels: &js_sys::Uint8ClampedArray) {
    canvas.set_width(set.width);
    canvas.set_height(set.height);
    let context = canvas.get_context("2d").ok().flatten();
    let Some(context) = context.and_then(|c| c.dyn_into::<CanvasRenderingContext2d>().ok()) else {
        return;
    };
    if let Ok(image) = ImageData::new_with_js_u8_clamped_array_and_sh(pixels, set.width, set.height)
    {
        let _ = context.put_image_data(&image, 0.0, 0.0);
    }
}

/// Epipolar line and spots, in the picture's own pixels: `(0, 0)` is the middle of the top left one.
#[component]
fn Overlay(sheet: Sheet) -> impl IntoView {
    let view_box = move || {
        let Window {
            left,
            top,
            width,
            height,
        } = sheet.window.get();
        format!("{} {} {width} {height}", left - 0.5, top - 0.5)
    };
    let line = move || {
        let facts = sheet.workbench.facts.get();
        let line = facts
            .map(|facts| facts.epipolar_line.clone())
            .unwrap_or_default();
        line.iter()
            .map(|[u, v]| format!("{u:.2},{v:.2}"))
            .collect::<Vec<_>>()
            .join(" ")
    };
    view! {
        <svg class="overlay" viewBox=view_box preserveAspectRatio="none" aria-hidden="true">
            <polyline class="epipolar" points=line />
            {move || {
                let window = sheet.window.get();
                let spots = sheet.spots.get();
                let marks = spots.iter().enumerate().take(MOST_MARKS);
                marks.map(|(index, spot)| mark(index, spot, window, sheet.pointed)).collect_view()
            }}
        </svg>
    }
}

fn mark(
    index: usize,
    spot: &Found,
    window: Window,
    pointed: RwSignal<Option<usize>>,
) -> impl IntoView + use<> {
    let [u, v] = spot.pixel;
    // Marks keep their size whatever the zoom.
    let unit = window.width / 100.0;
    let r = 2.2 * unit;
    let (class, shape) = match spot.role {
        SpotRole::Vessel => (
            "spot vessel",
            format!("M{} {v}L{u} {}L{} {v}L{u} {}Z", u - r, v - r, u + r, v + r),
        ),
        SpotRole::Object => (
            "spot object",
            format!(
                "M{} {v}a{r} {r} 0 1 0 {} 0a{r} {r} 0 1 0 {} 0Z",
                u - r,
                2.0 * r,
                -2.0 * r
            ),
        ),
        SpotRole::Stray => (
            "spot stray",
            format!(
                "M{a} {c}L{b} {d}M{a} {d}L{b} {c}",
                a = u - 0.7 * r,
                b = u + 0.7 * r,
                c = v - 0.7 * r,
                d = v + 0.7 * r
            ),
        ),
    };
    let (anchor, x, y) = name_place(spot, r, window);
    view! {
        <g
            class=class
            class:pointed=move || pointed.get() == Some(index)
            on:pointerenter=move |_| pointed.set(Some(index))
            on:pointerleave=move |_| pointed.set(None)
        >
            <circle class="reach" cx=u cy=v r=2.0 * r />
            <path d=shape />
            <text x=x y=y text-anchor=anchor font-size=4.6 * unit>
                {role_name(spot.role)}
            </text>
        </g>
    }
}

/// What is to be said of the spot that is pointed at. It stands where the spot is not.
#[component]
fn Note(sheet: Sheet) -> impl IntoView {
    let note = move || {
        let spots = sheet.spots.get();
        let spot = spots.get(sheet.pointed.get()?)?.clone();
        let window = sheet.window.get();
        let below = spot.pixel[1] > window.top + window.height / 2.0;
        Some(view! {
            <p class="spot-note" class:above=below data-testid="spot-note">
                <strong>{role_name(spot.role)}</strong>
                {spot.reason.map(|reason| format!(": {reason}"))}
            </p>
        })
    };
    note
}

/// The wall's name stands to the left above its mark, the others' to the right below: the spots are often
/// close. At the picture's edge a name turns inwards.
fn name_place(spot: &Found, r: f64, window: Window) -> (&'static str, f64, f64) {
    const ROOM: f64 = 0.2;
    let [u, v] = spot.pixel;
    let across = (u - window.left) / window.width;
    let is_wall = spot.role == SpotRole::Vessel;
    let leftwards = if is_wall {
        across > ROOM
    } else {
        across > 1.0 - ROOM
    };
    let y = if is_wall { v - 1.1 * r } else { v + 2.4 * r };
    if leftwards {
        ("end", u - 0.9 * r, y)
    } else {
        ("start", u + 0.9 * r, y)
    }
}

const fn role_class(role: SpotRole) -> &'static str {
    match role {
        SpotRole::Vessel => "vessel",
        SpotRole::Object => "object",
        SpotRole::Stray => "stray",
    }
}

const fn role_name(role: SpotRole) -> &'static str {
    match role {
        SpotRole::Vessel => "wall",
        SpotRole::Object => "object",
        SpotRole::Stray => "stray",
    }
}

#[component]
fn Key(workbench: Workbench) -> impl IntoView {
    let limit = move || {
        workbench
            .pictures
            .with(|set| set.as_ref().map(|set| set.difference_limit))
    };
    view! {
        <p class="picture-key">
            <span class="line-key">"epipolar line: where the beam is seen in air"</span>
            <span class="difference-key">
                {move || limit().map(|limit| fixed(-limit, 0))}
                <span class="difference-ramp" aria-hidden="true"></span>
                {move || limit().map(|limit| format!("+{}", fixed(limit, 0)))}
                " grey values, square root"
            </span>
        </p>
    }
}

#[component]
fn SpotList(spots: Signal<Arc<Vec<Found>>>, pointed: RwSignal<Option<usize>>) -> impl IntoView {
    let item = move |(index, spot): (usize, &Found)| {
        let [u, v] = spot.pixel.map(|p| fixed(p, 2));
        let reason = spot.reason.clone().map(|reason| format!(": {reason}"));
        view! {
            <li
                tabindex="0"
                class=role_class(spot.role)
                class:pointed=move || pointed.get() == Some(index)
                on:pointerenter=move |_| pointed.set(Some(index))
                on:pointerleave=move |_| pointed.set(None)
                on:focus=move |_| pointed.set(Some(index))
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

/// The part of the picture to show: as much as the zoom leaves, around the spots, within the picture.
fn window([width, height]: [f64; 2], look: Look, spots: &[Found]) -> Window {
    let (shown_width, shown_height) = (width / look.zoom, height / look.zoom);
    let [u, v] = look
        .centre
        .or_else(|| middle(spots))
        .unwrap_or([width / 2.0, height / 2.0]);
    Window {
        left: (u - shown_width / 2.0).clamp(0.0, width - shown_width),
        top: (v - shown_height / 2.0).clamp(0.0, height - shown_height),
        width: shown_width,
        height: shown_height,
    }
}

/// The middle of the spots that matter.
fn middle(spots: &[Found]) -> Option<[f64; 2]> {
    let known: Vec<_> = spots
        .iter()
        .filter(|spot| spot.role != SpotRole::Stray)
        .collect();
    let count = known.len() as f64;
    let mean = |axis: usize| known.iter().map(|spot| spot.pixel[axis]).sum::<f64>() / count;
    (count > 0.0).then(|| [mean(0), mean(1)])
}

fn hold(event: PointerEvent) {
    if let Some(frame) = event.current_target() {
        let _ = frame
            .unchecked_into::<web_sys::Element>()
            .set_pointer_capture(event.pointer_id());
    }
}

/// Drags all three pictures along.
fn drag(sheet: Sheet, event: &PointerEvent) {
    let frame = event
        .current_target()
        .and_then(|t| t.dyn_into::<web_sys::Element>().ok());
    let Some(frame) = frame.filter(|_| event.buttons() & 1 == 1) else {
        return;
    };
    let window = sheet.window.get_untracked();
    let per_px = window.width / f64::from(frame.client_width().max(1));
    let centre = [
        window.left + window.width / 2.0 - f64::from(event.movement_x()) * per_px,
        window.top + window.height / 2.0 - f64::from(event.movement_y()) * per_px,
    ];
    sheet.look.update(|look| look.centre = Some(centre));
}

fn percent(part: f64) -> String {
    format!("{}%", part * 100.0)
}
