//! A quantity over the refractive index: the paper's eq. (3) and its Fig. 12.

use crate::plot::{Axis, Dot, Figure, Ink, Layer};

/// A curve over the index, and what to say of it.
#[derive(Clone, Debug, PartialEq)]
pub struct IndexFigure {
    /// What it shows.
    pub title: String,
    /// The quantity.
    pub quantity: Axis,
    /// Index and quantity.
    pub points: Vec<[f64; 2]>,
    /// What the quantity is known to be.
    pub known: Option<f64>,
    /// Where the index lies 95 times in 100.
    pub interval: Option<[f64; 2]>,
    /// Where the curve is lowest, if that tells something.
    pub minimum: Option<[f64; 2]>,
}

impl IndexFigure {
    /// It as a figure.
    pub fn figure(&self) -> Figure {
        let index = Axis::new("Refractive index n", "", 3);
        let mut figure = Figure::new(self.title.clone(), index, self.quantity.clone());
        figure.layers.extend(self.interval.map(Layer::Band));
        figure.layers.extend(self.known.map(Layer::Level));
        figure.layers.push(Layer::Line {
            ink: Ink::Curve,
            series: Some("curve"),
            points: self.points.clone(),
        });
        figure.layers.extend(self.minimum.map(|at| Layer::Dots {
            series: "minimum",
            radius: 4.0,
            dots: vec![Dot::bare(at, Ink::Minimum)],
        }));
        figure
    }
}
