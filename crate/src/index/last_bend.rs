//! The part of the light's way that depends on the liquid's index, and nothing else of it.
//!
//! Where a ray meets the wall's two faces, and how it runs within the wall, does not depend on the
//! liquid. So all of that is traced once, and for another index only the last refraction is done again.
//! With T the part of the light's direction (within the wall) along the inner face, N the face's normal,
//! and r = n2/n3, Snell's law in vector form, eq. (2), is
//!
//! ```text
//! t(n3) = r T - sqrt(1 - r^2 T.T) N
//! ```
//!
//! Behind a far wall parallel to the first the light runs as it did in air; there only its place depends
//! on the index: it is shifted by D r T / sqrt(1 - r^2 T.T), D the two walls' distance.

use nalgebra::Vector3;

use crate::geometry::{Approach, Direction, Point, Ray, World, closest_approach};
use crate::optics::Stack;

/// A ray up to where the liquid's index begins to matter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LastBend {
    /// T: the part along the inner face of the unit vector within the wall.
    along: Vector3<f64>,
    /// N: the face's unit normal there, towards the rig.
    normal: Vector3<f64>,
    beyond: Beyond,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Beyond {
    /// The light ends in the liquid; it enters there.
    Liquid { entry: Point<World> },
    /// The light crosses the liquid and a far wall.
    FarWall {
        /// Where it would leave the far wall if it had not been shifted within the liquid.
        unshifted: Point<World>,
        /// How it runs there.
        direction: Direction<World>,
        /// From inner face to inner face, mm.
        distance: f64,
    },
}

impl LastBend {
    /// Traces a ray through a stack up to the liquid, which lies behind its second face. `None` if it
    /// does not get there.
    pub(super) fn new(stack: &Stack, far_distance: Option<f64>, ray: &Ray<World>) -> Option<Self> {
        let outer = Stack {
            outside: stack.outside,
            interfaces: stack.interfaces[..1].to_vec(),
        };
        let within = outer.trace(ray).ok()?;
        let inner = &stack.interfaces[1];
        let hit = inner.surface.hit(&within)?;
        let normal = hit.normal.vector();
        let light = within.direction.vector();
        let along = light - normal * light.dot(&normal);
        let beyond = match far_distance {
            None => Beyond::Liquid { entry: hit.point },
            Some(distance) => {
                let out = stack.trace(ray).ok()?;
                let ratio = outer.innermost_index() / inner.index_behind;
                Beyond::FarWall {
                    unshifted: out.origin + along * -(distance * tangent(along, ratio)?),
                    direction: out.direction,
                    distance,
                }
            }
        };
        Some(Self {
            along,
            normal,
            beyond,
        })
    }

    /// The light behind the last face; `ratio` is the wall's index over the liquid's. `None` where it is
    /// thrown back.
    pub(super) fn ray(&self, ratio: f64) -> Option<Ray<World>> {
        match &self.beyond {
            Beyond::Liquid { entry } => {
                let cosine = cosine(self.along, ratio)?;
                let bent = self.along * ratio - self.normal * cosine;
                Some(Ray::new(*entry, Direction::assume_unit(bent)))
            }
            Beyond::FarWall {
                unshifted,
                direction,
                distance,
            } => {
                let shift = self.along * (distance * tangent(self.along, ratio)?);
                Some(Ray::new(*unshifted + shift, *direction))
            }
        }
    }
}

/// The cosine of the angle in the liquid.
fn cosine(along: Vector3<f64>, ratio: f64) -> Option<f64> {
    let squared = 1.0 - ratio * ratio * along.norm_squared();
    (squared > 0.0).then(|| squared.sqrt())
}

/// The shift along the face per unit of depth, in units of T.
fn tangent(along: Vector3<f64>, ratio: f64) -> Option<f64> {
    Some(ratio / cosine(along, ratio)?)
}

/// The beam and a line of sight up to where the liquid's index begins to matter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BendPair {
    beam: LastBend,
    sight: LastBend,
    terms: GapTerms,
}

/// The signed ray distance as a function of r = n2/n3 alone, with a, b the cosines in the liquid of the
/// beam and the line of sight.
#[derive(Clone, Copy, Debug, PartialEq)]
enum GapTerms {
    /// w . (t1 x t2) / |t1 x t2| is a quotient of two forms in r^2, r a, r b and a b.
    Liquid {
        sines: [f64; 2],
        above: [f64; 4],
        below: [f64; 4],
    },
    /// Behind a far wall the directions stay, and the gap moves with the two shifts.
    FarWall {
        sines: [f64; 2],
        fixed: f64,
        shifts: [f64; 2],
    },
}

impl BendPair {
    pub(super) fn new(beam: LastBend, sight: LastBend) -> Option<Self> {
        let terms = GapTerms::new(&beam, &sight)?;
        Some(Self { beam, sight, terms })
    }

    /// Where the two rays come closest.
    pub(super) fn approach(&self, ratio: f64) -> Option<Approach<World>> {
        closest_approach(&self.beam.ray(ratio)?, &self.sight.ray(ratio)?).ok()
    }

    /// The signed ray distance alone; not a number where one of the rays is thrown back.
    #[inline]
    pub(super) fn gap(&self, ratio: f64) -> f64 {
        let r2 = ratio * ratio;
        match &self.terms {
            GapTerms::Liquid {
                sines,
                above,
                below,
            } => {
                let a = (1.0 - r2 * sines[0]).sqrt();
                let b = (1.0 - r2 * sines[1]).sqrt();
                let form = |f: &[f64; 4]| r2 * f[0] - ratio * (a * f[1] + b * f[2]) + a * b * f[3];
                let cosine = form(below);
                form(above) / (1.0 - cosine * cosine).sqrt()
            }
            GapTerms::FarWall {
                sines,
                fixed,
                shifts,
            } => {
                let a = (1.0 - r2 * sines[0]).sqrt();
                let b = (1.0 - r2 * sines[1]).sqrt();
                fixed + ratio * (shifts[1] / b - shifts[0] / a)
            }
        }
    }
}

impl GapTerms {
    fn new(beam: &LastBend, sight: &LastBend) -> Option<Self> {
        let sines = [beam.along.norm_squared(), sight.along.norm_squared()];
        match (&beam.beyond, &sight.beyond) {
            (Beyond::Liquid { entry: first }, Beyond::Liquid { entry: second }) => {
                let between = *second - *first;
                let forms = |f: &dyn Fn(&Vector3<f64>, &Vector3<f64>) -> f64| {
                    [
                        f(&beam.along, &sight.along),
                        f(&beam.normal, &sight.along),
                        f(&beam.along, &sight.normal),
                        f(&beam.normal, &sight.normal),
                    ]
                };
                Some(Self::Liquid {
                    sines,
                    above: forms(&|a, b| between.dot(&a.cross(b))),
                    below: forms(&|a, b| a.dot(b)),
                })
            }
            (
                Beyond::FarWall {
                    unshifted: first,
                    direction: d1,
                    distance,
                },
                Beyond::FarWall {
                    unshifted: second,
                    direction: d2,
                    ..
                },
            ) => {
                let across = d1.vector().cross(&d2.vector()).try_normalize(1e-9)?;
                Some(Self::FarWall {
                    sines,
                    fixed: (*second - *first).dot(&across),
                    shifts: [
                        distance * beam.along.dot(&across),
                        distance * sight.along.dot(&across),
                    ],
                })
            }
            _ => None,
        }
    }
}
