//! A motion at equal steps of time, and the table of it.

use crate::files::short;
use anamorph_core::Solid;
use anamorph_core::glam::DQuat;
use anamorph_recipe::BuiltMotion;
use std::io::Write;

/// Frames beyond which a result is refused: half an hour at 500 a second.
pub(crate) const MOST: usize = 1_000_000;

/// What a motion is at some times.
pub(crate) struct Frames {
    pub(crate) times: Vec<f64>,
    pub(crate) positions: Vec<Solid>,
    pub(crate) rotations: Vec<DQuat>,
    /// Length covered, in scene units.
    pub(crate) distances: Vec<f64>,
    /// Speed along the path, in scene units a second.
    pub(crate) speeds: Vec<f64>,
}

/// The times of frames: from 0 on, `rate` a second, as many as begin within the duration, and its end where none of them is there.
pub(crate) fn times(duration: f64, rate: f64) -> Result<Vec<f64>, String> {
    // A product that is a whole number but for rounding counts as that.
    let last = (duration * rate * (1.0 + 1e-12)).floor();
    #[allow(clippy::cast_precision_loss)]
    if !(last >= 0.0 && last < MOST as f64) {
        return Err(format!(
            "{} seconds at {} frames a second are more than {MOST} frames; lower --fps or --duration",
            short(duration),
            short(rate)
        ));
    }
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let last = last as u32;
    let mut times: Vec<f64> = (0..=last)
        .map(|i| (f64::from(i) / rate).min(duration))
        .collect();
    if times
        .last()
        .is_some_and(|last| duration - last > 1e-9 * duration)
    {
        times.push(duration);
    }
    Ok(times)
}

impl Frames {
    /// The motion at `times`, `rate` a second. At moments at which an ease is infinitely fast its speed is the mean one over a
    /// frame.
    pub(crate) fn at(built: &BuiltMotion, times: Vec<f64>, rate: f64) -> Self {
        let motion = &built.motion;
        let speed = |time: f64| {
            let speed = motion.speed(time);
            if speed.is_finite() {
                return speed;
            }
            let from = (time - 0.5 / rate).max(0.0);
            let to = (time + 0.5 / rate).min(motion.duration());
            (motion.distance(to) - motion.distance(from)) / (to - from)
        };
        Self {
            positions: times.iter().map(|t| motion.position(*t)).collect(),
            rotations: built.rotations(&times),
            distances: times.iter().map(|t| motion.distance(*t)).collect(),
            speeds: times.iter().map(|t| speed(*t)).collect(),
            times,
        }
    }

    /// Writes a table: time, position, rotation, distance, speed.
    pub(crate) fn write_csv(&self, out: &mut dyn Write) -> std::io::Result<()> {
        writeln!(out, "t,x,y,z,qw,qx,qy,qz,s,v")?;
        for (i, time) in self.times.iter().enumerate() {
            let (p, q) = (self.positions[i], self.rotations[i]);
            let row = [
                *time,
                p.x,
                p.y,
                p.z,
                q.w,
                q.x,
                q.y,
                q.z,
                self.distances[i],
                self.speeds[i],
            ];
            let row = row.map(number);
            writeln!(out, "{}", row.join(","))?;
        }
        Ok(())
    }
}

/// The shortest text that reads back as the same number.
fn number(value: f64) -> String {
    // No sign on zero.
    let value = value + 0.0;
    if value == 0.0 || (1e-5..1e16).contains(&value.abs()) {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_begin_within_the_duration_and_end_with_it() {
        assert_eq!(times(1.0, 4.0).unwrap(), [0.0, 0.25, 0.5, 0.75, 1.0]);
        assert_eq!(times(0.29, 100.0).unwrap().len(), 30);
        assert_eq!(times(0.1, 1.0).unwrap(), [0.0, 0.1]);
        assert_eq!(times(1.0, 2.5).unwrap(), [0.0, 0.4, 0.8, 1.0]);
        for (duration, rate) in [
            (1.0, 1e9),
            (1e9, 24.0),
            (f64::NAN, 1.0),
            (1.0, f64::INFINITY),
        ] {
            assert!(times(duration, rate).unwrap_err().contains("lower --fps"));
        }
    }

    #[test]
    fn numbers_read_back() {
        for value in [0.1, -1e-300, 1e300, 12.0, f64::MIN_POSITIVE, 1.0 / 3.0] {
            assert_eq!(number(value).parse::<f64>().unwrap(), value);
        }
        assert_eq!(number(-0.0), "0");
    }
}
