//! The zeros of the squared speed of a cubic, which decide how hard its length is to measure.
//!
//! *Source*: W. Press et al., *Numerical Recipes*, 3rd ed., 2007, §5.6 (quadratic equations without cancellation, also with
//! complex coefficients) and §9.5 (Bairstow's method). See [`cubic`](super::cubic) for what they are good for.

/// Zeros further away than this, in units of the curve's parameter, are as good as none.
const FAR: f64 = 1e6;

/// Real and imaginary part.
pub(super) type Complex = (f64, f64);

#[inline(always)]
fn product(a: Complex, b: Complex) -> Complex {
    (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0)
}

#[inline(always)]
fn quotient(a: Complex, b: Complex) -> Complex {
    let per = 1.0 / (b.0 * b.0 + b.1 * b.1);
    ((a.0 * b.0 + a.1 * b.1) * per, (a.1 * b.0 - a.0 * b.1) * per)
}

/// A square root with non-negative real part. Without branches: it is computed for many at once.
#[inline(always)]
fn root(a: Complex) -> Complex {
    let larger =
        ((a.0 * a.0 + a.1 * a.1).sqrt() + a.0.abs()).sqrt() * core::f64::consts::FRAC_1_SQRT_2;
    let smaller = a.1.abs() / (2.0 * larger.max(f64::MIN_POSITIVE));
    let right = a.0 >= 0.0;
    let (x, y) = (
        if right { larger } else { smaller },
        if right { smaller } else { larger },
    );
    (x, if a.1 < 0.0 { -y } else { y })
}

/// Brings zeros at infinity, or nowhere, to a bound, and all to the upper half-plane.
#[inline(always)]
fn bounded(zero: Complex) -> Complex {
    let bound = |c: f64| if c.abs() < FAR { c } else { FAR };
    (bound(zero.0), bound(zero.1).abs())
}

/// Zeros of the velocity of a plane curve as a complex polynomial. The squared speed is its product with its conjugate.
#[inline(always)]
pub(super) fn plane_zeros([x, y]: [[f64; 3]; 2]) -> [Complex; 2] {
    let (z0, z1, z2) = ((x[0], y[0]), (x[1], y[1]), (x[2], y[2]));
    let square = product(z1, z1);
    let fourth = product(z0, z2);
    let r = root((square.0 - 4.0 * fourth.0, square.1 - 4.0 * fourth.1));
    // The sum without cancellation; the other zero from the product of both.
    let same = z1.0 * r.0 + z1.1 * r.1 >= 0.0;
    let r = (if same { r.0 } else { -r.0 }, if same { r.1 } else { -r.1 });
    let w = (-0.5 * (z1.0 + r.0), -0.5 * (z1.1 + r.1));
    [bounded(quotient(z0, w)), bounded(quotient(w, z2))]
}

/// Curves whose zeros are computed together.
pub(super) const LANES: usize = 8;

/// Zeros of plane curves, by coordinates of zeros: `[re, im, re, im]`.
#[inline(always)]
pub(super) fn plane_zeros_of(x: &[[f64; LANES]; 3], y: &[[f64; LANES]; 3]) -> [[f64; LANES]; 4] {
    let mut out = [[0.0; LANES]; 4];
    for i in 0..LANES {
        let zeros = plane_zeros([[x[0][i], x[1][i], x[2][i]], [y[0][i], y[1][i], y[2][i]]]);
        out[0][i] = zeros[0].0;
        out[1][i] = zeros[0].1;
        out[2][i] = zeros[1].0;
        out[3][i] = zeros[1].1;
    }
    out
}

/// Steps of Bairstow's method; from a good start three to six are enough.
const BAIRSTOW: usize = 24;

/// Zeros of the squared speed of a space curve, from those of its projection along the axis that matters least: one pair of
/// conjugate zeros as a quadratic factor by Bairstow's method (which, unlike zeros themselves, is well determined also where
/// both are nearly real), the other from the quotient. `None` where the method did not settle.
pub(super) fn space_zeros(axes: &[[f64; 3]; 3]) -> Option<[Complex; 2]> {
    let weight = |a: &[f64; 3]| a[0].abs() + a[1].abs() + a[2].abs();
    let least = (0..3).min_by(|i, j| weight(&axes[*i]).total_cmp(&weight(&axes[*j])))?;
    let start = plane_zeros([axes[(least + 1) % 3], axes[(least + 2) % 3]]);
    if weight(&axes[least]) == 0.0 {
        return Some(start);
    }
    // Coefficients of the squared speed.
    let mut q = [0.0; 5];
    for [a, b, c] in axes {
        q[0] += a * a;
        q[1] += 2.0 * a * b;
        q[2] += b * b + 2.0 * a * c;
        q[3] += 2.0 * b * c;
        q[4] += c * c;
    }
    let size = q.iter().map(|c| c.abs()).sum::<f64>();
    // The pair nearer to the curve: it matters more, and is known better.
    let off = |z: &Complex| (z.0 - 0.5).abs() + z.1;
    let (x, y) = if off(&start[0]) <= off(&start[1]) {
        start[0]
    } else {
        start[1]
    };
    let (mut p, mut r) = (-2.0 * x, x * x + y * y);
    for _ in 0..BAIRSTOW {
        let (b1, b0) = (q[3] - p * q[4], q[2] - p * (q[3] - p * q[4]) - r * q[4]);
        let (r1, r0) = (q[1] - p * b0 - r * b1, q[0] - r * b0);
        let (c1, c0) = (b1 - p * q[4], b0 - r * q[4]);
        if (r1.abs() + r0.abs()) <= 1e-14 * size * (1.0 + p.abs() + r.abs()) {
            let pair = |half: f64, product: f64| {
                let square = product - half * half;
                bounded((half, square.max(0.0).sqrt()))
            };
            return Some([pair(-0.5 * p, r), pair(-0.5 * b1 / q[4], b0 / q[4])]);
        }
        // Derivatives of the remainder by p and r.
        let (r1p, r1r, r0p, r0r) = (p * c1 - c0, -c1, r * c1, -c0);
        let determinant = r1p * r0r - r1r * r0p;
        let (dp, dr) = (
            (r1r * r0 - r0r * r1) / determinant,
            (r0p * r1 - r1p * r0) / determinant,
        );
        p += dp;
        r += dr;
        if !(p.abs() < 1e12 && r.abs() < 1e12) {
            return None;
        }
    }
    None
}
