use std::io::{self, BufRead, Cursor, Seek};

use image::{DynamicImage, ImageDecoder, ImageReader};

/// A decoded grey picture, row by row from the top left.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Width, px.
    pub width: usize,
    /// Height, px.
    pub height: usize,
    /// The largest grey value: 255 or 65535.
    pub full_scale: u16,
    /// Grey values.
    pub grey: Vec<u16>,
}

/// The pictures of a view: with the laser on, and off (if it was taken).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PicturePair {
    /// Laser on.
    pub on: Picture,
    /// Laser off.
    pub off: Option<Picture>,
}

/// How much of an archive is believed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// The largest manifest, bytes.
    pub manifest_bytes: u64,
    /// The largest picture as a file, bytes.
    pub picture_bytes: u64,
    /// The largest picture, pixels.
    pub pixels: u64,
}

impl Default for Limits {
    /// Chosen so that a pair of the largest pictures is measured in less than 1 GiB.
    fn default() -> Self {
        Self {
            manifest_bytes: 64 << 20,
            picture_bytes: 256 << 20,
            pixels: 50_000_000,
        }
    }
}

/// Why a picture could not be used.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// The bytes are no picture of a known kind, or a damaged one.
    #[error("not a readable PNG, TIFF, JPEG, WebP or BMP picture ({0})")]
    Unreadable(#[from] image::ImageError),
    /// The size differs from the camera's.
    #[error(
        "the picture is {width} x {height} pixels, but the camera in scan.json has {camera_width} x {camera_height}"
    )]
    OtherSize {
        /// Picture width.
        width: u32,
        /// Picture height.
        height: u32,
        /// The camera's width.
        camera_width: u32,
        /// The camera's height.
        camera_height: u32,
    },
}

impl Picture {
    /// Decodes a PNG, TIFF, JPEG, WebP or BMP file of 8 or 16 bits, grey or colour, that must be of the
    /// camera's size. The size is checked before anything is allocated for the pixels.
    ///
    /// Colours are averaged with equal weights: a laser has one colour, and weights made for the eye
    /// would all but lose a red one.
    pub fn decode(bytes: &[u8], width: u32, height: u32) -> Result<Self, PictureError> {
        let mut file = Cursor::new(bytes);
        let reader = reader(&mut file).map_err(image::ImageError::from)?;
        let mut decoder = reader.into_decoder()?;
        let size = decoder.dimensions();
        if size != (width, height) {
            return Err(PictureError::OtherSize {
                width: size.0,
                height: size.1,
                camera_width: width,
                camera_height: height,
            });
        }
        let mut limits = image::Limits::default();
        limits.max_image_width = Some(width);
        limits.max_image_height = Some(height);
        limits.max_alloc = Some(512 << 20);
        decoder.set_limits(limits)?;
        Ok(Self::from_image(DynamicImage::from_decoder(decoder)?))
    }

    fn from_image(image: DynamicImage) -> Self {
        let (width, height) = (image.width() as usize, image.height() as usize);
        let (full_scale, grey) = match image {
            DynamicImage::ImageLuma8(p) => (255, p.iter().map(|g| u16::from(*g)).collect()),
            DynamicImage::ImageLuma16(p) => (u16::MAX, p.into_raw()),
            DynamicImage::ImageLumaA8(p) => (255, p.pixels().map(|p| u16::from(p[0])).collect()),
            DynamicImage::ImageLumaA16(p) => (u16::MAX, p.pixels().map(|p| p[0]).collect()),
            DynamicImage::ImageRgb8(p) => (255, p.pixels().map(|p| mean(p.0)).collect()),
            DynamicImage::ImageRgba8(p) => {
                (255, p.pixels().map(|p| mean([p[0], p[1], p[2]])).collect())
            }
            DynamicImage::ImageRgba16(p) => (
                u16::MAX,
                p.pixels().map(|p| mean([p[0], p[1], p[2]])).collect(),
            ),
            deep => (
                u16::MAX,
                deep.into_rgb16().pixels().map(|p| mean(p.0)).collect(),
            ),
        };
        Self {
            width,
            height,
            full_scale,
            grey,
        }
    }
}

/// Where a picture is read from.
pub(crate) trait PictureFile: BufRead + Seek {}

impl<T: BufRead + Seek> PictureFile for T {}

/// A reader of any kind of picture. It takes no type of file in particular: for each type the decoders of all formats
/// would be compiled anew.
pub(crate) fn reader(file: &mut dyn PictureFile) -> io::Result<ImageReader<&mut dyn PictureFile>> {
    ImageReader::new(file).with_guessed_format()
}

/// The mean of three colours, rounded.
fn mean<T: Into<u32>>(rgb: [T; 3]) -> u16 {
    let sum: u32 = rgb.into_iter().map(Into::into).sum();
    ((sum + 1) / 3) as u16
}
