//! Parameter types of recipes: angles with units, lengths and places that may be relative to the model.
//!
//! A percentage means, for a *place*, a fraction of the model's bounds along that coordinate (`"0%"` is the smallest
//! coordinate, `"100%"` the largest); for an *offset*, of the bounds' edge along that coordinate; for a *length*, of the
//! bounds' diagonal; *along an axis*, of the model's extent along that axis.

use crate::{ConstructError, Context};
use anamorph_core::{Bounds, Scaling, Space, math};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Deserialize, Deserializer, Error, Visitor};
use std::borrow::Cow;
use std::fmt;

/// A number that is absolute (scene units) or a percentage of something the parameter's type names.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Coordinate {
    /// Scene units.
    Absolute(f64),
    /// A fraction: `"50%"` is 0.5.
    Relative(f64),
}

impl Coordinate {
    fn within(self, from: f64, to: f64) -> f64 {
        match self {
            Self::Absolute(value) => value,
            // Exact at both ends.
            Self::Relative(f) => from * (1.0 - f) + to * f,
        }
    }
    fn is_relative(self) -> bool {
        matches!(self, Self::Relative(_))
    }
}

fn finite<E: Error>(value: f64) -> Result<f64, E> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(E::custom("the number is not finite"))
    }
}

fn parse_percentage<E: Error>(text: &str) -> Result<f64, E> {
    let number = text.trim().strip_suffix('%').map(str::trim);
    match number.and_then(|n| n.parse::<f64>().ok()) {
        Some(percent) => finite(percent / 100.0),
        None => Err(E::custom(format!(
            "`{text}` is neither a number nor a percentage | write a number in scene units, or a share of the model's \
             bounds such as \"50%\""
        ))),
    }
}

struct CoordinateVisitor;

impl Visitor<'_> for CoordinateVisitor {
    type Value = Coordinate;
    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number in scene units or a percentage such as \"50%\"")
    }
    fn visit_f64<E: Error>(self, value: f64) -> Result<Coordinate, E> {
        finite(value).map(Coordinate::Absolute)
    }
    #[allow(clippy::cast_precision_loss)]
    fn visit_i64<E: Error>(self, value: i64) -> Result<Coordinate, E> {
        Ok(Coordinate::Absolute(value as f64))
    }
    #[allow(clippy::cast_precision_loss)]
    fn visit_u64<E: Error>(self, value: u64) -> Result<Coordinate, E> {
        Ok(Coordinate::Absolute(value as f64))
    }
    fn visit_str<E: Error>(self, text: &str) -> Result<Coordinate, E> {
        parse_percentage(text).map(Coordinate::Relative)
    }
}

impl<'de> Deserialize<'de> for Coordinate {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(CoordinateVisitor)
    }
}

fn percentage_or_number(description: &str) -> Schema {
    json_schema!({
        "description": description,
        "anyOf": [{ "type": "number" }, { "type": "string", "pattern": "^\\s*[-+]?[0-9.]+([eE][-+]?[0-9]+)?\\s*%\\s*$" }]
    })
}

macro_rules! inline_schema {
    ($type:ty, $name:literal, $schema:expr) => {
        impl JsonSchema for $type {
            fn inline_schema() -> bool {
                true
            }
            fn schema_name() -> Cow<'static, str> {
                $name.into()
            }
            fn json_schema(_: &mut SchemaGenerator) -> Schema {
                $schema
            }
        }
    };
}

inline_schema!(
    Coordinate,
    "Coordinate",
    percentage_or_number("scene units, or a percentage of the model's bounds")
);

/// A length: scene units, or a percentage of the diagonal of the model's bounds.
#[derive(Debug, Clone, Copy, PartialEq, serde::Deserialize)]
#[serde(transparent)]
pub struct Length(pub Coordinate);
inline_schema!(
    Length,
    "Length",
    percentage_or_number(
        "a length in scene units, or a percentage of the diagonal of the model's bounds"
    )
);

impl Length {
    /// The length in scene units; `path` names the parameter in errors.
    pub fn resolve<S: Space>(
        self,
        path: &str,
        context: &Context<'_, S>,
    ) -> Result<f64, ConstructError> {
        match self.0 {
            Coordinate::Absolute(value) => Ok(value),
            Coordinate::Relative(f) => {
                let diagonal = context.bounds(path)?.diagonal();
                if diagonal.is_finite() {
                    Ok(f * diagonal)
                } else {
                    Err(overflow(path))
                }
            }
        }
    }

