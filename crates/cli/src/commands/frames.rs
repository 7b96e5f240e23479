//! `anamorph warp --frames`: a recipe over time as numbered files, the model read once.
//!
//! A frame that exists is finished, because files appear whole; a run that was interrupted goes on where it stopped.

use crate::arguments::WarpOptions;
use crate::error::{Failure, say};
use crate::files;
use std::path::{Path, PathBuf};

/// Frames of a run at most.
const MOST_FRAMES: usize = 1_000_000;

/// Frames a second if nothing is said.
const RATE: f64 = 24.0;

/// Which frames are asked for, and what their files are called.
#[derive(Debug)]
pub(crate) struct Frames {
    count: usize,
    first: i64,
    range: (i64, i64),
    fps: Option<f64>,
}

/// A frame of the run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Frame {
    /// Its number in file names.
    pub(crate) number: i64,
    /// Its time, from 0 to 1.
    pub(crate) time: f64,
}

impl Frames {
    /// From `--frames`, `--start` and `--range`.
    pub(crate) fn of(options: &WarpOptions) -> Result<Option<Self>, Failure> {
        let Some(count) = options.frames else {
            return Ok(None);
        };
        Self::new(count, options.start, options.range, options.fps).map(Some)
    }

    /// So many frames from a first number on, those of a range, at a rate.
    pub(crate) fn new(
        count: usize,
        first: i64,
        range: Option<(i64, i64)>,
        fps: Option<f64>,
    ) -> Result<Self, Failure> {
        if !(2..=MOST_FRAMES).contains(&count) {
            return Err(Failure::usage(format!(
                "--frames: write a number from 2 to {MOST_FRAMES}"
            )));
        }
        let span = i64::try_from(count).unwrap_or(i64::MAX) - 1;
        let last = first.checked_add(span).ok_or_else(|| {
            Failure::usage(format!(
                "--start {first}: the numbers of the frames are too large"
            ))
        })?;
        let range = range.unwrap_or((first, last));
        if range.0 < first || range.1 > last || range.1 < range.0 {
            return Err(Failure::usage(format!(
                "--range {}-{}: the frames are {first} to {last}",
                range.0, range.1
            )));
        }
        Ok(Self {
            count,
            first,
            range,
            fps,
        })
    }

    /// Frames a second.
    pub(crate) fn rate(&self) -> f64 {
        self.fps.unwrap_or(RATE)
    }

    /// Frames a second, where they are asked for.
    pub(crate) fn asked_rate(&self) -> Option<f64> {
        self.fps
    }

    /// How many frames the recipe's whole time has.
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// The numbers of the frames outside of the range.
    pub(crate) fn others(&self) -> impl Iterator<Item = i64> + '_ {
        let last = self.first + i64::try_from(self.count).unwrap_or(i64::MAX) - 1;
        (self.first..=last).filter(|n| !(self.range.0..=self.range.1).contains(n))
    }

    /// The number of the first frame of the whole time.
    pub(crate) fn first(&self) -> i64 {
        self.first
    }

    /// Says how long a film of numbered files is, where a rate was given.
    pub(crate) fn say_length(&self) {
        if let Some(rate) = self.fps {
            #[allow(clippy::cast_precision_loss)]
            let seconds = (self.range.1 - self.range.0 + 1) as f64 / rate;
            say!(
                "  note: numbered files have no rate; at {} frames a second these are a film of {} seconds",
                files::short(rate),
                files::short(seconds)
            );
        }
    }

    /// The frames of the range, in order.
    pub(crate) fn all(&self) -> impl Iterator<Item = Frame> + '_ {
        #[allow(clippy::cast_precision_loss)]
        let last = (self.count - 1) as f64;
        (self.range.0..=self.range.1).map(move |number| {
            #[allow(clippy::cast_precision_loss)]
            let step = (number - self.first) as f64;
            Frame {
                number,
                time: step / last,
            }
        })
    }
}

/// Digits of a frame's number at most.
const MOST_DIGITS: usize = 20;

