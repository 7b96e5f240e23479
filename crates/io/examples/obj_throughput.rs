//! How long an OBJ file of a million vertices and two million triangles takes through read, move and write, against what
//! `tobj` alone needs to load it, and how much memory it takes against the file's size.
//!
//! `cargo run --release -p anamorph-io --features parallel --example obj_throughput [-- SIDE [transform|recompute]]`: with a word, the
//! file has a normal for each vertex, which is carried along or computed anew.
#![allow(clippy::print_stdout)]

use anamorph_core::glam::DVec3;
use anamorph_io::{Moved, Normals, Points, ReadOptions, read};
use std::fmt::Write as _;
use std::time::{Duration, Instant};

/// A grid of `side` × `side` vertices in OBJ text, with six decimals as exporters write them.
fn grid(side: usize, normals: bool) -> Vec<u8> {
    let mut text = String::from("# a grid\no grid\n");
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    let mut noise = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 40) as f64 / f64::from(1 << 24)
    };
    for i in 0..side {
        for j in 0..side {
            let (x, y) = (i as f64 / side as f64 - 0.5, j as f64 / side as f64 - 0.5);
            let _ = writeln!(text, "v {x:.6} {y:.6} {:.6}", noise() * 0.01);
        }
    }
    if normals {
        for _ in 0..side * side {
            let _ = writeln!(
                text,
                "vn {:.4} {:.4} {:.4}",
                noise() - 0.5,
                noise() - 0.5,
                noise() + 0.5
            );
        }
    }
    for i in 0..side - 1 {
        for j in 0..side - 1 {
            let a = i * side + j + 1;
            let (b, c, d) = (a + 1, a + side + 1, a + side);
            let _ = if normals {
                writeln!(
                    text,
                    "f {a}//{a} {d}//{d} {c}//{c}\nf {a}//{a} {c}//{c} {b}//{b}"
                )
            } else {
                writeln!(text, "f {a} {d} {c}\nf {a} {c} {b}")
            };
        }
    }
    text.into_bytes()
}

/// The largest amount of memory this process has held, in bytes, where the system tells.
fn peak() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    Some(line.split_whitespace().nth(1)?.parse::<f64>().ok()? * 1024.0)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let side = arguments.next().map_or(Ok(1000), |side| side.parse())?;
    let policy = arguments.next();
    let normals = policy.is_some();
    let path = std::env::temp_dir().join(format!("anamorph-throughput-{}.obj", std::process::id()));
    let target = path.with_extension("out.obj");
    let file = grid(side, normals);
    let size = file.len() as f64;
    std::fs::write(&path, file)?;

    let mut best = [Duration::MAX; 4];
    let mut ours_peak = None;
    for _ in 0..5 {
        let start = Instant::now();
        let bytes = std::fs::read(&path)?;
        let document = read(bytes, None, &ReadOptions::default())?;
        let read_time = start.elapsed();
        let Points::Solid(points) = document.points() else {
            return Ok(());
        };
        let moved: Vec<DVec3> = points
            .iter()
            .map(|p| DVec3::new(p.x * 1.1 + p.z, p.y * 0.9, p.z - p.x * p.y))
            .collect();
        let begin = Instant::now();
        let turn = |_: usize, n: DVec3| DVec3::new(n.x / 1.1, n.y / 0.9, n.z - n.x);
        let normals = match policy.as_deref() {
            None => Normals::Keep,
            Some("recompute") => Normals::Recompute,
            Some(_) => Normals::Transform(&turn),
        };
        let mut out = std::fs::File::create(&target)?;
        document.write(
            &Moved::new(Points::Solid(&moved)).with_normals(normals),
            &mut out,
        )?;
        let write_time = begin.elapsed();
        let whole = start.elapsed();
        drop((document, moved));
        if ours_peak.is_none() {
            ours_peak = peak();
        }
        for (best, time) in best.iter_mut().zip([read_time, write_time, whole]) {
            *best = time.min(*best);
        }
        let start = Instant::now();
        let loaded = tobj::load_obj(&path, &tobj::LoadOptions::default())?;
        best[3] = best[3].min(start.elapsed());
        drop(loaded);
    }
    std::fs::remove_file(&path)?;
    std::fs::remove_file(&target)?;

    let seconds = best.map(|time| time.as_secs_f64());
    println!(
        "file {:.1} MB; read {:.3} s, write {:.3} s",
        size / 1e6,
        seconds[0],
        seconds[1]
    );
    println!(
        "whole {:.3} s, tobj alone {:.3} s: ratio {:.2} (bar 1.5)",
        seconds[2],
        seconds[3],
        seconds[2] / seconds[3]
    );
    // The generated text was in memory once too, before the file was written.
    if let Some(peak) = ours_peak {
        println!(
            "peak memory {:.1} MB: {:.2} times the file (bar 4)",
            peak / 1e6,
            peak / size
        );
    }
    Ok(())
}
