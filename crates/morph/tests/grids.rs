//! Coordinate grids: nodes meet, equal grids change nothing, moves by whole pixels are exact, folds and crossings are found,
//! and the picture in two passes is the picture through the map.

// A test that cannot be set up has nothing to say.
#![allow(clippy::unwrap_used, clippy::panic)]

use anamorph_core::glam::{DVec2, dvec2};
use anamorph_core::{Deformation, Plane, Site, Smoothness, Support, math};
use anamorph_morph::KeyPath;
use anamorph_morph::grid::{
    CoordinateGrid, GridError, GridKeys, GridWarp, Spline, TwoPassMemory, two_pass, two_pass_into,
};
use anamorph_raster::{
    Edge, Filter, Raster, RasterError, Window, cross_dissolve, resample_through,
};

fn window(x: i64, y: i64, width: usize, height: usize) -> Window {
    Window::new(x, y, width, height).unwrap()
}

/// Numbers in [−1, 1).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// A regular grid whose nodes are off by up to `share` of a cell, those of the border along it.
fn uneven(window: Window, columns: usize, rows: usize, share: f64, seed: u64) -> CoordinateGrid {
    let even = CoordinateGrid::regular(window, columns, rows).unwrap();
    let cell = dvec2(
        window.width() as f64 / (columns - 1) as f64,
        window.height() as f64 / (rows - 1) as f64,
    );
    let mut random = Random(seed);
    let node = |(index, at): (usize, &DVec2)| {
        let (column, row) = (index % columns, index / columns);
        let mut by = dvec2(random.next(), random.next()) * cell * share;
        if column == 0 || column == columns - 1 {
            by.x = 0.0;
        }
        if row == 0 || row == rows - 1 {
            by.y = 0.0;
        }
        *at + by
    };
    let nodes = even.nodes().iter().enumerate().map(node).collect();
    CoordinateGrid::new(columns, rows, nodes).unwrap()
}

fn moved(grid: &CoordinateGrid, by: DVec2) -> CoordinateGrid {
    let (columns, rows) = grid.shape();
    let nodes = grid.nodes().iter().map(|node| *node + by).collect();
    CoordinateGrid::new(columns, rows, nodes).unwrap()
}

fn noise(window: Window, channels: usize) -> Raster {
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let count = window.pixels().unwrap() * channels;
    let samples = (0..count).map(|_| random.next().abs() as f32).collect();
    Raster::from_samples(window, channels, samples).unwrap()
}

/// A smooth picture, moved.
fn waves(window: Window, channels: usize, by: DVec2) -> Raster {
    let mut raster = Raster::new(window, channels).unwrap();
    for y in 0..window.height() {
        for x in 0..window.width() {
            let p = window.centre(x, y) - by;
            for (c, sample) in raster.pixel_mut(x, y).iter_mut().enumerate() {
                let phase = c as f64;
                *sample = (0.5
                    + 0.25 * math::sin(p.x * 0.21 + phase)
                    + 0.2 * math::cos(p.y * 0.17 - phase)) as f32;
            }
        }
    }
    raster
}

fn bits(raster: &Raster) -> Vec<u32> {
    raster.samples().iter().map(|s| s.to_bits()).collect()
}

fn map(warp: &GridWarp, at: DVec2) -> DVec2 {
    warp.map(&Site::anywhere(at))
}

/// Largest and mean squared difference of the pixels at least `margin` inside.
fn difference(a: &Raster, b: &Raster, margin: usize) -> (f64, f64) {
    let (mut largest, mut sum, mut count) = (0.0_f64, 0.0, 0.0);
    for y in margin..a.height() - margin {
        for x in margin..a.width() - margin {
            for (p, q) in a.pixel(x, y).iter().zip(b.pixel(x, y)) {
                let d = f64::from(*p) - f64::from(*q);
                largest = largest.max(d.abs());
                sum += d * d;
                count += 1.0;
            }
        }
    }
    (largest, sum / count)
}

