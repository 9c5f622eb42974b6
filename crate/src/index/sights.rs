//! What the index is estimated from: the spots that lie on the wall and on the object.

use nalgebra::{Matrix2, Vector2};

use crate::camera::Pixel;
use crate::object::{Choice, Setup, object_grain};
use crate::scan::{InsideMedium, sweeps};
use crate::spots::Spots;

/// A spot on the wall's outer face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VesselSight {
    /// The view.
    pub view: usize,
    /// Where the outer face's own glow is seen.
    pub pixel: Pixel,
    /// How that moves per unit of the inner face's share of the light, px, with its sign turned.
    pub by_glow_share: Vector2<f64>,
    /// Covariance of the centroid, px^2.
    pub covariance: Matrix2<f64>,
}

/// A spot on the object, behind the liquid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObjectSight {
    /// The view.
    pub view: usize,
    /// The centroid.
    pub pixel: Pixel,
    /// Its covariance, px^2.
    pub covariance: Matrix2<f64>,
}

/// All of them, and which views belong together.
#[derive(Clone, Debug, PartialEq)]
pub struct Sights {
    /// The wall's, of every view that has any.
    pub vessel: Vec<VesselSight>,
    /// The object's, of the views in which the beam enters the liquid: the others say nothing of it.
    pub object: Vec<ObjectSight>,
    /// The sweep of each view.
    pub sweep_of: Vec<usize>,
}

/// No centroid is trusted further than this along each axis, px: the camera's noise model leaves out how
/// light falls off over an oblique face, and how a pixel answers it, and would let a few bright spots decide.
/// Simulated pictures bear it out: docs/refractive-index.md.
const LEAST_SIGMA: f64 = 0.05;

/// Some points of a view, evenly along its line: neighbours say the same of the index. A beam has one.
fn some<T>(points: &[T]) -> impl Iterator<Item = &T> {
    const MOST: usize = 24;
    points.iter().step_by(points.len().div_ceil(MOST).max(1))
}

impl Sights {
    /// Gathers them from what vessel and object were found to be.
    pub fn new(setup: &Setup, spots: &[Spots], choices: &[Choice]) -> Self {
        let grain = object_grain(setup, choices);
        let floor = Matrix2::identity() * (LEAST_SIGMA * LEAST_SIGMA);
        let vessel = setup.vessel.points.iter().enumerate();
        let vessel = vessel.flat_map(|(view, points)| {
            some(points).map(move |point| VesselSight {
                view,
                pixel: point.pixel,
                by_glow_share: point.by_glow_share,
                covariance: spots[view].spots[point.spot].covariance_with(setup.vessel.grain.value)
                    + floor,
            })
        });
        let in_liquid = |view: &usize| setup.stations[*view].inside == InsideMedium::Liquid;
        let object = (0..choices.len()).filter(in_liquid).flat_map(|view| {
            some(&choices[view].points).map(move |point| {
                let spot = &spots[view].spots[point.spot];
                ObjectSight {
                    view,
                    pixel: spot.pixel(),
                    covariance: spot.covariance_with(grain) + floor,
                }
            })
        });
        Self {
            vessel: vessel.collect(),
            object: object.collect(),
            sweep_of: sweeps(setup.stations),
        }
    }
}
