//! What can be wrong with a sequence of orientations.

/// Why a path through orientations could not be built or asked.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum OrientationError {
    /// There are no keys.
    #[error("there are no keys; give at least one orientation")]
    NoKeys,
    /// A key has a part that is infinite or not a number.
    #[error("key {key} is not finite; give quaternions without infinite parts or NaN")]
    KeyNotFinite {
        /// Number of the key, from 0.
        key: usize,
    },
    /// A key is the null quaternion, which is no rotation.
    #[error("key {key} is the null quaternion, which is no rotation; give it a direction")]
    NullKey {
        /// Number of the key, from 0.
        key: usize,
    },
    /// Keys and times do not go together.
    #[error(
        "{keys} keys come with {times} times; give {expected}, one for each key{}",
        if expected > keys { " and one for the return to the first" } else { "" }
    )]
    Count {
        /// How many keys there are.
        keys: usize,
        /// How many times.
        times: usize,
        /// How many there should be.
        expected: usize,
    },
    /// A key time is infinite or not a number.
    #[error("time {time} is not finite; give times that are neither infinite nor NaN")]
    TimeNotFinite {
        /// Number of the time, from 0.
        time: usize,
    },
    /// A key time is not after the one before it.
    #[error(
        "time {time} is {after}, which is not after the one before it, {before}; sort the keys by time and give each its own"
    )]
    TimesNotIncreasing {
        /// Number of the later time, from 0.
        time: usize,
        /// The earlier time.
        before: f64,
        /// The later time.
        after: f64,
    },
    /// Two neighbouring key times are so near or so far that rates overflow.
    #[error(
        "times {} and {time} are {span} apart; give spans between 1e-30 and 1e30, in another unit of time",
        time - 1
    )]
    Span {
        /// Number of the later time, from 0.
        time: usize,
        /// How far they are apart.
        span: f64,
    },
    /// A given angular velocity is not finite, or beyond 1e30 radians per unit of time.
    #[error(
        "the angular velocity given for the {end} is not finite, or beyond 1e30 radians per unit of time; give a smaller one"
    )]
    Rate {
        /// `"start"` or `"end"`.
        end: &'static str,
    },
    /// As many orientations are asked for as there are times.
    #[error("{times} times come with room for {out} orientations; give as many places as times")]
    Room {
        /// How many times there are.
        times: usize,
        /// How many places for orientations.
        out: usize,
    },
    /// An accuracy that is not a positive number.
    #[error("the accuracy is {accuracy}; give a positive number of radians, such as 1e-9")]
    Accuracy {
        /// What was given.
        accuracy: f64,
    },
    /// The turned angle cannot be tabulated to the accuracy asked for.
    #[error(
        "between times {} and {time} the motion turns too wildly to be measured to {accuracy} radians in {limit} pieces; give a larger accuracy, or keys whose times are less uneven",
        time - 1
    )]
    TooWild {
        /// Number of the key time at which the span ends, from 0.
        time: usize,
        /// The accuracy asked for, in radians.
        accuracy: f64,
        /// How many pieces a span may be cut into.
        limit: usize,
    },
}
