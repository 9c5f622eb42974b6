//! Adding an entry to an archive that is too large to be copied: only what changes is written.

use std::io::{self, Read, Seek, SeekFrom, Write};

use zip::result::ZipError;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

/// What follows the first bytes of an archive that gets another entry.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tail {
    /// How many of the archive's first bytes stay: all its entries, not its directory.
    pub keep: u64,
    /// What comes after them: the new entry and the new directory.
    pub bytes: Vec<u8>,
}

/// Adds an entry at an archive's end. The archive itself is only read: the new one is its first
/// [`Tail::keep`] bytes, followed by [`Tail::bytes`].
pub(super) fn append<R: Read + Seek>(
    reader: R,
    name: &str,
    content: &[u8],
) -> Result<Tail, ZipError> {
    let mut writer = ZipWriter::new_append(Overlay::over(reader))?;
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
    writer.start_file(name, options)?;
    writer.write_all(content)?;
    let overlay = writer.finish()?;
    Ok(Tail {
        keep: overlay.keep.unwrap_or(overlay.position),
        bytes: overlay.tail,
    })
}

/// Reads what lies below, and keeps what is written beside it.
struct Overlay<R> {
    below: R,
    /// Where the first write went: from there on, what was written counts.
    keep: Option<u64>,
    tail: Vec<u8>,
    position: u64,
}

impl<R> Overlay<R> {
    const fn over(below: R) -> Self {
        Self {
            below,
            keep: None,
            tail: Vec::new(),
            position: 0,
        }
    }
}

impl<R: Read + Seek> Read for Overlay<R> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let count = match self.keep {
            Some(keep) if self.position >= keep => {
                let from = ((self.position - keep) as usize).min(self.tail.len());
                (&self.tail[from..]).read(into)?
            }
            keep => {
                let left = keep.map_or(u64::MAX, |keep| keep - self.position);
                self.below.seek(SeekFrom::Start(self.position))?;
                self.below.by_ref().take(left).read(into)?
            }
        };
        self.position += count as u64;
        Ok(count)
    }
}

impl<R> Write for Overlay<R> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let keep = *self.keep.get_or_insert(self.position);
        let below = || io::Error::other("what is there already cannot be written anew");
        let from = self.position.checked_sub(keep).ok_or_else(below)? as usize;
        let end = from + bytes.len();
        if self.tail.len() < end {
            self.tail.resize(end, 0);
        }
        self.tail[from..end].copy_from_slice(bytes);
        self.position += bytes.len() as u64;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl<R: Seek> Seek for Overlay<R> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let position = match to {
            SeekFrom::Start(position) => Some(position),
            SeekFrom::Current(by) => self.position.checked_add_signed(by),
            SeekFrom::End(by) => {
                let end = match self.keep {
                    Some(keep) => keep + self.tail.len() as u64,
                    None => self.below.seek(SeekFrom::End(0))?,
                };
                end.checked_add_signed(by)
            }
        };
        self.position = position.ok_or(io::ErrorKind::InvalidInput)?;
        Ok(self.position)
    }
}
