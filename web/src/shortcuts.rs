//! Every key that does something: one table, from which the keys are heard and the help sheet is made.

use leptos::prelude::*;
use leptos::{ev, html};
use wasm_bindgen::JsCast;
use web_sys::{Element, HtmlInputElement, KeyboardEvent};

use crate::lab;
use crate::state::{Look, SceneCommand, Workbench};

/// A key and what it does.
struct Shortcut {
    /// Where it works.
    place: &'static str,
    /// The keys as a person reads them.
    keys: &'static str,
    what: &'static str,
    /// What happens; nothing where a part of the page hears its keys itself.
    act: Option<(Keys, fn(Workbench))>,
}

/// What is pressed together.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Keys {
    key: &'static str,
    control: bool,
    shift: Option<bool>,
}

const fn plain(key: &'static str) -> Keys {
    Keys {
        key,
        control: false,
        shift: None,
    }
}

const fn control(key: &'static str, shift: bool) -> Keys {
    Keys {
        key,
        control: true,
        shift: Some(shift),
    }
}

const SHORTCUTS: [Shortcut; 21] = [
    anywhere("?", "Show these keys", plain("?"), |w| w.help.set(true)),
    anywhere(
        "Ctrl Z",
        "Take the last change back",
        control("z", false),
        Workbench::undo,
    ),
    anywhere(
        "Ctrl Shift Z",
        "Make it again",
        control("z", true),
        Workbench::redo,
    ),
    anywhere(
        "Ctrl Y",
        "Make it again",
        control("y", false),
        Workbench::redo,
    ),
    anywhere("N", "The next view", plain("n"), |w| w.step(1)),
    anywhere("P", "The view before", plain("p"), |w| w.step(-1)),
    anywhere(
        "F",
        "Fit wall and object into the picture",
        plain("f"),
        |w| {
            w.command.set(Some(SceneCommand::Fit));
        },
    ),
    anywhere("1", "Look from the rig", plain("1"), |w| {
        look(w, Look::Front);
    }),
    anywhere("3", "Look from the side", plain("3"), |w| {
        look(w, Look::Side);
    }),
    anywhere("7", "Look from above", plain("7"), |w| look(w, Look::Above)),
    anywhere("5", "With or without perspective", plain("5"), |w| {
        w.orthographic.update(|on| *on = !*on);
    }),
    anywhere("R", "Without refraction, or with it", plain("r"), |w| {
        w.refraction
            .update(|r| *r = if *r > 0.5 { 0.0 } else { 1.0 });
    }),
    anywhere(
        "M",
        "Measure with the chosen view's point, or no more",
        plain("m"),
        Workbench::pick_chosen,
    ),
    within("scene", "Ctrl and drag", "Measure with the points within"),
    within("scene", "Left drag, arrow keys", "Turn"),
    within(
        "scene",
        "Right drag, Shift and left drag, Shift and arrow keys",
        "Shift",
    ),
    within("scene", "Wheel, + and \u{2212}", "Come nearer, go away"),
    within("scene", "Click, double click", "Choose a point, look at it"),
    within(
        "pictures",
        "Wheel, + and \u{2212}; drag, arrow keys",
        "Zoom; shift",
    ),
    within(
        "table",
        "\u{2191} \u{2193} Page Up, Page Down, Home, End",
        "Choose a view",
    ),
    within(
        "spots",
        "Tab",
        "From spot to spot; its list says what it is taken for",
    ),
];

const fn anywhere(
    keys: &'static str,
    what: &'static str,
    pressed: Keys,
    act: fn(Workbench),
) -> Shortcut {
    Shortcut {
        place: "anywhere",
        keys,
        what,
        act: Some((pressed, act)),
    }
}

const fn within(place: &'static str, keys: &'static str, what: &'static str) -> Shortcut {
    Shortcut {
        place,
        keys,
        what,
        act: None,
    }
}

fn look(workbench: Workbench, from: Look) {
    workbench.command.set(Some(SceneCommand::Look(from)));
}

/// Hears the keys of the table, as long as the page is there.
pub(crate) fn listen(workbench: Workbench) {
    let listener = window_event_listener(ev::keydown, move |event: KeyboardEvent| {
        if event.default_prevented() || event.alt_key() || is_typing(&event) || lab::is_open() {
            return;
        }
        let acts = SHORTCUTS.iter().filter_map(|shortcut| shortcut.act);
        let mut meant = acts.filter(|(keys, _)| is_pressed(*keys, &event));
        if let Some((_, act)) = meant.next() {
            event.prevent_default();
            act(workbench);
        }
    });
    on_cleanup(move || listener.remove());
}

fn is_pressed(keys: Keys, event: &KeyboardEvent) -> bool {
    event.key().to_lowercase() == keys.key
        && (event.ctrl_key() || event.meta_key()) == keys.control
        && keys.shift.is_none_or(|shift| event.shift_key() == shift)
}

/// What is typed into a field is no shortcut.
fn is_typing(event: &KeyboardEvent) -> bool {
    let target = event.target().and_then(|t| t.dyn_into::<Element>().ok());
    target.is_some_and(|target| match target.tag_name().as_str() {
        "INPUT" => {
            let kind = target
                .dyn_ref::<HtmlInputElement>()
                .map(HtmlInputElement::type_);
            !matches!(kind.as_deref(), Some("checkbox" | "range"))
        }
        "SELECT" => !event.ctrl_key() && !event.meta_key(),
        "TEXTAREA" => true,
        _ => false,
    })
}

/// The sheet of all keys.
#[component]
pub(crate) fn HelpSheet() -> impl IntoView {
    let workbench = Workbench::get();
    let sheet = NodeRef::<html::Dialog>::new();
    Effect::new(move |_| {
        let (Some(sheet), shown) = (sheet.get(), workbench.help.get()) else {
            return;
        };
        if shown && !sheet.open() {
            let _ = sheet.show_modal();
        } else if !shown && sheet.open() {
            sheet.close();
        }
    });
    let row = |shortcut: &Shortcut| {
        view! {
            <tr>
                <td>{shortcut.place}</td>
                <th scope="row">
                    <kbd>{shortcut.keys}</kbd>
                </th>
                <td>{shortcut.what}</td>
            </tr>
        }
    };
    view! {
        <dialog
            class="help-sheet"
            data-testid="help"
            aria-labelledby="help-title"
            node_ref=sheet
            on:close=move |_| workbench.help.set(false)
        >
            <div class="panel-head">
                <h2 id="help-title">"Keys and gestures"</h2>
                <button type="button" class="quiet" on:click=move |_| workbench.help.set(false)>
                    "Close"
                </button>
            </div>
            <table>
                <tbody>{SHORTCUTS.iter().map(row).collect_view()}</tbody>
            </table>
        </dialog>
    }
}