    /// As [`Length::resolve`], and refuses what is not greater than zero.
    pub fn resolve_positive<S: Space>(
        self,
        path: &str,
        context: &Context<'_, S>,
    ) -> Result<f64, ConstructError> {
        let length = self.resolve(path, context)?;
        if length > 0.0 && length.is_finite() {
            return Ok(length);
        }
        let message = format!("the length is {length}, and must be greater than 0");
        Err(ConstructError::new(path, message).with_hint(match self.0 {
            Coordinate::Relative(f) if f > 0.0 => {
                "the model has no extent; write the length in scene units"
            }
            _ => "write a positive number or percentage",
        }))
    }
}

/// The error of a share of a size that is beyond the range of numbers.
fn overflow(path: &str) -> ConstructError {
    ConstructError::new(
        path,
        "this is a share of the model's size, which overflows the range of numbers",
    )
    .with_hint("scale the model down")
}

/// Either one number for all coordinates (percentages only) or one each.
#[derive(Debug, Clone, PartialEq)]
struct Tuple(Vec<Coordinate>);

impl<'de> Deserialize<'de> for Tuple {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct TupleVisitor;
        impl<'de> Visitor<'de> for TupleVisitor {
            type Value = Tuple;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a list of numbers or percentages, one per coordinate, such as [0, \"50%\", 1.5]")
            }
            fn visit_seq<A: serde::de::SeqAccess<'de>>(
                self,
                mut seq: A,
            ) -> Result<Tuple, A::Error> {
                let mut list = Vec::new();
                while let Some(item) = seq.next_element::<Coordinate>()? {
                    list.push(item);
                }
                Ok(Tuple(list))
            }
            fn visit_str<E: Error>(self, text: &str) -> Result<Tuple, E> {
                parse_percentage(text).map(|f| Tuple(vec![Coordinate::Relative(f)]))
            }
        }
        deserializer.deserialize_any(TupleVisitor)
    }
}

impl Tuple {
    fn coordinates<S: Space>(&self, path: &str) -> Result<[Coordinate; 3], ConstructError> {
        match self.0.as_slice() {
            [all] if all.is_relative() => Ok([*all; 3]),
            list if list.len() == S::DIM => Ok(core::array::from_fn(|i| {
                list.get(i).copied().unwrap_or(Coordinate::Absolute(0.0))
            })),
            list => {
                let message = format!(
                    "{} coordinates where the {} has {}",
                    list.len(),
                    S::NAME,
                    S::DIM
                );
                Err(
                    ConstructError::new(path, message).with_hint(if S::DIM == 2 {
                        "write [x, y]"
                    } else {
                        "write [x, y, z]"
                    }),
                )
            }
        }
    }
}

fn tuple_schema(description: &str) -> Schema {
    let item = percentage_or_number("one coordinate");
    json_schema!({
        "description": description,
        "anyOf": [
            { "type": "array", "items": item, "minItems": 2, "maxItems": 3 },
            { "type": "string", "pattern": "^\\s*[-+]?[0-9.]+([eE][-+]?[0-9]+)?\\s*%\\s*$" }
        ]
    })
}

/// A point: one coordinate per axis, each in scene units or as a percentage of the model's bounds; a single `"50%"`
/// stands for all axes.
#[derive(Debug, Clone, PartialEq, serde::Deserialize)]
#[serde(transparent)]
pub struct Place(Tuple);
inline_schema!(
    Place,
    "Place",
    tuple_schema(
        "a point: a coordinate per axis in scene units or as a percentage of the model's bounds; a single \"50%\" for all axes"
    )
);

impl Place {
    /// The point in scene units; `path` names the parameter in errors.
    pub fn resolve<S: Space>(
        &self,
        path: &str,
        context: &Context<'_, S>,
    ) -> Result<S, ConstructError> {
        let coordinates = self.0.coordinates::<S>(path)?;
        let bounds = if coordinates[..S::DIM].iter().any(|c| c.is_relative()) {
            context.bounds(path)?
        } else {
            Bounds {
                min: S::ZERO,
                max: S::ZERO,
            }
        };
        Ok(S::from_fn(|i| {
            coordinates[i].within(bounds.min.component(i), bounds.max.component(i))
        }))
    }
}

/// A displacement: one coordinate per axis, each in scene units or as a percentage of the model's extent along it.
#[derive(Debug, Clone, PartialEq, serde::Deserialize)]
#[serde(transparent)]
pub struct Offset(Tuple);
inline_schema!(
    Offset,
    "Offset",
    tuple_schema(
        "a displacement: a coordinate per axis in scene units or as a percentage of the model's extent along it"
    )
);

