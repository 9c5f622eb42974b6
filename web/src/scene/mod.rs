//! The scene in 3-D: wall, rig, points and light. It follows the workbench and lets a point be chosen.

// What is drawn may differ in a last bit from machine to machine: no result goes through here.
#![allow(clippy::disallowed_methods)]

mod content;
mod faces;
mod gestures;
mod grid;
mod labels;
mod lines;
mod orbit;
mod palette;
mod patch;
mod points;
mod stage;

use std::rc::Rc;

use leptos::prelude::*;
use leptos::{ev, html};
use wasm_bindgen::prelude::*;
use web_sys::{HtmlCanvasElement, KeyboardEvent, MediaQueryList, ResizeObserver};

use self::content::Content;
use self::gestures::{Gestures, keys};
use self::stage::{Stage, Subject};
use crate::colours::wants_little_motion;
use crate::legend::Legend;
use crate::state::{ColourBy, Workbench};

/// The scene with its controls.
#[component]
pub(crate) fn Scene() -> impl IntoView {
    let workbench = Workbench::get();
    let canvas = NodeRef::<html::Canvas>::new();
    let labels = NodeRef::<html::Div>::new();
    let stage = StoredValue::new_local(None::<Stage>);
    let missing = RwSignal::new(false);

    Effect::new(move |_| {
        let (Some(canvas), Some(labels)) = (canvas.get(), labels.get()) else {
            return;
        };
        match Stage::new(canvas.clone(), labels.into()) {
            Ok(new) => {
                attend(&canvas, &new, workbench);
                follow(&new, workbench);
                stage.set_value(Some(new));
            }
            Err(_) => missing.set(true),
        }
    });
    on_cleanup(move || {
        if let Some(Some(stage)) = stage.try_get_value() {
            stage.close();
        }
    });
    let fit = move |subject| {
        stage.with_value(|stage| stage.iter().for_each(|stage| stage.fit(subject)));
    };
    fit_with_key(move || fit(Subject::Measured));

    view! {
        <section class="scene panel" aria-label="Scene in 3-D">
            <Toolbar fit />
            <div class="stage">
                <canvas
                    node_ref=canvas
                    data-testid="scene"
                    role="application"
                    tabindex="0"
                    aria-label="Scene in 3-D: the vessel's wall, the rig's stations and the object's points. \
                                Arrow keys turn, Shift and arrow keys shift, plus and minus come nearer \
                                and go away, F fits."
                ></canvas>
                <div class="scene-labels" node_ref=labels aria-hidden="true"></div>
                <Legend />
                <Show when=move || missing.get()>
                    <p class="no-webgl" role="alert">
                        "This browser gives no WebGL2, so there is no picture in 3-D. Everything else \
                         works: the table, the pictures and the downloads. To get it, turn on hardware \
                         acceleration in the browser's settings, or use a current Chrome, Edge, Firefox \
                         or Safari."
                    </p>
                </Show>
            </div>
        </section>
    }
}

#[component]
fn Toolbar(fit: impl Fn(Subject) + Copy + Send + 'static) -> impl IntoView {
    let workbench = Workbench::get();
    let choose_colours = move |event| {
        workbench
            .colour_by
            .set(match event_target_value(&event).as_str() {
                "scan" => ColourBy::Sweep,
                "depth" => ColourBy::Depth,
                _ => ColourBy::RayDistance,
            });
    };
    let chosen = move |by: ColourBy| workbench.colour_by.get() == by;
    view! {
        <div class="toolbar">
            <label class="field">
                <span>"Colour by"</span>
                <select data-testid="colour-by" on:change=choose_colours>
                    <option value="ray-distance" selected=move || chosen(ColourBy::RayDistance)>
                        "Ray distance"
                    </option>
                    <option value="scan" selected=move || chosen(ColourBy::Sweep)>
                        "Scan"
                    </option>
                    <option value="depth" selected=move || chosen(ColourBy::Depth)>
                        "Depth"
                    </option>
                </select>
            </label>
            <label class="switch">
                <input
                    type="checkbox"
                    role="switch"
                    data-testid="refraction-switch"
                    prop:checked=move || workbench.refraction.get()
                    on:change=move |event| workbench.refraction.set(event_target_checked(&event))
                />
                <span>
                    {move || {
                        if workbench.refraction.get() { "With refraction" } else { "Without refraction" }
                    }}
                </span>
            </label>
            <div class="views-of">
                <button
                    type="button"
                    class="quiet"
                    title="Move the camera until the wall and the object fill the picture (F)"
                    on:click=move |_| fit(Subject::Measured)
                >
                    "Fit "
                    <kbd>"F"</kbd>
                </button>
                <button
                    type="button"
                    class="quiet"
                    title="Move the camera until the rig's stations are in the picture too"
                    on:click=move |_| fit(Subject::WholeSetUp)
                >
                    "Whole set-up"
                </button>
            </div>
        </div>
    }
}

