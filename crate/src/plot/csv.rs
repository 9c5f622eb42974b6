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
        let value = self.value.as_ref().map(|axis| format!(",{}", column(axis)));
        let mut text = format!("series,view,{x},{y}{}\n", value.unwrap_or_default());
        for layer in &self.layers {
            self.rows(layer, &mut text);
        }
        text
    }
}

impl Figure {
    fn rows(&self, layer: &Layer, text: &mut String) {
        match layer {
            Layer::Dots { series, dots, .. } => {
                for dot in dots {
                    let [x, y] = dot.at;
                    let view = name(&self.views, dot.view);
                    let value = dot.value.map(|value| format!(",{value}"));
                    let value = value.unwrap_or_default();
                    let _ = writeln!(text, "{series},{view},{x},{y}{value}");
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
}

impl SpaceFigure {
    /// The values as a table, one row a dot.
    pub fn csv(&self) -> String {
        let [x, y, z] = [0, 1, 2].map(|axis| column(&self.axes[axis]));
        let mut text = format!("series,view,{x},{y},{z}\n");
        for dot in &self.dots {
            let [x, y, z] = dot.at;
            let view = name(&self.views, dot.view);
            let _ = writeln!(text, "{},{view},{x},{y},{z}", dot.series);
        }
        text
    }
}

fn column(axis: &Axis) -> String {
    match axis.unit {
        "" => axis.name.clone(),
        unit => format!("{} ({unit})", axis.name),
    }
    .replace(',', "")
}

/// A view's id, quoted where the table's own signs are in it.
fn name(views: &[String], view: Option<usize>) -> String {
    let id = view.and_then(|view| views.get(view));
    match id {
        Some(id) if id.contains([',', '"', '\n', '\r']) => {
            format!("\"{}\"", id.replace('"', "\"\""))
        }
        Some(id) => id.clone(),
        None => String::new(),
    }
}