impl Offset {
    /// The vector in scene units; `path` names the parameter in errors.
    pub fn resolve<S: Space>(
        &self,
        path: &str,
        context: &Context<'_, S>,
    ) -> Result<S, ConstructError> {
        let coordinates = self.0.coordinates::<S>(path)?;
        let size = if coordinates[..S::DIM].iter().any(|c| c.is_relative()) {
            let size = context.bounds(path)?.size();
            if !size.is_finite() {
                return Err(overflow(path));
            }
            size
        } else {
            S::ZERO
        };
        Ok(S::from_fn(|i| {
            coordinates[i].within(0.0, size.component(i))
        }))
    }
}

/// A coordinate along an axis: scene units from the axis's origin, or a percentage of the model's extent along the axis
/// (`"0%"` its lower end, `"100%"` its upper end).
#[derive(Debug, Clone, Copy, PartialEq, serde::Deserialize)]
#[serde(transparent)]
pub struct Along(pub Coordinate);
inline_schema!(
    Along,
    "Along",
    percentage_or_number(
        "a coordinate along the axis from its origin, or a percentage of the model's extent along it"
    )
);

impl Along {
    /// The coordinate from `origin` along the unit vector `axis`.
    pub fn resolve<S: Space>(
        self,
        path: &str,
        origin: S,
        axis: S,
        context: &Context<'_, S>,
    ) -> Result<f64, ConstructError> {
        match self.0 {
            Coordinate::Absolute(value) => Ok(value),
            Coordinate::Relative(_) => {
                let bounds = context.bounds(path)?;
                // Extent of a box along a direction: per axis, the corner that reaches farthest.
                let (mut low, mut high) = (0.0, 0.0);
                for i in 0..S::DIM {
                    let (a, b) = (
                        (bounds.min - origin).component(i) * axis.component(i),
                        (bounds.max - origin).component(i) * axis.component(i),
                    );
                    low += a.min(b);
                    high += a.max(b);
                }
                Ok(self.0.within(low, high))
            }
        }
    }
}

/// An angle: a string with its unit, `"45deg"`, `"0.7rad"` or `"0.25turn"`. A bare number is an error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Angle(f64);
inline_schema!(
    Angle,
    "Angle",
    json_schema!({
        "description": "an angle with its unit: \"45deg\", \"0.7rad\" or \"0.25turn\"; counter-clockwise positive",
        "type": "string",
        "pattern": "^\\s*[-+]?[0-9.]+([eE][-+]?[0-9]+)?\\s*(deg|rad|turn)\\s*$"
    })
);

impl Angle {
    /// The angle in radians.
    pub fn radians(self) -> f64 {
        self.0
    }

    /// Reads an angle with its unit.
    pub fn from_text(text: &str) -> Option<Self> {
        let text = text.trim();
        let units = [
            ("deg", core::f64::consts::PI / 180.0),
            ("rad", 1.0),
            ("turn", core::f64::consts::TAU),
        ];
        let (number, factor) = units
            .iter()
            .find_map(|(unit, factor)| Some((text.strip_suffix(unit)?, factor)))?;
        let radians = number.trim().parse::<f64>().ok()? * factor;
        radians.is_finite().then_some(Self(radians))
    }
}

impl<'de> Deserialize<'de> for Angle {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct AngleVisitor;
        // The number as it is written, or as short as it can be.
        fn bare<E: Error>(number: impl fmt::Display) -> E {
            E::custom(format!(
                "an angle needs its unit, and {number} has none | write \"{number}deg\" or \"{number}rad\""
            ))
        }
        impl Visitor<'_> for AngleVisitor {
            type Value = Angle;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an angle with its unit, such as \"45deg\" or \"0.7rad\"")
            }
            fn visit_f64<E: Error>(self, value: f64) -> Result<Angle, E> {
                // Beyond a few digits the exponent says more than zeros do.
                if value == 0.0 || (1e-6..1e12).contains(&value.abs()) {
                    Err(bare(value))
                } else {
                    Err(bare(format_args!("{value:e}")))
                }
            }
            fn visit_i64<E: Error>(self, value: i64) -> Result<Angle, E> {
                Err(bare(value))
            }
            fn visit_u64<E: Error>(self, value: u64) -> Result<Angle, E> {
                Err(bare(value))
            }
            fn visit_str<E: Error>(self, text: &str) -> Result<Angle, E> {
                Angle::from_text(text).ok_or_else(|| {
                    let text = text.trim();
                    let finite = |number: &str| number.parse::<f64>().is_ok_and(f64::is_finite);
                    if finite(text) {
                        return bare(text);
                    }
                    // A number with another way to write its unit: say how to write that one.
                    let unit = text.trim_start_matches(|c: char| c.is_ascii_digit() || "+-.".contains(c));
                    let number = &text[..text.len() - unit.len()];
                    let known = match unit.trim().to_lowercase().as_str() {
                        "°" | "º" | "d" | "degs" | "degree" | "degrees" => Some("deg"),
                        "r" | "rads" | "radian" | "radians" => Some("rad"),
                        "turns" | "tr" | "rev" | "revs" => Some("turn"),
                        _ => None,
                    };
                    match known.filter(|_| finite(number)) {
                        Some(unit) => E::custom(format!(
                            "`{text}` is not an angle | write \"{number}{unit}\""
                        )),
                        None => E::custom(format!(
                            "`{text}` is not an angle | write a number and its unit, such as \"45deg\" or \"0.7rad\""
                        )),
                    }
                })
            }
        }
        deserializer.deserialize_any(AngleVisitor)
    }
}

