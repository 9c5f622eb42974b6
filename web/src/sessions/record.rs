//! What is written down of a session.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use snellius::spots::{SpotSettings, Spots};
use wasm_bindgen::JsValue;

use crate::history::History;
use crate::run::Plan;

/// The form of what is written down; raised when older pages could not read it.
const VERSION: u32 = 1;

/// A session: how a scan is measured, and how far that is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Record {
    version: u32,
    /// What its owner calls it.
    pub(crate) name: String,
    /// The name of the archive.
    pub(crate) file_name: String,
    /// When it was begun and changed last, ms since 1970.
    pub(crate) begun: f64,
    pub(crate) changed: f64,
    /// How far the measurement is.
    pub(crate) progress: HowFar,
    pub(crate) plan: Plan,
    pub(crate) history: History,
    pub(crate) chosen: Option<usize>,
    /// It was deleted, and is gone when the page is opened the next time.
    #[serde(default)]
    pub(crate) deleted: bool,
    /// Width and height of the picture that stands for it, if there is one.
    #[serde(default)]
    pub(crate) picture: Option<[u32; 2]>,
}

/// How far a measurement is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum HowFar {
    /// So many views of all have been looked at.
    Looking { done: usize, views: usize },
    /// So many object points were found.
    Measured { points: usize, views: usize },
    /// Something is wanted first, or wrong.
    Stopped { views: usize },
}

impl Record {
    /// A session that begins.
    pub(crate) fn new(name: &str) -> Self {
        let now = js_sys::Date::now();
        Self {
            version: VERSION,
            name: name.trim_end_matches(".zip").to_owned(),
            file_name: name.to_owned(),
            begun: now,
            changed: now,
            progress: HowFar::Looking { done: 0, views: 0 },
            plan: Plan::default(),
            history: History::default(),
            chosen: None,
            deleted: false,
            picture: None,
        }
    }

    /// As it is written down.
    pub(crate) fn to_text(&self) -> Option<String> {
        to_json(self)
    }

    /// Of what was written down; `None` if this page cannot read it.
    pub(crate) fn from_text(text: &str) -> Option<Self> {
        from_json::<Self>(text).filter(|record| record.version <= VERSION)
    }
}

/// Spots that were found, so that nobody has to look for them again.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Found {
    /// How they were looked for.
    pub(crate) settings: SpotSettings,
    /// With the number of their view.
    pub(crate) spots: Vec<(usize, Spots)>,
}

impl Found {
    pub(super) fn to_text(&self) -> Option<String> {
        to_json(self)
    }

    pub(super) fn from_text(text: &str) -> Option<Self> {
        from_json(text)
    }
}

/// The browser's own JSON: numbers come back to the last bit.
fn to_json(value: &impl Serialize) -> Option<String> {
    let value = value.serialize(&serde_wasm_bindgen::Serializer::json_compatible());
    js_sys::JSON::stringify(&value.ok()?).ok()?.as_string()
}

fn from_json<T: DeserializeOwned>(text: &str) -> Option<T> {
    let value: JsValue = js_sys::JSON::parse(text).ok()?;
    serde_wasm_bindgen::from_value(value).ok()
}