#[test]
fn nodes_come_from_their_fellows() {
    for seed in 1..40 {
        let area = window(-13, 1_000, 64 + seed, 200);
        let (columns, rows) = (2 + seed % 7, 2 + seed % 5);
        let result = uneven(area, columns, rows, 0.2, seed as u64);
        let image = uneven(area, columns, rows, 0.2, seed as u64 + 1000);
        for spline in Spline::all() {
            let warp = GridWarp::new(&result, &image, spline).unwrap();
            for (there, here) in result.nodes().iter().zip(image.nodes()) {
                let off = map(&warp, *there).distance(*here);
                assert!(off <= 1e-9, "{spline:?} {off}");
            }
        }
    }
}

#[test]
fn equal_grids_change_nothing() {
    let area = window(-7, 1_000_000, 23, 19);
    let grid = uneven(area, 5, 4, 0.2, 3);
    for spline in Spline::all() {
        let warp = GridWarp::new(&grid, &grid, spline).unwrap();
        assert_eq!(warp.facts().support, Support::Nowhere);
        let mut random = Random(77);
        for _ in 0..1000 {
            let at = dvec2(random.next(), random.next()) * 40.0 + area.corner();
            assert_eq!(map(&warp, at).to_array(), at.to_array());
        }
        let zero = map(&warp, dvec2(-0.0, -0.0)).to_array();
        assert!(zero.iter().all(|c| c.to_bits() == (-0.0_f64).to_bits()));
        for channels in [1, 2, 3, 4, 5, 9] {
            let mut picture = noise(area, channels);
            let odd = [
                f32::NAN,
                f32::INFINITY,
                f32::NEG_INFINITY,
                -0.0,
                1e-45,
                f32::MAX,
            ];
            for (i, value) in odd.into_iter().enumerate() {
                picture.pixel_mut(3 * i, 2 * i + 1).fill(value);
            }
            for edge in Edge::all() {
                let same = two_pass(&picture, &warp, area, edge).unwrap();
                assert_eq!(
                    bits(&same),
                    bits(&picture),
                    "{spline:?} {edge:?} {channels}"
                );
            }
        }
    }
}

#[test]
fn nodes_moved_by_whole_pixels_move_the_picture_exactly() {
    let area = window(2, -5, 40, 30);
    let picture = noise(area, 4);
    let grid = uneven(area, 6, 5, 0.25, 8);
    for (dx, dy) in [(3, 0), (0, -4), (-7, 5), (100, 3)] {
        let there = moved(&grid, dvec2(dx as f64, dy as f64));
        for spline in Spline::all() {
            let warp = GridWarp::new(&there, &grid, spline).unwrap();
            for edge in Edge::all() {
                let drawn = two_pass(&picture, &warp, area, edge).unwrap();
                for y in 0..30_i64 {
                    for x in 0..40_i64 {
                        let place = |at: i64, size: usize| edge.pixel(at, size);
                        let from = place(x - dx, 40).zip(place(y - dy, 30));
                        let expected = from.map_or(&[0.0; 4][..], |(x, y)| picture.pixel(x, y));
                        let found = drawn.pixel(x as usize, y as usize);
                        assert_eq!(found, expected, "{spline:?} {edge:?} {dx} {dy} at {x} {y}");
                    }
                }
                // The window may be another one: the same picture, cut out.
                let cut = window(area.x() + 5, area.y() + 11, 17, 9);
                let part = two_pass(&picture, &warp, cut, edge).unwrap();
                for y in 0..9 {
                    for x in 0..17 {
                        assert_eq!(part.pixel(x, y), drawn.pixel(x + 5, y + 11));
                    }
                }
            }
        }
    }
}

#[test]
fn two_passes_draw_the_picture_that_the_map_describes() {
    let area = window(0, 0, 160, 120);
    let picture = waves(area, 3, DVec2::ZERO);
    let image = CoordinateGrid::regular(area, 6, 5).unwrap();
    for seed in 1..6 {
        let result = uneven(area, 6, 5, 0.12, seed);
        for spline in Spline::all() {
            let warp = GridWarp::new(&result, &image, spline).unwrap();
            let passes = two_pass(&picture, &warp, area, Edge::Clamp).unwrap();
            let through =
                resample_through(&picture, &warp, Filter::BILINEAR, Edge::Clamp, area).unwrap();
            let (_, square) = difference(&passes, &through, 0);
            let decibels = -10.0 * square.log10();
            assert!(decibels > 50.0, "{spline:?} {seed}: {decibels} dB");
        }
    }
}

