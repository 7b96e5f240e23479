//! Random and hard curves that several tests share.

#![allow(dead_code, unreachable_pub, clippy::unwrap_used, clippy::panic)]

use anamorph_core::glam::{DVec2, DVec3, dvec2, dvec3};

/// Numbers that look random, the same in every run (Marsaglia's xorshift).
pub struct Random(pub u64);

impl Random {
    /// A number in `[0, 1)`.
    pub fn unit(&mut self) -> f64 {
        // Small seeds would give small first numbers.
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
    /// A number in `[low, high)`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }
    /// A point of the unit square.
    pub fn plane(&mut self) -> DVec2 {
        dvec2(self.unit(), self.unit())
    }
    /// A point of the unit cube.
    pub fn solid(&mut self) -> DVec3 {
        dvec3(self.unit(), self.unit(), self.unit())
    }
}

/// Bézier points of the curve from the origin with velocity `a + bt + ct²`.
pub fn from_velocity(a: DVec2, b: DVec2, c: DVec2) -> [DVec2; 4] {
    let p1 = a / 3.0;
    let p2 = p1 + a / 3.0 + b / 6.0;
    [DVec2::ZERO, p1, p2, a + b / 2.0 + c / 3.0]
}

/// Cubics that methods stumble over: cusps, near-cusps at all distances and places, loops, doubled and collinear control
/// points, turns on a line, points.
pub fn hard() -> Vec<[DVec2; 4]> {
    let p = |list: [(f64, f64); 4]| list.map(|(x, y)| dvec2(x, y));
    let mut curves = vec![
        p([(0.0, 0.0), (1.0, 1.0), (0.0, 1.0), (1.0, 0.0)]),
        p([(0.0, 0.0), (2.0, 1.0), (-1.0, 1.0), (1.0, 0.0)]),
        p([(0.0, 0.0), (0.0, 0.0), (1.0, 1.0), (1.0, 1.0)]),
        p([(0.0, 0.0), (0.0, 0.0), (0.0, 0.0), (1.0, 2.0)]),
        p([(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (3.0, 0.0)]),
        p([(0.0, 0.0), (3.0, 0.0), (-2.0, 0.0), (1.0, 0.0)]),
        p([(0.0, 0.0), (4.0, 4.0), (4.0, 4.0), (0.0, 0.0)]),
        p([(0.0, 0.0), (1.0, 0.0), (1.0, 0.0), (2.0, 0.0)]),
        p([(1.0, 2.0); 4]),
    ];
    for i in 0..45 {
        let d = 0.5_f64.powi(i);
        for sign in [d, -d] {
            curves.push(p([(0.0, 0.0), (1.0, 1.0), (sign, 1.0), (1.0, 0.0)]));
            curves.push(p([(0.0, 0.0), (3.0, sign), (-2.0, 0.0), (1.0, 0.0)]));
            curves.push(p([(0.0, 0.0), (sign, 0.0), (1.0, sign), (1.0, 1.0)]));
        }
    }
    let mut random = Random(7);
    for _ in 0..4000 {
        let (at, size) = (
            random.between(-0.1, 1.1),
            0.1_f64.powf(12.0 * random.unit()),
        );
        let (a, b) = (random.plane() - 0.5, random.plane() - 0.5);
        let off = DVec2::from_angle(7.0 * random.unit()) * size;
        curves.push(from_velocity(a * -at + off, a - b * at, b));
    }
    curves
}

/// The plane at a slant in space.
pub fn slanted(p: DVec2) -> DVec3 {
    let (u, v) = (dvec3(2.0, -1.0, 2.0) / 3.0, dvec3(2.0, 2.0, -1.0) / 3.0);
    u * p.x + v * p.y + dvec3(0.5, -3.0, 1.0)
}

/// The length of a cubic by tanh–sinh quadrature between the places where it is slowest, independent of the crate.
pub fn exact_length(points: &[DVec3; 4]) -> f64 {
    let [p0, p1, p2, p3] = *points;
    let (a, b, c) = (
        (p1 - p0) * 3.0,
        (p0 - p1 * 2.0 + p2) * 6.0,
        (p3 - p2 * 3.0 + p1 * 3.0 - p0) * 3.0,
    );
    let speed = |t: f64| (a + (b + c * t) * t).length();
    // Where the derivative of the squared speed changes sign.
    let slope = |t: f64| (a + (b + c * t) * t).dot(b + c * (2.0 * t));
    let mut cuts = vec![0.0];
    let steps = 4096;
    for i in 0..steps {
        let (mut low, mut high) = (
            f64::from(i) / f64::from(steps),
            f64::from(i + 1) / f64::from(steps),
        );
        if (slope(low) < 0.0) != (slope(high) < 0.0) {
            let rising = slope(low) < 0.0;
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if (slope(middle) < 0.0) == rising {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            cuts.push(0.5 * (low + high));
        }
    }
    cuts.push(1.0);
    let mut sum = 0.0;
    for w in cuts.windows(2) {
        let (low, width) = (w[0], w[1] - w[0]);
        // The step is fine enough for near-cusps: the substitution puts half its nodes next to the ends.
        let h = 1.0 / 64.0;
        let mut part = 0.0;
        for k in -320..=320_i32 {
            let x = f64::from(k) * h;
            let u = std::f64::consts::FRAC_PI_2 * x.sinh();
            let weight = std::f64::consts::FRAC_PI_2 * x.cosh() / (u.cosh() * u.cosh()) * 0.5;
            let t = 1.0 / (1.0 + (-2.0 * u).exp());
            // From the nearer end, which keeps the digits of both.
            let at = if t < 0.5 {
                low + width * t
            } else {
                w[1] - width / (1.0 + (2.0 * u).exp())
            };
            part += weight * speed(at);
        }
        sum += part * h * width;
    }
    sum
}
