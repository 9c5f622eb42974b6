//! The settings as a person may turn them: one table from which forms, documentation and checks are made.

use super::{Settings, Stage};
use crate::scan::VesselShape;

/// A setting with what a person should know of it.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// Its path in [`Settings`], such as `vessel.outlier`.
    pub id: &'static str,
    /// The stage that it is a parameter of; this one and all after it depend on it.
    pub stage: Stage,
    /// What it is called.
    pub name: &'static str,
    /// What it does, in one sentence.
    pub meaning: &'static str,
    /// What it can be.
    pub kind: ParameterKind,
}

/// What a parameter can be, and how it is read and written.
#[derive(Clone, Copy, Debug)]
pub enum ParameterKind {
    /// A number within a range.
    Number(NumberParameter),
    /// Yes or no.
    Switch {
        /// Reads it.
        get: fn(&Settings) -> bool,
        /// Writes it.
        set: fn(&mut Settings, bool),
    },
    /// One of a few words.
    Choice {
        /// The words, each with what it is called.
        options: &'static [(&'static str, &'static str)],
        /// Reads it.
        get: fn(&Settings) -> &'static str,
        /// Writes it; an unknown word changes nothing.
        set: fn(&mut Settings, &str),
    },
}

/// A number within a range.
#[derive(Clone, Copy, Debug)]
pub struct NumberParameter {
    /// What it is counted in.
    pub unit: &'static str,
    /// The least that makes sense.
    pub low: f64,
    /// The most that makes sense.
    pub high: f64,
    /// The steps in which it is turned.
    pub step: f64,
    /// Reads it.
    pub get: fn(&Settings) -> f64,
    /// Writes it.
    pub set: fn(&mut Settings, f64),
}

impl Parameter {
    /// Whether the settings have it as [`Settings::default`] does.
    pub fn is_default(&self, settings: &Settings) -> bool {
        let mut reset = *settings;
        self.reset(&mut reset);
        reset == *settings
    }

    /// Sets it as [`Settings::default`] has it.
    pub fn reset(&self, settings: &mut Settings) {
        let usual = Settings::default();
        match self.kind {
            ParameterKind::Number(NumberParameter { get, set, .. }) => set(settings, get(&usual)),
            ParameterKind::Switch { get, set } => set(settings, get(&usual)),
            ParameterKind::Choice { get, set, .. } => set(settings, get(&usual)),
        }
    }
}

/// Every parameter, in the order of the stages.
pub const PARAMETERS: [Parameter; 10] = [
    Parameter {
        id: "spots.peak",
        stage: Stage::Spots,
        name: "Peak",
        meaning: "A spot stands at least this far above the noise of its picture.",
        kind: number(
            ("times the noise", 3.0, 40.0, 0.5),
            |s| s.spots.peak,
            |s, value| s.spots.peak = value,
        ),
    },
    Parameter {
        id: "spots.edge",
        stage: Stage::Spots,
        name: "Edge",
        meaning: "A spot ends where its light falls below this.",
        kind: number(
            ("times the noise", 1.0, 20.0, 0.5),
            |s| s.spots.edge,
            |s, value| s.spots.edge = value,
        ),
    },
    Parameter {
        id: "spots.smallest_area",
        stage: Stage::Spots,
        name: "Smallest area",
        meaning: "A region of fewer pixels is taken for noise.",
        kind: number(
            ("px", 1.0, 200.0, 1.0),
            |s| s.spots.smallest_area as f64,
            |s, value| s.spots.smallest_area = value as usize,
        ),
    },
    Parameter {
        id: "spots.most",
        stage: Stage::Spots,
        name: "Most spots",
        meaning: "Of a view's spots this many, the brightest, are looked at.",
        kind: number(
            ("spots", 2.0, 256.0, 1.0),
            |s| s.spots.most as f64,
            |s, value| s.spots.most = value as usize,
        ),
    },
    Parameter {
        id: "vessel.shape",
        stage: Stage::Vessel,
        name: "Shape",
        meaning: "What surface is laid through the vessel points.",
        kind: ParameterKind::Choice {
            options: &[
                ("given", "As the scan says"),
                ("auto", "Whichever fits"),
                ("plane", "Plane"),
                ("cylinder", "Cylinder"),
                ("sphere", "Sphere"),
                ("freeform", "Free form"),
            ],
            get: |s| s.vessel.shape.map_or("given", shape_word),
            set: |s, word| match word {
                "given" => s.vessel.shape = None,
                word => s.vessel.shape = shape_of_word(word).or(s.vessel.shape),
            },
        },
    },
    Parameter {
        id: "vessel.epipolar_tolerance",
        stage: Stage::Vessel,
        name: "Off the epipolar line",
        meaning: "A spot may lie on the wall if it is this near to the beam's line in the picture.",
        kind: number(
            ("px", 0.5, 30.0, 0.5),
            |s| s.vessel.epipolar_tolerance,
            |s, value| s.vessel.epipolar_tolerance = value,
        ),
    },
    Parameter {
        id: "vessel.outlier",
        stage: Stage::Vessel,
        name: "Outlier",
        meaning: "A vessel point farther off the wall than this is left out.",
        kind: number(
            ("robust \u{3c3}", 2.0, 20.0, 0.5),
            |s| s.vessel.outlier,
            |s, value| s.vessel.outlier = value,
        ),
    },
    Parameter {
        id: "vessel.separate_glows",
        stage: Stage::Vessel,
        name: "Tell the wall's two glows apart",
        meaning: "Takes the inner face's glow out of the vessel spots, which it pulls into the wall.",
        kind: ParameterKind::Switch {
            get: |s| s.vessel.separate_glows,
            set: |s, value| s.vessel.separate_glows = value,
        },
    },
    Parameter {
        id: "object.gap_sigmas",
        stage: Stage::Object,
        name: "Largest ray distance",
        meaning: "A spot whose two light paths pass each other farther apart is refused.",
        kind: number(
            ("\u{3c3}", 1.0, 20.0, 0.5),
            |s| s.object.gap_sigmas,
            |s, value| s.object.gap_sigmas = value,
        ),
    },
    Parameter {
        id: "object.nearest",
        stage: Stage::Object,
        name: "Nearest to the wall",
        meaning: "A point nearer to the wall's inner face is that face's own glow.",
        kind: number(
            ("mm", 0.0, 50.0, 0.5),
            |s| s.object.nearest,
            |s, value| s.object.nearest = value,
        ),
    },
];

