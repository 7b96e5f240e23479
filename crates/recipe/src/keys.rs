//! Unknown keys at any depth, found by walking a value and its JSON Schema together.
//!
//! The schemas are those that `schemars` derives, so a table without `additionalProperties` that names properties is
//! taken as closed. Of alternatives (`anyOf`, `oneOf`) those are followed that fit the value best at its own level; a
//! constant that must be there (`field = "radial"`) decides before anything else does; one that may be left out
//! (`between = "linear"`) hardly counts, so that a wrong word does not make the right keys beside it unknown. The work is linear in the size of the value: only
//! one level of a value is compared with each alternative.

use crate::names::suggestion;
use crate::tree::join;
use serde_json::{Map, Value};
use std::collections::{BTreeMap, BTreeSet};

/// Alternatives of one schema that are looked at; beyond, nothing is reported.
const ALTERNATIVES: usize = 512;
/// References and combinations inside one another that are followed; beyond, nothing is reported.
const NESTING: usize = 32;

/// Cost of another type than the schema's.
const TYPE: usize = 1_000_000;
/// Cost of another constant than the schema's.
const CONSTANT: usize = 10_000;
/// Cost of another constant than the schema's under a key that may be left out.
const WORD: usize = 5;
/// Cost of an unknown key.
const KEY: usize = 10;
/// Cost of a missing one.
const MISSING: usize = 1;

/// A key, or a constant that decides between alternatives, that no schema knows.
pub(crate) struct Unknown {
    pub(crate) path: String,
    pub(crate) is_key: bool,
    pub(crate) message: String,
    pub(crate) hint: String,
}

/// One alternative of a schema at one level.
#[derive(Clone, Default)]
struct Shape<'a> {
    /// The types it allows; all if empty.
    types: Vec<&'a str>,
    /// Its constants; any value if empty.
    constants: Vec<&'a Value>,
    properties: BTreeMap<&'a str, Vec<&'a Value>>,
    required: Vec<&'a str>,
    /// Schemas of keys that are not among the properties.
    additional: Vec<&'a Value>,
    /// Any other key is allowed.
    open: bool,
    /// It says something about keys.
    closed: bool,
    items: Vec<&'a Value>,
    first_items: &'a [Value],
}

impl<'a> Shape<'a> {
    fn anything() -> Self {
        Self {
            open: true,
            ..Self::default()
        }
    }

    /// Both at once.
    fn and(mut self, other: &Self) -> Self {
        self.types.extend(&other.types);
        self.constants.extend(&other.constants);
        for (key, schemas) in &other.properties {
            self.properties.entry(key).or_default().extend(schemas);
        }
        self.required.extend(&other.required);
        self.additional.extend(&other.additional);
        self.open |= other.open;
        self.closed |= other.closed;
        self.items.extend(&other.items);
        if self.first_items.is_empty() {
            self.first_items = other.first_items;
        }
        self
    }

    fn knows(&self, key: &str) -> bool {
        self.open
            || !self.closed
            || !self.additional.is_empty()
            || self.properties.contains_key(key)
    }
}

fn has_type(value: &Value, name: &str) -> bool {
    match name {
        "null" => value.is_null(),
        "boolean" => value.is_boolean(),
        "string" => value.is_string(),
        "array" => value.is_array(),
        "object" => value.is_object(),
        "number" => value.is_number(),
        "integer" => value.as_f64().is_some_and(|number| number.fract() == 0.0),
        _ => true,
    }
}

/// A walk that collects what it does not know.
pub(crate) struct Walk<'a> {
    definitions: &'a Map<String, Value>,
    pub(crate) unknown: Vec<Unknown>,
}

impl<'a> Walk<'a> {
    /// A walk over schemas whose references lead into `definitions`.
    pub(crate) fn new(definitions: &'a Map<String, Value>) -> Self {
        Self {
            definitions,
            unknown: Vec::new(),
        }
    }

    /// Compares `value`, which stands at `path`, with a schema. `also` are keys that are known beside the schema's.
    pub(crate) fn compare(&mut self, value: &Value, schema: &'a Value, path: &str, also: &[&str]) {
        self.walk(value, &[schema], path, also);
    }

