//! What the bench can be filled with.

/// A substance by name, with its refractive index and where that figure is from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Substance {
    /// How links name it.
    pub key: &'static str,
    /// How people name it.
    pub name: &'static str,
    /// Refractive index at 20 degrees Celsius, of red laser light (635 nm) unless the source says
    /// otherwise.
    pub index: f64,
    /// Where the index is from.
    pub source: &'static str,
}

/// The substances that the bench knows, thinnest first.
pub const SUBSTANCES: [Substance; 8] = [
    Substance {
        key: "air",
        name: "Air",
        index: 1.0003,
        source: "P. E. Ciddor, Appl. Opt. 35, 1566 (1996)",
    },
    Substance {
        key: "water",
        name: "Water",
        index: 1.3320,
        source: "M. Daimon, A. Masumura, Appl. Opt. 46, 3811 (2007)",
    },
    Substance {
        key: "sea-water",
        name: "Sea water (35 g/kg)",
        index: 1.3381,
        source: "X. Quan, E. S. Fry, Appl. Opt. 34, 3477 (1995)",
    },
    Substance {
        key: "ethanol",
        name: "Ethanol",
        index: 1.3604,
        source: "J. Rheims, J. Koeser, T. Wriedt, Meas. Sci. Technol. 8, 601 (1997)",
    },
    Substance {
        key: "formalin",
        name: "Formalin (37 %)",
        index: 1.3765,
        source: "suppliers' data sheets, sodium light (589 nm)",
    },
    Substance {
        key: "glycerol",
        name: "Glycerol",
        index: 1.4706,
        source: "J. Rheims, J. Koeser, T. Wriedt, Meas. Sci. Technol. 8, 601 (1997)",
    },
    Substance {
        key: "acrylic",
        name: "Acrylic (PMMA)",
        index: 1.4907,
        source: "G. Beadie et al., Appl. Opt. 54, F139 (2015)",
    },
    Substance {
        key: "glass",
        name: "Glass (soda-lime)",
        index: 1.5215,
        source: "M. Rubin, Sol. Energy Mater. 12, 275 (1985)",
    },
];

/// The indices of the liquids whose name is not told.
pub const MYSTERIES: [f64; 5] = [1.349, 1.383, 1.418, 1.447, 1.366];

/// A medium on the bench.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Medium {
    /// One of [`SUBSTANCES`], by its place.
    Named(usize),
    /// Any index.
    Index(f64),
    /// One of [`MYSTERIES`], by its place: its index is to be found out.
    Mystery(usize),
}

impl Medium {
    /// The least and the greatest index that can be chosen; four decimals are kept.
    pub const RANGE: (f64, f64) = (0.9, 2.5);

    /// A medium by its index, to the decimals that are kept; `None` out of range.
    pub fn of_index(index: f64) -> Option<Self> {
        let scale = 10_000.0;
        (Self::RANGE.0..=Self::RANGE.1)
            .contains(&index)
            .then(|| Self::Index((index * scale).round() / scale))
    }

    /// The refractive index.
    pub fn index(self) -> f64 {
        match self {
            Self::Named(place) => SUBSTANCES[place].index,
            Self::Index(index) => index,
            Self::Mystery(place) => MYSTERIES[place],
        }
    }

    /// Whether the index is to be found out.
    pub const fn is_mystery(self) -> bool {
        matches!(self, Self::Mystery(_))
    }

    /// How a person calls it.
    pub fn name(self) -> String {
        match self {
            Self::Named(place) => SUBSTANCES[place].name.to_owned(),
            Self::Index(index) => format!("n = {index}"),
            Self::Mystery(place) => format!("Mystery liquid {}", place + 1),
        }
    }

    /// How a link calls it.
    pub fn key(self) -> String {
        match self {
            Self::Named(place) => SUBSTANCES[place].key.to_owned(),
            Self::Index(index) => format!("{index}"),
            Self::Mystery(place) => format!("mystery{}", place + 1),
        }
    }

    /// The medium that a word of a link means, unless it is a number.
    pub(super) fn named(word: &str) -> Option<Self> {
        if let Some(place) = SUBSTANCES.iter().position(|s| s.key == word) {
            return Some(Self::Named(place));
        }
        let place = |number: usize| number.checked_sub(1).filter(|p| *p < MYSTERIES.len());
        let number = word.strip_prefix("mystery")?.parse().ok()?;
        place(number).map(Self::Mystery)
    }
}
