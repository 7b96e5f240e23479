//! What the pictures must show, whatever their exact pixels.

use std::f64::consts::{PI, TAU};

use anamorph_core::glam::{DVec2, DVec3};
use anamorph_core::{Mark, Role, Shape};
use anamorph_preview::{
    Camera, Model, Options, Panel, Picture, PreviewError, Projection, Theme, before_after, single,
};

const SMALL: Options = Options {
    width: 240,
    height: 160,
    theme: Theme::Dark,
    camera: Camera {
        azimuth: 0.0,
        elevation: 0.0,
        up: anamorph_preview::Up::Y,
        projection: Projection::Orthographic,
    },
    samples: 2,
    turning: false,
    around: None,
};

fn sphere() -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let (rows, columns) = (16_u32, 32_u32);
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for row in 0..=rows {
        for column in 0..columns {
            let (u, v) = (
                TAU * f64::from(column) / f64::from(columns),
                PI * f64::from(row) / f64::from(rows),
            );
            points.push(DVec3::new(v.sin() * u.cos(), -v.cos(), v.sin() * u.sin()));
            if row < rows {
                let at = |row: u32, column: u32| row * columns + column % columns;
                triangles.push([at(row, column), at(row + 1, column), at(row, column + 1)]);
                triangles.push([
                    at(row, column + 1),
                    at(row + 1, column),
                    at(row + 1, column + 1),
                ]);
            }
        }
    }
    (points, triangles)
}

/// A square in the plane `z = 0` that faces `+z`.
const SQUARE: [DVec3; 4] = [
    DVec3::new(-1.0, -1.0, 0.0),
    DVec3::new(1.0, -1.0, 0.0),
    DVec3::new(1.0, 1.0, 0.0),
    DVec3::new(-1.0, 1.0, 0.0),
];
const SQUARE_FACES: [[u32; 3]; 2] = [[0, 1, 2], [0, 2, 3]];

fn pixels(picture: &Picture) -> Vec<[i32; 3]> {
    picture
        .rgba()
        .0
        .chunks(4)
        .map(|pixel| [0, 1, 2].map(|k| i32::from(pixel[k])))
        .collect()
}

fn at(picture: &Picture, x: u32, y: u32) -> [i32; 3] {
    let [r, g, b, a] = picture.pixel(x, y).unwrap_or_default();
    assert_eq!(a, 255);
    [r, g, b].map(i32::from)
}

fn luma([r, g, b]: [i32; 3]) -> i32 {
    (r * 2 + g * 5 + b) / 8
}

/// How much more red than blue.
fn warmth([r, _, b]: [i32; 3]) -> i32 {
    r - b
}

/// Greatest difference of any channel anywhere.
fn difference(a: &Picture, b: &Picture) -> u8 {
    assert_eq!((a.rgba().1, a.rgba().2), (b.rgba().1, b.rgba().2));
    a.rgba()
        .0
        .iter()
        .zip(b.rgba().0)
        .map(|(a, b)| a.abs_diff(*b))
        .max()
        .unwrap_or(u8::MAX)
}

#[test]
fn equal_models_give_equal_panels() {
    let (points, triangles) = sphere();
    let panel = Panel::new(Model::mesh(&points, &triangles));
    let options = Options {
        camera: Camera::default(),
        width: 301,
        ..SMALL
    };
    let picture = before_after(&panel, &panel, &options).unwrap();
    let (width, side) = (301, 150);
    let all = pixels(&picture);
    for row in all.chunks(width) {
        for x in (0..side - 12).filter(|x| *x > 12) {
            assert_eq!(row[x], row[x + width - side]);
        }
    }
}

#[test]
fn both_panels_have_one_scale_and_hold_everything() {
    let (points, triangles) = sphere();
    let doubled: Vec<DVec3> = points.iter().map(|&point| point * 2.0).collect();
    let picture = before_after(
        &Panel::new(Model::mesh(&points, &triangles)),
        &Panel::new(Model::mesh(&doubled, &triangles)),
        &Options {
            width: 400,
            height: 200,
            ..SMALL
        },
    )
    .unwrap();
    let wide = |columns: std::ops::Range<u32>| {
        columns
            .filter(|&x| luma(at(&picture, x, 100)) > 110)
            .count()
    };
    let (one, two) = (wide(0..180), wide(215..400));
    assert!(one.abs_diff(two / 2) <= 2, "{one} and {two}");
    // The larger one fills its panel up to the margin and no further.
    assert!((165..=172).contains(&two), "{two}");
}