/// A file name with a place for the frame's number: `%04d`, `%d` or a run of `#`.
#[derive(Debug, PartialEq)]
pub(crate) struct Pattern {
    before: String,
    digits: usize,
    after: String,
}

impl Pattern {
    /// The pattern in a path's file name; `what` is the option that the path was given by.
    pub(crate) fn of(path: &Path, what: &str) -> Result<Self, Failure> {
        Self::find(path)?.ok_or_else(|| {
            let or = if what == "--output" {
                "; or name a .glb, for one file with an animation"
            } else {
                ""
            };
            Failure::usage(format!(
                "{what} {}: say where the frame's number goes, as in out.%04d.obj or out.####.obj{or}",
                path.display()
            ))
        })
    }

    /// The pattern in a path's file name, if there is one.
    ///
    /// # Errors
    /// Two places for numbers, more digits than numbers have, and a `%` before something else than a whole number.
    pub(crate) fn find(path: &Path) -> Result<Option<Self>, Failure> {
        let Some(name) = path.file_name().map(|name| name.to_string_lossy()) else {
            return Ok(None);
        };
        let wrong = |what: String| Err(Failure::usage(format!("{}: {what}", path.display())));
        let Some((from, to, digits)) = Self::signs(&name) else {
            return match Self::foreign_sign(&name) {
                Some(sign) => wrong(format!(
                    "`{sign}` is no place for a frame's number; write %04d or ####"
                )),
                None => Ok(None),
            };
        };
        if digits > MOST_DIGITS {
            return wrong(format!(
                "`{}` asks for {digits} digits, and a number has {MOST_DIGITS} at most; write %04d",
                &name[from..to]
            ));
        }
        for rest in [&name[..from], &name[to..]] {
            if let Some((second, end, _)) = Self::signs(rest) {
                return wrong(format!(
                    "`{}` and `{}` are two places for the frame's number; leave one of them",
                    &name[from..to],
                    &rest[second..end]
                ));
            }
        }
        let folder = path.with_file_name("");
        Ok(Some(Self {
            before: format!("{}{}", folder.display(), &name[..from]),
            digits,
            after: name[to..].to_owned(),
        }))
    }

    /// A place for something else than a whole number, such as `%s`, `%4.1f` or `%-4d`.
    fn foreign_sign(name: &str) -> Option<&str> {
        let mut signs = name.match_indices('%').map(|(at, _)| at);
        signs.find_map(|at| {
            let rest = &name[at + 1..];
            let before = rest.find(|c: char| !(c.is_ascii_digit() || "-+.".contains(c)))?;
            let mut letters = rest[before..].chars();
            let letter = letters.next()?;
            // A word may follow a percentage, as in 50%off.png, and an extension, as in 50%.png.
            let ends = letters.next().is_none_or(|c| !c.is_alphanumeric());
            (ends && &rest[..before] != "." && "diouxXeEfgGsc".contains(letter))
                .then(|| &name[at..=at + 1 + before])
        })
    }

    /// The numbers of the files that are there, in order.
    pub(crate) fn existing(&self) -> std::io::Result<Vec<i64>> {
        let (folder, stem) = match self.before.rfind(std::path::is_separator) {
            Some(at) => self.before.split_at(at + 1),
            None => (".", self.before.as_str()),
        };
        let mut numbers = Vec::new();
        for entry in std::fs::read_dir(folder)? {
            let name = entry?.file_name().to_string_lossy().into_owned();
            let middle = name.strip_prefix(stem);
            let middle = middle.and_then(|rest| rest.strip_suffix(&self.after));
            let number = middle.and_then(|digits| digits.parse::<i64>().ok());
            // Of 7 and 007 that which the pattern writes.
            let is_own = |&n: &i64| {
                self.path(n)
                    .file_name()
                    .is_some_and(|own| own == name.as_str())
            };
            numbers.extend(number.filter(is_own));
        }
        numbers.sort_unstable();
        numbers.dedup();
        Ok(numbers)
    }

