//! The stage: a WebGL2 canvas, what stands on it, and the camera that looks at it. It draws when
//! something has changed, and only then.

use std::cell::{Cell, RefCell};
use std::rc::Rc;
use std::sync::Arc;

use js_sys::{Promise, Reflect};
use three_d::{Context, CoreError, InnerSpace, Mat4, Vec2, Viewport};
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::JsFuture;
use web_sys::{
    Blob, HtmlCanvasElement, HtmlElement, WebGl2RenderingContext, WebGlContextAttributes,
    WebglLoseContext,
};

use super::content::Content;
use super::faces::Faces;
use super::labels::Labels;
use super::layer::Layer;
use super::lines::{LineProgram, Lines};
use super::orbit::Orbit;
use super::pace::Pace;
use super::palette::Palette;
use super::picture::with_legend;
use super::points::{PointProgram, PointStyle, Points, ScenePoint, between};
use super::section::Slab;
use crate::files::save_blob;
use crate::measuring::Picked;
use crate::run::{graphics_started, now, sleep};
use crate::state::{Look, Section};

/// Why there is no stage.
#[derive(Debug)]
pub(super) struct NoStage;

impl From<CoreError> for NoStage {
    fn from(error: CoreError) -> Self {
        web_sys::console::warn_1(&error.to_string().into());
        Self
    }
}

type FrameListener = Closure<dyn FnMut(f64)>;

/// A handle on the stage; copies mean the same one.
#[derive(Clone)]
pub(super) struct Stage(Rc<Inner>);

struct Inner {
    canvas: HtmlCanvasElement,
    context: Context,
    set: RefCell<Set>,
    labels: Labels,
    orbit: Cell<Orbit>,
    /// 0: without refraction, 1: with.
    refraction: Cell<f32>,
    /// What the refraction is on its way to.
    wanted_refraction: Cell<f32>,
    /// Points beyond these fractions of the colours are hidden.
    range: Cell<[f32; 2]>,
    /// Only this is shown.
    slab: Cell<Slab>,
    /// What the picture was last fitted to, until a hand moves the camera.
    fitted: Cell<Option<Subject>>,
    /// The number of the frame that the browser was asked for, until it comes.
    frame_asked_for: Cell<Option<i32>>,
    last_frame: Cell<f64>,
    /// Whether the picture shows everything as it is.
    is_up_to_date: Cell<bool>,
    /// How many points it draws in a frame.
    pace: Pace,
    on_frame: RefCell<Option<FrameListener>>,
}

/// What can fill the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Subject {
    /// The object and the wall before it.
    Measured,
    /// These and the rig.
    WholeSetUp,
}

/// What stands on the stage, in graphics memory.
struct Set {
    content: Content,
    palette: Palette,
    object: Points,
    vessel: Points,
    marker: Points,
    stations: Lines,
    grid: Lines,
    edges: Lines,
    beams: Lines,
    displacements: Lines,
    chosen_light: Lines,
    ellipsoids: Lines,
    wall: Faces,
    /// How far refraction went when the chosen light was bent; nothing, and it is another one by now.
    light_at: Option<f32>,
    /// The points, and these with everything else.
    layers: Option<[Layer; 2]>,
    /// How the points on their layer are seen.
    seen: Option<Seen>,
}

/// How points are seen: as long as it is the same, those that are drawn need not be drawn again.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Seen {
    world_to_clip: Mat4,
    object: PointStyle,
    vessel: PointStyle,
    /// Red, green, blue, opacity.
    ground: [f32; 4],
}

impl Set {
    /// Draws rings around what is chosen or picked, and the light of the chosen view, anew.
    fn mark(&mut self) {
        self.marker.fill(&self.content.rings(&self.palette));
        self.light_at = None;
    }

    /// Bends the chosen view's light as far as refraction goes.
    fn bend(&mut self, refraction: f32) {
        if self.light_at.replace(refraction) != Some(refraction) {
            let light = self.content.chosen_light(&self.palette, refraction);
            self.chosen_light.fill(&light);
        }
    }

