//! The one table of what can be set: its keys in links, its names and ranges in the page.

use super::{Bench, LESSONS, Medium, Thing, View, WallShape};

/// A number that can be set.
#[derive(Clone, Copy, Debug)]
pub struct Quantity {
    /// How links name it.
    pub key: &'static str,
    /// How people name it.
    pub name: &'static str,
    /// Its unit, empty for none.
    pub unit: &'static str,
    /// The least value.
    pub low: f64,
    /// The greatest value.
    pub high: f64,
    /// Decimals that are kept.
    pub decimals: usize,
    /// The value; `None` where the bench chooses for itself.
    pub get: fn(&Bench) -> Option<f64>,
    /// Writes a value that is in range and rounded.
    put: fn(&mut Bench, f64),
}

impl Quantity {
    /// The value to the decimals that are kept, within the range.
    pub fn fitted(&self, value: f64) -> f64 {
        let scale = [1.0, 10.0, 100.0, 1000.0, 10_000.0][self.decimals];
        // Adding 0 makes a 0 of a -0, which would read otherwise in a link.
        (value.clamp(self.low, self.high) * scale).round() / scale + 0.0
    }

    /// Whether the value may be given by a link.
    pub fn allows(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }

    /// Sets the value, fitted, and tidies the bench.
    pub fn set(&self, bench: &mut Bench, value: f64) {
        self.set_alone(bench, value);
        *bench = bench.tidied();
    }

    /// Sets the value, fitted, whatever else that makes untidy.
    pub(super) fn set_alone(&self, bench: &mut Bench, value: f64) {
        (self.put)(bench, self.fitted(value));
    }
}

/// The quantity of a key.
pub fn quantity(key: &str) -> Option<&'static Quantity> {
    QUANTITIES.iter().find(|quantity| quantity.key == key)
}

/// One of some words.
#[derive(Clone, Copy, Debug)]
pub struct Choice {
    /// How links name it.
    pub key: &'static str,
    /// How people name it.
    pub name: &'static str,
    /// How links and people name the words.
    pub options: &'static [(&'static str, &'static str)],
    /// The chosen word's place.
    pub get: fn(&Bench) -> usize,
    put: fn(&mut Bench, usize),
}

impl Choice {
    /// Chooses the word at `place`, and tidies the bench.
    pub fn set(&self, bench: &mut Bench, place: usize) {
        self.set_alone(bench, place);
        *bench = bench.tidied();
    }

    /// Chooses the word at `place`, whatever else that makes untidy.
    pub(super) fn set_alone(&self, bench: &mut Bench, place: usize) {
        (self.put)(bench, place);
    }
}

/// One of the three media.
#[derive(Clone, Copy, Debug)]
pub struct MediumRole {
    /// How links name it.
    pub key: &'static str,
    /// How people name it.
    pub name: &'static str,
    /// The paper's symbol.
    pub symbol: &'static str,
    /// What it is.
    pub get: fn(&Bench) -> Medium,
    /// Makes it something else.
    pub set: fn(&mut Bench, Medium),
    /// Whether it may be a mystery.
    pub may_be_hidden: bool,
}

const VIEWS: [View; 5] = [
    View::Bench,
    View::See,
    View::Index,
    View::Lessons,
    View::Sheet,
];
const WALLS: [WallShape; 3] = [WallShape::Plane, WallShape::Cylinder, WallShape::Sphere];
const THINGS: [Thing; 3] = [Thing::Rod, Thing::Ball, Thing::Card];

/// Everything that is one of some words, in the order of links.
pub static CHOICES: [Choice; 3] = [
    Choice {
        key: "view",
        name: "What is shown",
        options: &[
            ("bench", "Bench"),
            ("see", "See through it"),
            ("index", "What is n?"),
            ("lessons", "Lessons"),
            ("sheet", "Teacher's sheet"),
        ],
        get: |bench| bench.view as usize,
        put: |bench, place| bench.view = VIEWS[place],
    },
    Choice {
        key: "wall",
        name: "Wall",
        options: &[
            ("plane", "Flat (tank)"),
            ("cylinder", "Round (jar)"),
            ("sphere", "Ball (bowl)"),
        ],
        get: |bench| bench.wall as usize,
        put: |bench, place| bench.wall = WALLS[place],
    },
    Choice {
        key: "thing",
        name: "Object",
        options: &[("rod", "Rod"), ("ball", "Ball"), ("card", "Card")],
        get: |bench| bench.thing as usize,
        put: |bench, place| bench.thing = THINGS[place],
    },
];