#[test]
fn a_sphere_is_lit_from_the_upper_left() {
    let (points, triangles) = sphere();
    let picture = single(
        &Panel::new(Model::mesh(&points, &triangles)),
        &Options {
            width: 160,
            ..SMALL
        },
    )
    .unwrap();
    let lit = |x: u32, y: u32| luma(at(&picture, x, y));
    assert!(
        lit(60, 55) > lit(100, 105) + 40,
        "{} {}",
        lit(60, 55),
        lit(100, 105)
    );
    assert!(lit(60, 55) > lit(100, 55), "left of right");
    assert!(lit(60, 55) > lit(60, 105), "upper over lower");
    // The outline is round: as wide as high, and the same on both sides.
    for y in 0..160 {
        let inside: Vec<u32> = (0..160).filter(|&x| lit(x, y) > 75).collect();
        if let (Some(first), Some(last)) = (inside.first(), inside.last()) {
            assert!(
                (first + last).abs_diff(159) <= 2,
                "row {y}: {first} to {last}"
            );
        }
    }
}

#[test]
fn the_inside_is_cooler_than_the_outside() {
    let turned = SQUARE_FACES.map(|[a, b, c]| [a, c, b]);
    for theme in [Theme::Light, Theme::Dark] {
        let options = Options { theme, ..SMALL };
        let outside = single(&Panel::new(Model::mesh(&SQUARE, &SQUARE_FACES)), &options).unwrap();
        let inside = single(&Panel::new(Model::mesh(&SQUARE, &turned)), &options).unwrap();
        assert!(warmth(at(&outside, 120, 80)) > 5);
        assert!(warmth(at(&inside, 120, 80)) < -5);
        assert!(luma(at(&inside, 120, 80)) < luma(at(&outside, 120, 80)));
    }
}

#[test]
fn sources_are_orange_and_targets_blue_and_guides_paler() {
    for theme in [Theme::Light, Theme::Dark] {
        let shown = |role| {
            let marks = [Mark::new(role, Shape::Point(DVec3::Z))];
            let panel = Panel::new(Model::mesh(&SQUARE, &SQUARE_FACES)).with_marks(&marks);
            let options = Options {
                theme,
                width: 900,
                height: 900,
                samples: 1,
                ..SMALL
            };
            at(&single(&panel, &options).unwrap(), 451, 451)
        };
        let [source, target] = [Role::Source, Role::Target].map(shown);
        let [source_guide, target_guide] = [Role::SourceGuide, Role::TargetGuide].map(shown);
        assert!(warmth(source) > 120, "{source:?}");
        assert!(warmth(target) < -80, "{target:?}");
        assert!(
            (40..warmth(source)).contains(&warmth(source_guide)),
            "{source_guide:?}"
        );
        assert!(
            (warmth(target) + 1..-30).contains(&warmth(target_guide)),
            "{target_guide:?}"
        );
    }
}

#[test]
fn a_mark_behind_the_model_is_fainter_but_there() {
    let line = |z: f64| {
        let marks = [Mark::new(
            Role::Target,
            Shape::Polyline(vec![DVec3::new(-1.5, 0.0, z), DVec3::new(1.5, 0.0, z)]),
        )];
        let panel = Panel::new(Model::mesh(&SQUARE, &SQUARE_FACES)).with_marks(&marks);
        single(
            &panel,
            &Options {
                width: 600,
                height: 600,
                theme: Theme::Light,
                ..SMALL
            },
        )
        .unwrap()
    };
    let (before, behind) = (line(0.3), line(-0.3));
    // Over the square, between its edge and its middle.
    let blue = |picture: &Picture, x: u32| {
        (295..305)
            .map(|y| -warmth(at(picture, x, y)))
            .max()
            .unwrap()
    };
    let plain = -warmth(at(&before, 300, 250));
    let (seen, hidden) = (blue(&before, 260) - plain, blue(&behind, 260) - plain);
    assert!(hidden > 15, "{hidden}");
    assert!(
        f64::from(hidden) < 0.6 * f64::from(seen),
        "{hidden} of {seen}"
    );
    // Beside the square both are in full view, but for the air between.
    let [over, under] =
        [&before, &behind].map(|picture| blue(picture, 70) + warmth(at(picture, 70, 250)));
    assert!(
        f64::from(under) > 0.7 * f64::from(over),
        "{under} of {over}"
    );
}

