//! What pictures, calibration and poses leave open: the questions, and somebody's answers as they are typed.

use std::collections::BTreeMap;

/// What a scan is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Part {
    /// Pictures with the laser on and off.
    Pictures,
    /// The lens.
    Camera,
    /// Where the rig stood.
    Poses,
    /// The laser in the camera's frame.
    Laser,
    /// Its wall.
    Vessel,
    /// Refractive indices.
    Media,
    /// Measures of the object, for estimating an unknown index.
    Known,
    /// What calibration gave, to one standard deviation.
    Calibration,
}

impl Part {
    /// All of them, in the order in which they are asked for.
    pub const ALL: [Self; 8] = [
        Self::Pictures,
        Self::Camera,
        Self::Poses,
        Self::Laser,
        Self::Vessel,
        Self::Media,
        Self::Known,
        Self::Calibration,
    ];

    /// A heading.
    pub const fn title(self) -> &'static str {
        match self {
            Self::Pictures => "Pictures",
            Self::Camera => "Camera",
            Self::Poses => "Poses",
            Self::Laser => "Laser",
            Self::Vessel => "Vessel",
            Self::Media => "Media",
            Self::Known => "What is known of the object",
            Self::Calibration => "How good the calibration is",
        }
    }

    /// Its name in identifiers.
    pub const fn id(self) -> &'static str {
        match self {
            Self::Pictures => "pictures",
            Self::Camera => "camera",
            Self::Poses => "poses",
            Self::Laser => "laser",
            Self::Vessel => "vessel",
            Self::Media => "media",
            Self::Known => "known",
            Self::Calibration => "calibration",
        }
    }

    /// What opens a part that may be left as it is.
    pub const fn invitation(self) -> Option<&'static str> {
        match self {
            Self::Known => {
                Some("An angle, a distance or a radius, which an unknown index is found by")
            }
            Self::Calibration => Some("Standard deviations, where they are known"),
            _ => None,
        }
    }
}

/// A question.
#[derive(Clone, Copy, Debug)]
pub struct Question {
    /// Which one.
    pub key: Key,
    /// Its name in identifiers.
    pub id: &'static str,
    /// What it belongs to.
    pub part: Part,
    /// A name for people.
    pub label: &'static str,
    /// The unit of the answer, `""` for none.
    pub unit: &'static str,
    /// One sentence on what is meant.
    pub meaning: &'static str,
    /// The kind of answer.
    pub kind: QuestionKind,
    /// What counts while nothing is answered; `""` where an answer is needed.
    pub initial: &'static str,
}

/// The kind of an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QuestionKind {
    /// Any text.
    Text,
    /// So many numbers.
    Numbers(usize),
    /// A number, or nothing.
    Optional,
    /// One of some words, each with a name for people.
    Choice(&'static [(&'static str, &'static str)]),
}

/// Generates the keys and the table, so that neither can lack what the other has.
macro_rules! questions {
    ($($key:ident, $id:literal, $part:ident, $label:literal, $unit:literal, $kind:expr, $initial:literal,
       $meaning:literal;)*) => {
        /// Names a question.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        pub enum Key {
            $(#[doc = $meaning] $key,)*
        }

        /// All questions, part by part.
        pub const QUESTIONS: &[Question] = &[$(Question {
            key: Key::$key,
            id: $id,
            part: Part::$part,
            label: $label,
            unit: $unit,
            meaning: $meaning,
            kind: $kind,
            initial: $initial,
        },)*];
    };
}

use QuestionKind::{Choice, Numbers, Optional, Text};

