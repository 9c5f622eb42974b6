//! The one-file page: the viewer with a document in it.

use super::document::{Document, DocumentError};

/// Where the viewer's title stands.
const TITLE: &str = "<title>Snellius</title>";
/// Where the document goes.
const PLACE: &str = "<!-- snellius:data -->";
/// What stands before and behind the document. Readers of every version look for this.
const BEGIN: &str = r#"<script type="application/json" id="snellius-data">"#;
const END: &str = "</script>";

/// A self-contained page that shows a document: `viewer.html` with the document put in. The same document
/// and viewer give the same bytes everywhere.
pub fn one_file(viewer: &str, document: &Document) -> Result<String, DocumentError> {
    let once = |place: &'static str| match viewer.matches(place).count() {
        1 => Ok(()),
        found => Err(DocumentError::NoViewer(place, found)),
    };
    once(TITLE)?;
    once(PLACE)?;
    // No text of the document may end the block, nor begin a comment in it.
    let data = document.to_json().replace('<', "\\u003c");
    let block = format!("{BEGIN}{data}{END}");
    let title = format!("<title>{}</title>", escaped(&document.title));
    // The document last: what is written in it is no place to put things.
    Ok(viewer.replacen(TITLE, &title, 1).replacen(PLACE, &block, 1))
}

/// The document in a one-file page.
pub fn document_in(page: &str) -> Result<Document, DocumentError> {
    let (_, data) = page.split_once(BEGIN).ok_or(DocumentError::NotOurs)?;
    let (data, _) = data.split_once(END).ok_or(DocumentError::Cut)?;
    Document::from_json(data.as_bytes())
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
