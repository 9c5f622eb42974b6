//! Points: one GL point each, round, of a size in pixels, with a colour of its own. Each has two places,
//! with and without refraction, and the graphics card goes from one to the other.
//!
//! A million points go to the card once, in batches, a few a frame. Each batch is an even sample of them all:
//! the first ones show the whole while a hand turns the scene, and the others are drawn to them afterwards.

use std::rc::Rc;

use three_d::context::POINTS;
use three_d::{
    Context, CoreError, DepthTest, HasContext, Mat4, Program, RenderStates, Vec2, Vec3, Vector4,
    VertexBuffer, Viewport, WriteMask,
};

use super::blend::OVER;
use super::section::Slab;

/// How many points go to the card at a time.
pub(super) const BATCH: usize = 16_384;

/// A point to draw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ScenePoint {
    /// The view it comes from.
    pub(super) view: usize,
    /// Which of the view's points of the object it is; none, if it lies on the wall.
    pub(super) index: Option<usize>,
    /// Where it is.
    pub(super) place: Vec3,
    /// Where it would be without refraction.
    pub(super) unrefracted: Vec3,
    /// Red, green, blue, opacity.
    pub(super) colour: [f32; 4],
    /// Where it lies on the scale of the colours, 0 to 1.
    pub(super) fraction: f32,
}

impl ScenePoint {
    /// Where it is shown on the way from without (0) to with (1) refraction.
    pub(super) fn between(&self, refraction: f32) -> Vec3 {
        between([self.place, self.unrefracted], refraction)
    }
}

/// On the way from without (0) to with (1) refraction.
pub(super) fn between([place, unrefracted]: [Vec3; 2], refraction: f32) -> Vec3 {
    unrefracted + (place - unrefracted) * refraction
}

/// How points are drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PointStyle {
    /// Diameter, device px.
    pub(super) size: f32,
    /// The colour of the rim that sets a point off.
    pub(super) rim: [f32; 3],
    /// 0: without refraction, 1: with.
    pub(super) refraction: f32,
    /// Points beyond these fractions of the scale are hidden.
    pub(super) range: [f32; 2],
    /// Points beyond it are hidden.
    pub(super) slab: Slab,
    /// Only a ring, over everything.
    pub(super) ring: bool,
}

/// What draws points.
pub(super) struct PointProgram {
    context: Context,
    program: Program,
}

impl PointProgram {
    pub(super) fn new(context: &Context) -> Result<Rc<Self>, CoreError> {
        Ok(Rc::new(Self {
            context: context.clone(),
            program: Program::from_source(
                context,
                include_str!("shaders/points.vert"),
                include_str!("shaders/points.frag"),
            )?,
        }))
    }
}

/// Points in graphics memory, and those that are still to go there.
pub(super) struct Points {
    with: Rc<PointProgram>,
    batches: Vec<Batch>,
    /// How many points there are to be.
    count: usize,
    /// How many batches have their colours as they are to be.
    coloured: usize,
    /// How many of them are drawn.
    drawn: usize,
}

struct Batch {
    places: VertexBuffer<Vec3>,
    unrefracted: VertexBuffer<Vec3>,
    colours: VertexBuffer<Vector4<u8>>,
    fractions: VertexBuffer<f32>,
    count: usize,
}

impl Points {
    pub(super) const fn new(with: Rc<PointProgram>) -> Self {
        Self {
            with,
            batches: Vec::new(),
            count: 0,
            coloured: 0,
            drawn: 0,
        }
    }

    /// Makes room for so many other points.
    pub(super) fn clear(&mut self, count: usize) {
        self.batches.clear();
        self.count = count;
        self.coloured = 0;
    }

    /// The points get other colours.
    pub(super) const fn fade(&mut self) {
        self.coloured = 0;
    }

    /// Whether all points are on the card as they are to be.
    pub(super) fn is_filled(&self) -> bool {
        self.coloured == self.wanted()
    }

