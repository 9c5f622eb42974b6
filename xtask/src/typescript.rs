//! TypeScript declarations from JSON Schemas: as much of both as the core's schemas use.

use std::collections::BTreeMap;

use serde_json::{Map, Value};

/// The declarations of schemas and of everything they refer to, one interface or type a name.
pub(crate) fn declarations(schemas: &[Value]) -> String {
    let mut named: BTreeMap<&str, &Value> = BTreeMap::new();
    for schema in schemas {
        if let Some(title) = schema["title"].as_str() {
            named.insert(title, schema);
        }
        for (name, definition) in schema["$defs"].as_object().into_iter().flatten() {
            named.insert(name, definition);
        }
    }
    let mut text = String::from("// Made by `cargo xtask npm` from the core's schemas.\n");
    for (name, schema) in named {
        text.push('\n');
        text.push_str(&comment(schema, ""));
        text.push_str(&declaration(&identifier(name), schema));
    }
    text
}

fn declaration(name: &str, schema: &Value) -> String {
    let is_plain_object = schema["properties"].is_object() && alternatives(schema).is_none();
    if is_plain_object {
        format!("export interface {name} {}\n", object(schema, ""))
    } else {
        format!("export type {name} = {};\n", type_of(schema, ""))
    }
}

/// A type as an expression.
fn type_of(schema: &Value, indent: &str) -> String {
    if let Some(reference) = schema["$ref"].as_str() {
        return identifier(reference.rsplit('/').next().unwrap_or_default());
    }
    if let Some(list) = alternatives(schema) {
        let either = list.iter().map(|s| type_of(s, indent));
        let either = either.collect::<Vec<_>>().join(" | ");
        // Properties beside the alternatives belong to each of them.
        return match schema["properties"].is_object() {
            true => format!("({either}) & {}", object(schema, indent)),
            false => either,
        };
    }
    if !schema["const"].is_null() {
        return schema["const"].to_string();
    }
    if let Some(words) = schema["enum"].as_array() {
        return words
            .iter()
            .map(Value::to_string)
            .collect::<Vec<_>>()
            .join(" | ");
    }
    let kinds = match &schema["type"] {
        Value::Array(kinds) => kinds.iter().filter_map(Value::as_str).collect(),
        Value::String(kind) => vec![kind.as_str()],
        _ => vec![],
    };
    if kinds.is_empty() {
        return "unknown".to_owned();
    }
    let kinds = kinds.into_iter().map(|kind| of_kind(kind, schema, indent));
    kinds.collect::<Vec<_>>().join(" | ")
}

fn of_kind(kind: &str, schema: &Value, indent: &str) -> String {
    match kind {
        "number" | "integer" => "number".to_owned(),
        "array" => array(schema, indent),
        "object" if schema["properties"].is_object() => object(schema, indent),
        "object" => "Record<string, unknown>".to_owned(),
        other => other.to_owned(),
    }
}

fn array(schema: &Value, indent: &str) -> String {
    let item = match schema.get("items") {
        Some(items) => type_of(items, indent),
        None => "unknown".to_owned(),
    };
    let (least, most) = (schema["minItems"].as_u64(), schema["maxItems"].as_u64());
    match (least, most) {
        (Some(least), Some(most)) if least == most => {
            format!("[{}]", vec![item; least as usize].join(", "))
        }
        _ if item.contains(' ') => format!("({item})[]"),
        _ => format!("{item}[]"),
    }
}

fn object(schema: &Value, indent: &str) -> String {
    let inner = format!("{indent}  ");
    let required: Vec<&str> = schema["required"]
        .as_array()
        .into_iter()
        .flatten()
        .filter_map(Value::as_str)
        .collect();
    let empty = Map::new();
    let properties = schema["properties"].as_object().unwrap_or(&empty);
    let lines = properties.iter().map(|(key, property)| {
        let optional = if required.contains(&key.as_str()) {
            ""
        } else {
            "?"
        };
        let comment = comment(property, &inner);
        format!(
            "{comment}{inner}{key}{optional}: {};\n",
            type_of(property, &inner)
        )
    });
    format!("{{\n{}{indent}}}", lines.collect::<String>())
}

fn alternatives(schema: &Value) -> Option<&Vec<Value>> {
    schema["oneOf"]
        .as_array()
        .or_else(|| schema["anyOf"].as_array())
}

fn comment(schema: &Value, indent: &str) -> String {
    let description = schema["description"].as_str().unwrap_or_default();
    // A description that ends the comment would be code.
    let description = description.replace("*/", "* /");
    match description.lines().collect::<Vec<_>>().as_slice() {
        [] => String::new(),
        [line] => format!("{indent}/** {line} */\n"),
        lines => {
            let lines: String = lines
                .iter()
                .map(|line| format!("{indent} * {line}\n"))
                .collect();
            format!("{indent}/**\n{lines}{indent} */\n")
        }
    }
}

/// A name of schemars, such as `Array_of_double`, as TypeScript has it.
fn identifier(name: &str) -> String {
    let kept = name
        .chars()
        .filter(|c| c.is_ascii_alphanumeric() || *c == '_');
    kept.collect()
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn structs_become_interfaces_and_choices_become_unions() {
        let schema = json!({
            "title": "Result", "description": "A result.", "type": "object",
            "properties": {
                "name": { "type": "string", "description": "Its name." },
                "place": { "type": "array", "items": { "type": "number" }, "minItems": 3, "maxItems": 3 },
                "sigma": { "type": ["number", "null"] },
                "status": { "$ref": "#/$defs/Status" },
                "all": { "type": "array", "items": { "type": ["number", "null"] } },
            },
            "required": ["name", "status"],
            "$defs": {
                "Status": { "oneOf": [{ "const": "ok" }, { "const": "refused" }] },
                "Vessel": {
                    "type": "object", "properties": { "rms": { "type": "number" } }, "required": ["rms"],
                    "oneOf": [{ "type": "object", "properties": { "radius": { "type": "number" } } }],
                },
            },
        });
        let text = declarations(&[schema]);
        for part in [
            "/** A result. */\nexport interface Result {\n",
            "  /** Its name. */\n  name: string;\n",
            "  place?: [number, number, number];\n",
            "  sigma?: number | null;\n",
            "  status: Status;\n",
            "  all?: (number | null)[];\n",
            "export type Status = \"ok\" | \"refused\";\n",
            "export type Vessel = ({\n  radius?: number;\n}) & {\n  rms: number;\n};\n",
        ] {
            assert!(text.contains(part), "{part}\nis missing in\n{text}");
        }
    }
}