    /// The schema of a property, for its description.
    pub(crate) fn property(&self, schema: &'a Value, key: &str) -> Option<&'a Value> {
        let shapes = self.shapes(schema, 0);
        shapes
            .iter()
            .find_map(|shape| shape.properties.get(key)?.first().copied())
    }

    /// The alternatives of a schema.
    fn shapes(&self, schema: &'a Value, nesting: usize) -> Vec<Shape<'a>> {
        let Some(object) = schema.as_object() else {
            return vec![Shape::anything()];
        };
        if nesting > NESTING {
            return vec![Shape::anything()];
        }
        let mut own = Shape::default();
        match object.get("type") {
            Some(Value::String(name)) => own.types.push(name),
            Some(Value::Array(names)) => own.types.extend(names.iter().filter_map(Value::as_str)),
            _ => {}
        }
        own.constants.extend(object.get("const"));
        if let Some(Value::Array(list)) = object.get("enum") {
            own.constants.extend(list);
        }
        if let Some(Value::Object(properties)) = object.get("properties") {
            own.closed = true;
            for (key, schema) in properties {
                own.properties.entry(key).or_default().push(schema);
            }
        }
        if let Some(Value::Array(names)) = object.get("required") {
            own.required.extend(names.iter().filter_map(Value::as_str));
        }
        for word in ["additionalProperties", "unevaluatedProperties"] {
            match object.get(word) {
                Some(Value::Bool(open)) => {
                    own.open |= open;
                    own.closed |= !open;
                }
                Some(schema) => own.additional.push(schema),
                None => {}
            }
        }
        if let Some(Value::Object(patterns)) = object.get("patternProperties") {
            own.additional.extend(patterns.values());
        }
        own.items.extend(object.get("items"));
        if let Some(Value::Array(list)) = object.get("prefixItems") {
            own.first_items = list;
        }

        let mut shapes = vec![own];
        let product = |shapes: &[Shape<'a>], others: &[Shape<'a>]| -> Vec<Shape<'a>> {
            if shapes.len() * others.len() > ALTERNATIVES {
                return vec![Shape::anything()];
            }
            let pairs = shapes
                .iter()
                .flat_map(|a| others.iter().map(move |b| (a, b)));
            pairs.map(|(a, b)| a.clone().and(b)).collect()
        };
        if let Some(Value::String(reference)) = object.get("$ref") {
            let target = reference.strip_prefix("#/$defs/").and_then(|name| {
                self.definitions
                    .get(&name.replace("~1", "/").replace("~0", "~"))
            });
            let others = target.map_or_else(
                || vec![Shape::anything()],
                |target| self.shapes(target, nesting + 1),
            );
            shapes = product(&shapes, &others);
        }
        if let Some(Value::Array(all)) = object.get("allOf") {
            for schema in all {
                shapes = product(&shapes, &self.shapes(schema, nesting + 1));
            }
        }
        for word in ["anyOf", "oneOf"] {
            if let Some(Value::Array(list)) = object.get(word) {
                let mut others = Vec::new();
                for schema in list {
                    others.extend(self.shapes(schema, nesting + 1));
                    if others.len() > ALTERNATIVES {
                        return vec![Shape::anything()];
                    }
                }
                shapes = product(&shapes, &others);
            }
        }
        shapes
    }

    /// The constants of a schema that has nothing else; none if it allows anything else.
    fn constants(&self, schemas: &[&'a Value]) -> Vec<&'a Value> {
        let mut constants = Vec::new();
        for schema in schemas {
            for shape in self.shapes(schema, 0) {
                if shape.constants.is_empty() {
                    return Vec::new();
                }
                constants.extend(shape.constants);
            }
        }
        constants
    }

    /// Keys of the value whose constants in this shape are others.
    fn mismatches(&self, shape: &Shape<'a>, table: &Map<String, Value>) -> Vec<&'a str> {
        let differs = |(key, schemas): (&&'a str, &Vec<&'a Value>)| {
            let value = table.get(*key)?;
            let constants = self.constants(schemas);
            (!constants.is_empty() && !constants.contains(&value)).then_some(*key)
        };
        shape.properties.iter().filter_map(differs).collect()
    }

    fn cost(&self, shape: &Shape<'a>, value: &Value) -> usize {
        let mut cost = 0;
        if !shape.types.is_empty() && !shape.types.iter().any(|name| has_type(value, name)) {
            cost += TYPE;
        }
        if !shape.constants.is_empty() && !shape.constants.contains(&value) {
            cost += CONSTANT;
        }
        if let Value::Object(table) = value {
            for key in self.mismatches(shape, table) {
                let decides = shape.required.contains(&key);
                cost += if decides { CONSTANT } else { WORD };
            }
            cost += KEY * table.keys().filter(|key| !shape.knows(key)).count();
            let missing = |key: &&&str| !table.contains_key(**key);
            cost += MISSING * shape.required.iter().filter(missing).count();
        }
        cost
    }

    fn walk(&mut self, value: &Value, schemas: &[&'a Value], path: &str, also: &[&str]) {
        if !value.is_object() && !value.is_array() {
            return;
        }
        let mut shapes: Vec<(usize, Shape<'a>)> = Vec::new();
        for (i, schema) in schemas.iter().enumerate() {
            // Alternatives that share a schema lead here once, or the walk would double at every level.
            if schemas[..i]
                .iter()
                .any(|other| std::ptr::eq(*other, *schema))
            {
                continue;
            }
            for shape in self.shapes(schema, 0) {
                shapes.push((self.cost(&shape, value), shape));
            }
        }
        if let Value::Object(table) = value
            && self.decides_nothing(table, &shapes)
        {
            self.report_choice(table, &shapes, path);
            return;
        }
        let Some(least) = shapes.iter().map(|(cost, _)| *cost).min() else {
            return;
        };
        if least >= TYPE {
            // Another type than any: the plug-in will say what it expects.
            return;
        }
        if least >= CONSTANT && shapes.len() > 1 {
            if let Value::Object(table) = value {
                self.report_choice(table, &shapes, path);
            }
            return;
        }
        shapes.retain(|(cost, _)| *cost == least);
        match value {
            Value::Object(table) => self.table(table, &shapes, path, also),
            Value::Array(list) => {
                for (i, item) in list.iter().enumerate() {
                    let of_shape = |(_, shape): &(usize, Shape<'a>)| match shape.first_items.get(i)
                    {
                        Some(schema) => vec![schema],
                        None => shape.items.clone(),
                    };
                    let inner: Vec<&'a Value> = shapes.iter().flat_map(of_shape).collect();
                    self.walk(item, &inner, &join(path, &i.to_string()), &[]);
                }
            }
            _ => {}
        }
    }

    /// Whether a key by which alternatives are told apart has a word that none of them has.
    fn decides_nothing(&self, table: &Map<String, Value>, shapes: &[(usize, Shape<'a>)]) -> bool {
        let of_type = || shapes.iter().filter(|(cost, _)| *cost < TYPE);
        let mut keys: BTreeSet<&str> = BTreeSet::new();
        for (_, shape) in of_type() {
            keys.extend(
                shape
                    .required
                    .iter()
                    .filter(|key| table.contains_key(**key)),
            );
        }
        keys.into_iter().any(|key| {
            let Some(word @ Value::String(_)) = table.get(key) else {
                return false;
            };
            let mut any = false;
            for (_, shape) in of_type() {
                let Some(schemas) = shape.properties.get(key) else {
                    continue;
                };
                let constants = self.constants(schemas);
                if constants.is_empty() || constants.contains(&word) {
                    return false;
                }
                any = true;
            }
            any
        })
    }

    fn table(
        &mut self,
        table: &Map<String, Value>,
        shapes: &[(usize, Shape<'a>)],
        path: &str,
        also: &[&str],
    ) {
        for (key, item) in table {
            let inner_path = join(path, key);
            let mut inner = Vec::new();
            let mut known = false;
            for (_, shape) in shapes {
                known |= shape.knows(key);
                match shape.properties.get(key.as_str()) {
                    Some(schemas) => inner.extend(schemas),
                    None => inner.extend(&shape.additional),
                }
            }
            if known {
                self.walk(item, &inner, &inner_path, &[]);
                continue;
            }
            let names = shapes.iter().flat_map(|(_, shape)| shape.properties.keys());
            // The plug-in's own keys first.
            let own: BTreeSet<&str> = names.copied().collect();
            let words: Vec<String> = own
                .iter()
                .chain(also)
                .map(|&name| name.to_owned())
                .collect();
            self.unknown.push(Unknown {
                path: inner_path,
                is_key: true,
                message: format!("unknown key {}", crate::error::quoted(key)),
                hint: suggestion(key, &words),
            });
        }
    }

    /// Reports the constant by which no alternative was chosen.
    fn report_choice(
        &mut self,
        table: &Map<String, Value>,
        shapes: &[(usize, Shape<'a>)],
        path: &str,
    ) {
        let of_type: Vec<&Shape<'a>> = shapes
            .iter()
            .filter(|(cost, _)| *cost < TYPE)
            .map(|(_, shape)| shape)
            .collect();
        let keys: BTreeSet<&str> = of_type
            .iter()
            .flat_map(|shape| self.mismatches(shape, table))
            .collect();
        for key in keys {
            let mut words = BTreeSet::new();
            for shape in &of_type {
                let schemas = shape.properties.get(key).map_or(&[][..], Vec::as_slice);
                let constants = self.constants(schemas);
                words.extend(constants.into_iter().filter_map(Value::as_str));
            }
            let Some(Value::String(word)) = table.get(key) else {
                continue;
            };
            if words.contains(word.as_str()) {
                continue;
            }
            let words: Vec<String> = words.into_iter().map(str::to_owned).collect();
            self.unknown.push(Unknown {
                path: join(path, key),
                is_key: false,
                message: format!("`{key}` cannot be {}", crate::error::quoted(word)),
                hint: suggestion(word, &words),
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn unknown(value: &Value, schema: &Value) -> Vec<String> {
        let definitions = schema.get("$defs").and_then(Value::as_object).cloned();
        let definitions = definitions.unwrap_or_default();
        let mut walk = Walk::new(&definitions);
        walk.compare(value, schema, "", &[]);
        walk.unknown.into_iter().map(|u| u.path).collect()
    }

    fn field() -> Value {
        json!({
            "$ref": "#/$defs/Field",
            "$defs": { "Field": { "anyOf": [
                { "type": "number" },
                { "type": "object", "properties": { "field": { "const": "radial" }, "radius": {} },
                  "required": ["field"], "additionalProperties": false },
                { "type": "object", "properties": { "field": { "const": "product" },
                  "of": { "type": "array", "items": { "$ref": "#/$defs/Field" } } }, "required": ["field"] },
            ] } }
        })
    }

    #[test]
    fn alternatives_are_chosen_by_their_constants() {
        let nested = json!({ "field": "product", "of": [0.5, { "field": "radial", "radus": 1 },
            { "field": "product", "of": [{ "field": "radial", "of": 1 }] }] });
        assert_eq!(unknown(&nested, &field()), ["of.1.radus", "of.2.of.0.of"]);
        assert_eq!(
            unknown(&json!({ "field": "radal", "q": 1 }), &field()),
            ["field"]
        );
        assert_eq!(unknown(&json!("text"), &field()), [""; 0]);
    }

    #[test]
    fn deep_recursion_without_constants_is_linear() {
        // Two alternatives that both fit at every level: a walk that followed each for itself would take 2^60 steps.
        let schema = json!({ "$ref": "#/$defs/A", "$defs": { "A": { "anyOf": [
            { "type": "object", "properties": { "a": { "$ref": "#/$defs/A" } } },
            { "type": "object", "properties": { "a": { "$ref": "#/$defs/A" }, "b": {} } },
        ] } } });
        let mut value = json!({ "c": 1 });
        for _ in 0..60 {
            value = json!({ "a": value });
        }
        assert_eq!(unknown(&value, &schema).len(), 1);
    }

    #[test]
    fn circular_definitions_end() {
        let schema = json!({ "$ref": "#/$defs/A", "$defs": { "A": { "allOf": [{ "$ref": "#/$defs/A" }] } } });
        assert_eq!(unknown(&json!({ "a": 1 }), &schema), [""; 0]);
    }

    #[test]
    fn combined_and_open_tables() {
        let schema = json!({
            "type": "object",
            "properties": { "a": {} },
            "allOf": [{ "properties": { "b": { "additionalProperties": { "type": "object", "properties": { "c": {} } } } } }],
            "unevaluatedProperties": false
        });
        let value = json!({ "a": { "x": 1 }, "b": { "any": { "c": 1, "d": 2 } }, "e": 1 });
        assert_eq!(unknown(&value, &schema), ["b.any.d", "e"]);
        let list = json!({ "prefixItems": [{ "type": "object", "properties": { "a": {} } }], "items": { "properties": { "b": {} } } });
        assert_eq!(
            unknown(&json!([{ "b": 1 }, { "b": 1 }, { "a": 1 }]), &list),
            ["0.b", "2.a"]
        );
        assert_eq!(unknown(&json!({ "x": { "y": 1 } }), &json!(true)), [""; 0]);
    }
}
