//! The picture through the wall, traced by the graphics card.

use glow::HasContext;
use leptos::html;
use leptos::prelude::*;
use snellius::camera::Pixel;
use snellius::geometry::Point;
use snellius::lab::{Bench, Sight, Thing, WallShape, quantity};
use wasm_bindgen::prelude::*;
use web_sys::{
    HtmlCanvasElement, KeyboardEvent, PointerEvent, WebGl2RenderingContext, WebglLoseContext,
};

use super::bench::watch_size;
use super::controls::{ChoiceControl, MediumControl, QuantityControl};
use super::drawing::At;
use super::state::LabState;

/// The view through the wall, against the one without the liquid.
#[component]
pub(super) fn SightView() -> impl IntoView {
    let lab = LabState::get();
    let canvas = NodeRef::<html::Canvas>::new();
    let size = RwSignal::new([1.0, 1.0]);
    let card = StoredValue::new_local(None::<GraphicsCard>);
    let missing = RwSignal::new(false);
    let ready = RwSignal::new(false);
    let dark = crate::scene::dark_mode();
    Effect::new(move |_| {
        let Some(canvas) = canvas.get() else { return };
        watch_size(&canvas, size);
        match GraphicsCard::new(&canvas) {
            Ok(new) => {
                card.set_value(Some(new));
                ready.set(true);
            }
            Err(cause) => {
                web_sys::console::warn_1(&cause.into());
                missing.set(true);
            }
        }
    });
    on_cleanup(move || {
        if let Some(Some(card)) = card.try_update_value(Option::take) {
            card.close();
        }
    });
    Effect::new(move |_| {
        dark.track();
        let (bench, size) = (lab.bench.get(), size.get());
        if ready.get() {
            card.with_value(|card| card.iter().for_each(|card| card.draw(&bench, size)));
        }
    });
    view! {
        <div class="bench see">
            <section class="panel pictures-of-bench" aria-label="The view through the wall">
                <Picture canvas size missing />
            </section>
            <Controls card />
        </div>
    }
}

#[component]
fn Picture(
    canvas: NodeRef<html::Canvas>,
    size: RwSignal<At>,
    missing: RwSignal<bool>,
) -> impl IntoView {
    let lab = LabState::get();
    let held = RwSignal::new(None::<At>);
    let at = |event: &PointerEvent| [f64::from(event.client_x()), f64::from(event.client_y())];
    let take = move |event: PointerEvent| {
        held.set(Some(at(&event)));
        if let Some(canvas) = canvas.get_untracked() {
            let _ = canvas.set_pointer_capture(event.pointer_id());
        }
    };
    let drag = move |event: PointerEvent| {
        let (Some(before), now) = (held.get_untracked(), at(&event)) else {
            return;
        };
        held.set(Some(now));
        let per_px = 90.0 / size.get_untracked()[1].max(200.0);
        walk(
            lab,
            (before[0] - now[0]) * per_px,
            (now[1] - before[1]) * per_px,
        );
    };
    let key = move |event: KeyboardEvent| {
        let [round, above] = match event.key().as_str() {
            "ArrowLeft" => [-2.0, 0.0],
            "ArrowRight" => [2.0, 0.0],
            "ArrowUp" => [0.0, 2.0],
            "ArrowDown" => [0.0, -2.0],
            _ => return,
        };
        event.prevent_default();
        walk(lab, round, above);
    };
    let divider = Memo::new(move |_| lab.bench.with(|bench| bench.divider));
    let swipe = move |event| {
        if let (Ok(value), Some(quantity)) =
            (event_target_value(&event).parse(), quantity("divider"))
        {
            lab.change(|bench| quantity.set(bench, value));
        }
    };
    view! {
        <div class="sight-picture" style:--divider=move || format!("{}%", divider.get())>
            <canvas
                node_ref=canvas
                data-testid="sight"
                role="application"
                tabindex="0"
                aria-label="The object in the vessel, seen through the wall: on the left with the liquid, on \
                            the right without. Arrow keys walk round it."
                on:pointerdown=take
                on:pointermove=drag
                on:pointerup=move |_| held.set(None)
                on:pointercancel=move |_| held.set(None)
                on:keydown=key
            ></canvas>
            <span class="side-name left" aria-hidden="true">
                {move || lab.bench.with(|bench| bench.liquid.name())}
            </span>
            <span class="side-name right" aria-hidden="true">"No liquid"</span>
            <div class="divider-line" aria-hidden="true"></div>
            <input
                class="divider"
                type="range"
                min="0"
                max="100"
                aria-label="How much of the picture shows the liquid, per cent from the left"
                data-testid="divider"
                prop:value=move || divider.get().to_string()
                on:input=swipe
            />
            <Show when=move || missing.get()>
                <p class="no-webgl" role="alert">
                    "This browser gives no WebGL2, so there is no picture through the wall. The bench and \
                     the lessons work without it."
                </p>
            </Show>
        </div>
    }
}