#[test]
fn an_image_and_its_shifted_copy_meet_at_half_the_shift() {
    let area = window(0, 0, 96, 64);
    let by = dvec2(6.0, -4.0);
    let (first, second) = (waves(area, 3, DVec2::ZERO), waves(area, 3, by));
    let expected = waves(area, 3, by * 0.5);
    for path in KeyPath::all() {
        let grid = uneven(area, 5, 5, 0.15, 21);
        let keys = GridKeys::new(vec![grid.clone(), moved(&grid, by)], path).unwrap();
        let between = keys.at(0.5).unwrap();
        for spline in Spline::all() {
            let draw = |image: &Raster, key: usize| {
                let warp = GridWarp::new(&between, &keys.keys()[key], spline).unwrap();
                two_pass(image, &warp, area, Edge::Clamp).unwrap()
            };
            let half = cross_dissolve(&draw(&first, 0), &draw(&second, 1), 0.5).unwrap();
            let (largest, _) = difference(&half, &expected, 8);
            assert!(largest < 1e-6, "{spline:?} {largest}");
        }
    }
}

#[test]
fn constants_stay_and_the_mean_is_kept_where_nothing_leaves() {
    let area = window(0, 0, 60, 48);
    let grey = Raster::from_samples(area, 3, vec![0.1; 60 * 48 * 3]).unwrap();
    let even = CoordinateGrid::regular(area, 5, 5).unwrap();
    let bent = uneven(area, 5, 5, 0.2, 5);
    for spline in Spline::all() {
        let warp = GridWarp::new(&bent, &even, spline).unwrap();
        for edge in [Edge::Clamp, Edge::Mirror, Edge::Wrap] {
            let drawn = two_pass(&grey, &warp, area, edge).unwrap();
            assert!(drawn.samples().iter().all(|s| *s == 0.1));
        }
    }
    // Shrunk to a third: the mean of all pixels is that of the image.
    let picture = noise(area, 1);
    let mean = |raster: &Raster| {
        let sum: f64 = raster.samples().iter().map(|s| f64::from(*s)).sum();
        sum / raster.samples().len() as f64
    };
    let small = window(0, 0, 20, 16);
    let grid = CoordinateGrid::regular(small, 5, 5).unwrap();
    let warp = GridWarp::new(&grid, &even, Spline::CatmullRom).unwrap();
    let drawn = two_pass(&picture, &warp, small, Edge::Transparent).unwrap();
    assert!((mean(&drawn) - mean(&picture)).abs() < 1e-7);
    // And grown to three times its size.
    let large = window(0, 0, 180, 144);
    let grid = CoordinateGrid::regular(large, 5, 5).unwrap();
    let warp = GridWarp::new(&grid, &even, Spline::CatmullRom).unwrap();
    let drawn = two_pass(&picture, &warp, large, Edge::Clamp).unwrap();
    assert!((mean(&drawn) - mean(&picture)).abs() < 1e-6);
}

#[test]
fn what_is_not_finite_shows_only_where_it_is_covered() {
    let area = window(0, 0, 40, 40);
    let mut picture = noise(area, 2);
    let calm = picture.clone();
    let odd = [
        (5, 6, f32::NAN),
        (20, 31, f32::INFINITY),
        (39, 0, f32::NEG_INFINITY),
    ];
    for (x, y, value) in odd {
        picture.pixel_mut(x, y).fill(value);
    }
    let image = uneven(area, 4, 4, 0.15, 2);
    let result = uneven(area, 4, 4, 0.15, 4);
    let warp = GridWarp::new(&result, &image, Spline::Monotone).unwrap();
    let drawn = two_pass(&picture, &warp, area, Edge::Clamp).unwrap();
    let without = two_pass(&calm, &warp, area, Edge::Clamp).unwrap();
    let mut shown = 0;
    for y in 0..40 {
        for x in 0..40 {
            let from = map(&warp, area.centre(x, y));
            let near = odd.iter().any(|(x, y, _)| {
                let d = (from - area.centre(*x, *y)).abs();
                d.x.max(d.y) < 2.5
            });
            let same = drawn.pixel(x, y) == without.pixel(x, y);
            assert!(same || near, "{x} {y}");
            shown += usize::from(!same);
        }
    }
    assert!(shown >= 3, "{shown}");
}

