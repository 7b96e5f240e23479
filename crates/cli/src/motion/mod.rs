//! Motions as tables, animations and pictures.

pub(crate) mod drawing;
pub(crate) mod frames;
pub(crate) mod shapes;
pub(crate) mod tracks;
