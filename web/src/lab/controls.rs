//! Sliders, choices and media, from the core's table of parameters.

use leptos::prelude::*;
use snellius::lab::{
    Bench, CHOICES, Choice, MEDIA, MYSTERIES, Medium, MediumRole, Quantity, SUBSTANCES, quantity,
};

use super::state::LabState;

fn of_table(key: &str) -> &'static Quantity {
    quantity(key).expect("controls name keys of the table")
}

/// A slider with its number beside it.
#[component]
pub(super) fn QuantityControl(key: &'static str) -> impl IntoView {
    let lab = LabState::get();
    let quantity = of_table(key);
    let value = Memo::new(move |_| lab.bench.with(quantity.get).unwrap_or(quantity.low));
    let shown = move || value.get().to_string();
    let step = [1.0, 0.1, 0.01, 0.001, 0.0001][quantity.decimals];
    let set = move |event| {
        if let Ok(value) = event_target_value(&event).parse::<f64>() {
            lab.change(|bench| quantity.set(bench, value));
        }
    };
    let id = format!("lab-{key}");
    let name = if quantity.unit.is_empty() {
        quantity.name.to_owned()
    } else {
        format!("{} ({})", quantity.name, quantity.unit)
    };
    view! {
        <div class="quantity">
            <label for=id.clone()>{quantity.name}</label>
            <span class="number">
                <input
                    type="number"
                    min=quantity.low
                    max=quantity.high
                    step=step
                    aria-label=name
                    data-testid=format!("number-{key}")
                    prop:value=shown
                    on:change=set
                />
                <span class="unit">{quantity.unit}</span>
            </span>
            <input
                id=id
                type="range"
                min=quantity.low
                max=quantity.high
                step=step
                data-testid=format!("slider-{key}")
                prop:value=shown
                on:input=set
            />
        </div>
    }
}

/// A number that the bench chooses for itself unless it is switched on.
#[component]
pub(super) fn SwitchedQuantity(
    key: &'static str,
    on: &'static str,
    off: &'static str,
    /// Lets the bench choose.
    clear: fn(&mut Bench),
    /// The value to begin with.
    start: impl Fn(&Bench) -> f64 + Copy + Send + Sync + 'static,
) -> impl IntoView {
    let lab = LabState::get();
    let quantity = of_table(key);
    let is_on = Memo::new(move |_| lab.bench.with(quantity.get).is_some());
    let switch = move |event| {
        if event_target_checked(&event) {
            let value = lab.bench.with_untracked(start);
            lab.change(|bench| quantity.set(bench, value));
        } else {
            lab.change(clear);
        }
    };
    view! {
        <label class="switch">
            <input
                type="checkbox"
                role="switch"
                data-testid=format!("switch-{key}")
                prop:checked=move || is_on.get()
                on:change=switch
            />
            <span>{move || if is_on.get() { on } else { off }}</span>
        </label>
        <Show when=move || is_on.get()>
            <QuantityControl key />
        </Show>
    }
}

/// One of some words, as buttons of which one is pressed.
#[component]
pub(super) fn ChoiceControl(key: &'static str) -> impl IntoView {
    let lab = LabState::get();
    let choice: &'static Choice = CHOICES
        .iter()
        .find(|choice| choice.key == key)
        .expect("controls name keys of the table");
    let chosen = Memo::new(move |_| lab.bench.with(choice.get));
    let options = choice
        .options
        .iter()
        .enumerate()
        .map(|(place, (word, name))| {
            view! {
                <button
                    type="button"
                    class="chip"
                    aria-pressed=move || (chosen.get() == place).to_string()
                    data-testid=format!("{key}-{word}")
                    on:click=move |_| lab.change(|bench| choice.set(bench, place))
                >
                    {*name}
                </button>
            }
        });
    view! {
        <div class="choice" role="group" aria-label=choice.name>
            {options.collect_view()}
        </div>
    }
}

/// How the list of media names a number.
const NUMBER: &str = "number";

/// What a medium is: a substance, a mystery, or a number.
#[component]
pub(super) fn MediumControl(key: &'static str) -> impl IntoView {
    let lab = LabState::get();
    let role: &'static MediumRole = MEDIA
        .iter()
        .find(|role| role.key == key)
        .expect("controls name keys of the table");
    let medium = Memo::new(move |_| lab.bench.with(role.get));
    let chosen = move || match medium.get() {
        Medium::Index(_) => NUMBER.to_owned(),
        other => other.key(),
    };
    let choose = move |event| {
        let word = event_target_value(&event);
        let place = SUBSTANCES
            .iter()
            .position(|substance| substance.key == word);
        let mystery = || (0..MYSTERIES.len()).find(|place| Medium::Mystery(*place).key() == word);
        let now = lab.bench.with_untracked(role.get);
        // What was a mystery is not given away by becoming a number.
        let index = if now.is_mystery() { 1.4 } else { now.index() };
        let medium = match (place, mystery()) {
            (Some(place), _) => Medium::Named(place),
            (None, Some(place)) => Medium::Mystery(place),
            (None, None) => Medium::Index(index),
        };
        lab.change(|bench| (role.set)(bench, medium));
    };
    let type_index = move |event| {
        if let Some(medium) = event_target_value(&event)
            .parse()
            .ok()
            .and_then(Medium::of_index)
        {
            lab.change(|bench| (role.set)(bench, medium));
        }
    };
    let substances = SUBSTANCES.map(|substance| {
        let text = format!("{} \u{b7} {:.4}", substance.name, substance.index);
        view! {
            <option value=substance.key selected=move || chosen() == substance.key title=substance.source>
                {text}
            </option>
        }
    });
    let hidden = if role.may_be_hidden {
        MYSTERIES.len()
    } else {
        0
    };
    let mysteries = (0..hidden).map(|place| {
        let medium = Medium::Mystery(place);
        view! {
            <option value=medium.key() selected=move || chosen() == medium.key()>
                {medium.name()}
            </option>
        }
    });
    let source = move || match medium.get() {
        Medium::Named(place) => SUBSTANCES[place].source,
        _ => "",
    };
    let id = format!("lab-{key}");
    view! {
        <div class="medium-control">
            <label for=id.clone()>{role.name} " " <var>{role.symbol}</var></label>
            <select id=id data-testid=format!("medium-{key}") title=source on:change=choose>
                {substances}
                {mysteries.collect_view()}
                <option value=NUMBER selected=move || chosen() == NUMBER>
                    "A number"
                </option>
            </select>
            <Show when=move || matches!(medium.get(), Medium::Index(_))>
                <input
                    type="number"
                    class="index-number"
                    min=Medium::RANGE.0
                    max=Medium::RANGE.1
                    step="0.0001"
                    aria-label=format!("{}: refractive index", role.name)
                    data-testid=format!("index-{key}")
                    prop:value=move || medium.get().index().to_string()
                    on:change=type_index
                />
            </Show>
        </div>
    }
}
