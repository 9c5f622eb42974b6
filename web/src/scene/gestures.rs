//! Hands on the scene: left drag turns, right or Shift+left drag shifts, the wheel comes nearer; one
//! finger turns, two shift and pinch. A drag under 4 px is a click.

use std::cell::RefCell;
use std::collections::BTreeMap;

use three_d::{InnerSpace, Vec2};
use web_sys::{HtmlCanvasElement, KeyboardEvent, MouseEvent, PointerEvent, WheelEvent};

use super::stage::Stage;

/// A drag shorter than this (CSS px) is a click.
const CLICK: f32 = 4.0;

/// What a gesture was, in the end.
pub(super) enum Ended {
    /// A click, and where (CSS px).
    Click(Vec2),
    /// A box around points: two corners.
    Frame([Vec2; 2]),
}

/// What the pointers on the canvas do.
#[derive(Default)]
pub(super) struct Gestures {
    pointers: RefCell<BTreeMap<i32, Pointer>>,
}

#[derive(Clone, Copy)]
struct Pointer {
    start: Vec2,
    now: Vec2,
    shifts: bool,
    /// It draws a box around points.
    frames: bool,
    /// It has gone too far, or in too much company, to be a click.
    is_drag: bool,
}

impl Gestures {
    pub(super) fn down(&self, canvas: &HtmlCanvasElement, event: &PointerEvent) {
        let _ = canvas.set_pointer_capture(event.pointer_id());
        let at = place(event);
        let pointer = Pointer {
            start: at,
            now: at,
            shifts: event.button() == 2 || event.shift_key(),
            frames: event.ctrl_key() || event.meta_key(),
            is_drag: false,
        };
        let mut pointers = self.pointers.borrow_mut();
        pointers.insert(event.pointer_id(), pointer);
        if pointers.len() > 1 {
            pointers
                .values_mut()
                .for_each(|pointer| pointer.is_drag = true);
        }
    }

    pub(super) fn moved(&self, stage: &Stage, event: &PointerEvent) {
        let mut pointers = self.pointers.borrow_mut();
        let before: Vec<Vec2> = pointers.values().map(|pointer| pointer.now).collect();
        let Some(pointer) = pointers.get_mut(&event.pointer_id()) else {
            return;
        };
        pointer.now = place(event);
        pointer.is_drag |= (pointer.now - pointer.start).magnitude() >= CLICK;
        if pointer.frames {
            return;
        }
        let (is_drag, shifts) = (pointer.is_drag, pointer.shifts);
        let after: Vec<Vec2> = pointers.values().map(|pointer| pointer.now).collect();
        let picture = stage.css_size();
        match (before.as_slice(), after.as_slice()) {
            ([from], [to]) if is_drag && shifts => stage.turn(|o| o.pan(to - from, picture)),
            ([from], [to]) if is_drag => stage.turn(|o| o.turn(to - from, picture)),
            ([a, b], [c, d]) => stage.turn(|orbit| {
                orbit.pan((c + d - a - b) * 0.5, picture);
                let ratio = (b - a).magnitude() / (d - c).magnitude().max(1.0);
                orbit.zoom(ratio, (c + d) * 0.5 - picture * 0.5, picture);
            }),
            _ => {}
        }
    }

    /// The box that is being drawn around points, if one is: two corners.
    pub(super) fn frame(&self) -> Option<[Vec2; 2]> {
        let pointers = self.pointers.borrow();
        let pointer = pointers.values().find(|p| p.frames && p.is_drag)?;
        Some([pointer.start, pointer.now])
    }

    /// Ends a gesture.
    pub(super) fn up(&self, event: &PointerEvent) -> Option<Ended> {
        let pointer = self.pointers.borrow_mut().remove(&event.pointer_id())?;
        match (pointer.is_drag, pointer.frames) {
            (true, true) => Some(Ended::Frame([pointer.start, pointer.now])),
            (false, _) if event.button() == 0 => Some(Ended::Click(pointer.now)),
            _ => None,
        }
    }

    pub(super) fn lost(&self, event: &PointerEvent) {
        self.pointers.borrow_mut().remove(&event.pointer_id());
    }

    pub(super) fn wheel(&self, stage: &Stage, event: &WheelEvent) {
        event.prevent_default();
        // Wheels count in pixels, lines or pages.
        let unit = [1.0, 30.0, 300.0][event.delta_mode().min(2) as usize];
        let turned = (event.delta_y() * unit).clamp(-300.0, 300.0) as f32;
        let picture = stage.css_size();
        let at = Vec2::new(event.offset_x() as f32, event.offset_y() as f32);
        stage.turn(|orbit| orbit.zoom((turned * 0.0015).exp(), at - picture * 0.5, picture));
    }
}

/// The same by keys, for the canvas in focus.
pub(super) fn keys(stage: &Stage, event: &KeyboardEvent) {
    const STEP: f32 = 24.0;
    const RATIO: f32 = 0.85;
    let picture = stage.css_size();
    let middle = Vec2::new(0.0, 0.0);
    let drag = match event.key().as_str() {
        "ArrowLeft" => Vec2::new(-STEP, 0.0),
        "ArrowRight" => Vec2::new(STEP, 0.0),
        "ArrowUp" => Vec2::new(0.0, -STEP),
        "ArrowDown" => Vec2::new(0.0, STEP),
        "+" | "=" => return stage.turn(|orbit| orbit.zoom(RATIO, middle, picture)),
        "-" => return stage.turn(|orbit| orbit.zoom(1.0 / RATIO, middle, picture)),
        _ => return,
    };
    event.prevent_default();
    stage.turn(|orbit| {
        if event.shift_key() {
            orbit.pan(drag, picture);
        } else {
            orbit.turn(drag, picture);
        }
    });
}

/// Where on the canvas (CSS px).
pub(super) fn place(event: &MouseEvent) -> Vec2 {
    Vec2::new(event.offset_x() as f32, event.offset_y() as f32)
}
