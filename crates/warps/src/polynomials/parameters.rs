//! How recipes describe polynomial warps.
//!
//! *Source*: Wolberg 1990, §3.6; the notation is that of the warp `points` (Milliron et al. 2002, §3.2).

use super::{PolynomialError, PolynomialWarp};
use crate::radial::parameters::{LandmarkParameters, landmarks};
use anamorph_catalog::schemars::JsonSchema;
use anamorph_catalog::{Built, ConstructError, Context, Value, WarpEntry, parse, schemars};
use anamorph_core::Space;
use serde::Deserialize;

/// A polynomial of the coordinates that carries source points near to their targets.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct PolynomialParameters {
    /// Its degree, 1 to 5; 2 if left out.
    degree: Option<usize>,
    /// The points; those of the files come before them.
    #[serde(default)]
    point: Vec<LandmarkParameters>,
    /// A file with source points, such as from `anamorph cage --points`.
    source: Option<String>,
    /// A file with their targets, one for each in the same order.
    target: Option<String>,
}

/// The registry entry of polynomial warps.
pub(crate) fn polynomial<S: Space>() -> WarpEntry<S> {
    fn construct<S: Space>(
        value: &Value,
        context: &Context<'_, S>,
    ) -> Result<Built<S>, ConstructError> {
        let p: PolynomialParameters = parse(value)?;
        let files = (p.source.as_ref(), p.target.as_ref());
        let (pairs, from_files) = landmarks(files, &p.point, context)?;
        let warp = PolynomialWarp::construct(pairs, p.degree.unwrap_or(2)).map_err(|error| {
            let path = match error {
                PolynomialError::Degree { .. } => "degree".to_owned(),
                PolynomialError::NotFinite { point } => match point.checked_sub(from_files) {
                    Some(number) => format!("point.{number}"),
                    None => "source".to_owned(),
                },
                PolynomialError::TooFew { .. } | PolynomialError::Dependent { .. } => {
                    "point".to_owned()
                }
            };
            ConstructError::new(path, error.to_string())
        })?;
        Ok(Built::new(warp.marks(), Box::new(warp)))
    }
    WarpEntry {
        kind: "polynomial",
        system: "B20",
        figure: "",
        summary: "a polynomial of the coordinates that carries points near to their targets",
        reference: "G. Wolberg, Digital Image Warping, IEEE Computer Society Press, 1990",
        example: if S::DIM == 2 {
            "degree = 2\npoint = [{ from = [\"0%\", \"0%\"] }, { from = [\"100%\", \"0%\"] }, { from = [\"0%\", \"100%\"] }, \
             { from = [\"100%\", \"100%\"] }, { from = [\"50%\", \"0%\"], by = [0, \"15%\"] }, { from = [\"50%\", \"100%\"], by = [0, \"15%\"] }, \
             { from = [\"0%\", \"50%\"] }]\n"
        } else {
            "degree = 1\npoint = [{ from = \"0%\" }, { from = [\"100%\", \"0%\", \"0%\"] }, { from = [\"0%\", \"100%\", \"0%\"], by = [\"25%\", 0, 0] }, \
             { from = [\"0%\", \"0%\", \"100%\"] }, { from = \"100%\", by = [\"20%\", 0, 0] }]\n"
        },
        schema: PolynomialParameters::json_schema,
        construct: construct::<S>,
    }
}
