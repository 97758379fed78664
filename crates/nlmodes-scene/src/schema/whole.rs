//! One schema for several kinds of files, and the same without what only this program understands.

use serde_json::{Map, Value, json};

use crate::units::{Spelling, spellings};

/// The union of these schemas: tables are joined key by key, with the requirements of each kind.
pub fn joined(kinds: &[&Value]) -> Value {
    let mut rest: Vec<&Value> = Vec::new();
    for kind in kinds {
        if !rest.contains(kind) {
            rest.push(kind);
        }
    }
    let mut taken = |of: fn(&Value) -> bool| {
        let found: Vec<&Value> = rest.iter().copied().filter(|rule| of(rule)).collect();
        rest.retain(|rule| !of(rule));
        found
    };
    let (tables, lists, words) = (taken(is_table), taken(is_list), taken(is_choice));
    let parts = [(tables, joined_tables as fn(&[&Value]) -> Value), (lists, joined_lists), (words, joined_words)];
    let made = parts.into_iter().filter(|(rules, _)| !rules.is_empty());
    let mut all: Vec<Value> = made
        .map(|(rules, join)| if let [only] = rules[..] { only.clone() } else { join(&rules) })
        .chain(joined_plain(rest))
        .collect();
    match &all[..] {
        [_] => all.remove(0),
        _ => with_description(all, kinds),
    }
}

/// Any of these, with the first description.
fn with_description(all: Vec<Value>, kinds: &[&Value]) -> Value {
    let description = kinds.iter().find_map(|kind| kind.get("description")).cloned().unwrap_or_default();
    json!({ "description": description, "anyOf": all })
}

fn is_table(rule: &Value) -> bool {
    rule["type"] == "object"
}

fn is_list(rule: &Value) -> bool {
    rule["type"] == "array" && rule.get("items").is_some()
}

fn is_choice(rule: &Value) -> bool {
    rule.get("oneOf").is_some_and(Value::is_array)
}

/// Single values, those of one type joined; limits that differ are left out.
fn joined_plain(rules: Vec<&Value>) -> Vec<Value> {
    let mut of_types: Vec<Vec<&Value>> = Vec::new();
    for rule in rules {
        match of_types.iter_mut().find(|same| same[0]["type"] == rule["type"]) {
            Some(same) => same.push(rule),
            None => of_types.push(vec![rule]),
        }
    }
    of_types.iter().map(|same| Value::Object(common(same))).collect()
}

/// Lists with the items of any of them; limits that differ are left out.
fn joined_lists(lists: &[&Value]) -> Value {
    let mut list = common(lists);
    let items: Vec<&Value> = lists.iter().map(|list| &list["items"]).collect();
    list.insert("items".into(), joined(&items));
    Value::Object(list)
}

/// The words of all of them, each once.
fn joined_words(choices: &[&Value]) -> Value {
    let mut choice = common(choices);
    let mut words: Vec<Value> = Vec::new();
    for word in choices.iter().filter_map(|choice| choice["oneOf"].as_array()).flatten() {
        if words.iter().all(|other| other["const"] != word["const"]) {
            words.push(word.clone());
        }
    }
    choice.insert("oneOf".into(), Value::Array(words));
    Value::Object(choice)
}

/// The keys of all of them, and what each demands.
fn joined_tables(tables: &[&Value]) -> Value {
    let mut table = common(tables);
    let all = || tables.iter().filter_map(|table| table["properties"].as_object());
    let mut properties = Map::new();
    for key in all().flat_map(Map::keys) {
        if !properties.contains_key(key) {
            let rules: Vec<&Value> = all().filter_map(|keys| keys.get(key)).collect();
            properties.insert(key.clone(), joined(&rules));
        }
    }
    table.insert("properties".into(), Value::Object(properties));
    let mut demands: Vec<Value> = tables.iter().map(|table| demand(table)).collect();
    demands.dedup();
    ["title", "required", "oneRequired"].iter().for_each(|key| _ = table.remove(*key));
    match &mut demands[..] {
        [Value::Object(only)] => table.append(only),
        _ => _ = table.insert("anyOf".into(), Value::Array(demands)),
    }
    Value::Object(table)
}

/// What a table demands of its keys, under its title.
fn demand(table: &Value) -> Value {
    let said = ["title", "required", "oneRequired"].into_iter();
    let said = said.filter_map(|key| Some((key.to_owned(), table.get(key)?.clone())));
    Value::Object(said.collect())
}

