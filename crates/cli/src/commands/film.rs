//! Where the frames of a morph go: numbered images, one image, or a film.

use super::super::frames::{Frame, Frames, Pattern};
use super::super::sequence::{Record, is_finished};
use super::{Morph, image_format};
use crate::arguments::MorphOptions;
use crate::error::Failure;
use crate::files::{self, Pending};
use anamorph_io::Lost;
use anamorph_io::images::{ImageFile, ImageFormat, Y4m};
use anamorph_preview::{Animation, AnimationFormat, Picture};
use anamorph_raster::Raster;
use anamorph_raster::colour::Srgb8;
use serde_json::json;
use std::io::Write;
use std::path::{Path, PathBuf};

/// The form of the result.
#[derive(Default)]
pub(super) enum Output {
    /// Numbered images.
    Numbered(Pattern, ImageFormat),
    /// One image.
    Single(PathBuf, ImageFormat),
    /// A film of at most 256 colours a frame, or of all.
    Animation(PathBuf, AnimationFormat),
    /// A film without compression.
    #[default]
    Y4m,
}

/// What has been written.
#[derive(Clone, Copy)]
pub(super) struct Written {
    /// Frames that were there already.
    pub(super) kept: usize,
    pub(super) is_film: bool,
}

/// Draws a frame.
type Draw<'a> = dyn FnMut(&Frame) -> Result<ImageFile, Failure> + 'a;

impl Output {
    pub(super) fn of(options: &MorphOptions) -> Result<Self, Failure> {
        let path = &options.output;
        if options.at.is_some() {
            let format = image_format(path).ok_or_else(|| {
                Failure::usage(format!(
                    "{}: with --at the result is one image; name it .png, .jpg, .tif, .webp or .exr",
                    files::shown_output(path)
                ))
            })?;
            return Ok(Self::Single(path.clone(), format));
        }
        let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        match (Pattern::find(path), extension.as_deref()) {
            _ if files::is_stream(path) => Ok(Self::Y4m),
            (Some(pattern), _) => match image_format(path) {
                Some(format) => Ok(Self::Numbered(pattern, format)),
                None => Err(Failure::usage(format!(
                    "{}: numbered frames are images; name them .png, .jpg, .tif, .webp or .exr",
                    path.display()
                ))),
            },
            (None, Some("y4m")) => Ok(Self::Y4m),
            (None, Some("gif")) => Ok(Self::Animation(path.clone(), AnimationFormat::Gif)),
            (None, Some("apng")) => Ok(Self::Animation(path.clone(), AnimationFormat::Apng)),
            (None, Some(_)) if image_format(path).is_some() => Err(Failure::usage(format!(
                "{}: say where the frames' numbers go, as in out.%04d.png; or name a film .gif, .apng or .y4m; or ask for one image with \
                 --at 0.5",
                path.display()
            ))),
            _ => Err(Failure::usage(format!(
                "{}: a morph is numbered images (out.%04d.png, .exr, …), a film (.gif, .apng, .y4m), or `-`, a y4m film on standard output",
                path.display()
            ))),
        }
    }

    /// Refuses results that exist, that are inputs, or that could not be.
    pub(super) fn check(
        &self,
        options: &MorphOptions,
        frames: Option<&Frames>,
        inputs: &[PathBuf],
    ) -> Result<(), Failure> {
        let known = |path: &Path| (!files::is_stream(path)).then(|| files::identity(path));
        let inputs: Vec<PathBuf> = inputs.iter().filter_map(|path| known(path)).collect();
        let refuse = |path: &Path| match known(path).filter(|own| inputs.contains(own)) {
            Some(_) => Err(Failure::usage(format!(
                "{}: the result would replace what it is made from; choose another name",
                path.display()
            ))),
            None => Ok(()),
        };
        if let Some(path) = &options.report {
            if files::is_stream(path) {
                return Err(Failure::usage("--report: name a file"));
            }
            refuse(path)?;
            if known(path) == known(&options.output) {
                return Err(Failure::usage(
                    "the result and its report need files of their own",
                ));
            }
            files::refuse_existing(path, options.force)?;
        }
        match (self, frames) {
            (Self::Numbered(pattern, _), Some(frames)) => {
                for frame in frames.all() {
                    let path = pattern.path(frame.number);
                    if path.exists() {
                        refuse(&path)?;
                    }
                }
                let folder = files::folder_of(&options.output);
                if folder.is_dir() {
                    Ok(())
                } else {
                    Err(Failure::new(format!(
                        "{}: its folder does not exist; make it first",
                        options.output.display()
                    )))
                }
            }
            _ => {
                refuse(&options.output)?;
                files::refuse_existing(&options.output, options.force)
            }
        }
    }