    /// Whether a path names one GLB, which all frames go into.
    pub(crate) fn is_animation(path: &Path) -> bool {
        let glb = path
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case("glb"));
        let name = path.file_name().map(|name| name.to_string_lossy());
        glb && name.is_some_and(|name| Self::signs(&name).is_none())
    }

    /// Where the first sign stands, and how many digits it asks for.
    fn signs(name: &str) -> Option<(usize, usize, usize)> {
        if let Some(from) = name.find('#') {
            let count = name[from..].bytes().take_while(|b| *b == b'#').count();
            return Some((from, from + count, count));
        }
        let mut start = 0;
        while let Some(found) = name[start..].find('%') {
            let from = start + found;
            let rest = &name[from + 1..];
            let digits: String = rest.chars().take_while(char::is_ascii_digit).collect();
            if rest[digits.len()..].starts_with('d') {
                let width = match digits.as_str() {
                    "" => 1,
                    digits => digits.parse().unwrap_or(usize::MAX).max(1),
                };
                return Some((from, from + digits.len() + 2, width));
            }
            start = from + 1;
        }
        None
    }

    /// The path of the record of what the frames were made from.
    pub(crate) fn record(&self) -> PathBuf {
        let stem = self.before.trim_end_matches(['.', '_', '-', ' ']);
        let dot = if stem.is_empty() || stem.ends_with(std::path::is_separator) {
            ""
        } else {
            "."
        };
        PathBuf::from(format!("{stem}{dot}frames.json"))
    }

    /// The path of a frame.
    pub(crate) fn path(&self, number: i64) -> PathBuf {
        let sign = if number < 0 { "-" } else { "" };
        let digits = format!("{:0width$}", number.unsigned_abs(), width = self.digits);
        PathBuf::from(format!("{}{sign}{digits}{}", self.before, self.after))
    }
}

/// Refuses options that do not fit together with frames. Images can be a film on standard output.
pub(crate) fn check(options: &WarpOptions, of_image: bool) -> Result<(), Failure> {
    if options.models.len() > 1 {
        return Err(Failure::usage("--frames takes one model"));
    }
    if files::is_stream(&options.output) && !of_image {
        return Err(Failure::usage(
            "--frames writes files; name them, as in out.%04d.obj",
        ));
    }
    if options.turntable.is_some() {
        return Err(Failure::usage(
            "--frames and --turntable are two kinds of film; choose one",
        ));
    }
    Ok(())
}

/// Says what a run left as it was, and what of that which was there it made again.
pub(crate) fn kept(count: usize, again: usize) {
    if count > 0 {
        say!("  {count} frames exist and are kept; --force writes them anew");
    }
    if again > 0 {
        say!(
            "  note: {again} frames were there, but damaged or of another size; they are made again"
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_name_frames() {
        let name = |pattern: &str, number| {
            let pattern = Pattern::of(Path::new(pattern), "--output").unwrap();
            pattern.path(number).display().to_string()
        };
        assert_eq!(name("out.%04d.obj", 7), "out.0007.obj");
        assert_eq!(name("out.####.obj", 1001), "out.1001.obj");
        assert_eq!(name("a/b%d.ply", 12), "a/b12.ply");
        assert_eq!(name("100%_##.ply", 123), "100%_123.ply");
        assert_eq!(name("100%.%02d.ply", -3), "100%.-03.ply");
        for plain in ["50%.obj", "out.png", "50%off.png", "100% done.png"] {
            assert_eq!(Pattern::find(Path::new(plain)).unwrap(), None, "{plain}");
        }
        for wrong in [
            "out.obj",
            "50%.obj",
            "a#/out.obj",
            "x.%0999d.png",
            "x.%99999999999999999999d.png",
            "x.%04d.%04d.png",
            "x.##.##.png",
            "x.%s.png",
            "x.%-4d.png",
            "x.%4.1f.png",
        ] {
            assert!(
                Pattern::of(Path::new(wrong), "--output").is_err(),
                "{wrong}"
            );
        }
    }
}
