//! Laws: statements that hold for every registered warp and field, in every setting, in the plane and in space.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod bad_input;
mod bad_rows;
mod evaluation;
mod facts;
mod fields;
mod guarantees;
mod identity;
mod jacobians;
mod transformations;

/// Makes a test in the plane and one in space of a law that is generic over the space.
macro_rules! laws {
    ($($law:ident),* $(,)?) => {
        mod plane {
            $(#[test] fn $law() { super::$law::<anamorph_core::Plane>(); })*
        }
        mod solid {
            $(#[test] fn $law() { super::$law::<anamorph_core::Solid>(); })*
        }
    };
}
pub(crate) use laws;
