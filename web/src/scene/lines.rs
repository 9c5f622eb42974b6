//! Lines of a width in pixels (WebGL's own are one pixel thin): each is a strip that the graphics card
//! turns towards the eye.

use std::rc::Rc;

use three_d::{
    Context, CoreError, DepthTest, Mat4, Program, RenderStates, Vec2, Vec3, Vec4, VertexBuffer,
    Viewport, WriteMask,
};

use super::blend::OVER;
use super::section::Slab;

/// A line to draw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Line {
    pub(super) start: Vec3,
    pub(super) end: Vec3,
    pub(super) colour: [f32; 4],
}

impl Line {
    pub(super) const fn new(start: Vec3, end: Vec3, colour: [f32; 4]) -> Self {
        Self { start, end, colour }
    }
}

/// The lines that join places one after the other.
pub(super) fn chain(places: &[Vec3], colour: [f32; 4]) -> impl Iterator<Item = Line> + '_ {
    places
        .windows(2)
        .map(move |pair| Line::new(pair[0], pair[1], colour))
}

/// What draws lines.
pub(super) struct LineProgram {
    context: Context,
    program: Program,
}

impl LineProgram {
    pub(super) fn new(context: &Context) -> Result<Rc<Self>, CoreError> {
        Ok(Rc::new(Self {
            context: context.clone(),
            program: Program::from_source(
                context,
                include_str!("shaders/lines.vert"),
                include_str!("shaders/lines.frag"),
            )?,
        }))
    }
}

/// Lines in graphics memory.
pub(super) struct Lines {
    with: Rc<LineProgram>,
    starts: VertexBuffer<Vec3>,
    ends: VertexBuffer<Vec3>,
    corners: VertexBuffer<Vec2>,
    colours: VertexBuffer<Vec4>,
}

/// Two triangles: how far along the line (0 to 1), and on which side.
const CORNERS: [(f32, f32); 6] = [
    (0.0, -1.0),
    (1.0, -1.0),
    (1.0, 1.0),
    (0.0, -1.0),
    (1.0, 1.0),
    (0.0, 1.0),
];

impl Lines {
    pub(super) fn new(with: &Rc<LineProgram>) -> Self {
        let context = &with.context;
        Self {
            with: Rc::clone(with),
            starts: VertexBuffer::new(context),
            ends: VertexBuffer::new(context),
            corners: VertexBuffer::new(context),
            colours: VertexBuffer::new(context),
        }
    }

    pub(super) fn fill(&mut self, lines: &[Line]) {
        self.starts.fill(&six(lines, |line| line.start));
        self.ends.fill(&six(lines, |line| line.end));
        self.colours
            .fill(&six(lines, |line| Vec4::from(line.colour)));
        let corners = lines.iter().flat_map(|_| CORNERS);
        let corners: Vec<_> = corners
            .map(|(along, side)| Vec2::new(along, side))
            .collect();
        self.corners.fill(&corners);
    }

    /// Draws the lines `width` device px wide, as far as they lie in a slab.
    pub(super) fn draw(&self, matrix: Mat4, viewport: Viewport, width: f32, slab: Slab) {
        let count = self.corners.vertex_count();
        if count == 0 {
            return;
        }
        let program = &self.with.program;
        program.use_uniform("world_to_clip", matrix);
        program.use_uniform(
            "picture",
            Vec2::new(viewport.width as f32, viewport.height as f32),
        );
        program.use_uniform("width", width);
        program.use_uniform("slab_normal", slab.normal);
        program.use_uniform("slab", Vec2::from(slab.range));
        program.use_vertex_attribute("start", &self.starts);
        program.use_vertex_attribute("end", &self.ends);
        program.use_vertex_attribute("corner", &self.corners);
        program.use_vertex_attribute("colour", &self.colours);
        let states = RenderStates {
            blend: OVER,
            depth_test: DepthTest::LessOrEqual,
            write_mask: WriteMask::COLOR,
            ..Default::default()
        };
        program.draw_arrays(states, viewport, count);
    }
}

fn six<T: Copy>(lines: &[Line], of: impl Fn(&Line) -> T) -> Vec<T> {
    lines.iter().flat_map(|line| [of(line); 6]).collect()
}
