//! Which of many equal parts of a scrolled frame are in sight. Only those are made: ten thousand rows, or
//! pictures, would take the browser seconds.

use std::ops::Range;

use leptos::ev;
use leptos::html;
use leptos::prelude::*;

/// What is seen of a frame. A handle: copies mean the same frame.
#[derive(Clone, Copy)]
pub(crate) struct Sight {
    /// The frame that is scrolled.
    pub(crate) frame: NodeRef<html::Div>,
    /// From one part to the next, CSS px.
    pitch: i32,
    /// How far it is scrolled, CSS px.
    scrolled: RwSignal<i32>,
    /// How much of it is seen, CSS px.
    seen: RwSignal<i32>,
}

impl Sight {
    pub(crate) fn new(pitch: i32) -> Self {
        let sight = Self {
            frame: NodeRef::new(),
            pitch: pitch.max(1),
            scrolled: RwSignal::new(0),
            seen: RwSignal::new(0),
        };
        Effect::new(move |_| {
            sight.frame.track();
            sight.look();
        });
        let resized = window_event_listener(ev::resize, move |_| sight.look());
        on_cleanup(move || resized.remove());
        sight
    }

    /// Sees where the frame is now.
    pub(crate) fn look(self) {
        let Some(frame) = self.frame.get_untracked() else {
            return;
        };
        self.scrolled.set(frame.scroll_top());
        self.seen.set(frame.client_height());
    }

    /// The parts in sight of so many, and some on both sides: scrolling a little makes no new ones.
    pub(crate) fn parts(self, count: usize) -> Range<usize> {
        const BESIDE: i32 = 8;
        let (scrolled, seen) = (self.scrolled.get(), self.seen.get());
        let first = scrolled / self.pitch;
        let last = (scrolled + seen) / self.pitch;
        let from = (first / BESIDE - 1).max(0) * BESIDE;
        let to = (last / BESIDE + 2) * BESIDE;
        (from as usize).min(count)..(to as usize).min(count)
    }

    /// Whether anything of it is seen: a frame that is folded away has no height.
    pub(crate) fn is_open(self) -> bool {
        self.seen.get() > 0
    }

    /// How long so many parts are, CSS px.
    pub(crate) fn length(self, count: usize) -> String {
        format!("{}px", self.pitch as usize * count)
    }

    /// Scrolls the frame, and never the page, until a part is in sight; `covered` px at its start are not
    /// to be seen.
    pub(crate) fn reveal(self, part: usize, covered: i32) {
        let Some(frame) = self.frame.get_untracked() else {
            return;
        };
        self.look();
        let start = part as i32 * self.pitch;
        let end = start + self.pitch + covered;
        let (scrolled, seen) = (self.scrolled.get_untracked(), self.seen.get_untracked());
        let wanted = if start < scrolled {
            start
        } else if end > scrolled + seen {
            end - seen
        } else {
            return;
        };
        frame.set_scroll_top(wanted);
        self.look();
    }
}

/// The size of the page's letters, CSS px: what is counted in `rem` follows it.
pub(crate) fn letter() -> f64 {
    const USUAL: f64 = 16.0;
    let style = document().document_element().and_then(|root| {
        let window = web_sys::window()?;
        window.get_computed_style(&root).ok().flatten()
    });
    let size = style.and_then(|style| style.get_property_value("font-size").ok());
    size.and_then(|size| size.strip_suffix("px")?.parse().ok())
        .unwrap_or(USUAL)
}
