//! A file that arrives: an archive to be measured, or a reconstruction that was passed on.

use snellius::export::ReconstructionResult;
use snellius::share::{Document, DocumentError, document_in};
use wasm_bindgen_futures::{JsFuture, spawn_local};
use web_sys::Blob;

use super::Guest;
use crate::run::Problem;
use crate::state::Workbench;

/// A file that is larger is read by nobody who does without its pictures.
const MOST_BYTES: f64 = 256e6;

/// Opens a file, whatever it is: what it begins with says what it may be.
pub(crate) fn open_file(workbench: Workbench, file: Blob, name: String) {
    spawn_local(async move {
        match first_letter(&file).await {
            Some(b'<' | b'{') => match document(&file).await {
                Ok(document) => workbench.receive(Guest {
                    document: document.into(),
                    rounding: None,
                }),
                Err(problem) => workbench.fail(problem),
            },
            // Anything else is an archive, or the archive's reader says why it is none.
            _ => workbench.open(file, name),
        }
    });
}

/// The first byte that is no white space, of the first few.
async fn first_letter(file: &Blob) -> Option<u8> {
    const FEW: i32 = 64;
    let few = file.slice_with_i32_and_i32(0, FEW).ok()?;
    let bytes = JsFuture::from(few.array_buffer()).await.ok()?;
    let bytes = js_sys::Uint8Array::new(&bytes).to_vec();
    let text = bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(&bytes);
    text.iter()
        .copied()
        .find(|byte| !byte.is_ascii_whitespace())
}

async fn document(file: &Blob) -> Result<Document, Problem> {
    if file.size() > MOST_BYTES {
        return Err(refused("the file is larger than 256 MB, as no page is"));
    }
    let text = JsFuture::from(file.text()).await;
    let text = text.ok().and_then(|text| text.as_string());
    let text = text.ok_or_else(|| refused("the file cannot be read"))?;
    let read = match text.trim_start_matches(['\u{feff}', ' ', '\n', '\r', '\t']) {
        json if json.starts_with('{') => from_json(json.as_bytes()),
        _ => document_in(&text),
    };
    read.map_err(|error| refused(&error.to_string()))
}

/// A page's data by itself, or a `result.json`.
fn from_json(json: &[u8]) -> Result<Document, DocumentError> {
    match ReconstructionResult::from_json(json) {
        Ok(result) => Ok(Document::new(
            None,
            String::new(),
            Default::default(),
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
