//! Barr's deformations: one transformation that varies along an axis.
//!
//! *Source*: A. H. Barr, *Global and Local Deformations of Solid Primitives*, SIGGRAPH 1984; cast as in Milliron et al.
//! 2002, §4.3: a single parameterized transformation `T(v)`, strength 1, and a weight that picks `v` = the point's
//! coordinate along the axis (*nearest* sampling, errata F17).

pub mod axial;
mod axis;
pub mod bend;
#[cfg(feature = "recipe")]
pub(crate) mod parameters;
pub mod taper;
pub mod twist;

pub use axis::{AxialWarp, AxisError, AxisFrame, Course, Law, LocalMap};
