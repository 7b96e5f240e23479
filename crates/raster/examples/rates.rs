//! Rates of resampling and of hierarchical maps, by the clock, best of a few runs.

// An example reports to its reader, and has nothing to show where it cannot be set up.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use anamorph_core::glam::dvec2;
use anamorph_core::{Deformation, Plane, Scaling};
use anamorph_features::ElementPair;
use anamorph_raster::{
    Edge, Filter, Hierarchy, PixelMap, Raster, Window, hierarchical_map, hierarchical_map_into,
    resample_into,
};
use anamorph_warps::lines::{WeightConstants, local};
use std::hint::black_box;
use std::time::Instant;

/// Lines all over a square, moved and turned a little.
fn lines(count: usize, size: f64) -> impl Deformation<Plane> {
    let mut state = 0x1234_5678_9abc_def1_u64;
    let mut unit = move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let constants = WeightConstants {
        a: size / 100.0,
        b: 2.0,
        p: 0.0,
    };
    let pairs: Vec<_> = (0..count)
        .map(|_| {
            let from = dvec2(unit(), unit()) * size;
            let to = from + (dvec2(unit(), unit()) - 0.5) * size * 0.15;
            let mut moved = || (dvec2(unit(), unit()) - 0.5) * size * 0.02;
            let target = [from + moved(), to + moved()];
            let pair = ElementPair::of_corners(&[from, to], &target).unwrap();
            (pair, constants)
        })
        .collect();
    local::construct(&pairs, Scaling::Displacement).unwrap()
}

fn best<T>(runs: usize, mut body: impl FnMut() -> T) -> f64 {
    let time = || {
        let start = Instant::now();
        black_box(body());
        start.elapsed().as_secs_f64()
    };
    core::iter::repeat_with(time)
        .take(runs)
        .fold(f64::INFINITY, f64::min)
}

fn main() {
    let side = 1024;
    let window = Window::new(0, 0, side, side).unwrap();
    let pixels = (side * side) as f64;
    let mut source = Raster::new(window, 4).unwrap();
    for (i, sample) in source.samples_mut().iter_mut().enumerate() {
        *sample = (i % 251) as f32;
    }
    let mut target = source.clone();
    let copy = best(20, || {
        use rayon::prelude::*;
        target
            .samples_mut()
            .par_chunks_mut(1 << 16)
            .zip(source.samples().par_chunks(1 << 16))
            .for_each(|(a, b)| a.copy_from_slice(b));
    });
    println!("copy: {:.0} million pixels/s", pixels / copy / 1e6);
    let warp = lines(100, side as f64);
    let (map, _) = hierarchical_map(&warp, window, &Hierarchy::default()).unwrap();
    for filter in Filter::all() {
        let time = best(10, || {
            resample_into(&source, &map, filter, Edge::Clamp, &mut target).unwrap();
        });
        println!(
            "{}: {:.0} million pixels/s, {:.1} % of copying",
            filter.name(),
            pixels / time / 1e6,
            100.0 * copy / time
        );
    }
    for side in [1024, 4096] {
        let window = Window::new(0, 0, side, side).unwrap();
        let warp = lines(100, side as f64);
        // Both over memory that is already there: getting it takes longer than drawing 4096² pixels.
        let mut truth = PixelMap::identity(window).unwrap();
        let (mut map, report) = hierarchical_map(&warp, window, &Hierarchy::default()).unwrap();
        let exact = best(2, || truth.evaluate(&warp));
        let quick = best(5, || {
            hierarchical_map_into(&warp, &Hierarchy::default(), &mut map).unwrap()
        });
        let worst = map
            .offsets()
            .iter()
            .zip(truth.offsets())
            .map(|(a, b)| f64::from(a[0] - b[0]).hypot(f64::from(a[1] - b[1])))
            .fold(0.0, f64::max);
        println!(
            "100 lines, {side}²: exact {:.1} ms ({:.2} billion pixel·lines/s), hierarchical {:.2} ms, {:.1} times; \
             worst {worst:.4} px; {report:?}",
            exact * 1e3,
            pixels_of(side) * 100.0 / exact / 1e9,
            quick * 1e3,
            exact / quick
        );
    }
}

fn pixels_of(side: usize) -> f64 {
    (side * side) as f64
}
