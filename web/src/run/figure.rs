//! What the page asks a worker to draw.

use serde::{Deserialize, Serialize};
use snellius::export::{IndexFigure, ReconstructionResult, ResultFigure};
use snellius::plot::{Axis, Drawing, Plot, PlotError};
use snellius::scan::KnownKind;

use super::study::{CurveKind, Study, StudyCurve};

/// A figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum FigureOf {
    /// Of the result.
    Result(ResultFigure),
    /// One of the curves over the liquid's index, by its number in the study.
    Curve(usize),
}

/// What a figure shall be made into.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum FigureForm {
    /// A drawing of so many px.
    Drawing([u32; 2]),
    /// A table of all its values (CSV).
    Table,
}

/// What became of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum Figured {
    Drawn(Box<Drawing>),
    Table(String),
    /// There is no such figure of this scan.
    None(PlotError),
}

impl FigureOf {
    /// Makes it from what was measured, and from what was said of the index.
    pub(super) fn make(
        self,
        form: FigureForm,
        result: &ReconstructionResult,
        study: Option<&Study>,
    ) -> Figured {
        let plot = match self {
            Self::Result(figure) => result.figure(figure),
            Self::Curve(number) => study
                .and_then(|study| study.curves.get(number))
                .map(|curve| Plot::Flat(index_figure(curve).figure()))
                .ok_or(PlotError::Nothing),
        };
        let made = plot.and_then(|plot| {
            Ok(match form {
                FigureForm::Drawing(size) => Figured::Drawn(Box::new(plot.draw(size)?)),
                FigureForm::Table => Figured::Table(plot.csv()),
            })
        });
        made.unwrap_or_else(Figured::None)
    }
}

fn index_figure(curve: &StudyCurve) -> IndexFigure {
    let (title, quantity) = words(curve.kind);
    let pair = |(index, value): (f64, f64)| [index, value];
    IndexFigure {
        title: title.to_owned(),
        quantity,
        points: curve.points.iter().copied().map(pair).collect(),
        known: match curve.kind {
            // Of a flat face nothing is known but that its unevenness is least.
            CurveKind::Known(KnownKind::Flatness) => None,
            _ => curve.known,
        },
        interval: curve.interval,
        minimum: curve.minimum.map(pair),
    }
}

fn words(kind: CurveKind) -> (&'static str, Axis) {
    match kind {
        CurveKind::RayDistance => (
            "Ray distances against n, eq. (3): their sum over their number",
            Axis::new("Mean ray distance", "mm", 4),
        ),
        CurveKind::WeightedRayDistance => (
            "Ray distances over their \u{3c3} against n, robust",
            Axis::new("Mean loss", "", 3),
        ),
        CurveKind::Known(KnownKind::PlaneAngle) => (
            "Angle of two faces against n, eq. (4)",
            Axis::new("Angle", "\u{b0}", 2),
        ),
        CurveKind::Known(KnownKind::EdgeLength) => (
            "Length of an edge against n, eq. (4)",
            Axis::new("Length", "mm", 3),
        ),
        CurveKind::Known(KnownKind::Flatness) => (
            "Unevenness of a flat face against n, eq. (4)",
            Axis::new("RMS off the face", "mm", 4),
        ),
        CurveKind::Known(KnownKind::Radius) => {
            ("Radius against n, eq. (4)", Axis::new("Radius", "mm", 3))
        }
    }
}
