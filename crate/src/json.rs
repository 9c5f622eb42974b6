//! JSON files, and the place of what is wrong in one.

use std::borrow::Cow;

use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

/// Why a file could not be read.
#[derive(Debug)]
pub(crate) struct Misread {
    /// The key, as `views[3].on`; the name of the whole where it is no key's.
    pub(crate) place: String,
    /// What is wrong there.
    pub(crate) problem: serde_json::Error,
}

/// Reads a file, of which errors speak by the name `whole`.
///
/// The place follows from the position at which serde_json gave up. A deserializer that keeps the path while it reads
/// (as of `serde_path_to_error`) would tell it as well, but is compiled anew for every type in the file: a tenth of
/// the page's programs.
pub(crate) fn read<T: DeserializeOwned>(json: &[u8], whole: &str) -> Result<T, Misread> {
    let mut reader = serde_json::Deserializer::from_slice(json);
    let read = T::deserialize(&mut reader).map_err(|problem| {
        let path = path_at(consumed(json, &problem));
        let place = if path.is_empty() {
            whole.to_owned()
        } else {
            path
        };
        Misread { place, problem }
    })?;
    reader.end().map_err(|problem| Misread {
        place: format!("after {whole}"),
        problem,
    })?;
    Ok(read)
}

/// serde_json ends its messages with the position, which the caller states by itself.
pub(crate) fn without_position(problem: &serde_json::Error) -> String {
    let text = problem.to_string();
    match text.rfind(" at line ") {
        Some(end) => text[..end].to_owned(),
        None => text,
    }
}

/// The tree of a value, through its text: serde_json's serializer of trees would be compiled for every type beside
/// that of texts.
pub(crate) fn tree_of(value: &impl Serialize) -> Value {
    serde_json::to_vec(value)
        .and_then(|text| serde_json::from_slice(&text))
        .expect("strings and numbers alone, with string keys, always serialise")
}

/// The value that a tree says, likewise.
pub(crate) fn of_tree<T: DeserializeOwned>(
    tree: &Map<String, Value>,
) -> Result<T, serde_json::Error> {
    serde_json::from_slice(&serde_json::to_vec(tree)?)
}

/// An object of its entries. To `collect` them would sort them first, by a program for each way that they are made.
pub(crate) fn object(entries: impl Iterator<Item = (String, Value)>) -> Map<String, Value> {
    let mut object = Map::new();
    object.extend(entries);
    object
}

/// What had been read when the error arose.
fn consumed<'a>(json: &'a [u8], error: &serde_json::Error) -> &'a [u8] {
    let lines = json.split_inclusive(|byte| *byte == b'\n');
    let before: usize = lines
        .take(error.line().saturating_sub(1))
        .map(<[u8]>::len)
        .sum();
    &json[..json.len().min(before + error.column())]
}

/// An object or a list that is not closed yet.
enum Open<'a> {
    /// The key read last.
    Object(Option<Cow<'a, str>>),
    /// The number of the item.
    List(usize),
}

/// The path to the end of a piece of JSON.
fn path_at(json: &[u8]) -> String {
    let mut open = Vec::new();
    let mut wants_key = false;
    let mut rest = json;
    while let [byte, behind @ ..] = rest {
        rest = behind;
        match byte {
            b'{' => open.push(Open::Object(None)),
            b'[' => open.push(Open::List(0)),
            b'}' | b']' => {
                open.pop();
            }
            b'"' => {
                let (text, behind) = string(rest);
                rest = behind;
                if let (true, Some(Open::Object(key))) = (wants_key, open.last_mut()) {
                    *key = Some(String::from_utf8_lossy(text));
                }
            }
            b',' => {
                if let Some(Open::List(number)) = open.last_mut() {
                    *number += 1;
                }
            }
            _ => {}
        }
        match byte {
            b'{' | b',' => wants_key = true,
            b'"' | b'[' => wants_key = false,
            _ => {}
        }
    }
    let mut path = String::new();
    for part in open {
        match part {
            Open::Object(Some(key)) if path.is_empty() => path.push_str(&key),
            Open::Object(Some(key)) => path.push_str(&format!(".{key}")),
            Open::Object(None) => {}
            Open::List(number) => path.push_str(&format!("[{number}]")),
        }
    }
    path
}

/// A string up to its closing quote, and what follows.
fn string(json: &[u8]) -> (&[u8], &[u8]) {
    let mut at = 0;
    loop {
        match json.get(at) {
            Some(b'\\') => at += 2,
            Some(b'"') => return (&json[..at], &json[at + 1..]),
            Some(_) => at += 1,
            None => return (json, &[]),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use serde::Deserialize;

    use super::*;

    #[derive(Debug, Deserialize)]
    #[allow(dead_code, reason = "only whether they can be read matters")]
    struct File {
        views: Vec<View>,
        named: BTreeMap<String, [f64; 2]>,
    }

    #[derive(Debug, Deserialize)]
    #[allow(dead_code, reason = "only whether they can be read matters")]
    struct View {
        on: String,
        at: Option<f64>,
        #[serde(flatten)]
        others: BTreeMap<String, serde_json::Value>,
    }

    fn place(json: &str) -> String {
        read::<File>(json.as_bytes(), "the file").unwrap_err().place
    }

    #[test]
    fn a_value_that_cannot_be_is_named_by_its_path() {
        for (json, expected) in [
            (r#"{"views": [{"on": "a"}, {"on": 3}]}"#, "views[1].on"),
            (r#"{"views": [{"on": "a"}, {"on": {}}]}"#, "views[1].on"),
            (r#"{"views": [{"on": "a", "at": "b"}]}"#, "views[0].at"),
            ("{\n\"views\": [\n{\"on\": \"a\"},\n[]\n, 3]}", "views[1]"),
            (r#"{"views": 3}"#, "views"),
            (r#"{"views": [], "named": {"b": [1, "}"]}}"#, "named.b[1]"),
            (r#"{"views": [], "named": {"a\"{": [1]}}"#, r#"named.a\"{"#),
            (r#"{"views": [{"on": "],[{", "at": []}]}"#, "views[0].at"),
            ("3", "the file"),
        ] {
            assert_eq!(place(json), expected, "{json}");
        }
    }

    #[test]
    fn what_is_missing_is_named_by_where_it_should_be() {
        assert_eq!(place(r#"{"views": [{"on": "a"}, {"at": 1}]}"#), "views[1]");
        assert_eq!(place(r#"{"views": []}"#), "the file");
    }

    #[test]
    fn a_text_that_ends_early_or_late_is_told() {
        assert_eq!(place(r#"{"views": [{"on": "a"#), "views[0].on");
        assert_eq!(place(r#"{"views": [], "named": {}} {}"#), "after the file");
        assert_eq!(place(""), "the file");
    }
}