/// The common part.
fn common(rules: &[&Value]) -> Map<String, Value> {
    let Some((Value::Object(first), rest)) = rules.split_first() else { return Map::new() };
    let same = |key: &str, value: &Value| rest.iter().all(|rule| rule.get(key) == Some(value));
    let same = first.iter().filter(|(key, value)| key.as_str() == "description" || same(key, value));
    same.map(|(key, value)| (key.clone(), value.clone())).collect()
}

/// The schema in words that every program understands: `oneRequired` and `enum_of_text` are ours.
pub fn published(mut schema: Value) -> Value {
    translate(&mut schema);
    schema
}

fn translate(value: &mut Value) {
    match value {
        Value::Object(object) => {
            object.values_mut().for_each(translate);
            demands(object);
            other_units(object);
            text_of_words(object);
        }
        Value::Array(items) => items.iter_mut().for_each(translate),
        _ => {}
    }
}

/// Keys of which one is required: those of `oneRequired`, and each of `required` in any of its units.
fn demands(object: &mut Map<String, Value>) {
    if let Some(Value::Array(keys)) = object.remove("oneRequired") {
        let each: Vec<String> = keys.iter().filter_map(Value::as_str).flat_map(in_all_units).collect();
        all_of(object, json!({ "anyOf": demanded(&each) }));
    }
    let Some(Value::Array(required)) = object.get_mut("required") else { return };
    let in_units: Vec<Vec<String>> = required.iter().filter_map(Value::as_str).map(in_all_units).collect();
    required.retain(|key| key.as_str().is_none_or(|key| in_all_units(key).len() == 1));
    for keys in in_units.into_iter().filter(|keys| keys.len() > 1) {
        all_of(object, json!({ "anyOf": demanded(&keys) }));
    }
}

/// The key, and its names in other units.
fn in_all_units(key: &str) -> Vec<String> {
    std::iter::once(key.to_owned()).chain(spellings(key).into_iter().map(|spelling| spelling.key)).collect()
}

fn demanded(keys: &[String]) -> Vec<Value> {
    keys.iter().map(|key| json!({ "required": [key] })).collect()
}

fn all_of(object: &mut Map<String, Value>, demand: Value) {
    if let Value::Array(all) = object.entry("allOf").or_insert_with(|| json!([])) {
        all.push(demand);
    }
}

/// The keys of a table in other units, at most one of which may be given.
fn other_units(object: &mut Map<String, Value>) {
    let Some(Value::Object(keys)) = object.get_mut("properties") else { return };
    let numeric = keys.iter().filter(|(_, rule)| is_numeric(rule));
    let found: Vec<(String, Value)> = numeric.map(|(key, rule)| (key.clone(), rule.clone())).collect();
    let mut once = Vec::new();
    for (key, rule) in found {
        let others = spellings(&key);
        for other in &others {
            let (unit, mut rule) = (other.unit, rule.clone());
            in_unit(&mut rule, other);
            rule["description"] = json!(format!("`{key}` in {unit}"));
            rule["unit"] = json!(unit);
            keys.insert(other.key.clone(), rule);
        }
        if !others.is_empty() {
            let mut choices = demanded(&in_all_units(&key));
            choices.push(json!({ "not": { "anyOf": choices.clone() } }));
            once.push(json!({ "oneOf": choices }));
        }
    }
    once.into_iter().for_each(|demand| all_of(object, demand));
}

fn is_numeric(rule: &Value) -> bool {
    let is = |name: &Value| name == "number";
    let of_type = |rule: &Value| is(&rule["type"]) || rule["type"].as_array().is_some_and(|all| all.iter().any(is));
    of_type(rule) || rule.get("items").is_some_and(of_type)
}

/// The limits of numbers in another unit; a default is given at the key itself.
fn in_unit(rule: &mut Value, other: &Spelling) {
    let Some(object) = rule.as_object_mut() else { return };
    object.remove("default");
    for key in ["minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum"] {
        if let Some(limit) = object.get_mut(key)
            && let Some(x) = limit.as_f64()
        {
            *limit = json!(other.factor.undo(x));
        }
    }
    object.get_mut("items").into_iter().for_each(|items| in_unit(items, other));
}

/// Words that a text must be one of where it may be a list too.
fn text_of_words(object: &mut Map<String, Value>) {
    if let Some(words) = object.remove("enum_of_text") {
        object.insert("if".into(), json!({ "type": "string" }));
        object.insert("then".into(), json!({ "enum": words }));
    }
}