    /// None of them is drawn any more.
    pub(super) const fn wipe(&mut self) {
        self.drawn = 0;
    }

    /// How many points are drawn, rounded up to whole batches.
    pub(super) const fn drawn(&self) -> usize {
        self.drawn * BATCH
    }

    /// Whether all points are drawn.
    pub(super) fn is_drawn(&self) -> bool {
        self.drawn == self.wanted()
    }

    /// How many batches there are to be.
    fn wanted(&self) -> usize {
        self.count.div_ceil(BATCH)
    }

    /// Fills the next batch; `point` gives a point by its number.
    pub(super) fn fill_next(&mut self, point: impl Fn(usize) -> Option<ScenePoint>) {
        let (next, step) = (self.coloured, self.wanted());
        let points: Vec<_> = (next..self.count)
            .step_by(step.max(1))
            .filter_map(point)
            .collect();
        if next == self.batches.len() {
            let places: Vec<_> = points.iter().map(|p| p.place).collect();
            let unrefracted: Vec<_> = points.iter().map(|p| p.unrefracted).collect();
            let context = &self.with.context;
            self.batches.push(Batch {
                places: VertexBuffer::new_with_data(context, &places),
                unrefracted: VertexBuffer::new_with_data(context, &unrefracted),
                colours: VertexBuffer::new(context),
                fractions: VertexBuffer::new(context),
                count: points.len(),
            });
        }
        let colours: Vec<_> = points.iter().map(|p| bytes(p.colour)).collect();
        let fractions: Vec<_> = points.iter().map(|p| p.fraction).collect();
        let batch = &mut self.batches[next];
        batch.colours.fill(&colours);
        batch.fractions.fill(&fractions);
        self.coloured += 1;
    }

    /// Puts a few points in the place of those there were, at once.
    pub(super) fn fill(&mut self, points: &[ScenePoint]) {
        self.clear(points.len());
        while !self.is_filled() {
            self.fill_next(|index| points.get(index).copied());
        }
    }

    /// Draws points to those that are drawn, until there are about `most`: an even sample of them all.
    pub(super) fn draw(
        &mut self,
        matrix: Mat4,
        viewport: Viewport,
        style: PointStyle,
        most: usize,
    ) {
        let program = &self.with.program;
        let states = RenderStates {
            blend: OVER,
            depth_test: if style.ring {
                DepthTest::Always
            } else {
                DepthTest::Less
            },
            write_mask: if style.ring {
                WriteMask::COLOR
            } else {
                WriteMask::COLOR_AND_DEPTH
            },
            ..Default::default()
        };
        let there = most.div_ceil(BATCH).min(self.coloured);
        for batch in self.batches.iter().take(there).skip(self.drawn) {
            program.use_uniform("world_to_clip", matrix);
            program.use_uniform("size", style.size);
            program.use_uniform("rim", Vec3::from(style.rim));
            program.use_uniform("refraction", style.refraction);
            program.use_uniform("range", Vec2::from(style.range));
            program.use_uniform("slab_normal", style.slab.normal);
            program.use_uniform("slab", Vec2::from(style.slab.range));
            program.use_uniform("ring", f32::from(u8::from(style.ring)));
            program.use_vertex_attribute("place", &batch.places);
            program.use_vertex_attribute("unrefracted", &batch.unrefracted);
            program.use_vertex_attribute("colour", &batch.colours);
            program.use_vertex_attribute("fraction", &batch.fractions);
            program.draw_with(states, viewport, || {
                // SAFETY: `draw_with` has bound the program, and every attribute holds `count` values.
                // three-d itself draws triangles only, so points have to go past it.
                unsafe {
                    self.with.context.draw_arrays(POINTS, 0, batch.count as i32);
                }
            });
        }
        self.drawn = self.drawn.max(there);
    }
}

/// A colour as bytes: a quarter of the memory, and as many shades as a screen has.
fn bytes(colour: [f32; 4]) -> Vector4<u8> {
    Vector4::from(colour.map(|part| (part * 255.0).round() as u8))
}