#[test]
fn a_mark_on_the_surface_is_in_full_view() {
    let (points, triangles) = sphere();
    let ring = points[8 * 32..9 * 32].to_vec();
    let marks = [Mark::new(Role::Source, Shape::Polyline(ring))];
    let panel = Panel::new(Model::mesh(&points, &triangles)).with_marks(&marks);
    let camera = SMALL.camera.at(0.0, 0.5);
    let picture = single(
        &panel,
        &Options {
            width: 300,
            height: 300,
            camera,
            ..SMALL
        },
    )
    .unwrap();
    // The near half of the ring lies on the surface, below the middle.
    let orange = (150..280)
        .map(|y| warmth(at(&picture, 150, y)))
        .max()
        .unwrap();
    assert!(orange > 110, "{orange}");
}

#[test]
fn what_is_not_finite_is_left_out() {
    let points = [
        &SQUARE[..],
        &[DVec3::NAN, DVec3::new(f64::INFINITY, 0.0, 0.0)],
    ]
    .concat();
    let triangles = [
        &SQUARE_FACES[..],
        &[[0, 1, 4], [5, 2, 3], [0, 1, 77], [2, 2, 3]],
    ]
    .concat();
    let marks = [
        Mark::new(Role::Source, Shape::Point(DVec3::NAN)),
        Mark::new(Role::Source, Shape::Arrow(DVec3::ZERO, DVec3::INFINITY)),
        Mark::new(Role::Source, Shape::Polyline(vec![DVec3::NAN, DVec3::NAN])),
        Mark::new(Role::Source, Shape::Polyline(Vec::new())),
    ];
    let clean = single(&Panel::new(Model::mesh(&SQUARE, &SQUARE_FACES)), &SMALL).unwrap();
    let dirty = single(
        &Panel::new(Model::mesh(&points, &triangles)).with_marks(&marks),
        &SMALL,
    )
    .unwrap();
    assert_eq!(clean, dirty);
}

#[test]
fn nothing_to_draw_is_an_error_that_names_the_panel() {
    let lost = [DVec3::NAN; 3];
    let good = Panel::new(Model::mesh(&SQUARE, &SQUARE_FACES));
    let bad = Panel::new(Model::mesh(&lost, &[[0, 1, 2]]));
    assert_eq!(
        single(&bad, &SMALL),
        Err(PreviewError::Empty {
            panel: "only",
            points: 3
        })
    );
    assert_eq!(
        before_after(&good, &bad, &SMALL),
        Err(PreviewError::Empty {
            panel: "after",
            points: 3
        })
    );
    let error = single(&Panel::<DVec2>::new(Model::cloud(&[])), &SMALL).unwrap_err();
    assert_eq!(
        error,
        PreviewError::Empty {
            panel: "only",
            points: 0
        }
    );
    assert!(error.to_string().contains("finite"));
}

#[test]
fn size_and_place_of_the_scene_do_not_matter() {
    let (points, triangles) = sphere();
    let plain = single(&Panel::new(Model::mesh(&points, &triangles)), &SMALL).unwrap();
    for (scale, shift) in [(1e300, 0.0), (1e-290, 0.0), (1.0, 1e6), (1.7e308, 0.0)] {
        let moved: Vec<DVec3> = points.iter().map(|&point| point * scale + shift).collect();
        let picture = single(&Panel::new(Model::mesh(&moved, &triangles)), &SMALL).unwrap();
        assert!(
            difference(&plain, &picture) <= 12,
            "{scale} {shift}: {}",
            difference(&plain, &picture)
        );
    }
}

