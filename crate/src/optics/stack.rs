use super::{Surface, TotalReflection, refract};
use crate::geometry::{Point, Ray, World};

/// A face and the medium behind it.
#[derive(Clone, Debug, PartialEq)]
pub struct Interface {
    /// The face.
    pub surface: Surface,
    /// Refractive index of the medium behind it.
    pub index_behind: f64,
}

/// N media parted by N - 1 faces, in the order in which light from the rig meets them.
#[derive(Clone, Debug, PartialEq)]
pub struct Stack {
    /// Refractive index of the medium the rig stands in.
    pub outside: f64,
    /// The faces, from the rig inwards.
    pub interfaces: Vec<Interface>,
}

/// Light through a stack, bend by bend.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// Where the light starts and where it crosses each face.
    pub vertices: Vec<Point<World>>,
    /// The light behind the last face; its origin is the last vertex.
    pub last: Ray<World>,
}

/// Light that does not get through, and the face that stops it.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("face {face}: {problem}")]
pub struct TraceError {
    /// Which face, counted from 0 at the rig.
    pub face: usize,
    /// What happens there.
    pub problem: TraceProblem,
}

/// What can stop light at a face.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum TraceProblem {
    /// The light never meets the face.
    #[error("the ray misses it")]
    Miss,
    /// The light meets the face where it was not measured.
    #[error("outside the measured wall")]
    Unmeasured,
    /// The light is thrown back.
    #[error(transparent)]
    TotalReflection(#[from] TotalReflection),
}

impl Stack {
    /// Follows a ray through every face and returns the light behind the last one.
    ///
    /// At each face it applies [`refract`]; section II-D of the paper does this for a wall's two faces.
    pub fn trace(&self, ray: &Ray<World>) -> Result<Ray<World>, TraceError> {
        self.follow(ray, |_| {})
    }

    /// As [`Stack::trace`], and keeps where the light bends.
    pub fn path(&self, ray: &Ray<World>) -> Result<Path, TraceError> {
        let mut vertices = vec![ray.origin];
        let last = self.follow(ray, |bend| vertices.push(bend))?;
        Ok(Path { vertices, last })
    }

    /// Index of the last medium.
    pub fn innermost_index(&self) -> f64 {
        self.interfaces
            .last()
            .map_or(self.outside, |last| last.index_behind)
    }

    fn follow(
        &self,
        ray: &Ray<World>,
        mut at_bend: impl FnMut(Point<World>),
    ) -> Result<Ray<World>, TraceError> {
        let mut light = *ray;
        let mut index = self.outside;
        for (face, interface) in self.interfaces.iter().enumerate() {
            let stopped = |problem| TraceError { face, problem };
            let hit = interface
                .surface
                .hit(&light)
                .ok_or_else(|| stopped(missed(&interface.surface)))?;
            let bent = refract(light.direction, hit.normal, index, interface.index_behind)
                .map_err(|e| stopped(e.into()))?;
            light = Ray::new(hit.point, bent);
            index = interface.index_behind;
            at_bend(hit.point);
        }
        Ok(light)
    }
}

/// A free form ends where its measurement does; other shapes go on, so a ray that does not meet them
/// passes by.
const fn missed(surface: &Surface) -> TraceProblem {
    match surface {
        Surface::Freeform(_) => TraceProblem::Unmeasured,
        _ => TraceProblem::Miss,
    }
}
