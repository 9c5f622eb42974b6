//! Passing a reconstruction on without any server: in a link, or in a page of one file.
//!
//! A link holds settings and result as the fragment of a page's address, which no server ever sees:
//!
//! ```text
//! #r1=<base64url of the deflated payload>
//! payload: length of the head (varint) | head (JSON) | columns of whole numbers (varints)
//! ```
//!
//! The head holds what there is once: name, media, wall, warnings, settings that differ from the defaults,
//! and the columns' steps. The columns hold what every view or point has, in whole steps, each as the
//! difference from what the points before it let one expect (`columns.rs`). Spots and the reasons for
//! refusing them stay behind.
//!
//! `r1` is version 1. A link that was made once opens for ever: what decodes it stays, and
//! `tests/data/link-v1.txt` is opened by a test.
//!
//! A one-file page ([`one_file`]) is the viewer, which is built once, with a [`Document`] put in; what the
//! viewer needs of the optics is in [`Sightlines`].

mod columns;
mod document;
mod head;
mod one_file;
mod sightlines;
mod views;

pub use document::{Document, DocumentError, DocumentFormat};
pub use one_file::{Viewer, document_in, one_file};
pub use sightlines::Sightlines;

use std::io::Read;

use base64::Engine;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;
use flate2::read::DeflateEncoder;
use flate2::{Compression, Decompress, FlushDecompress, Status};

use crate::export::ReconstructionResult;
use crate::pipeline::Settings;
use columns::{ColumnError, Columns};
use head::Head;

/// Every program and mail client takes an address of 2,041 characters; of these 101 are left for the page's
/// own address.
pub const SHORT: usize = 1_940;
/// Browsers take no more than this.
pub const LONGEST: usize = 32_000;
/// No link that this program makes inflates to more.
const MOST_INFLATED: usize = 1 << 20;
const PREFIX: &str = "r1=";

/// What a link carries.
#[derive(Clone, Debug, PartialEq)]
pub struct Shared {
    /// How it was measured.
    pub settings: Settings,
    /// What was measured, if it is in the link: rounded, without spots and reasons.
    pub result: Option<ReconstructionResult>,
    /// How far rounding may have moved it.
    pub rounding: Option<Rounding>,
}

/// How far the numbers of a link may be off those it was made of, at most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rounding {
    /// An object point along each axis, mm; less than the standard deviation of every point.
    pub object: [f64; 3],
    /// A ray distance, mm.
    pub ray_distance: f64,
    /// A vessel point, or an object point without refraction, along each axis, mm: for looking at only.
    pub shown: f64,
    /// A standard deviation, as a factor.
    pub sigma_factor: f64,
}

/// A link's fragment, without the `#`.
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    /// `r1=...`
    pub fragment: String,
    /// How far off the numbers in it may be, if it holds a result.
    pub rounding: Option<Rounding>,
}

impl Link {
    /// Why the link may not arrive everywhere.
    pub fn warning(&self) -> Option<String> {
        let length = self.fragment.len();
        (length > SHORT).then(|| {
            format!(
                "the link has {length} characters; browsers open it, but some programs cut links off \
                 after about 2,000"
            )
        })
    }
}

/// Why there is no link, or why a link does not open.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LinkError {
    /// It does not fit into a link.
    #[error("too much for a link (at most 32,000 characters): use a file")]
    TooLong,
    /// It is no link of this program.
    #[error("this link holds no reconstruction")]
    NotOurs,
    /// A later program made it.
    #[error("this link is of version {0}, and this program knows version 1; load the newest page")]
    Version(String),
    /// Characters are missing, or others than those it was made of.
    #[error("the link is damaged or was cut off: {0}")]
    Damaged(String),
}

impl From<ColumnError> for LinkError {
    fn from(error: ColumnError) -> Self {
        Self::Damaged(error.to_string())
    }
}