#[test]
fn far_from_the_grid_places_are_shifted_and_nothing_grows() {
    let area = window(0, 0, 100, 80);
    let result = uneven(area, 5, 6, 0.2, 31);
    let image = moved(&uneven(area, 5, 6, 0.2, 32), dvec2(11.0, -3.0));
    let pairs = result.nodes().iter().zip(image.nodes());
    let most = pairs
        .map(|(a, b)| (*b - *a).abs())
        .fold(DVec2::ZERO, DVec2::max);
    for spline in [Spline::Linear, Spline::Monotone, Spline::CatmullRom] {
        let warp = GridWarp::new(&result, &image, spline).unwrap();
        let mut random = Random(9);
        for scale in [100.0, 1e4, 1e9, 1e15] {
            for _ in 0..200 {
                let at = dvec2(random.next(), random.next()) * scale;
                let by = (map(&warp, at) - at).abs();
                // A smooth displacement may swing a little further than its nodes.
                assert!(
                    by.x <= 1.5 * most.x && by.y <= 1.5 * most.y,
                    "{spline:?} {at} {by}"
                );
            }
        }
        let step = map(&warp, dvec2(1e6, -1e6)) - map(&warp, dvec2(2e6, -1e6));
        assert!(step.distance(dvec2(-1e6, 0.0)) < 1e-6);
        assert!(map(&warp, DVec2::NAN).is_nan());
        assert_eq!(warp.facts().smoothness(), Smoothness::C(0));
    }
}

#[test]
fn ordered_splines_are_one_to_one() {
    let area = window(0, 0, 100, 100);
    let mut built = 0;
    for seed in 1..60 {
        // Up to far beyond half a cell: nodes may overtake each other, curves may cross.
        let jitter = 0.3 + 0.005 * seed as f64;
        let wild = |seed: u64| {
            let even = CoordinateGrid::regular(area, 5, 5).unwrap();
            let mut random = Random(seed);
            let nodes = even
                .nodes()
                .iter()
                .map(|node| *node + dvec2(random.next(), random.next()) * 25.0 * jitter)
                .collect();
            CoordinateGrid::new(5, 5, nodes)
        };
        let (Ok(result), Ok(image)) = (wild(seed), wild(seed + 500)) else {
            continue;
        };
        for spline in Spline::all().filter(|spline| spline.keeps_order()) {
            let warp = match GridWarp::new(&result, &image, spline) {
                Err(GridError::Crossing { near, .. }) => {
                    assert!(near.is_finite());
                    continue;
                }
                warp => warp.unwrap(),
            };
            built += 1;
            assert!(warp.facts().one_to_one().is_some());
            assert_eq!(warp.folds(area).near, None);
            let step = 1e-4;
            for i in 0..60 {
                for k in 0..60 {
                    let at = dvec2(f64::from(i), f64::from(k)) * 2.0 - 10.0;
                    let along = map(&warp, at + DVec2::Y * step) - map(&warp, at);
                    let across = map(&warp, at + DVec2::X * step) - map(&warp, at);
                    let determinant = across.x * along.y - across.y * along.x;
                    assert!(determinant > 0.0 && along.y > 0.0, "{spline:?} {seed} {at}");
                }
            }
        }
    }
    assert!(built > 20, "{built}");
}