/// A direction: `"x"`, `"-z"`, or a vector such as `[1, 2, 0]` (any length but zero).
#[derive(Debug, Clone, PartialEq, serde::Deserialize)]
#[serde(
    untagged,
    expecting = "an axis is \"x\", \"y\" or \"z\", with a minus to turn it round, or a vector such as [1, 2, 0]"
)]
pub enum Axis {
    /// A coordinate axis by name, with an optional sign.
    Named(String),
    /// A vector.
    Vector(Vec<f64>),
}
inline_schema!(
    Axis,
    "Axis",
    json_schema!({
        "description": "a direction: \"x\", \"y\" or \"z\", with a minus to turn it round, or a vector",
        "anyOf": [
            { "type": "string", "enum": ["x", "y", "z", "+x", "+y", "+z", "-x", "-y", "-z"] },
            { "type": "array", "items": { "type": "number" }, "minItems": 2, "maxItems": 3 }
        ]
    })
);

impl Axis {
    /// The unit vector; `path` names the parameter in errors.
    pub fn resolve<S: Space>(&self, path: &str) -> Result<S, ConstructError> {
        let names = if S::DIM == 2 {
            "\"x\" or \"y\""
        } else {
            "\"x\", \"y\" or \"z\""
        };
        match self {
            Self::Named(name) => {
                let (sign, letter) = match name.as_bytes() {
                    [b'-', letter] => (-1.0, *letter),
                    [b'+', letter] | [letter] => (1.0, *letter),
                    _ => (1.0, 0),
                };
                let index = [b'x', b'y', b'z']
                    .iter()
                    .position(|&l| l == letter.to_ascii_lowercase());
                match index {
                    Some(i) if i < S::DIM => Ok(S::unit(i) * sign),
                    _ => Err(ConstructError::new(
                        path,
                        format!("`{name}` is no axis of the {}", S::NAME),
                    )
                    .with_hint(format!(
                        "write {names}, with a minus to turn it round, or a vector"
                    ))),
                }
            }
            Self::Vector(list) => {
                if list.len() != S::DIM {
                    let message = format!(
                        "{} numbers where the {} has {} axes",
                        list.len(),
                        S::NAME,
                        S::DIM
                    );
                    return Err(ConstructError::new(path, message)
                        .with_hint(format!("write {} numbers, or {names}", S::DIM)));
                }
                S::from_fn(|i| list[i]).normalized().ok_or_else(|| {
                    ConstructError::new(
                        path,
                        "the axis has no direction: its length is zero or not finite",
                    )
                    .with_hint("write a vector that is not zero")
                })
            }
        }
    }
}

/// The name of a scaling method in a recipe.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum ScalingMethod {
    /// Displacements are multiplied by the strength.
    Displacement,
    /// Angles, shifts and stretches are multiplied by the strength and composed again.
    Composition,
}

impl From<ScalingMethod> for Scaling {
    fn from(method: ScalingMethod) -> Self {
        match method {
            ScalingMethod::Displacement => Self::Displacement,
            ScalingMethod::Composition => Self::Composition,
        }
    }
}

