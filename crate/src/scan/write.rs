use std::io::{self, Cursor, Seek, Write};

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::codecs::tiff::TiffEncoder;
use image::{ExtendedColorType, ImageEncoder, ImageError};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::{MANIFEST_NAME, Manifest, Picture, PicturePair, ViewEntry};

/// Writes a scan archive: pictures view by view, the manifest last.
pub struct ArchiveWriter<W: Write + Seek> {
    zip: ZipWriter<W>,
}

/// Why an archive could not be written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The ZIP could not be written.
    #[error(transparent)]
    Zip(#[from] zip::result::ZipError),
    /// The bytes could not be written.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// A picture could not be encoded.
    #[error(transparent)]
    Picture(#[from] ImageError),
    /// The manifest could not be written.
    #[error(transparent)]
    Manifest(#[from] serde_json::Error),
}

impl<W: Write + Seek> ArchiveWriter<W> {
    /// Starts an archive.
    pub fn new(writer: W) -> Self {
        Self {
            zip: ZipWriter::new(writer),
        }
    }

    /// Adds the pictures of a view as PNG, under the names that its entry gives them.
    pub fn add_pictures(&mut self, view: &ViewEntry, pair: &PicturePair) -> Result<(), WriteError> {
        self.add(view, pair, Picture::to_png).map(drop)
    }

    /// Likewise, as TIFF without compression; says how many bytes they are.
    pub fn add_pictures_uncompressed(
        &mut self,
        view: &ViewEntry,
        pair: &PicturePair,
    ) -> Result<u64, WriteError> {
        self.add(view, pair, Picture::to_tiff)
    }

    /// Adds the manifest and closes the archive.
    pub fn finish(mut self, manifest: &Manifest) -> Result<W, WriteError> {
        let deflated = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
        self.zip.start_file(MANIFEST_NAME, deflated)?;
        serde_json::to_writer_pretty(&mut self.zip, manifest)?;
        Ok(self.zip.finish()?)
    }

    fn add(
        &mut self,
        view: &ViewEntry,
        pair: &PicturePair,
        encode: impl Fn(&Picture) -> Result<Vec<u8>, ImageError>,
    ) -> Result<u64, WriteError> {
        let on = self.add_file(&view.on, &encode(&pair.on)?)?;
        let off = match (&view.off, &pair.off) {
            (Some(name), Some(picture)) => self.add_file(name, &encode(picture)?)?,
            _ => 0,
        };
        Ok(on + off)
    }

    fn add_file(&mut self, name: &str, bytes: &[u8]) -> Result<u64, WriteError> {
        // A PNG is compressed already, and what is not shall not be.
        let stored = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
        self.zip.start_file(name, stored)?;
        self.zip.write_all(bytes)?;
        Ok(bytes.len() as u64)
    }
}

impl Picture {
    /// The picture as a PNG file of 8 or 16 bits, grey.
    pub fn to_png(&self) -> Result<Vec<u8>, ImageError> {
        let mut file = Cursor::new(Vec::new());
        let encoder =
            PngEncoder::new_with_quality(&mut file, CompressionType::Best, FilterType::Adaptive);
        self.encode(encoder)?;
        Ok(file.into_inner())
    }

    /// The picture as a TIFF file of 8 or 16 bits, grey, without compression.
    pub fn to_tiff(&self) -> Result<Vec<u8>, ImageError> {
        let mut file = Cursor::new(Vec::new());
        self.encode(TiffEncoder::new(&mut file))?;
        Ok(file.into_inner())
    }

    fn encode(&self, encoder: impl ImageEncoder) -> Result<(), ImageError> {
        let (width, height) = (self.width as u32, self.height as u32);
        if self.full_scale == 255 {
            let bytes: Vec<u8> = self.grey.iter().map(|g| *g as u8).collect();
            encoder.write_image(&bytes, width, height, ExtendedColorType::L8)
        } else {
            // Encoders take the machine's byte order and write the file's.
            let bytes: Vec<u8> = self.grey.iter().flat_map(|g| g.to_ne_bytes()).collect();
            encoder.write_image(&bytes, width, height, ExtendedColorType::L16)
        }
    }
}
