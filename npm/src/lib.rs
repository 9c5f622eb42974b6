//! The core's boundary to JavaScript: archives go in as bytes, results come out as plain objects.
//!
//! This is the small, synchronous part. What a JavaScript program calls, with promises, progress and
//! `AbortSignal`, is `js/core.js`, which is made of it.
#![allow(missing_docs, reason = "the public documentation is js/core.d.ts")]

use std::io::Cursor;

use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_wasm_bindgen::Serializer;
use snellius::export::{Format, ReconstructionResult};
use snellius::pipeline::{Settings, observe, reconstruct};
use snellius::scan::Archive;
use snellius::share;
use snellius::spots::Spots;
use wasm_bindgen::prelude::*;

/// The core's version.
#[wasm_bindgen]
pub fn version() -> String {
    snellius::VERSION.to_owned()
}

/// The names of the formats that a result can be written in.
#[wasm_bindgen]
pub fn formats() -> Vec<String> {
    Format::ALL.iter().map(|format| format.name()).collect()
}

/// An open archive, and the spots that were found in it so far.
#[wasm_bindgen]
pub struct Scan {
    archive: Archive<Cursor<Vec<u8>>>,
    settings: Settings,
    spots: Vec<Spots>,
}

#[wasm_bindgen]
impl Scan {
    #[wasm_bindgen(constructor)]
    pub fn new(archive: Vec<u8>, settings: JsValue) -> Result<Self, JsError> {
        Ok(Self {
            settings: from_js(settings)?,
            archive: Archive::open(Cursor::new(archive))?,
            spots: Vec::new(),
        })
    }

    /// How many views there are.
    #[wasm_bindgen(getter)]
    pub fn views(&self) -> usize {
        self.archive.scan().stations.len()
    }

    /// Finds the spots of the next view.
    #[wasm_bindgen(js_name = observeNext)]
    pub fn observe_next(&mut self) -> Result<(), JsError> {
        let view = self.spots.len();
        if view < self.views() {
            self.spots
                .push(observe(&mut self.archive, view, &self.settings)?);
        }
        Ok(())
    }

    /// Measures vessel and object, after every view was observed.
    pub fn measure(&self) -> Result<Reconstruction, JsError> {
        if self.spots.len() < self.views() {
            return Err(JsError::new("not every view was observed"));
        }
        let reconstruction = reconstruct(self.archive.scan(), &self.spots, &self.settings)?;
        Ok(Reconstruction {
            result: reconstruction.result(),
            settings: self.settings,
        })
    }
}

/// A measured scan.
#[wasm_bindgen]
pub struct Reconstruction {
    result: ReconstructionResult,
    settings: Settings,
}

#[wasm_bindgen]
impl Reconstruction {
    /// Reads `result.json`.
    #[wasm_bindgen(js_name = fromJson)]
    pub fn from_json(bytes: &[u8]) -> Result<Self, JsError> {
        Ok(Self {
            result: ReconstructionResult::from_json(bytes)?,
            settings: Settings::default(),
        })
    }

    /// Opens a link's fragment.
    #[wasm_bindgen(js_name = fromLink)]
    pub fn from_link(fragment: &str) -> Result<Self, JsError> {
        let shared = share::decode(fragment)?;
        let result = shared
            .result
            .ok_or_else(|| JsError::new("this link holds settings, but no reconstruction"))?;
        Ok(Self {
            result,
            settings: shared.settings,
        })
    }

    /// What `result.json` holds, as an object.
    pub fn result(&self) -> Result<JsValue, JsError> {
        to_js(&self.result)
    }

    /// The bytes of a file.
    pub fn write(&self, format: &str) -> Result<Vec<u8>, JsError> {
        let mut known = Format::ALL.iter();
        let known = known.find(|known| known.name() == format);
        let format = known.ok_or_else(|| {
            JsError::new(&format!(
                "no format \"{format}\"; there are {}",
                formats().join(", ")
            ))
        })?;
        Ok(self.result.write(*format)?)
    }

    /// The reconstruction as a link's fragment, without the `#`.
    pub fn link(&self) -> Result<String, JsError> {
        Ok(share::encode(&self.settings, Some(&self.result))?.fragment)
    }
}

fn from_js<T: DeserializeOwned + Default>(value: JsValue) -> Result<T, JsError> {
    if value.is_undefined() || value.is_null() {
        return Ok(T::default());
    }
    Ok(serde_wasm_bindgen::from_value(value)?)
}

/// Plain objects, arrays and `null`, as `JSON.parse` would make them.
fn to_js(value: &impl Serialize) -> Result<JsValue, JsError> {
    Ok(value.serialize(&Serializer::json_compatible())?)
}
