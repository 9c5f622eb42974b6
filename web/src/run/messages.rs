//! What the page and its workers say to each other.
//!
//! Every question carries a number and is answered once under the same number, so an answer that comes
//! late, from a run that was given up, finds nobody waiting. Long lists of an answer come before it, in pieces.

use js_sys::{Array, Int32Array, Uint8Array, Uint8ClampedArray, Uint16Array};
use serde::{Deserialize, Serialize};
use snellius::export::Format;
use snellius::pipeline::Settings;
use wasm_bindgen::JsValue;
use web_sys::Blob;

use super::figure::{FigureForm, FigureOf, Figured};
use super::guest::Guest;
use super::making::{MakeReply, MakeRequest};
use super::passing::{LinkMade, PageWish};
use super::plan::Plan;
use super::problem::Problem;
use super::report::{Facts, Outcome, Piece};
use super::study::Study;

/// The spots of a view as one worker writes them for another (JSON). The page hands them on unread: to take
/// the thousands of a line apart would keep its thread from everything else.
pub(crate) type WrittenSpots = Uint8Array;

/// A question with its number.
#[derive(Serialize, Deserialize)]
pub(crate) struct Question {
    pub(crate) number: u32,
    pub(crate) request: Request,
}

/// An answer, under the question's number.
#[derive(Serialize, Deserialize)]
pub(crate) struct Answer {
    pub(crate) number: u32,
    pub(crate) reply: Reply,
}

/// The number of the answer that a worker gives unasked once it is there.
pub(crate) const READY: u32 = 0;