    /// Draws and writes all frames.
    pub(super) fn write(
        &self,
        morph: &Morph<'_>,
        frames: &[Frame],
        draw: &mut Draw<'_>,
        lost: &mut Lost,
    ) -> Result<Written, Failure> {
        let options = morph.options;
        let film = Written {
            kept: 0,
            is_film: true,
        };
        let encode = |image: &ImageFile, format| {
            image
                .encode(format, &morph.encoding())
                .map_err(Failure::new)
        };
        match self {
            Self::Single(path, format) => {
                let (bytes, more) = encode(&draw(&frames[0])?, *format)?;
                *lost = more;
                put(path, &bytes, options.force)?;
                Ok(Written {
                    kept: 0,
                    is_film: false,
                })
            }
            Self::Numbered(pattern, format) => {
                let mut kept = 0;
                let record = morph.record();
                let path = pattern.record();
                let all = morph.frames.as_ref();
                let known = match all {
                    Some(all) => record.check(&path, options.force, all, pattern)?,
                    None => true,
                };
                if !known {
                    record.write(&path)?;
                }
                for frame in frames {
                    let path = pattern.path(frame.number);
                    if !options.force && is_finished(&path) {
                        kept += 1;
                        continue;
                    }
                    let (bytes, more) = encode(&draw(frame)?, *format)?;
                    *lost = more;
                    put(&path, &bytes, true)?;
                }
                Ok(Written {
                    kept,
                    is_film: false,
                })
            }
            Self::Animation(path, format) => {
                let rate = morph.frames.as_ref().map_or(24.0, Frames::rate);
                fill(path, options.force, |out| {
                    let mut film =
                        Animation::new(out, *format, frames.len(), rate).map_err(Failure::new)?;
                    for frame in frames {
                        let image = draw(frame)?;
                        film.push(&seen(&image, lost)?).map_err(Failure::new)?;
                    }
                    film.finish().map_err(Failure::new)
                })?;
                Ok(film)
            }
            Self::Y4m => {
                let rate = morph.frames.as_ref().map_or(24.0, Frames::rate);
                fill(&options.output, options.force, |out| {
                    let mut film = None;
                    let failed = |error: std::io::Error| Failure::written(&options.output, &error);
                    let mut out = Some(out);
                    for frame in frames {
                        let image = draw(frame)?;
                        let picture = image.colours().map_err(Failure::new)?;
                        note_clipped(&image, &picture, lost);
                        if film.is_none()
                            && let Some(out) = out.take()
                        {
                            let size = [picture.width(), picture.height()];
                            film = Some(
                                Y4m::new(out, size, picture.channels(), rate).map_err(failed)?,
                            );
                        }
                        if let Some(film) = &mut film {
                            film.push(&picture).map_err(Failure::new)?.map_err(failed)?;
                        }
                    }
                    film.map_or(Ok(()), |film| film.finish().map_err(failed))
                })?;
                Ok(film)
            }
        }
    }
}

/// Writes a whole file.
fn put(path: &Path, bytes: &[u8], replace: bool) -> Result<(), Failure> {
    let mut file = Pending::create(path, replace)?;
    file.fill(|out| out.write_all(bytes))?;
    files::keep_all([file])
}

/// Fills a file by what can fail for reasons of its own.
fn fill(
    path: &Path,
    replace: bool,
    content: impl FnOnce(&mut dyn Write) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let mut file = Pending::create(path, replace)?;
    let mut result = Ok(());
    file.fill(|out| {
        result = content(out);
        Ok(())
    })?;
    result?;
    files::keep_all([file])
}

/// Notes light that a film of codes cannot show, once.
fn note_clipped(image: &ImageFile, picture: &Raster, lost: &mut Lost) {
    const NOTE: &str = "light below 0 or above 1";
    let is_open = image.format() == ImageFormat::OpenExr;
    if is_open && !lost.0.iter().any(|note| note == NOTE) {
        let clipped = |light: &f32| !(-1e-3..=1.001).contains(light);
        if picture.samples().iter().any(clipped) {
            lost.0.push(NOTE.to_owned());
        }
    }
}

/// An image as films without opacity show it: before white.
fn seen(image: &ImageFile, lost: &mut Lost) -> Result<Picture, Failure> {
    let raster = image.colours().map_err(Failure::new)?;
    note_clipped(image, &raster, lost);
    let channels = raster.channels();
    let has_alpha = matches!(channels, 2 | 4);
    if has_alpha && !lost.0.iter().any(|note| note.starts_with("alpha")) {
        lost.0
            .push("alpha: the film stands before white".to_owned());
    }
    let table = Srgb8::new();
    let mut pixels = Vec::with_capacity(3 * raster.width() * raster.height());
    for pixel in raster.samples().chunks_exact(channels) {
        let beyond = if has_alpha {
            1.0 - pixel[channels - 1]
        } else {
            0.0
        };
        let light = |i: usize| table.encode(pixel[i] + beyond);
        let colours = if channels < 3 { [0; 3] } else { [0, 1, 2] };
        pixels.extend(colours.map(light));
    }
    let size = |side: usize| u32::try_from(side).map_err(Failure::new);
    Picture::from_rgb(&pixels, size(raster.width())?, size(raster.height())?).map_err(Failure::new)
}

impl Morph<'_> {
    /// What tells these frames from others.
    fn record(&self) -> Record {
        let options = self.options;
        let file = |path: &PathBuf| match std::fs::metadata(path) {
            Ok(found) => {
                let time = found.modified().ok();
                let time = time.and_then(|t| t.duration_since(std::time::UNIX_EPOCH).ok());
                json!([
                    path.display().to_string(),
                    found.len(),
                    time.map(|t| t.as_micros() as u64)
                ])
            }
            Err(_) => json!(path.display().to_string()),
        };
        let files: Vec<_> = super::inputs(options, &self.sources)
            .iter()
            .map(file)
            .collect();
        let recipes = self.steps.iter().map(|step| step.recipe().fingerprint());
        let recipes: Vec<String> = recipes.map(|number| format!("{number:016x}")).collect();
        let drawing = format!(
            "{:?} {:?} {:?} {:?} {:?}",
            options.pixels.filter,
            options.pixels.edge,
            options.pixels.max_error,
            options.fit,
            options.draw_features
        );
        Record(json!({
            "anamorph": "frames",
            "inputs": files,
            "recipes": recipes,
            "drawing": drawing,
            "frames": self.frames.as_ref().map(Frames::count),
            "first": self.frames.as_ref().map(Frames::first),
        }))
    }
}
