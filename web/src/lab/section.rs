//! The bench from above: wall, light and what can be dragged.

use leptos::html;
use leptos::prelude::*;
use snellius::geometry::{Point, World};
use snellius::lab::{Bench, End, Light, LightPath, WallShape, quantity};
use wasm_bindgen::JsCast;
use web_sys::{Element, KeyboardEvent, PointerEvent};

use super::bench::watch_size;
use super::drawing::{At, Drawing, degrees};
use super::state::LabState;
use crate::number::fixed;

/// How the bench's millimetres lie in the picture: z to the right, x downwards.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Frame {
    /// px per mm.
    scale: f64,
    /// Where x = z = 0 is.
    origin: At,
    size: At,
}

impl Frame {
    /// Shows the rig and the vessel as large as they fit.
    fn of(bench: &Bench, size: At) -> Self {
        let rig = [bench.laser, bench.camera].map(|place| bench.on_rig(place).coords);
        let depth = match bench.wall {
            WallShape::Plane => 190.0_f64.max(bench.object[1] + 20.0),
            _ => 2.0 * bench.radius + 18.0,
        };
        let half_vessel = match bench.wall {
            WallShape::Plane => 0.0,
            _ => bench.radius + 12.0,
        };
        // A laser on a small picture is as large as on a large one.
        let margin = if size[0] < 520.0 { 62.0 } else { 30.0 };
        let front = rig.iter().fold(-200.0_f64, |low, p| low.min(p.z - margin));
        let half = rig.iter().fold(120.0_f64.max(half_vessel), |most, p| {
            most.max(p.x.abs() + 24.0)
        });
        let scale = (size[0] / (depth - front)).min(size[1] / (2.0 * half));
        let spare = size[0] - scale * (depth - front);
        Self {
            scale,
            origin: [0.5 * spare - front * scale, 0.5 * size[1]],
            size,
        }
    }

    fn place(&self, x: f64, z: f64) -> At {
        [
            self.origin[0] + z * self.scale,
            self.origin[1] + x * self.scale,
        ]
    }

    fn point(&self, point: Point<World>) -> At {
        self.place(point.coords.x, point.coords.z)
    }

    /// x and z of a place in the picture.
    fn back(&self, [right, down]: At) -> [f64; 2] {
        [
            (down - self.origin[1]) / self.scale,
            (right - self.origin[0]) / self.scale,
        ]
    }
}

/// What can be dragged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Handle {
    Laser,
    Camera,
    Object,
}

impl Handle {
    const ALL: [(Self, &'static str, &'static str); 3] = [
        (Self::Laser, "Laser", "handle-laser"),
        (Self::Camera, "Camera", "handle-camera"),
        (Self::Object, "Object point", "handle-object"),
    ];

    /// Keys of its x and its z.
    const fn keys(self) -> [&'static str; 2] {
        match self {
            Self::Laser => ["lx", "lz"],
            Self::Camera => ["cx", "cz"],
            Self::Object => ["ox", "oz"],
        }
    }

    /// Its x and z as the bench keeps them.
    const fn kept(self, bench: &Bench) -> [f64; 2] {
        match self {
            Self::Laser => bench.laser,
            Self::Camera => bench.camera,
            Self::Object => bench.object,
        }
    }

    /// Where it is seen from above.
    fn seen(self, bench: &Bench) -> [f64; 2] {
        match self {
            Self::Object => bench.object,
            on_rig => {
                let place = bench.on_rig(on_rig.kept(bench)).coords;
                [place.x, place.z]
            }
        }
    }

    fn put(self, bench: &mut Bench, place: [f64; 2]) {
        for (key, value) in self.keys().into_iter().zip(place) {
            if let Some(quantity) = quantity(key) {
                quantity.set(bench, value);
            }
        }
    }

    /// Puts it where the pointer is.
    fn put_from_above(self, bench: &mut Bench, [x, z]: [f64; 2]) {
        let place = match self {
            Self::Object => [x, z],
            _ => bench.from_above(x, z),
        };
        self.put(bench, place);
    }
}