#[test]
fn curves_that_cross_between_their_nodes_are_refused() {
    // Columns two pixels apart at their nodes, steeply slanted in opposite ways between.
    let node = |x: f64, y: f64| dvec2(x, y);
    let even = CoordinateGrid::new(
        3,
        2,
        vec![
            node(0.0, 0.0),
            node(50.0, 0.0),
            node(100.0, 0.0),
            node(0.0, 100.0),
            node(50.0, 100.0),
            node(100.0, 100.0),
        ],
    )
    .unwrap();
    // Rows are functions of x: with steps at different x the upper one dips below the lower one.
    let steps = CoordinateGrid::new(
        3,
        2,
        vec![
            node(0.0, 0.0),
            node(10.0, 60.0),
            node(100.0, 60.0),
            node(0.0, 5.0),
            node(90.0, 65.0),
            node(100.0, 70.0),
        ],
    )
    .unwrap();
    for spline in Spline::all() {
        let error = GridWarp::new(&steps, &even, spline).unwrap_err();
        let GridError::Crossing {
            lines,
            grid,
            first,
            near,
        } = &error
        else {
            panic!("{error}");
        };
        assert_eq!((*lines, *grid, *first), ("rows", "result", 0));
        assert!((0.0..=100.0).contains(&near.x) && (0.0..=70.0).contains(&near.y));
        assert!(error.to_string().contains("rows 0 and 1"), "{error}");
        assert!(GridWarp::new(&even, &even, spline).is_ok());
    }
    let other = CoordinateGrid::regular(window(0, 0, 100, 100), 3, 3).unwrap();
    let error = GridWarp::new(&other, &even, Spline::Linear).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("3 × 2 nodes, and the first 3 × 3"),
        "{error}"
    );
}

#[test]
fn folds_of_catmull_rom_are_measured_and_drawn_without_harm() {
    let area = window(0, 0, 100, 60);
    let even = CoordinateGrid::regular(area, 5, 3).unwrap();
    // The second and third columns nearly meet in the result: between the others the spline swings back.
    let mut nodes = even.nodes().to_vec();
    for row in 0..3 {
        nodes[5 * row + 2].x = 25.5;
    }
    let pinched = CoordinateGrid::new(5, 3, nodes).unwrap();
    let warp = GridWarp::new(&pinched, &even, Spline::CatmullRom).unwrap();
    let folds = warp.folds(area);
    assert_eq!((folds.columns, folds.rows), (0, 60));
    let near = folds.near.unwrap();
    let (before, behind) = (
        map(&warp, near - DVec2::X * 0.01),
        map(&warp, near + DVec2::X * 0.01),
    );
    assert!(behind.x < before.x, "{before} {behind}");
    assert!(warp.facts().one_to_one().is_none() && warp.facts().notes.len() == 2);
    let picture = noise(area, 4);
    let drawn = two_pass(&picture, &warp, area, Edge::Clamp).unwrap();
    assert!(drawn.samples().iter().all(|s| (0.0..=1.0).contains(s)));
    // The spline that cannot.
    let warp = GridWarp::new(&pinched, &even, Spline::Monotone).unwrap();
    assert_eq!(warp.folds(area).near, None);
}

#[test]
fn memory_is_reused_and_unlike_rasters_are_refused() {
    let area = window(0, 0, 50, 40);
    let image = CoordinateGrid::regular(area, 4, 4).unwrap();
    let mut memory = TwoPassMemory::default();
    for (size, channels, seed) in [((50, 40), 4, 1), ((20, 30), 1, 2), ((64, 70), 3, 3)] {
        let warp = GridWarp::new(&uneven(area, 4, 4, 0.2, seed), &image, Spline::Monotone).unwrap();
        let picture = noise(area, channels);
        let place = window(3, 2, size.0, size.1);
        let fresh = two_pass(&picture, &warp, place, Edge::Mirror).unwrap();
        let mut again = noise(place, channels);
        two_pass_into(&picture, &warp, Edge::Mirror, &mut memory, &mut again).unwrap();
        assert_eq!(bits(&fresh), bits(&again));
        let mut other = noise(place, channels + 1);
        let error = two_pass_into(&picture, &warp, Edge::Clamp, &mut memory, &mut other);
        assert!(matches!(error, Err(RasterError::Channels { .. })));
    }
}

#[test]
fn any_number_of_threads_draws_the_same() {
    let area = window(0, 0, 131, 97);
    let picture = noise(area, 4);
    let warp = GridWarp::new(
        &uneven(area, 7, 6, 0.2, 11),
        &uneven(area, 7, 6, 0.2, 12),
        Spline::CatmullRom,
    )
    .unwrap();
    let draw = || bits(&two_pass(&picture, &warp, area, Edge::Wrap).unwrap());
    let expected = draw();
    for threads in [1, 2, 3, 7] {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        assert_eq!(pool.install(draw), expected, "{threads}");
    }
}

