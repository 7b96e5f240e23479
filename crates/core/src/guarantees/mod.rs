//! What a deformation promises: verdicts with their evidence.
//!
//! *Source*: Milliron et al. 2002, §7 (commutativity, interpolation, continuity, invertibility); errata F3, F4, F15.
//! A verdict is *proved*, *refuted* by a witness, or *unknown*; a sampled search can refute, never prove.

mod commutation;
mod folds;
mod inversion;
mod jumps;

pub use commutation::{commutation, commutes_with_itself};
pub use folds::{ON_THE_MODEL, no_fold, safe_strength};
pub use inversion::invertibility;
pub use jumps::{ambient_repair, continuity_of};

use crate::{Condition, Deformation, Influences, Site, Smoothness, Space, Warp};

/// A property one may want of a deformation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Property {
    /// Source features land on their targets.
    Interpolation,
    /// The moved point is continuous in space (class named in the statement).
    Continuity,
    /// Every point of the model has a feature that tells it where to go (errata F14).
    Coverage,
    /// The Jacobian determinant is positive: no fold-over.
    NoFold,
    /// The deformation has an inverse.
    Invertibility,
    /// Two deformations may change places.
    Commutation,
}

impl Property {
    /// Every property, in the order of a report.
    pub const ALL: [Self; 6] = [
        Self::Interpolation,
        Self::Coverage,
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
            Self::Coverage => "coverage",
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
    /// The measured number there (an error in scene units, a determinant, a jump in scene units).
    pub value: f64,
    /// A second place that belongs to it: the other side of a jump, the other place with the same image.
    pub other: Option<S>,
}

impl<S> Witness<S> {
    /// A number at a place.
    pub fn new(place: S, value: f64) -> Self {
        Self {
            place,
            value,
            other: None,
        }
    }
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
    /// What else was found out, as a name and a sentence each: how strong the warp may be, what repairs it at which price.
    pub details: Vec<(&'static str, String)>,
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
            details: Vec::new(),
        }
    }

    /// Adds what else was found out.
    #[must_use]
    pub fn with_detail(mut self, name: &'static str, sentence: impl Into<String>) -> Self {
        self.details.push((name, sentence.into()));
        self
    }
}

/// Continuity from the declared facts (§7.3 with errata F4), of all three kinds. Declared classes are lower bounds.
pub fn continuity<S: Space, D: Deformation<S> + ?Sized>(deformation: &D) -> Guarantee<S> {
    let facts = deformation.facts();
    let guarantee =
        |verdict, statement: String| Guarantee::new(Property::Continuity, verdict, statement, None);
    if deformation.domain() == crate::Domain::Model {
        let statement =
            "depends on a field that lives on the model: no continuity in space can be stated";
        return guarantee(Verdict::Unknown, statement.to_owned()).with_detail(
            "with respect to the model",
            "as continuous over the model as the values that the model carries",
        );
    }
    let class = facts.smoothness();
    let found = if facts.inside == Smoothness::Jump {
        guarantee(
            Verdict::Unknown,
            "may jump: a field of the warp is not continuous".to_owned(),
        )
    } else if facts.inside == facts.edge {
        guarantee(
            Verdict::Proved,
            format!("at least {} everywhere", facts.inside),
        )
    } else if facts.edge == Smoothness::Jump {
        guarantee(
            Verdict::Unknown,
            format!(
                "at least {} inside its support; may jump at the edge of the support",
                facts.inside
            ),
        )
    } else {
        guarantee(
            Verdict::Proved,
            format!(
                "at least {} inside its support and {} across its edge",
                facts.inside, facts.edge
            ),
        )
    };
    if class == Smoothness::Jump {
        return found;
    }
    found
        .with_detail(
            "deforming function",
            format!("at least {class} with respect to space"),
        )
        .with_detail(
            "deformed model",
            match class {
                Smoothness::Smooth => "as continuous as the model itself".to_owned(),
                _ => format!("a model that is {class} or better stays at least {class}"),
            },
        )
        .with_detail(
            "with respect to the model",
            format!("along the model the deforming function is as continuous as the model, up to {class}"),
        )
}

/// Whether every point of a model is told where to go: where all weights vanish, the model stays behind (errata F4, F14).
///
/// `whole` is the number of the model's points: where fewer are given, all of which feel a feature, nothing is proved of the rest.
pub fn coverage<S: Space, W: Warp<S> + ?Sized>(
    warp: &W,
    points: &[S],
    whole: usize,
) -> Guarantee<S> {
    let mut list = Influences::default();
    let (mut uncovered, mut first) = (0_usize, None);
    for (index, &place) in points.iter().enumerate() {
        list.clear();
        warp.influences(&Site::new(index, place), &mut list);
        // A weight that follows the displacement is finished later; what has a term is told where to go.
        if !list.list.iter().any(|i| i.weight > 0.0) {
            uncovered += 1;
            first = first.or(Some(Witness::new(place, 0.0)));
        }
    }
    let count = points.len();
    if count == 0 {
        let statement = "not examined: no points were given";
        return Guarantee::new(Property::Coverage, Verdict::Unknown, statement, None);
    }
    if uncovered == 0 && count < whole {
        let statement =
            format!("the {count} points looked at feel a feature, of {whole} of the model");
        return Guarantee::new(Property::Coverage, Verdict::Unknown, statement, None);
    }
    if uncovered == 0 {
        let statement = format!("all {count} points of the model feel a feature");
        return Guarantee::new(Property::Coverage, Verdict::Proved, statement, None);
    }
    let of = if count < whole {
        "points looked at"
    } else {
        "points of the model"
    };
    let statement = format!("{uncovered} of {count} {of} feel no feature and stay where they are");
    Guarantee::new(Property::Coverage, Verdict::Refuted, statement, first)
}

/// Two features that have a source point in common and take it to different places, if there are any: neither is met there, but their
/// average. The first such pair in the order of the conditions, and the point.
pub fn disagreement<S: Space>(conditions: &[Condition<S>]) -> Option<(u32, u32, S)> {
    let mut order: Vec<&Condition<S>> = conditions.iter().collect();
    let compare = |a: S, b: S| {
        let axes = (0..S::DIM).map(|axis| a.component(axis).total_cmp(&b.component(axis)));
        axes.fold(core::cmp::Ordering::Equal, core::cmp::Ordering::then)
    };
    order.sort_by(|a, b| compare(a.source, b.source));
    let pairs = order.windows(2).filter(|pair| {
        let [a, b] = [pair[0], pair[1]];
        a.source == b.source && a.target != b.target && a.feature != b.feature
    });
    let named = pairs.map(|pair| {
        let (a, b) = (pair[0].feature, pair[1].feature);
        (a.min(b), a.max(b), pair[0].source)
    });
    named.min_by_key(|(a, b, _)| (*a, *b))
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
    let mut worst = (0_u32, Witness::new(conditions[0].source, -1.0));
    for condition in conditions {
        let error = deformation
            .map(&Site::anywhere(condition.source))
            .distance(condition.target);
        if error > worst.1.value || error.is_nan() {
            worst = (condition.feature, Witness::new(condition.source, error));
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
    let statement = if witness.value.is_finite() {
        let miss = rounded(witness.value);
        format!("approximate: feature {feature} misses its target by {miss}")
    } else {
        format!(
            "feature {feature} goes to a place that is not finite: its numbers are too large or too small"
        )
    };
    Guarantee::new(
        Property::Interpolation,
        Verdict::Refuted,
        statement,
        Some(witness),
    )
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
