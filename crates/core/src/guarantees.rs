//! What a deformation promises: verdicts with their evidence.
//!
//! *Source*: Milliron et al. 2002, §7 (commutativity, interpolation, continuity, invertibility); errata F3, F4, F15.
//! A verdict is *proved*, *refuted* by a witness, or *unknown*; a sampled search can refute, never prove.

use crate::{Condition, Deformation, Linear, Site, Smoothness, Space, Warp};

/// A property one may want of a deformation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Property {
    /// Source features land on their targets.
    Interpolation,
    /// The moved point is continuous in space (class named in the statement).
    Continuity,
    /// The Jacobian determinant is positive: no fold-over.
    NoFold,
    /// The deformation has an inverse.
    Invertibility,
    /// Two deformations may change places.
    Commutation,
}

impl Property {
    /// Every property, in the order of a report.
    pub const ALL: [Self; 5] = [
        Self::Interpolation,
        Self::Continuity,
        Self::NoFold,
        Self::Invertibility,
        Self::Commutation,
    ];

    /// Its name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Interpolation => "interpolation",
            Self::Continuity => "continuity",
            Self::NoFold => "no fold",
            Self::Invertibility => "invertibility",
            Self::Commutation => "commutation",
        }
    }
}

/// How a question was decided.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// It holds, by derivation or by an exact check of all cases.
    Proved,
    /// It does not hold; a witness shows it.
    Refuted,
    /// Not decided.
    Unknown,
}

impl Verdict {
    /// Its name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Proved => "proved",
            Self::Refuted => "refuted",
            Self::Unknown => "unknown",
        }
    }
}

/// A place that shows something.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Witness<S> {
    /// The place before the deformation.
    pub place: S,
    /// The measured number there (an error in scene units, a determinant).
    pub value: f64,
}

/// One property, decided.
#[derive(Debug, Clone, PartialEq)]
pub struct Guarantee<S> {
    /// Which property.
    pub property: Property,
    /// How it was decided.
    pub verdict: Verdict,
    /// What exactly was decided, in a sentence.
    pub statement: String,
    /// A place that shows a refutation, or the worst place found.
    pub witness: Option<Witness<S>>,
}

impl<S> Guarantee<S> {
    fn new(
        property: Property,
        verdict: Verdict,
        statement: impl Into<String>,
        witness: Option<Witness<S>>,
    ) -> Self {
        Self {
            property,
            verdict,
            statement: statement.into(),
            witness,
        }
    }
}

/// Continuity from the declared facts (§7.3 with errata F4). Declared classes are lower bounds.
pub fn continuity<S: Space, D: Deformation<S> + ?Sized>(deformation: &D) -> Guarantee<S> {
    let facts = deformation.facts();
    let (verdict, statement) = if deformation.domain() == crate::Domain::Model {
        (
            Verdict::Unknown,
            "depends on a field that lives on the model: no continuity in space can be stated"
                .to_owned(),
        )
    } else if facts.inside == Smoothness::Jump {
        (
            Verdict::Unknown,
            "may jump: a field of the warp is not continuous".to_owned(),
        )
    } else if facts.inside == facts.edge {
        (
            Verdict::Proved,
            format!("at least {} everywhere", facts.inside),
        )
    } else if facts.edge == Smoothness::Jump {
        (
            Verdict::Unknown,
            format!(
                "at least {} inside its support; may jump at the edge of the support",
                facts.inside
            ),
        )
    } else {
        (
            Verdict::Proved,
            format!(
                "at least {} inside its support and {} across its edge",
                facts.inside, facts.edge
            ),
        )
    };
    Guarantee::new(Property::Continuity, verdict, statement, None)
}

/// Interpolation by measuring every condition the warp names (errata F15). `size` is the model's size in scene units; an
/// error below 1e-9 of it counts as exact.
pub fn interpolation<S: Space, W: Warp<S> + ?Sized>(warp: &W, size: f64) -> Guarantee<S> {
    interpolation_of(warp, &warp.conditions(), size)
}

