//! Laws of orientations along paths, and their hard cases.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod banking;
#[path = "../common/mod.rs"]
mod common;
mod frenet;
mod laws;
mod looking;
mod minimizing;
mod paths;
