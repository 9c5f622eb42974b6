//! What a link holds once, as JSON.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json as tree};

use super::{LinkError, Rounding};
use crate::export::{OneOrMany, ReconstructionResult};
use crate::json;
use crate::pipeline::{PARAMETERS, ParameterKind, Settings};

/// Vessel points and points without refraction are for looking at, mm.
const SHOWN_STEP: f64 = 0.5;
/// Standard deviations are told to within a fourth root of two.
pub(super) const SIGMA_STEPS_PER_OCTAVE: f64 = 2.0;
/// A rounding that no measurement needs finer, mm; also where a point claims to have no standard deviation.
const FINEST: f64 = 1e-4;
/// No search for an index tries more of them.
const MOST_INDICES: usize = 10_000;

/// The head of a link. Keys are short, and what is as usual is left out: every byte counts.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Head {
    /// Settings that differ from the defaults.
    #[serde(rename = "set", default, skip_serializing_if = "Map::is_empty")]
    settings: Map<String, Value>,
    /// The result without its views, and without what every result has.
    #[serde(rename = "res", default, skip_serializing_if = "Option::is_none")]
    result: Option<Map<String, Value>>,
    /// The columns' steps, mm: x, y and z of an object point, ray distance.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    steps: Option<[f64; 4]>,
    /// Whether a view has a list, as of a line laser.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub(super) line: bool,
    /// The views' ids.
    #[serde(default, skip_serializing_if = "Ids::is_none")]
    pub(super) ids: Ids,
}

/// The views' ids: most often numbers one after the other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub(super) enum Ids {
    /// How many digits, and the first.
    Numbers(usize, u64),
    /// Each by itself.
    Names(Vec<String>),
}

impl Default for Ids {
    fn default() -> Self {
        Self::Names(Vec::new())
    }
}

impl Ids {
    fn is_none(&self) -> bool {
        *self == Self::default()
    }

    fn of(result: &ReconstructionResult) -> Self {
        let names = || result.views.iter().map(|view| view.id.clone());
        let first = names().next().unwrap_or_default();
        let numbers = Self::Numbers(first.len(), first.parse().unwrap_or(u64::MAX));
        let are_numbers = names()
            .enumerate()
            .all(|(view, name)| numbers.name(view).as_ref() == Some(&name));
        if are_numbers {
            numbers
        } else {
            Self::Names(names().collect())
        }
    }

    /// The id of a view.
    pub(super) fn name(&self, view: usize) -> Option<String> {
        // No id of a number has more digits than 64 bits need.
        const DIGITS: usize = 20;
        match self {
            Self::Numbers(digits, first) if *digits <= DIGITS => {
                let number = first.checked_add(view as u64)?;
                Some(format!("{number:0digits$}"))
            }
            Self::Numbers(..) => None,
            Self::Names(names) => names.get(view).cloned(),
        }
    }
}

/// How wide the columns' steps are, mm.
pub(super) struct Steps {
    pub(super) object: [f64; 3],
    pub(super) ray_distance: f64,
    pub(super) shown: f64,
}

impl Head {
    pub(super) fn of_settings(settings: &Settings) -> Self {
        let default = json::tree_of(&Settings::default());
        let changed = difference(json::tree_of(settings), &default);
        Self {
            settings: as_map(changed.unwrap_or_default()),
            ..Self::default()
        }
    }

    /// `part`: the rounding error in parts of the smallest standard deviation.
    pub(super) fn new(settings: &Settings, result: &ReconstructionResult, part: f64) -> Self {
        let mut once = result.clone();
        once.views = Vec::new();
        let mut once = as_map(rounded(json::tree_of(&once)));
        for usual in ["format", "version", "length_unit", "views"] {
            once.remove(usual);
        }
        let error = smallest_sigma(result).map(|sigma| part * sigma);
        let smallest = error.into_iter().fold(f64::INFINITY, f64::min);
        let step = |error: f64| short((2.0 * error).max(FINEST));
        Self {
            result: Some(once),
            steps: Some([
                step(error[0]),
                step(error[1]),
                step(error[2]),
                // It says how far to trust a point: to a fraction of the point's own uncertainty.
                step(smallest.max(0.25 * mean_ray_distance(result))),
            ]),
            line: matches!(result.views.first(), Some(v) if matches!(v.object, OneOrMany::Many(_))),
            ids: Ids::of(result),
            ..Self::of_settings(settings)
        }
    }

    pub(super) fn to_json(&self) -> Vec<u8> {
        json::tree_of(self).to_string().into_bytes()
    }

    pub(super) fn from_json(json: &[u8]) -> Result<Self, LinkError> {
        let head: Self = serde_json::from_slice(json).map_err(damaged)?;
        // Steps that are none would make points that are none.
        let are_steps = |steps: [f64; 4]| steps.iter().all(|s| (FINEST / 2.0..1e3).contains(s));
        if head.result.is_some() && !head.steps.is_some_and(are_steps) {
            return Err(LinkError::Damaged("its steps are none".to_owned()));
        }
        Ok(head)
    }

