//! Flat faces that light passes through: the vessel's wall.

use three_d::{
    Context, CoreError, Mat4, Program, RenderStates, Vec2, Vec3, Vec4, VertexBuffer, Viewport,
    WriteMask,
};

use super::blend::OVER;
use super::section::Slab;

/// A triangle to draw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Face {
    pub(super) corners: [Vec3; 3],
    pub(super) colour: [f32; 4],
}

/// Faces in graphics memory.
pub(super) struct Faces {
    program: Program,
    places: VertexBuffer<Vec3>,
    colours: VertexBuffer<Vec4>,
}

impl Faces {
    pub(super) fn new(context: &Context) -> Result<Self, CoreError> {
        Ok(Self {
            program: Program::from_source(
                context,
                include_str!("shaders/faces.vert"),
                include_str!("shaders/faces.frag"),
            )?,
            places: VertexBuffer::new(context),
            colours: VertexBuffer::new(context),
        })
    }

    pub(super) fn fill(&mut self, faces: &[Face]) {
        let places: Vec<_> = faces.iter().flat_map(|face| face.corners).collect();
        let colours = faces.iter().flat_map(|face| [Vec4::from(face.colour); 3]);
        self.places.fill(&places);
        self.colours.fill(&colours.collect::<Vec<_>>());
    }

    /// Draws the faces over what stands behind them, hiding nothing that is drawn later.
    pub(super) fn draw(&self, matrix: Mat4, viewport: Viewport, slab: Slab) {
        let count = self.places.vertex_count();
        if count == 0 {
            return;
        }
        self.program.use_uniform("world_to_clip", matrix);
        self.program.use_uniform("slab_normal", slab.normal);
        self.program.use_uniform("slab", Vec2::from(slab.range));
        self.program.use_vertex_attribute("place", &self.places);
        self.program.use_vertex_attribute("colour", &self.colours);
        let states = RenderStates {
            blend: OVER,
            write_mask: WriteMask::COLOR,
            ..Default::default()
        };
        self.program.draw_arrays(states, viewport, count);
    }
}
