//! Values of the options of morphs of shapes.
//!
//! Each says what may be written where it is refused. They are beside `arguments.rs` because that is long enough.

use clap::ValueEnum;

/// What becomes of parts of a drawing without a partner.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum PiecesName {
    /// Further parts of the target split off the source's nearest, further parts of the source merge into the target's
    SplitAndMerge,
    /// Further parts of the target split off; those of the source shrink to points
    Split,
    /// Further parts of the source merge; those of the target grow from points
    Merge,
    /// All grow from points, or shrink to points
    Grow,
}

impl From<PiecesName> for anamorph_morph::shapes::Pieces {
    fn from(name: PiecesName) -> Self {
        match name {
            PiecesName::SplitAndMerge => Self::SplitAndMerge,
            PiecesName::Split => Self::Split,
            PiecesName::Merge => Self::Merge,
            PiecesName::Grow => Self::Grow,
        }
    }
}

pub(crate) fn parse_positive(text: &str) -> Result<f64, String> {
    let number = text.trim().parse().ok();
    number
        .filter(|n: &f64| *n > 0.0 && n.is_finite())
        .ok_or_else(|| "write a positive number, such as 0.1".to_owned())
}

pub(crate) fn parse_side(text: &str) -> Result<f64, String> {
    let number = text.trim().trim_end_matches("px").trim().parse().ok();
    number
        .filter(|n: &f64| (1.0..=16_384.0).contains(n))
        .ok_or_else(|| "write a number of pixels from 1 to 16384".to_owned())
}
