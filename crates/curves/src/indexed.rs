//! A curve with its index for nearest points.
//!
//! *Source*: Milliron et al., 2002, §4.4: features that are curves ask for the nearest point of each of a model's points
//! (errata F10). The index is [`NearestTable`].

use crate::{NearestTable, Pieces};
use anamorph_core::{Curve, Differentiable, Jet, Nearest, NearestPoint, Space};
use core::ops::Deref;

/// A curve, held by any handle (`Box`, `Arc`, `&`), that answers nearest-point questions from a table prepared once.
///
/// ```
/// use anamorph_core::{NearestPoint, glam::dvec2};
/// use anamorph_curves::{Indexed, families::{CatmullRom, Generator}};
///
/// let curve = CatmullRom::new(vec![dvec2(0.0, 0.0), dvec2(1.0, 0.0), dvec2(2.0, 0.0)]).curve()?;
/// let wire = Indexed::new(Box::new(curve));
/// assert!((wire.nearest(dvec2(0.5, 3.0)).distance - 3.0).abs() < 1e-12);
/// assert!(wire.nearest_within(dvec2(0.5, 3.0), 1.0).is_none());
/// # Ok::<(), anamorph_curves::CurveError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Indexed<S, P> {
    curve: P,
    table: NearestTable<S>,
}

impl<S: Space, P: Deref<Target: Pieces<S>>> Indexed<S, P> {
    /// Prepares the table.
    pub fn new(curve: P) -> Self {
        let table = NearestTable::new(&*curve);
        Self { curve, table }
    }

    /// The curve.
    pub fn curve(&self) -> &P::Target {
        &self.curve
    }

    /// The handle of the curve.
    pub fn handle(&self) -> &P {
        &self.curve
    }

    /// The table.
    pub fn table(&self) -> &NearestTable<S> {
        &self.table
    }
}

impl<S: Space, P: Deref<Target: Pieces<S>> + Send + Sync> Curve<S> for Indexed<S, P> {
    fn domain(&self) -> (f64, f64) {
        self.curve.domain()
    }
    fn point(&self, parameter: f64) -> S {
        self.curve.point(parameter)
    }
    fn is_closed(&self) -> bool {
        self.curve.is_closed()
    }
}

impl<S: Space, P: Deref<Target: Pieces<S>> + Send + Sync> Differentiable<S> for Indexed<S, P> {
    fn jet(&self, parameter: f64) -> Jet<S> {
        self.curve.jet(parameter)
    }
    fn velocity(&self, parameter: f64) -> S {
        self.curve.velocity(parameter)
    }
    fn breaks(&self) -> Vec<f64> {
        self.curve.breaks()
    }
}

impl<S: Space, P: Deref<Target: Pieces<S>> + Send + Sync> NearestPoint<S> for Indexed<S, P> {
    fn nearest(&self, to: S) -> Nearest<S> {
        self.table.nearest(to)
    }
    fn nearest_within(&self, to: S, reach: f64) -> Option<Nearest<S>> {
        self.table.nearest_within(to, reach)
    }
}