/// The bench from above.
#[component]
pub(super) fn Section() -> impl IntoView {
    let lab = LabState::get();
    let picture = NodeRef::<html::Div>::new();
    let size = RwSignal::new([720.0, 420.0]);
    Effect::new(move |_| {
        if let Some(picture) = picture.get() {
            watch_size(&picture, size);
        }
    });
    let frame = Memo::new(move |_| lab.bench.with(|bench| Frame::of(bench, size.get())));
    let drawn = move || {
        lab.bench
            .with(|bench| lab.light.with(|light| draw(bench, light, frame.get())))
    };
    let handles = Handle::ALL.map(|(handle, name, id)| {
        view! { <HandleMark handle name id frame picture /> }
    });
    let pitched = move || lab.bench.with(|bench| bench.pitch != 0.0);
    view! {
        <div class="section-picture" node_ref=picture>
            <svg
                class="lab-svg"
                viewBox=move || format!("0 0 {} {}", size.get()[0], size.get()[1])
                role="group"
                aria-label="The bench from above"
            >
                <g inner_html=drawn aria-hidden="true"></g>
                {handles}
            </svg>
            <p class="picture-note">
                {move || {
                    if pitched() {
                        "From above. The rig is pitched: the rays leave the picture's plane."
                    } else {
                        "From above. Drag laser, camera and point."
                    }
                }}
            </p>
        </div>
    }
}

#[component]
fn HandleMark(
    handle: Handle,
    name: &'static str,
    id: &'static str,
    frame: Memo<Frame>,
    picture: NodeRef<html::Div>,
) -> impl IntoView {
    let lab = LabState::get();
    let held = RwSignal::new(false);
    let place = Memo::new(move |_| {
        let [x, z] = lab.bench.with(|bench| handle.seen(bench));
        frame.get().place(x, z)
    });
    let turned = move || match handle {
        Handle::Object => 0.0,
        Handle::Camera => lab.bench.with(|bench| -bench.turn),
        Handle::Laser => lab.light.with(|light| {
            let aim = light.beam.start.direction.vector();
            aim.x.atan2(aim.z).to_degrees()
        }),
    };
    let words = move || {
        let [x, z] = lab.bench.with(|bench| handle.kept(bench));
        format!(
            "{name}: {} mm to the right, {} mm into the vessel. Arrow keys move it.",
            fixed(x, 1),
            fixed(z, 1)
        )
    };
    let take = move |event: PointerEvent| {
        if event.button() != 0 {
            return;
        }
        held.set(true);
        if let Some(mark) = event.current_target() {
            let mark: Element = mark.unchecked_into();
            let _ = mark.set_pointer_capture(event.pointer_id());
        }
    };
    let drag = move |event: PointerEvent| {
        let Some(picture) = picture.get_untracked().filter(|_| held.get_untracked()) else {
            return;
        };
        let corner = picture.get_bounding_client_rect();
        let at = [
            f64::from(event.client_x()) - corner.left(),
            f64::from(event.client_y()) - corner.top(),
        ];
        let place = frame.get_untracked().back(at);
        lab.change(|bench| handle.put_from_above(bench, place));
    };
    let key = move |event: KeyboardEvent| {
        let step = if event.shift_key() { 10.0 } else { 1.0 };
        let [x, z] = match event.key().as_str() {
            "ArrowLeft" => [0.0, -step],
            "ArrowRight" => [0.0, step],
            "ArrowUp" => [-step, 0.0],
            "ArrowDown" => [step, 0.0],
            _ => return,
        };
        event.prevent_default();
        lab.change(|bench| {
            let [old_x, old_z] = handle.kept(bench);
            handle.put(bench, [old_x + x, old_z + z]);
        });
    };
    let shape = match handle {
        Handle::Laser => {
            r#"<rect class="body" x="-26" y="-8" width="30" height="16" rx="3"/><rect class="mouth" x="4" y="-4" width="5" height="8"/>"#
        }
        Handle::Camera => {
            r#"<rect class="body" x="-26" y="-12" width="22" height="24" rx="3"/><path class="body" d="M-4 -5L5 -10V10L-4 5Z"/>"#
        }
        Handle::Object => r#"<circle class="spot" r="6.5"/>"#,
    };
    view! {
        <g
            class="handle"
            class:held=move || held.get()
            class:aside=move || handle == Handle::Object && lab.bench.with(|bench| bench.aim.is_some())
            tabindex="0"
            role="button"
            aria-roledescription="movable"
            aria-label=words
            data-testid=id
            transform=move || {
                let [x, y] = place.get();
                format!("translate({x:.1} {y:.1}) rotate({:.2})", turned())
            }
            on:pointerdown=take
            on:pointermove=drag
            on:pointerup=move |_| held.set(false)
            on:pointercancel=move |_| held.set(false)
            on:keydown=key
        >
            <circle class="reach" r="22" />
            <g inner_html=shape></g>
        </g>
    }
}