/// What a worker can be asked.
#[derive(Serialize, Deserialize)]
pub(crate) enum Request {
    /// Open an archive; everything after is about it. Answered by `Opened`.
    Open(#[serde(with = "serde_wasm_bindgen::preserve")] Blob),
    /// Likewise, where another worker has said already what is in it. Answered by `Ready`.
    OpenToo(#[serde(with = "serde_wasm_bindgen::preserve")] Blob),
    /// Find the spots of a view. Answered by `Observed`.
    Observe { view: usize, settings: Settings },
    /// Keep the spots of views, an array of [`WrittenSpots`], after those of so many views that were given
    /// before. Answered by `Kept`.
    Keep(usize, #[serde(with = "serde_wasm_bindgen::preserve")] Array),
    /// Measure vessel and object from the spots kept. Answered by `Measured`.
    Measure(Box<Plan>),
    /// Say what the spots kept tell of the liquid's index. Answered by `Studied`.
    Study(Box<Plan>),
    /// Decode the pictures of a view. Answered by `Pictures`.
    Pictures { view: usize },
    /// Decode a view's picture, small. Answered by `Thumbnail`.
    Thumbnail { view: usize },
    /// Draw a figure of what was measured last, or write it as a table. Answered by `Figured`.
    Figure { of: FigureOf, form: FigureForm },
    /// Write a file from what was measured last. Answered by `Written`.
    Write(Format),
    /// Say what must follow the archive's first bytes so that it holds a note. Answered by `Noted`.
    Note(String),
    /// Open what a link holds; everything after is about it. Answered by `Received`.
    OpenLink(String),
    /// Open a file that was passed on; everything after is about it. Answered by `Received`.
    OpenPassed(#[serde(with = "serde_wasm_bindgen::preserve")] Blob),
    /// Make a link to what was measured last with these settings. Answered by `Linked`.
    Link(Settings),
    /// Write a one-file page of what was measured last with these settings. Answered by `Written`.
    Page(Settings, PageWish),
    /// Make a scan of pictures. Answered by `Make`.
    Make(MakeRequest),
}

/// What a worker answers.
#[derive(Serialize, Deserialize)]
pub(crate) enum Reply {
    /// The worker runs.
    Ready,
    /// A part of the answer that is to come.
    Piece(Piece),
    Opened(Box<Facts>),
    Observed(#[serde(with = "serde_wasm_bindgen::preserve")] WrittenSpots),
    Kept,
    Measured(Box<Outcome>),
    Studied(Box<Study>),
    Pictures(PictureSet),
    Thumbnail(Thumbnail),
    Figured(Figured),
    Written(#[serde(with = "serde_wasm_bindgen::preserve")] Uint8Array),
    /// How many of the archive's first bytes stay, and what follows them.
    Noted(
        f64,
        #[serde(with = "serde_wasm_bindgen::preserve")] Uint8Array,
    ),
    Received(Box<Guest>),
    Linked(LinkMade),
    Make(MakeReply),
    /// The input is at fault; the worker goes on.
    Refused(Problem),
    /// The worker is at fault, and is no more.
    Panicked(String),
}

impl Reply {
    /// Takes long lists away, to be sent before.
    pub(super) fn take_apart(&mut self) -> Vec<Piece> {
        match self {
            Self::Opened(facts) => facts.take_apart(),
            Self::Measured(outcome) => outcome.take_apart(),
            Self::Received(guest) => {
                let mut pieces = guest.facts.take_apart();
                pieces.extend(guest.outcome.take_apart());
                pieces
            }
            _ => Vec::new(),
        }
    }

    /// Puts them back.
    pub(super) fn put_together(&mut self, pieces: Vec<Piece>) {
        match self {
            Self::Opened(facts) => facts.put_together(pieces),
            Self::Measured(outcome) => outcome.put_together(pieces),
            Self::Received(guest) => {
                let is_station = |piece: &Piece| matches!(piece, Piece::Stations(_));
                let (stations, others) = pieces.into_iter().partition(is_station);
                guest.facts.put_together(stations);
                guest.outcome.put_together(others);
            }
            _ => {}
        }
    }

    /// What of the answer changes hands without being copied.
    pub(crate) fn transfer(&self) -> Array {
        match self {
            Self::Pictures(set) => set.buffers(),
            Self::Observed(bytes) | Self::Written(bytes) | Self::Noted(_, bytes) => {
                Array::of1(&bytes.buffer())
            }
            Self::Thumbnail(thumbnail) => Array::of1(&thumbnail.pixels.buffer()),
            _ => Array::new(),
        }
    }
}

/// A view's picture with the laser on, small: RGBA, row by row.
#[derive(Clone, Serialize, Deserialize)]
pub(crate) struct Thumbnail {
    pub(crate) width: u32,
    pub(crate) height: u32,
    #[serde(with = "serde_wasm_bindgen::preserve")]
    pub(crate) pixels: Uint8ClampedArray,
}

/// The grey values of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Grey {
    pub(crate) on: u16,
    /// Missing if no picture was taken with the laser off.
    pub(crate) off: Option<u16>,
    pub(crate) difference: i32,
}

/// The pictures of a view, ready to be shown: RGBA, row by row.
#[derive(Clone, Serialize, Deserialize)]
pub(crate) struct PictureSet {
    pub(crate) width: u32,
    pub(crate) height: u32,
    #[serde(with = "serde_wasm_bindgen::preserve")]
    pub(crate) on: Uint8ClampedArray,
    /// Missing if no picture was taken with the laser off.
    #[serde(with = "serde_wasm_bindgen::preserve")]
    pub(crate) off: JsValue,
    #[serde(with = "serde_wasm_bindgen::preserve")]
    pub(crate) difference: Uint8ClampedArray,
    /// The grey values as the camera gave them.
    #[serde(with = "serde_wasm_bindgen::preserve")]
    pub(crate) on_grey: Uint16Array,
    /// Likewise; missing if no picture was taken with the laser off.
    #[serde(with = "serde_wasm_bindgen::preserve")]
    pub(crate) off_grey: JsValue,
    /// On less off, or less the background where there is no off.
    #[serde(with = "serde_wasm_bindgen::preserve")]
    pub(crate) difference_grey: Int32Array,
    /// The difference at which the colours end, grey values.
    pub(crate) difference_limit: f64,
}

impl PictureSet {
    fn buffers(&self) -> Array {
        let buffers = Array::of4(
            &self.on.buffer(),
            &self.difference.buffer(),
            &self.on_grey.buffer(),
            &self.difference_grey.buffer(),
        );
        if let (Some(off), Some(grey)) = (self.off(), self.off_grey()) {
            buffers.push(&off.buffer());
            buffers.push(&grey.buffer());
        }
        buffers
    }

    /// The grey values of a pixel of the picture.
    pub(crate) fn grey_at(&self, [u, v]: [usize; 2]) -> Option<Grey> {
        let (width, height) = (self.width as usize, self.height as usize);
        if u >= width || v >= height {
            return None;
        }
        let index = (v * width + u) as u32;
        Some(Grey {
            on: self.on_grey.get_index(index),
            off: self.off_grey().map(|off| off.get_index(index)),
            difference: self.difference_grey.get_index(index),
        })
    }

    fn off_grey(&self) -> Option<Uint16Array> {
        use wasm_bindgen::JsCast;
        self.off_grey.clone().dyn_into().ok()
    }

    /// The picture with the laser off, if there is one.
    pub(crate) fn off(&self) -> Option<Uint8ClampedArray> {
        use wasm_bindgen::JsCast;
        self.off.clone().dyn_into().ok()
    }
}