fn walk(lab: LabState, round: f64, above: f64) {
    lab.change(|bench| {
        let (round, above) = (bench.eye_round + round, bench.eye_above + above);
        for (key, value) in [("round", round), ("above", above)] {
            if let Some(quantity) = quantity(key) {
                quantity.set(bench, value);
            }
        }
    });
}

#[component]
fn Controls(card: StoredValue<Option<GraphicsCard>, LocalStorage>) -> impl IntoView {
    let lab = LabState::get();
    let round = move || lab.bench.with(|bench| bench.wall != WallShape::Plane);
    let checked = RwSignal::new(None::<RayCheck>);
    let check = move |_| {
        let bench = lab.bench.get_untracked();
        checked.set(card.with_value(|card| card.as_ref().and_then(|card| card.check(&bench))));
    };
    // What was checked is told of what is shown, and of nothing else.
    Effect::new(move |_| {
        lab.bench.track();
        checked.set(None);
    });
    let rays = move || checked.with(|check| check.as_ref().map(RayCheck::rays_text));
    view! {
        <section class="panel controls" aria-label="What can be set">
            <fieldset>
                <legend>"Vessel"</legend>
                <ChoiceControl key="wall" />
                <QuantityControl key="thickness" />
                <Show when=round>
                    <QuantityControl key="radius" />
                </Show>
                <QuantityControl key="fill" />
            </fieldset>
            <fieldset>
                <legend>"Object"</legend>
                <ChoiceControl key="thing" />
            </fieldset>
            <fieldset>
                <legend>"Media"</legend>
                <MediumControl key="outside" />
                <MediumControl key="glass" />
                <MediumControl key="liquid" />
            </fieldset>
            <fieldset>
                <legend>"Eye"</legend>
                <QuantityControl key="round" />
                <QuantityControl key="above" />
            </fieldset>
            <fieldset>
                <legend>"Is it true?"</legend>
                <p class="help">
                    "The graphics card bends the light of every pixel. This holds some of its rays against \
                     the tracer that measures scans."
                </p>
                <button type="button" class="quiet" data-testid="check-rays" on:click=check>
                    "Check 100 rays"
                </button>
                <p role="status" data-testid="ray-check" data-rays=rays>
                    {move || checked.with(|check| check.as_ref().map(RayCheck::words))}
                </p>
            </fieldset>
        </section>
    }
}

/// Rays of the picture held against the core's.
#[derive(Clone, Debug, PartialEq)]
struct RayCheck {
    /// The picture's size, px.
    size: At,
    /// Where each pixel's ray landed.
    rays: Vec<(Pixel, [f64; 3])>,
    /// How far the core sees the worst of these places from the pixel, px.
    worst: f64,
}

impl RayCheck {
    fn words(&self) -> String {
        format!(
            "{} rays: at most {:.4} px between picture and measurement.",
            self.rays.len(),
            self.worst
        )
    }

    /// The picture's size, and pixels and places, for whoever wants to check the check.
    fn rays_text(&self) -> String {
        let ray = |(pixel, at): &(Pixel, [f64; 3])| {
            format!("{} {} {} {} {}", pixel.u, pixel.v, at[0], at[1], at[2])
        };
        let rays: Vec<String> = self.rays.iter().map(ray).collect();
        format!("{} {};{}", self.size[0], self.size[1], rays.join(";"))
    }
}

/// A canvas's WebGL2 context with the program that traces rays, and the same one that tells where they land.
struct GraphicsCard {
    canvas: HtmlCanvasElement,
    gl: glow::Context,
    picture: glow::Program,
    probe: glow::Program,
}

const VERTEX: &str = include_str!("shaders/sight.vert");
const FRAGMENT: &str = include_str!("shaders/sight.frag");
const HEAD: &str = "#version 300 es\nprecision highp float;\nprecision highp int;\n";

/// Pixels that the check tries, across and down; those whose rays stay in the liquid count.
const PROBES: [i32; 2] = [40, 30];
/// Rays that the check compares.
const RAYS: usize = 100;

impl GraphicsCard {
    fn new(canvas: &HtmlCanvasElement) -> Result<Self, String> {
        let context = canvas
            .get_context("webgl2")
            .ok()
            .flatten()
            .and_then(|context| context.dyn_into::<WebGl2RenderingContext>().ok())
            .ok_or("no WebGL2")?;
        let gl = glow::Context::from_webgl2_context(context);
        let picture = build(&gl, HEAD)?;
        let probe = build(&gl, &format!("{HEAD}#define PROBE\n"))?;
        Ok(Self {
            canvas: canvas.clone(),
            gl,
            picture,
            probe,
        })
    }

