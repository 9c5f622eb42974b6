//! The scene in 3-D: wall, rig, points and light. It follows the workbench and lets a point be chosen.

// What is drawn may differ in a last bit from machine to machine: no result goes through here.
#![allow(clippy::disallowed_methods)]

mod blend;
mod content;
mod ellipsoids;
mod faces;
mod gestures;
mod grid;
mod labels;
mod layer;
mod lines;
mod orbit;
mod pace;
mod palette;
mod patch;
mod picture;
mod points;
mod section;
mod stage;

use std::rc::Rc;

use leptos::html;
use leptos::prelude::*;
use three_d::Vec2;
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::spawn_local;
use web_sys::{HtmlCanvasElement, MediaQueryList, ResizeObserver};

use self::content::Content;
use self::gestures::{Ended, Gestures, keys};
use self::palette::Palette;
use self::section::SectionControl;
use self::stage::{Stage, Subject};
use crate::colours::wants_little_motion;
use crate::legend::Legend;
use crate::measuring::{Measuring, MeasuringBar};
use crate::run::Problem;
use crate::state::{ColourBy, SceneCommand, Workbench};

/// The scene with its controls.
#[component]
pub(crate) fn Scene() -> impl IntoView {
    let workbench = Workbench::get();
    let canvas = NodeRef::<html::Canvas>::new();
    let labels = NodeRef::<html::Div>::new();
    let stage = StoredValue::new_local(None::<Stage>);
    let missing = RwSignal::new(false);
    let frame = RwSignal::new(None);

    let ready = RwSignal::new(false);
    Effect::new(move |_| {
        let (Some(canvas), Some(labels)) = (canvas.get(), labels.get()) else {
            return;
        };
        let owner = Owner::current();
        spawn_local(async move {
            let made = Stage::new(canvas.clone(), labels.into()).await;
            let is_gone = stage.try_get_value().is_none();
            match (made, owner) {
                (Ok(new), _) if is_gone => new.close(),
                (_, _) if is_gone => {}
                (Ok(new), Some(owner)) => {
                    owner.with(|| {
                        attend(&canvas, &new, workbench, frame);
                        follow(&new, workbench);
                    });
                    stage.set_value(Some(new));
                }
                _ => missing.set(true),
            }
            ready.try_set(true);
        });
    });
    on_cleanup(move || {
        if let Some(Some(stage)) = stage.try_get_value() {
            stage.close();
        }
    });
    view! {
        <section class="scene panel" aria-label="Scene in 3-D">
            <Toolbar />
            <MeasuringBar />
            <MoreTools />
            <div class="stage">
                <canvas
                    node_ref=canvas
                    data-testid="scene"
                    role="application"
                    tabindex="0"
                    aria-busy=move || (!ready.get()).to_string()
                    aria-label="Scene in 3-D: the vessel's wall, the rig's stations and the object's points. \
                                Arrow keys turn, Shift and arrow keys shift, plus and minus come nearer \
                                and go away, F fits."
                ></canvas>
                <div class="scene-labels" node_ref=labels aria-hidden="true"></div>
                <Legend />
                {move || frame.get().map(drawn_frame)}
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

/// A box that is being drawn around points.
fn drawn_frame([one, other]: [Vec2; 2]) -> impl IntoView {
    let px = |value: f32| format!("{value}px");
    view! {
        <div
            class="drawn-frame"
            aria-hidden="true"
            style:left=px(one.x.min(other.x))
            style:top=px(one.y.min(other.y))
            style:width=px((one.x - other.x).abs())
            style:height=px((one.y - other.y).abs())
        ></div>
    }
}

/// What the colours can mean.
const COLOURS: [(ColourBy, &str, &str); 5] = [
    (ColourBy::RayDistance, "ray-distance", "Ray distance"),
    (ColourBy::Sigma, "sigma", "Standard deviation"),
    (ColourBy::Depth, "depth", "Depth"),
    (ColourBy::Sweep, "scan", "Scan"),
    (ColourBy::Residual, "residual", "Wall residual"),
];

#[component]
fn Toolbar() -> impl IntoView {
    let workbench = Workbench::get();
    let choose_colours = move |event| {
        let word = event_target_value(&event);
        let chosen = COLOURS.iter().find(|(_, known, _)| *known == word);
        if let Some((by, ..)) = chosen {
            workbench.colour_by.set(*by);
        }
    };
    let chosen = move |by: ColourBy| workbench.colour_by.get() == by;
    view! {
        <div class="toolbar">
            <label class="field">
                <span>"Colour by"</span>
                <select data-testid="colour-by" on:change=choose_colours>
                    {COLOURS
                        .map(|(by, word, name)| {
                            view! {
                                <option value=word selected=move || chosen(by)>
                                    {name}
                                </option>
                            }
                        })
                        .collect_view()}
                </select>
            </label>
            <RefractionSlider />
            <div class="views-of">
                <button
                    type="button"
                    class="quiet"
                    aria-pressed=move || workbench.orthographic.get().to_string()
                    title="Without perspective: what is parallel is seen parallel (5)"
                    data-testid="orthographic"
                    on:click=move |_| workbench.orthographic.update(|on| *on = !*on)
                >
                    "Parallel"
                </button>
                <button
                    type="button"
                    class="quiet"
                    title="Move the camera until the wall and the object fill the picture (F)"
                    on:click=move |_| workbench.command.set(Some(SceneCommand::Fit))
                >
                    "Fit "
                    <kbd>"F"</kbd>
                </button>
                <button
                    type="button"
                    class="quiet"
                    title="Move the camera until the rig's stations are in the picture too"
                    on:click=move |_| workbench.command.set(Some(SceneCommand::FitAll))
                >
                    "Whole set-up"
                </button>
            </div>
        </div>
    }
}

/// What a scene is looked at with now and then.
#[component]
fn MoreTools() -> impl IntoView {
    let workbench = Workbench::get();
    let transparent = RwSignal::new(false);
    let choose_ellipsoids = move |event| {
        let word = event_target_value(&event);
        let chosen = ELLIPSOIDS.iter().find(|(_, known, _)| *known == word);
        workbench
            .ellipsoids
            .set(chosen.and_then(|(size, ..)| *size));
    };
    let ellipsoids = move |(size, word, name): (Option<f32>, &'static str, &'static str)| {
        view! {
            <option value=word selected=move || workbench.ellipsoids.get() == size>
                {name}
            </option>
        }
    };
    let save = move |_| {
        let transparent = transparent.get_untracked();
        workbench
            .command
            .set(Some(SceneCommand::Picture { transparent }));
    };
    view! {
        <details class="scene-more" data-testid="scene-more">
            <summary>"Section, uncertainty, picture"</summary>
            <div class="scene-tools">
                <SectionControl />
                <label class="field">
                    <span>"Error ellipsoids, 2\u{3c3}"</span>
                    <select data-testid="ellipsoids" on:change=choose_ellipsoids>
                        {ELLIPSOIDS.map(ellipsoids).collect_view()}
                    </select>
                </label>
                <label class="field">
                    <input
                        type="checkbox"
                        data-testid="picture-transparent"
                        prop:checked=move || transparent.get()
                        on:change=move |event| transparent.set(event_target_checked(&event))
                    />
                    <span>"Transparent ground"</span>
                </label>
                <button type="button" class="chip" data-testid="save-picture" on:click=save>
                    "Save picture (PNG)"
                </button>
            </div>
        </details>
    }
}

/// How large error ellipsoids are drawn: most are too small to be seen as they are.
const ELLIPSOIDS: [(Option<f32>, &str, &str); 4] = [
    (None, "off", "Off"),
    (Some(1.0), "1", "As they are"),
    (Some(10.0), "10", "10 times as large"),
    (Some(100.0), "100", "100 times as large"),
];

/// From the object as it would be seen without refraction to where it is.
#[component]
fn RefractionSlider() -> impl IntoView {
    let workbench = Workbench::get();
    let slide = move |event| {
        if let Ok(refraction) = event_target_value(&event).parse() {
            workbench.refraction.set(refraction);
        }
    };
    let end = move |(name, test_id, at): (&'static str, &'static str, f32)| {
        view! {
            <button
                type="button"
                class="chip"
                data-testid=test_id
                aria-pressed=move || (workbench.refraction.get() == at).to_string()
                on:click=move |_| workbench.refraction.set(at)
            >
                {name}
            </button>
        }
    };
    view! {
        <div class="refraction" role="group" aria-label="Refraction">
            {end(("Without", "refraction-without", 0.0))}
            <input
                type="range"
                min="0"
                max="1"
                step="0.01"
                data-testid="refraction-slider"
                aria-label="Refraction, from without to with"
                prop:value=move || workbench.refraction.get().to_string()
                on:input=slide
            />
            {end(("With refraction", "refraction-with", 1.0))}
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
            &Palette::of_the_system(),
        ));
        if had_content != Some(true) {
            stage.face_front();
        }
        true
    });
    Effect::new(move |_| show.get_value().choose(workbench.chosen.get()));
    Effect::new(move |_| {
        show.get_value()
            .pick(workbench.measuring.with(|m| m.faces().clone()));
    });
    Effect::new(move |_| {
        workbench.outcome.track();
        show.get_value().cut(workbench.section.get());
    });
    Effect::new(move |_| {
        workbench.outcome.track();
        show.get_value().draw_ellipsoids(workbench.ellipsoids.get());
    });
    Effect::new(move |_| show.get_value().hide_beyond(workbench.shown_range.get()));
    Effect::new(move |_| {
        show.get_value()
            .set_orthographic(workbench.orthographic.get());
    });
    Effect::new(move |_| {
        let Some(command) = workbench.command.get() else {
            return;
        };
        let stage = show.get_value();
        match command {
            SceneCommand::Fit => stage.fit(Subject::Measured),
            SceneCommand::FitAll => stage.fit(Subject::WholeSetUp),
            SceneCommand::Look(from) => stage.look(from),
            SceneCommand::Picture { transparent } => {
                stage.save_picture(transparent, move |saved| {
                    if let Err(error) = saved {
                        workbench.fail(Problem::own(format!(
                            "The browser gives no picture: {error:?}"
                        )));
                    }
                });
            }
        }
    });
    Effect::new(move |before: Option<f32>| {
        let refraction = workbench.refraction.get();
        // A slider under way is motion enough.
        let is_jump = before.is_some_and(|before| (before - refraction).abs() == 1.0);
        let at_once = !is_jump || wants_little_motion();
        show.get_value().refract(refraction, at_once);
        refraction
    });
}

