//! JSON schema of a scene: what `nlmodes-cli schema` prints, and what scenes are checked against.

mod whole;

use std::sync::OnceLock;

use schemars::JsonSchema;
use schemars::generate::SchemaSettings;
use serde_json::{Map, Value, json};

use crate::raw::{RawBodiesScene, RawMatrixScene, RawRecordScene, RawReducedScene, RawScene, RawTestScene};

/// JSON schema of a scene of a structure (draft 2020-12), without references. Units are given by the extra key `unit`.
pub fn schema() -> Value {
    of_structure().clone()
}

/// The schema of a scene of a structure, made once.
pub fn of_structure() -> &'static Value {
    static SCHEMA: OnceLock<Value> = OnceLock::new();
    SCHEMA.get_or_init(schema_of::<RawScene>)
}

/// The schema of a scene of a structure from files, in the same way.
pub fn of_matrices() -> &'static Value {
    static SCHEMA: OnceLock<Value> = OnceLock::new();
    SCHEMA.get_or_init(schema_of::<RawMatrixScene>)
}

/// The schema of a scene of a structure that was reduced elsewhere, in the same way.
pub fn of_reduced() -> &'static Value {
    static SCHEMA: OnceLock<Value> = OnceLock::new();
    SCHEMA.get_or_init(schema_of::<RawReducedScene>)
}

/// The schema of a scene of several structures, in the same way.
pub fn of_bodies() -> &'static Value {
    static SCHEMA: OnceLock<Value> = OnceLock::new();
    SCHEMA.get_or_init(schema_of::<RawBodiesScene>)
}

/// The schema of a scene of measured records, in the same way.
pub fn of_records() -> &'static Value {
    static SCHEMA: OnceLock<Value> = OnceLock::new();
    SCHEMA.get_or_init(schema_of::<RawRecordScene>)
}

/// The schema of a scene of a virtual test, in the same way.
pub fn of_test() -> &'static Value {
    static SCHEMA: OnceLock<Value> = OnceLock::new();
    SCHEMA.get_or_init(schema_of::<RawTestScene>)
}

/// JSON schema of all scenes: the keys of all kinds, and which of them each kind demands.
pub fn whole_schema() -> Value {
    let mut schema =
        whole::joined(&[of_structure(), of_bodies(), of_matrices(), of_reduced(), of_records(), of_test()]);
    schema["title"] = json!("nlmodes scene");
    schema["$schema"] = of_structure()["$schema"].clone();
    for table in ["method", "response"] {
        under_one_or_two_brackets(&mut schema["properties"][table]);
    }
    whole::published(schema)
}

/// JSON schema of files of another kind, as studies, in words that every program understands.
pub fn schema_for<T: JsonSchema>() -> Value {
    whole::published(schema_of::<T>())
}

/// A table of which there may be several: `[method]` or `[[method]]`.
fn under_one_or_two_brackets(rule: &mut Value) {
    let written = rule.take();
    let kinds = match written.get("items") {
        Some(table) => json!([table, written]),
        None => json!([written, { "type": "array", "minItems": 1, "items": written }]),
    };
    *rule = json!({ "description": written["description"], "anyOf": kinds });
}

/// JSON schema of any tables.
pub fn schema_of<T: JsonSchema>() -> Value {
    let settings = SchemaSettings::draft2020_12().with(|settings| settings.inline_subschemas = true);
    let mut schema = settings.into_generator().into_root_schema_for::<T>().to_value();
    without_null(&mut schema);
    with_aliases(&mut schema);
    // Of tables with a common part, this is not said by themselves.
    if let Some(root) = schema.as_object_mut() {
        root.entry("additionalProperties").or_insert(Value::Bool(false));
    }
    schema
}

/// Adds the other words of choices, each given with its choice as `alias`.
fn with_aliases(value: &mut Value) {
    match value {
        Value::Object(object) => {
            if let Some(Value::Array(choices)) = object.get_mut("oneOf") {
                let other = |choice: &mut Value| {
                    let alias = choice.as_object_mut()?.remove("alias")?;
                    let mut other = choice.clone();
                    other["const"] = alias;
                    Some(other)
                };
                let others: Vec<Value> = choices.iter_mut().filter_map(other).collect();
                choices.extend(others);
            }
            object.values_mut().for_each(with_aliases);
        }
        Value::Array(items) => items.iter_mut().for_each(with_aliases),
        _ => {}
    }
}

/// Takes out `null`, which means "left out" in the raw tables and which TOML does not have.
fn without_null(value: &mut Value) {
    match value {
        Value::Object(object) => {
            unwrap_optional(object);
            object.values_mut().for_each(without_null);
        }
        Value::Array(items) => items.iter_mut().for_each(without_null),
        _ => {}
    }
}

/// `type: [T, null]` becomes `type: T`, and `anyOf: [S, null]` becomes `S`.
fn unwrap_optional(object: &mut Map<String, Value>) {
    if object.contains_key("properties") {
        object.entry("additionalProperties").or_insert(Value::Bool(false));
    }
    // An absent value that means absence is no default.
    if object.get("default").is_some_and(|value| value.is_null() || *value == json!("") || *value == json!([])) {
        object.remove("default");
    }
    if let Some(Value::Array(types)) = object.get_mut("type") {
        types.retain(|name| name != "null");
        if let [only] = types.as_slice() {
            let only = only.clone();
            object.insert("type".into(), only);
        }
    }
    if let Some(Value::Array(branches)) = object.remove("anyOf") {
        for (key, value) in branches.into_iter().filter_map(not_null).flatten() {
            object.entry(key).or_insert(value);
        }
    }
}

fn not_null(schema: Value) -> Option<Map<String, Value>> {
    match schema {
        Value::Object(object) if object.get("type").is_none_or(|name| name != "null") => Some(object),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_null_and_no_word_is_ours() {
        let text = whole_schema().to_string();
        assert!(!text.contains("null"), "{text}");
        assert!(!text.contains("oneRequired"), "{text}");
        assert!(!text.contains("$ref"), "{text}");
    }
}
