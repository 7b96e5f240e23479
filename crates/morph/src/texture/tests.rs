use super::*;
use anamorph_raster::{Edge, Filter};

fn window(width: usize, height: usize) -> Window {
    Window::new(0, 0, width, height).unwrap()
}

fn area(ring: &[DVec2]) -> f64 {
    crate::shapes::area(ring)
}

/// Numbers from 0 to 1, always the same.
fn numbers() -> impl FnMut() -> f64 {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64
    }
}

#[test]
fn coverage_is_the_area_of_what_lies_in_each_pixel() {
    let mut next = numbers();
    for _ in 0..200 {
        let corners: Vec<DVec2> = (0..3)
            .map(|_| dvec2(30.0 * next() - 7.0, 26.0 * next() - 7.0))
            .collect();
        let mut ring = corners;
        if area(&ring) < 0.0 {
            ring.reverse();
        }
        let covered = coverage(std::slice::from_ref(&ring), window(16, 12));
        // Cut to each pixel by its four sides.
        for (number, share) in covered.iter().enumerate() {
            let (x, y) = ((number % 16) as f64, (number / 16) as f64);
            let mut cut = ring.clone();
            for (normal, limit) in [
                (DVec2::X, x),
                (DVec2::NEG_X, -x - 1.0),
                (DVec2::Y, y),
                (DVec2::NEG_Y, -y - 1.0),
            ] {
                let mut kept = Vec::new();
                for (i, p) in cut.iter().enumerate() {
                    let q = cut[(i + 1) % cut.len()];
                    let (a, b) = (p.dot(normal) - limit, q.dot(normal) - limit);
                    if a >= 0.0 {
                        kept.push(*p);
                    }
                    if (a >= 0.0) != (b >= 0.0) {
                        kept.push(p.lerp(q, a / (a - b)));
                    }
                }
                cut = kept;
            }
            assert!((area(&cut) - share).abs() < 1e-8, "{ring:?} {x} {y}");
        }
    }
}

#[test]
fn holes_are_open_and_overlaps_count_once() {
    let square = |low: f64, high: f64| {
        vec![
            dvec2(low, low),
            dvec2(high, low),
            dvec2(high, high),
            dvec2(low, high),
        ]
    };
    let mut hole = square(3.25, 5.0);
    hole.reverse();
    let covered = coverage(&[square(1.0, 8.5), hole, square(6.0, 12.0)], window(10, 10));
    let at = |x: usize, y: usize| covered[10 * y + x];
    assert_eq!(
        [at(0, 0), at(1, 1), at(4, 4), at(7, 7)],
        [0.0, 1.0, 0.0, 1.0]
    );
    assert_eq!(
        [at(3, 4), at(8, 2), at(8, 8), at(9, 9)],
        [0.25, 0.5, 1.0, 1.0]
    );
}

fn noise(width: usize, height: usize) -> Raster {
    let mut next = numbers();
    let samples = (0..width * height).flat_map(|_| {
        let alpha = next();
        [next() * alpha, next() * alpha, next() * alpha, alpha].map(|v| v as f32)
    });
    Raster::from_samples(window(width, height), 4, samples.collect()).unwrap()
}

/// A pentagon about a middle point, and the same bent.
fn pentagon() -> ([Vec<DVec2>; 2], Vec<[u32; 3]>) {
    let mut here: Vec<DVec2> = (0..5)
        .map(|i| {
            let turn = f64::from(i) * 1.256_637 + 0.2;
            dvec2(20.0 + 17.3 * turn.cos(), 18.0 + 15.7 * turn.sin())
        })
        .collect();
    here.push(dvec2(21.0, 17.0));
    let mut there: Vec<DVec2> = here
        .iter()
        .map(|p| dvec2(0.8 * p.y + 6.0, 36.0 - 0.9 * p.x))
        .collect();
    there[5] += dvec2(3.0, -2.0);
    let triangles = (0..5).map(|i| [i, (i + 1) % 5, 5]).collect();
    ([here, there], triangles)
}

#[test]
fn where_nothing_moves_the_image_is_there_bit_for_bit() {
    let images = [noise(40, 36), noise(44, 40)];
    let ([here, there], triangles) = pentagon();
    for filter in [Filter::ANISOTROPIC, Filter::CATMULL_ROM] {
        let samplers = [0, 1].map(|i: usize| Sampler::new(&images[i], filter, Edge::Clamp));
        for (side, own) in [&here, &there].into_iter().enumerate() {
            let mut ring = own[..5].to_vec();
            if area(&ring) < 0.0 {
                ring.reverse();
            }
            let rings = [ring];
            let window = images[side].window();
            let mesh = Textured {
                triangles: &triangles,
                places: own,
                rings: &rings,
                images: [&here, &there],
                dissolve: side as f64,
                opacity: 1.0,
            };
            let frame = draw(&[mesh], [&samplers[0], &samplers[1]], window).unwrap();
            let covered = coverage(&rings, window);
            let mut whole = 0;
            for (pixel, share) in covered.iter().enumerate() {
                let (x, y) = (pixel % window.width(), pixel / window.width());
                let (found, wanted) = (frame.pixel(x, y), images[side].pixel(x, y));
                if *share == 1.0 {
                    whole += 1;
                    assert_eq!(found, wanted, "{x} {y}");
                } else {
                    for (a, b) in found.iter().zip(wanted) {
                        assert!((f64::from(*a) - f64::from(*b) * share).abs() < 1e-6);
                    }
                }
            }
            assert!(whole > 300);
        }
    }
}

