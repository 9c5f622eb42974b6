//! One of the pictures in its frame, and the hands on it.

use leptos::html;
use leptos::prelude::*;
use wasm_bindgen::JsCast;
use web_sys::{Element, KeyboardEvent, PointerEvent, WheelEvent};

use super::Sheet;
use super::overlay::{Note, Overlay};
use crate::paint::paint;
use crate::run::PictureSet;

pub(super) fn frame(
    sheet: Sheet,
    title: &'static str,
    test_id: &'static str,
    of: fn(&PictureSet) -> Option<js_sys::Uint8ClampedArray>,
) -> impl IntoView {
    let canvas = NodeRef::<html::Canvas>::new();
    let missing = RwSignal::new(false);
    // Where a pointer went down: one that has moved since has dragged.
    let held = StoredValue::new(None::<[i32; 2]>);
    Effect::new(move |_| {
        let Some(canvas) = canvas.get() else { return };
        sheet.workbench.pictures.with(|set| {
            let Some(set) = set else { return };
            let pixels = of(set);
            missing.set(pixels.is_none());
            if let Some(pixels) = pixels {
                // A frame that shows nothing says enough.
                let _ = paint(&canvas, [set.width, set.height], &pixels);
            }
        });
    });
    let size = move || {
        let facts = sheet.workbench.facts.get();
        facts.map_or([4, 3], |facts| facts.picture)
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
                tabindex="0"
                role="application"
                aria-label=format!(
                    "{title}: arrow keys go from pixel to pixel, plus and minus zoom",
                )
                data-testid=format!("{test_id}-frame")
                style:aspect-ratio=ratio
                on:pointerdown=move |event| {
                    held.set_value(Some([event.client_x(), event.client_y()]));
                    hold(event);
                }
                on:pointermove=move |event| {
                    drag(sheet, &event);
                    sheet.pixel.set(Some(pixel_at(sheet, &event)));
                }
                on:pointerleave=move |_| sheet.pixel.set(None)
                on:click=move |event| {
                    let moved = held.get_value() != Some([event.client_x(), event.client_y()]);
                    if !moved {
                        sheet.mark();
                    }
                }
                on:wheel=move |event| wheel(sheet, &event)
                on:keydown=move |event| keys(sheet, &event)
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
                <Overlay sheet of_picture=test_id />
                <Note sheet of_picture=test_id />
                <Show when=move || missing.get()>
                    <p class="missing">"Not taken"</p>
                </Show>
            </div>
        </figure>
    }
}

/// A drag may leave the frame. A spot's mark hears its own click.
fn hold(event: PointerEvent) {
    let target = event.target().and_then(|t| t.dyn_into::<Element>().ok());
    let on_mark = target.and_then(|t| t.closest(".spot").ok().flatten());
    if on_mark.is_some() {
        return;
    }
    if let Some(frame) = event.current_target() {
        let _ = frame
            .unchecked_into::<Element>()
            .set_pointer_capture(event.pointer_id());
    }
}

/// Drags all three pictures along.
fn drag(sheet: Sheet, event: &PointerEvent) {
    let Some(frame) = frame_of(event).filter(|_| event.buttons() & 1 == 1) else {
        return;
    };
    let window = sheet.window.get_untracked();
    let per_px = window.width / f64::from(frame.client_width().max(1));
    let moved = [event.movement_x(), event.movement_y()].map(|px| -f64::from(px) * per_px);
    sheet.look.update(|look| look.shift(window, moved));
}

fn wheel(sheet: Sheet, event: &WheelEvent) {
    /// A usual notch of the wheel zooms by about a third.
    const PER_PX: f64 = 0.003;
    event.prevent_default();
    let unit = [1.0, 30.0, 300.0][event.delta_mode().min(2) as usize];
    let turned = (event.delta_y() * unit).clamp(-300.0, 300.0);
    let (window, at) = (sheet.window.get_untracked(), share(event));
    let factor = js_sys::Math::exp(-turned * PER_PX);
    sheet.look.update(|look| look.zoom(factor, window, at));
}

/// From pixel to pixel (with Shift ten at a time), nearer and farther; the picture follows.
fn keys(sheet: Sheet, event: &KeyboardEvent) {
    const FACTOR: f64 = 2.0;
    let step = if event.shift_key() { 10 } else { 1 };
    let (du, dv) = match event.key().as_str() {
        "ArrowLeft" => (-step, 0),
        "ArrowRight" => (step, 0),
        "ArrowUp" => (0, -step),
        "ArrowDown" => (0, step),
        "+" | "=" => return zoom_about_pixel(sheet, FACTOR),
        "-" => return zoom_about_pixel(sheet, 1.0 / FACTOR),
        "Enter" => return sheet.mark(),
        _ => return,
    };
    event.prevent_default();
    let facts = sheet.workbench.facts.get_untracked();
    let [width, height] = facts.map_or([1, 1], |facts| facts.picture.map(|px| px as usize));
    let [u, v] = pixel_or_middle(sheet);
    let pixel = [
        u.saturating_add_signed(du).min(width - 1),
        v.saturating_add_signed(dv).min(height - 1),
    ];
    sheet.pixel.set(Some(pixel));
    sheet
        .look
        .update(|look| look.centre = Some(centre_of(pixel)));
}

fn zoom_about_pixel(sheet: Sheet, factor: f64) {
    let pixel = pixel_or_middle(sheet);
    let window = sheet.window.get_untracked();
    sheet.look.update(|look| {
        look.zoom(factor, window, [0.5, 0.5]);
        look.centre = Some(centre_of(pixel));
    });
}

/// The pixel that is pointed at, or the one in the middle.
fn pixel_or_middle(sheet: Sheet) -> [usize; 2] {
    let middle = sheet.window.get_untracked().pixel([0.5, 0.5]);
    sheet.pixel.get_untracked().unwrap_or(middle)
}

fn centre_of(pixel: [usize; 2]) -> [f64; 2] {
    pixel.map(|at| at as f64 + 0.5)
}

fn pixel_at(sheet: Sheet, event: &PointerEvent) -> [usize; 2] {
    sheet.window.get_untracked().pixel(share(event))
}

/// Where on the frame, from 0 to 1.
fn share(event: &web_sys::MouseEvent) -> [f64; 2] {
    let Some(frame) = frame_of(event) else {
        return [0.5, 0.5];
    };
    let bounds = frame.get_bounding_client_rect();
    [
        (f64::from(event.client_x()) - bounds.left()) / bounds.width().max(1.0),
        (f64::from(event.client_y()) - bounds.top()) / bounds.height().max(1.0),
    ]
}

fn frame_of(event: &web_sys::Event) -> Option<Element> {
    event.current_target()?.dyn_into().ok()
}

fn percent(part: f64) -> String {
    format!("{}%", part * 100.0)
}