    pub(super) fn steps(&self) -> Steps {
        let [x, y, z, ray_distance] = self.steps.unwrap_or([FINEST; 4]);
        Steps {
            object: [x, y, z],
            ray_distance,
            shown: SHOWN_STEP,
        }
    }

    pub(super) fn rounding(&self) -> Option<Rounding> {
        self.result.as_ref()?;
        let Steps {
            object,
            ray_distance,
            shown,
        } = self.steps();
        // Half a step, and what the last bits of a sum add.
        let half = |step: f64| 0.500_001 * step;
        Some(Rounding {
            object: object.map(half),
            ray_distance: half(ray_distance),
            shown: half(shown),
            sigma_factor: libm::exp2(0.500_001 / SIGMA_STEPS_PER_OCTAVE),
        })
    }

    /// The settings; those that no program of ours would have set are refused.
    pub(super) fn settings(&self) -> Result<Settings, LinkError> {
        let settings: Settings = of_map(&self.settings)?;
        for parameter in &PARAMETERS {
            if let ParameterKind::Number(number) = &parameter.kind {
                let value = (number.get)(&settings);
                if !(number.low..=number.high).contains(&value) {
                    return Err(LinkError::Damaged(format!(
                        "{} cannot be {value}",
                        parameter.name
                    )));
                }
            }
        }
        let range = settings.index_range;
        let is_index = |n: f64| (1.0..=4.0).contains(&n);
        let is_range = is_index(range.from) && is_index(range.to) && range.count <= MOST_INDICES;
        if !is_range || !settings.index.is_none_or(is_index) {
            return Err(LinkError::Damaged("its index cannot be".to_owned()));
        }
        Ok(settings)
    }

    /// The result, still without views.
    pub(super) fn result(&self) -> Result<Option<ReconstructionResult>, LinkError> {
        let Some(once) = &self.result else {
            return Ok(None);
        };
        let mut once = once.clone();
        let usual = tree!({
            "format": "refractive-reconstruction", "version": 1, "length_unit": "mm", "views": [],
        });
        once.extend(as_map(usual));
        of_map(&once).map(Some)
    }
}

fn of_map<T: DeserializeOwned>(map: &Map<String, Value>) -> Result<T, LinkError> {
    json::of_tree(map).map_err(|error| LinkError::Damaged(json::without_position(&error)))
}

fn damaged(error: impl ToString) -> LinkError {
    LinkError::Damaged(error.to_string())
}

fn as_map(value: Value) -> Map<String, Value> {
    match value {
        Value::Object(map) => map,
        _ => Map::new(),
    }
}

/// What of a value is not as the default has it.
fn difference(value: Value, default: &Value) -> Option<Value> {
    match value {
        same if same == *default => None,
        Value::Object(map) => {
            let changed = map.into_iter().filter_map(|(key, value)| {
                let changed = difference(value, default.get(&key).unwrap_or(&Value::Null))?;
                Some((key, changed))
            });
            Some(Value::Object(json::object(changed)))
        }
        changed => Some(changed),
    }
}

/// Numbers to seven digits: a tenth of a micrometre in a metre.
fn rounded(value: Value) -> Value {
    match value {
        Value::Number(number) if number.is_f64() => {
            let number = number.as_f64().unwrap_or_default();
            tree!(format!("{number:.6e}").parse::<f64>().unwrap_or(number))
        }
        Value::Array(list) => list.into_iter().map(rounded).collect(),
        Value::Object(map) => Value::Object(json::object(
            map.into_iter().map(|(key, v)| (key, rounded(v))),
        )),
        other => other,
    }
}

/// A length of two digits, not larger.
fn short(length: f64) -> f64 {
    let two: f64 = format!("{length:.1e}").parse().unwrap_or(length);
    if two <= length {
        two
    } else {
        format!("{:.1e}", 0.95 * length).parse().unwrap_or(length)
    }
}

fn smallest_sigma(result: &ReconstructionResult) -> [f64; 3] {
    let sigmas = result.views.iter().flat_map(|v| v.object_sigma.iter());
    let smallest = sigmas.fold([f64::INFINITY; 3], |low, sigma| {
        std::array::from_fn(|axis| low[axis].min(sigma[axis]))
    });
    // Without points any step will do.
    smallest.map(|sigma| if sigma.is_finite() { sigma } else { 1.0 })
}

fn mean_ray_distance(result: &ReconstructionResult) -> f64 {
    let distances = result.views.iter().flat_map(|v| v.ray_distance.iter());
    let count = distances.clone().count().max(1);
    distances.sum::<f64>() / count as f64
}
