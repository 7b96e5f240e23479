//! A small validator of JSON Schema: the subset of draft 2020-12 that the schema of recipes uses.

use serde_json::{Map, Value};
use std::collections::BTreeSet;

/// Validates and returns the keys of `value` that were evaluated; `None` if it is not valid.
pub(crate) fn validate(value: &Value, schema: &Value, root: &Value) -> Option<BTreeSet<String>> {
    let object = match schema {
        Value::Bool(valid) => return valid.then(BTreeSet::new),
        other => other
            .as_object()
            .expect("a schema is a table or a truth value"),
    };
    let mut evaluated = BTreeSet::new();
    let table = value.as_object();
    let empty = Map::new();
    let entries = table.unwrap_or(&empty);
    // Words that say more about others come last.
    let last = ["additionalProperties", "unevaluatedProperties"];
    let words = object
        .iter()
        .filter(|(word, _)| !last.contains(&word.as_str()));
    for (word, rule) in words.chain(last.iter().filter_map(|word| object.get_key_value(*word))) {
        let inner = |rule: &Value| validate(value, rule, root);
        let inner_of = |item: &Value, rule: &Value| validate(item, rule, root).is_some();
        let ok = match word.as_str() {
            "$ref" => {
                let pointer = rule.as_str()?.strip_prefix('#')?;
                let keys = inner(root.pointer(pointer).expect("a reference leads somewhere"))?;
                evaluated.extend(keys);
                true
            }
            "type" => {
                let is = |name: &Value| match name.as_str() {
                    Some("object") => value.is_object(),
                    Some("array") => value.is_array(),
                    Some("string") => value.is_string(),
                    Some("number") => value.is_number(),
                    Some("integer") => value.as_f64().is_some_and(|n| n.fract() == 0.0),
                    Some("boolean") => value.is_boolean(),
                    Some("null") => value.is_null(),
                    other => panic!("unknown type {other:?}"),
                };
                rule.as_array()
                    .map_or_else(|| is(rule), |names| names.iter().any(is))
            }
            "const" => value == rule || value.as_f64().is_some_and(|n| rule.as_f64() == Some(n)),
            "enum" => rule.as_array()?.contains(value),
            "required" => rule.as_array()?.iter().all(|key| {
                table.is_none_or(|table| table.contains_key(key.as_str().unwrap_or("")))
            }),
            "properties" => rule.as_object()?.iter().all(|(key, rule)| {
                let Some(item) = entries.get(key) else {
                    return true;
                };
                evaluated.insert(key.clone());
                validate(item, rule, root).is_some()
            }),
            "additionalProperties" => {
                let own = object.get("properties").and_then(Value::as_object);
                let others = entries
                    .iter()
                    .filter(|(key, _)| !own.is_some_and(|own| own.contains_key(*key)));
                others.clone().for_each(|(key, _)| {
                    evaluated.insert(key.clone());
                });
                others
                    .map(|(_, item)| item)
                    .all(|item| validate(item, rule, root).is_some())
            }
            "unevaluatedProperties" => entries
                .iter()
                .all(|(key, item)| evaluated.contains(key) || validate(item, rule, root).is_some()),
            "prefixItems" => {
                let rules = rule.as_array()?;
                let list = value.as_array();
                list.is_none_or(|list| {
                    list.iter()
                        .zip(rules)
                        .all(|(item, rule)| inner_of(item, rule))
                })
            }
            "items" => {
                let before = object.get("prefixItems").and_then(Value::as_array);
                let before = before.map_or(0, Vec::len);
                let list = value.as_array();
                list.is_none_or(|list| list.iter().skip(before).all(|item| inner_of(item, rule)))
            }
            "minItems" => value
                .as_array()
                .is_none_or(|list| Some(list.len() as u64) >= rule.as_u64()),
            "maxItems" => value
                .as_array()
                .is_none_or(|list| Some(list.len() as u64) <= rule.as_u64()),
            "minimum" => value.as_f64().is_none_or(|n| Some(n) >= rule.as_f64()),
            "maximum" => value.as_f64().is_none_or(|n| Some(n) <= rule.as_f64()),
            "not" => inner(rule).is_none(),
            "exclusiveMinimum" => value.as_f64().is_none_or(|n| Some(n) > rule.as_f64()),
            "allOf" | "anyOf" | "oneOf" => {
                let list = rule.as_array()?;
                let valid: Vec<_> = list.iter().filter_map(inner).collect();
                let count = valid.len();
                evaluated.extend(valid.into_iter().flatten());
                match word.as_str() {
                    "allOf" => count == list.len(),
                    "anyOf" => count > 0,
                    _ => count == 1,
                }
            }
            "title" | "description" | "default" | "$schema" | "$defs" | "format" | "pattern" => {
                true
            }
            other => panic!("this validator does not know {other}"),
        };
        if !ok {
            return None;
        }
    }
    Some(evaluated)
}
