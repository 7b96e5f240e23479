//! What is known of a registered ease: names, parameters, how it is built.
//!
//! Recipes, lists and galleries read this table; laws are tested over it.

use super::Ease;
use super::table::EASES;
use crate::CurveError;

/// The value of a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Setting<'a> {
    /// A number.
    Number(f64),
    /// One of a few words.
    Word(&'a str),
    /// Stops, (time, value).
    Stops(&'a [(f64, f64)]),
}

impl Setting<'_> {
    fn kind(&self) -> &'static str {
        match self {
            Self::Number(_) => "a number",
            Self::Word(_) => "a word",
            Self::Stops(_) => "a list of stops",
        }
    }
}

impl From<f64> for Setting<'_> {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

/// A parameter of an ease.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EaseParameter {
    /// Its name in recipes.
    pub name: &'static str,
    /// What it means, with its range.
    pub summary: &'static str,
    /// What it is when left out.
    pub default: Setting<'static>,
}

/// The settings of all parameters of an ease: those given, and the defaults of the others.
pub struct Settings<'a> {
    parameters: &'static [EaseParameter],
    given: &'a [(&'a str, Setting<'a>)],
}

impl<'a> Settings<'a> {
    fn get(&self, index: usize) -> (&'static str, Setting<'a>) {
        let Some(parameter) = self.parameters.get(index) else {
            return ("", Setting::Number(0.0));
        };
        let given = self
            .given
            .iter()
            .rev()
            .find(|(name, _)| *name == parameter.name);
        (
            parameter.name,
            given.map_or(parameter.default, |(_, setting)| *setting),
        )
    }
    pub(super) fn number(&self, index: usize) -> Result<f64, CurveError> {
        match self.get(index) {
            (_, Setting::Number(number)) => Ok(number),
            (name, other) => Err(wrong_kind(name, &other, "a number")),
        }
    }
    pub(super) fn word(&self, index: usize) -> Result<&'a str, CurveError> {
        match self.get(index) {
            (_, Setting::Word(word)) => Ok(word),
            (name, other) => Err(wrong_kind(name, &other, "a word")),
        }
    }
    pub(super) fn stops(&self, index: usize) -> Result<&'a [(f64, f64)], CurveError> {
        match self.get(index) {
            (_, Setting::Stops(stops)) => Ok(stops),
            (name, other) => Err(wrong_kind(name, &other, "a list of stops")),
        }
    }
}

fn wrong_kind(name: &'static str, found: &Setting<'_>, needed: &'static str) -> CurveError {
    CurveError::WrongKind {
        name,
        found: found.kind(),
        needed,
    }
}

/// An ease in the registry.
pub struct EaseEntry {
    /// Its name in recipes and lists.
    pub name: &'static str,
    /// Further names.
    pub aliases: &'static [&'static str],
    /// What it is, in a few words.
    pub title: &'static str,
    /// Where it comes from.
    pub reference: &'static str,
    /// Its parameters; positions are those that the builder reads.
    pub parameters: &'static [EaseParameter],
    /// Settings with which it is shown; defaults for the rest.
    pub example: &'static [(&'static str, Setting<'static>)],
    pub(super) build: fn(&Settings<'_>) -> Result<Box<dyn Ease>, CurveError>,
}

impl core::fmt::Debug for EaseEntry {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("EaseEntry")
            .field("name", &self.name)
            .field("parameters", &self.parameters)
            .finish_non_exhaustive()
    }
}

impl EaseEntry {
    /// Builds the ease from named settings; those left out have their defaults.
    ///
    /// # Errors
    /// [`CurveError::UnknownName`] for a parameter that it does not have, [`CurveError::WrongKind`],
    /// [`CurveError::OutOfRange`].
    pub fn construct(&self, given: &[(&str, Setting<'_>)]) -> Result<Box<dyn Ease>, CurveError> {
        let strange = given
            .iter()
            .find(|(name, _)| self.parameters.iter().all(|known| known.name != *name));
        if let Some((name, _)) = strange {
            let known: Vec<&str> = self.parameters.iter().map(|known| known.name).collect();
            return Err(CurveError::UnknownName {
                what: "parameter of this ease",
                name: (*name).to_owned(),
                known: if known.is_empty() {
                    "none".to_owned()
                } else {
                    known.join(", ")
                },
            });
        }
        (self.build)(&Settings {
            parameters: self.parameters,
            given,
        })
    }

    /// Whether it has that name or alias.
    pub fn is_called(&self, name: &str) -> bool {
        self.name == name || self.aliases.contains(&name)
    }
}

/// The entry of that name or alias.
pub fn entry(name: &str) -> Option<&'static EaseEntry> {
    EASES.iter().find(|entry| entry.is_called(name))
}

/// Builds the ease of that name or alias.
///
/// # Errors
/// [`CurveError::UnknownName`], and as [`EaseEntry::construct`].
pub fn ease(name: &str, given: &[(&str, Setting<'_>)]) -> Result<Box<dyn Ease>, CurveError> {
    match entry(name) {
        Some(entry) => entry.construct(given),
        None => {
            let names: Vec<&str> = EASES.iter().map(|entry| entry.name).collect();
            Err(CurveError::UnknownName {
                what: "ease",
                name: name.to_owned(),
                known: names.join(", "),
            })
        }
    }
}

/// All eases.
pub fn registry() -> &'static [EaseEntry] {
    EASES
}
