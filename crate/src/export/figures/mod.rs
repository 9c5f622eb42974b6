//! Figures of a result: those of the paper, and what tells how far to trust it.

mod birds_eye;
mod curve;
mod ray_distances;
mod residuals;
mod top_view;
mod view;

use serde::{Deserialize, Serialize};

use super::{ReconstructionResult, ViewResult};
use crate::plot::{Plot, PlotError};

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
    /// A figure, to be drawn or written as a table.
    pub fn figure(&self, figure: ResultFigure) -> Result<Plot, PlotError> {
        Ok(match figure {
            ResultFigure::TopView => Plot::Flat(top_view::figure(self, true)?),
            ResultFigure::TopViewStraight => Plot::Flat(top_view::figure(self, false)?),
            ResultFigure::BirdsEye => Plot::Space(birds_eye::figure(self)?),
            ResultFigure::RayDistances => Plot::Flat(ray_distances::by_view(self)?),
            ResultFigure::RayDistanceHistogram => Plot::Flat(ray_distances::histogram(self)?),
            ResultFigure::WallResiduals => Plot::Flat(residuals::figure(self)?),
        })
    }

    /// The views with their numbers.
    fn numbered(&self) -> impl Iterator<Item = (usize, &ViewResult)> {
        self.views.iter().enumerate()
    }

    fn view_names(&self) -> Vec<String> {
        self.views.iter().map(|view| view.id.clone()).collect()
    }
}

/// How large dots are drawn, px: of many each is small.
const fn radius(dots: usize) -> f64 {
    match dots {
        0..400 => 3.0,
        400..1500 => 2.0,
        _ => 1.3,
    }
}
