//! All formats, and how the right one is found: by content first, by the extension of the name second.

use crate::formats as all;
use crate::{
    Companions, Document, Format, ReadError, ReadErrorKind, ReadOptions, Recognition, Target,
};

/// One line for each format. Earlier ones win where two are equally sure.
static FORMATS: &[&dyn Format] = &[
    &all::ply::Ply, //
    &all::off::Off,
    &all::stl::Stl,
    &all::obj::Obj,
    &all::csv::Csv,
    &all::gltf::Gltf,
    &all::gltf::Glb,
];

/// One line for each format that can be written anew.
static TARGETS: &[Target] = &[
    Target {
        name: "obj",
        title: "Wavefront OBJ",
        extensions: &["obj"],
        create: all::obj::create,
    },
    Target {
        name: "ply",
        title: "PLY, binary",
        extensions: &["ply"],
        create: all::ply::create,
    },
    Target {
        name: "stl",
        title: "STL, binary",
        extensions: &["stl"],
        create: all::stl::create,
    },
    Target {
        name: "off",
        title: "OFF",
        extensions: &["off"],
        create: all::off::create,
    },
    Target {
        name: "csv",
        title: "CSV points",
        extensions: &["csv"],
        create: all::csv::create,
    },
    Target {
        name: "glb",
        title: "binary glTF 2.0",
        extensions: &["glb"],
        create: all::gltf_create::create,
    },
    Target {
        name: "gltf",
        title: "glTF 2.0",
        extensions: &["gltf"],
        create: all::gltf_create::create_text,
    },
];

/// How much of a file is looked at to recognise it. Comments at the beginning of a file may be long.
const HEAD: usize = 1 << 16;

/// All formats.
#[must_use]
pub fn formats() -> &'static [&'static dyn Format] {
    FORMATS
}

/// All formats that a [`Geometry`](crate::Geometry) can be written in.
#[must_use]
pub fn targets() -> &'static [Target] {
    TARGETS
}

/// The format of a file from its beginning (or all) and, where that does not decide, the extension of its name. A file
/// whose content one format is certain of is of that format, whatever its name.
///
/// # Errors
/// [`ReadErrorKind::UnknownFormat`] when neither decides, or [`ReadErrorKind::Encoding`] when the reason is UTF-16 and
/// [`ReadErrorKind::NoPoints`] when there is no content.
pub fn find(head: &[u8], name: Option<&str>) -> Result<&'static dyn Format, ReadError> {
    let head = &head[..head.len().min(HEAD)];
    let extension = name
        .and_then(|name| name.rsplit_once('.'))
        .map(|(_, extension)| extension.to_ascii_lowercase());
    let named = |format: &dyn Format| {
        extension
            .as_deref()
            .is_some_and(|e| format.extensions().contains(&e))
    };
    let rated = FORMATS
        .iter()
        .map(|format| (format.recognises(head), named(*format), *format));
    // max_by_key takes the last of equals, hence the reversal.
    let best = rated
        .rev()
        .max_by_key(|(recognition, named, _)| (*recognition, *named));
    if let Some((recognition, named, format)) = best
        && (recognition > Recognition::No || named)
    {
        return Ok(format);
    }
    if let Some(error) = crate::text::is_wide(head)
        .then(|| crate::text::encoding_error(head, ""))
        .flatten()
    {
        return Err(error);
    }
    if head.is_empty() {
        return Err(ReadError::new(
            ReadErrorKind::NoPoints,
            "there is nothing in it",
            "check what was to write it",
        ));
    }
    let known: Vec<&str> = FORMATS.iter().map(|format| format.name()).collect();
    Err(ReadError::new(
        ReadErrorKind::UnknownFormat,
        "neither the content nor the name tells what kind of file this is",
        format!("give a file of one of these formats: {}", known.join(", ")),
    ))
}

/// Reads a file of any known format: [`find`], then [`Format::read`].
///
/// # Errors
/// As of those two.
pub fn read(
    bytes: Vec<u8>,
    name: Option<&str>,
    options: &ReadOptions,
) -> Result<Box<dyn Document>, ReadError> {
    find(&bytes, name)?.read(bytes, options)
}

/// As [`read()`], for a file that may keep part of its data in others.
///
/// # Errors
/// As of [`find`] and [`Format::read_with`].
pub fn read_with(
    bytes: Vec<u8>,
    name: Option<&str>,
    options: &ReadOptions,
    companions: &dyn Companions,
) -> Result<Box<dyn Document>, ReadError> {
    find(&bytes, name)?.read_with(bytes, options, companions)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_well_formed() {
        let mut seen = std::collections::BTreeSet::new();
        for format in formats() {
            assert!(
                format
                    .name()
                    .chars()
                    .all(|c| c.is_ascii_lowercase() || c.is_ascii_digit())
            );
            assert!(!format.title().is_empty());
            assert!(format.extensions().contains(&format.name()));
            for extension in format.extensions() {
                assert!(seen.insert(*extension), "{extension} is claimed twice");
            }
            assert_eq!(format.recognises(b""), Recognition::No);
        }
    }

    #[test]
    fn content_wins_over_the_name() {
        assert_eq!(
            find(b"v 0 0 0\n", Some("points.csv")).unwrap().name(),
            "obj"
        );
        assert_eq!(find(b"x,y\n1,2\n", Some("a.b.OBJ")).unwrap().name(), "csv");
        assert_eq!(
            find(b"\xEF\xBB\xBF# head\n\n  v 0 0 0", None)
                .unwrap()
                .name(),
            "obj"
        );
        assert_eq!(find(b"", Some("x.obj")).unwrap().name(), "obj");
        assert_eq!(find(b"1,2\n3,4\n", Some("x.CSV")).unwrap().name(), "csv");
        assert_eq!(
            find(b"\x89PNG\r\n", None).err().unwrap().kind,
            ReadErrorKind::UnknownFormat
        );
        assert_eq!(
            find(b"\xFF\xFEv\0 \0", None).err().unwrap().kind,
            ReadErrorKind::Encoding
        );
        assert_eq!(find(b"", None).err().unwrap().kind, ReadErrorKind::NoPoints);
    }
}