/// The angle of a number of degrees, for defaults in code.
impl Angle {
    /// An angle given in degrees.
    pub fn degrees(degrees: f64) -> Self {
        Self(degrees * (core::f64::consts::PI / 180.0))
    }
    /// Sine and cosine.
    pub fn sin_cos(self) -> (f64, f64) {
        math::sin_cos(self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parse;
    use anamorph_core::{Plane, Solid, glam::dvec3};
    use serde_json::json;

    #[derive(Debug, serde::Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Parameters {
        #[serde(default)]
        angle: Option<Angle>,
        #[serde(default)]
        centre: Option<Place>,
        #[serde(default)]
        axis: Option<Axis>,
    }

    fn context() -> Context<'static, Solid> {
        Context::of_bounds(Bounds::new(dvec3(-1.0, 0.0, 2.0), dvec3(3.0, 10.0, 2.0)))
    }

    #[test]
    fn angles_need_units() {
        for (text, radians) in [
            ("180deg", core::f64::consts::PI),
            (" -0.5 rad", -0.5),
            ("0.25turn", core::f64::consts::FRAC_PI_2),
        ] {
            assert_eq!(Angle::from_text(text).unwrap().radians(), radians);
        }
        let read = parse::<Parameters>(&json!({ "angle": "1rad" })).unwrap();
        assert_eq!(read.angle.map(Angle::radians), Some(1.0));
        for bad in [
            json!(45),
            json!(0.5),
            json!("45"),
            json!("many deg"),
            json!("infdeg"),
            json!(true),
        ] {
            let error = parse::<Parameters>(&json!({ "angle": bad })).unwrap_err();
            assert_eq!(error.path, "angle");
            assert!(
                error.to_string().contains("45deg\"") || error.to_string().contains("0.5deg"),
                "{error}"
            );
        }
    }

    #[test]
    fn a_suggested_angle_is_the_one_written() {
        for (written, suggestion) in [
            (json!(45), "\"45deg\""),
            (json!(-7.25), "\"-7.25deg\""),
            (json!(1e-9), "\"1e-9deg\""),
            (json!(u64::MAX), "\"18446744073709551615deg\""),
            (json!("4.50"), "\"4.50deg\""),
            (json!("45°"), "write \"45deg\""),
            (json!("-45.5 Degrees"), "write \"-45.5deg\""),
            (json!("2 radians"), "write \"2rad\""),
            (json!("inf"), "such as \"45deg\""),
            (json!("°"), "such as \"45deg\""),
        ] {
            let error = parse::<Parameters>(&json!({ "angle": written })).unwrap_err();
            assert!(error.hint.contains(suggestion), "{written}: {error}");
        }
    }

    #[test]
    fn places_are_absolute_or_relative() {
        let place = |value| {
            parse::<Parameters>(&json!({ "centre": value }))
                .unwrap()
                .centre
                .unwrap()
        };
        assert_eq!(
            place(json!([1, "100%", "0%"])).resolve("centre", &context()),
            Ok(dvec3(1.0, 10.0, 2.0))
        );
        assert_eq!(
            place(json!("50%")).resolve("centre", &context()),
            Ok(dvec3(1.0, 5.0, 2.0))
        );
        let none = Context::<Solid>::default();
        assert!(
            place(json!("50%"))
                .resolve("centre", &none)
                .unwrap_err()
                .to_string()
                .contains("model")
        );
        assert!(
            place(json!([1, 2]))
                .resolve("centre", &context())
                .unwrap_err()
                .to_string()
                .contains("[x, y, z]")
        );
        let error = parse::<Parameters>(&json!({ "centre": [0, "half", 0] })).unwrap_err();
        assert_eq!(error.path, "centre.1");
    }

    #[test]
    fn axes_by_name_and_vector() {
        let axis = |value| {
            parse::<Parameters>(&json!({ "axis": value }))
                .unwrap()
                .axis
                .unwrap()
        };
        assert_eq!(
            axis(json!("-z")).resolve::<Solid>("axis"),
            Ok(dvec3(0.0, 0.0, -1.0))
        );
        assert_eq!(
            axis(json!([0, 3, 4])).resolve::<Solid>("axis"),
            Ok(dvec3(0.0, 0.6, 0.8))
        );
        assert!(axis(json!("z")).resolve::<Plane>("axis").is_err());
        assert!(axis(json!([0, 0, 0])).resolve::<Solid>("axis").is_err());
        assert!(
            parse::<Parameters>(&json!({ "axis": 3 }))
                .unwrap_err()
                .to_string()
                .contains("\"x\"")
        );
    }

    #[test]
    fn along_an_axis_percentages_span_the_model() {
        let axis = dvec3(0.0, -1.0, 0.0);
        let along = |f| {
            Along(Coordinate::Relative(f))
                .resolve("range", Solid::ZERO, axis, &context())
                .unwrap()
        };
        assert_eq!((along(0.0), along(1.0)), (-10.0, 0.0));
    }
}