questions! {
    Name, "name", Pictures, "Name of the scan", "", Text, "",
        "What was measured; it may be left empty.";
    Alone, "alone", Pictures, "Pictures without a partner", "",
        Choice(&[("", "Say what to do"), ("skip", "Leave them out"), ("alone", "Measure them alone")]), "",
        "Without a picture with the laser off, other lights may be taken for spots.";
    Frames, "frames", Poses, "A pose says where", "",
        Choice(&[
            ("", "Choose"),
            ("world-from-flange", "the robot's flange stands in the world"),
            ("flange-from-world", "the world stands, seen from the flange"),
            ("world-from-camera", "the camera stands in the world"),
            ("camera-from-world", "the world stands, seen from the camera"),
        ]), "",
        "The frame in which a pose's translation is given: OpenCV's rvec and tvec are the world seen from the \
         camera, a robot's report is its flange in the world.";
    Motion, "motion", Poses, "What moved", "",
        Choice(&[("rig", "Camera and laser"), ("vessel", "The vessel, on a turntable or a stage")]), "rig",
        "If the vessel moved, the world is the frame that moves with it.";
    Length, "length", Poses, "Lengths are in", "",
        Choice(&[("mm", "millimetres"), ("cm", "centimetres"), ("m", "metres")]), "mm",
        "The unit of the file's translations; everything typed here is in millimetres.";
    Angle, "angle", Poses, "Rotation vectors are in", "",
        Choice(&[("", "Choose"), ("rad", "radians"), ("deg", "degrees")]), "",
        "The length of a rotation vector is its angle.";
    Order, "order", Poses, "Quaternions are written", "",
        Choice(&[("", "Choose"), ("wxyz", "w x y z"), ("xyzw", "x y z w")]), "",
        "The file does not name their numbers. The rotation by nothing is 1 0 0 0, or 0 0 0 1.";
    HandRotation, "hand-rotation", Poses, "Camera on the flange: rotation", "w x y z", Numbers(4), "",
        "The quaternion of the hand-eye calibration: it takes the camera's axes to the flange's.";
    HandTranslation, "hand-translation", Poses, "Camera on the flange: position", "mm", Numbers(3), "",
        "Where the camera's centre stands in the flange's frame: x, y, z.";
    LaserKind, "laser-kind", Laser, "Kind", "",
        Choice(&[("spot", "A beam, which makes a spot"), ("line", "A sheet of light, which makes a line")]), "spot",
        "What the laser throws onto the object.";
    LaserOrigin, "laser-origin", Laser, "Origin", "mm", Numbers(3), "",
        "A point of the beam, or where a sheet's rays come from: x to the right, y down, z forward of the camera.";
    LaserDirection, "laser-direction", Laser, "Direction", "x y z", Numbers(3), "",
        "Where the beam goes, in the camera's frame, of any length.";
    LaserNormal, "laser-normal", Laser, "Normal", "x y z", Numbers(3), "",
        "Square to the sheet of light, in the camera's frame, of any length.";
    Shape, "shape", Vessel, "Shape", "",
        Choice(&[
            ("auto", "Whichever the points support"),
            ("plane", "A flat wall"),
            ("cylinder", "A round jar"),
            ("sphere", "A bowl or a flask"),
            ("freeform", "Any smooth wall"),
        ]), "auto",
        "The shape of the wall that the laser goes through.";
    WallThickness, "wall-thickness", Vessel, "Wall thickness", "mm", Numbers(1), "",
        "Glass between outer and inner face, more than 0: callipers or an ultrasonic gauge tell it.";
    WallKnown, "wall-known", Vessel, "Where the wall stands", "",
        Choice(&[
            ("no", "is found from the laser's spots on it"),
            ("yes", "is known from an earlier measurement"),
        ]), "no",
        "A known wall is taken as it is given, and the spots on it are held against it.";
    WallPoint, "wall-point", Vessel, "A point of the wall", "mm", Numbers(3), "",
        "x, y and z of any point of the outer face, in the world's frame.";
    WallNormal, "wall-normal", Vessel, "The wall's normal", "x y z", Numbers(3), "",
        "Square to the outer face, from the glass towards the camera, in the world's frame, of any length.";
    WallAxisPoint, "wall-axis-point", Vessel, "A point of the jar's axis", "mm", Numbers(3), "",
        "x, y and z of any point of the axis, in the world's frame.";
    WallAxis, "wall-axis", Vessel, "The axis' direction", "x y z", Numbers(3), "",
        "Along the jar, either way, in the world's frame, of any length.";
    WallCentre, "wall-centre", Vessel, "The middle of the bowl", "mm", Numbers(3), "",
        "x, y and z of the middle of the sphere, in the world's frame.";
    WallRadius, "wall-radius", Vessel, "Outer radius", "mm", Numbers(1), "",
        "Half the diameter over the outer face, and more than the wall is thick.";
    FarWall, "far-wall", Vessel, "The object stands", "",
        Choice(&[("no", "in the vessel"), ("yes", "behind it, in the open")]), "no",
        "Behind a flat tank its light goes through the liquid and a second wall.";
    FarDistance, "far-distance", Vessel, "Between the two walls", "mm", Numbers(1), "",
        "The depth of the liquid, from inner face to inner face, more than 0.";
    FarThickness, "far-thickness", Vessel, "Thickness of the far wall", "mm", Numbers(1), "",
        "Of the same glass as the front wall, more than 0.";
    IndexOutside, "index-outside", Media, "Index around the rig", "", Numbers(1), "1.0",
        "Refractive index, from 1 to 4: air has 1.000.";
    IndexWall, "index-wall", Media, "Index of the wall", "", Numbers(1), "",
        "From 1 to 4: soda-lime glass has 1.52, borosilicate 1.47, acrylic 1.49.";
    IndexKnown, "index-known", Media, "Index of the liquid", "",
        Choice(&[("yes", "is known"), ("no", "is not known: estimate it")]), "yes",
        "What it takes to estimate it, the scan will say; a measure of the object, below, helps most.";
    IndexInside, "index-inside", Media, "Index in the vessel", "", Numbers(1), "",
        "From 1 to 4: water has 1.333 in yellow light, ethanol 1.361.";
    InAir, "in-air", Media, "Views in air", "numbers", Text, "",
        "The views whose beam enters air above the liquid, by their numbers in the list of pairs: 1-12, 20. \
         Empty, and all look into the liquid.";
    KnownAngle, "known-angle", Known, "Angle between two flat faces", "\u{b0}", Optional, "",
        "More than 0 and less than 180; an angle and the one that makes it 180 count as the same.";
    KnownEdge, "known-edge", Known, "Distance of two parallel faces", "mm", Optional, "",
        "As callipers measure it across the object, more than 0; both faces must have been scanned.";
    KnownRadius, "known-radius", Known, "Radius of a ball or a rod", "mm", Optional, "",
        "Half the diameter, more than 0.";
    KnownFlat, "known-flat", Known, "A flat face", "",
        Choice(&[("no", "none that is known to be flat"), ("yes", "the object has a flat face")]), "no",
        "A wrong index bends a flat face, though little: an angle or a distance tells more.";
    SigmaLaserOrigin, "sigma-laser-origin", Calibration, "Laser's origin", "mm", Optional, "0.3",
        "One standard deviation.";
    SigmaLaserDirection, "sigma-laser-direction", Calibration, "Laser's direction", "\u{b0}", Optional, "0.1",
        "One standard deviation.";
    SigmaFocal, "sigma-focal", Calibration, "Focal length", "px", Optional, "0.5",
        "One standard deviation.";
    SigmaCentre, "sigma-centre", Calibration, "Principal point", "px", Optional, "0.5",
        "One standard deviation.";
    SigmaHandRotation, "sigma-hand-rotation", Calibration, "Hand-eye rotation", "\u{b0}", Optional, "0.1",
        "One standard deviation.";
    SigmaHandTranslation, "sigma-hand-translation", Calibration, "Hand-eye translation", "mm", Optional, "0.3",
        "One standard deviation.";
}

