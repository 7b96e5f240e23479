//! `fit`: the targets of a warp from where places of the model are to go.
//!
//! *Source*: W. M. Hsu, J. F. Hughes, H. Kaufman, *Direct Manipulation of Free-Form Deformations*, SIGGRAPH 1992, for every warp that is linear
//! in its targets; see [`anamorph_core::fit`]. The notation is a decision.

use anamorph_catalog::schemars::{self, JsonSchema};
use anamorph_catalog::{
    Built, ConstructError, Context, FeatureMesh, Offset, Place, Value, parse, source_and_target,
};
use anamorph_core::{FitError, Fitted, Mark, Pin, Role, Shape, Space, Warp, fit};
use serde::Deserialize;

/// Targets that go so many times as far as any pin are worth a word.
const WILD: f64 = 30.0;

/// A place and where it is to go.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct PinParameters {
    /// The place.
    from: Place,
    /// Where it is to go.
    to: Option<Place>,
    /// The offset to there, instead of `to`. With neither the place is to stay.
    by: Option<Offset>,
    /// How much it counts among the others, 1 if left out.
    weight: Option<f64>,
}

/// Where places of the model are to go: the warp's targets are found from that.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct FitParameters {
    /// The places; those of the files come before them.
    #[serde(default)]
    pin: Vec<PinParameters>,
    /// A file with places.
    source: Option<String>,
    /// A file with where they are to go, one for each in the same order.
    target: Option<String>,
    /// How much the changes of targets count against misses: 0, if left out, meets the pins if they can be met.
    stiffness: Option<f64>,
}

/// The points of a file, one for each axis of the space.
fn points<S: Space>(path: &str, name: &str, file: &FeatureMesh) -> Result<Vec<S>, ConstructError> {
    if file.dimension > S::DIM {
        let message = format!("{name} has points with {} coordinates", file.dimension);
        return Err(ConstructError::new(path, message)
            .with_hint(format!("this recipe is used in the {}", S::NAME)));
    }
    let point = |p: &anamorph_core::glam::DVec3| S::from_fn(|axis| p[axis]);
    Ok(file.points.iter().map(point).collect())
}

impl FitParameters {
    fn pins<S: Space>(&self, context: &Context<'_, S>) -> Result<Vec<Pin<S>>, ConstructError> {
        let mut pins = Vec::new();
        let both = source_and_target(self.source.as_ref(), self.target.as_ref())?;
        if let Some((source, target)) = both {
            let sources = points::<S>("source", source, &*context.mesh("source", source)?)?;
            let targets = points::<S>("target", target, &*context.mesh("target", target)?)?;
            if sources.len() != targets.len() {
                let message = format!(
                    "{source} has {} points and {target} {}",
                    sources.len(),
                    targets.len()
                );
                return Err(ConstructError::new("target", message)
                    .with_hint("give one target for each place, in the same order"));
            }
            let both = sources.into_iter().zip(targets);
            pins.extend(both.map(|(source, target)| Pin {
                source,
                target,
                weight: 1.0,
            }));
        }
        for (number, pin) in self.pin.iter().enumerate() {
            let path = format!("pin.{number}");
            let source: S = pin.from.resolve(&format!("{path}.from"), context)?;
            let target = match (&pin.to, &pin.by) {
                (Some(_), Some(_)) => {
                    return Err(ConstructError::new(
                        format!("{path}.by"),
                        "both `to` and `by` are given",
                    )
                    .with_hint("write where it goes with `to`, or how far with `by`"));
                }
                (Some(to), None) => to.resolve(&format!("{path}.to"), context)?,
                (None, Some(by)) => source + by.resolve(&format!("{path}.by"), context)?,
                (None, None) => source,
            };
            let weight = pin.weight.unwrap_or(1.0);
            pins.push(Pin {
                source,
                target,
                weight,
            });
        }
        Ok(pins)
    }

    /// Where an error of fitting is, and what it says.
    fn located(&self, pins: usize, error: FitError) -> ConstructError {
        let from_files = pins - self.pin.len();
        let at = |pin: usize| match pin.checked_sub(from_files) {
            Some(number) => format!("pin.{number}"),
            None => "source".to_owned(),
        };
        let (path, hint) = match error {
            FitError::NoPins => (
                String::new(),
                "add a table `[[warp.fit.pin]]` with `from` and `to`, or name files as `source` and `target`",
            ),
            FitError::Number { pin } => (at(pin), "give finite numbers, and a weight above 0"),
            FitError::Stiffness { .. } => ("stiffness".to_owned(), ""),
            FitError::OutOfReach { pin } => (
                at(pin),
                "move the pin to where the warp reaches, make the warp larger, or give it strength and weight there",
            ),
            FitError::NotLinear => (String::new(), "fit another warp, such as a lattice"),
        };
        ConstructError::new(path, error.to_string()).with_hint(hint)
    }
}

/// Adds the fields of a table to a warp.
pub(crate) type Finish<'a, S> =
    dyn FnMut(Box<dyn Warp<S>>) -> Result<Box<dyn Warp<S>>, ConstructError> + 'a;

/// The warp of a table with the targets that its `fit` asks for. `finish` adds the table's fields.
pub(crate) fn fitted<S: Space>(
    value: &Value,
    kind: &str,
    built: Built<S>,
    context: &Context<'_, S>,
    finish: &mut Finish<'_, S>,
) -> Result<Built<S>, ConstructError> {
    let parameters: FitParameters = parse(value).map_err(|e| e.under("fit"))?;
    let Some(refit) = built.refit else {
        let message =
            format!("`{kind}` cannot be fitted: its images are not linear in its targets");
        return Err(ConstructError::new("fit", message)
            .with_hint("fit a warp that can, such as `lattice`, `spline-lattice` or `points`"));
    };
    let pins = parameters.pins(context).map_err(|e| e.under("fit"))?;
    let located = |error| parameters.located(pins.len(), error).under("fit");
    let stiffness = parameters.stiffness.unwrap_or(0.0);
    let rest = finish(built.warp)?;
    let changes = fit(&rest, refit.targets, &pins, stiffness).map_err(located)?;
    let mut built = (refit.with)(&changes)?;
    // Whoever says where places go wants to see these, not what was found for it.
    let marks = pins.iter().flat_map(|pin| {
        let arrow = Shape::Arrow(pin.source, pin.target);
        [
            Some(Mark::new(Role::Source, Shape::Point(pin.source))),
            (pin.source != pin.target).then(|| Mark::new(Role::Source, arrow)),
            Some(Mark::new(Role::Target, Shape::Point(pin.target))),
        ]
    });
    built.marks = marks.flatten().collect();
    let length = |v: &S| v.length();
    let far = changes.iter().map(length).fold(0.0, f64::max);
    let asked = pins.iter().map(|pin| pin.source.distance(pin.target));
    let asked = asked.fold(0.0, f64::max);
    let mut fitted = Fitted::new(finish(built.warp)?, pins);
    if far > WILD * asked {
        fitted = fitted.with_note(
            "targets had to go much farther than any pin, as pins that are close to each other part; a `stiffness` such as 0.001 tames that",
        );
    }
    built.warp = Box::new(fitted);
    Ok(built)
}
