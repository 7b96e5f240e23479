//! `anamorph schema`: the JSON Schema of recipes.

use crate::error::{Failure, output};
use anamorph::registry;
use std::io::Write;

pub(crate) fn run() -> Result<(), Failure> {
    let schema = anamorph_recipe::schema(&registry::plane(), &registry::solid());
    let text = serde_json::to_string_pretty(&schema).map_err(Failure::new)?;
    writeln!(std::io::stdout().lock(), "{text}").map_err(|error| output(&error))
}
