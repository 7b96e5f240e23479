//! Fields read from a model: one number per index.
//!
//! *Source*: Milliron et al. 2002, §3.2: strength and weighting fields may depend on the index `u` of a model point
//! (painted weights, precomputed distances).

use crate::FieldError;
use anamorph_core::{Domain, Field, Site, Smoothness, Space, Support};
use std::sync::Arc;

/// A model's attribute: the value at index `u`; 0 at indices the attribute does not have.
///
/// It lives on the model, so that it has no spatial derivative and no continuity class. The values may be shared.
#[derive(Debug, Clone, PartialEq)]
pub struct Attribute {
    name: String,
    values: Arc<[f64]>,
}

impl Attribute {
    /// The attribute called `name` with one value per index, from 0.
    ///
    /// # Errors
    /// [`FieldError::BadAttribute`] with the first index whose value is not finite.
    pub fn new(name: impl Into<String>, values: impl Into<Arc<[f64]>>) -> Result<Self, FieldError> {
        let (name, values) = (name.into(), values.into());
        match values.iter().position(|v| !v.is_finite()) {
            Some(index) => Err(FieldError::BadAttribute { name, index }),
            None => Ok(Self { name, values }),
        }
    }
    /// The attribute's name.
    pub fn name(&self) -> &str {
        &self.name
    }
    /// How many indices have a value.
    pub fn len(&self) -> usize {
        self.values.len()
    }
    /// Whether no index has a value.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }
}

impl<S: Space> Field<S> for Attribute {
    fn value(&self, site: &Site<S>) -> f64 {
        self.values.get(site.index).copied().unwrap_or(0.0)
    }
    fn support(&self) -> Support<S> {
        if self.values.iter().all(|&v| v == 0.0) {
            Support::Nowhere
        } else {
            Support::Everywhere
        }
    }
    fn smoothness(&self) -> Smoothness {
        Smoothness::Jump
    }
    fn domain(&self) -> Domain {
        Domain::Model
    }
    fn values(&self, first: usize, points: &[S], values: &mut [f64]) {
        let known = self.values.get(first..).unwrap_or_default();
        let count = known.len().min(points.len()).min(values.len());
        values[..count].copy_from_slice(&known[..count]);
        values[count..].fill(0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::check_field;
    use anamorph_core::glam::DVec3;

    #[test]
    fn read_by_index_and_zero_beyond() {
        let paint = Attribute::new("paint", vec![0.5, 1.0, 0.25]).unwrap();
        let field: &dyn Field<DVec3> = &paint;
        assert_eq!(field.value(&Site::new(1, DVec3::ONE)), 1.0);
        assert_eq!(field.value(&Site::new(3, DVec3::ONE)), 0.0);
        let mut values = [7.0; 4];
        field.values(1, &[DVec3::ZERO; 4], &mut values);
        assert_eq!(values, [1.0, 0.25, 0.0, 0.0]);
        field.values(9, &[DVec3::ZERO; 4], &mut values);
        assert_eq!(values, [0.0; 4]);
        assert_eq!(field.domain(), Domain::Model);
        assert!(field.gradient(&Site::new(0, DVec3::ZERO), 1.0).is_none());
        check_field(field, 1.0);
    }

    #[test]
    fn the_first_bad_value_is_named() {
        let error = Attribute::new("w", vec![0.0, f64::NAN, f64::INFINITY]).unwrap_err();
        assert_eq!(
            error.to_string(),
            "attribute `w`: the value at index 1 is not finite"
        );
    }
}