/// How a line of sight is drawn, and where it ends: faint, if there is no spot to be seen along it.
pub(super) fn sight_class(light: &Light) -> (&'static str, Option<Point<World>>) {
    match light.spot {
        Some(spot) if light.measurement.is_ok() => ("sight", Some(spot)),
        _ => ("sight idle", None),
    }
}

/// All that cannot be dragged.
fn draw(bench: &Bench, light: &Light, frame: Frame) -> String {
    let mut drawing = Drawing::default();
    vessel(&mut drawing, bench, frame);
    names(&mut drawing, bench, frame);
    virtual_rays(&mut drawing, light, frame);
    let spot = light.spot;
    rays(&mut drawing, "beam", &light.beam, spot, frame, true);
    let (class, seen) = sight_class(light);
    rays(&mut drawing, class, &light.sight, seen, frame, false);
    for path in [&light.beam, &light.sight] {
        if frame.size[0] > 520.0 {
            angles(&mut drawing, path, frame);
        }
    }
    points(&mut drawing, bench, light, frame);
    drawing.text_of()
}

fn vessel(drawing: &mut Drawing, bench: &Bench, frame: Frame) {
    let [width, height] = frame.size;
    let centre = frame.place(0.0, bench.radius);
    match bench.wall {
        WallShape::Plane => {
            let front = frame.place(0.0, 0.0)[0];
            let back = frame.place(0.0, bench.thickness)[0];
            drawing.rect("liquid", [back, 0.0], [width - back, height]);
            drawing.rect("glass", [front, 0.0], [back - front, height]);
            drawing.line("face", [front, 0.0], [front, height]);
            drawing.line("face", [back, 0.0], [back, height]);
        }
        WallShape::Cylinder | WallShape::Sphere => {
            let outer = bench.radius * frame.scale;
            let inner = (bench.radius - bench.thickness) * frame.scale;
            drawing.circle("glass face", centre, outer);
            drawing.circle("ground", centre, inner);
            drawing.circle("liquid face", centre, inner);
        }
    }
}

fn names(drawing: &mut Drawing, bench: &Bench, frame: Frame) {
    let named = |medium: snellius::lab::Medium| {
        if medium.is_mystery() {
            format!("{}: n = ?", medium.name())
        } else {
            format!(
                "{}: n = {:.4}",
                medium.name().split(" (").next().unwrap_or_default(),
                medium.index()
            )
        }
    };
    let [width, height] = frame.size;
    drawing.text("medium", [12.0, height - 12.0], &named(bench.outside));
    drawing.text(
        "medium end",
        [width - 12.0, height - 12.0],
        &named(bench.liquid),
    );
    let wall = frame.place(0.0, 0.0)[0];
    // Between the two others, where there is room.
    if wall > 330.0 {
        drawing.text(
            "medium end",
            [wall - 10.0, height - 12.0],
            &named(bench.glass),
        );
    }
}

/// Where the straight continuations of both rays would meet.
fn virtual_rays(drawing: &mut Drawing, light: &Light, frame: Frame) {
    let apparent = light.measurement.as_ref().ok().and_then(|m| m.apparent);
    let Some(apparent) = apparent else { return };
    for path in [&light.beam, &light.sight] {
        if let Some(bend) = path.bends.first() {
            drawing.line("virtual", frame.point(bend.at), frame.point(apparent));
        }
    }
}

