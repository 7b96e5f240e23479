//! One module a command.

mod animation;
pub(crate) mod bind;
pub(crate) mod cage;
pub(crate) mod check;
pub(crate) mod coarse;
mod film;
pub(crate) mod frames;
mod image;
mod image_frames;
mod image_maps;
mod image_report;
pub(crate) mod inspect;
mod jobs;
pub(crate) mod list;
pub(crate) mod morph;
pub(crate) mod motion;
mod panels;
pub(crate) mod promises;
pub(crate) mod schema;
pub(crate) mod sequence;
pub(crate) mod shapes;
pub(crate) mod shell;
pub(crate) mod snake;
pub(crate) mod undone;
pub(crate) mod warp;
