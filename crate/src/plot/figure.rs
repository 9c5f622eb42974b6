//! What a figure is made of, before it is drawn.

use super::paint::Ink;
use super::{Drawing, PlotError};

/// What an axis counts.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// The quantity.
    pub name: String,
    /// Its unit; empty for a bare number.
    pub unit: &'static str,
    /// Decimals of a value that is told.
    pub digits: usize,
}

/// A figure in a plane.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// What it shows.
    pub title: String,
    /// Across.
    pub x: Axis,
    /// Upwards.
    pub y: Axis,
    /// A unit is as long across as upwards.
    pub equal: bool,
    /// What the dots' colours say.
    pub value: Option<Axis>,
    /// The views' names, in the scan's order.
    pub views: Vec<String>,
    /// What must be within the axes besides the layers' values: `[x, y]`.
    pub within: Vec<[f64; 2]>,
    /// What is drawn, from the back to the front.
    pub layers: Vec<Layer>,
}

/// Part of a figure.
#[derive(Clone, Debug, PartialEq)]
pub enum Layer {
    /// From a value of x to another one, over the whole height.
    Band([f64; 2]),
    /// A value of y that is known.
    Level(f64),
    /// A line through places; beyond the axes it is cut. Not counted among the values, if it is only shape.
    Line {
        /// How it looks.
        ink: Ink,
        /// Its name in the table; none, and it does not stand there.
        series: Option<&'static str>,
        /// Its places.
        points: Vec<[f64; 2]>,
    },
    /// Dots.
    Dots {
        /// Their name in the table.
        series: &'static str,
        /// Radius, px.
        radius: f64,
        /// The dots.
        dots: Vec<Dot>,
    },
    /// Bars on the x axis.
    Bars(Vec<Bar>),
}

/// A dot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dot {
    /// Its values.
    pub at: [f64; 2],
    /// How it looks.
    pub ink: Ink,
    /// What its colour says.
    pub value: Option<f64>,
    /// The view it comes from.
    pub view: Option<usize>,
}

/// A bar.
#[derive(Clone, Debug, PartialEq)]
pub struct Bar {
    /// From and to, on the x axis.
    pub across: [f64; 2],
    /// How high.
    pub height: f64,
    /// A view that is in it.
    pub view: Option<usize>,
}

/// A figure in space, seen from above and aside.
#[derive(Clone, Debug, PartialEq)]
pub struct SpaceFigure {
    /// What it shows.
    pub title: String,
    /// To the right, upwards, and away from who looks; a unit is as long on each.
    pub axes: [Axis; 3],
    /// The views' names, in the scan's order.
    pub views: Vec<String>,
    /// The dots.
    pub dots: Vec<SpaceDot>,
}

/// A dot in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpaceDot {
    /// Its values.
    pub at: [f64; 3],
    /// Its name in the table.
    pub series: &'static str,
    /// How it looks.
    pub ink: Ink,
    /// The view it comes from.
    pub view: Option<usize>,
}

impl Axis {
    /// An axis.
    pub fn new(name: impl Into<String>, unit: &'static str, digits: usize) -> Self {
        Self {
            name: name.into(),
            unit,
            digits,
        }
    }

    /// Name and unit, as they stand at the axis.
    pub(super) fn label(&self) -> String {
        match self.unit {
            "" => self.name.clone(),
            unit => format!("{}, {unit}", self.name),
        }
    }

    /// A value with its unit.
    pub(super) fn told(&self, value: f64) -> String {
        let value = super::ticks::fixed(value, self.digits);
        match self.unit {
            "" => value,
            "\u{b0}" => format!("{value}\u{b0}"),
            unit => format!("{value} {unit}"),
        }
    }
}

impl Figure {
    /// A figure without anything in it.
    pub fn new(title: impl Into<String>, x: Axis, y: Axis) -> Self {
        Self {
            title: title.into(),
            x,
            y,
            equal: false,
            value: None,
            views: Vec::new(),
            within: Vec::new(),
            layers: Vec::new(),
        }
    }

    /// With one layer more, before the others.
    #[must_use]
    pub fn with(mut self, layer: Layer) -> Self {
        self.layers.push(layer);
        self
    }
}

/// A figure of either kind.
#[derive(Clone, Debug, PartialEq)]
pub enum Plot {
    /// In a plane.
    Flat(Figure),
    /// In space.
    Space(SpaceFigure),
}

impl Plot {
    /// Draws it, so many px wide and high.
    pub fn draw(&self, size: [u32; 2]) -> Result<Drawing, PlotError> {
        match self {
            Self::Flat(figure) => figure.draw(size),
            Self::Space(figure) => figure.draw(size),
        }
    }

    /// All its values as a table (CSV).
    pub fn csv(&self) -> String {
        match self {
            Self::Flat(figure) => figure.csv(),
            Self::Space(figure) => figure.csv(),
        }
    }
}

impl Dot {
    /// A dot that is its place alone.
    pub const fn bare(at: [f64; 2], ink: Ink) -> Self {
        Self {
            at,
            ink,
            value: None,
            view: None,
        }
    }
}

/// What is told of a value: whose it is, and the values themselves.
pub(super) fn words(
    views: &[String],
    (view, series): (Option<usize>, &str),
    told: impl IntoIterator<Item = String>,
) -> String {
    let told: Vec<String> = told.into_iter().collect();
    let told = told.join(", ");
    match view.and_then(|view| views.get(view)) {
        Some(name) => format!("View {name}, {series}: {told}"),
        None => told,
    }
}
