//! Colours by what they mean. A drawing carries both: the colour for itself, the meaning for a page.

use plotters::style::RGBColor;

/// What a shape is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ink {
    /// Letters and numbers.
    Text,
    /// Lines at round values.
    Grid,
    /// The axes.
    Axis,
    /// The back of a figure in space.
    Panel,
    /// The vessel's wall, and points on it.
    Wall,
    /// A curve, bars.
    Curve,
    /// Where a curve is lowest.
    Minimum,
    /// What a quantity is known to be.
    Known,
    /// Where something lies with confidence.
    Band,
    /// A point of a sweep.
    Sweep(u32),
    /// From -1 over nothing (0) to 1.
    Signed(f64),
}

/// Hues that the common kinds of colour blindness keep apart, on white and on black: M. Okabe and K. Ito,
/// "Color Universal Design" (2008), but for their yellow and black, which one of the two grounds swallows.
pub const SWEEP_COLOURS: [[u8; 3]; 7] = [
    [0, 114, 178],
    [230, 159, 0],
    [0, 158, 115],
    [204, 121, 167],
    [86, 180, 233],
    [213, 94, 0],
    [153, 153, 51],
];

/// The colour of a sweep.
pub fn sweep_colour(sweep: u32) -> [u8; 3] {
    SWEEP_COLOURS[sweep as usize % SWEEP_COLOURS.len()]
}

/// The inks that a style sheet may repaint: the class, and the colour on white.
const NAMED: [(Ink, &str, [u8; 3]); 9] = [
    (Ink::Text, "text", [75, 95, 107]),
    (Ink::Grid, "grid", [227, 232, 235]),
    (Ink::Axis, "axis", [130, 150, 161]),
    (Ink::Panel, "panel", [246, 248, 249]),
    (Ink::Wall, "wall", [136, 136, 136]),
    (Ink::Curve, "curve", [11, 106, 133]),
    (Ink::Minimum, "minimum", [200, 51, 15]),
    (Ink::Known, "known", [179, 89, 0]),
    (Ink::Band, "band", [220, 238, 243]),
];

/// Purple over grey to orange: the ends of ColorBrewer's PuOr (C. Brewer, Apache License 2.0) about a grey
/// that is seen on white and on black.
const SIGNED: [[u8; 3]; 5] = [
    [100, 60, 160],
    [150, 130, 190],
    [160, 160, 160],
    [230, 150, 60],
    [200, 95, 0],
];

impl Ink {
    pub(super) fn colour(self) -> RGBColor {
        let [red, green, blue] = match self {
            Self::Sweep(sweep) => sweep_colour(sweep),
            Self::Signed(value) => signed(value),
            named => {
                let entry = NAMED.iter().find(|(ink, ..)| *ink == named);
                entry.map_or([0; 3], |(_, _, colour)| *colour)
            }
        };
        RGBColor(red, green, blue)
    }
}

/// The class of a colour: plotters hands on nothing else of what a shape is.
pub(super) fn class_of((red, green, blue): (u8, u8, u8)) -> Option<&'static str> {
    let entry = NAMED.iter().find(|(.., c)| *c == [red, green, blue]);
    entry.map(|(_, class, _)| *class)
}

fn signed(value: f64) -> [u8; 3] {
    let place = (value.clamp(-1.0, 1.0) + 1.0) * 0.5 * (SIGNED.len() - 1) as f64;
    let below = (place as usize).min(SIGNED.len() - 2);
    let rest = place - below as f64;
    std::array::from_fn(|i| {
        let [from, to] = [below, below + 1].map(|k| f64::from(SIGNED[k][i]));
        (from + rest * (to - from)) as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_named_ink_is_known_by_its_colour() {
        for (ink, class, colour) in NAMED {
            assert_eq!(ink.colour(), RGBColor(colour[0], colour[1], colour[2]));
            assert_eq!(class_of((colour[0], colour[1], colour[2])), Some(class));
        }
        for sweep in 0..SWEEP_COLOURS.len() as u32 {
            let RGBColor(red, green, blue) = Ink::Sweep(sweep).colour();
            assert_eq!(class_of((red, green, blue)), None);
        }
    }

    #[test]
    fn signs_have_sides() {
        let [low, middle, high] = [-2.0, 0.0, 1.0].map(signed);
        assert_eq!((low, high), (SIGNED[0], SIGNED[4]));
        assert_eq!(middle, SIGNED[2]);
    }
}