    /// Has points go to the card for some milliseconds; true while there are more.
    fn fill_some(&mut self) -> bool {
        const MILLISECONDS: f64 = 6.0;
        let begun = now();
        let Self {
            object,
            vessel,
            content,
            ..
        } = self;
        while now() - begun < MILLISECONDS {
            // By turns: neither waits for the other.
            if !object.is_filled() {
                object.fill_next(|index| content.object_point(index));
            }
            if !vessel.is_filled() {
                vessel.fill_next(|index| content.vessel_point(index));
            }
            if object.is_filled() && vessel.is_filled() {
                return false;
            }
        }
        true
    }
}

impl Stage {
    /// Each of its steps may take the graphics card long, so each is a task of its own, and waits for the one before.
    pub(super) async fn new(
        canvas: HtmlCanvasElement,
        labels: HtmlElement,
    ) -> Result<Self, NoStage> {
        graphics_started().await;
        // It takes the card long to change its size later.
        match_resolution(&canvas);
        calm().await;
        let graphics = graphics(&canvas)?;
        caught_up(&graphics).await;
        let context = context(&graphics)?;
        caught_up(&graphics).await;
        let points = PointProgram::new(&context)?;
        caught_up(&graphics).await;
        let lines = LineProgram::new(&context)?;
        caught_up(&graphics).await;
        let wall = Faces::new(&context)?;
        caught_up(&graphics).await;
        let points = || Points::new(Rc::clone(&points));
        let lines = || Lines::new(&lines);
        let set = Set {
            content: Content::default(),
            palette: Palette::of_the_system(),
            object: points(),
            vessel: points(),
            marker: points(),
            stations: lines(),
            grid: lines(),
            edges: lines(),
            beams: lines(),
            displacements: lines(),
            chosen_light: lines(),
            ellipsoids: lines(),
            wall,
            light_at: None,
            layers: None,
            seen: None,
        };
        let stage = Self(Rc::new(Inner {
            canvas,
            context,
            set: RefCell::new(set),
            labels: Labels::new(labels),
            orbit: Cell::new(Orbit::default()),
            refraction: Cell::new(1.0),
            wanted_refraction: Cell::new(1.0),
            range: Cell::new([0.0, 1.0]),
            slab: Cell::new(Slab::ALL),
            fitted: Cell::new(None),
            frame_asked_for: Cell::new(None),
            last_frame: Cell::new(0.0),
            is_up_to_date: Cell::new(false),
            pace: Pace::default(),
            on_frame: RefCell::new(None),
        }));
        let handle = stage.clone();
        let on_frame = Closure::new(move |time: f64| handle.frame(time));
        stage.0.on_frame.replace(Some(on_frame));
        Ok(stage)
    }

    /// Lets go of itself and of the graphics context: a browser gives but a few of them at a time.
    pub(super) fn close(&self) {
        // The browser must not call what is dropped.
        if let (Some(window), Some(asked)) = (web_sys::window(), self.0.frame_asked_for.take()) {
            let _ = window.cancel_animation_frame(asked);
        }
        self.0.on_frame.replace(None);
        let graphics = self.0.canvas.get_context("webgl2").ok().flatten();
        let loss = graphics
            .and_then(|context| context.dyn_into::<WebGl2RenderingContext>().ok())
            .and_then(|context| context.get_extension("WEBGL_lose_context").ok().flatten());
        if let Some(loss) = loss {
            loss.unchecked_into::<WebglLoseContext>().lose_context();
        }
    }

    /// Puts other things on the stage. Points follow in the frames to come.
    pub(super) fn show(&self, content: Content) {
        let set = &mut *self.0.set.borrow_mut();
        let palette = Palette::of_the_system();
        if content.has_points_of(&set.content) {
            set.object.fade();
            set.vessel.fade();
        } else {
            let [object, vessel] = content.counts();
            set.object.clear(object);
            set.vessel.clear(vessel);
        }
        set.seen = None;
        set.stations.fill(&content.station_lines(&palette));
        set.grid.fill(&content.grid_lines(&palette));
        set.edges.fill(&content.wall_edges(&palette));
        set.beams.fill(&content.beams(&palette));
        set.displacements.fill(&content.displacements(&palette));
        set.wall.fill(&content.wall_faces(&palette));
        self.0.labels.fill(content.labels());
        let picked = std::mem::take(&mut set.content.picked);
        set.palette = palette;
        set.content = content;
        set.content.picked = picked;
        set.mark();
        self.draw_soon();
    }

    /// Marks a view's point and draws its light.
    pub(super) fn choose(&self, view: Option<usize>) {
        let set = &mut *self.0.set.borrow_mut();
        set.content.chosen = view;
        set.mark();
        self.draw_soon();
    }

