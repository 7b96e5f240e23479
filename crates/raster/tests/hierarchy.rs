//! The bound of hierarchical maps, pixel by pixel, on warps that are smooth, folded, torn, and narrow.

// A test that cannot be set up has nothing to say.
#![allow(clippy::unwrap_used)]

use anamorph_core::glam::{DVec2, dvec2};
use anamorph_core::{
    Affine, Bounds, Deformation, Domain, Facts, Plane, Site, Smoothness, Support, math,
};
use anamorph_features::ElementPair;
use anamorph_raster::{Bound, Hierarchy, HierarchyReport, PixelMap, Window, hierarchical_map};
use anamorph_warps::lines::{WeightConstants, local};

/// A map given by a function, with the facts it declares.
struct Given<F> {
    map: F,
    facts: Facts<Plane>,
}

impl<F: Fn(DVec2) -> DVec2 + Send + Sync> Given<F> {
    fn everywhere(map: F) -> Self {
        let facts = Facts {
            support: Support::Everywhere,
            ..Facts::identity()
        };
        Self { map, facts }
    }
}

impl<F: Fn(DVec2) -> DVec2 + Send + Sync> Deformation<Plane> for Given<F> {
    fn map(&self, site: &Site<Plane>) -> DVec2 {
        (self.map)(site.point)
    }
    fn facts(&self) -> Facts<Plane> {
        self.facts.clone()
    }
}

/// The largest distance to the exact map over all pixels; also checks that the report adds up.
fn worst(
    deformation: &dyn Deformation<Plane>,
    window: Window,
    options: &Hierarchy,
) -> (f64, HierarchyReport) {
    let (map, report) = hierarchical_map(deformation, window, options).unwrap();
    let mut largest = 0.0_f64;
    for row in 0..window.height() {
        for column in 0..window.width() {
            let exact = deformation.map(&Site::anywhere(window.centre(column, row)));
            let error = map.position(column, row).unwrap().distance(exact);
            assert!(!error.is_nan(), "({column}, {row})");
            largest = largest.max(error);
        }
    }
    let pixels =
        report.exact_pixels + report.still_pixels + report.derived_pixels + report.estimated_pixels;
    assert_eq!(Some(pixels), window.pixels());
    let estimated = report.estimated_pixels > 0;
    assert_eq!(report.bound == Bound::Estimated, estimated);
    assert!(report.measured <= report.max_error);
    (largest, report)
}

fn window(width: usize, height: usize) -> Window {
    Window::new(0, 0, width, height).unwrap()
}

fn kernel(p: DVec2, centre: DVec2) -> f64 {
    let squared = (p - centre).length_squared();
    if squared == 0.0 {
        0.0
    } else {
        0.5 * squared * math::ln(squared)
    }
}

#[test]
fn smooth_maps_keep_the_bound_with_few_evaluations() {
    let plate = Given::everywhere(|p: DVec2| {
        let mut moved = p;
        for (i, centre) in [dvec2(40.0, 70.0), dvec2(300.0, 90.0), dvec2(180.0, 260.0)]
            .iter()
            .enumerate()
        {
            let pull = dvec2(1.0 - i as f64, 0.4 + i as f64 * 0.3) * 4e-4;
            moved += pull * kernel(p, *centre);
        }
        moved
    });
    let vortex = Given::everywhere(|p: DVec2| {
        let from = p - dvec2(170.0, 150.0);
        let angle = 2.5 * math::exp(-from.length_squared() / (2.0 * 60.0 * 60.0));
        let (sin, cos) = math::sin_cos(angle);
        p - from + dvec2(from.x * cos - from.y * sin, from.x * sin + from.y * cos)
    });
    let lens = Given::everywhere(|p: DVec2| {
        let from = p - dvec2(160.0, 160.0);
        p + from * (from.length_squared() * 2e-6)
    });
    for (name, map) in [
        ("plate", &plate as &dyn Deformation<Plane>),
        ("vortex", &vortex),
        ("lens", &lens),
    ] {
        for max_error in [0.5, 0.05, 0.005] {
            let (error, report) = worst(map, window(333, 301), &Hierarchy::within(max_error));
            assert!(error <= max_error, "{name}: {error} over {max_error}");
            let share = report.evaluations as f64 / (333.0 * 301.0);
            let most = if max_error < 0.05 { 0.4 } else { 0.15 };
            assert!(
                share < most,
                "{name} within {max_error}: {share} of the pixels"
            );
        }
    }
}

