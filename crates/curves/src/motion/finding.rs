//! What a diagnosis says.

use crate::error::Short;
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
    /// It is turned by an angle at once.
    TurnsAtOnce {
        /// When.
        time: f64,
        /// By how much, in radians.
        angle: f64,
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
            | Self::TurnsAtOnce { time, .. }
            | Self::ArrivesEarly { time, .. }
            | Self::ArrivesLate { time, .. } => Some(time),
            Self::Stalls { from, .. }
            | Self::BacksUp { from, .. }
            | Self::LeavesPath { from, .. } => Some(from),
            Self::NeverArrives { .. } => None,
        }
    }

    /// What several of its kind are called.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Waits { .. } => "waits",
            Self::StartsPartway { .. } => "starts partway",
            Self::StartsAbruptly { .. } => "abrupt starts",
            Self::Stalls { .. } => "stalls",
            Self::BacksUp { .. } => "ways back",
            Self::Jumps { .. } => "jumps",
            Self::LeavesPath { .. } => "times off the path",
            Self::EndsAbruptly { .. } => "abrupt ends",
            Self::TurnsAtOnce { .. } => "turns at once",
            Self::ArrivesEarly { .. } | Self::ArrivesLate { .. } | Self::NeverArrives { .. } => {
                "arrivals at another time"
            }
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
                let (goes, place) = if by < 0.0 {
                    ("is before the start", "start")
                } else {
                    ("goes beyond the end", "end")
                };
                write!(
                    f,
                    "it {goes} of the path by up to {} from {} to {}, and waits at the {place}",
                    Short(by.abs()),
                    Short(from),
                    Short(to)
                )
            }
            Self::TurnsAtOnce { time, angle } => write!(
                f,
                "it turns by {} degrees at once at {}",
                Short((10.0 * angle.to_degrees()).round() / 10.0),
                Short(time)
            ),
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