/// The media, from the rig inwards.
pub static MEDIA: [MediumRole; 3] = [
    MediumRole {
        key: "outside",
        name: "Around the rig",
        symbol: "n\u{2081}",
        get: |bench| bench.outside,
        set: |bench, medium| bench.outside = medium,
        may_be_hidden: false,
    },
    MediumRole {
        key: "glass",
        name: "Wall",
        symbol: "n\u{2082}",
        get: |bench| bench.glass,
        set: |bench, medium| bench.glass = medium,
        may_be_hidden: false,
    },
    MediumRole {
        key: "liquid",
        name: "Inside",
        symbol: "n\u{2083}",
        get: |bench| bench.liquid,
        set: |bench, medium| bench.liquid = medium,
        may_be_hidden: true,
    },
];

const MM: &str = "mm";
const DEGREES: &str = "\u{b0}";

macro_rules! number {
    ($key:literal, $name:literal, $unit:expr, $low:literal, $high:literal, $decimals:literal, $($place:tt)+) => {
        Quantity {
            key: $key,
            name: $name,
            unit: $unit,
            low: $low,
            high: $high,
            decimals: $decimals,
            get: |bench| Some(bench.$($place)+),
            put: |bench, value| bench.$($place)+ = value,
        }
    };
}

/// Everything that is a number, in the order of links.
pub static QUANTITIES: [Quantity; 24] = [
    Quantity {
        key: "lesson",
        name: "Lesson",
        unit: "",
        low: 1.0,
        high: LESSONS.len() as f64,
        decimals: 0,
        get: |bench| bench.lesson.map(|place| (place + 1) as f64),
        put: |bench, value| bench.lesson = Some(value as usize - 1),
    },
    number!("radius", "Outer radius", MM, 40.0, 150.0, 1, radius),
    number!("thickness", "Thickness", MM, 0.5, 20.0, 1, thickness),
    number!("lx", "Laser, to the right", MM, -150.0, 150.0, 1, laser[0]),
    number!(
        "lz",
        "Laser, into the vessel",
        MM,
        -240.0,
        -30.0,
        1,
        laser[1]
    ),
    number!(
        "cx",
        "Camera, to the right",
        MM,
        -150.0,
        150.0,
        1,
        camera[0]
    ),
    number!(
        "cz",
        "Camera, into the vessel",
        MM,
        -240.0,
        -30.0,
        1,
        camera[1]
    ),
    number!(
        "ox",
        "Object point, to the right",
        MM,
        -120.0,
        120.0,
        1,
        object[0]
    ),
    number!(
        "oz",
        "Object point, into the vessel",
        MM,
        5.0,
        290.0,
        1,
        object[1]
    ),
    Quantity {
        key: "aim",
        name: "Beam's angle",
        unit: DEGREES,
        low: -80.0,
        high: 80.0,
        decimals: 1,
        get: |bench| bench.aim,
        put: |bench, value| bench.aim = Some(value),
    },
    number!("turn", "Rig turned", DEGREES, -40.0, 40.0, 1, turn),
    number!("pitch", "Rig pitched", DEGREES, -50.0, 50.0, 1, pitch),
    Quantity {
        key: "assumed",
        name: "Assumed index",
        unit: "",
        low: 0.9,
        high: 2.5,
        decimals: 4,
        get: |bench| bench.assumed,
        put: |bench, value| bench.assumed = Some(value),
    },
    number!(
        "az",
        "View in space, round",
        DEGREES,
        -180.0,
        180.0,
        0,
        space_round
    ),
    number!(
        "el",
        "View in space, above",
        DEGREES,
        -10.0,
        89.0,
        0,
        space_above
    ),
    number!(
        "round",
        "Eye, round the vessel",
        DEGREES,
        -50.0,
        50.0,
        1,
        eye_round
    ),
    number!(
        "above",
        "Eye, above the vessel",
        DEGREES,
        -20.0,
        30.0,
        1,
        eye_above
    ),
    number!("fill", "Filled to", "%", 0.0, 100.0, 0, fill),
    number!("divider", "Divider", "%", 0.0, 100.0, 0, divider),
    number!("n", "Trial index", "", 0.9, 1.8, 3, trial),
    number!("l", "L turned", DEGREES, -25.0, 25.0, 1, l_turn),
    number!("noise", "Noise of a spot", "px", 0.0, 2.0, 2, noise),
    number!(
        "out",
        "Laser's tilt out of plane",
        DEGREES,
        0.0,
        0.3,
        3,
        out_of_plane
    ),
    number!(
        "in",
        "Laser's tilt in plane",
        DEGREES,
        0.0,
        0.3,
        3,
        in_plane
    ),
];
