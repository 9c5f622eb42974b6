use serde::{Deserialize, Serialize};
use snellius::pipeline::{Correction, Settings, Stage};

/// How a scan is measured: the settings, and what a person says of spots.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Plan {
    pub(crate) settings: Settings,
    pub(crate) corrections: Vec<Correction>,
}

impl Plan {
    /// The plan as far as it matters to what the scan tells of the liquid's index.
    pub(crate) fn without_index(&self) -> Self {
        let mut plan = self.clone();
        plan.settings.index = None;
        plan.settings.index_method = None;
        plan
    }

    /// The first stage that gives something else with `other`.
    pub(crate) fn first_changed(&self, other: &Self) -> Option<Stage> {
        let by_settings = self.settings.first_changed(&other.settings);
        let by_spots = (self.corrections != other.corrections).then_some(Stage::Vessel);
        by_settings.into_iter().chain(by_spots).min()
    }
}
