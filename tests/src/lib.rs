//! Shared by the tests and benchmarks: worked cases, random numbers, models made in code, and the settings of every
//! registered warp that the laws are checked on.

// A panic in here is a failed test.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

pub mod cases;
pub mod measure;
pub mod models;
pub mod pairs;
pub mod random;
pub mod settings;
pub mod subjects;
