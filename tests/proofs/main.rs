//! Proofs of the systems: for each what it promises beyond "equals the formula", named by the row of the inventory.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod axial;
mod barr;
mod features;
mod framework;
mod lattices;
mod lines;
mod multilevel;
mod pairs;
mod planes;
mod radial;
mod scodef;
mod segments;
mod wires;
