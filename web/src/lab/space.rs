//! The bench in space: the same light, seen from anywhere.

use leptos::html;
use leptos::prelude::*;
use nalgebra::{UnitQuaternion, Vector3};
use snellius::geometry::{Point, World};
use snellius::lab::{Bench, Light, LightPath, WallShape, quantity};
use web_sys::{KeyboardEvent, PointerEvent};

use super::bench::watch_size;
use super::drawing::{At, Drawing};
use super::section::sight_class;
use super::state::LabState;

/// The view in space.
#[component]
pub(super) fn Space() -> impl IntoView {
    let lab = LabState::get();
    let picture = NodeRef::<html::Div>::new();
    let size = RwSignal::new([720.0, 420.0]);
    Effect::new(move |_| {
        if let Some(picture) = picture.get() {
            watch_size(&picture, size);
        }
    });
    let drawn = move || {
        lab.bench
            .with(|bench| lab.light.with(|light| draw(bench, light, size.get())))
    };
    let held = RwSignal::new(None::<At>);
    let at = |event: &PointerEvent| [f64::from(event.client_x()), f64::from(event.client_y())];
    let take = move |event: PointerEvent| {
        held.set(Some(at(&event)));
        if let Some(picture) = picture.get_untracked() {
            let _ = picture.set_pointer_capture(event.pointer_id());
        }
    };
    let drag = move |event: PointerEvent| {
        let (Some(before), now) = (held.get_untracked(), at(&event)) else {
            return;
        };
        held.set(Some(now));
        let per_px = 180.0 / size.get_untracked()[1].max(200.0);
        orbit(
            lab,
            (before[0] - now[0]) * per_px,
            (now[1] - before[1]) * per_px,
        );
    };
    let key = move |event: KeyboardEvent| {
        let [round, above] = match event.key().as_str() {
            "ArrowLeft" => [-5.0, 0.0],
            "ArrowRight" => [5.0, 0.0],
            "ArrowUp" => [0.0, 5.0],
            "ArrowDown" => [0.0, -5.0],
            _ => return,
        };
        event.prevent_default();
        orbit(lab, round, above);
    };
    view! {
        <div
            class="space-picture"
            node_ref=picture
            tabindex="0"
            role="application"
            aria-label="The bench in space. Arrow keys turn the view."
            data-testid="space"
            on:pointerdown=take
            on:pointermove=drag
            on:pointerup=move |_| held.set(None)
            on:pointercancel=move |_| held.set(None)
            on:keydown=key
        >
            <svg
                class="lab-svg"
                viewBox=move || format!("0 0 {} {}", size.get()[0], size.get()[1])
                aria-hidden="true"
            >
                <g inner_html=drawn></g>
            </svg>
            <p class="picture-note">"In space. Drag to turn."</p>
        </div>
    }
}

fn orbit(lab: LabState, round: f64, above: f64) {
    lab.change(|bench| {
        let whole_turn = |degrees: f64| (degrees + 540.0).rem_euclid(360.0) - 180.0;
        let (round, above) = (
            whole_turn(bench.space_round + round),
            bench.space_above + above,
        );
        for (key, value) in [("az", round), ("el", above)] {
            if let Some(quantity) = quantity(key) {
                quantity.set(bench, value);
            }
        }
    });
}

/// An eye that looks at the bench.
struct Eye {
    /// The eye's directions from the world's.
    rotation: UnitQuaternion<f64>,
    pivot: Vector3<f64>,
    distance: f64,
    focal: f64,
    centre: At,
}

impl Eye {
    fn of(bench: &Bench, size: At) -> Self {
        let about = |axis: Vector3<f64>, degrees: f64| {
            UnitQuaternion::from_scaled_axis(axis * degrees.to_radians())
        };
        // At 0 it looks along the light, over the rig's shoulder.
        let world_from_eye =
            about(Vector3::y(), -bench.space_round) * about(Vector3::x(), -bench.space_above);
        Self {
            rotation: world_from_eye.inverse(),
            pivot: Vector3::new(0.0, 0.0, 0.0),
            distance: 760.0,
            focal: 2.0 * size[1].min(size[0] * 0.85),
            centre: [0.5 * size[0], 0.5 * size[1]],
        }
    }

