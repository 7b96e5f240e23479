//! A mass on a damped spring, released at 0 and pulled to 1.
//!
//! *Source*: the damped harmonic oscillator `m ẍ + c ẋ + k x = 0` with `x(0) = −1`, `ẋ(0) = v`, in closed form for less than,
//! exactly and more than critical damping. The ease is `1 + x`.
//!
//! A spring never comes to rest. Its unit of time ends where the distance from 1 stays below the share `rest`: with
//! a damping ratio below 0.9 at the first turning point from which all turning points are nearer than that, else where
//! a bound on the distance falls below it. What then is left of distance and speed is taken away by the cubic that has both at
//! the end and neither at the start, so that the ease ends at 1 and at rest; it is of the size of `rest`.

use super::{Ease, EaseFacts, EaseState, ranged};
use crate::CurveError;
use anamorph_core::math;

/// The damping ratio below which the spring swings visibly, and settles at a turning point.
const SWINGING: f64 = 0.9;

/// The damping ratio above which the two decays are far enough apart to be told from each other without loss.
const SEPARATE: f64 = 1.25;

/// A spring with its settling time as the unit of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spring {
    /// Undamped angular frequency, radians for a second.
    frequency: f64,
    /// Damping over critical damping.
    ratio: f64,
    /// Speed at the start, in distances for a radian of the undamped swing.
    start: f64,
    /// Settling time, in radians of the undamped swing.
    settling: f64,
    /// Distance and speed (for the unit of time) left at the settling time.
    left: (f64, f64),
}

impl Spring {
    /// A spring of a mass, a stiffness (force for a distance), a damping (force for a speed) and a speed at the start (whole
    /// distances for a second). `rest`, from 1e-6 to 0.1, is the share of the distance below which it counts as at rest.
    ///
    /// # Errors
    /// [`CurveError::OutOfRange`]: mass and stiffness must be positive, the damping ratio `c/(2√(km))` from 0.001 to
    /// 1000, the speed at the start at most 1000 distances for a radian of the undamped swing.
    pub fn new(
        mass: f64,
        stiffness: f64,
        damping: f64,
        velocity: f64,
        rest: f64,
    ) -> Result<Self, CurveError> {
        let positive = "a positive number from 1e-100 to 1e100";
        let mass = ranged("mass", mass, 1e-100, 1e100, positive)?;
        let stiffness = ranged("stiffness", stiffness, 1e-100, 1e100, positive)?;
        let frequency = (stiffness / mass).sqrt();
        let ratio = ranged(
            "damping ratio (damping over twice the root of stiffness times mass)",
            damping / (2.0 * (stiffness.sqrt() * mass.sqrt())),
            1e-3,
            1e3,
            "from 0.001 to 1000: change the damping",
        )?;
        let start = ranged(
            "velocity over the root of stiffness by mass",
            velocity / frequency,
            -1e3,
            1e3,
            "from -1000 to 1000",
        )?;
        let rest = ranged("rest", rest, 1e-6, 0.1, "from 0.000001 to 0.1")?;
        let mut spring = Self {
            frequency,
            ratio,
            start,
            settling: 1.0,
            left: (0.0, 0.0),
        };
        spring.settling = spring.settles(rest);
        let [distance, speed, _] = spring.oscillation(spring.settling);
        spring.left = (distance, speed * spring.settling);
        Ok(spring)
    }

    /// The seconds that the unit of time stands for.
    pub fn settling_time(&self) -> f64 {
        self.settling / self.frequency
    }

    /// Damping over critical damping: below 1 the spring swings.
    pub fn damping_ratio(&self) -> f64 {
        self.ratio
    }

    /// The decaying cosine and the decaying sine over its frequency (hyperbolic above critical damping).
    fn waves(&self, time: f64) -> (f64, f64) {
        let ratio = self.ratio;
        let square = (1.0 - ratio) * (1.0 + ratio);
        let width = square.abs().sqrt();
        if square >= 0.0 {
            let decay = math::exp(-ratio * time);
            let (sin, cos) = math::sin_cos(width * time);
            // sin(wτ)/w, the limit τ where the frequency vanishes.
            let angle = width * time;
            let sinc = if angle < 1e-4 {
                time * (1.0 - angle * angle / 6.0)
            } else {
                sin / width
            };
            (decay * cos, decay * sinc)
        } else {
            // The slower rate without cancellation: (ζ − s)(ζ + s) = 1.
            let slow = math::exp(-time / (ratio + width));
            let twice = 2.0 * width * time;
            let fast = math::exp(-twice);
            (
                0.5 * slow * (1.0 + fast),
                slow * time * one_less_exp_over(twice),
            )
        }
    }