    /// Rings the points that are measured with.
    pub(super) fn pick(&self, picked: [Vec<Picked>; 2]) {
        let set = &mut *self.0.set.borrow_mut();
        set.content.picked = picked;
        set.mark();
        self.draw_soon();
    }

    /// Goes over to the object with (1) or without (0) refraction, or between, in steps if motion is
    /// welcome.
    pub(super) fn refract(&self, wanted: f32, at_once: bool) {
        self.0.wanted_refraction.set(wanted);
        if at_once {
            self.0.refraction.set(wanted);
        }
        self.draw_soon();
    }

    /// Moves the camera by hand.
    pub(super) fn turn(&self, change: impl FnOnce(&mut Orbit)) {
        self.0.fitted.set(None);
        let mut orbit = self.0.orbit.get();
        change(&mut orbit);
        self.0.orbit.set(orbit);
        self.draw_soon();
    }

    /// Looks from beside the rig at what was measured.
    pub(super) fn face_front(&self) {
        let mut front = self.0.set.borrow().content.front();
        front.orthographic = self.0.orbit.get().orthographic;
        self.0.orbit.set(front);
        self.fit(Subject::Measured);
    }

    /// Looks at what was measured from one of the usual sides.
    pub(super) fn look(&self, from: Look) {
        self.turn(|orbit| orbit.look(from));
        self.fit(Subject::Measured);
    }

    /// Hides points beyond these fractions of the colours.
    pub(super) fn hide_beyond(&self, range: [f32; 2]) {
        self.0.range.set(range);
        self.draw_soon();
    }

    /// Shows a slab only.
    pub(super) fn cut(&self, section: Section) {
        let slab = self.0.set.borrow().content.slab(section);
        self.0.slab.set(slab);
        self.draw_soon();
    }

    /// Draws error ellipsoids, so many times as large as they are, or none.
    pub(super) fn draw_ellipsoids(&self, magnified: Option<f32>) {
        let set = &mut *self.0.set.borrow_mut();
        let lines = magnified.map(|magnified| set.content.ellipsoids(magnified));
        set.ellipsoids.fill(&lines.unwrap_or_default());
        self.draw_soon();
    }

    /// Saves what is seen as `scene.png`, with the legend of its colours; `then` is told how that went.
    pub(super) fn save_picture(
        &self,
        transparent: bool,
        then: impl FnOnce(Result<(), JsValue>) + 'static,
    ) {
        // The browser takes the picture as it is when it is asked, before anything else is drawn.
        self.match_resolution();
        self.draw(transparent, usize::MAX);
        let picture = match self.0.set.borrow().content.scale() {
            Some(scale) => with_legend(&self.0.canvas, self.css_size(), scale),
            None => Ok(self.0.canvas.clone()),
        };
        let taken = Closure::once_into_js(move |picture: Option<Blob>| {
            let picture = picture.ok_or_else(|| JsValue::from("the canvas is empty"));
            then(picture.and_then(|picture| save_blob(&picture, "scene.png")));
        });
        let asked = picture.and_then(|picture| picture.to_blob(taken.unchecked_ref()));
        if let Err(error) = asked {
            web_sys::console::warn_1(&error);
        }
        self.draw_soon();
    }

    /// With or without perspective.
    pub(super) fn set_orthographic(&self, on: bool) {
        let mut orbit = self.0.orbit.get();
        orbit.orthographic = on;
        self.0.orbit.set(orbit);
        self.draw_soon();
    }

    /// Looks at the point that is nearest to a place of the canvas (CSS px), if one is near.
    pub(super) fn focus(&self, place: Vec2) {
        if let Some(point) = self.point_at(place) {
            let at = point.between(smooth(self.0.refraction.get()));
            self.turn(|orbit| orbit.focus(at));
        }
    }

    /// Moves the camera until the subject fills the picture; as long as no hand moves the camera, it
    /// does so in a picture of another size too.
    pub(super) fn fit(&self, subject: Subject) {
        let places = {
            let content = &self.0.set.borrow().content;
            match subject {
                Subject::Measured => content.extent().to_vec(),
                Subject::WholeSetUp => content.whole_extent(),
            }
        };
        let aspect = self.aspect();
        self.turn(|orbit| orbit.fit(&places, aspect));
        self.0.fitted.set(Some(subject));
    }