    fn see(&self, place: Vector3<f64>) -> At {
        let local = self.rotation * (place - self.pivot);
        let scale = self.focal / (local.z + self.distance).max(40.0);
        [
            self.centre[0] + local.x * scale,
            self.centre[1] + local.y * scale,
        ]
    }

    fn point(&self, point: Point<World>) -> At {
        self.see(point.coords)
    }
}

/// Half the height of what is drawn of a vessel, and where its floor is, mm.
const HALF_HEIGHT: f64 = 90.0;

fn draw(bench: &Bench, light: &Light, size: At) -> String {
    let eye = Eye::of(bench, size);
    let mut drawing = Drawing::default();
    floor(&mut drawing, &eye);
    vessel(&mut drawing, bench, &eye);
    rig(&mut drawing, bench, &eye);
    let (class, seen) = sight_class(light);
    rays(&mut drawing, "beam", &light.beam, light.spot, &eye, true);
    rays(&mut drawing, class, &light.sight, seen, &eye, false);
    points(&mut drawing, bench, light, &eye);
    drawing.text_of()
}

fn floor(drawing: &mut Drawing, eye: &Eye) {
    let line = |drawing: &mut Drawing, a: [f64; 2], b: [f64; 2]| {
        let on_floor = |[x, z]: [f64; 2]| eye.see(Vector3::new(x, HALF_HEIGHT, z));
        drawing.line("grid", on_floor(a), on_floor(b));
    };
    for step in -4..=4 {
        let across = f64::from(step) * 50.0;
        line(drawing, [across, -200.0], [across, 200.0]);
        line(drawing, [-200.0, across], [200.0, across]);
    }
}

fn vessel(drawing: &mut Drawing, bench: &Bench, eye: &Eye) {
    match bench.wall {
        WallShape::Plane => tank(drawing, bench.thickness, eye),
        WallShape::Cylinder => {
            let ring =
                |radius: f64, y: f64| ring(bench.radius, radius, |c, s| Vector3::new(s, y, c));
            for radius in [bench.radius, bench.radius - bench.thickness] {
                for y in [HALF_HEIGHT, 0.0, -HALF_HEIGHT] {
                    let class = if y == HALF_HEIGHT {
                        "wall-face"
                    } else {
                        "wall-edge"
                    };
                    drawing.path(class, &see_all(eye, &ring(radius, y)), true);
                }
            }
            for step in 0..12 {
                let (s, c) = (f64::from(step) * 30.0_f64.to_radians()).sin_cos();
                let at = |y| eye.see(Vector3::new(bench.radius * s, y, bench.radius * (1.0 + c)));
                drawing.line("wall-edge", at(-HALF_HEIGHT), at(HALF_HEIGHT));
            }
        }
        WallShape::Sphere => {
            let centre = Vector3::new(0.0, 0.0, bench.radius);
            let outline = eye.see(centre);
            let away = (eye.rotation * (centre - eye.pivot)).z + eye.distance;
            drawing.circle("wall-face", outline, bench.radius * eye.focal / away);
            for step in 0..4 {
                let (s, c) = (f64::from(step) * 45.0_f64.to_radians()).sin_cos();
                let meridian = ring(bench.radius, bench.radius, |a, b| {
                    Vector3::new(a * s, b, a * c)
                });
                drawing.path("wall-edge", &see_all(eye, &meridian), true);
            }
            for share in [-0.5_f64, 0.0, 0.5] {
                let radius = bench.radius * (1.0 - share * share).sqrt();
                let y = share * bench.radius;
                let parallel = ring(bench.radius, radius, |c, s| Vector3::new(s, y, c));
                drawing.path("wall-edge", &see_all(eye, &parallel), true);
            }
        }
    }
}

/// A circle about the vessel's middle, which lies `depth` behind the wall's front.
fn ring(depth: f64, radius: f64, at: impl Fn(f64, f64) -> Vector3<f64>) -> Vec<Vector3<f64>> {
    (0..48)
        .map(|step| {
            let (s, c) = (f64::from(step) / 48.0 * std::f64::consts::TAU).sin_cos();
            at(radius * c, radius * s) + Vector3::new(0.0, 0.0, depth)
        })
        .collect()
}