const fn number(
    (unit, low, high, step): (&'static str, f64, f64, f64),
    get: fn(&Settings) -> f64,
    set: fn(&mut Settings, f64),
) -> ParameterKind {
    ParameterKind::Number(NumberParameter {
        unit,
        low,
        high,
        step,
        get,
        set,
    })
}

const fn shape_word(shape: VesselShape) -> &'static str {
    match shape {
        VesselShape::Auto => "auto",
        VesselShape::Plane => "plane",
        VesselShape::Cylinder => "cylinder",
        VesselShape::Sphere => "sphere",
        VesselShape::Freeform => "freeform",
    }
}

fn shape_of_word(word: &str) -> Option<VesselShape> {
    let shapes = [
        VesselShape::Auto,
        VesselShape::Plane,
        VesselShape::Cylinder,
        VesselShape::Sphere,
        VesselShape::Freeform,
    ];
    shapes.into_iter().find(|shape| shape_word(*shape) == word)
}

/// The table as a page of documentation (Markdown).
pub fn parameters_page() -> String {
    let mut page = String::from(
        "# Parameters\n\n\
         The defaults are right for most scans. A changed parameter runs its stage and those after it again.\n\n\
         | stage | parameter | what it does | range | default |\n\
         |---|---|---|---|---|\n",
    );
    let usual = Settings::default();
    for parameter in &PARAMETERS {
        let (range, default) = match parameter.kind {
            ParameterKind::Number(n) => (
                format!("{} to {} {}", n.low, n.high, n.unit),
                (n.get)(&usual).to_string(),
            ),
            ParameterKind::Switch { get, .. } => {
                let word = if get(&usual) { "on" } else { "off" };
                ("on, off".to_owned(), word.to_owned())
            }
            ParameterKind::Choice { options, get, .. } => {
                let words: Vec<_> = options
                    .iter()
                    .map(|(word, _)| format!("`{word}`"))
                    .collect();
                (words.join(", "), format!("`{}`", get(&usual)))
            }
        };
        let Parameter {
            id, stage, meaning, ..
        } = parameter;
        page.push_str(&format!(
            "| {stage:?} | `{id}` | {meaning} | {range} | {default} |\n"
        ));
    }
    page
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_parameter_changes_its_own_stage_and_comes_back() {
        for parameter in &PARAMETERS {
            let usual = Settings::default();
            let mut changed = usual;
            match parameter.kind {
                ParameterKind::Number(n) => {
                    let value = (n.get)(&usual);
                    assert!((n.low..=n.high).contains(&value), "{}", parameter.id);
                    (n.set)(&mut changed, n.high);
                    assert_eq!((n.get)(&changed), n.high);
                }
                ParameterKind::Switch { get, set } => {
                    set(&mut changed, !get(&usual));
                    assert_ne!(get(&changed), get(&usual));
                }
                ParameterKind::Choice { options, get, set } => {
                    for (word, _) in options {
                        set(&mut changed, word);
                        assert_eq!(get(&changed), *word);
                    }
                }
            }
            assert_eq!(usual.first_changed(&changed), Some(parameter.stage));
            assert!(!parameter.is_default(&changed));
            parameter.reset(&mut changed);
            assert_eq!(changed, usual, "{}", parameter.id);
        }
    }

    #[test]
    fn the_documentation_is_made_from_the_table() {
        let written = include_str!("../../../docs/parameters.md");
        assert!(
            written == parameters_page(),
            "docs/parameters.md should be:\n{}",
            parameters_page()
        );
    }
}
