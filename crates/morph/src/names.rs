//! Things called by name, and what is said of a name that nothing has. Decision: one table for each kind feeds recipes, lists
//! and tests.

/// A name that nothing of its kind has.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("no {what} is called `{name}`; there are {known}")]
pub struct UnknownName {
    /// What was looked for.
    pub what: &'static str,
    /// The name given.
    pub name: String,
    /// The names there are.
    pub known: String,
}

/// Something with its name, and its meaning in a few words.
pub(crate) type Named<T> = (T, &'static str, &'static str);

/// The thing of that name.
pub(crate) fn by_name<T: Copy>(
    what: &'static str,
    table: &[Named<T>],
    name: &str,
) -> Result<T, UnknownName> {
    let found = table.iter().find(|row| row.1 == name);
    found.map(|row| row.0).ok_or_else(|| UnknownName {
        what,
        name: name.to_owned(),
        known: table.iter().map(|row| row.1).collect::<Vec<_>>().join(", "),
    })
}

/// Name and meaning of a thing; every one of its kind has a row.
pub(crate) fn row_of<T: Copy + PartialEq>(
    table: &'static [Named<T>],
    thing: T,
) -> (&'static str, &'static str) {
    let found = table.iter().find(|row| row.0 == thing);
    found.map_or(("", ""), |row| (row.1, row.2))
}
