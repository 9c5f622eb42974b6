use serde::{Deserialize, Serialize};

use super::{PipelineError, Settings};

/// The stages a scan goes through, in their order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Stage {
    /// The archive and what its manifest says.
    Scan,
    /// Spots in the pictures.
    Spots,
    /// The vessel's wall.
    Vessel,
    /// The object's points.
    Object,
    /// The liquid's refractive index.
    Index,
}

/// Something to know before trusting a reconstruction.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Warning {
    /// The stage it is about.
    pub stage: Stage,
    /// A plain sentence.
    pub text: String,
}

impl Settings {
    /// The first stage that gives something else with `other`; `None` if none does. The stages before it
    /// need not run again.
    pub fn first_changed(&self, other: &Self) -> Option<Stage> {
        if self.spots != other.spots {
            Some(Stage::Spots)
        } else if self.vessel != other.vessel {
            Some(Stage::Vessel)
        } else if self.object != other.object
            || self.accept_media != other.accept_media
            || (self.index, self.index_method, self.index_range)
                != (other.index, other.index_method, other.index_range)
        {
            Some(Stage::Object)
        } else {
            None
        }
    }
}

impl PipelineError {
    /// The stage that could not be done.
    pub const fn stage(&self) -> Stage {
        match self {
            Self::Scan(_) => Stage::Scan,
            Self::NoSpots { .. } => Stage::Spots,
            Self::Vessel(_) => Stage::Vessel,
            Self::Index(_) | Self::IndexImpossible(_) => Stage::Index,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_reaches_back_to_the_earliest_stage_it_concerns() {
        let usual = Settings::default();
        assert_eq!(usual.first_changed(&usual), None);

        let mut other = usual;
        other.index = Some(1.4);
        assert_eq!(usual.first_changed(&other), Some(Stage::Object));
        other.vessel.outlier += 1.0;
        assert_eq!(usual.first_changed(&other), Some(Stage::Vessel));
        other.spots.peak += 1.0;
        assert_eq!(usual.first_changed(&other), Some(Stage::Spots));
    }
}
