//! JSON schema of a scene: what `nlmodes-cli schema` prints, and what scenes are checked against.

use std::sync::OnceLock;

use schemars::JsonSchema;
use schemars::generate::SchemaSettings;
use serde_json::{Map, Value, json};

use crate::raw::{RawBodiesScene, RawMatrixScene, RawRecordScene, RawScene, RawTestScene};

/// JSON schema of a scene of a structure (draft 2020-12), without references. Units stand under the extra key `unit`.
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
    let (mut schema, records, tests, matrices) = (schema(), of_records(), of_test(), of_matrices());
    let kinds =
        [&schema, matrices, records, tests].map(|kind| json!({ "title": kind["title"], "required": kind["required"] }));
    for other in [records, tests] {
        if let (Some(all), Some(more)) = (schema["properties"].as_object_mut(), other["properties"].as_object()) {
            for (key, rule) in more {
                all.entry(key).or_insert_with(|| rule.clone());
            }
        }
    }
    for table in ["structure", "contact"] {
        join_tables(&mut schema["properties"][table], &matrices["properties"][table]);
    }
    if let Some(root) = schema.as_object_mut() {
        root.remove("required");
        root.insert("oneOf".into(), json!(kinds));
    }
    schema
}

/// A table, or the items of a list of tables, with the keys of both of two, and what each of them demands.
fn join_tables(one: &mut Value, other: &Value) {
    let (one, other) = if one.get("items").is_some() { (&mut one["items"], &other["items"]) } else { (one, other) };
    if let (Some(all), Some(more)) = (one["properties"].as_object_mut(), other["properties"].as_object()) {
        for (key, rule) in more {
            let choices = rule.get("oneOf").and_then(Value::as_array);
            match (all.get_mut(key).and_then(|own| own.get_mut("oneOf")).and_then(Value::as_array_mut), choices) {
                (Some(own), Some(choices)) => {
                    let new: Vec<Value> = choices.iter().filter(|choice| !own.contains(choice)).cloned().collect();
                    own.extend(new);
                }
                _ => _ = all.entry(key).or_insert_with(|| rule.clone()),
            }
        }
    }
    let demands = json!([{ "required": one["required"] }, { "required": other["required"] }]);
    if let Some(table) = one.as_object_mut() {
        table.remove("required");
        table.insert("oneOf".into(), demands);
    }
}

/// JSON schema of any tables.
pub fn schema_of<T: JsonSchema>() -> Value {
    let settings = SchemaSettings::draft2020_12().with(|settings| settings.inline_subschemas = true);
    let mut schema = settings.into_generator().into_root_schema_for::<T>().to_value();
    without_null(&mut schema);
    // Of tables with a common part, this is not said by themselves.
    if let Some(root) = schema.as_object_mut() {
        root.entry("additionalProperties").or_insert(Value::Bool(false));
    }
    schema
}

/// Takes out `null`, which stands for "left out" in the raw tables and which TOML does not have.
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
    fn nothing_is_null_and_no_choice_is_left_open() {
        let text = whole_schema().to_string();
        assert!(!text.contains("null"), "{text}");
        assert!(!text.contains("anyOf"), "{text}");
        assert!(!text.contains("$ref"), "{text}");
    }
}