fn see_all(eye: &Eye, places: &[Vector3<f64>]) -> Vec<At> {
    places.iter().map(|place| eye.see(*place)).collect()
}

fn tank(drawing: &mut Drawing, thickness: f64, eye: &Eye) {
    const HALF_WIDTH: f64 = 130.0;
    const DEPTH: f64 = 190.0;
    let face = |z: f64| {
        [
            Vector3::new(-HALF_WIDTH, -HALF_HEIGHT, z),
            Vector3::new(HALF_WIDTH, -HALF_HEIGHT, z),
            Vector3::new(HALF_WIDTH, HALF_HEIGHT, z),
            Vector3::new(-HALF_WIDTH, HALF_HEIGHT, z),
        ]
    };
    for corner in 0..4 {
        drawing.line(
            "wall-edge",
            eye.see(face(thickness)[corner]),
            eye.see(face(DEPTH)[corner]),
        );
    }
    drawing.path("wall-back", &see_all(eye, &face(DEPTH)), true);
    for z in [thickness, 0.0] {
        drawing.path("wall-face", &see_all(eye, &face(z)), true);
    }
}

/// The laser and the camera, and what bolts them together.
fn rig(drawing: &mut Drawing, bench: &Bench, eye: &Eye) {
    let (laser, camera) = (bench.on_rig(bench.laser), bench.on_rig(bench.camera));
    drawing.line("bar", eye.point(laser), eye.point(camera));
    let rotation = bench.rig_rotation();
    let corners = [[-9.0, -7.0], [9.0, -7.0], [9.0, 7.0], [-9.0, 7.0]];
    let frame = corners.map(|[x, y]| eye.see(camera.coords + rotation * Vector3::new(x, y, 22.0)));
    for corner in frame {
        drawing.line("frustum", eye.point(camera), corner);
    }
    drawing.path("frustum", &frame, true);
    drawing.circle("camera-dot", eye.point(camera), 5.0);
    drawing.circle("laser-dot", eye.point(laser), 5.0);
    let beside = |[x, y]: At| [x + 9.0, y + 18.0];
    drawing.text("label", beside(eye.point(laser)), "laser");
    drawing.text("label", beside(eye.point(camera)), "camera");
}

fn rays(
    drawing: &mut Drawing,
    class: &str,
    path: &LightPath,
    end: Option<Point<World>>,
    eye: &Eye,
    outwards: bool,
) {
    const FAR: f64 = 160.0;
    let mut places = vec![path.start.origin];
    places.extend(path.bends.iter().map(|bend| bend.at));
    let far = if path.bends.is_empty() {
        3.0 * FAR
    } else {
        FAR
    };
    places.push(
        end.filter(|_| path.is_inside())
            .unwrap_or_else(|| path.last().at(far)),
    );
    for pair in places.windows(2) {
        let [from, to] = [eye.point(pair[0]), eye.point(pair[1])];
        let [from, to] = if outwards { [from, to] } else { [to, from] };
        drawing.ray(class, from, to);
    }
    for bend in &path.bends {
        let normal = bend.at + bend.normal * 30.0;
        drawing.line("normal", eye.point(bend.at), eye.point(normal));
    }
}

fn points(drawing: &mut Drawing, bench: &Bench, light: &Light, eye: &Eye) {
    if let Ok(measurement) = &light.measurement {
        if let Some(apparent) = measurement.apparent {
            drawing.circle("apparent", eye.point(apparent), 5.0);
        }
        if bench.assumed.is_some() {
            let approach = measurement.meeting.approach;
            drawing.line("gap", eye.point(approach.first), eye.point(approach.second));
            drawing.circle("measured", eye.point(measurement.meeting.point()), 5.0);
        }
    }
    if let Some(spot) = light.spot {
        let below = Vector3::new(spot.coords.x, HALF_HEIGHT, spot.coords.z);
        drawing.line("drop", eye.point(spot), eye.see(below));
        drawing.circle("lit", eye.point(spot), 5.0);
    }
}
