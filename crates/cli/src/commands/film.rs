//! Where frames of images go: numbered images, one image, or a film.
//!
//! A film is written frame by frame as they are drawn, to a file that appears when it is whole, or to standard output.

use super::frames::{Frame, Frames, Pattern};
use super::sequence::{Record, is_picture};
use crate::error::{Failure, say};
use crate::files::{self, Pending};
use anamorph_io::Lost;
use anamorph_io::images::{EncodeOptions, ImageFile, ImageFormat, Y4m};
use anamorph_preview::{Animation, AnimationFormat, Picture};
use anamorph_raster::Raster;
use anamorph_raster::colour::Srgb8;
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
    /// Frames that were there, but not whole, and were made again.
    pub(super) again: usize,
    pub(super) is_film: bool,
}

/// Draws a frame.
type Draw<'a> = dyn FnMut(&Frame) -> Result<ImageFile, Failure> + 'a;

/// How frames are written.
pub(super) struct Writing<'a> {
    pub(super) path: &'a Path,
    /// Whether results may replace what exists.
    pub(super) force: bool,
    pub(super) encoding: EncodeOptions,
    /// Pixels that every frame shows.
    pub(super) size: [usize; 2],
    pub(super) frames: Option<&'a Frames>,
}

impl Writing<'_> {
    fn rate(&self) -> f64 {
        self.frames.map_or(24.0, Frames::rate)
    }
}

/// The format of images that a path names.
fn image_format(path: &Path) -> Option<ImageFormat> {
    ImageFormat::of_extension(path.extension()?.to_str()?)
}

impl Output {
    /// The film that a path names, if it names one.
    pub(super) fn film(path: &Path) -> Result<Option<Self>, Failure> {
        if files::is_stream(path) {
            return Ok(Some(Self::Y4m));
        }
        if Pattern::find(path)?.is_some() {
            return Ok(None);
        }
        let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        Ok(match extension.as_deref() {
            Some("y4m") => Some(Self::Y4m),
            Some("gif") => Some(Self::Animation(path.to_owned(), AnimationFormat::Gif)),
            Some("apng") => Some(Self::Animation(path.to_owned(), AnimationFormat::Apng)),
            _ => None,
        })
    }

    /// What a path names; `single` where one image is asked for.
    pub(super) fn of(path: &Path, single: bool) -> Result<Self, Failure> {
        if single {
            let format = image_format(path).ok_or_else(|| {
                Failure::usage(format!(
                    "{}: with --at the result is one image; name it .png, .jpg, .tif, .webp or .exr",
                    files::shown_output(path)
                ))
            })?;
            return Ok(Self::Single(path.to_owned(), format));
        }
        if let Some(film) = Self::film(path)? {
            return Ok(film);
        }
        match Pattern::find(path)? {
            Some(pattern) => match image_format(path) {
                Some(format) => Ok(Self::Numbered(pattern, format)),
                None => Err(Failure::usage(format!(
                    "{}: numbered frames are images; name them .png, .jpg, .tif, .webp or .exr",
                    path.display()
                ))),
            },
            None if image_format(path).is_some() => Err(Failure::usage(format!(
                "{}: say where the frames' numbers go, as in out.%04d.png; or name a film .gif, .apng or .y4m; or ask for one image with \
                 --at 0.5",
                path.display()
            ))),
            None => Err(Failure::usage(format!(
                "{}: a morph is numbered images (out.%04d.png, .exr, …), a film (.gif, .apng, .y4m), or `-`, a y4m film on standard output",
                path.display()
            ))),
        }
    }

