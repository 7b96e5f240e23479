//! What a diagnosis says.

use core::fmt;

/// Something about a motion that an animator would want to know. Times and distances are those of the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Finding {
    /// It rests from time 0 on.
    Waits {
        /// When it starts.
        until: f64,
    },
    /// It does not start at the start of the path.
    StartsPartway {
        /// The distance at time 0.
        distance: f64,
    },
    /// It does not start from rest.
    StartsAbruptly {
        /// When.
        time: f64,
        /// The speed it has at once.
        speed: f64,
    },
    /// It stands still on the way: at a moment, where both times are equal, or for a while.
    Stalls {
        /// When it comes to rest.
        from: f64,
        /// When it goes on.
        to: f64,
        /// Where.
        distance: f64,
    },
    /// It goes back.
    BacksUp {
        /// When it turns back.
        from: f64,
        /// When it turns round again, or the end.
        to: f64,
        /// How far it goes back.
        distance: f64,
    },
    /// It is in one place and at once in another.
    Jumps {
        /// When.
        time: f64,
        /// By how much; negative: back.
        distance: f64,
    },
    /// It is before the start of the path, or beyond its end, where the path stays at its end.
    LeavesPath {
        /// When it leaves.
        from: f64,
        /// When it is back, or the end.
        to: f64,
        /// How far it gets: negative before the start, positive beyond the end.
        by: f64,
    },
    /// It does not come to rest at the end.
    EndsAbruptly {
        /// When.
        time: f64,
        /// The speed it loses at once.
        speed: f64,
    },
    /// It arrives before it is due, and rests.
    ArrivesEarly {
        /// When it arrives.
        time: f64,
        /// When it is due.
        due: f64,
    },
    /// It arrives after it is due.
    ArrivesLate {
        /// When it arrives.
        time: f64,
        /// When it is due.
        due: f64,
    },
    /// It does not arrive.
    NeverArrives {
        /// The distance that is missing when it ends.
        missing: f64,
    },
}

impl Finding {
    /// The time at which it begins; for what concerns the whole motion, 0 or none.
    pub fn time(&self) -> Option<f64> {
        match *self {
            Self::Waits { .. } | Self::StartsPartway { .. } => Some(0.0),
            Self::StartsAbruptly { time, .. }
            | Self::Jumps { time, .. }
            | Self::EndsAbruptly { time, .. }
            | Self::ArrivesEarly { time, .. }
            | Self::ArrivesLate { time, .. } => Some(time),
            Self::Stalls { from, .. }
            | Self::BacksUp { from, .. }
            | Self::LeavesPath { from, .. } => Some(from),
            Self::NeverArrives { .. } => None,
        }
    }
}

/// A number with at most six significant digits, for people.
struct Short(f64);

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rounded: f64 = format!("{:.5e}", self.0).parse().unwrap_or(self.0);
        let size = rounded.abs();
        if size != 0.0 && !(1e-4..1e9).contains(&size) {
            write!(f, "{rounded:e}")
        } else {
            write!(f, "{rounded}")
        }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Waits { until } => write!(f, "it waits until {} before it starts", Short(until)),
            Self::StartsPartway { distance } => {
                write!(f, "it starts partway, at the distance {}", Short(distance))
            }
            Self::StartsAbruptly { time, speed } => write!(
                f,
                "it starts abruptly at {}, with the speed {}",
                Short(time),
                Short(speed)
            ),
            Self::Stalls { from, to, distance } if from == to => write!(
                f,
                "it stalls for a moment at {}, at the distance {}",
                Short(from),
                Short(distance)
            ),
            Self::Stalls { from, to, distance } => write!(
                f,
                "it stalls from {} to {}, at the distance {}",
                Short(from),
                Short(to),
                Short(distance)
            ),
            Self::BacksUp { from, to, distance } => write!(
                f,
                "it backs up from {} to {}, by {}",
                Short(from),
                Short(to),
                Short(distance)
            ),
            Self::Jumps { time, distance } => {
                let way = if distance < 0.0 { "back" } else { "ahead" };
                write!(
                    f,
                    "it jumps {way} by {} at {}",
                    Short(distance.abs()),
                    Short(time)
                )
            }
            Self::LeavesPath { from, to, by } => {
                let place = if by < 0.0 {
                    "before the start of the path"
                } else {
                    "beyond the end of the path"
                };
                write!(
                    f,
                    "it is {place} from {} to {}, by up to {}",
                    Short(from),
                    Short(to),
                    Short(by.abs())
                )
            }
            Self::EndsAbruptly { time, speed } => write!(
                f,
                "it ends abruptly at {}, with the speed {}",
                Short(time),
                Short(speed)
            ),
            Self::ArrivesEarly { time, due } => {
                write!(
                    f,
                    "it arrives early, at {} instead of {}",
                    Short(time),
                    Short(due)
                )
            }
            Self::ArrivesLate { time, due } => {
                write!(
                    f,
                    "it arrives late, at {} instead of {}",
                    Short(time),
                    Short(due)
                )
            }
            Self::NeverArrives { missing } => {
                write!(
                    f,
                    "it never arrives: {} is missing at its end",
                    Short(missing)
                )
            }
        }
    }
}
