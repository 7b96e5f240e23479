//! Banking: leaning into turns, on top of any orientation.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Frenet Frame – local coordinate system" ("use for direction and bank into
//! turn, especially for ground-planar curves (e.g. roads)"). The angle is that of a coordinated turn (any text on flight
//! mechanics): on a circle of curvature `κ` passed at speed `v`, weight and centrifugal force add up to a force
//! along the up axis leaned by `atan(v² κ / g)`.
//!
//! Of the curvature only the part along the side axis counts, `κ·u`: the turn as felt by who has that frame. Over hills and in
//! vertical loops the curvature is along the up axis, and nothing leans. A loop with a fixed up vector still turns over where it
//! is vertical, with the frame it is based on; base it on rotation-minimizing frames.

use super::error::in_range;
use super::up::Course;
use super::{Frame, OrientationError, Orienter, SpaceCurve};
use crate::{Curvature, LengthTable};
use anamorph_core::{Curve, Space, math};
use core::f64::consts::{FRAC_PI_2, FRAC_PI_3};
use std::sync::Arc;

/// Places a half-width of smoothing at which leans are kept; with fewer, steps would show.
const PLACES: f64 = 16.0;
/// Places along a path at least and at most; the latter bounds memory (2 MB) and the least smoothing.
const FEWEST: f64 = 256.0;
const MOST: f64 = 262_144.0;

/// How fast the path is travelled.
#[derive(Clone)]
pub enum Speed {
    /// Always as fast, in scene units a second.
    Constant(f64),
    /// The speed at a parameter, in scene units a second; what is not finite counts as 0.
    At(Arc<dyn Fn(f64) -> f64 + Send + Sync>),
}

impl core::fmt::Debug for Speed {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Constant(speed) => f.debug_tuple("Constant").field(speed).finish(),
            Self::At(_) => f.write_str("At(…)"),
        }
    }
}

/// Banking: settings.
#[derive(Clone, Debug)]
pub struct Banking {
    /// How fast the path is travelled; 1 by default.
    pub speed: Speed,
    /// The acceleration of gravity in scene units a second squared, positive; 9.81 by default.
    pub gravity: f64,
    /// How much of `v² κ / g` counts. 1, the default, is the coordinated turn; negative numbers lean out of turns.
    pub gain: f64,
    /// The largest lean in radians, above 0 and at most π/2; π/3 by default.
    pub limit: f64,
    /// Half the width, in scene units along the path, over which leans are averaged with weights that fall off linearly; 0, the default
    /// here (by name it is a fiftieth of the path), averages nothing: leans jump where the curvature does. Smoothings below a 16 000th of the path's length are taken as that.
    pub smoothing: f64,
}

impl Default for Banking {
    fn default() -> Self {
        Self {
            speed: Speed::Constant(1.0),
            gravity: 9.81,
            gain: 1.0,
            limit: FRAC_PI_3,
            smoothing: 0.0,
        }
    }
}

impl Banking {
    /// Leans the frames `base` along `path`, which must be those of this path, into its turns.
    ///
    /// # Errors
    ///
    /// A path without length, a number outside its range.
    pub fn of<O: Orienter, P: SpaceCurve>(
        &self,
        base: O,
        path: P,
    ) -> Result<Banked<O, P>, OrientationError> {
        if let Speed::Constant(speed) = self.speed {
            in_range("the speed", speed, speed >= 0.0, "0 or more")?;
        }
        in_range("the gravity", self.gravity, self.gravity > 0.0, "positive")?;
        in_range("the gain", self.gain, true, "a finite number")?;
        let holds = self.limit > 0.0 && self.limit <= FRAC_PI_2;
        in_range(
            "the limit",
            self.limit,
            holds,
            "above 0 and at most π/2 radians",
        )?;
        in_range(
            "the smoothing",
            self.smoothing,
            self.smoothing >= 0.0,
            "0 or more scene units",
        )?;
        let mut banked = Banked {
            settings: self.clone(),
            course: Course::new(path)?,
            base,
            smooth: None,
        };
        if self.smoothing > 0.0 {
            banked.smooth = Some(banked.smoothed()?);
        }
        Ok(banked)
    }
}

/// Leans at places evenly along a path.
#[derive(Clone, Debug)]
struct Smooth {
    table: LengthTable,
    leans: Vec<f64>,
    closed: bool,
}

/// The value of a list at a place before, in or behind it: around in a closed one, else that of the nearest.
fn at(values: &[f64], index: isize, closed: bool) -> f64 {
    let count = values.len() as isize;
    let inside = if closed {
        index.rem_euclid(count)
    } else {
        index.clamp(0, count - 1)
    };
    values[inside as usize]
}

