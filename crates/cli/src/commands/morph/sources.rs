//! What is morphed: images, and series of images that play along.

use super::super::frames::Pattern;
use crate::error::Failure;
use crate::files;
use anamorph_io::images::{ImageError, ImageFile, ImageLimits};
use anamorph_raster::Window;
use std::path::{Path, PathBuf};

/// An image, or a series of them.
pub(super) struct Source {
    /// One path a picture.
    paths: Vec<PathBuf>,
    /// As messages show it.
    name: String,
    allow_large: bool,
}

impl Source {
    /// From an argument: a file, or a pattern for a series without gaps.
    pub(super) fn of(path: &Path, allow_large: bool) -> Result<Self, Failure> {
        let name = files::shown(path);
        let one = || vec![path.to_owned()];
        let pattern = if path.exists() {
            None
        } else {
            Pattern::find(path)?
        };
        let paths = match pattern {
            None => one(),
            Some(pattern) => {
                let numbers = pattern.existing().unwrap_or_default();
                let (Some(&first), Some(&last)) = (numbers.first(), numbers.last()) else {
                    return Err(Failure::new(format!(
                        "{name}: no file of this series is there; check the folder and the number of digits"
                    )));
                };
                if let Some(gap) = (first..=last).zip(&numbers).find(|(n, found)| n != *found) {
                    return Err(Failure::new(format!(
                        "{}: this image of the series is missing (it has {} from {first} to {last}); add it",
                        pattern.path(gap.0).display(),
                        numbers.len()
                    )));
                }
                numbers.iter().map(|&n| pattern.path(n)).collect()
            }
        };
        Ok(Self {
            paths,
            name,
            allow_large,
        })
    }

    pub(super) fn name(&self) -> &str {
        &self.name
    }

    /// How many pictures there are.
    pub(super) fn count(&self) -> usize {
        self.paths.len()
    }

    pub(super) fn paths(&self) -> &[PathBuf] {
        &self.paths
    }

    /// The picture that is seen in a frame; the last one stays.
    pub(super) fn at(&self, frame: usize) -> usize {
        frame.min(self.paths.len() - 1)
    }

    /// Reads a picture.
    pub(super) fn read(&self, picture: usize) -> Result<Image, Failure> {
        let path = &self.paths[picture];
        let name = files::shown(path);
        let bytes = files::read(path)?;
        let limits = if self.allow_large {
            ImageLimits::NONE
        } else {
            ImageLimits::of_file(bytes.len())
        };
        let file = ImageFile::read(&bytes, limits).map_err(|error| {
            let more = match &error {
                ImageError::TooLarge { .. } => " with --allow-large",
                ImageError::UnknownFormat => {
                    "; morphs are of images: PNG, JPEG, TIFF, WebP, OpenEXR"
                }
                _ => "",
            };
            Failure::new(format!("{name}: {error}{more}"))
        })?;
        Ok(Image { file, name })
    }
}

/// A picture that has been read.
pub(super) struct Image {
    pub(super) file: ImageFile,
    pub(super) name: String,
}

impl Image {
    /// Whether nothing may be beyond the pixels of a layer.
    pub(super) fn is_open(&self, layer: usize) -> bool {
        let layer = &self.file.layers()[layer];
        layer.has_alpha()
            || layer
                .window()
                .is_some_and(|window| window != self.file.display())
    }

    pub(super) fn display(&self) -> Window {
        self.file.display()
    }
}
