//! `anamorph warp --frames -o out.glb`: a recipe over time as one GLB with morph targets and an animation.
//!
//! Each frame is a key. Between two keys the file goes straight and the warp may not; how far they are apart is measured at a quarter, half
//! and three quarters of the way, over all vertices, and said with the result.

use super::frames::{Frame, Frames};
use super::jobs::Job;
use super::undone::Undone;
use super::warp::{NormalsPolicy, Run, move_all, normals_policy, refuse_overflow, with_directions};
use crate::companions::Folder;
use crate::error::{Failure, say};
use crate::files::{self, Pending, short};
use crate::model::{self, ModelSpace};
use crate::progress::Progress;
use anamorph_core::{Deformation, Inverse, Plane, Solid};
use anamorph_io::{
    Document, Farthest, MorphBase, MorphKeys, MorphReport, Points, ReadOptions, WriteError,
};
use anamorph_recipe::BuiltPart;
use serde_json::{Value, json};

/// Where between two keys the error is measured, as shares of the way.
const BETWEEN: [f64; 3] = [0.25, 0.5, 0.75];

/// Writes the frames of a range as one file, the model read once.
pub(super) fn animate(job: &Job, run: &Run<'_>, frames: &Frames) -> Result<(), Failure> {
    let options = run.options;
    if job.preview.is_some() {
        return Err(Failure::usage(
            "--preview draws numbered files; write them, as in -o out.%04d.obj --preview out.%04d.png",
        ));
    }
    for (path, _) in job.results() {
        files::refuse_existing(path, options.force)?;
    }
    let read_options = ReadOptions::default()
        .allow_nonfinite(options.allow_nonfinite)
        .local(run.recipe.is_local());
    let document = model::read(&job.model, &read_options, options.allow_outside)?;
    let film = Film {
        job,
        run,
        frames: frames.all().collect(),
        count: frames.count(),
        rate: frames.rate(),
        document: document.as_ref(),
        name: files::shown(&job.model),
    };
    if film.frames.len() < 2 {
        return Err(Failure::usage(
            "--range: an animation takes at least two frames",
        ));
    }
    match document.points() {
        Points::Plane(_) => film.write::<Plane>(&read_options),
        Points::Solid(_) => film.write::<Solid>(&read_options),
    }
}

/// What is to be written.
struct Film<'a> {
    job: &'a Job,
    run: &'a Run<'a>,
    frames: Vec<Frame>,
    /// Frames of the recipe's whole time.
    count: usize,
    /// Frames a second.
    rate: f64,
    document: &'a dyn Document,
    name: String,
}

/// A distance between file and warp, and when it was found.
#[derive(Clone, Copy)]
struct Apart {
    farthest: Farthest,
    seconds: f64,
    /// Number of the frame at that time, or before it.
    frame: i64,
}

/// What was found out on the way.
#[derive(Default)]
struct Findings {
    /// Between frames, and at frames.
    between: Option<Apart>,
    at_frames: Option<Apart>,
    /// Whether each point moves at some time.
    moves: Vec<bool>,
    undone: Option<Undone>,
    policy: Option<NormalsPolicy>,
    titles: Vec<String>,
}

/// The farther one.
fn farther(known: &mut Option<Apart>, found: Option<Farthest>, seconds: f64, frame: i64) {
    if let Some(farthest) = found
        && known.is_none_or(|known| farthest.distance > known.farthest.distance)
    {
        *known = Some(Apart {
            farthest,
            seconds,
            frame,
        });
    }
}

/// The model at a time.
struct Warped<S: ModelSpace> {
    stack: Box<dyn Deformation<S>>,
    points: Vec<S>,
    policy: NormalsPolicy,
    titles: Vec<String>,
    undone: Option<Undone>,
}

