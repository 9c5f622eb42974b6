//! Figures of a result: those of the paper, and what tells how far to trust it.

mod birds_eye;
mod curve;
mod ray_distances;
mod residuals;
mod top_view;
mod view;

use serde::{Deserialize, Serialize};

use super::{ReconstructionResult, ViewResult};
use crate::plot::{Drawing, PlotError};

pub use curve::IndexFigure;

/// A figure of a result.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ResultFigure {
    /// Vessel and object from above: the paper's Fig. 11 (a).
    TopView,
    /// The same by straight rays: the paper's Fig. 11 (b).
    TopViewStraight,
    /// Vessel and object from above and aside: the paper's Fig. 10.
    BirdsEye,
    /// The ray distance of each point, view by view.
    RayDistances,
    /// How often which ray distance occurs.
    RayDistanceHistogram,
    /// How far the wall's points lie off the fitted wall, over the wall.
    WallResiduals,
}

impl ReconstructionResult {
    /// Draws a figure, so many px wide and high.
    pub fn figure(&self, figure: ResultFigure, size: [u32; 2]) -> Result<Drawing, PlotError> {
        match figure {
            ResultFigure::TopView => top_view::figure(self, true)?.draw(size),
            ResultFigure::TopViewStraight => top_view::figure(self, false)?.draw(size),
            ResultFigure::BirdsEye => birds_eye::figure(self)?.draw(size),
            ResultFigure::RayDistances => ray_distances::by_view(self)?.draw(size),
            ResultFigure::RayDistanceHistogram => ray_distances::histogram(self)?.draw(size),
            ResultFigure::WallResiduals => residuals::figure(self)?.draw(size),
        }
    }

    /// The views with their numbers.
    fn numbered(&self) -> impl Iterator<Item = (usize, &ViewResult)> {
        self.views.iter().enumerate()
    }
}

/// A view's name in a figure.
fn name(view: &ViewResult) -> String {
    format!("View {}", view.id)
}

/// How large dots are drawn, px: of many each is small.
const fn radius(dots: usize) -> f64 {
    match dots {
        0..400 => 3.0,
        400..1500 => 2.0,
        _ => 1.3,
    }
}
