//! From the pictures of a view to something a screen can show.

use js_sys::{Int32Array, Uint8ClampedArray, Uint16Array};
use snellius::scan::{Picture, PicturePair};
use snellius::spots::Difference;
use wasm_bindgen::JsValue;

use super::messages::{PictureSet, Thumbnail};

/// Makes the pictures visible: on and off as they are, the difference with a sign.
pub(super) fn develop(pictures: &PicturePair) -> PictureSet {
    let difference = Difference::of(pictures);
    let difference: Vec<i32> = (0..difference.len()).map(|i| difference.at(i)).collect();
    let limit = difference.iter().map(|d| d.unsigned_abs()).max();
    let limit = f64::from(limit.unwrap_or(0).max(1));
    let white = white_level(pictures);
    PictureSet {
        width: pictures.on.width as u32,
        height: pictures.on.height as u32,
        on: grey(&pictures.on, white),
        off: pictures
            .off
            .as_ref()
            .map_or(JsValue::NULL, |off| grey(off, white).into()),
        difference: signed(&difference, limit),
        on_grey: Uint16Array::from(pictures.on.grey.as_slice()),
        off_grey: pictures.off.as_ref().map_or(JsValue::NULL, |off| {
            Uint16Array::from(off.grey.as_slice()).into()
        }),
        difference_grey: Int32Array::from(difference.as_slice()),
        difference_limit: limit,
    }
}

/// A picture, small, lifted to its brightest.
pub(super) fn thumbnail(picture: &Picture) -> Thumbnail {
    let small = Small::of(picture);
    small.lifted(small.brightest())
}

/// The pictures of a pair, small. Both are lifted by as much: what the laser adds is to be seen.
pub(super) fn thumbnails(on: &Picture, off: Option<&Picture>) -> (Thumbnail, Option<Thumbnail>) {
    let (on, off) = (Small::of(on), off.map(Small::of));
    let brightest = on.brightest();
    (on.lifted(brightest), off.map(|off| off.lifted(brightest)))
}

/// A picture of which each pixel is the mean of those it stands for.
struct Small {
    width: usize,
    height: usize,
    means: Vec<f64>,
}

impl Small {
    fn of(picture: &Picture) -> Self {
        const WIDTH: usize = 96;
        let size = picture.width.div_ceil(WIDTH).max(1);
        let (width, height) = (picture.width.div_ceil(size), picture.height.div_ceil(size));
        let mean = |column: usize, row: usize| {
            let right = ((column + 1) * size).min(picture.width);
            let bottom = ((row + 1) * size).min(picture.height);
            let rows = row * size..bottom;
            let sum: u32 = rows
                .flat_map(|v| {
                    &picture.grey[v * picture.width + column * size..v * picture.width + right]
                })
                .map(|grey| u32::from(*grey))
                .sum();
            f64::from(sum) / ((right - column * size) * (bottom - row * size)) as f64
        };
        let places = (0..height).flat_map(|row| (0..width).map(move |column| (column, row)));
        Self {
            width,
            height,
            means: places.map(|(column, row)| mean(column, row)).collect(),
        }
    }

    fn brightest(&self) -> f64 {
        self.means
            .iter()
            .fold(1.0, |most, mean| f64::max(most, *mean))
    }

    /// As it is shown: white is the brightest.
    fn lifted(&self, brightest: f64) -> Thumbnail {
        let shade = |mean: &f64| (mean / brightest).min(1.0).sqrt() * 255.0;
        Thumbnail {
            width: self.width as u32,
            height: self.height as u32,
            pixels: rgba(self.means.iter().map(|mean| [shade(mean) as u8; 3])),
        }
    }
}

/// 8-bit pictures are shown as they are. A 16-bit camera rarely uses all of its range, so there the
/// brightest pixel is white.
fn white_level(pictures: &PicturePair) -> f64 {
    if pictures.on.full_scale <= 255 {
        return 255.0;
    }
    f64::from(pictures.on.grey.iter().max().copied().unwrap_or(1).max(1))
}

fn grey(picture: &Picture, white: f64) -> Uint8ClampedArray {
    let scale = 255.0 / white;
    let shade = |grey: &u16| (f64::from(*grey) * scale) as u8;
    rgba(picture.grey.iter().map(|grey| [shade(grey); 3]))
}

/// Light that the laser adds from black over orange to white, light that is missing in blue. The square
/// root lifts the faint spots: the object's is often a hundredth of the wall's.
fn signed(grey: &[i32], limit: f64) -> Uint8ClampedArray {
    let colour = |difference: &i32| {
        let strength = (f64::from(difference.unsigned_abs()) / limit).sqrt();
        let ramp = |from: f64, to: f64| ((strength - from) / (to - from) * 255.0) as u8;
        if *difference >= 0 {
            [ramp(0.0, 0.55), ramp(0.15, 0.9), ramp(0.55, 1.0)]
        } else {
            [ramp(0.5, 1.0), ramp(0.2, 0.9), ramp(0.0, 0.6)]
        }
    };
    rgba(grey.iter().map(colour))
}

fn rgba(colours: impl ExactSizeIterator<Item = [u8; 3]>) -> Uint8ClampedArray {
    let mut bytes = Vec::with_capacity(colours.len() * 4);
    for [red, green, blue] in colours {
        bytes.extend_from_slice(&[red, green, blue, u8::MAX]);
    }
    Uint8ClampedArray::from(bytes.as_slice())
}
