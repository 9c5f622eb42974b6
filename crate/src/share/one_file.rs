//! The one-file page: the viewer with a document in it.

use std::io::Read;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::read::ZlibEncoder;

use super::document::{Document, DocumentError};

/// What one-file pages are made of: two files, which hosts compress better than one with the other in it.
pub struct Viewer<'a> {
    /// `viewer.html`: the page, with its styles and scripts.
    pub page: &'a str,
    /// `viewer.wasm`: what measures in it.
    pub module: &'a [u8],
}

/// Where the viewer's title stands.
const TITLE: &str = "<title>Snellius</title>";
/// Where the module goes.
const MODULE: &str = "<!-- snellius:module -->";
/// How hard it is compressed: what is beyond takes twice the time for one part in a hundred.
const LEVEL: u32 = 9;
/// Where the document goes.
const PLACE: &str = "<!-- snellius:data -->";
/// What stands before and behind the document. Readers of every version look for this.
const BEGIN: &str = r#"<script type="application/json" id="snellius-data">"#;
const END: &str = "</script>";

/// A self-contained page that shows a document: the viewer with the document put in. The same document and viewer
/// give the same bytes everywhere.
pub fn one_file(viewer: &Viewer, document: &Document) -> Result<String, DocumentError> {
    let once = |place: &'static str| match viewer.page.matches(place).count() {
        1 => Ok(()),
        found => Err(DocumentError::NoViewer(place, found)),
    };
    once(TITLE)?;
    once(PLACE)?;
    once(MODULE)?;
    // No text of the document may end the block, nor begin a comment in it.
    let data = document.to_json().replace('<', "\\u003c");
    let block = format!("{BEGIN}{data}{END}");
    let title = format!("<title>{}</title>", escaped(&document.title));
    let page = viewer.page.replacen(TITLE, &title, 1);
    let page = page.replacen(MODULE, &as_text(viewer.module), 1);
    // The document last: what is written in it is no place to put things.
    Ok(page.replacen(PLACE, &block, 1))
}

/// The document in a one-file page.
pub fn document_in(page: &str) -> Result<Document, DocumentError> {
    let (_, data) = page.split_once(BEGIN).ok_or(DocumentError::NotOurs)?;
    let (data, _) = data.split_once(END).ok_or(DocumentError::Cut)?;
    Document::from_json(data.as_bytes())
}

/// A module as a page holds it: the base64 of the deflated bytes.
fn as_text(module: &[u8]) -> String {
    let mut deflated = Vec::new();
    ZlibEncoder::new(module, Compression::new(LEVEL))
        .read_to_end(&mut deflated)
        .expect("bytes in memory can be read");
    let packed = STANDARD.encode(deflated);
    format!(r#"<script type="text/plain" id="snellius-wasm">{packed}</script>"#)
}

fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            other => escaped.push(other),
        }
    }
    escaped
}
