//! How recipes describe wires.
//!
//! *Source*: Milliron et al. 2002, §4.4 and §5.3; K. Singh and E. Fiume, *Wires*, SIGGRAPH 1998; the notation is a decision.

use super::curve_parameters::{CurveParameter, polylines, through};
use super::{Along, Anchor, ContinuousWires, Wire, WireError, Wires};
use anamorph_catalog::schemars::JsonSchema;
use anamorph_catalog::{
    Axis, Built, ConstructError, Context, Length, Offset, Value, WarpEntry, parse, schemars,
};
use anamorph_core::sampling::Sampling;
use anamorph_core::{Differentiable, Jet, Solid, Space};
use anamorph_curves::families::registry::InFamily;
use anamorph_fields::Profile;
use anamorph_fields::recipe::FalloffName;
use anamorph_transforms::Rotational;
use serde::Deserialize;
use std::sync::Arc;

/// A length, or one drawn along the wire.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(
    untagged,
    expecting = "a radius is a length, or points along the wire such as [[0, \"10%\"], [1, \"20%\"]] | write a positive \
                 number or percentage, or a list of [share, length]"
)]
#[schemars(inline)]
enum Lengths {
    /// The same everywhere.
    One(Length),
    /// Points [share of the wire, length], smooth through them.
    Drawn(Vec<(f64, Length)>),
}

/// A number, or one drawn along the wire.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(
    untagged,
    expecting = "a scale is a number, or points along the wire such as [[0, 1], [1, 2]] | write a number, or a list of \
                 [share, number]"
)]
#[schemars(inline)]
pub(super) enum Numbers {
    /// The same everywhere.
    One(f64),
    /// Points [share of the wire, number], smooth through them.
    Drawn(Vec<[f64; 2]>),
}

/// Locators as a number along a wire, or an error at the path.
fn locators(path: &str, points: &[[f64; 2]]) -> Result<Along, ConstructError> {
    check_shares(path, points)?;
    Along::through(points).map_err(|error| ConstructError::new(path, error.to_string()))
}

fn check_shares(path: &str, points: &[[f64; 2]]) -> Result<(), ConstructError> {
    match points.iter().position(|p| !(0.0..=1.0).contains(&p[0])) {
        None => Ok(()),
        Some(i) => Err(ConstructError::new(
            format!("{path}.{i}.0"),
            format!("{} is not a share of the wire", points[i][0]),
        )
        .with_hint("write a number from 0 (the start) to 1 (the end)")),
    }
}

impl Lengths {
    fn resolve<S: Space>(
        &self,
        path: &str,
        context: &Context<'_, S>,
    ) -> Result<Along, ConstructError> {
        match self {
            Self::One(length) => Ok(Along::constant(length.resolve_positive(path, context)?)),
            Self::Drawn(list) => {
                let mut points = Vec::with_capacity(list.len());
                for (i, (share, length)) in list.iter().enumerate() {
                    let at = format!("{path}.{i}.1");
                    points.push([*share, length.resolve_positive(&at, context)?]);
                }
                locators(path, &points)
            }
        }
    }
}

impl Numbers {
    pub(super) fn resolve(&self, path: &str) -> Result<Along, ConstructError> {
        match self {
            Self::One(number) => Ok(Along::constant(*number)),
            Self::Drawn(points) => locators(path, points),
        }
    }
}

/// One wire.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct WireParameters {
    /// The curve on the model as it is.
    source: CurveParameter,
    /// The curve that it becomes.
    target: Option<CurveParameter>,
    /// The offset from source to target, instead of `target`. With neither the wire stays.
    by: Option<Offset>,
    /// How far this wire reaches, also drawn along it.
    radius: Option<Lengths>,
    /// Factor about this wire, also drawn along it.
    scale: Option<Numbers>,
    /// Exponent of the displacement in this wire's weight.
    exponent: Option<f64>,
    /// Exponent of the strength in this wire's weight.
    locality: Option<f64>,
    /// How its strength falls off.
    falloff: Option<FalloffName>,
    /// Which share of the target follows a share of the source: points [share, share of the target], smooth through them.
    crimp: Option<Vec<[f64; 2]>>,
    /// A curve towards which the wire reaches just as far as it lies.
    domain: Option<CurveParameter>,
}

/// A curve that holds what is near it.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct AnchorParameters {
    /// The curve.
    curve: CurveParameter,
    /// How far it holds.
    radius: Length,
}