/// Lines all over a square, some crossing, moved and turned a little.
fn lines(count: usize, size: f64, reach: f64, a: f64) -> impl Deformation<Plane> {
    let mut state = 0x1234_5678_9abc_def1_u64;
    let mut unit = move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let constants = WeightConstants { a, b: 2.0, p: 0.0 };
    let pairs: Vec<_> = (0..count)
        .map(|_| {
            let from = dvec2(unit(), unit()) * size;
            let to = from + (dvec2(unit(), unit()) - 0.5) * size * 0.3;
            let mut moved = || (dvec2(unit(), unit()) - 0.5) * 2.0 * reach;
            let target = [from + moved(), to + moved()];
            (
                ElementPair::of_corners(&[from, to], &target).unwrap(),
                constants,
            )
        })
        .collect();
    local::construct(&pairs, anamorph_core::Scaling::Displacement).unwrap()
}

#[test]
fn feature_lines_keep_the_bound() {
    for (count, a) in [(3, 1.0), (12, 5.0), (25, 0.5), (6, 0.0)] {
        let warp = lines(count, 200.0, 6.0, a);
        let (error, report) = worst(&warp, window(200, 200), &Hierarchy::default());
        assert!(error <= 0.05, "{count} lines, a = {a}: {error}, {report:?}");
    }
}

#[test]
fn creases_and_jumps_are_refined_to_pixels() {
    // Slanted and curved, so that no cell's corner lies on them.
    let crease = Given::everywhere(|p: DVec2| {
        let across = p.x * 0.8 + p.y * 0.6 - 123.4;
        p + dvec2(0.0, 0.7 * across.max(0.0))
    });
    let jump = Given::everywhere(|p: DVec2| {
        if (p - dvec2(90.3, 110.7)).length() < 61.3 {
            p + dvec2(5.0, 0.3)
        } else {
            p
        }
    });
    for (map, most) in [(&crease as &dyn Deformation<Plane>, 0.35), (&jump, 0.35)] {
        let (error, report) = worst(map, window(256, 192), &Hierarchy::default());
        assert!(error <= 0.05, "{error}");
        assert!(report.exact_pixels > 0);
        let share = report.evaluations as f64 / (256.0 * 192.0);
        assert!(share < most, "{share}");
    }
}

/// Ridges with a kink that graze the sides of cells, and end there: only a little of them is in the cells next to them.
#[test]
fn creases_that_graze_cells_keep_the_bound() {
    for step in 0..60 {
        let slope = 0.02 * f64::from(step % 7) - 0.05;
        let height = 61.0 + 0.11 * f64::from(step);
        let end = 20.0 + f64::from(step);
        for turned in [false, true] {
            let ridge = Given::everywhere(move |p: DVec2| {
                let q = if turned { dvec2(p.y, p.x) } else { p };
                let across = q.y - height - slope * q.x;
                let beyond = (q.x - end).max(0.0);
                let distance = (across * across + beyond * beyond).sqrt();
                p + dvec2(0.3, 1.0) * (16.0 / (4.0 + distance))
            });
            let (error, _) = worst(&ridge, window(130, 130), &Hierarchy::default());
            assert!(error <= 0.05, "{step} {turned}: {error}");
        }
    }
}

#[test]
fn narrow_bumps_are_found_by_their_support() {
    // Between all evaluations of a cell of 32: without the support they would be missed.
    for radius in [2.5, 6.0, 40.0] {
        let centre = dvec2(76.1, 77.9);
        let bump = |p: DVec2| {
            let share = 1.0 - (p - centre).length_squared() / (radius * radius);
            p + dvec2(3.0, -2.0) * share.max(0.0).powi(3)
        };
        let given = Given {
            map: bump,
            facts: Facts {
                support: Support::Ball { centre, radius },
                inside: Smoothness::Smooth,
                edge: Smoothness::C(2),
                ..Facts::identity()
            },
        };
        let (error, report) = worst(&given, window(160, 160), &Hierarchy::default());
        assert!(error <= 0.05, "radius {radius}: {error}");
        assert!(report.still_pixels > 160 * 160 / 3);
    }
    // A disc that is moved as a whole: a jump all around.
    let bounds = Bounds::new(dvec2(33.2, 40.9), dvec2(71.7, 66.6));
    let torn = Given {
        map: move |p: DVec2| {
            if bounds.contains(p) {
                p + dvec2(0.0, 9.0)
            } else {
                p
            }
        },
        facts: Facts {
            support: Support::Box(bounds),
            edge: Smoothness::Jump,
            ..Facts::identity()
        },
    };
    let (error, _) = worst(&torn, window(128, 128), &Hierarchy::default());
    assert!(error <= 0.05, "{error}");
}