    /// The point of object or wall that is nearest to a place of the canvas (CSS px), if one is near.
    pub(super) fn point_at(&self, place: Vec2) -> Option<ScenePoint> {
        const REACH: f32 = 14.0;
        let reach = Cell::new(REACH);
        let mut nearest = None;
        let distance = |at: Vec2| (at - place).magnitude();
        self.for_seen_points(
            |at| distance(at) <= reach.get(),
            |at, point| {
                reach.set(distance(at));
                nearest = Some(point);
            },
        );
        nearest
    }

    /// The points between two corners of the canvas (CSS px).
    pub(super) fn points_within(&self, [one, other]: [Vec2; 2]) -> Vec<ScenePoint> {
        let lies = |at: f32, a: f32, b: f32| (a.min(b)..=a.max(b)).contains(&at);
        let mut within = Vec::new();
        self.for_seen_points(
            |at| lies(at.x, one.x, other.x) && lies(at.y, one.y, other.y),
            |_, point| within.push(point),
        );
        within
    }

    /// Goes through the points that are not hidden and whose places on the canvas (CSS px) are wanted. The
    /// colours of a million others would keep the page.
    fn for_seen_points(
        &self,
        is_wanted: impl Fn(Vec2) -> bool,
        mut see: impl FnMut(Vec2, ScenePoint),
    ) {
        let size = self.css_size();
        let camera = self.0.orbit.get().camera(self.viewport());
        let matrix = camera.projection() * camera.view();
        let refraction = smooth(self.0.refraction.get());
        let ([low, high], slab) = (self.0.range.get(), self.0.slab.get());
        let content = &self.0.set.borrow().content;
        for (number, places) in content.places().enumerate() {
            let place = between(places, refraction);
            let clip = matrix * place.extend(1.0);
            let x = (clip.x / clip.w * 0.5 + 0.5) * size.x;
            let y = (0.5 - clip.y / clip.w * 0.5) * size.y;
            let at = Vec2::new(x, y);
            if clip.w > 0.0
                && is_wanted(at)
                && slab.holds(place)
                && let Some(point) = content.point(number)
                && (low..=high).contains(&point.fraction)
            {
                see(at, point);
            }
        }
    }

    /// The canvas's size, CSS px.
    pub(super) fn css_size(&self) -> Vec2 {
        css_size(&self.0.canvas)
    }

    fn aspect(&self) -> f32 {
        let size = self.css_size();
        size.x / size.y
    }

    fn viewport(&self) -> Viewport {
        Viewport::new_at_origo(self.0.canvas.width().max(1), self.0.canvas.height().max(1))
    }

    /// Has everything drawn as it is by then in the next frame.
    pub(super) fn draw_soon(&self) {
        self.0.is_up_to_date.set(false);
        self.ask_for_frame();
    }

    /// Asks for a frame; asking twice gives one.
    fn ask_for_frame(&self) {
        if self.0.frame_asked_for.get().is_some() {
            return;
        }
        if let (Some(window), Some(on_frame)) = (web_sys::window(), &*self.0.on_frame.borrow()) {
            let asked = window.request_animation_frame(on_frame.as_ref().unchecked_ref());
            self.0.frame_asked_for.set(asked.ok());
        }
    }

    fn frame(&self, time: f64) {
        self.0.frame_asked_for.set(None);
        let points = self.0.pace.points(time);
        if self.0.is_up_to_date.get() {
            return;
        }
        let bending = self.step_refraction(time);
        let filling = self.0.set.borrow_mut().fill_some();
        self.match_resolution();
        let (drawn, all_are) = self.draw(false, points);
        if !bending {
            self.0.last_frame.set(0.0);
        }
        self.0.is_up_to_date.set(all_are && !bending && !filling);
        // The next frame shows more, or nothing new but how long this one took.
        self.0.pace.drew(time, drawn);
        self.ask_for_frame();
    }

    /// A step of the way between without and with refraction; true while there is a way to go.
    fn step_refraction(&self, time: f64) -> bool {
        const MILLISECONDS: f64 = 450.0;
        let (now, wanted) = (self.0.refraction.get(), self.0.wanted_refraction.get());
        if now == wanted {
            return false;
        }
        let last = self.0.last_frame.replace(time);
        let passed = if last == 0.0 { 0.0 } else { time - last };
        let step = (passed / MILLISECONDS) as f32;
        let left = wanted - now;
        self.0.refraction.set(if left.abs() <= step {
            wanted
        } else {
            now + step.copysign(left)
        });
        true
    }

