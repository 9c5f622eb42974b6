//! The parameters of a stage, made from the core's table: whatever stands there can be turned here.

use leptos::prelude::*;
use snellius::pipeline::{NumberParameter, PARAMETERS, Parameter, ParameterKind, Settings, Stage};

use crate::state::Workbench;

/// Reads a parameter.
type Getter<T> = fn(&Settings) -> T;

/// The choices of a stage: they are seen at once.
#[component]
pub(super) fn Choices(stage: Stage) -> impl IntoView {
    let own = PARAMETERS.iter().filter(move |p| p.stage == stage);
    own.filter(|p| is_choice(p)).map(control).collect_view()
}

/// The other parameters of a stage: they are seen when they are asked for.
#[component]
pub(super) fn Parameters(stage: Stage) -> impl IntoView {
    let workbench = Workbench::get();
    let own = move || {
        let own = PARAMETERS.iter().filter(move |p| p.stage == stage);
        own.filter(|p| !is_choice(p))
    };
    let changed = move || {
        let settings = workbench.settings.get();
        let changed = own().filter(|p| !p.is_default(&settings)).count();
        (changed > 0).then(|| format!(" ({changed} changed)"))
    };
    (own().count() > 0).then(|| {
        view! {
            <details class="parameters" data-testid=format!("parameters-{stage:?}").to_lowercase()>
                <summary>"Parameters" {changed}</summary>
                {own().map(control).collect_view()}
            </details>
        }
    })
}

const fn is_choice(parameter: &Parameter) -> bool {
    matches!(parameter.kind, ParameterKind::Choice { .. })
}

fn control(parameter: &'static Parameter) -> impl IntoView {
    let workbench = Workbench::get();
    let help = format!("help-{}", parameter.id);
    let field = match parameter.kind {
        ParameterKind::Number(number) => number_field(workbench, parameter, number).into_any(),
        ParameterKind::Switch { get, set } => {
            switch_field(workbench, parameter, (get, set)).into_any()
        }
        ParameterKind::Choice { options, get, set } => {
            choice_field(workbench, parameter, options, (get, set)).into_any()
        }
    };
    let changed = move || !parameter.is_default(&workbench.settings.get());
    let reset = move |_| {
        workbench.change(parameter.id, |settings| parameter.reset(settings));
        workbench.let_go();
    };
    view! {
        <div class="parameter" class:changed=changed>
            <div class="parameter-head">
                {field}
                <button
                    type="button"
                    class="reset"
                    title=format!("Back to the default {}", default_of(parameter))
                    aria-label=format!("Reset {}", parameter.name)
                    data-testid=format!("reset-{}", parameter.id)
                    disabled=move || !changed()
                    on:click=reset
                >
                    "\u{21ba}"
                </button>
            </div>
            <p class="help" id=help>
                {parameter.meaning}
            </p>
        </div>
    }
}

fn number_field(
    workbench: Workbench,
    parameter: &'static Parameter,
    number: NumberParameter,
) -> impl IntoView {
    let NumberParameter {
        unit,
        low,
        high,
        step,
        get,
        set,
    } = number;
    let value = move || get(&workbench.settings.get()).to_string();
    let turn = move |event| {
        let typed = event_target_value(&event).parse::<f64>();
        if let Some(value) = typed.ok().filter(|v| (low..=high).contains(v)) {
            workbench.change(parameter.id, |settings| set(settings, value));
        }
    };
    // What was typed beyond the range gives way to what is used.
    let settle = move |event: web_sys::Event| {
        workbench.let_go();
        use wasm_bindgen::JsCast;
        let field = event
            .target()
            .and_then(|t| t.dyn_into::<web_sys::HtmlInputElement>().ok());
        if let Some(field) = field {
            field.set_value(&get(&workbench.settings.get_untracked()).to_string());
        }
    };
    let [low, high, step] = [low, high, step].map(|n| n.to_string());
    let (range_low, range_high, range_step) = (low.clone(), high.clone(), step.clone());
    view! {
        <label for=parameter.id>{parameter.name}</label>
        <span class="number-field">
            <input
                id=parameter.id
                type="number"
                data-testid=parameter.id
                min=low
                max=high
                step=step
                aria-describedby=format!("help-{}", parameter.id)
                prop:value=value
                on:input=turn
                on:change=settle
            />
            <span class="unit">{unit}</span>
        </span>
        <input
            type="range"
            aria-label=format!("{}, {unit}", parameter.name)
            tabindex="-1"
            min=range_low
            max=range_high
            step=range_step
            prop:value=value
            on:input=turn
            on:change=settle
        />
    }
}

fn switch_field(
    workbench: Workbench,
    parameter: &'static Parameter,
    (get, set): (Getter<bool>, fn(&mut Settings, bool)),
) -> impl IntoView {
    let turn = move |event| {
        let on = event_target_checked(&event);
        workbench.change(parameter.id, |settings| set(settings, on));
        workbench.let_go();
    };
    view! {
        <label class="switch">
            <input
                id=parameter.id
                type="checkbox"
                role="switch"
                data-testid=parameter.id
                aria-describedby=format!("help-{}", parameter.id)
                prop:checked=move || get(&workbench.settings.get())
                on:change=turn
            />
            <span>{parameter.name}</span>
        </label>
    }
}

fn choice_field(
    workbench: Workbench,
    parameter: &'static Parameter,
    options: &'static [(&'static str, &'static str)],
    (get, set): (Getter<&'static str>, fn(&mut Settings, &str)),
) -> impl IntoView {
    let choose = move |event| {
        let word = event_target_value(&event);
        workbench.change(parameter.id, |settings| set(settings, &word));
        workbench.let_go();
    };
    let option = move |(word, name): (&'static str, &'static str)| {
        view! {
            <option value=word selected=move || get(&workbench.settings.get()) == word>
                {name}
            </option>
        }
    };
    view! {
        <label for=parameter.id>{parameter.name}</label>
        <select
            id=parameter.id
            data-testid=parameter.id
            aria-describedby=format!("help-{}", parameter.id)
            prop:value=move || get(&workbench.settings.get())
            on:change=choose
        >
            {options.iter().copied().map(option).collect_view()}
        </select>
    }
}

fn default_of(parameter: &Parameter) -> String {
    let usual = Settings::default();
    match parameter.kind {
        ParameterKind::Number(n) => format!("{} {}", (n.get)(&usual), n.unit),
        ParameterKind::Switch { get, .. } => if get(&usual) { "on" } else { "off" }.to_owned(),
        ParameterKind::Choice { options, get, .. } => {
            let word = get(&usual);
            let known = options.iter().find(|(option, _)| *option == word);
            known.map_or(word, |(_, name)| name).to_owned()
        }
    }
}