/// As [`interpolation`], of any deformation against given conditions: what a mask or a stack leaves of a warp's promise.
pub fn interpolation_of<S: Space, D: Deformation<S> + ?Sized>(
    deformation: &D,
    conditions: &[Condition<S>],
    size: f64,
) -> Guarantee<S> {
    if conditions.is_empty() {
        let statement = "the warp names no source point that should land on a target";
        return Guarantee::new(Property::Interpolation, Verdict::Unknown, statement, None);
    }
    if deformation.domain() == crate::Domain::Model {
        let statement = "a field lives on the model, so that the warp has no value at its features";
        return Guarantee::new(Property::Interpolation, Verdict::Unknown, statement, None);
    }
    let mut worst = (
        0_u32,
        Witness {
            place: conditions[0].source,
            value: -1.0,
        },
    );
    for condition in conditions {
        let error = deformation
            .map(&Site::anywhere(condition.source))
            .distance(condition.target);
        if error > worst.1.value || error.is_nan() {
            worst = (
                condition.feature,
                Witness {
                    place: condition.source,
                    value: error,
                },
            );
        }
    }
    let (feature, witness) = worst;
    let tolerance = 1e-9 * if size > 0.0 { size } else { 1.0 };
    if witness.value <= tolerance {
        let statement = if conditions.len() == 1 {
            "exact at its source point".to_owned()
        } else {
            format!("exact at all {} source points", conditions.len())
        };
        return Guarantee::new(
            Property::Interpolation,
            Verdict::Proved,
            statement,
            Some(witness),
        );
    }
    let statement = format!(
        "approximate: feature {feature} misses its target by {}",
        rounded(witness.value)
    );
    Guarantee::new(
        Property::Interpolation,
        Verdict::Refuted,
        statement,
        Some(witness),
    )
}

/// Fold-over by the Jacobian determinants at a model's points: a determinant that is not positive refutes; otherwise the
/// question stays open, with the smallest determinant found.
pub fn no_fold<S: Space, D: Deformation<S> + ?Sized>(
    deformation: &D,
    points: &[S],
    size: f64,
) -> Guarantee<S> {
    let mut worst: Option<Witness<S>> = None;
    for (index, &place) in points.iter().enumerate() {
        let Some(jacobian) = deformation.jacobian(&Site::new(index, place), size) else {
            let statement = "depends on a field that lives on the model: there is no Jacobian";
            return Guarantee::new(Property::NoFold, Verdict::Unknown, statement, None);
        };
        let value = jacobian.determinant();
        if worst.is_none_or(|w| value < w.value || w.value.is_nan()) {
            worst = Some(Witness { place, value });
        }
    }
    match worst {
        None => Guarantee::new(
            Property::NoFold,
            Verdict::Unknown,
            "not examined: no points were given",
            None,
        ),
        Some(w) if w.value <= 0.0 => {
            let statement = format!(
                "folds: the Jacobian determinant is {} at a point of the model",
                rounded(w.value)
            );
            Guarantee::new(Property::NoFold, Verdict::Refuted, statement, worst)
        }
        Some(w) => {
            let statement = format!(
                "no fold at the model's points: smallest Jacobian determinant {}",
                rounded(w.value)
            );
            Guarantee::new(Property::NoFold, Verdict::Unknown, statement, worst)
        }
    }
}

/// Properties that no search has been made for.
pub fn undecided<S>(property: Property) -> Guarantee<S> {
    Guarantee::new(property, Verdict::Unknown, "not examined", None)
}

/// A number with four significant digits for a sentence.
fn rounded(value: f64) -> String {
    if value == 0.0 || (1e-3..1e5).contains(&value.abs()) {
        let text = format!("{value:.4}");
        let text = text.trim_end_matches('0').trim_end_matches('.');
        text.to_owned()
    } else {
        format!("{value:.3e}")
    }
}
