//! Schemes: which strain a place should have at a time between, from the one that it has at the end.
//!
//! A scheme sees strains alone, so it can never see a rotation; it is one file here and one line in [`all`].
//!
//! The default is `indifferent`, by numbers: on a strip that is bent, one that grows as well, and a ring that becomes a star, principal stretches differ from
//! those that go evenly by 0.0005, 0.0014 and 0.088 (root of mean square), against 0.0035, 0.118 and 0.30 (`linear`), 0.0007, 0.0034 and 0.39 (`modified`),
//! and 0.0037, 0.129 and 0.34 (`log`); the whole area stays between those of both ends in all three. Where the area of each element must not
//! turn back `log` is nearest (121 and 150 elements against 120 of 128 and 143 of 320). The page on strain fields has the table.
//!
//! *Source*: H.-B. Yan, S.-M. Hu, R. Martin, *Morphing based on strain field interpolation*, 2004, eqs. (2) and (3); errata S1 to S3.

mod indifferent;
mod linear;
mod log;
mod modified;

pub use indifferent::Indifferent;
pub use linear::Linear;
pub use log::Log;
pub use modified::Modified;

use super::Strain;
use crate::names::UnknownName;

/// How strains go from nothing to those of the target.
pub trait Scheme: Send + Sync + std::fmt::Debug {
    /// Its name in recipes and lists.
    fn name(&self) -> &'static str;
    /// What it is, in a few words.
    fn title(&self) -> &'static str;
    /// The strain wanted at time `t`, from 0 to 1, where the target has the strain `target`.
    fn strain(&self, target: Strain, t: f64) -> Strain;
    /// Whether it asks for a target whose elements all have an area.
    fn needs_area(&self) -> bool {
        false
    }
}

const SCHEMES: [&dyn Scheme; 4] = [&Indifferent, &Linear, &Modified, &Log];

/// All of them, the default first.
pub fn all() -> impl Iterator<Item = &'static dyn Scheme> {
    SCHEMES.into_iter()
}

/// The one of that name.
///
/// # Errors
/// [`UnknownName`], which lists the names there are.
pub fn by_name(name: &str) -> Result<&'static dyn Scheme, UnknownName> {
    let found = all().find(|scheme| scheme.name() == name);
    found.ok_or_else(|| UnknownName {
        what: "scheme",
        name: name.to_owned(),
        known: all().map(Scheme::name).collect::<Vec<_>>().join(", "),
    })
}
