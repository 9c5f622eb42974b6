//! Reads a file that lies with the browser, piece by piece, so that an archive may be larger than memory.

use std::io::{self, Read, Seek, SeekFrom};

use js_sys::Uint8Array;
use wasm_bindgen::JsValue;
use web_sys::{Blob, FileReaderSync};

/// A file as something to read and seek in. Works in workers only: nowhere else may reading wait.
pub(super) struct BlobReader {
    blob: Blob,
    reader: FileReaderSync,
    /// JavaScript counts a file's bytes in f64: exact up to 2^53.
    length: u64,
    position: u64,
}

impl BlobReader {
    pub(super) fn new(blob: Blob) -> Result<Self, JsValue> {
        Ok(Self {
            length: blob.size() as u64,
            reader: FileReaderSync::new()?,
            blob,
            position: 0,
        })
    }

    fn piece(&self, end: u64) -> Result<Uint8Array, JsValue> {
        let slice = self
            .blob
            .slice_with_f64_and_f64(self.position as f64, end as f64)?;
        Ok(Uint8Array::new(
            &self.reader.read_as_array_buffer(&slice)?.into(),
        ))
    }
}

impl Read for BlobReader {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let end = self.length.min(self.position + into.len() as u64);
        if end <= self.position {
            return Ok(0);
        }
        let piece = self.piece(end).map_err(|e| unreadable(&e))?;
        let count = piece.length() as usize;
        piece.copy_to(&mut into[..count]);
        self.position += count as u64;
        Ok(count)
    }
}

impl Seek for BlobReader {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let position = match to {
            SeekFrom::Start(position) => Some(position),
            SeekFrom::End(offset) => self.length.checked_add_signed(offset),
            SeekFrom::Current(offset) => self.position.checked_add_signed(offset),
        };
        self.position = position.ok_or(io::ErrorKind::InvalidInput)?;
        Ok(self.position)
    }
}

/// A file that was changed or taken away after it was chosen may no longer be read.
fn unreadable(error: &JsValue) -> io::Error {
    let detail = js_sys::Reflect::get(error, &"message".into())
        .ok()
        .and_then(|message| message.as_string())
        .unwrap_or_default();
    io::Error::other(format!(
        "the browser can no longer read the file; was it changed or moved? {detail}"
    ))
}
