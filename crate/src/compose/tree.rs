//! YAML, XML and JSON as one tree, so that each kind of content is read once.

use std::borrow::Cow;

use roxmltree::{Document, Node};
use saphyr::{LoadableYamlNode, Scalar, Yaml};
use saphyr_parser::{Event, Parser};
use serde_json::{Map, Number, Value};

use super::ImportError;
use crate::json::object;

/// Reads a tree, whichever of the three languages it is written in.
pub(super) fn read(text: &str) -> Result<Value, ImportError> {
    let text = text.trim_start_matches('\u{feff}');
    match text.trim_start().chars().next() {
        Some('<') => xml(text),
        Some('{' | '[') => json(text),
        _ => yaml(text),
    }
}

pub(super) fn json(text: &str) -> Result<Value, ImportError> {
    serde_json::from_slice(text.as_bytes()).map_err(|error| ImportError::Syntax {
        line: error.line(),
        column: error.column(),
        problem: "this is no JSON here".to_owned(),
    })
}

fn yaml(text: &str) -> Result<Value, ImportError> {
    check_indentation(text)?;
    let text = without_directive(text);
    check_aliases(&text)?;
    let mut parser = Parser::new_from_str(&text);
    let documents = Yaml::load_from_parser(&mut parser).map_err(|error| ImportError::Syntax {
        line: error.marker().line(),
        column: error.marker().col() + 1,
        problem: error.info().to_owned(),
    })?;
    Ok(documents.first().map_or(Value::Null, of_yaml))
}

/// How deep a file of a few numbers may be nested. Trees are walked by recursion.
const DEEPEST: usize = 128;

/// The YAML reader limits the nesting of brackets, and not that of indentation.
fn check_indentation(text: &str) -> Result<(), ImportError> {
    let deep = |line: &str| {
        let rest = line.trim_start_matches([' ', '-', '?', ':', '\t']);
        line.len() - rest.len() > 2 * DEEPEST
    };
    match text.lines().position(deep) {
        None => Ok(()),
        Some(index) => Err(ImportError::Syntax {
            line: index + 1,
            column: 2 * DEEPEST,
            problem: "nested too deeply".to_owned(),
        }),
    }
}

/// Each alias is a copy of what it means, so a few lines of them can fill any memory. No calibration needs one.
fn check_aliases(text: &str) -> Result<(), ImportError> {
    let alias = Parser::new_from_str(text)
        .map_while(Result::ok)
        .find(|(event, _)| matches!(event, Event::Alias(_)));
    match alias {
        None => Ok(()),
        Some((_, span)) => Err(ImportError::Syntax {
            line: span.start.line(),
            column: span.start.col() + 1,
            problem: "aliases are not read; write the value itself".to_owned(),
        }),
    }
}

/// OpenCV up to version 4 begins its files with `%YAML:1.0`, which is no directive of YAML (that would be
/// `%YAML 1.0`). The line is emptied, not removed: the others keep their numbers.
fn without_directive(text: &str) -> Cow<'_, str> {
    match text.strip_prefix("%YAML:") {
        Some(rest) => Cow::Owned(format!(
            "#{}",
            rest.find('\n').map_or("", |end| &rest[end..])
        )),
        None => Cow::Borrowed(text),
    }
}

fn of_yaml(node: &Yaml) -> Value {
    match node {
        Yaml::Value(Scalar::Boolean(truth)) => Value::Bool(*truth),
        Yaml::Value(Scalar::Integer(number)) => (*number).into(),
        Yaml::Value(Scalar::FloatingPoint(number)) => of_number(number.into_inner()),
        Yaml::Value(Scalar::String(text)) => Value::String(text.to_string()),
        Yaml::Sequence(items) => Value::Array(items.iter().map(of_yaml).collect()),
        Yaml::Mapping(items) => {
            let entries = items.iter();
            let entries =
                entries.filter_map(|(key, value)| Some((key.as_str()?.to_owned(), of_yaml(value))));
            Value::Object(object(entries))
        }
        Yaml::Tagged(_, node) => of_yaml(node),
        _ => Value::Null,
    }
}

fn xml(text: &str) -> Result<Value, ImportError> {
    let document = Document::parse(text).map_err(|error| ImportError::Syntax {
        line: error.pos().row as usize,
        column: error.pos().col as usize,
        problem: error.to_string(),
    })?;
    Ok(of_xml(document.root_element(), 0))
}

/// An element with elements in it is a mapping; one without holds numbers or a text.
fn of_xml(node: Node, depth: usize) -> Value {
    if depth > DEEPEST {
        return Value::Null;
    }
    let children = node.children().filter(Node::is_element);
    let entries =
        children.map(|child| (child.tag_name().name().to_owned(), of_xml(child, depth + 1)));
    let entries = object(entries);
    if !entries.is_empty() {
        return Value::Object(entries);
    }
    let text = node.text().unwrap_or_default().trim();
    let numbers: Option<Vec<Value>> = text
        .split_whitespace()
        .map(|word| word.parse().ok().map(of_number))
        .collect();
    match numbers {
        Some(mut numbers) if numbers.len() == 1 => numbers.remove(0),
        Some(numbers) if !numbers.is_empty() => Value::Array(numbers),
        _ => Value::String(text.trim_matches('"').to_owned()),
    }
}

/// JSON has no NaN: what is none becomes nothing, which whoever wants a number complains of.
fn of_number(number: f64) -> Value {
    Number::from_f64(number).map_or(Value::Null, Value::Number)
}

/// The entry of a mapping under one of some names, and the name that it has there. Names are compared
/// without case, `_`, `-` and blanks: programs differ in nothing else.
pub(super) fn find<'a>(
    mapping: &'a Map<String, Value>,
    names: &[&str],
) -> Option<(&'a str, &'a Value)> {
    let named = |name: &&str| {
        let entry = mapping.iter().find(|(key, _)| plain(key) == **name);
        entry.map(|(key, value)| (key.as_str(), value))
    };
    names.iter().find_map(named)
}

pub(super) fn plain(key: &str) -> String {
    let letters = key.chars().filter(|c| c.is_alphanumeric());
    letters.flat_map(char::to_lowercase).collect()
}

/// The numbers of a list, of a list of lists (row by row), or of a matrix as OpenCV and ROS write it.
pub(super) fn numbers(value: &Value, place: &str) -> Result<Vec<f64>, ImportError> {
    match value {
        Value::Array(items) => {
            let items = items.iter().enumerate();
            let lists = items.map(|(index, item)| numbers(item, &format!("{place}[{index}]")));
            Ok(lists.collect::<Result<Vec<_>, _>>()?.concat())
        }
        Value::Object(entries) => match entries.get("data") {
            Some(data) => numbers(data, &format!("{place}.data")),
            None => Err(ImportError::value(
                format!("{place}.data"),
                "missing; a matrix has its numbers there",
            )),
        },
        value => number(value, place).map(|number| vec![number]),
    }
}

/// A number.
pub(super) fn number(value: &Value, place: &str) -> Result<f64, ImportError> {
    value
        .as_f64()
        .filter(|number| number.is_finite())
        .ok_or_else(|| ImportError::value(place, format!("{value} is no number")))
}
