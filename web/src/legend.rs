//! What the colours in the scene mean.

use leptos::prelude::*;

use crate::colours::{Quantity, Scale, css, hue};
use crate::number::fixed;
use crate::state::Workbench;

/// The legend of the colours.
#[component]
pub(crate) fn Legend() -> impl IntoView {
    let workbench = Workbench::get();
    let scale = Memo::new(move |_| {
        let (facts, outcome) = (workbench.facts.get()?, workbench.outcome.get()?);
        Some(Scale::of(&facts, &outcome, workbench.colour_by.get()))
    });
    view! {
        <div class="legend" data-testid="legend">
            {move || match scale.get() {
                Some(Scale::Quantity(shown)) => quantity(&shown).into_any(),
                Some(Scale::Sweeps(count)) => sweeps(count).into_any(),
                None => ().into_any(),
            }}
        </div>
    }
}

fn quantity(shown: &Quantity) -> impl IntoView + use<> {
    let Quantity {
        name,
        unit,
        low,
        high,
        map,
    } = *shown;
    let digits = if high.abs() < 10.0 { 3 } else { 1 };
    let end = |value: f32| fixed(f64::from(value), digits);
    view! {
        <p class="legend-title">{format!("{name}, {unit}")}</p>
        <div class="ramp" style:background=map.gradient()></div>
        <p class="ends">
            <span>{end(low)}</span>
            <span>{end(high)}</span>
        </p>
    }
}

fn sweeps(count: usize) -> impl IntoView {
    // More would cover the scene, and hues repeat by then.
    const MOST: usize = 8;
    let entry = |sweep| {
        view! {
            <li>
                <span class="swatch" style:background=css(hue(sweep))></span>
                {sweep + 1}
            </li>
        }
    };
    view! {
        <p class="legend-title">"Scan"</p>
        <ul class="swatches">
            {(0..count.min(MOST)).map(entry).collect_view()}
            {(count > MOST).then(|| view! { <li>{format!("... {count}")}</li> })}
        </ul>
    }
}
