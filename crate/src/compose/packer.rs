//! The layout of an archive around files that are too large to be copied: only what is new is written.

use std::cell::Cell;
use std::io::{self, Read, Seek, SeekFrom, Write};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use crate::scan::{MANIFEST_NAME, Manifest, WriteError};

/// A piece of an archive; one after the other they are the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Piece {
    /// What is new: headers, the manifest, the directory.
    Bytes(Vec<u8>),
    /// A file that was added, byte for byte: the first has number 0.
    File(usize),
}

/// Packs files into a scan archive without keeping them: they are read once, for their checksums, and the
/// archive is given as [pieces](Piece).
///
/// ```
/// use snellius::compose::{Packer, Piece};
///
/// let mut packer = Packer::new();
/// packer.add("images/0-on.png", 5, &mut b"light".as_slice())?;
/// let pieces = packer.finish_with(b"{}")?;
/// assert_eq!(pieces[1], Piece::File(0));
/// # Ok::<(), snellius::scan::WriteError>(())
/// ```
#[derive(Debug)]
pub struct Packer {
    zip: ZipWriter<Skeleton>,
}

impl Default for Packer {
    fn default() -> Self {
        Self::new()
    }
}

impl Packer {
    /// Begins an archive.
    pub fn new() -> Self {
        Self {
            zip: ZipWriter::new(Skeleton::default()),
        }
    }

    /// Adds a file of a length, bytes, under a name.
    pub fn add(&mut self, name: &str, length: u64, file: &mut impl Read) -> Result<(), WriteError> {
        if length == 0 {
            return Err(io::Error::other(format!("{name} is empty")).into());
        }
        let stored = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Stored)
            .large_file(length >= u64::from(u32::MAX));
        self.zip.start_file(name, stored)?;
        self.within_a_file(true);
        let copied = io::copy(file, &mut self.zip);
        self.within_a_file(false);
        match copied? {
            copied if copied == length => Ok(()),
            copied => Err(io::Error::other(format!(
                "{name}: {copied} bytes could be read, not {length}; was it changed?"
            ))
            .into()),
        }
    }

    /// Adds the manifest and closes the archive.
    pub fn finish(self, manifest: &Manifest) -> Result<Vec<Piece>, WriteError> {
        self.finish_with(&serde_json::to_vec_pretty(manifest)?)
    }

    /// Likewise, with a manifest that was written elsewhere.
    pub fn finish_with(mut self, manifest: &[u8]) -> Result<Vec<Piece>, WriteError> {
        let deflated = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
        self.zip.start_file(MANIFEST_NAME, deflated)?;
        self.zip.write_all(manifest)?;
        Ok(self.zip.finish()?.into_pieces())
    }

    fn within_a_file(&self, is: bool) {
        if let Some(skeleton) = self.zip.get_ref() {
            skeleton.within_a_file.set(is);
        }
    }
}

/// An archive under way, without what is in its files.
#[derive(Debug, Default)]
struct Skeleton {
    /// Each with the place where it begins.
    pieces: Vec<(u64, Part)>,
    length: u64,
    position: u64,
    /// What is written now is a file's.
    within_a_file: Cell<bool>,
}

#[derive(Debug)]
enum Part {
    Bytes(Vec<u8>),
    File,
}

impl Skeleton {
    fn into_pieces(self) -> Vec<Piece> {
        let mut files = 0..;
        let pieces = self.pieces.into_iter().filter_map(|(_, part)| match part {
            Part::Bytes(bytes) => Some(Piece::Bytes(bytes)),
            Part::File => files.next().map(Piece::File),
        });
        pieces.collect()
    }

    fn append(&mut self, bytes: &[u8]) {
        let within_a_file = self.within_a_file.get();
        match self.pieces.last_mut() {
            Some((_, Part::File)) if within_a_file => {}
            Some((_, Part::Bytes(last))) if !within_a_file => last.extend(bytes),
            _ if within_a_file => self.pieces.push((self.length, Part::File)),
            _ => self.pieces.push((self.length, Part::Bytes(bytes.to_vec()))),
        }
        self.length += bytes.len() as u64;
    }

    /// Writes over what is there: sizes and checksums in headers, once they are known.
    fn write_over(&mut self, bytes: &[u8]) -> io::Result<()> {
        let position = self.position;
        let at = self.pieces.partition_point(|(start, _)| *start <= position);
        let piece = at.checked_sub(1).and_then(|at| self.pieces.get_mut(at));
        let there = piece.and_then(|(start, part)| match part {
            Part::Bytes(there) => {
                let from = (position - *start) as usize;
                there.get_mut(from..from + bytes.len())
            }
            Part::File => None,
        });
        let there = there.ok_or_else(|| io::Error::other("a file cannot be written over"))?;
        there.copy_from_slice(bytes);
        Ok(())
    }
}

impl Write for Skeleton {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.position == self.length {
            self.append(bytes);
        } else {
            self.write_over(bytes)?;
        }
        self.position += bytes.len() as u64;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Seek for Skeleton {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let position = match to {
            SeekFrom::Start(position) => Some(position),
            SeekFrom::Current(by) => self.position.checked_add_signed(by),
            SeekFrom::End(by) => self.length.checked_add_signed(by),
        };
        let position = position.filter(|position| *position <= self.length);
        self.position = position.ok_or(io::ErrorKind::InvalidInput)?;
        Ok(self.position)
    }
}
