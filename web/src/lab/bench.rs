//! The bench: from above, in space, at the wall's faces, with its numbers and its controls.

use leptos::prelude::*;
use snellius::lab::{Bench, WallShape, quantity};
use wasm_bindgen::prelude::*;
use web_sys::{Element, ResizeObserver};

use super::controls::{ChoiceControl, MediumControl, QuantityControl, SwitchedQuantity};
use super::drawing::At;
use super::equations::Equations;
use super::loupe::Loupes;
use super::measured::{Faces, Measured};
use super::section::Section;
use super::space::Space;
use super::state::LabState;

/// The view of the bench.
#[component]
pub(super) fn BenchView() -> impl IntoView {
    view! {
        <div class="bench">
            <section class="panel pictures-of-bench" aria-label="The bench">
                <Section />
                <Space />
            </section>
            <Controls />
            <section class="panel at-the-wall" aria-labelledby="at-the-wall">
                <h2 id="at-the-wall">"At the wall's faces"</h2>
                <div class="loupes">
                    <Loupes />
                    <Faces />
                </div>
            </section>
            <section class="panel" aria-labelledby="equations">
                <h2 id="equations">"The equations, with the numbers of this moment"</h2>
                <Equations />
            </section>
            <Measured />
        </div>
    }
}

#[component]
fn Controls() -> impl IntoView {
    let lab = LabState::get();
    let round = move || lab.bench.with(|bench| bench.wall != WallShape::Plane);
    let aim_now = move |_: &Bench| {
        let aim = lab
            .light
            .with_untracked(|light| light.beam.start.direction.vector());
        let on_rig = lab
            .bench
            .with_untracked(|bench| bench.rig_rotation().inverse() * aim);
        on_rig.x.atan2(on_rig.z).to_degrees()
    };
    view! {
        <section class="panel controls" aria-label="What can be set">
            <fieldset>
                <legend>"Wall"</legend>
                <ChoiceControl key="wall" />
                <QuantityControl key="thickness" />
                <Show when=round>
                    <QuantityControl key="radius" />
                </Show>
            </fieldset>
            <fieldset>
                <legend>"Media"</legend>
                <MediumControl key="outside" />
                <MediumControl key="glass" />
                <MediumControl key="liquid" />
            </fieldset>
            <fieldset>
                <legend>"Rig"</legend>
                <SwitchedQuantity
                    key="aim"
                    off="Beam aimed at the object point"
                    on="Beam at an angle of its own"
                    clear=|bench| bench.aim = None
                    start=aim_now
                />
                <QuantityControl key="turn" />
                <QuantityControl key="pitch" />
            </fieldset>
            <fieldset>
                <legend>"Measuring"</legend>
                <SwitchedQuantity
                    key="assumed"
                    off="Measured with the right index"
                    on="Measured with an assumed index"
                    clear=|bench| bench.assumed = None
                    start=assumed_start
                />
            </fieldset>
        </section>
    }
}

/// An assumed index to begin with; that of a mystery is not given away.
fn assumed_start(bench: &Bench) -> f64 {
    if bench.hides_index() {
        return 1.4;
    }
    quantity("assumed").map_or(1.4, |quantity| quantity.fitted(bench.liquid.index()))
}

/// Keeps a signal at an element's size, px.
pub(super) fn watch_size(element: &Element, size: RwSignal<At>) {
    let watched = element.clone();
    let resized = Closure::<dyn FnMut()>::new(move || {
        let now = [
            f64::from(watched.client_width().max(1)),
            f64::from(watched.client_height().max(1)),
        ];
        // The observer may speak once more after the view is gone.
        if size.try_get_untracked().is_some_and(|before| before != now) {
            size.set(now);
        }
    });
    let observer = ResizeObserver::new(resized.as_ref().unchecked_ref()).ok();
    if let Some(observer) = &observer {
        observer.observe(element);
    }
    let kept = StoredValue::new_local(Some((observer, resized)));
    on_cleanup(move || {
        if let Some((Some(observer), _)) = kept.try_update_value(Option::take).flatten() {
            observer.disconnect();
        }
    });
}