#[test]
fn bounds_are_derived_where_derivatives_are_known() {
    let wave = |p: DVec2| p + dvec2(2.0 * math::sin(p.y * 0.01), 0.0);
    let mut given = Given::everywhere(wave);
    // The second derivative of the wave is at most 2·0.01² a pixel.
    let options = Hierarchy {
        second_derivative: Some(2e-4),
        only_derived: true,
        ..Hierarchy::default()
    };
    let (error, report) = worst(&given, window(300, 200), &options);
    assert_eq!(report.bound, Bound::Derived);
    assert!(error <= 0.05, "{error}");
    assert!(
        report.exact_pixels == 0 && report.evaluations < 300 * 200 / 10,
        "{report:?}"
    );
    // By the slope alone, of at most 0.02 a pixel, which is too much for cells of 8 pixels.
    given.facts.stretch = Some(0.02);
    let proof = Hierarchy {
        only_derived: true,
        ..Hierarchy::default()
    };
    let (_, report) = worst(&given, window(300, 200), &proof);
    assert_eq!(
        (report.bound, report.exact_pixels),
        (Bound::Derived, 300 * 200)
    );
    let (error, report) = worst(
        &given,
        window(300, 200),
        &Hierarchy {
            max_error: 0.3,
            ..proof
        },
    );
    assert_eq!((report.bound, report.exact_pixels), (Bound::Derived, 0));
    assert!(error <= 0.3);
    // Without any bound of derivatives an estimate is called one.
    let estimate = worst(
        &Given::everywhere(wave),
        window(300, 200),
        &Hierarchy::default(),
    )
    .1;
    assert_eq!(estimate.bound, Bound::Estimated);
    assert!(estimate.checks > 0 && estimate.measured < 0.025);
}

#[test]
fn nothing_moved_is_exact_and_costs_little() {
    let (map, report) = hierarchical_map(
        &Affine::<Plane>::IDENTITY,
        window(500, 37),
        &Hierarchy::default(),
    )
    .unwrap();
    assert_eq!(map, PixelMap::identity(window(500, 37)).unwrap());
    assert_eq!(
        (report.still_pixels, report.bound),
        (500 * 37, Bound::Derived)
    );
    assert_eq!(report.measured, 0.0);
}

#[test]
fn windows_of_all_sizes_and_places_are_covered() {
    let swirl =
        Given::everywhere(|p: DVec2| p + dvec2(math::sin(p.y * 0.05), math::cos(p.x * 0.04)) * 3.0);
    for (width, height) in [(1, 1), (7, 65), (64, 64), (33, 1), (129, 63), (8, 200)] {
        let window = Window::new(-1000, 77, width, height).unwrap();
        for coarsest in [8, 16, 32] {
            let options = Hierarchy {
                coarsest,
                ..Hierarchy::default()
            };
            let (error, _) = worst(&swirl, window, &options);
            assert!(error <= 0.05, "{width} × {height}, {coarsest}: {error}");
        }
    }
}

#[test]
fn maps_that_are_nowhere_finite_end_as_pixels() {
    let broken = Given::everywhere(|p: DVec2| if p.x > 50.0 { DVec2::NAN } else { p });
    let (map, report) = hierarchical_map(&broken, window(100, 40), &Hierarchy::default()).unwrap();
    assert!(report.exact_pixels >= 50 * 40);
    assert!(map.position(20, 20).unwrap().is_finite() && map.position(80, 20).unwrap().is_nan());
}

/// A deformation that knows pixels by number only.
struct ByIndex;

impl Deformation<Plane> for ByIndex {
    fn map(&self, site: &Site<Plane>) -> DVec2 {
        site.point + dvec2(site.index as f64, 0.0)
    }
    fn facts(&self) -> Facts<Plane> {
        Facts {
            support: Support::Everywhere,
            ..Facts::identity()
        }
    }
    fn domain(&self) -> Domain {
        Domain::Model
    }
}

#[test]
fn deformations_of_one_model_are_evaluated_at_every_pixel() {
    let (map, report) = hierarchical_map(&ByIndex, window(40, 30), &Hierarchy::default()).unwrap();
    assert_eq!((report.exact_pixels, report.bound), (1200, Bound::Derived));
    assert_eq!(map.offsets()[777], [777.0, 0.0]);
}

#[test]
fn options_out_of_range_are_refused() {
    let default = Hierarchy::default();
    for options in [
        Hierarchy {
            max_error: 0.0,
            ..default
        },
        Hierarchy {
            max_error: f64::NAN,
            ..default
        },
        Hierarchy {
            coarsest: 64,
            ..default
        },
        Hierarchy {
            safety: 0.5,
            ..default
        },
        Hierarchy {
            second_derivative: Some(-1.0),
            ..default
        },
    ] {
        let map = hierarchical_map(&Affine::<Plane>::IDENTITY, window(4, 4), &options);
        assert!(map.is_err(), "{options:?}");
    }
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let warp = lines(9, 300.0, 8.0, 1.0);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| hierarchical_map(&warp, window(300, 300), &Hierarchy::default()).unwrap())
    };
    let one = on(1);
    assert_eq!(on(2), one);
    assert_eq!(on(5), one);
}