/// Makes a link of settings alone, or of settings and a result. Of the roundings that are below every
/// point's standard deviation the finest is taken with which the link is short; if none is, the coarsest.
pub fn encode(
    settings: &Settings,
    result: Option<&ReconstructionResult>,
) -> Result<Link, LinkError> {
    let Some(result) = result else {
        let fragment = fragment(&Head::of_settings(settings), &Columns::default())?;
        return Ok(Link {
            fragment,
            rounding: None,
        });
    };
    /// Rounding errors in parts of the smallest standard deviation.
    const PARTS: [f64; 4] = [0.125, 0.25, 0.5, 0.9];
    let mut link = Err(LinkError::TooLong);
    for part in PARTS {
        let head = Head::new(settings, result, part);
        let mut columns = Columns::default();
        views::write(result, &head.steps(), &mut columns);
        link = fragment(&head, &columns).map(|fragment| Link {
            fragment,
            rounding: head.rounding(),
        });
        if link.as_ref().is_ok_and(|link| link.fragment.len() <= SHORT) {
            break;
        }
    }
    link
}

fn fragment(head: &Head, columns: &Columns) -> Result<String, LinkError> {
    let payload = columns.behind(&head.to_json());
    let fragment = format!("{PREFIX}{}", URL_SAFE_NO_PAD.encode(deflated(&payload)));
    if payload.len() > MOST_INFLATED || fragment.len() > LONGEST {
        return Err(LinkError::TooLong);
    }
    Ok(fragment)
}

fn deflated(payload: &[u8]) -> Vec<u8> {
    let mut deflated = Vec::new();
    DeflateEncoder::new(payload, Compression::best())
        .read_to_end(&mut deflated)
        .expect("bytes in memory can be read");
    deflated
}

fn inflated(deflated: &[u8]) -> Result<Vec<u8>, LinkError> {
    let mut payload = Vec::with_capacity(MOST_INFLATED);
    let told =
        Decompress::new(false).decompress_vec(deflated, &mut payload, FlushDecompress::Finish);
    match told {
        Ok(Status::StreamEnd) => Ok(payload),
        Ok(_) if payload.len() == payload.capacity() => Err(LinkError::Damaged(
            "it holds more than any link does".to_owned(),
        )),
        _ => Err(LinkError::Damaged("it does not inflate".to_owned())),
    }
}

/// Opens a link's fragment, with or without its `#`. Whatever the fragment is, memory stays below a few
/// megabytes, and nothing but numbers and texts comes out.
pub fn decode(fragment: &str) -> Result<Shared, LinkError> {
    let fragment = fragment.strip_prefix('#').unwrap_or(fragment);
    if fragment.len() > LONGEST {
        return Err(LinkError::TooLong);
    }
    let text = fragment
        .strip_prefix(PREFIX)
        .ok_or_else(|| other(fragment))?;
    let deflated = URL_SAFE_NO_PAD
        .decode(text)
        .map_err(|error| LinkError::Damaged(error.to_string()))?;
    let payload = inflated(&deflated)?;
    let (head, mut columns) = columns::split(&payload)?;
    let head = Head::from_json(head)?;
    let settings = head.settings()?;
    let mut result = head.result()?;
    if let Some(result) = &mut result {
        result.views = views::read(&head, &mut columns)?;
    }
    columns.end()?;
    Ok(Shared {
        settings,
        rounding: result.as_ref().and_then(|_| head.rounding()),
        result,
    })
}

/// Whether a fragment is a link of this program, of whatever version; it may still be damaged.
pub fn is_link(fragment: &str) -> bool {
    version(fragment).is_some()
}

fn version(fragment: &str) -> Option<&str> {
    let (version, _) = fragment.strip_prefix('r')?.split_once('=')?;
    let is_number = version.bytes().all(|b| b.is_ascii_digit());
    ((1..=6).contains(&version.len()) && is_number).then_some(version)
}

/// What a fragment is that is not of this version.
fn other(fragment: &str) -> LinkError {
    match version(fragment) {
        Some(version) => LinkError::Version(version.to_owned()),
        None => LinkError::NotOurs,
    }
}
