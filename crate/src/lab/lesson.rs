//! Short lessons: one idea, one question, one thing to do, an answer to check.

use super::{Bench, link};

/// A lesson.
#[derive(Clone, Copy, Debug)]
pub struct Lesson {
    /// What it is called.
    pub title: &'static str,
    /// The idea.
    pub idea: &'static str,
    /// What to do on the bench.
    pub task: &'static str,
    /// What is asked.
    pub question: &'static str,
    /// What is right.
    pub answer: Answer,
    /// Why it is right, told with the right answer.
    pub because: &'static str,
    /// The bench it opens, as a link's parameters.
    pub parameters: &'static str,
}

/// What is right.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Answer {
    /// A number.
    Number {
        /// The right one.
        value: f64,
        /// How far off it may be.
        within: f64,
        /// Its unit, empty for none.
        unit: &'static str,
    },
    /// One of some sentences.
    Choice {
        /// The sentences.
        options: &'static [&'static str],
        /// The place of the right one.
        right: usize,
    },
}

/// What is to be said of an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reply {
    /// It is right.
    Right,
    /// It is wrong.
    Wrong,
    /// It is no answer.
    Unreadable,
}

impl Lesson {
    /// The bench that a lesson opens; it is the lesson's place in [`LESSONS`] that makes it this one.
    pub fn bench(place: usize) -> Option<Bench> {
        let lesson = LESSONS.get(place)?;
        let bench = link::read_parameters(lesson.parameters).ok()?;
        Some(Bench {
            lesson: Some(place),
            ..bench
        })
    }

    /// Judges an answer: a number as it is typed, or the place of a sentence.
    pub fn judge(&self, answer: &str) -> Reply {
        let given = answer.trim().replace(',', ".").replace('\u{2212}', "-");
        let Ok(given) = given.parse::<f64>() else {
            return Reply::Unreadable;
        };
        let right = match self.answer {
            Answer::Number { value, within, .. } => (given - value).abs() <= within + 1e-9,
            Answer::Choice { right, .. } => given == right as f64,
        };
        if right { Reply::Right } else { Reply::Wrong }
    }
}