    /// Refuses results that exist, that are inputs, or that could not be.
    pub(super) fn check(
        &self,
        writing: &Writing<'_>,
        report: Option<&PathBuf>,
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
        if let Some(path) = report {
            if files::is_stream(path) {
                return Err(Failure::usage("--report: name a file"));
            }
            refuse(path)?;
            if known(path) == known(writing.path) {
                return Err(Failure::usage(
                    "the result and its report need files of their own",
                ));
            }
            files::refuse_existing(path, writing.force)?;
        }
        match (self, writing.frames) {
            (Self::Numbered(pattern, _), Some(frames)) => {
                for frame in frames.all() {
                    let path = pattern.path(frame.number);
                    if path.exists() {
                        refuse(&path)?;
                    }
                }
                let folder = files::folder_of(writing.path);
                if folder.is_dir() {
                    Ok(())
                } else {
                    Err(Failure::new(format!(
                        "{}: its folder does not exist; make it first",
                        writing.path.display()
                    )))
                }
            }
            _ => {
                refuse(writing.path)?;
                files::refuse_existing(writing.path, writing.force)
            }
        }
    }

    /// Says how a film's clock shows a rate that is asked for and not among its own.
    pub(super) fn say_rate(&self, frames: &Frames) {
        let Some(rate) = frames.asked_rate() else {
            return;
        };
        if !matches!(self, Self::Animation(_, AnimationFormat::Gif)) {
            return;
        }
        let hundredths = 100.0 / rate;
        if hundredths < 2.0 {
            say!(
                "  note: GIF shows at most 50 frames a second, so the film is slower; .apng and .y4m hold {} a second",
                files::short(rate)
            );
        } else if hundredths.fract() != 0.0 {
            let (short, long) = (hundredths.floor(), hundredths.ceil());
            say!(
                "  note: GIF counts hundredths of a second, so frames are shown for {short} or {long} of them; together they last as long \
                 as they should"
            );
        }
    }

    /// Draws and writes all frames; `record` says what numbered ones are made from.
    pub(super) fn write(
        &self,
        writing: &Writing<'_>,
        frames: &[Frame],
        record: &dyn Fn() -> Result<Record, Failure>,
        draw: &mut Draw<'_>,
        lost: &mut Lost,
    ) -> Result<Written, Failure> {
        let film = Written {
            kept: 0,
            again: 0,
            is_film: true,
        };
        let encode = |image: &ImageFile, format| {
            image
                .encode(format, &writing.encoding)
                .map_err(Failure::new)
        };
        match self {
            Self::Single(path, format) => {
                let (bytes, more) = encode(&draw(&frames[0])?, *format)?;
                *lost = more;
                put(path, &bytes, writing.force)?;
                Ok(Written {
                    kept: 0,
                    again: 0,
                    is_film: false,
                })
            }
            Self::Numbered(pattern, format) => {
                let (mut kept, mut again) = (0, 0);
                if let Some(all) = writing.frames {
                    let (record, path) = (record()?, pattern.record());
                    if !record.check(&path, writing.force, all, pattern)? {
                        record.begin(&path, all, pattern)?;
                    }
                }
                for frame in frames {
                    let path = pattern.path(frame.number);
                    if !writing.force && path.exists() {
                        if is_picture(&path, *format, Some(writing.size)) {
                            kept += 1;
                            continue;
                        }
                        again += 1;
                    }
                    let (bytes, more) = encode(&draw(frame)?, *format)?;
                    *lost = more;
                    put(&path, &bytes, true)?;
                }
                Ok(Written {
                    kept,
                    again,
                    is_film: false,
                })
            }
            Self::Animation(path, format) => {
                fill(path, writing.force, |out| {
                    let mut film = Animation::new(out, *format, frames.len(), writing.rate())
                        .map_err(Failure::new)?;
                    for frame in frames {
                        let image = draw(frame)?;
                        film.push(&seen(&image, lost)?).map_err(Failure::new)?;
                    }
                    film.finish().map_err(Failure::new)
                })?;
                Ok(film)
            }
            Self::Y4m => {
                let rate = writing.rate();
                fill(writing.path, writing.force, |out| {
                    let mut film = None;
                    let failed = |error: std::io::Error| Failure::written(writing.path, &error);
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
pub(super) fn fill(
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