impl Film<'_> {
    fn failed(&self, error: &WriteError) -> Failure {
        Failure::new(format!("{}: {error}", self.name))
    }

    /// Seconds at which a frame is shown: the first at 0.
    #[allow(clippy::cast_precision_loss)]
    fn seconds(&self, frame: usize) -> f64 {
        frame as f64 / self.rate
    }

    fn write<S: ModelSpace>(&self, read_options: &ReadOptions) -> Result<(), Failure> {
        let (job, run, options) = (self.job, self.run, self.run.options);
        let folder = Folder::of(&job.model, options.allow_outside);
        let base = MorphBase::of(self.document, read_options, &folder)
            .map_err(|error| self.failed(&error))?;
        let most = base.most_bytes(self.frames.len());
        if most > u64::from(u32::MAX) {
            return Err(Failure::new(format!(
                "{}: {} frames of {} vertices can take {most} bytes, and a GLB holds at most {}; take fewer frames (--frames, --range), or write numbered files (-o out.%04d.glb)",
                self.name,
                self.frames.len(),
                base.vertices(),
                u32::MAX
            )));
        }
        let mut model_file = Pending::create(&job.output, run.replace)?;
        let begin = |path: &std::path::PathBuf| Pending::create(path, run.replace);
        let mut report_file = job.report.as_ref().map(begin).transpose()?;
        let mut copies = run.copies(self.document, job)?;
        let folder = files::folder_of(&job.output);
        let mut storage = tempfile::tempfile_in(folder).map_err(|error| {
            let mend = files::mend(error.kind());
            Failure::new(format!(
                "{}: cannot make a temporary file: {error}{mend}",
                folder.display()
            ))
        })?;
        let rest = S::points(self.document.points()).unwrap_or_default();
        let size = model::size(&rest[..self.document.visible().min(rest.len())]);
        let mut frames = base.frames(&mut storage);
        let findings = self.evaluate(&mut frames, rest, size)?;
        let times: Vec<f64> = (0..self.frames.len()).map(|i| self.seconds(i)).collect();
        let names: Vec<String> = self
            .frames
            .iter()
            .map(|frame| format!("frame {}", frame.number))
            .collect();
        let keys = MorphKeys {
            times: &times,
            names: &names,
            animation: "warp",
        };
        let mut result = Ok(MorphReport::default());
        model_file.fill(|out| match frames.finish(&keys, out) {
            Err(WriteError::Output(error)) => Err(error),
            done => {
                result = done;
                Ok(())
            }
        })?;
        let report = result.map_err(|error| self.failed(&error))?;
        if let Some(file) = &mut report_file {
            let value = self.report(&base, &findings, &report, size);
            let text = serde_json::to_string_pretty(&value).map_err(Failure::new)?;
            file.fill(|out| writeln!(out, "{text}"))?;
        }
        let own = [report_file, Some(model_file)];
        files::keep_all(
            std::mem::take(&mut copies.files)
                .into_iter()
                .chain(own.into_iter().flatten()),
        )?;
        if !options.quiet {
            self.summary(&base, &findings, &report, size);
            copies.print();
            if let Some(undone) = &findings.undone {
                undone.print();
            }
        }
        Ok(())
    }

    /// Adds all frames, and measures between them.
    fn evaluate<S: ModelSpace>(
        &self,
        frames: &mut anamorph_io::MorphFrames<'_>,
        rest: &[S],
        size: f64,
    ) -> Result<Findings, Failure> {
        let evaluations = self.frames.len() + (self.frames.len() - 1) * BETWEEN.len();
        let total = rest.len().saturating_mul(evaluations);
        let progress = Progress::new("warping", total, self.run.options.quiet);
        let mut findings = Findings {
            moves: vec![false; self.document.visible().min(rest.len())],
            ..Findings::default()
        };
        let differs = |a: &S, b: &S| {
            (0..S::DIM).any(|axis| a.component(axis).to_bits() != b.component(axis).to_bits())
        };
        for (number, frame) in self.frames.iter().enumerate() {
            let warped = self.warped(frame.time, rest, size, &progress)?;
            let pairs = rest.iter().zip(&warped.points).zip(&mut findings.moves);
            pairs.for_each(|((old, new), moves)| *moves |= differs(old, new));
            let added = with_directions(
                warped.stack.as_ref(),
                self.document,
                size,
                warped.policy,
                &warped.points,
                |moved| frames.add(moved),
            );
            added.map_err(|error| self.failed(&error))?;
            let found = frames.farthest(1.0, &S::wrap(&warped.points));
            let seconds = self.seconds(number);
            farther(&mut findings.at_frames, found, seconds, frame.number);
            findings.policy = Some(warped.policy);
            findings.titles = warped.titles;
            if let Some(undone) = warped.undone {
                let worse = |known: &Undone| {
                    (undone.stayed.len(), undone.residual) > (known.stayed.len(), known.residual)
                };
                if findings.undone.as_ref().is_none_or(worse) {
                    findings.undone = Some(undone);
                }
            }
            let Some(before) = number.checked_sub(1).map(|before| self.frames[before]) else {
                continue;
            };
            for share in BETWEEN {
                let time = before.time + share * (frame.time - before.time);
                let warped = self.warped(time, rest, size, &progress)?;
                let found = frames.farthest(share, &S::wrap(&warped.points));
                let seconds = seconds - (1.0 - share) / self.rate;
                farther(&mut findings.between, found, seconds, before.number);
            }
        }
        Ok(findings)
    }

    /// The model as the recipe has it at a time from 0 to 1.
    fn warped<S: ModelSpace>(
        &self,
        time: f64,
        rest: &[S],
        size: f64,
        progress: &Progress,
    ) -> Result<Warped<S>, Failure> {
        let run = self.run;
        let recipe = run.recipe.at(time).map_err(Failure::new)?;
        let built = model::build(&recipe, self.document, rest, &run.beside)?;
        let results = self.job.results();
        run.beside.refuse_replacing(results.map(|(path, _)| path))?;
        let inverted = recipe.is_inverse() != run.options.invert;
        let stack: Box<dyn Deformation<S>> = if inverted {
            Box::new(Inverse::new(built.stack(), size))
        } else {
            Box::new(built.stack())
        };
        let mut points = rest.to_vec();
        let stayed = move_all(stack.as_ref(), self.document, &mut points, progress);
        refuse_overflow(&self.name, &stayed, inverted)?;
        let undone = inverted.then(|| Undone::measure(&built.stack(), rest, &points, &stayed));
        let titles = built.parts.iter().map(BuiltPart::title);
        Ok(Warped {
            points,
            policy: normals_policy(self.document, &built, stack.as_ref(), run.options),
            titles: titles.map(str::to_owned).collect(),
            undone,
            stack,
        })
    }

    fn report(
        &self,
        base: &MorphBase<'_>,
        findings: &Findings,
        report: &MorphReport,
        size: f64,
    ) -> Value {
        let apart = |apart: Option<Apart>| {
            apart.map(|apart| {
                json!({
                    "distance": apart.farthest.distance,
                    "relative": apart.farthest.distance / size,
                    "seconds": apart.seconds,
                    "frame": apart.frame,
                    "point": apart.farthest.point,
                })
            })
        };
        let mut value = json!({
            "anamorph": env!("CARGO_PKG_VERSION"),
            "model": self.name,
            "recipe": files::shown(self.run.options.recipe_path()),
            "set": self.run.options.set,
            "output": self.job.output.display().to_string(),
            "format": self.document.format(),
            "points": {
                "count": findings.moves.len(),
                "moved": findings.moves.iter().filter(|moves| **moves).count(),
                "not_finite": self.document.nonfinite().len(),
            },
            "normals": findings.policy.map(NormalsPolicy::words),
            "frames": {
                "first": self.frames.first().map(|frame| frame.number),
                "last": self.frames.last().map(|frame| frame.number),
                "count": self.frames.len(),
                "of": self.count,
                "fps": self.rate,
                "seconds": self.seconds(self.frames.len() - 1),
            },
            "animation": {
                "nodes": report.nodes,
                "targets": report.targets,
                "accessors": report.accessors,
                "sparse": report.sparse,
                "bytes": report.bytes,
            },
            "error": {
                "size": size,
                "between_frames": apart(findings.between),
                "at_frames": apart(findings.at_frames),
            },
            "notes": self.document.notes(),
        });
        if self.document.format() != "glb" {
            value["conversion"] = json!({ "to": "glb", "lost": base.lost().0 });
        }
        if let Some(undone) = &findings.undone {
            value["inverse"] = json!({ "residual": undone.residual, "stayed": undone.stayed });
        }
        value
    }

    fn summary(&self, base: &MorphBase<'_>, findings: &Findings, report: &MorphReport, size: f64) {
        let by = match findings.titles.as_slice() {
            [] => "no warp".to_owned(),
            titles => titles.join(", "),
        };
        say!(
            "{} -> {}: {by}; {} of {} points move",
            self.name,
            self.job.output.display(),
            findings.moves.iter().filter(|moves| **moves).count(),
            findings.moves.len()
        );
        say!(
            "  {} frames in {} seconds, the first at 0; {} bytes",
            self.frames.len(),
            short(self.seconds(self.frames.len() - 1)),
            report.bytes
        );
        if report.nodes == 0 {
            say!("  warning: nothing moves, so the file has no animation");
        } else {
            say!(
                "  {} morph targets ({} of {} displacements sparse), weights of {} {} animated",
                report.targets,
                report.sparse,
                report.accessors,
                report.nodes,
                if report.nodes == 1 { "node" } else { "nodes" }
            );
            let carried = [NormalsPolicy::Carried, NormalsPolicy::Recomputed];
            if let Some(policy) = findings.policy.filter(|policy| carried.contains(policy)) {
                say!("  normals {}", policy.words());
            }
            self.say_error(findings, size);
        }
        for note in self.document.notes() {
            say!("  note: {note}");
        }
        if !matches!(self.document.format(), "glb" | "gltf") {
            say!("  converted to binary glTF 2.0");
            if !base.lost().is_empty() {
                say!("  warning: GLB cannot hold: {}", base.lost());
            }
        }
        if let Some(path) = &self.job.report {
            say!("  report {}", path.display());
        }
    }

    fn say_error(&self, findings: &Findings, size: f64) {
        if let Some(apart) = findings.between {
            say!(
                "  between frames the file is up to {} from the warp ({} % of the model's size): at {} seconds, after frame {}, point {} (measured at quarters of the way)",
                short(apart.farthest.distance),
                short(100.0 * apart.farthest.distance / size),
                short(apart.seconds),
                apart.frame,
                apart.farthest.point + 1
            );
        }
        if let Some(apart) = findings.at_frames {
            say!(
                "  at frames up to {}, by rounding to 32 bits",
                short(apart.farthest.distance)
            );
        }
    }
}
