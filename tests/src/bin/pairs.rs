//! Prints what all pairs of some shapes are like: `cargo xtask pairs [--jumps] FILE…`.
//!
//! A font is followed by `:` and a text, as in `sans.ttf:A`. One line a pair, then a table over all of them for each
//! method. Exits with 1 if a pair failed; the others are measured all the same.
//!
//! *Source*: the project's own design.

use anamorph_tests::pairs::{Measured, largest_jump, load, measure};
use rayon::prelude::*;
use std::io::Write;
use std::process::ExitCode;
use std::time::Instant;

fn main() -> ExitCode {
    let mut out = std::io::stdout().lock();
    match run(&mut out) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            let _ = writeln!(std::io::stderr(), "error: {error}");
            ExitCode::from(2)
        }
    }
}

fn run(out: &mut impl Write) -> Result<bool, Box<dyn std::error::Error>> {
    let mut shapes = Vec::new();
    let mut jumps = false;
    for argument in std::env::args().skip(1) {
        if argument == "--jumps" {
            jumps = true;
            continue;
        }
        let font = argument
            .rsplit_once(':')
            .filter(|(path, _)| path.ends_with("tf"));
        let (path, text) = font.map_or((argument.as_str(), None), |(p, t)| (p, Some(t)));
        let bytes = std::fs::read(path).map_err(|error| format!("{path}: {error}"))?;
        let name = argument.rsplit('/').next().unwrap_or(&argument).to_owned();
        match load(&bytes, text) {
            Ok(parts) => shapes.push((name, parts)),
            Err(error) => writeln!(out, "left out: {name}: {error}")?,
        }
    }
    let numbers = (0..shapes.len()).flat_map(|i| (i + 1..shapes.len()).map(move |j| (i, j)));
    let numbers: Vec<(usize, usize)> = numbers.collect();
    let all: Vec<(String, Result<Measured, String>, f64)> = numbers
        .par_iter()
        .map(|&(i, j)| {
            let ((a, from), (b, to)) = (&shapes[i], &shapes[j]);
            let start = Instant::now();
            let found = measure(from, to, 3);
            let seconds = start.elapsed().as_secs_f64();
            let mut line = format!("{a} -> {b}");
            if jumps {
                match largest_jump(from, to, 60) {
                    Ok(jump) => line.push_str(&format!(" (jump {jump:.3})")),
                    Err(error) => line.push_str(&format!(" (no frames: {error})")),
                }
            }
            let mark = match &found {
                Ok(found) if found.is_good() => "ok ",
                _ => "BAD",
            };
            let what = match &found {
                Ok(f) => format!(
                    "{} parts, {} of {} triangles, angle {:.2}, {} steps, {} unfinished, smallest {:.1e}, {:?} {:?}",
                    f.couples,
                    f.triangles,
                    f.overlaid,
                    f.angle,
                    f.rows[0].steps,
                    f.rows[0].unfinished,
                    f.rows[0].smallest,
                    f.faults,
                    f.rows[0].fault
                ),
                Err(error) => error.clone(),
            };
            // Each as soon as it is there.
            let _ = writeln!(std::io::stderr(), "{mark} {line}: {what}, {seconds:.2} s");
            (line, found, seconds)
        })
        .collect();
    let good = |found: &Result<Measured, String>| found.as_ref().is_ok_and(Measured::is_good);
    writeln!(
        out,
        "{} of {} pairs without a fault",
        all.iter().filter(|(_, found, _)| good(found)).count(),
        all.len()
    )?;
    writeln!(
        out,
        "{:<22} {:>8} {:>8} {:>10} {:>10} {:>10} {:>8}",
        "method", "failed", "flips", "crossings", "overshoot", "Dirichlet", "steps"
    )?;
    for number in 0..3 {
        let rows = all
            .iter()
            .filter_map(|(_, found, _)| found.as_ref().ok()?.rows.get(number));
        let rows: Vec<_> = rows.collect();
        let Some(first) = rows.first() else { continue };
        let mut dirichlet: Vec<f64> = rows.iter().map(|row| row.dirichlet).collect();
        dirichlet.sort_by(f64::total_cmp);
        let mut steps: Vec<usize> = rows.iter().map(|row| row.steps).collect();
        steps.sort_unstable();
        writeln!(
            out,
            "{:<22} {:>8} {:>8} {:>10} {:>10.3} {:>10.3} {:>8}",
            first.method,
            rows.iter().filter(|row| row.fault.is_some()).count(),
            rows.iter().map(|row| row.flips).sum::<usize>(),
            rows.iter().map(|row| row.crossings).sum::<usize>(),
            rows.iter()
                .map(|row| row.area_overshoot)
                .fold(0.0, f64::max),
            dirichlet[dirichlet.len() / 2],
            steps[steps.len() / 2],
        )?;
    }
    let (ours, overlay) = all
        .iter()
        .filter_map(|(_, found, _)| found.as_ref().ok())
        .fold((0, 0), |(ours, overlay), found| {
            (ours + found.triangles, overlay + found.overlaid)
        });
    writeln!(
        out,
        "triangles: {ours}; laid over each other without being made better: {overlay}"
    )?;
    Ok(all.iter().all(|(_, found, _)| good(found)))
}