/// A path's pieces. A beam's light goes outwards; that of a line of sight comes back along it.
fn rays(
    drawing: &mut Drawing,
    class: &str,
    path: &LightPath,
    end: Option<Point<World>>,
    frame: Frame,
    outwards: bool,
) {
    const FAR: f64 = 2000.0;
    let mut places = vec![frame.point(path.start.origin)];
    places.extend(path.bends.iter().map(|bend| frame.point(bend.at)));
    let last = frame.point(
        end.filter(|_| path.is_inside())
            .unwrap_or_else(|| path.last().at(FAR)),
    );
    let thrown_back = matches!(path.end, End::ThrownBack { .. });
    for pair in places.windows(2) {
        let [from, to] = if outwards {
            [pair[0], pair[1]]
        } else {
            [pair[1], pair[0]]
        };
        drawing.ray(class, from, to);
    }
    let Some(&from) = places.last() else { return };
    let dashed = format!("{class} {}", if thrown_back { "thrown-back" } else { "" });
    if end.is_some() && path.is_inside() {
        let [from, to] = if outwards { [from, last] } else { [last, from] };
        drawing.ray(class, from, to);
    } else {
        drawing.line(&dashed, from, last);
        // Near the bend, where it is in the picture.
        let share = 90.0 / (FAR * frame.scale);
        drawing.arrowhead(class, from, last, share);
    }
}

/// The normal at the wall, and the angles before it and behind it.
fn angles(drawing: &mut Drawing, path: &LightPath, frame: Frame) {
    const NORMAL: f64 = 62.0;
    let unit = |x: f64, z: f64| {
        let length = x.hypot(z).max(1e-9);
        [z / length, x / length]
    };
    let (Some(first), Some(last)) = (path.bends.first(), path.bends.last()) else {
        return;
    };
    let along = |at: At, way: At, length: f64| [at[0] + way[0] * length, at[1] + way[1] * length];
    let normal = |bend: &snellius::lab::Bend| {
        let n = bend.normal.vector();
        unit(n.x, n.z)
    };
    let outside = normal(first);
    let corner = frame.point(first.at);
    drawing.line("normal", corner, along(corner, outside, NORMAL));
    let came = first.before.vector();
    let text = degrees(first.angle_before());
    drawing.angle(corner, outside, unit(-came.x, -came.z), 40.0, &text);
    if path.is_inside() {
        let corner = frame.point(last.at);
        let inwards = normal(last).map(|part| -part);
        drawing.line("normal", corner, along(corner, inwards, NORMAL));
        let goes = last.after.vector();
        let text = degrees(last.angle_after());
        drawing.angle(corner, inwards, unit(goes.x, goes.z), 40.0, &text);
    }
}

fn points(drawing: &mut Drawing, bench: &Bench, light: &Light, frame: Frame) {
    let Ok(measurement) = &light.measurement else {
        return;
    };
    // To the right of a place or, where that is too narrow, at the picture's edge and lower.
    let label = |drawing: &mut Drawing, class: &str, [x, y]: At, down: f64, text: &str| {
        let width = 7.0 * text.chars().count() as f64;
        if x + 12.0 + width > frame.size[0] {
            let at = [frame.size[0] - 8.0, y + down + 20.0_f64.copysign(down)];
            drawing.text(&format!("{class} end"), at, text);
        } else {
            drawing.text(class, [x + 12.0, y + down], text);
        }
    };
    if let Some(apparent) = measurement.apparent {
        let at = frame.point(apparent);
        drawing.circle("apparent", at, 5.5);
        label(drawing, "label", at, -12.0, "apparent point");
    }
    let distance = format!("l = {:.2} mm", measurement.meeting.gap().abs());
    if bench.assumed.is_some() {
        let approach = measurement.meeting.approach;
        drawing.line(
            "gap",
            frame.point(approach.first),
            frame.point(approach.second),
        );
        let at = frame.point(measurement.meeting.point());
        let corners = [[0.0, -7.0], [7.0, 0.0], [0.0, 7.0], [-7.0, 0.0]];
        drawing.path(
            "measured",
            &corners.map(|[x, y]| [at[0] + x, at[1] + y]),
            true,
        );
        label(drawing, "label", at, 5.0, &format!("measured, {distance}"));
    }
    if let Some(spot) = light.spot {
        let at = frame.point(spot);
        if bench.aim.is_some() {
            drawing.circle("lit", at, 5.5);
        }
        if bench.assumed.is_none() {
            label(drawing, "label strong", at, 5.0, &format!("P, {distance}"));
        } else {
            // What is measured may lie close by, along the light.
            drawing.text("label strong middle", [at[0], at[1] + 26.0], "P");
        }
    }
}