impl Key {
    /// What is asked.
    pub const fn question(self) -> &'static Question {
        &QUESTIONS[self as usize]
    }
}

/// Answers as they were typed, by the questions' ids.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Answers(BTreeMap<String, String>);

impl Answers {
    /// Takes answers by the ids of their questions.
    pub const fn new(answers: BTreeMap<String, String>) -> Self {
        Self(answers)
    }

    /// Answers a question.
    pub fn set(&mut self, key: Key, answer: impl Into<String>) {
        self.0.insert(key.question().id.to_owned(), answer.into());
    }

    /// What was answered, or what counts otherwise.
    pub fn get(&self, key: Key) -> &str {
        let question = key.question();
        let given = self.0.get(question.id).map(|answer| answer.trim());
        match question.kind {
            // Left empty on purpose.
            Optional => given.unwrap_or_default(),
            _ => given.filter(|a| !a.is_empty()).unwrap_or(question.initial),
        }
    }

    /// So many numbers, or the sentence on why they are not there.
    pub(super) fn numbers<const N: usize>(&self, key: Key) -> Result<[f64; N], String> {
        let text = self.get(key);
        let name = key.question().label;
        if text.is_empty() {
            return Err(format!("{name}: missing."));
        }
        let plain = text.replace('\u{2212}', "-");
        let numbers = split::<N>(&plain).map(|word| {
            let number = word.parse().ok().filter(|number: &f64| number.is_finite());
            number.ok_or_else(|| format!("{name}: \"{word}\" is no number."))
        });
        let numbers: Vec<f64> = numbers.collect::<Result<_, _>>()?;
        let found = crate::text::count(numbers.len(), "number");
        let wanted = N;
        numbers
            .try_into()
            .map_err(|_| format!("{name}: {found}; {wanted} wanted."))
    }
}

/// The words of an answer. Between several numbers a comma parts them; within a single one it is a decimal
/// sign.
fn split<const N: usize>(text: &str) -> impl Iterator<Item = String> + use<'_, N> {
    let parted = text.split(|c: char| {
        c.is_whitespace() || matches!(c, ';' | '[' | ']' | '(' | ')') || (N > 1 && c == ',')
    });
    let words = parted.filter(|word| !word.is_empty());
    words.map(|word| word.replace(',', "."))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_in_the_order_of_the_keys() {
        for question in QUESTIONS {
            assert_eq!(question.key.question().id, question.id);
        }
    }

    #[test]
    fn numbers_are_read_as_people_write_them() {
        let mut answers = Answers::default();
        for text in [
            "1 -2.5 3",
            "1, -2.5, 3",
            "[1; \u{2212}2.5; 3]",
            " (1,-2.5,3) ",
        ] {
            answers.set(Key::LaserOrigin, text);
            assert_eq!(
                answers.numbers(Key::LaserOrigin),
                Ok([1.0, -2.5, 3.0]),
                "{text}"
            );
        }
        answers.set(Key::IndexInside, "1,333");
        assert_eq!(answers.numbers(Key::IndexInside), Ok([1.333]));
        for (text, why) in [
            ("", "Origin: missing."),
            ("1 2", "Origin: 2 numbers; 3 wanted."),
            ("1 2 x", "Origin: \"x\" is no number."),
            ("1 2 inf", "Origin: \"inf\" is no number."),
        ] {
            answers.set(Key::LaserOrigin, text);
            assert_eq!(answers.numbers::<3>(Key::LaserOrigin), Err(why.to_owned()));
        }
    }
}