    /// As many pixels as the screen has.
    fn match_resolution(&self) {
        if match_resolution(&self.0.canvas)
            && let Some(subject) = self.0.fitted.get()
        {
            self.fit(subject);
        }
    }

    /// Draws everything, with so many points more than there are if they are seen as before, with so many if
    /// not. Says how many it drew, and whether all are there.
    fn draw(&self, transparent: bool, points: usize) -> (usize, bool) {
        let viewport = self.viewport();
        let camera = self.0.orbit.get().camera(viewport);
        let matrix = camera.projection() * camera.view();
        let scale = viewport.width as f32 / self.css_size().x;
        let refraction = smooth(self.0.refraction.get());
        let set = &mut *self.0.set.borrow_mut();
        let palette = set.palette;
        set.bend(refraction);

        let large = set.content.point_size();
        let (object_size, vessel_size) = if set.content.about_wall {
            (0.5 * large, large)
        } else {
            (large, 0.5 * large)
        };
        let slab = self.0.slab.get();
        let object = PointStyle {
            size: object_size * scale,
            rim: palette.rim,
            refraction,
            range: self.0.range.get(),
            slab,
            ring: false,
        };
        let vessel = PointStyle {
            size: vessel_size * scale,
            ..object
        };
        let marker = PointStyle {
            size: 2.1 * large * scale,
            ring: true,
            ..object
        };
        let [red, green, blue] = palette.background;
        let ground = match transparent {
            true => [0.0; 4],
            false => [red, green, blue, 1.0],
        };
        let seen = Seen {
            world_to_clip: matrix,
            object,
            vessel,
            ground,
        };
        if !matches!(&set.layers, Some([layer, _]) if layer.fits(viewport)) {
            let layer = || Layer::new(&self.0.context, viewport);
            set.layers = layer().zip(layer()).map(|(points, all)| [points, all]);
            set.seen = None;
        }
        let Some([cloud, picture]) = &set.layers else {
            return (0, true);
        };
        if set.seen.replace(seen) != Some(seen) {
            cloud.clear(ground);
            set.object.wipe();
            set.vessel.wipe();
            self.0.labels.place(matrix, self.css_size());
        }
        let before = set.object.drawn() + set.vessel.drawn();
        let (object_most, vessel_most) =
            shares(set.content.counts(), before.saturating_add(points));
        cloud.draw(|| {
            set.object.draw(matrix, viewport, object, object_most);
            set.vessel.draw(matrix, viewport, vessel, vessel_most);
        });
        cloud.copy_to(Some(picture));
        picture.draw(|| {
            set.stations.draw(matrix, viewport, 1.25 * scale, Slab::ALL);
            set.edges.draw(matrix, viewport, 1.25 * scale, slab);
            set.chosen_light.draw(matrix, viewport, 2.25 * scale, slab);
            if refraction < 1.0 {
                set.displacements.draw(matrix, viewport, 1.0 * scale, slab);
            } else {
                set.ellipsoids.draw(matrix, viewport, 1.0 * scale, slab);
            }
            set.wall.draw(matrix, viewport, slab);
            set.grid.draw(matrix, viewport, 1.0 * scale, Slab::ALL);
            set.beams.draw(matrix, viewport, 1.0 * scale, slab);
            set.marker.wipe();
            set.marker.draw(matrix, viewport, marker, usize::MAX);
        });
        picture.copy_to(None);
        (
            set.object.drawn() + set.vessel.drawn() - before,
            set.object.is_drawn() && set.vessel.is_drawn(),
        )
    }
}

/// How many of object and wall are drawn of so many together.
fn shares([object, vessel]: [usize; 2], most: usize) -> (usize, usize) {
    let all = object + vessel;
    if most >= all {
        return (object, vessel);
    }
    let share = most as f64 / all.max(1) as f64;
    let part = |count: usize| (count as f64 * share) as usize;
    (part(object), part(vessel))
}

/// Slow at both ends.
fn smooth(way: f32) -> f32 {
    way * way * (3.0 - 2.0 * way)
}

