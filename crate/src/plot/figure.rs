//! What a figure is made of, before it is drawn.

use super::paint::Ink;

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
#[derive(Clone, Debug, PartialEq)]
pub struct Dot {
    /// Its values.
    pub at: [f64; 2],
    /// How it looks.
    pub ink: Ink,
    /// The view it comes from.
    pub view: Option<usize>,
    /// What is told of it beside its values.
    pub words: String,
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
    /// The dots, with their name in the table.
    pub dots: Vec<SpaceDot>,
}

/// A dot in space.
#[derive(Clone, Debug, PartialEq)]
pub struct SpaceDot {
    /// Its values.
    pub at: [f64; 3],
    /// Its name in the table.
    pub series: &'static str,
    /// How it looks.
    pub ink: Ink,
    /// The view it comes from.
    pub view: Option<usize>,
    /// What is told of it beside its values.
    pub words: String,
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