#[test]
fn models_without_extent_are_drawn() {
    let spot = |model: Model<'_, DVec3>, camera: Camera| {
        let picture = single(&Panel::new(model), &Options { camera, ..SMALL }).unwrap();
        pixels(&picture).into_iter().map(luma).max().unwrap()
    };
    let view = Camera::default();
    // A single point, three at one place as a triangle, points on a line as a mesh, a flat sheet from above.
    assert!(spot(Model::cloud(&[DVec3::splat(7.0)]), view) > 110);
    assert!(spot(Model::mesh(&[DVec3::ONE; 3], &[[0, 1, 2]]), view) > 110);
    assert!(
        spot(
            Model::mesh(&[DVec3::ZERO, DVec3::X, DVec3::X * 3.0], &[[0, 1, 2]]),
            view
        ) > 110
    );
    assert!(
        spot(
            Model::cloud(&[DVec3::ZERO, DVec3::X]).with_lines(&[[0, 1]]),
            view
        ) > 110
    );
    let sheet = SQUARE.map(|point| DVec3::new(point.x, 0.0, -point.y));
    assert!(spot(Model::mesh(&sheet, &SQUARE_FACES), view.at(0.0, PI / 2.0)) > 110);
    // Edge-on there is hardly a trace, and no harm.
    spot(Model::mesh(&sheet, &SQUARE_FACES), view.at(0.3, 0.0));
}

#[test]
fn vertex_colours_show() {
    let (points, triangles) = sphere();
    let colours = vec![[0.1, 0.7, 0.1]; points.len()];
    let panel = Panel::new(Model::mesh(&points, &triangles).with_colours(&colours));
    let [r, g, b] = at(&single(&panel, &SMALL).unwrap(), 110, 70);
    assert!(g > r + 50 && g > b + 50, "{r} {g} {b}");
    // Too few, or not finite: the material's own.
    let poor = [[f32::NAN; 3]; 5];
    let panel = Panel::new(Model::mesh(&points, &triangles).with_colours(&poor));
    let plain = Panel::new(Model::mesh(&points, &triangles));
    assert_eq!(single(&panel, &SMALL), single(&plain, &SMALL));
}

#[test]
fn nearer_dots_hide_farther_ones_and_far_ones_fade() {
    let far_one = [
        DVec3::new(0.0, 0.0, -1.0),
        DVec3::new(1.0, 0.0, 1.0),
        DVec3::new(-1.0, 0.0, 1.0),
    ];
    let options = Options {
        width: 300,
        height: 300,
        ..SMALL
    };
    let picture = single(&Panel::new(Model::cloud(&far_one)), &options).unwrap();
    let brightest = |columns: std::ops::Range<u32>| {
        columns
            .flat_map(|x| (130..170).map(move |y| (x, y)))
            .map(|(x, y)| luma(at(&picture, x, y)))
            .max()
            .unwrap()
    };
    let (near, far) = (brightest(0..60), brightest(140..160));
    assert!(far < near - 15, "{far} {near}");
    assert!(far > luma(at(&picture, 150, 100)) + 15);
}

#[test]
fn the_plane_has_a_grid_dots_and_marks() {
    let points: Vec<DVec2> = (0..40)
        .map(|index| DVec2::from_angle(f64::from(index)) * f64::from(index))
        .collect();
    let marks = [Mark::new(
        Role::Target,
        Shape::Arrow(DVec2::new(-20.0, 0.0), DVec2::new(20.0, 0.0)),
    )];
    for theme in [Theme::Light, Theme::Dark] {
        let options = Options {
            theme,
            width: 300,
            height: 300,
            ..SMALL
        };
        let picture = single(
            &Panel::new(Model::cloud(&points)).with_marks(&marks),
            &options,
        )
        .unwrap();
        let blue = pixels(&picture)
            .into_iter()
            .filter(|&pixel| warmth(pixel) < -90)
            .count();
        assert!(blue > 100, "{blue}");
        // Lines of the grid meet the edge of the picture.
        let edge: Vec<i32> = (0..300).map(|x| luma(at(&picture, x, 1))).collect();
        let steps = edge
            .windows(2)
            .filter(|pair| (pair[1] - pair[0]).abs() >= 3)
            .count();
        assert!(steps >= 8, "{steps}");
    }
}

