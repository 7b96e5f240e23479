//! Random numbers for the tests.

use anamorph_core::{Field, Site, Space};

/// Marsaglia's xorshift generator, seeded: the same numbers in every run.
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        low + (high - low) * ((self.0 >> 11) as f64 / (1_u64 << 53) as f64)
    }
    pub(crate) fn vector<S: Space>(&mut self) -> S {
        S::from_fn(|_| self.between(-1.0, 1.0))
    }
}

/// The laws of fields in space: batches equal single values bit for bit, the value is 0 outside the support and never
/// NaN, and the gradient is that of the values. Points are drawn from a cube of half-edge `size`.
pub(crate) fn check_field<S: Space>(field: &dyn Field<S>, size: f64) {
    let mut random = Random::new(77);
    let mut points: Vec<S> = (0..1500).map(|_| random.vector::<S>() * size).collect();
    points.push(S::ZERO);
    points.push(S::splat(1e200));
    let mut values = vec![f64::NAN; points.len()];
    field.values(3, &points, &mut values);
    let mut checked = 0;
    for (i, &p) in points.iter().enumerate() {
        let site = Site::new(3 + i, p);
        let value = field.value(&site);
        assert_eq!(value.to_bits(), values[i].to_bits(), "at {p:?}");
        assert!(!value.is_nan(), "at {p:?}");
        assert!(field.support().contains(p) || value == 0.0, "at {p:?}");
        if p.largest() > 1e3 || !value.is_finite() {
            continue;
        }
        let Some(gradient) = field.gradient(&site, size) else {
            continue;
        };
        // One-sided differences on both sides, so that creases excuse themselves.
        let mut slopes = [S::ZERO; 2];
        for (slope, h) in slopes.iter_mut().zip([1e-6 * size, -1e-6 * size]) {
            *slope = S::from_fn(|axis| {
                (field.value(&Site::new(3 + i, p + S::unit(axis) * h)) - value) / h
            });
        }
        if (slopes[0] - slopes[1]).largest() < 1e-3 * (1.0 + slopes[0].largest()) {
            let mean = (slopes[0] + slopes[1]) * 0.5;
            let error = (mean - gradient).largest();
            assert!(error < 1e-3 * (1.0 + mean.largest()), "{error} at {p:?}");
            checked += 1;
        }
    }
    assert!(checked > 500 || field.gradient(&Site::anywhere(S::ZERO), size).is_none());
}
