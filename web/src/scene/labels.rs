//! Words in the scene: elements of the page that follow their places, so they are sharp at every size.

use std::cell::RefCell;

use three_d::{Mat4, Vec2, Vec3};
use wasm_bindgen::JsCast;
use web_sys::HtmlElement;

/// A word and where it stands.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Label {
    pub(super) place: Vec3,
    pub(super) text: String,
}

/// The labels of a scene.
pub(super) struct Labels {
    parent: HtmlElement,
    shown: RefCell<Vec<(Vec3, HtmlElement)>>,
}

impl Labels {
    pub(super) fn new(parent: HtmlElement) -> Self {
        Self {
            parent,
            shown: RefCell::default(),
        }
    }

    pub(super) fn fill(&self, labels: Vec<Label>) {
        self.parent.set_inner_html("");
        let document = self.parent.owner_document();
        let make = |label: Label| {
            let element = document.as_ref()?.create_element("span").ok()?;
            element.set_text_content(Some(&label.text));
            self.parent.append_child(&element).ok()?;
            Some((label.place, element.dyn_into().ok()?))
        };
        self.shown
            .replace(labels.into_iter().filter_map(make).collect());
    }

    /// Puts every label where its place is in the picture (CSS px).
    pub(super) fn place(&self, world_to_clip: Mat4, picture: Vec2) {
        for (place, element) in &*self.shown.borrow() {
            let clip = world_to_clip * place.extend(1.0);
            let x = (clip.x / clip.w * 0.5 + 0.5) * picture.x;
            let y = (0.5 - clip.y / clip.w * 0.5) * picture.y;
            let transform = if clip.w > 0.0 {
                format!("translate({x:.1}px, {y:.1}px) translate(-50%, -50%)")
            } else {
                "translate(-9999px, 0)".to_owned()
            };
            let _ = element.style().set_property("transform", &transform);
        }
    }
}