/// Listens to the canvas: pointers, wheel, size.
fn attend(
    canvas: &HtmlCanvasElement,
    stage: &Stage,
    workbench: Workbench,
    frame: RwSignal<Option<[Vec2; 2]>>,
) {
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
        Box::new(move |event| {
            hand.moved(&on_stage, event.unchecked_ref());
            frame.set(hand.frame());
        }),
    );
    let (hand, on_stage) = (gestures.clone(), stage.clone());
    on(
        "pointerup",
        Box::new(move |event| {
            frame.set(None);
            match hand.up(event.unchecked_ref()) {
                Some(Ended::Click(place)) => {
                    let Some(point) = on_stage.point_at(place) else {
                        return;
                    };
                    workbench.choose(Some(point.view));
                    if let Some(index) = point.index {
                        workbench.pick((point.view, index));
                    }
                }
                Some(Ended::Frame(corners))
                    if workbench.measuring.with_untracked(Measuring::is_on) =>
                {
                    let points = on_stage.points_within(corners).into_iter();
                    let picked = points.filter_map(|p| Some((p.view, p.index?)));
                    workbench
                        .measuring
                        .update(|measuring| measuring.add(picked));
                }
                _ => {}
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
    let on_stage = stage.clone();
    on(
        "dblclick",
        Box::new(move |event| on_stage.focus(gestures::place(event.unchecked_ref()))),
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
