//! tmp
pub use glam;
mod marks;
pub mod math;
mod space;
pub use marks::*;
pub use space::*;
