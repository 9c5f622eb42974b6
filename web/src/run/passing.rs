//! The worker's side of passing on: what was passed on becomes a document, and what was measured a link or a
//! page.

use js_sys::Uint8Array;
use serde::{Deserialize, Serialize};
use snellius::export::ReconstructionResult;
use snellius::pipeline::Settings;
use snellius::share::{
    Document, DocumentError, LinkError, Rounding, Viewer, decode, document_in, encode, one_file,
};
use web_sys::{Blob, FileReaderSync};

use super::problem::Problem;

/// A link, or why there is none.
#[derive(Serialize, Deserialize)]
pub(crate) struct LinkMade {
    /// Behind the page's address; nothing if the reconstruction is too much for a link.
    pub(crate) fragment: Option<String>,
    /// How far off a point in it may be along an axis, mm.
    pub(crate) rounding: f64,
    /// Why it may not arrive everywhere.
    pub(crate) warning: Option<String>,
}

/// What a one-file page is to be made of, beside the reconstruction.
#[derive(Serialize, Deserialize)]
pub(crate) struct PageWish {
    /// The viewer's page.
    pub(crate) viewer: String,
    /// The viewer's module.
    #[serde(with = "serde_wasm_bindgen::preserve")]
    pub(crate) module: Uint8Array,
    pub(crate) title: String,
    pub(crate) notes: String,
}

/// The document in a link, and by how much its points may be off along an axis, mm.
pub(super) fn from_link(fragment: &str) -> Result<(Document, f64), Problem> {
    let shared = decode(fragment).map_err(|error| {
        Problem::input(
            format!("{}.", capitalised(&error.to_string())),
            "Copy the whole link and open it again, or ask whoever sent it for a file.",
        )
    })?;
    let (Some(result), Some(rounding)) = (shared.result, shared.rounding) else {
        return Err(Problem::input(
            "This link holds settings, but no reconstruction.",
            "Ask whoever sent it for a link made from a measured scan.",
        ));
    };
    let document = Document::new(None, String::new(), shared.settings, None, result);
    Ok((document, largest(rounding)))
}

/// The document in a file: a one-file page, its data alone, or a `result.json`.
pub(super) fn from_file(file: &Blob) -> Result<Document, Problem> {
    /// A larger file is none that any program of ours has made.
    const MOST_BYTES: f64 = 256e6;
    if file.size() > MOST_BYTES {
        return Err(refused("it is larger than 256 MB, as no page is"));
    }
    let text = FileReaderSync::new().and_then(|reader| reader.read_as_text(file));
    let text = text.map_err(|_| refused("it cannot be read"))?;
    let text = text.trim_start_matches(['\u{feff}', ' ', '\n', '\r', '\t']);
    let read = match text.starts_with('{') {
        true => from_json(text.as_bytes()),
        false => document_in(text),
    };
    read.map_err(|error| refused(&error.to_string()))
}

fn from_json(json: &[u8]) -> Result<Document, DocumentError> {
    match ReconstructionResult::from_json(json) {
        Ok(result) => Ok(Document::new(
            None,
            String::new(),
            Settings::default(),
            None,
            result,
        )),
        Err(_) => Document::from_json(json),
    }
}

fn refused(why: &str) -> Problem {
    Problem::input(
        format!("This file holds no reconstruction that can be opened: {why}."),
        "Choose a scan archive (.zip) or a page that Snellius made, or ask for another copy of it.",
    )
}

/// A link to a result.
pub(super) fn link(
    settings: &Settings,
    result: &ReconstructionResult,
) -> Result<LinkMade, Problem> {
    match encode(settings, Some(result)) {
        Ok(link) => Ok(LinkMade {
            warning: link.warning(),
            rounding: link.rounding.map_or(0.0, largest),
            fragment: Some(link.fragment),
        }),
        Err(LinkError::TooLong) => Ok(LinkMade {
            fragment: None,
            rounding: 0.0,
            warning: None,
        }),
        Err(error) => Err(Problem::own(error.to_string())),
    }
}

/// A one-file page.
pub(super) fn page(wish: PageWish, document: Document) -> Result<String, Problem> {
    let Document {
        settings,
        scan,
        result,
        ..
    } = document;
    let title = Some(wish.title).filter(|title| !title.trim().is_empty());
    let document = Document::new(title, wish.notes, settings, scan, result);
    let viewer = Viewer {
        page: &wish.viewer,
        module: &wish.module.to_vec(),
    };
    one_file(&viewer, &document).map_err(|error| Problem::own(error.to_string()))
}

fn largest(rounding: Rounding) -> f64 {
    rounding.object.into_iter().fold(0.0, f64::max)
}

fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().into_iter().flat_map(char::to_uppercase);
    first.chain(letters).collect()
}