    /// A browser gives but a few contexts at a time.
    fn close(&self) {
        let context = self.canvas.get_context("webgl2").ok().flatten();
        let loss = context
            .and_then(|context| context.dyn_into::<WebGl2RenderingContext>().ok())
            .and_then(|context| context.get_extension("WEBGL_lose_context").ok().flatten());
        if let Some(loss) = loss {
            loss.unchecked_into::<WebglLoseContext>().lose_context();
        }
    }

    /// The canvas's size in the screen's pixels.
    fn resolution(&self, size: At) -> At {
        let ratio = window().device_pixel_ratio().clamp(1.0, 2.0);
        size.map(|length| (length * ratio).round().max(1.0))
    }

    fn draw(&self, bench: &Bench, size: At) {
        let [width, height] = self.resolution(size);
        if f64::from(self.canvas.width()) != width || f64::from(self.canvas.height()) != height {
            self.canvas.set_width(width as u32);
            self.canvas.set_height(height as u32);
        }
        // SAFETY: all names belong to this context, and the three vertices come from no buffer.
        unsafe {
            self.gl.viewport(0, 0, width as i32, height as i32);
            self.set_uniforms(self.picture, bench, [width, height]);
            self.gl.draw_arrays(glow::TRIANGLES, 0, 3);
        }
    }

    /// Reads back where some rays of the present picture land, and asks the core where it sees them.
    fn check(&self, bench: &Bench) -> Option<RayCheck> {
        let size = [
            f64::from(self.canvas.width()),
            f64::from(self.canvas.height()),
        ];
        let sight = Sight::new(bench, size[0], size[1]);
        let landed = self.land(bench, size)?;
        let stride = (landed.len() / RAYS).max(1);
        let rays: Vec<_> = landed.into_iter().step_by(stride).take(RAYS).collect();
        let off = |(pixel, at): &(Pixel, [f64; 3])| {
            sight
                .off_by(*pixel, Point::from(*at))
                .unwrap_or(f64::INFINITY)
        };
        let worst = rays.iter().map(off).fold(0.0, f64::max);
        (!rays.is_empty()).then_some(RayCheck { size, rays, worst })
    }

    /// Pixels whose rays run from the wall through liquid alone, and where these land.
    fn land(&self, bench: &Bench, size: At) -> Option<Vec<(Pixel, [f64; 3])>> {
        let [across, down] = PROBES;
        let step = [
            (size[0] / f64::from(across)).floor().max(1.0),
            (size[1] / f64::from(down)).floor().max(1.0),
        ];
        let mut texels = vec![0_u8; (across * down) as usize * 16];
        let gl = &self.gl;
        // SAFETY: the texture is as large as what is read from it: four 32-bit words a texel.
        unsafe {
            let texture = gl.create_texture().ok()?;
            gl.bind_texture(glow::TEXTURE_2D, Some(texture));
            gl.tex_storage_2d(glow::TEXTURE_2D, 1, glow::RGBA32UI, across, down);
            let frame = gl.create_framebuffer().ok()?;
            gl.bind_framebuffer(glow::FRAMEBUFFER, Some(frame));
            gl.framebuffer_texture_2d(
                glow::FRAMEBUFFER,
                glow::COLOR_ATTACHMENT0,
                glow::TEXTURE_2D,
                Some(texture),
                0,
            );
            gl.viewport(0, 0, across, down);
            self.set_uniforms(self.probe, bench, size);
            let place = gl.get_uniform_location(self.probe, "probe");
            gl.uniform_4_f32(place.as_ref(), 0.0, 0.0, step[0] as f32, step[1] as f32);
            gl.draw_arrays(glow::TRIANGLES, 0, 3);
            gl.read_pixels(
                0,
                0,
                across,
                down,
                glow::RGBA_INTEGER,
                glow::UNSIGNED_INT,
                glow::PixelPackData::Slice(Some(&mut texels)),
            );
            gl.bind_framebuffer(glow::FRAMEBUFFER, None);
            gl.delete_framebuffer(frame);
            gl.delete_texture(texture);
        }
        let word = |texel: &[u8], at: usize| {
            let bytes = [
                texel[4 * at],
                texel[4 * at + 1],
                texel[4 * at + 2],
                texel[4 * at + 3],
            ];
            u32::from_le_bytes(bytes)
        };
        let landed = texels
            .chunks_exact(16)
            .enumerate()
            .filter_map(|(number, texel)| {
                let number = number as i32;
                let pixel = Pixel::new(
                    f64::from(number % across) * step[0],
                    f64::from(number / across) * step[1],
                );
                let at = [0, 1, 2].map(|axis| f64::from(f32::from_bits(word(texel, axis))));
                (word(texel, 3) == 1).then_some((pixel, at))
            });
        Some(landed.collect())
    }