/// Keeps the stage as the workbench says.
fn follow(stage: &Stage, workbench: Workbench) {
    let show = StoredValue::new_local(stage.clone());
    let dark = dark_mode();
    Effect::new(move |had_content: Option<bool>| {
        dark.track();
        let by = workbench.colour_by.get();
        let (Some(facts), Some(outcome)) = (workbench.facts.get(), workbench.outcome.get()) else {
            return false;
        };
        let stage = show.get_value();
        stage.show(Content::new(
            facts,
            outcome,
            by,
            workbench.chosen.get_untracked(),
        ));
        if had_content != Some(true) {
            stage.face_front();
        }
        true
    });
    Effect::new(move |_| show.get_value().choose(workbench.chosen.get()));
    Effect::new(move |before: Option<bool>| {
        let refraction = workbench.refraction.get();
        let at_once = before.is_none() || wants_little_motion();
        show.get_value().refract(refraction, at_once);
        refraction
    });
}

/// Listens to the canvas: pointers, wheel, size.
fn attend(canvas: &HtmlCanvasElement, stage: &Stage, workbench: Workbench) {
    let gestures = Rc::new(Gestures::default());
    let on = |name: &str, act: Box<dyn FnMut(web_sys::Event)>| {
        let closure = Closure::<dyn FnMut(web_sys::Event)>::wrap(act);
        let options = web_sys::AddEventListenerOptions::new();
        options.set_passive(false);
        let _ = canvas.add_event_listener_with_callback_and_add_event_listener_options(
            name,
            closure.as_ref().unchecked_ref(),
            &options,
        );
        // The canvas owns it from here on.
        closure.into_js_value();
    };
    let (hand, target) = (gestures.clone(), canvas.clone());
    on(
        "pointerdown",
        Box::new(move |event| hand.down(&target, event.unchecked_ref())),
    );
    let (hand, on_stage) = (gestures.clone(), stage.clone());
    on(
        "pointermove",
        Box::new(move |event| hand.moved(&on_stage, event.unchecked_ref())),
    );
    let (hand, on_stage) = (gestures.clone(), stage.clone());
    on(
        "pointerup",
        Box::new(move |event| {
            let place = hand.up(event.unchecked_ref());
            if let Some(view) = place.and_then(|place| on_stage.view_at(place)) {
                workbench.choose(Some(view));
            }
        }),
    );
    let hand = gestures.clone();
    on(
        "pointercancel",
        Box::new(move |event| hand.lost(event.unchecked_ref())),
    );
    let on_stage = stage.clone();
    on(
        "wheel",
        Box::new(move |event| gestures.wheel(&on_stage, event.unchecked_ref())),
    );
    let on_stage = stage.clone();
    on(
        "keydown",
        Box::new(move |event| keys(&on_stage, event.unchecked_ref())),
    );
    on("contextmenu", Box::new(|event| event.prevent_default()));
    watch_size(canvas, stage);
}

fn watch_size(canvas: &HtmlCanvasElement, stage: &Stage) {
    let stage = stage.clone();
    let resized = Closure::<dyn FnMut()>::new(move || stage.draw_soon());
    if let Ok(observer) = ResizeObserver::new(resized.as_ref().unchecked_ref()) {
        observer.observe(canvas);
    }
    resized.into_js_value();
}

/// F fits, unless something is being typed.
fn fit_with_key(fit: impl Fn() + 'static) {
    let listener = window_event_listener(ev::keydown, move |event: KeyboardEvent| {
        let typing = event.target().is_some_and(|target| {
            target
                .dyn_ref::<web_sys::HtmlInputElement>()
                .is_some_and(|i| i.type_() != "checkbox")
                || target.dyn_ref::<web_sys::HtmlSelectElement>().is_some()
        });
        let plain = !event.ctrl_key() && !event.meta_key() && !event.alt_key();
        if plain && !typing && event.key().eq_ignore_ascii_case("f") {
            fit();
        }
    });
    on_cleanup(move || listener.remove());
}

/// Tells when the system goes over from light to dark or back.
pub(crate) fn dark_mode() -> Trigger {
    let trigger = Trigger::new();
    let list = web_sys::window().and_then(|window| {
        window
            .match_media("(prefers-color-scheme: dark)")
            .ok()
            .flatten()
    });
    let Some(list) = list else { return trigger };
    let changed = Closure::<dyn FnMut()>::new(move || trigger.notify());
    list.set_onchange(Some(changed.as_ref().unchecked_ref()));
    let kept = StoredValue::new_local(Some((list, changed)));
    on_cleanup(move || {
        let kept = kept.try_update_value(Option::take).flatten();
        if let Some((list, _)) = kept as Option<(MediaQueryList, _)> {
            list.set_onchange(None);
        }
    });
    trigger
}
