//! Figures as tables.

use std::fmt::Write as _;

use super::figure::{Axis, Figure, Layer, SpaceFigure};

impl Figure {
    /// The values as a table: of bars where they stand and how high they are, else one row a value.
    pub fn csv(&self) -> String {
        let bars = self.layers.iter().filter_map(|layer| match layer {
            Layer::Bars(bars) => Some(bars),
            _ => None,
        });
        let mut bars = bars.flatten().peekable();
        let (x, y) = (column(&self.x), column(&self.y));
        if bars.peek().is_some() {
            let mut text = format!("from {x},to {x},{y}\n");
            for bar in bars {
                let _ = writeln!(text, "{},{},{}", bar.across[0], bar.across[1], bar.height);
            }
            return text;
        }
        let mut text = format!("series,view,{x},{y}\n");
        for layer in &self.layers {
            rows(layer, &mut text);
        }
        text
    }
}

impl SpaceFigure {
    /// The values as a table, one row a dot. A view is named by its number in the scan, from 0.
    pub fn csv(&self) -> String {
        let [x, y, z] = [0, 1, 2].map(|axis| column(&self.axes[axis]));
        let mut text = format!("series,view,{x},{y},{z}\n");
        for dot in &self.dots {
            let [x, y, z] = dot.at;
            let _ = writeln!(text, "{},{},{x},{y},{z}", dot.series, number(dot.view));
        }
        text
    }
}

fn rows(layer: &Layer, text: &mut String) {
    match layer {
        Layer::Dots { series, dots, .. } => {
            for dot in dots {
                let [x, y] = dot.at;
                let _ = writeln!(text, "{series},{},{x},{y}", number(dot.view));
            }
        }
        Layer::Line {
            series: Some(series),
            points,
            ..
        } => {
            for [x, y] in points {
                let _ = writeln!(text, "{series},,{x},{y}");
            }
        }
        Layer::Level(value) => {
            let _ = writeln!(text, "known,,,{value}");
        }
        Layer::Line { .. } | Layer::Band(_) | Layer::Bars(_) => {}
    }
}

fn column(axis: &Axis) -> String {
    match axis.unit {
        "" => axis.name.clone(),
        unit => format!("{} ({unit})", axis.name),
    }
    .replace(',', "")
}

fn number(view: Option<usize>) -> String {
    view.map_or_else(String::new, |view| view.to_string())
}