    /// Hands the bench to the card.
    ///
    /// # Safety
    ///
    /// The program must be one of this context's.
    unsafe fn set_uniforms(&self, program: glow::Program, bench: &Bench, size: At) {
        let sight = Sight::new(bench, size[0], size[1]);
        let gl = &self.gl;
        // SAFETY: the caller's; a name that the program does not have is passed over.
        unsafe {
            gl.use_program(Some(program));
            let at = |name: &str| gl.get_uniform_location(program, name);
            let one = |name: &str, value: f64| gl.uniform_1_f32(at(name).as_ref(), value as f32);
            let two = |name: &str, [x, y]: [f64; 2]| {
                gl.uniform_2_f32(at(name).as_ref(), x as f32, y as f32);
            };
            let three = |name: &str, [x, y, z]: [f64; 3]| {
                gl.uniform_3_f32(at(name).as_ref(), x as f32, y as f32, z as f32);
            };
            let whole = |name: &str, value: i32| gl.uniform_1_i32(at(name).as_ref(), value);
            three("eye", sight.world_from_eye.translation().into());
            let rotation = sight.world_from_eye.rotation().to_rotation_matrix();
            let columns: Vec<f32> = rotation.matrix().iter().map(|x| *x as f32).collect();
            gl.uniform_matrix_3_f32_slice(at("world_from_eye").as_ref(), false, &columns);
            three("lens", [sight.focal, sight.centre.u, sight.centre.v]);
            one("picture_height", size[1]);
            one("divider", size[0] * bench.divider / 100.0);
            whole("wall", bench.wall as i32);
            one("radius", bench.radius);
            one("thickness", bench.thickness);
            three(
                "indices",
                [
                    bench.outside.index(),
                    bench.glass.index(),
                    bench.liquid.index(),
                ],
            );
            three(
                "level",
                [sight.level.rim, sight.level.surface, sight.level.floor],
            );
            two("tank", sight.tank);
            three("middle", sight.middle.to_array());
            let thing = thing(bench, &sight);
            whole("thing", bench.thing as i32);
            three("thing_from", thing.from);
            three("thing_to", thing.to);
            one("thing_radius", thing.radius);
            one("dark", if crate::colours::is_dark() { 1.0 } else { 0.0 });
        }
    }
}

/// Where the object is.
struct Placed {
    from: [f64; 3],
    to: [f64; 3],
    radius: f64,
}

fn thing(bench: &Bench, sight: &Sight) -> Placed {
    let [x, _, z] = sight.middle.to_array();
    let (rim, floor, reach) = (sight.level.rim, sight.level.floor, sight.reach);
    // A bowl is closed, and round at the bottom as well.
    let [top, bottom] = match bench.wall {
        WallShape::Sphere => [0.55 * rim, 0.6 * floor],
        _ => [rim - 30.0, floor - 22.0],
    };
    match bench.thing {
        Thing::Rod => Placed {
            from: [x - 0.8 * reach, top, z],
            to: [x + 0.6 * reach, bottom, z],
            radius: 6.0,
        },
        Thing::Ball => Placed {
            from: [x, 0.3 * floor, z],
            to: [x, 0.3 * floor, z],
            radius: 0.6 * reach,
        },
        Thing::Card => Placed {
            from: [x, 0.15 * floor, z],
            to: [x, 0.15 * floor, z],
            radius: 30.0_f64.min(reach),
        },
    }
}

/// Compiles and links the program; the error is the compiler's.
fn build(gl: &glow::Context, head: &str) -> Result<glow::Program, String> {
    // SAFETY: every name is made by this context, and used with it.
    unsafe {
        let program = gl.create_program()?;
        for (kind, source) in [
            (glow::VERTEX_SHADER, VERTEX),
            (glow::FRAGMENT_SHADER, FRAGMENT),
        ] {
            let shader = gl.create_shader(kind)?;
            gl.shader_source(shader, &format!("{head}{source}"));
            gl.compile_shader(shader);
            if !gl.get_shader_compile_status(shader) {
                return Err(gl.get_shader_info_log(shader));
            }
            gl.attach_shader(program, shader);
        }
        gl.link_program(program);
        if !gl.get_program_link_status(program) {
            return Err(gl.get_program_info_log(program));
        }
        Ok(program)
    }
}