fn css_size(canvas: &HtmlCanvasElement) -> Vec2 {
    Vec2::new(
        canvas.client_width().max(1) as f32,
        canvas.client_height().max(1) as f32,
    )
}

/// Gives a canvas as many pixels as the screen has for it; true if it had others.
fn match_resolution(canvas: &HtmlCanvasElement) -> bool {
    let ratio = web_sys::window().map_or(1.0, |w| w.device_pixel_ratio()) as f32;
    let size = css_size(canvas) * ratio;
    let (width, height) = (size.x.round() as u32, size.y.round() as u32);
    let is_other = canvas.width() != width || canvas.height() != height;
    if is_other {
        canvas.set_width(width);
        canvas.set_height(height);
    }
    is_other
}

/// Ends when frames follow one another quickly, or after a second or so. Until then the graphics process is at work
/// on the page around the scene, and whoever asks it for a context waits for that as well.
async fn calm() {
    const QUICK: f64 = 30.0;
    const WANTED: usize = 3;
    const MOST_FRAMES: usize = 30;
    let (mut before, mut quick) = (now(), 0);
    for _ in 0..MOST_FRAMES {
        next_frame().await;
        let passed = now() - before;
        before += passed;
        quick = if passed < QUICK { quick + 1 } else { 0 };
        if quick == WANTED {
            return;
        }
    }
}

/// Ends when the browser is about to draw, or soon where it draws nothing, as in a tab that is hidden.
async fn next_frame() {
    const SOON: i32 = 100;
    let frame = Promise::new(&mut |done, _| {
        if let Some(window) = web_sys::window() {
            let _ = window.request_animation_frame(&done);
            let _ = window.set_timeout_with_callback_and_timeout_and_arguments_0(&done, SOON);
        }
    });
    let _ = JsFuture::from(frame).await;
}

/// Ends when the graphics process has done what it was told. Whoever asks it something before, how a program
/// was linked, say, is kept until it has; this asks in passing.
async fn caught_up(graphics: &WebGl2RenderingContext) {
    const LOOK: i32 = 4;
    const MOST_LOOKS: usize = 500;
    type Gl = WebGl2RenderingContext;
    let Some(fence) = graphics.fence_sync(Gl::SYNC_GPU_COMMANDS_COMPLETE, 0) else {
        return sleep(0).await;
    };
    graphics.flush();
    for _ in 0..MOST_LOOKS {
        sleep(LOOK).await;
        let status = graphics.get_sync_parameter(&fence, Gl::SYNC_STATUS);
        if status.as_f64() != Some(f64::from(Gl::UNSIGNALED)) {
            break;
        }
    }
    graphics.delete_sync(Some(&fence));
}

fn graphics(canvas: &HtmlCanvasElement) -> Result<WebGl2RenderingContext, NoStage> {
    let wishes = WebGlContextAttributes::new();
    // Points and lines have smooth edges of their own, and layers have the depth.
    wishes.set_antialias(false);
    wishes.set_depth(false);
    // For pictures without a ground; what is shown has one.
    wishes.set_alpha(true);
    canvas
        .get_context_with_context_options("webgl2", &wishes)
        .ok()
        .flatten()
        .and_then(|context| context.dyn_into::<WebGl2RenderingContext>().ok())
        .ok_or(NoStage)
}

/// glow asks for the version and three dozen extensions. The scene needs none of these, and each question has the
/// page wait for the browser's graphics process: meanwhile there are answers at hand.
fn context(graphics: &WebGl2RenderingContext) -> Result<Context, CoreError> {
    let none = Closure::<dyn Fn() -> JsValue>::new(|| JsValue::NULL);
    let version = Closure::<dyn Fn() -> JsValue>::new(|| "WebGL 2.0".into());
    let asked = [("getExtension", none), ("getParameter", version)];
    for (question, answer) in &asked {
        let _ = Reflect::set(graphics, &(*question).into(), answer.as_ref());
    }
    let bare = glow::Context::from_webgl2_context(graphics.clone());
    for (question, _) in &asked {
        let _ = Reflect::delete_property(graphics, &(*question).into());
    }
    // three-d wants an `Arc`; nothing of it leaves the main thread.
    #[allow(clippy::arc_with_non_send_sync)]
    let shared = Arc::new(bare);
    Context::from_gl_context(shared)
}