/// How the length of wires is sampled.
#[derive(Debug, Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
#[schemars(inline)]
enum SamplingName {
    /// The nearest place alone.
    Nearest,
    /// The middles of about this many equal cells.
    Uniform(usize),
    /// This many Gauss–Legendre nodes on every smooth piece.
    GaussLegendre(usize),
    /// As many nodes as an error of this share of the displacement takes.
    Adaptive(f64),
}

impl From<SamplingName> for Sampling {
    fn from(name: SamplingName) -> Self {
        match name {
            SamplingName::Nearest => Self::Nearest,
            SamplingName::Uniform(count) => Self::Uniform(count),
            SamplingName::GaussLegendre(count) => Self::GaussLegendre(count),
            SamplingName::Adaptive(tolerance) => Self::Adaptive(tolerance),
        }
    }
}

/// The parameters that all warps by wires share, with more of their own (a shared structure cannot be flattened into them
/// without losing the refusal of unknown keys).
macro_rules! parameters {
    ($(#[$doc:meta])* $name:ident { $($(#[$field_doc:meta])* $field:ident: $type:ty,)* }) => {
        $(#[$doc])*
        #[derive(Deserialize, JsonSchema)]
        #[serde(deny_unknown_fields)]
        struct $name {
            /// The wires; those of the files come before them.
            #[serde(default)]
            wire: Vec<WireParameters>,
            /// A file with source curves: its polylines, a wire each, drawn as Catmull–Rom curves.
            source: Option<String>,
            /// A file with their targets, in the same order.
            target: Option<String>,
            /// How far wires reach that say nothing themselves, also drawn along them.
            radius: Option<Lengths>,
            /// Factor about wires that say nothing themselves, 1 if left out; also drawn along them.
            scale: Option<Numbers>,
            /// Exponent of the displacement in their weights, 1 if left out.
            exponent: Option<f64>,
            /// Exponent of the strength in their weights, 0 if left out.
            locality: Option<f64>,
            /// Their falloff, "wires" if left out.
            falloff: Option<FalloffName>,
            /// Curves that hold what is near them.
            #[serde(default)]
            anchor: Vec<AnchorParameters>,
            $($(#[$field_doc])* $field: $type,)*
        }

        impl $name {
            fn common(&self) -> Common<'_> {
                Common {
                    wires: &self.wire,
                    files: (self.source.as_ref(), self.target.as_ref()),
                    radius: self.radius.as_ref(),
                    scale: self.scale.as_ref(),
                    exponent: self.exponent,
                    locality: self.locality,
                    falloff: self.falloff,
                    anchors: &self.anchor,
                }
            }
        }
    };
}

parameters! {
    /// What is near curves on the model follows them when they are bent.
    WiresParameters {}
}
parameters! {
    /// Wires without tears: an integral over their length.
    ContinuousParameters {
        /// Where the integral is sampled: "nearest", or { uniform = 64 } (if left out), { gauss-legendre = 8 }, { adaptive = 1e-4 }.
        sampling: Option<SamplingName>,
    }
}
parameters! {
    /// Wires that keep depth along a direction of view.
    DepthParameters {
        /// The direction of view, along which no point moves.
        view: Axis,
        /// Where the integral over the wires' length is sampled; at the nearest place without weighing by length if left out.
        sampling: Option<SamplingName>,
    }
}

/// What the structures have in common.
struct Common<'a> {
    wires: &'a [WireParameters],
    files: (Option<&'a String>, Option<&'a String>),
    radius: Option<&'a Lengths>,
    scale: Option<&'a Numbers>,
    exponent: Option<f64>,
    locality: Option<f64>,
    falloff: Option<FalloffName>,
    anchors: &'a [AnchorParameters],
}

/// A curve moved by an offset.
struct Moved<C, S>(C, S);

impl<S: Space, C: Differentiable<S>> anamorph_core::Curve<S> for Moved<C, S> {
    fn domain(&self) -> (f64, f64) {
        self.0.domain()
    }
    fn point(&self, parameter: f64) -> S {
        self.0.point(parameter) + self.1
    }
    fn is_closed(&self) -> bool {
        self.0.is_closed()
    }
}

impl<S: Space, C: Differentiable<S>> Differentiable<S> for Moved<C, S> {
    fn jet(&self, parameter: f64) -> Jet<S> {
        let jet = self.0.jet(parameter);
        Jet {
            point: jet.point + self.1,
            ..jet
        }
    }
    fn velocity(&self, parameter: f64) -> S {
        self.0.velocity(parameter)
    }
    fn breaks(&self) -> Vec<f64> {
        self.0.breaks()
    }
}

impl Common<'_> {
    /// A wire with the warp's own numbers.
    fn wire<S: Rotational + InFamily>(
        &self,
        source: Arc<dyn super::WireCurve<S>>,
        target: Arc<dyn Differentiable<S>>,
        own: Option<(&str, &WireParameters)>,
        context: &Context<'_, S>,
    ) -> Result<Wire<S>, ConstructError> {
        let mut wire = Wire::new(source, target, 1.0);
        let (path, own) = own.map_or(("", None), |(path, own)| (path, Some(own)));
        let at = |key: &str, mine: bool| {
            if mine {
                format!("{path}.{key}")
            } else {
                key.to_owned()
            }
        };
        let mine = own.and_then(|w| w.radius.as_ref());
        let Some(radius) = mine.or(self.radius) else {
            return Err(ConstructError::new(path, "missing field `radius`")
                .with_hint("write how far the wire reaches, such as `radius = \"20%\"`"));
        };
        wire.radius = radius.resolve(&at("radius", mine.is_some()), context)?;
        let mine = own.and_then(|w| w.scale.as_ref());
        if let Some(scale) = mine.or(self.scale) {
            wire.scale = scale.resolve(&at("scale", mine.is_some()))?;
        }
        let number = |key: &str, mine: Option<f64>, common: Option<f64>, usual, range: [f64; 2]| {
            let number = mine.or(common).unwrap_or(usual);
            if (range[0]..=range[1]).contains(&number) {
                return Ok(number);
            }
            let message = format!("the {key} is {number}");
            let hint = format!("write a number from {} to {}", range[0], range[1]);
            Err(ConstructError::new(at(key, mine.is_some()), message).with_hint(hint))
        };
        let mine = own.and_then(|w| w.exponent);
        wire.exponent = number("exponent", mine, self.exponent, 1.0, [-16.0, 16.0])?;
        let mine = own.and_then(|w| w.locality);
        wire.locality = number("locality", mine, self.locality, 0.0, [0.0, 16.0])?;
        let mine = own.and_then(|w| w.falloff);
        wire.falloff = mine.or(self.falloff).unwrap_or_default().get();
        if !wire.falloff.compact() {
            let message = format!("`{}` does not end at a radius", wire.falloff.name());
            return Err(ConstructError::new(at("falloff", mine.is_some()), message)
                .with_hint("take one that does, such as \"wires\""));
        }
        if let Some(own) = own {
            if let Some(crimp) = &own.crimp {
                let path = format!("{path}.crimp");
                check_shares(&path, crimp)?;
                if let Some(i) = crimp.iter().position(|p| !(0.0..=1.0).contains(&p[1])) {
                    return Err(ConstructError::new(
                        format!("{path}.{i}.1"),
                        format!("{} is not a share of the target", crimp[i][1]),
                    )
                    .with_hint("write a number from 0 to 1"));
                }
                let profile = Profile::through(crimp)
                    .map_err(|error| ConstructError::new(&path, error.to_string()))?;
                wire.crimp = Some(profile);
            }
            if let Some(domain) = &own.domain {
                let curve = domain.resolve::<S>(&format!("{path}.domain"), context)?;
                wire.domain = Some(Arc::new(curve));
            }
        }
        for (i, anchor) in self.anchors.iter().enumerate() {
            let curve = anchor
                .curve
                .resolve::<S>(&format!("anchor.{i}.curve"), context)?;
            let radius = anchor
                .radius
                .resolve_positive(&format!("anchor.{i}.radius"), context)?;
            wire.anchors.push(Anchor {
                curve: Arc::new(curve),
                radius,
            });
        }
        Ok(wire)
    }

    /// All wires, and how many of them are of files.
    fn resolve<S: Rotational + InFamily>(
        &self,
        context: &Context<'_, S>,
    ) -> Result<(Vec<Wire<S>>, usize), ConstructError> {
        let mut wires = Vec::new();
        match self.files {
            (None, None) => {}
            (Some(source), Some(target)) => {
                let (from, to) = (
                    polylines("source", source, context)?,
                    polylines("target", target, context)?,
                );
                if from.len() != to.len() {
                    let message = format!(
                        "{target} has {} polylines, and {source} {}",
                        to.len(),
                        from.len()
                    );
                    return Err(ConstructError::new("target", message)
                        .with_hint("give every source curve one target, in the same order"));
                }
                for (from, to) in from.into_iter().zip(to) {
                    let source = Arc::new(through::<S>("source", from)?);
                    let target = Arc::new(through::<S>("target", to)?);
                    wires.push(self.wire(source, target, None, context)?);
                }
            }
            (Some(_), None) => {
                let message = "there is a `source` file and no `target`";
                return Err(ConstructError::new("source", message)
                    .with_hint("name the other file as `target`"));
            }
            (None, Some(_)) => {
                let message = "there is a `target` file and no `source`";
                return Err(ConstructError::new("target", message)
                    .with_hint("name the other file as `source`"));
            }
        }
        let from_files = wires.len();
        for (i, own) in self.wires.iter().enumerate() {
            let path = format!("wire.{i}");
            let at = format!("{path}.source");
            let source = own.source.resolve::<S>(&at, context)?;
            let target: Arc<dyn Differentiable<S>> = match (&own.target, &own.by) {
                (Some(_), Some(_)) => {
                    return Err(ConstructError::new(
                        format!("{path}.by"),
                        "both `target` and `by` are given",
                    )
                    .with_hint("write the target as a curve, or as an offset with `by`"));
                }
                (Some(target), None) => {
                    Arc::new(target.resolve::<S>(&format!("{path}.target"), context)?)
                }
                (None, by) => {
                    let by = match by {
                        Some(by) => by.resolve(&format!("{path}.by"), context)?,
                        None => S::ZERO,
                    };
                    Arc::new(Moved(own.source.resolve::<S>(&at, context)?, by))
                }
            };
            wires.push(self.wire(Arc::new(source), target, Some((&path, own)), context)?);
        }
        if wires.is_empty() {
            return Err(ConstructError::new("wire", "there is no wire").with_hint(
                "add a table `[[warp.wire]]` with `source` and `target`, or name files as `source` and `target`",
            ));
        }
        Ok((wires, from_files))
    }
}

/// An error at the wire it is about; the first `from_files` wires are of files.
fn located(from_files: usize, error: &WireError) -> ConstructError {
    let at = |feature: &usize, key: &str| match feature.checked_sub(from_files) {
        Some(number) => format!("wire.{number}{key}"),
        None => "source".to_owned(),
    };
    let path = match error {
        WireError::None => "wire".to_owned(),
        WireError::NotFinite { feature, which } | WireError::NoLength { feature, which } => {
            at(feature, &format!(".{which}"))
        }
        WireError::Radius { feature, .. } => at(feature, ".radius"),
        WireError::Number { feature, what, .. } => at(feature, &format!(".{what}")),
        WireError::Falloff { feature, .. } => at(feature, ".falloff"),
        WireError::Sampling => "sampling".to_owned(),
        WireError::View => "view".to_owned(),
    };
    ConstructError::new(path, error.to_string())
}

const SINGH_FIUME: &str =
    "K. Singh and E. Fiume, Wires: A Geometric Deformation Technique, SIGGRAPH 1998";

/// The registry entry of wires.
pub(crate) fn wires<S: Rotational + InFamily>() -> WarpEntry<S> {
    fn construct<S: Rotational + InFamily>(
        value: &Value,
        context: &Context<'_, S>,
    ) -> Result<Built<S>, ConstructError> {
        let p: WiresParameters = parse(value)?;
        let (wires, from_files) = p.common().resolve::<S>(context)?;
        let warp = Wires::construct(wires, None).map_err(|e| located(from_files, &e))?;
        Ok(Built::new(warp.marks(), Box::new(warp)))
    }
    WarpEntry {
        kind: "wires",
        system: "B14",
        figure: "§4.4, Fig. 6",
        summary: "curves on a model are bent, and what is near follows",
        reference: SINGH_FIUME,
        example: if S::DIM == 2 {
            "radius = \"30%\"\n\
             [[wire]]\n\
             source = { points = [[\"10%\", \"40%\"], [\"50%\", \"40%\"], [\"90%\", \"40%\"]] }\n\
             target = { points = [[\"10%\", \"40%\"], [\"50%\", \"75%\"], [\"90%\", \"30%\"]] }\n"
        } else {
            "radius = \"30%\"\n\
             [[wire]]\n\
             source = { points = [[\"10%\", \"50%\", \"50%\"], [\"50%\", \"50%\", \"50%\"], [\"90%\", \"50%\", \"50%\"]] }\n\
             target = { points = [[\"10%\", \"40%\", \"50%\"], [\"50%\", \"85%\", \"50%\"], [\"90%\", \"50%\", \"80%\"]] }\n"
        },
        schema: WiresParameters::json_schema,
        construct: construct::<S>,
    }
}

/// The registry entry of continuous wires.
pub(crate) fn continuous<S: Rotational + InFamily>() -> WarpEntry<S> {
    fn construct<S: Rotational + InFamily>(
        value: &Value,
        context: &Context<'_, S>,
    ) -> Result<Built<S>, ConstructError> {
        let p: ContinuousParameters = parse(value)?;
        let (wires, from_files) = p.common().resolve::<S>(context)?;
        let sampling = p.sampling.map_or(Sampling::Uniform(64), Sampling::from);
        let warp = ContinuousWires::construct(wires, sampling, None)
            .map_err(|e| located(from_files, &e))?;
        Ok(Built::new(warp.marks(), Box::new(warp)))
    }
    WarpEntry {
        kind: "continuous-wires",
        system: "B15",
        figure: "§5.3, Fig. 16",
        summary: "wires that act from all of their length, and do not tear",
        reference: "Milliron, Jensen, Barzel and Finkelstein, A Framework for Geometric Warps and Deformations, ACM TOG \
                    21(1), 2002, §5.3",
        example: if S::DIM == 2 {
            "radius = \"35%\"\n\
             [[wire]]\n\
             source = { kind = \"bezier\", points = [[\"20%\", \"20%\"], [\"20%\", \"110%\"], [\"80%\", \"110%\"], [\"80%\", \"20%\"]] }\n\
             target = { kind = \"bezier\", points = [[\"20%\", \"0%\"], [\"20%\", \"110%\"], [\"80%\", \"110%\"], [\"80%\", \"40%\"]] }\n"
        } else {
            "radius = \"35%\"\n\
             [[wire]]\n\
             source = { kind = \"bezier\", points = [[\"20%\", \"20%\", \"50%\"], [\"20%\", \"110%\", \"50%\"], [\"80%\", \"110%\", \"50%\"], [\"80%\", \"20%\", \"50%\"]] }\n\
             target = { kind = \"bezier\", points = [[\"20%\", \"0%\", \"50%\"], [\"20%\", \"110%\", \"50%\"], [\"80%\", \"110%\", \"50%\"], [\"80%\", \"40%\", \"50%\"]] }\n"
        },
        schema: ContinuousParameters::json_schema,
        construct: construct::<S>,
    }
}

/// The registry entry of wires that keep depth.
pub(crate) fn depth() -> WarpEntry<Solid> {
    fn construct(
        value: &Value,
        context: &Context<'_, Solid>,
    ) -> Result<Built<Solid>, ConstructError> {
        let p: DepthParameters = parse(value)?;
        let view: Solid = p.view.resolve("view")?;
        let (wires, from_files) = p.common().resolve::<Solid>(context)?;
        let fail = |e: WireError| located(from_files, &e);
        match p.sampling.map(Sampling::from) {
            None => {
                let warp = Wires::construct(wires, Some(view)).map_err(fail)?;
                Ok(Built::new(warp.marks(), Box::new(warp)))
            }
            Some(sampling) => {
                let warp = ContinuousWires::construct(wires, sampling, Some(view)).map_err(fail)?;
                Ok(Built::new(warp.marks(), Box::new(warp)))
            }
        }
    }
    WarpEntry {
        kind: "depth-wires",
        system: "B16",
        figure: "§4.4, §5.2",
        summary: "wires seen along a direction: no point changes its depth",
        reference: "W. Corrêa, R. Jensen, C. Thayer and A. Finkelstein, Texture Mapping for Cel Animation, SIGGRAPH 1998",
        example: "view = \"z\"\nradius = \"35%\"\n\
                  [[wire]]\n\
                  source = { points = [[\"0%\", \"30%\", \"50%\"], [\"50%\", \"50%\", \"50%\"], [\"100%\", \"30%\", \"50%\"]] }\n\
                  target = { points = [[\"0%\", \"50%\", \"0%\"], [\"50%\", \"80%\", \"0%\"], [\"100%\", \"10%\", \"0%\"]] }\n",
        schema: DepthParameters::json_schema,
        construct,
    }
}
