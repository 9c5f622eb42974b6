//! What is written down of a session.

use js_sys::Array;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use snellius::spots::SpotSettings;
use wasm_bindgen::JsValue;
use web_sys::Blob;

use crate::history::History;
use crate::run::{Plan, WrittenSpots, build};

/// The form of what is written down; raised when older pages could not read it.
const VERSION: u32 = 1;

/// Of larger archives no copy is kept, bytes.
const LARGE: f64 = 1e9;

/// A session: how a scan is measured, and how far that is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Record {
    version: u32,
    /// What its owner calls it.
    pub(crate) name: String,
    /// The name of the archive.
    pub(crate) file_name: String,
    /// The archive's size, by which it is known again.
    #[serde(default)]
    pub(crate) archive_bytes: Option<f64>,
    /// Where that came from.
    #[serde(default)]
    pub(crate) origin: Origin,
    /// What of it is not kept.
    #[serde(default)]
    pub(crate) unkept: Option<Unkept>,
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

/// Where the archive of a session came from, and can be had from again.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Origin {
    /// It is a file.
    #[default]
    File,
    /// It was made of a folder with a manifest.
    Folder,
    /// It was made of pictures, in the form.
    Pictures,
}

/// What of a session is not kept, and why.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Unkept {
    /// A copy of its archive, which would take as much of the disk again.
    LargeArchive,
    /// A copy of its archive: the browser has no room for it, or fails.
    Archive,
    /// What is new of it, likewise; or all, where the browser keeps no files.
    News,
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
    /// A session that begins, with an archive of that name, size and origin.
    pub(crate) fn new(name: &str, bytes: f64, origin: Origin) -> Self {
        let now = js_sys::Date::now();
        Self {
            version: VERSION,
            name: name.trim_end_matches(".zip").to_owned(),
            file_name: name.to_owned(),
            archive_bytes: Some(bytes),
            origin,
            unkept: (bytes > LARGE).then_some(Unkept::LargeArchive),
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

    /// Whether no copy of its archive is kept, so that it has to be had again.
    pub(crate) fn lacks_archive(&self) -> bool {
        matches!(self.unkept, Some(Unkept::LargeArchive | Unkept::Archive)) || self.is_large()
    }

    fn is_large(&self) -> bool {
        self.archive_bytes.is_some_and(|bytes| bytes > LARGE)
    }

    /// Whether that may be its archive, which was chosen again.
    pub(crate) fn is_of(&self, archive: &Blob) -> bool {
        self.archive_bytes
            .is_none_or(|bytes| bytes == archive.size())
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
#[derive(Clone, Debug)]
pub(crate) struct Found {
    /// How they were looked for.
    pub(crate) settings: SpotSettings,
    /// With the number of their view.
    pub(crate) spots: Vec<(usize, WrittenSpots)>,
}

/// What stands before the spots in a file: a line of its own.
#[derive(Serialize, Deserialize)]
struct Head {
    /// The build whose spots they are: another may write them otherwise, or find others.
    build: String,
    settings: SpotSettings,
    /// Each view's number, and how many bytes it has.
    views: Vec<(usize, u32)>,
}

impl Found {
    /// As a file.
    pub(super) fn to_blob(&self) -> Option<Blob> {
        let of = |(view, spots): &(usize, WrittenSpots)| (*view, spots.length());
        let head = Head {
            build: build(),
            settings: self.settings,
            views: self.spots.iter().map(of).collect(),
        };
        let head = JsValue::from(to_json(&head)? + "\n");
        let spots = self.spots.iter().map(|(_, spots)| spots.clone().into());
        let parts: Array = std::iter::once(head).chain(spots).collect();
        Blob::new_with_blob_sequence(&parts).ok()
    }

    /// Of a file; `None` if it was not written to its end, or by another build of the page.
    pub(super) fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let line = bytes.iter().position(|byte| *byte == b'\n')?;
        let head: Head = from_json(std::str::from_utf8(&bytes[..line]).ok()?)?;
        if head.build != build() {
            return None;
        }
        let mut rest = &bytes[line + 1..];
        let mut spots = Vec::with_capacity(head.views.len());
        for (view, length) in head.views {
            let (of_view, others) = rest.split_at_checked(length as usize)?;
            spots.push((view, WrittenSpots::from(of_view)));
            rest = others;
        }
        Some(Self {
            settings: head.settings,
            spots,
        })
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