#[test]
fn straight_lines_in_a_triangle_stay_straight() {
    // The coordinates themselves as colours: what is drawn says where it comes from.
    let size = 64;
    let samples = (0..size * size).flat_map(|i| {
        let (x, y) = ((i % size) as f32 + 0.5, (i / size) as f32 + 0.5);
        [x / 64.0, y / 64.0, 0.0, 1.0]
    });
    let image = Raster::from_samples(window(size, size), 4, samples.collect()).unwrap();
    let sampler = Sampler::new(&image, Filter::BILINEAR, Edge::Clamp);
    let source = [dvec2(6.0, 8.0), dvec2(55.0, 14.0), dvec2(20.0, 57.0)];
    let places = [dvec2(50.0, 5.0), dvec2(58.0, 60.0), dvec2(4.0, 40.0)];
    let rings = [places.to_vec()];
    let mesh = Textured {
        triangles: &[[0, 1, 2]],
        places: &places,
        rings: &rings,
        images: [&source, &source],
        dissolve: 0.5,
        opacity: 1.0,
    };
    let frame = draw(&[mesh], [&sampler, &sampler], image.window()).unwrap();
    let covered = coverage(&rings, image.window());
    let mut checked = 0;
    for y in 0..size {
        for x in 0..size {
            if covered[y * size + x] < 1.0 {
                continue;
            }
            // Barycentric coordinates of the pixel's centre, by areas.
            let p = dvec2(x as f64 + 0.5, y as f64 + 0.5);
            let part = |a: DVec2, b: DVec2| (b - a).perp_dot(p - a);
            let [a, b, c] = places;
            let whole = (b - a).perp_dot(c - a);
            let shares = [part(b, c), part(c, a), part(a, b)].map(|s| s / whole);
            let wanted: DVec2 = source.iter().zip(shares).map(|(q, s)| *q * s).sum();
            let found = frame.pixel(x, y);
            let found = dvec2(f64::from(found[0]), f64::from(found[1])) * 64.0;
            // So a line of the frame is one of the image, evenly.
            assert!(found.distance(wanted) < 1e-4, "{found} {wanted}");
            checked += 1;
        }
    }
    assert!(checked > 800);
}

#[test]
fn parts_lie_over_each_other_and_fade() {
    let white = Raster::from_samples(window(4, 4), 4, vec![1.0; 64]).unwrap();
    let red: Vec<f32> = [1.0, 0.0, 0.0, 1.0].repeat(16);
    let red = Raster::from_samples(window(4, 4), 4, red).unwrap();
    let samplers = [&white, &red].map(|i| Sampler::new(i, Filter::ANISOTROPIC, Edge::Clamp));
    let places = [
        dvec2(0.0, 0.0),
        dvec2(4.0, 0.0),
        dvec2(4.0, 4.0),
        dvec2(0.0, 4.0),
    ];
    let rings = [places.to_vec()];
    let mesh = |dissolve: f64, opacity: f64| Textured {
        triangles: &[[0, 1, 2], [0, 2, 3]],
        places: &places,
        rings: &rings,
        images: [&places, &places],
        dissolve,
        opacity,
    };
    let both = [&samplers[0], &samplers[1]];
    let frame = draw(&[mesh(0.0, 1.0), mesh(1.0, 0.25)], both, window(4, 4)).unwrap();
    assert_eq!(frame.pixel(2, 1), [1.0, 0.75, 0.75, 1.0]);
    let frame = draw(&[mesh(0.25, 1.0)], both, window(4, 4)).unwrap();
    assert_eq!(frame.pixel(0, 3), [1.0, 0.75, 0.75, 1.0]);
    let frame = draw(&[mesh(0.5, 0.5)], both, window(4, 4)).unwrap();
    assert_eq!(frame.pixel(0, 3), [0.5, 0.25, 0.25, 0.5]);
    // Nonsense is refused.
    assert!(draw(&[mesh(f64::NAN, 1.0)], both, window(4, 4)).is_err());
    assert!(draw(&[mesh(0.0, 1.5)], both, window(4, 4)).is_err());
    let mut short = mesh(0.0, 1.0);
    short.places = &places[..3];
    let wrong = draw(&[short], both, window(4, 4)).unwrap_err();
    assert_eq!(wrong, TextureError::Point { triangle: 1 });
}
