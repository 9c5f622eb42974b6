use crate::scan::KnownKind;

/// Why the index cannot even be tried for.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum IndexError {
    /// A known shape lacks its value, or has an impossible one.
    #[error("known[{entry}].{key}: needed, between {least} and {greatest}")]
    KnownValue {
        /// Which of the manifest's list.
        entry: usize,
        /// The key.
        key: &'static str,
        /// More than this.
        least: f64,
        /// Less than this.
        greatest: f64,
    },
    /// A weight is negative or no number.
    #[error("known[{entry}].weight: {weight}; a weight is 0 or more")]
    Weight {
        /// Which of the manifest's list.
        entry: usize,
        /// The weight.
        weight: f64,
    },
    /// No known shape counts.
    #[error(
        "known: all weights are 0, so nothing is known of the object; give one a weight above 0"
    )]
    AllWeightsZero,
    /// A known shape names too many or too few faces.
    #[error(
        "known[{entry}].views: {found} lists of views, and this kind of shape is about {needed}"
    )]
    FaceCount {
        /// Which of the manifest's list.
        entry: usize,
        /// How many lists it needs.
        needed: usize,
        /// How many there are.
        found: usize,
    },
    /// A known shape names a view that is not there.
    #[error("known[{entry}].views: there is no view \"{id}\"")]
    UnknownView {
        /// Which of the manifest's list.
        entry: usize,
        /// The id.
        id: String,
    },
    /// The points of a face do not make one.
    #[error(
        "known[{entry}]: {found} object points on a face, and it takes {needed} that do not lie on one line"
    )]
    TooFewPoints {
        /// Which of the manifest's list.
        entry: usize,
        /// How many points a face needs.
        needed: usize,
        /// How many there are.
        found: usize,
    },
    /// No face of the object is what a known shape is about.
    #[error(
        "known[{entry}]: no faces for this {} are found among the object's points; name them by \"views\", or scan more of them",
        name(.kind)
    )]
    NoFace {
        /// Which of the manifest's list.
        entry: usize,
        /// What it is.
        kind: KnownKind,
    },
    /// Two known shapes want different indices.
    #[error(
        "known[{first}] and known[{second}] contradict each other: {first_index} would meet the one and \
         {second_index} the other"
    )]
    Contradiction {
        /// One of them.
        first: usize,
        /// The other.
        second: usize,
        /// What the one wants, with its standard deviation.
        first_index: String,
        /// What the other wants.
        second_index: String,
    },
    /// No known shape was given.
    #[error("known: the scan says nothing of the object's shape, so it cannot tell the index")]
    NothingKnown,
    /// There is no index to look for.
    #[error(
        "the search range from {from} to {to} holds no index of a liquid; these lie between 1 and 2.5"
    )]
    Range {
        /// Its start.
        from: f64,
        /// Its end.
        to: f64,
    },
    /// The beam enters the liquid in no view that has an object point.
    #[error(
        "no view shows the object through the liquid, so nothing in the scan depends on its index"
    )]
    NoSights,
}

const fn name(kind: &KnownKind) -> &'static str {
    match kind {
        KnownKind::PlaneAngle => "plane_angle",
        KnownKind::EdgeLength => "edge_length",
        KnownKind::Flatness => "flatness",
        KnownKind::Radius => "radius",
    }
}