#[test]
fn a_warped_picture_as_it_was_checked() {
    let area = window(0, 0, 12, 8);
    let mut picture = Raster::new(area, 1).unwrap();
    for y in 0..8 {
        for x in 0..12 {
            picture.pixel_mut(x, y)[0] = if (x / 3 + y / 2) % 2 == 0 { 9.0 } else { 0.0 };
        }
    }
    let even = CoordinateGrid::regular(area, 4, 3).unwrap();
    let bent = even
        .with_node(1, 1, dvec2(5.5, 3.0))
        .and_then(|grid| grid.with_node(2, 1, dvec2(7.0, 5.0)))
        .unwrap();
    let mut text = String::new();
    for spline in Spline::all() {
        let warp = GridWarp::new(&bent, &even, spline).unwrap();
        let drawn = two_pass(&picture, &warp, area, Edge::Clamp).unwrap();
        text += &format!("{}\n", spline.name());
        for y in 0..8 {
            let row: Vec<String> = (0..12)
                .map(|x| format!("{:4.1}", drawn.pixel(x, y)[0]))
                .collect();
            text += &format!("{}\n", row.join(" "));
        }
    }
    insta::assert_snapshot!(text);
}

#[test]
fn sites_and_runs_agree() {
    let area = window(0, 0, 30, 30);
    let warp = GridWarp::new(
        &uneven(area, 5, 4, 0.2, 1),
        &uneven(area, 5, 4, 0.2, 2),
        Spline::CatmullRom,
    )
    .unwrap();
    let mut points: Vec<Plane> = (0..30).map(|i| area.centre(i, 29 - i)).collect();
    let expected: Vec<Plane> = points.iter().map(|p| map(&warp, *p)).collect();
    assert!(warp.map_points(0, &mut points).is_empty());
    assert_eq!(points, expected);
}

#[test]
fn landmarks_of_both_images_coincide_and_the_ends_are_the_images() {
    let area = window(0, 0, 120, 90);
    let first = uneven(area, 5, 4, 0.2, 40);
    let second = uneven(area, 5, 4, 0.2, 41);
    // A spot at every inner node.
    let inner: Vec<usize> = (0..20)
        .filter(|i| (1..4).contains(&(i % 5)) && (1..3).contains(&(i / 5)))
        .collect();
    let spots = |grid: &CoordinateGrid| {
        let mut raster = Raster::new(area, inner.len()).unwrap();
        for y in 0..90 {
            for x in 0..120 {
                let p = area.centre(x, y);
                for (sample, node) in raster.pixel_mut(x, y).iter_mut().zip(&inner) {
                    let d = p.distance_squared(grid.nodes()[*node]);
                    *sample = math::exp(-d / 8.0) as f32;
                }
            }
        }
        raster
    };
    let images = [spots(&first), spots(&second)];
    let keys = GridKeys::new(vec![first, second], KeyPath::Straight).unwrap();
    // Straight splines crease at nodes: a spot's centre of mass is then no longer its landmark.
    for spline in [Spline::CatmullRom, Spline::Monotone] {
        let mut worst = 0.0_f64;
        for step in 0..=10 {
            let between = keys.at(f64::from(step) / 10.0).unwrap();
            let drawn = [0, 1].map(|key| {
                let warp = GridWarp::new(&between, &keys.keys()[key], spline).unwrap();
                two_pass(&images[key], &warp, area, Edge::Clamp).unwrap()
            });
            if step == 0 {
                assert_eq!(bits(&drawn[0]), bits(&images[0]));
            }
            if step == 10 {
                assert_eq!(bits(&drawn[1]), bits(&images[1]));
            }
            for (channel, node) in inner.iter().enumerate() {
                let middles = drawn.each_ref().map(|image| {
                    let (mut sum, mut mass) = (DVec2::ZERO, 0.0);
                    for y in 0..90 {
                        for x in 0..120 {
                            // The core of the spot, which is what stays round.
                            let s = f64::from(image.pixel(x, y)[channel]);
                            let s = s * s * s;
                            sum += area.centre(x, y) * s;
                            mass += s;
                        }
                    }
                    sum / mass
                });
                let node = between.nodes()[*node];
                let off = middles[0]
                    .distance(middles[1])
                    .max(middles[0].distance(node));
                worst = worst.max(off).max(middles[1].distance(node));
            }
        }
        assert!(worst < 0.5, "{spline:?}: {worst} pixels");
    }
}

