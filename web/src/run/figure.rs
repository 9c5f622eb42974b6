//! What the page asks a worker to draw.

use serde::{Deserialize, Serialize};
use snellius::export::{IndexFigure, ReconstructionResult, ResultFigure};
use snellius::plot::{Axis, Drawing, Mark, Plot, PlotError};
use snellius::scan::KnownKind;

use super::packed::{self, Packed};
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
    Drawn(Box<Drawn>),
    Table(String),
    /// There is no such figure of this scan.
    None(PlotError),
}

/// A drawing as it crosses to the page: thousands of values as objects of JavaScript would keep its thread.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Drawn {
    pub(crate) title: String,
    pub(crate) svg: String,
    /// Width and height, px.
    pub(crate) size: [u32; 2],
    /// The values that are told where the pointer is.
    #[serde(with = "packed")]
    pub(crate) marks: Vec<MarkAt>,
    /// What they say, a line each.
    words: String,
}

/// Where a value is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MarkAt {
    /// Px from top left.
    pub(crate) at: [f32; 2],
    /// The view it comes from, if it is one view's.
    pub(crate) view: Option<usize>,
}

impl Drawn {
    fn of(drawing: Drawing) -> Self {
        let at = |mark: &Mark| MarkAt {
            at: mark.at,
            view: mark.view,
        };
        let words = drawing
            .marks
            .iter()
            .map(|mark| mark.words.replace('\n', " "));
        Self {
            marks: drawing.marks.iter().map(at).collect(),
            words: words.collect::<Vec<_>>().join("\n"),
            title: drawing.title,
            svg: drawing.svg,
            size: drawing.size,
        }
    }

    /// What a value says.
    pub(crate) fn words_of(&self, mark: usize) -> Option<&str> {
        self.words.split('\n').nth(mark)
    }
}

impl Packed for MarkAt {
    const COUNT: usize = 3;

    fn pack(&self, numbers: &mut Vec<f32>) {
        numbers.extend(self.at);
        numbers.push(self.view.map_or(-1.0, |view| view as f32));
    }

    fn unpack(n: &[f32]) -> Self {
        Self {
            at: [n[0], n[1]],
            view: (n[2] >= 0.0).then_some(n[2] as usize),
        }
    }
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
                FigureForm::Drawing(size) => Figured::Drawn(Box::new(Drawn::of(plot.draw(size)?))),
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
