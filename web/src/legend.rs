//! What the colours in the scene mean.

use leptos::prelude::*;

use crate::colours::{Quantity, Scale, css, hue, values};
use crate::number::fixed;
use crate::state::Workbench;

/// The legend of the colours. That of a quantity shows how often each value occurs, and hides points
/// beyond two handles.
#[component]
pub(crate) fn Legend() -> impl IntoView {
    let workbench = Workbench::get();
    let scale = Memo::new(move |_| {
        let (facts, outcome) = (workbench.facts.get()?, workbench.outcome.get()?);
        Some(Scale::of(&facts, &outcome, workbench.colour_by.get()))
    });
    // What was hidden by one quantity is not what another hides.
    Effect::new(move |_| {
        workbench.colour_by.track();
        workbench.shown_range.set([0.0, 1.0]);
    });
    view! {
        <div class="legend" data-testid="legend">
            {move || match scale.get() {
                Some(Scale::Quantity(shown)) => view! { <QuantityLegend shown /> }.into_any(),
                Some(Scale::Sweeps(count)) => sweeps(count).into_any(),
                None => ().into_any(),
            }}
        </div>
    }
}

#[component]
fn QuantityLegend(shown: Quantity) -> impl IntoView {
    let workbench = Workbench::get();
    let (map, name, unit) = (shown.map, shown.name, shown.unit);
    let fractions = Memo::new(move |_| {
        let (outcome, by) = (workbench.outcome.get(), workbench.colour_by.get());
        let values = outcome.iter().flat_map(|outcome| values(outcome, by));
        values
            .map(|value| shown.fraction(value).clamp(0.0, 1.0))
            .collect::<Vec<_>>()
    });
    let counts = Memo::new(move |_| fractions.with(|fractions| histogram(fractions)));
    let bars = move || {
        let counts = counts.get();
        let most = counts.iter().copied().max().unwrap_or(1).max(1) as f64;
        let [low, high] = workbench.shown_range.get();
        let bar = |(index, count): (usize, &usize)| {
            let middle = (index as f32 + 0.5) / BINS as f32;
            let height = HEIGHT * (*count as f64 / most).sqrt();
            view! {
                <rect
                    x=index
                    y=HEIGHT - height
                    width="1"
                    height=height
                    fill=css(map.at(middle))
                    opacity=if (low..=high).contains(&middle) { "1" } else { "0.25" }
                />
            }
        };
        counts.iter().enumerate().map(bar).collect_view()
    };
    let count = move || {
        let [low, high] = workbench.shown_range.get();
        let within = |fractions: &Vec<f32>| {
            let within = fractions.iter().filter(|f| (low..=high).contains(*f));
            (within.count(), fractions.len())
        };
        let (within, all) = fractions.with(within);
        (within < all).then(|| format!("{within} of {all} points"))
    };
    let value_at = move |fraction: f32| value_text(&shown, fraction);
    let handle = move |(end, test_id, says): (usize, &'static str, &'static str)| {
        let slide = move |event| {
            if let Ok(fraction) = event_target_value(&event).parse::<f32>() {
                workbench.shown_range.update(|range| {
                    let other = range[1 - end];
                    range[end] = if end == 0 {
                        fraction.min(other)
                    } else {
                        fraction.max(other)
                    };
                });
            }
        };
        view! {
            <input
                type="range"
                min="0"
                max="1"
                step="0.01"
                data-testid=test_id
                aria-label=format!("{says}: {name}, {unit}")
                aria-valuetext=move || value_at(workbench.shown_range.get()[end])
                prop:value=move || workbench.shown_range.get()[end].to_string()
                on:input=slide
            />
        }
    };
    view! {
        <p class="legend-title">
            {format!("{name}, {unit}")}
            <span class="legend-count">{count}</span>
        </p>
        <svg
            class="histogram"
            viewBox=format!("0 0 {BINS} {HEIGHT}")
            preserveAspectRatio="none"
            aria-hidden="true"
        >
            {bars}
        </svg>
        <div class="brush" role="group" aria-label="Points to be shown">
            <div class="ramp" style:background=map.gradient()></div>
            {handle((0, "hide-below", "Hide points below"))}
            {handle((1, "hide-above", "Hide points above"))}
        </div>
        <p class="ends">
            <span>{move || value_at(workbench.shown_range.get()[0])}</span>
            <span>{move || value_at(workbench.shown_range.get()[1])}</span>
        </p>
    }
}

/// The value at a fraction of a scale, as it is written beside it.
pub(crate) fn value_text(scale: &Quantity, fraction: f32) -> String {
    let digits = if scale.high.abs() < 10.0 { 3 } else { 1 };
    let value = scale.low + fraction * (scale.high - scale.low);
    fixed(f64::from(value), digits)
}

/// How many bars a histogram has.
const BINS: usize = 32;
/// How high it is, in bars' widths.
const HEIGHT: f64 = 6.0;

fn histogram(fractions: &[f32]) -> [usize; BINS] {
    let mut counts = [0; BINS];
    for fraction in fractions {
        counts[((fraction * BINS as f32) as usize).min(BINS - 1)] += 1;
    }
    counts
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