#[test]
fn refused_crossings_are_there() {
    let area = window(0, 0, 100, 100);
    let even = CoordinateGrid::regular(area, 5, 5).unwrap();
    let mut seen = 0;
    for seed in 1..400 {
        let mut random = Random(seed);
        let nodes = even
            .nodes()
            .iter()
            .map(|node| *node + dvec2(random.next(), random.next()) * 13.0)
            .collect();
        let Ok(wild) = CoordinateGrid::new(5, 5, nodes) else {
            continue;
        };
        for spline in Spline::all() {
            // Rows of the result, and columns of the image, are those that are drawn.
            for (result, image, axis, grid) in
                [(&wild, &even, 0, "result"), (&even, &wild, 1, "image")]
            {
                let curves = wild.curves(spline, 50).unwrap();
                let curves = if axis == 0 {
                    &curves[..5]
                } else {
                    &curves[5..]
                };
                let value = |line: &[DVec2], at: f64| {
                    let behind = line.partition_point(|p| p[axis] <= at);
                    if behind == 0 || behind == line.len() {
                        return line[behind.saturating_sub(1).min(line.len() - 1)][1 - axis];
                    }
                    let (a, b) = (line[behind - 1], line[behind]);
                    a.lerp(b, (at - a[axis]) / (b[axis] - a[axis]))[1 - axis]
                };
                let gap = |first: usize, at: f64| {
                    value(&curves[first + 1], at) - value(&curves[first], at)
                };
                match GridWarp::new(result, image, spline) {
                    Ok(_) => {
                        for i in -100..1300 {
                            let at = f64::from(i) / 10.0;
                            assert!((0..4).all(|first| gap(first, at) > -0.01), "{seed} {at}");
                        }
                    }
                    Err(GridError::Crossing {
                        grid: found,
                        first,
                        near,
                        ..
                    }) if found == grid => {
                        seen += 1;
                        assert!(gap(first, near[axis]) < 0.01, "{spline:?} {seed} {near}");
                    }
                    // In the auxiliary grid.
                    Err(GridError::Crossing { .. }) => {}
                    Err(other) => panic!("{other}"),
                }
            }
        }
    }
    assert!(seen > 10, "{seen}");
}

#[test]
fn extreme_grids_and_small_pictures_are_drawn() {
    let mut random = Random(4);
    for round in 0..60 {
        let size = [1e-5, 0.3, 40.0, 1e6, 1e14][round % 5];
        let grid = |random: &mut Random, size: f64| {
            let nodes = (0..12).map(|i| {
                let at = dvec2((i % 4) as f64, (i / 4) as f64);
                (at + dvec2(random.next(), random.next()) * 0.2 - 1.0) * size
            });
            CoordinateGrid::new(4, 3, nodes.collect()).unwrap()
        };
        let result = grid(&mut random, size);
        let image = grid(&mut random, [1e14, 3.0, 1e-5][round % 3]);
        for spline in Spline::all() {
            let warp = GridWarp::new(&result, &image, spline).unwrap();
            for (width, height, channels) in [(1, 1, 1), (2, 5, 4), (67, 3, 5)] {
                let picture = noise(window(-1, 0, width, height), channels);
                for edge in Edge::all() {
                    let far = [0, 1 << 49][round % 2];
                    let place = window(-far, far - 3, height + 1, width);
                    let drawn = two_pass(&picture, &warp, place, edge).unwrap();
                    let usual = |s: &f32| (-1e-6..=1.000_001).contains(s);
                    assert!(
                        drawn.samples().iter().all(usual),
                        "{round} {spline:?} {edge:?}"
                    );
                }
            }
        }
    }
}