    /// Distance from the target, its first and its second derivative, by radians of the undamped swing.
    fn oscillation(&self, time: f64) -> [f64; 3] {
        let (ratio, start) = (self.ratio, self.start);
        if ratio > SEPARATE {
            // The sum of both decays; the decaying sine and cosine would cancel each other's digits.
            let width = ((ratio - 1.0) * (ratio + 1.0)).sqrt();
            let (slow, fast) = (-1.0 / (ratio + width), -(ratio + width));
            let share = (start + fast) / (slow - fast);
            let a = share * math::exp(slow * time);
            let b = (-1.0 - share) * math::exp(fast * time);
            return [
                a + b,
                a * slow + b * fast,
                a * slow * slow + b * fast * fast,
            ];
        }
        let (cos, sin) = self.waves(time);
        let distance = (start - ratio) * sin - cos;
        let speed = start * cos + (1.0 - ratio * start) * sin;
        [distance, speed, -distance - 2.0 * ratio * speed]
    }

    fn settles(&self, rest: f64) -> f64 {
        let (ratio, start) = (self.ratio, self.start);
        if ratio < SWINGING {
            let width = ((1.0 - ratio) * (1.0 + ratio)).sqrt();
            let half_turn = core::f64::consts::PI / width;
            // Where the speed vanishes: tan(wτ) = −v w/(1 − ζv).
            let angle = math::atan2(-start * width, 1.0 - ratio * start);
            let mut first = angle / width;
            while first <= 0.0 {
                first += half_turn;
            }
            let swing = self.oscillation(first)[0].abs();
            let turns = (math::ln(swing / rest) / (ratio * half_turn))
                .ceil()
                .max(0.0);
            return first + turns * half_turn;
        }
        let bound = |time: f64| {
            let (cos, sin) = if ratio < 1.0 {
                let decay = math::exp(-ratio * time);
                (decay, decay * time)
            } else {
                self.waves(time)
            };
            cos + (start - ratio).abs() * sin
        };
        // The bound is at least 1 at the start and has one maximum at most.
        let mut high = 1.0;
        while bound(high) >= rest {
            high *= 2.0;
        }
        let mut low = 0.5 * high;
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if bound(middle) >= rest {
                low = middle;
            } else {
                high = middle;
            }
        }
        high
    }
}

/// `(1 − e^(−z))/z` for `z ≥ 0`.
fn one_less_exp_over(z: f64) -> f64 {
    if z > 0.5 {
        return (1.0 - math::exp(-z)) / z;
    }
    // Σ (−z)ⁿ/(n + 1)!; the term after these is below 0.5¹⁵/16!.
    let (mut sum, mut term) = (0.0, 1.0);
    for n in 1..=15_u32 {
        sum += term;
        term *= -z / f64::from(n + 1);
    }
    sum
}

impl Ease for Spring {
    fn state(&self, t: f64) -> EaseState {
        let unit = self.settling;
        let [distance, speed, acceleration] = self.oscillation(t * unit);
        let (d, v) = self.left;
        // d t²(3 − 2t) + v t²(t − 1): d and v at the end, nothing at the start.
        let (bend, cube) = (3.0 * d - v, v - 2.0 * d);
        let value = 1.0 + (distance - t * t * (bend + cube * t));
        EaseState {
            value: if t == 0.0 {
                0.0
            } else if t == 1.0 {
                1.0
            } else {
                value
            },
            speed: unit * speed - t * (2.0 * bend + 3.0 * cube * t),
            acceleration: unit * unit * acceleration - (2.0 * bend + 6.0 * cube * t),
        }
    }
    fn facts(&self) -> EaseFacts {
        EaseFacts {
            // Swings, and the last correction, may go back.
            monotone: false,
            ..EaseFacts::PLAIN
        }
    }
}
