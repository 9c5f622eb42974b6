//! What the lab knows, and how it keeps to the address.

use std::time::Duration;

use leptos::ev;
use leptos::prelude::*;
use snellius::lab::{Bench, Lesson, Light, link};
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::spawn_local;

use crate::clipboard::write_to_clipboard;

/// The lab's state; copies mean the same one.
#[derive(Clone, Copy)]
pub(super) struct LabState {
    /// Whether the address means the lab.
    pub(super) open: RwSignal<bool>,
    pub(super) bench: RwSignal<Bench>,
    /// The bench's light.
    pub(super) light: Memo<Light>,
    /// The address as it was read or written last.
    known: StoredValue<String>,
    /// What was wrong with the link.
    pub(super) trouble: RwSignal<Option<String>>,
    /// Whether the page stands in a frame of another one.
    pub(super) embedded: bool,
}

impl LabState {
    pub(super) fn get() -> Self {
        expect_context()
    }

    /// Reads the address, and follows it from then on.
    pub(super) fn new() -> Self {
        let bench = RwSignal::new(Bench::default());
        let lab = Self {
            open: RwSignal::new(false),
            bench,
            light: Memo::new(move |_| bench.with(Light::of)),
            known: StoredValue::new(String::new()),
            trouble: RwSignal::new(None),
            embedded: is_embedded(),
        };
        lab.read_address();
        let listener = window_event_listener(ev::hashchange, move |_| lab.read_address());
        on_cleanup(move || listener.remove());
        Effect::new(move |_| mark_root(super::OPEN, lab.open.get()));
        mark_root("data-embed", lab.embedded);
        lab.keep_address();
        lab
    }

    /// Sets the bench as the address says.
    fn read_address(self) {
        let fragment = fragment();
        let open = link::is_lab(&fragment);
        if open {
            match link::read(&fragment) {
                Ok(bench) => {
                    self.trouble.set(None);
                    self.bench.set(bench);
                }
                Err(error) => {
                    self.trouble.set(Some(error.to_string()));
                    self.bench.set(Bench::default());
                }
            }
        }
        self.open.set(open);
        self.known.set_value(fragment);
    }

    /// Lets the address follow the bench. Browsers count such changes and refuse too many: a drag
    /// changes the address once it rests.
    fn keep_address(self) {
        const REST: Duration = Duration::from_millis(200);
        let mut write = debounce(REST, move |bench: Bench| {
            // By now the address may have left the lab, or a link that was just clicked has changed it and
            // is about to be read: neither must be written over.
            let now = fragment();
            if link::is_lab(&now) && self.known.with_value(|known| *known == now) {
                replace_fragment(&link::write(&bench));
                self.known.set_value(fragment());
            }
        });
        Effect::new(move |_| {
            let (bench, open) = (self.bench.get(), self.open.get());
            if open && self.trouble.with(Option::is_none) {
                write(bench);
            }
        });
    }

    /// Changes the bench, by hand.
    pub(super) fn change(self, change: impl FnOnce(&mut Bench)) {
        self.trouble.set(None);
        self.bench.update(change);
    }

    /// The bench as it was at first: at the lesson's beginning, or with nothing set.
    pub(super) fn reset(self) {
        let (view, lesson) = self
            .bench
            .with_untracked(|bench| (bench.view, bench.lesson));
        let first = || Bench {
            view,
            ..Bench::default()
        };
        let bench = lesson.and_then(Lesson::bench).unwrap_or_else(first);
        self.trouble.set(None);
        self.bench.set(bench);
    }

    /// Puts a link to the bench on the clipboard, and says whether that was allowed.
    pub(super) fn copy_link(self, said: RwSignal<String>) {
        let address = page_address(&link::write(&self.bench.get_untracked()));
        spawn_local(async move {
            said.set(match write_to_clipboard(&address).await {
                Some(()) => "Link copied".to_owned(),
                None => format!("The browser forbids copying. The link is {address}"),
            });
        });
    }
}

/// What stands behind the `#` of the address.
fn fragment() -> String {
    let hash = window().location().hash().unwrap_or_default();
    hash.strip_prefix('#').unwrap_or(&hash).to_owned()
}

fn is_embedded() -> bool {
    let search = window().location().search().unwrap_or_default();
    let search = search.strip_prefix('?').unwrap_or(&search);
    search
        .split('&')
        .any(|part| part == "embed" || part.starts_with("embed="))
}

/// The page's address with another fragment, outside any frame.
pub(super) fn page_address(fragment: &str) -> String {
    let href = window().location().href().unwrap_or_default();
    let page = href.split(['#', '?']).next().unwrap_or_default();
    format!("{page}#{fragment}")
}

fn replace_fragment(fragment: &str) {
    let search = window().location().search().unwrap_or_default();
    let path = window().location().pathname().unwrap_or_default();
    if let Ok(history) = window().history() {
        let address = format!("{path}{search}#{fragment}");
        // Too many changes at once are refused; the next rest makes up for it.
        let _ = history.replace_state_with_url(&JsValue::NULL, "", Some(&address));
    }
}

fn mark_root(name: &str, marked: bool) {
    if let Some(root) = document().document_element() {
        let _ = root.toggle_attribute_with_force(name, marked);
    }
}

pub(super) fn has_mark(name: &str) -> bool {
    let root = document().document_element();
    root.is_some_and(|root| root.has_attribute(name))
}

/// The lab fills the screen, or does no longer.
pub(super) fn toggle_full_screen() {
    let document = document();
    if document.fullscreen_element().is_some() {
        document.exit_fullscreen();
    } else if let Some(lab) = document.get_element_by_id("lab") {
        // Telephones may know no full screen; then nothing happens.
        let _ = lab.request_fullscreen();
    }
}
