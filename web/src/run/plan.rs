use serde::{Deserialize, Serialize};
use snellius::pipeline::{Correction, Settings, Stage};

/// How a scan is measured: the settings, and what a person says of spots.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Plan {
    pub(crate) settings: Settings,
    pub(crate) corrections: Vec<Correction>,
}

impl Plan {
    /// The first stage that gives something else with `other`.
    pub(crate) fn first_changed(&self, other: &Self) -> Option<Stage> {
        let by_settings = self.settings.first_changed(&other.settings);
        let by_spots = (self.corrections != other.corrections).then_some(Stage::Vessel);
        by_settings.into_iter().chain(by_spots).min()
    }
}