/// The lessons, in order.
pub static LESSONS: [Lesson; 8] = [
    Lesson {
        title: "Light bends at a face",
        idea: "Where light goes from one medium into another it bends. The product of the refractive \
               index and the sine of the angle to the normal stays the same: n\u{2081} sin a = n\u{2082} \
               sin b. That is Snell's law.",
        task: "The beam comes at 30\u{b0}. Set the beam's angle to 60\u{b0} and read its angle in the water.",
        question: "At what angle to the normal does a beam run in the water that came at 60\u{b0}?",
        answer: Answer::Number {
            value: 40.6,
            within: 0.5,
            unit: "\u{b0}",
        },
        because: "sin b = 1.0003 \u{b7} sin 60\u{b0} / 1.332 = 0.650. Twice the angle outside is less than \
                  twice the angle inside.",
        parameters: "lx=-90&lz=-100&aim=30&ox=20&oz=100",
    },
    Lesson {
        title: "The glass only shifts the light",
        idea: "The wall has two faces. What the first one bends, the second one bends again, and of the \
               glass's index nothing is left: n\u{2081} sin a = n\u{2082} sin b = n\u{2083} sin c.",
        task: "Make the wall 20 mm thick, then choose acrylic for it. Watch the angle in the water.",
        question: "What becomes of the beam in the water when the wall is made thicker?",
        answer: Answer::Choice {
            options: &[
                "Its angle grows",
                "Its angle stays; it is only shifted sideways",
                "Its angle becomes smaller",
            ],
            right: 1,
        },
        because: "Both faces are parallel, so the angle in the water is set by the air and the water \
                  alone. Thickness and index of the wall shift the beam by millimetres.",
        parameters: "lx=-90&lz=-100&aim=45&ox=20&oz=100",
    },
    Lesson {
        title: "Thrown back",
        idea: "Light that goes from a denser medium into a thinner one bends away from the normal. At the \
               critical angle it would run along the face; beyond, none of it gets through.",
        task: "Here the rig is under water and the box is full of air. Turn the beam until it is thrown \
               back.",
        question: "At which angle in the water does the light cease to get into the air?",
        answer: Answer::Number {
            value: 48.7,
            within: 0.5,
            unit: "\u{b0}",
        },
        because: "sin a = 1.0003 / 1.332, so a = 48.7\u{b0}. The glass between does not change it.",
        parameters: "outside=water&liquid=air&lx=-100&lz=-90&aim=40&ox=20&oz=100",
    },
    Lesson {
        title: "It looks nearer than it is",
        idea: "The eye follows light back along a straight line. Laser and camera, without knowing of the \
               water, put the spot where the straight rays would meet: the apparent point.",
        task: "The object point is 100 mm behind the wall's outer face. Read the depth of the apparent \
               point, then move the object nearer and farther.",
        question: "How deep does the point that lies at 100 mm seem to lie?",
        answer: Answer::Number {
            value: 73.2,
            within: 1.5,
            unit: "mm",
        },
        because: "Squarely seen, a depth in water seems to be divided by 1.332; seen aslant it shrinks a \
                  little more.",
        parameters: "ox=0&oz=100",
    },
    Lesson {
        title: "A jar is a lens",
        idea: "A round wall bends rays towards the middle as a lens does, but only across the jar's axis.",
        task: "Move the divider to and fro: on its left the jar is full, on its right it is empty.",
        question: "What does the full jar make of the card with the squares?",
        answer: Answer::Choice {
            options: &[
                "It is wider and higher in the same measure",
                "It is wider, and hardly higher",
                "It is higher, and hardly wider",
            ],
            right: 1,
        },
        because: "Upright, the wall is straight, and bends light as a flat one does. Across, it is curved.",
        parameters: "view=see&wall=cylinder&thing=card&radius=75&thickness=3&fill=100&round=0&above=0",
    },
    Lesson {
        title: "Find the liquid by Snell's law",
        idea: "Two angles and one index give the other index.",
        task: "The liquid's name is not told. Read the beam's angles in the air and in the liquid at \
               several settings, and work out the liquid's index.",
        question: "What is the index of mystery liquid 2?",
        answer: Answer::Number {
            value: 1.383,
            within: 0.01,
            unit: "",
        },
        because: "n\u{2083} = n\u{2081} sin a / sin c. The larger the angle, the less an error of reading \
                  matters.",
        parameters: "liquid=mystery2&lx=-90&lz=-100&aim=50&ox=20&oz=100",
    },
    Lesson {
        title: "A known shape tells the index",
        idea: "Reconstructed at a wrong index, space is stretched along the wall's normal, and a right angle \
               is no longer one. So an object of known shape tells the index (eq. (4) of the paper).",
        task: "Drag n until the angle of the L is 90\u{b0}.",
        question: "Which index makes the angle right?",
        answer: Answer::Number {
            value: 1.36,
            within: 0.01,
            unit: "",
        },
        because: "It is ethanol, 1.3604. A box that stands squarely to the wall would have told nothing: \
                  its angles stay right whatever the index.",
        parameters: "view=index&liquid=ethanol&n=0.9&noise=0",
    },
    Lesson {
        title: "When the rays always meet",
        idea: "Without a known shape there is the ray distance: at the right index the two bent rays meet \
               (eq. (3) of the paper). But if beam, camera and the wall's normal lie in one plane, the bent \
               rays stay in that plane, and meet at every index.",
        task: "Look at the curve of the sum of l. Then pitch the rig and watch the curve and the scatter of \
               the tries.",
        question: "Which pitch lets eq. (3) find the index best?",
        answer: Answer::Choice {
            options: &["0\u{b0}: squarely before the tank", "5\u{b0}", "35\u{b0}"],
            right: 2,
        },
        because: "What the rays miss each other by grows with the sines of the angles out of the common \
                  plane. Squarely it is nothing: what is least there is a matter of noise alone, and lies at the \
                  end of the range.",
        parameters: "view=index&n=1.5&noise=0.2",
    },
];
