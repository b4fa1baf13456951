//! A JSON document held against a JSON Schema, as far as this repository's schemas go. By hand, since the crate `jsonschema`
//! brings 38 crates and turns on features of `num` that compile nalgebra and all that rests on it once more.

use serde_json::{Map, Value};

/// What is wrong, by its place in the document; empty where the document has the form.
///
/// # Panics
/// Where the schema uses a keyword that is not known here: none is passed over.
pub fn faults(schema: &Value, document: &Value) -> Vec<String> {
    let mut found = Vec::new();
    check(schema, schema, document, "", &mut found);
    found
}

fn check(root: &Value, schema: &Value, value: &Value, place: &str, found: &mut Vec<String>) {
    for (keyword, rule) in schema.as_object().expect("a schema is an object") {
        let holds = match keyword.as_str() {
            "$schema" | "$defs" | "title" | "description" | "properties" => true,
            "$ref" => {
                let pointer = rule.as_str().and_then(|text| text.strip_prefix('#')).expect("a place in this schema");
                check(root, root.pointer(pointer).expect("it is there"), value, place, found);
                true
            }
            "type" => types(rule).any(|name| is(name, value)),
            "enum" => rule.as_array().expect("a list").contains(value),
            "required" => value.as_object().is_none_or(|object| types(rule).all(|key| object.contains_key(key))),
            "additionalProperties" => {
                value.as_object().is_none_or(|object| members(root, schema, object, place, found))
            }
            "items" => {
                for (k, item) in value.as_array().into_iter().flatten().enumerate() {
                    check(root, rule, item, &format!("{place}/{k}"), found);
                }
                true
            }
            "minItems" => value.as_array().is_none_or(|items| items.len() as f64 >= number(rule)),
            "maxItems" => value.as_array().is_none_or(|items| items.len() as f64 <= number(rule)),
            "minimum" => value.as_f64().is_none_or(|x| x >= number(rule)),
            "maximum" => value.as_f64().is_none_or(|x| x <= number(rule)),
            "exclusiveMinimum" => value.as_f64().is_none_or(|x| x > number(rule)),
            "exclusiveMaximum" => value.as_f64().is_none_or(|x| x < number(rule)),
            other => panic!("unknown keyword `{other}` in the schema"),
        };
        if !holds {
            found.push(format!("{place}: {keyword} {rule}"));
        }
    }
}

/// Checks the members of an object; whether all of them may be there.
fn members(root: &Value, schema: &Value, object: &Map<String, Value>, place: &str, found: &mut Vec<String>) -> bool {
    let mut all_known = true;
    for (key, member) in object {
        let place = format!("{place}/{key}");
        match (schema.get("properties").and_then(|known| known.get(key)), &schema["additionalProperties"]) {
            (Some(own), _) => check(root, own, member, &place, found),
            (None, Value::Bool(allowed)) => all_known &= allowed,
            (None, others) => check(root, others, member, &place, found),
        }
    }
    all_known
}

/// A text, or the texts of a list.
fn types(rule: &Value) -> impl Iterator<Item = &str> {
    let list = rule.as_array().map_or_else(|| std::slice::from_ref(rule), Vec::as_slice);
    list.iter().map(|name| name.as_str().expect("a name"))
}

fn is(name: &str, value: &Value) -> bool {
    match name {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "null" => value.is_null(),
        "number" => value.is_number(),
        "integer" => value.is_u64() || value.is_i64(),
        other => panic!("unknown type `{other}` in the schema"),
    }
}

fn number(rule: &Value) -> f64 {
    rule.as_f64().expect("a number")
}
