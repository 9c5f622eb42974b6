//! Points: one GL point each, round, of a size in pixels, with a colour of its own. Each has two places,
//! with and without refraction, and the graphics card goes from one to the other.

use three_d::context::POINTS;
use three_d::{
    Context, CoreError, DepthTest, HasContext, Mat4, Program, RenderStates, Vec2, Vec3, Vec4,
    VertexBuffer, Viewport, WriteMask,
};

use super::blend::OVER;
use super::section::Slab;

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
        self.unrefracted + (self.place - self.unrefracted) * refraction
    }
}

/// How points are drawn.
#[derive(Clone, Copy, Debug)]
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

/// Points in graphics memory.
pub(super) struct Points {
    context: Context,
    program: Program,
    places: VertexBuffer<Vec3>,
    unrefracted: VertexBuffer<Vec3>,
    colours: VertexBuffer<Vec4>,
    fractions: VertexBuffer<f32>,
    count: usize,
}

impl Points {
    pub(super) fn new(context: &Context) -> Result<Self, CoreError> {
        Ok(Self {
            context: context.clone(),
            program: Program::from_source(
                context,
                include_str!("shaders/points.vert"),
                include_str!("shaders/points.frag"),
            )?,
            places: VertexBuffer::new(context),
            unrefracted: VertexBuffer::new(context),
            colours: VertexBuffer::new(context),
            fractions: VertexBuffer::new(context),
            count: 0,
        })
    }

    pub(super) fn fill(&mut self, points: &[ScenePoint]) {
        let places: Vec<_> = points.iter().map(|p| p.place).collect();
        let unrefracted: Vec<_> = points.iter().map(|p| p.unrefracted).collect();
        let colours: Vec<_> = points.iter().map(|p| Vec4::from(p.colour)).collect();
        let fractions: Vec<_> = points.iter().map(|p| p.fraction).collect();
        self.fractions.fill(&fractions);
        self.places.fill(&places);
        self.unrefracted.fill(&unrefracted);
        self.colours.fill(&colours);
        self.count = points.len();
    }

    pub(super) fn draw(&self, matrix: Mat4, viewport: Viewport, style: PointStyle) {
        if self.count == 0 {
            return;
        }
        let program = &self.program;
        program.use_uniform("world_to_clip", matrix);
        program.use_uniform("size", style.size);
        program.use_uniform("rim", Vec3::from(style.rim));
        program.use_uniform("refraction", style.refraction);
        program.use_uniform("range", Vec2::from(style.range));
        program.use_uniform("slab_normal", style.slab.normal);
        program.use_uniform("slab", Vec2::from(style.slab.range));
        program.use_uniform("ring", f32::from(u8::from(style.ring)));
        program.use_vertex_attribute("place", &self.places);
        program.use_vertex_attribute("unrefracted", &self.unrefracted);
        program.use_vertex_attribute("colour", &self.colours);
        program.use_vertex_attribute("fraction", &self.fractions);
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
        program.draw_with(states, viewport, || {
            // SAFETY: `draw_with` has bound the program, and every attribute holds `count` values.
            // three-d itself draws triangles only, so points have to go past it.
            unsafe { self.context.draw_arrays(POINTS, 0, self.count as i32) }
        });
    }
}