#[test]
fn a_triangle_turned_over_in_the_plane_is_cooler() {
    let points = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
    let colour = |triangles: &[[u32; 3]]| {
        let picture = single(&Panel::new(Model::mesh(&points, triangles)), &SMALL).unwrap();
        at(&picture, 130, 90)
    };
    let (plain, turned) = (
        colour(&[[0, 1, 2], [0, 2, 3]]),
        colour(&[[0, 2, 1], [0, 3, 2]]),
    );
    assert!(
        warmth(plain) > 5 && warmth(turned) < -5,
        "{plain:?} {turned:?}"
    );
}

#[test]
fn options_that_cannot_be_followed_are_errors() {
    let panel = Panel::new(Model::mesh(&SQUARE, &SQUARE_FACES));
    let sizes = [
        (0, 100, 1),
        (100, 20_000, 1),
        (100, 100, 0),
        (100, 100, 9),
        (16_000, 16_000, 3),
    ];
    for (width, height, samples) in sizes {
        let options = Options {
            width,
            height,
            samples,
            ..SMALL
        };
        assert!(
            matches!(single(&panel, &options), Err(PreviewError::Size { .. })),
            "{options:?}"
        );
    }
    for camera in [
        SMALL.camera.at(f64::NAN, 0.0),
        SMALL.camera.at(0.0, 2.0),
        Camera {
            projection: Projection::Perspective { field_of_view: 3.2 },
            ..SMALL.camera
        },
    ] {
        let options = Options { camera, ..SMALL };
        assert!(
            matches!(
                before_after(&panel, &panel, &options),
                Err(PreviewError::Camera { .. })
            ),
            "{camera:?}"
        );
    }
    let least = Options {
        width: 32,
        height: 32,
        samples: 1,
        ..SMALL
    };
    assert_eq!(
        before_after(&panel, &panel, &least).unwrap().rgba().0.len(),
        32 * 32 * 4
    );
}

#[cfg(feature = "parallel")]
#[test]
fn the_number_of_threads_does_not_matter() {
    let (points, triangles) = sphere();
    let marks = [Mark::new(
        Role::Source,
        Shape::Arrow(DVec3::X, DVec3::ONE * 1.3),
    )];
    let panel = Panel::new(Model::mesh(&points, &triangles)).with_marks(&marks);
    let options = Options {
        camera: Camera::default(),
        height: 240,
        ..SMALL
    };
    let pictures = [1, 2, 7].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| before_after(&panel, &panel, &options).unwrap())
    });
    assert!(pictures[0] == pictures[1] && pictures[0] == pictures[2]);
}

/// What is drawn in one panel leaves no trace in the other, however near to its side it goes.
#[test]
fn marks_stay_in_their_panel() {
    let flat: Vec<DVec2> = SQUARE.iter().map(|p| p.truncate()).collect();
    let options = Options {
        around: Some([DVec3::splat(-3.0), DVec3::splat(3.0)]),
        ..SMALL
    };
    let marks: Vec<Mark<DVec2>> = (-6..=6)
        .flat_map(|y| {
            let y = f64::from(y) * 0.5;
            let [left, right] = [-3.0, 3.0].map(|x| DVec2::new(x, y));
            [
                Mark::new(Role::Source, Shape::Polyline(vec![left, right])),
                Mark::new(Role::Target, Shape::Arrow(right, left)),
                Mark::new(Role::Target, Shape::Point(right)),
                Mark::new(Role::Source, Shape::Point(left)),
            ]
        })
        .collect();
    let bare = Panel::new(Model::mesh(&flat, &SQUARE_FACES));
    let marked = bare.with_marks(&marks);
    let [none, first, second] = [(&bare, &bare), (&marked, &bare), (&bare, &marked)]
        .map(|(before, after)| before_after(before, after, &options).unwrap());
    let side = (SMALL.width - 1) / 2;
    let (mut left, mut right) = (0, 0);
    for y in 0..SMALL.height {
        for x in 0..SMALL.width {
            if x >= side {
                assert_eq!(at(&first, x, y), at(&none, x, y), "({x}, {y})");
            } else {
                left += usize::from(at(&first, x, y) != at(&none, x, y));
            }
            if x < SMALL.width - side {
                assert_eq!(at(&second, x, y), at(&none, x, y), "({x}, {y})");
            } else {
                right += usize::from(at(&second, x, y) != at(&none, x, y));
            }
        }
    }
    assert!(left > 500 && right > 500, "{left} {right}");
}
