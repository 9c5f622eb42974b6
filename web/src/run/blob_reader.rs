//! Reads a file that lies with the browser, piece by piece, so that an archive may be larger than memory.

use std::io::{self, Read, Seek, SeekFrom};

use js_sys::Uint8Array;
use wasm_bindgen::JsValue;
use web_sys::{Blob, FileReaderSync};

/// How much of the file is read at a time: one request to the browser for a usual picture, and no more
/// than it may keep.
const READ_AHEAD: u64 = 256 << 10;

/// A file as something to read and seek in. Works in workers only: nowhere else may reading wait.
///
/// What was read last is kept, wherever is sought to: a ZIP's reader goes back and forth between an entry's
/// header and its content, and a [`std::io::BufReader`] would read both anew each time.
pub(super) struct BlobReader {
    blob: Blob,
    reader: FileReaderSync,
    /// JavaScript counts a file's bytes in f64: exact up to 2^53.
    length: u64,
    position: u64,
    /// What was read last, and where in the file that begins.
    window: Vec<u8>,
    window_start: u64,
}

impl BlobReader {
    pub(super) fn new(blob: Blob) -> Result<Self, JsValue> {
        Ok(Self {
            length: blob.size() as u64,
            reader: FileReaderSync::new()?,
            blob,
            position: 0,
            window: Vec::new(),
            window_start: 0,
        })
    }

    /// What of the window begins at the position.
    fn at_hand(&self) -> &[u8] {
        let from = self.position.checked_sub(self.window_start);
        // A worker counts its memory in 32 bits, and the file may be longer.
        let from = from.and_then(|from| usize::try_from(from).ok());
        from.and_then(|from| self.window.get(from..))
            .unwrap_or_default()
    }

    fn move_window(&mut self) -> io::Result<()> {
        let end = self.length.min(self.position.saturating_add(READ_AHEAD));
        self.window.clear();
        if end > self.position {
            let piece = self.piece(end).map_err(|e| unreadable(&e))?;
            self.window.resize(piece.length() as usize, 0);
            piece.copy_to(&mut self.window);
        }
        self.window_start = self.position;
        Ok(())
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
        if self.at_hand().is_empty() {
            self.move_window()?;
        }
        let count = self.at_hand().read(into)?;
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