/// Averages over `2·reach + 1` values around each.
fn averages(values: &[f64], reach: isize, closed: bool) -> Vec<f64> {
    let width = (2 * reach + 1) as f64;
    let mut sum: f64 = (-reach..=reach).map(|i| at(values, i, closed)).sum();
    (0..values.len() as isize)
        .map(|i| {
            let average = sum / width;
            sum += at(values, i + reach + 1, closed) - at(values, i - reach, closed);
            average
        })
        .collect()
}

impl Smooth {
    /// The lean at a length: the cubic with central differences as slopes.
    fn lean(&self, s: f64) -> f64 {
        let steps = self.leans.len() - usize::from(!self.closed);
        let x = (s / self.table.length() * steps as f64).clamp(0.0, steps as f64);
        let index = (x.floor() as isize).min(steps as isize - 1);
        let x = x - index as f64;
        let [a, b, c, d] = [-1, 0, 1, 2].map(|k| at(&self.leans, index + k, self.closed));
        let (at_b, at_c) = (0.5 * (c - a), 0.5 * (d - b));
        let rise = c - b;
        b + x * (at_b + x * (3.0 * rise - 2.0 * at_b - at_c + x * (at_b + at_c - 2.0 * rise)))
    }
}

/// Frames that lean into turns.
#[derive(Clone, Debug)]
pub struct Banked<O, P> {
    settings: Banking,
    course: Course<P>,
    base: O,
    smooth: Option<Smooth>,
}

impl<O: Orienter, P: SpaceCurve> Banked<O, P> {
    /// The lean in radians of the frame `base` at a parameter, without smoothing: positive towards its side axis, which is the inside
    /// of a turn to the left. 0 where the path stops.
    fn raw(&self, base: &Frame, parameter: f64) -> f64 {
        let set = &self.settings;
        let speed = match &set.speed {
            Speed::Constant(speed) => *speed,
            Speed::At(speed) => speed(parameter),
        };
        let bend = self.course.path.curvature_vector(parameter);
        let felt = bend.map_or(0.0, |bend| Space::dot(bend, base.side()));
        let slope = set.gain * (speed * speed / set.gravity) * felt;
        if slope.is_nan() {
            return 0.0;
        }
        math::atan2(slope, 1.0).clamp(-set.limit, set.limit)
    }

    fn smoothed(&self) -> Result<Smooth, OrientationError> {
        let table = self.course.table()?;
        let (length, closed) = (table.length(), self.course.path.is_closed());
        let steps = (PLACES * length / self.settings.smoothing)
            .clamp(FEWEST, MOST)
            .ceil();
        let count = steps as usize + usize::from(!closed);
        let parameter = |i: usize| table.parameter(length * (i as f64 / steps));
        let mut leans = Vec::with_capacity(count);
        self.base
            .stream(&mut (0..count).map(parameter), &mut |frame| {
                leans.push(self.raw(&frame, parameter(leans.len())));
            });
        // Two averages of the same width are one with weights that fall off linearly.
        let half = (0.5 * self.settings.smoothing * steps / length).min(steps);
        let reach = half.round().max(1.0) as isize;
        let once = averages(&leans, reach, closed);
        Ok(Smooth {
            leans: averages(&once, reach, closed),
            table,
            closed,
        })
    }

    /// The lean in radians at a parameter whose frame without banking is `base`: positive towards its side axis, which is
    /// the inside of a turn to the left.
    #[must_use]
    pub fn lean(&self, base: &Frame, parameter: f64) -> f64 {
        match &self.smooth {
            Some(smooth) => {
                let within = self.course.path.within(parameter);
                let limit = self.settings.limit;
                smooth
                    .lean(smooth.table.length_to(within))
                    .clamp(-limit, limit)
            }
            None => self.raw(base, parameter),
        }
    }

    fn leaned(&self, base: &Frame, parameter: f64) -> Frame {
        // Rolling goes to the right.
        base.rolled(-self.lean(base, parameter))
    }
}

impl<O: Orienter, P: SpaceCurve> Orienter for Banked<O, P> {
    fn frame(&self, parameter: f64) -> Frame {
        self.leaned(&self.base.frame(parameter), parameter)
    }

    fn stream(&self, parameters: &mut dyn Iterator<Item = f64>, each: &mut dyn FnMut(Frame)) {
        let at = core::cell::Cell::new(0.0);
        let mut noted = parameters.inspect(|parameter| at.set(*parameter));
        self.base
            .stream(&mut noted, &mut |frame| each(self.leaned(&frame, at.get())));
    }
}
