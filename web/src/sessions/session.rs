//! One session in its folder.

use std::cell::Cell;

use js_sys::{Array, Uint8ClampedArray};
use wasm_bindgen::prelude::*;
use web_sys::{Blob, File};

use super::folder::{self, Folder};
use super::record::{Found, Record};
use crate::run::Thumbnail;

/// The folder of all sessions.
const SESSIONS: &str = "sessions";
/// What lies in a session's folder.
const RECORD: &str = "session.json";
const ARCHIVE: &str = "scan.zip";
const PICTURE: &str = "picture.rgba";
const FOUND: &str = "found-";

/// A session's folder.
pub(crate) struct Session {
    id: String,
    folder: Folder,
    /// How many files of spots there are.
    parts: Cell<usize>,
}

impl Session {
    /// A new one.
    pub(crate) async fn begin() -> Result<Self, JsValue> {
        // Two tabs may begin one in the same millisecond.
        let chance = (js_sys::Math::random() * 1e6) as u32;
        Self::open(&format!("{:013.0}-{chance:06}", js_sys::Date::now())).await
    }

    /// One that was kept.
    pub(crate) async fn open(id: &str) -> Result<Self, JsValue> {
        let folder = all().await?.folder(id).await?;
        let names = folder.names().await?;
        let parts = names.iter().filter(|name| is_found(name)).count();
        Ok(Self {
            id: id.to_owned(),
            folder,
            parts: Cell::new(parts),
        })
    }

    /// Its name among the sessions.
    pub(crate) fn id(&self) -> &str {
        &self.id
    }

    pub(crate) async fn record(&self) -> Option<Record> {
        Record::from_text(&self.folder.text(RECORD).await.ok()?)
    }

    pub(crate) async fn write(&self, record: &Record) -> Result<(), JsValue> {
        let text = record.to_text().ok_or("it cannot be written down")?;
        self.folder.write_text(RECORD, &text).await
    }

    /// Keeps a copy of the archive, if there is room for it and for what is found in it.
    pub(crate) async fn keep_archive(&self, archive: &Blob) -> Result<(), JsValue> {
        const BESIDE: f64 = 20e6;
        if folder::room()
            .await
            .is_some_and(|room| room < archive.size() + BESIDE)
        {
            return Err("there is no room for it".into());
        }
        self.folder.write(ARCHIVE, archive).await
    }

    pub(crate) async fn archive(&self) -> Option<File> {
        self.folder.file(ARCHIVE).await.ok()
    }

    /// Keeps spots that were found; a file each time, for a file that grows would be copied each time.
    pub(crate) async fn keep_found(&self, found: &Found) -> Result<(), JsValue> {
        let file = found.to_blob().ok_or("they cannot be written down")?;
        let part = self.parts.get();
        self.parts.set(part + 1);
        self.folder.write(&format!("{FOUND}{part:06}"), &file).await
    }

    /// All spots that were kept.
    pub(crate) async fn found(&self) -> Vec<Found> {
        let mut found = Vec::new();
        for name in self.folder.names().await.unwrap_or_default() {
            if is_found(&name)
                && let Ok(bytes) = self.folder.bytes(&name).await
            {
                found.extend(Found::from_bytes(&bytes.to_vec()));
            }
        }
        found
    }

    pub(crate) async fn keep_picture(&self, picture: &Thumbnail) -> Result<(), JsValue> {
        let content = Blob::new_with_u8_array_sequence(&Array::of1(&picture.pixels))?;
        self.folder.write(PICTURE, &content).await
    }

    /// The picture that stands for it, of that width and height.
    pub(crate) async fn picture(&self, [width, height]: [u32; 2]) -> Option<Thumbnail> {
        let bytes = self.folder.bytes(PICTURE).await.ok()?;
        let pixels = Uint8ClampedArray::new(&bytes.buffer());
        (pixels.length() == 4 * width * height).then_some(Thumbnail {
            width,
            height,
            pixels,
        })
    }
}

/// Whether a file holds spots. What a browser has not written to its end lies beside it, under the same name
/// with an ending.
fn is_found(name: &str) -> bool {
    let number = name.strip_prefix(FOUND);
    number.is_some_and(|number| number.bytes().all(|digit| digit.is_ascii_digit()))
}

/// The sessions that were kept, the newest first. One that cannot be read is passed over.
pub(super) async fn kept() -> Result<Vec<(String, Record)>, JsValue> {
    let mut sessions = Vec::new();
    for id in all().await?.names().await? {
        let session = Session::open(&id).await?;
        if let Some(record) = session.record().await {
            sessions.push((id, record));
        }
    }
    sessions.sort_by(|(_, a), (_, b)| b.changed.total_cmp(&a.changed));
    Ok(sessions)
}

/// Removes a session for good.
pub(super) async fn remove(id: &str) -> Result<(), JsValue> {
    all().await?.remove(id).await
}

async fn all() -> Result<Folder, JsValue> {
    Folder::outermost().await?.folder(SESSIONS).await
}
