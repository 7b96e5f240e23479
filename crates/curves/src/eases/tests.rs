//! Laws over the registry and over every family at other parameters; values that are known.

use super::*;
use std::collections::HashSet;

/// Every registered ease with its defaults and its example, and the families at hard parameters.
fn all() -> Vec<(String, Box<dyn Ease>)> {
    let mut all: Vec<(String, Box<dyn Ease>)> = Vec::new();
    for entry in registry() {
        all.push((entry.name.to_owned(), entry.construct(&[]).unwrap()));
        let example = entry.construct(entry.example).unwrap();
        all.push((format!("{} (example)", entry.name), example));
    }
    let mut add = |ease: Box<dyn Ease>| all.push((format!("{ease:?}"), ease));
    let ends = [
        (0.0, 1.0),
        (0.0, 0.0),
        (1.0, 1.0),
        (0.5, 0.5),
        (0.3, 0.8),
        (0.0, 0.4),
        (0.9, 1.0),
        (1e-3, 1e-3),
    ];
    for (a, b) in ends {
        add(Box::new(PiecewiseSinusoidal::new(a, b).unwrap()));
        add(Box::new(ConstantAcceleration::new(a, b).unwrap()));
    }
    let directions = [
        Direction::In,
        Direction::Out,
        Direction::InOut,
        Direction::OutIn,
    ];
    for direction in directions {
        add(Box::new(Directed::new(Sine, direction)));
        add(Box::new(Directed::new(Circular, direction)));
        add(Box::new(Back::new(4.0).unwrap().directed(direction)));
        let elastic = Elastic::new(1.7, 0.45).unwrap();
        add(Box::new(elastic.directed(direction)));
        for (bounces, restitution) in [(0.0, 0.5), (1.0, 1.0), (7.0, 0.7), (30.0, 0.01)] {
            let bounce = Bounce::new(bounces, restitution).unwrap();
            add(Box::new(Directed::new(bounce, direction)));
        }
        for exponent in [1.0, 1.5, 2.0, 7.25, 100.0] {
            let power = Power::new(exponent).unwrap();
            add(Box::new(Directed::new(power, direction)));
        }
        for rate in [0.1, 100.0] {
            let exponential = Exponential::new(rate).unwrap();
            add(Box::new(Directed::new(exponential, direction)));
        }
        let constant = ConstantAcceleration::new(0.2, 0.3).unwrap();
        add(Box::new(Directed::new(constant, direction)));
    }
    let curves = [
        (0.0, 0.0, 0.0, 0.0),
        (1.0, 1.0, 1.0, 1.0),
        (0.0, 0.0, 1.0, 1.0),
        (1.0, 0.0, 0.0, 1.0),
        (0.0, 1.0, 1.0, 0.0),
        (0.0, 0.7, 0.0, 0.7),
        (1.0, 0.1, 1.0, 0.4),
        (0.0, 0.0, 0.0, 2.0),
        (0.9, 5.0, 0.05, -7.0),
        (0.5, 0.0, 0.5, 1.0),
        (0.999, 0.0, 0.001, 1.0),
    ];
    for (x1, y1, x2, y2) in curves {
        add(Box::new(CubicBezier::new(x1, y1, x2, y2).unwrap()));
    }
    for (_, position) in StepPosition::WORDS {
        for count in [2.0, 3.0, 10.0] {
            add(Box::new(Steps::new(count, position).unwrap()));
        }
    }
    add(Box::new(Steps::STEP_START));
    add(Box::new(Steps::STEP_END));
    let lists: [&[(f64, f64)]; 5] = [
        &[(0.0, 0.0), (1.0, 1.0)],
        &[(0.0, 0.0), (0.5, 0.8), (0.5, 0.2), (1.0, 1.0)],
        &[(0.2, 0.0), (0.7, 1.0)],
        &[(0.0, 0.3), (0.5, 0.3), (1.0, 0.9)],
        &[(0.0, -1e100), (1e-300, 1e100)],
    ];
    for stops in lists {
        add(Box::new(Stops::new(stops).unwrap()));
    }
    for ratio in [
        0.02,
        0.3,
        0.899,
        0.95,
        0.999_999_999,
        1.0,
        1.000_000_001,
        3.0,
        800.0,
    ] {
        for velocity in [0.0, 4.0, -9.0] {
            let spring = Spring::new(1.0, 1.0, 2.0 * ratio, velocity, 1e-3);
            add(Box::new(spring.unwrap()));
        }
    }
    all
}

/// Whether a difference of that step about a time stays clear of the breaks and ends.
fn clear(ease: &dyn Ease, t: f64, step: f64) -> bool {
    let near = |b: f64| (b - t).abs() <= step;
    t > step && t < 1.0 - step && !ease.breaks().into_iter().any(near)
}

#[test]
fn names_are_unique_well_formed_and_found() {
    let mut names = HashSet::new();
    for entry in registry() {
        for name in core::iter::once(&entry.name).chain(entry.aliases) {
            assert!(names.insert(*name), "{name}");
            assert!(name.chars().all(|c| c.is_ascii_lowercase() || c == '-'));
            assert_eq!(super::entry(name).unwrap().name, entry.name);
        }
        assert!(!entry.title.is_empty() && !entry.reference.is_empty());
        let parameters: HashSet<_> = entry.parameters.iter().map(|p| p.name).collect();
        assert_eq!(parameters.len(), entry.parameters.len(), "{}", entry.name);
        assert!(entry.parameters.iter().all(|p| !p.summary.is_empty()));
    }
}

#[test]
fn ends_are_exact_where_promised_and_nowhere_else() {
    for (name, ease) in all() {
        let facts = ease.facts();
        assert_eq!(facts.starts_at_zero, ease.value(0.0) == 0.0, "{name}");
        assert_eq!(
            facts.ends_at_one,
            ease.value(1.0) == 1.0,
            "{name}: {}",
            ease.value(1.0)
        );
    }
}

#[test]
fn every_time_has_finite_numbers() {
    let strange = [
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        -1.0,
        2.0,
        -0.0,
        5e-324,
        f64::EPSILON,
        1.0 - f64::EPSILON / 2.0,
        1.0 + f64::EPSILON,
    ];
    for (name, ease) in all() {
        let times = (0..=1000).map(|i| f64::from(i) * 1e-3);
        let breaks = ease.breaks();
        let beside = breaks.iter().flat_map(|b| [b.next_down(), *b, b.next_up()]);
        for t in times.chain(strange).chain(beside) {
            assert!(ease.value(t).is_finite(), "{name} at {t}");
            assert!(!ease.speed(t).is_nan(), "{name} at {t}");
            if ease.facts().finite_speed {
                assert!(ease.speed(t).is_finite(), "{name} at {t}");
            }
            assert!(ease.acceleration(t).is_finite(), "{name} at {t}");
        }
        assert_eq!(ease.value(f64::NAN), ease.value(0.0));
        assert_eq!(ease.value(-3.0), ease.value(0.0));
        assert_eq!(ease.value(7.0), ease.value(1.0));
        assert_eq!(ease.speed(7.0), 0.0);
    }
}

#[test]
fn breaks_increase_inside() {
    for (name, ease) in all() {
        let breaks = ease.breaks();
        assert!(breaks.windows(2).all(|pair| pair[0] < pair[1]), "{name}");
        assert!(breaks.iter().all(|&t| t > 0.0 && t < 1.0), "{name}");
    }
}

/// Both derivatives against Richardson's extrapolated differences, wherever these have settled.
#[test]
fn derivatives_are_difference_quotients() {
    for (name, ease) in all() {
        let mut compared = 0;
        for i in 0..1000 {
            let (t, h) = (0.0007 + f64::from(i) * 1e-3, 1e-5);
            if !clear(&*ease, t, 4.0 * h) {
                continue;
            }
            let check = |f: &dyn Fn(f64) -> f64, exact: f64, what: &str| {
                let d = |h: f64| (f(t + h) - f(t - h)) / (2.0 * h);
                let (coarse, fine) = (d(2.0 * h), d(h));
                let best = fine + (fine - coarse) / 3.0;
                let noise = 1e-14 * f(t).abs().max(1.0) / h;
                let tolerance = (fine - coarse).abs() + 30.0 * noise + 1e-7 * exact.abs();
                assert!(
                    (best - exact).abs() <= tolerance,
                    "{name}: {what} at {t} is {best}, not {exact}"
                );
            };
            check(&|t| ease.value(t), ease.speed(t), "speed");
            check(&|t| ease.speed(t), ease.acceleration(t), "acceleration");
            compared += 1;
        }
        assert!(compared > 500, "{name}: {compared}");
    }
}

#[test]
fn eases_declared_monotone_never_go_back() {
    for (name, ease) in all() {
        let values: Vec<f64> = (0..=4000)
            .map(|i| ease.value(f64::from(i) / 4000.0))
            .collect();
        let back = values.windows(2).any(|pair| pair[1] < pair[0] - 2e-15);
        if ease.facts().monotone {
            assert!(!back, "{name}");
            assert!(
                (0..=4000).all(|i| ease.speed(f64::from(i) / 4000.0) >= -1e-12),
                "{name}"
            );
        }
    }
}

#[test]
fn eases_are_as_smooth_as_declared() {
    for (name, ease) in all() {
        let facts = ease.facts();
        for b in ease.breaks() {
            let (before, behind) = (b - 1e-9, b + 1e-9);
            let steep = ease.speed(before).abs().max(ease.speed(behind).abs());
            if facts.smoothness > Smoothness::Jump {
                let jump = (ease.value(behind) - ease.value(before)).abs();
                // The steepest, a cube root, rises by 2e-3 over that step.
                assert!(
                    jump <= 1e-2 && jump <= 1e-8 * (1.0 + steep),
                    "{name} at {b}"
                );
            }
            if facts.smoothness >= Smoothness::C(1) {
                let jump = (ease.speed(behind) - ease.speed(before)).abs();
                let curved = ease
                    .acceleration(before)
                    .abs()
                    .max(ease.acceleration(behind).abs());
                assert!(jump <= 1e-8 * (1.0 + curved), "{name} at {b}");
            }
        }
    }
}

/// Values of the families as their authors' formulas give them, where ours do not deviate.
#[test]
fn known_values() {
    let at = |name: &str, t: f64| ease(name, &[]).unwrap().value(t);
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-14, "{a} is not {b}");
    close(at("quad-in-out", 0.25), 0.125);
    close(at("cubic-in", 0.5), 0.125);
    close(at("quart-out", 0.5), 0.9375);
    close(at("quint-in", 0.5), 0.03125);
    close(at("back-in", 0.5), 2.70158 * 0.125 - 1.70158 * 0.25);
    let in_out = 1.70158 * 1.525;
    close(
        at("back-in-out", 0.25),
        0.5 * (0.25 * ((in_out + 1.0) * 0.5 - in_out)),
    );
    close(
        at("bounce-out", 0.5),
        7.5625 * (0.5f64 - 1.5 / 2.75).powi(2) + 0.75,
    );
    close(
        at("bounce-out", 0.95),
        7.5625 * (0.95f64 - 2.625 / 2.75).powi(2) + 0.984_375,
    );
    close(at("bounce-in", 0.9), 1.0 - 7.5625 * 0.1 * 0.1);
    close(at("circular-in", 0.6), 0.2);
    close(at("sine-in-out", 0.3), at("sinusoidal", 0.3));
    // Deviations from the printed formulas, which jump at the start, stay below 1/1024.
    for i in 1..=100 {
        let t = f64::from(i) * 0.01;
        let printed = 2f64.powf(10.0 * (t - 1.0));
        assert!((at("exponential-in", t) - printed).abs() < 1.0 / 1024.0);
        let printed = -printed * ((10.0 * t - 10.75) * core::f64::consts::TAU / 3.0).sin();
        assert!((at("elastic-in", t) - printed).abs() < 1.0 / 1024.0);
    }
    // The run-up goes back as far as its documentation says.
    let back = Back::new(4.0).unwrap();
    let least = (0..=100_000).fold(0.0_f64, |m, i| m.min(back.value(f64::from(i) * 1e-5)));
    assert!((least + 4.0 * 64.0 / (27.0 * 25.0)).abs() < 1e-9);
}

/// Where the abscissa is `½ + 4(s − ½)³` the parameter has a closed form; its slope is infinite at one half.
#[test]
fn the_steepest_curve_is_inverted_to_its_last_digits() {
    let curve = CubicBezier::new(1.0, 0.0, 0.0, 1.0).unwrap();
    let mut distances: Vec<f64> = (0..=100)
        .map(|i| 10f64.powf(-15.0 + 0.1469 * f64::from(i)))
        .collect();
    distances.push(0.0);
    for distance in distances {
        for t in [0.5 - distance, 0.5 + distance] {
            let u = ((t - 0.5) / 4.0).cbrt();
            let expected = 0.5 + u * (1.5 - 2.0 * u * u);
            let error = (curve.value(t) - expected).abs();
            assert!(error <= 1e-12, "{distance:e}: {error:e}");
        }
    }
}

/// The abscissa at the parameter that was found, computed by the curve itself with its coordinates exchanged.
#[test]
fn curves_are_inverted_to_rounding() {
    let mut seed = 1_u64;
    let mut next = || {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        (seed >> 11) as f64 / (1_u64 << 53) as f64
    };
    for _ in 0..2000 {
        let (x1, x2, s) = (next(), next(), next());
        let (y1, y2) = (4.0 * next() - 1.5, 4.0 * next() - 1.5);
        let r = 1.0 - s;
        let of = |a: f64, b: f64| 3.0 * r * r * s * a + 3.0 * r * s * s * b + s * s * s;
        let curve = CubicBezier::new(x1, y1, x2, y2).unwrap();
        let slope = curve.speed(of(x1, x2)).abs();
        let error = (curve.value(of(x1, x2)) - of(y1, y2)).abs();
        assert!(
            error <= 1e-15 * (4.0 + 4.0 * slope),
            "{curve:?} at {s}: {error:e}"
        );
    }
}

#[test]
fn steps_jump_where_style_sheets_say() {
    let values = |text: &str, times: &[f64]| -> Vec<f64> {
        let ease = parse(text).unwrap();
        times.iter().map(|&t| ease.value(t)).collect()
    };
    let times = [0.0, 0.49, 0.5, 0.99, 1.0];
    assert_eq!(
        values("steps(2, jump-start)", &times),
        [0.5, 0.5, 1.0, 1.0, 1.0]
    );
    assert_eq!(values("steps(2, start)", &times), [0.5, 0.5, 1.0, 1.0, 1.0]);
    assert_eq!(values("steps(2)", &times), [0.0, 0.0, 0.5, 0.5, 1.0]);
    assert_eq!(
        values("steps(2, jump-none)", &times),
        [0.0, 0.0, 1.0, 1.0, 1.0]
    );
    let thirds = [1.0 / 3.0, 1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0, 1.0];
    assert_eq!(values("steps(2, jump-both)", &times), thirds);
    assert_eq!(values("step-start", &[0.0, 1.0]), [1.0, 1.0]);
    assert_eq!(values("STEP-END", &[0.0, 0.999, 1.0]), [0.0, 0.0, 1.0]);
}

#[test]
fn stops_without_times_are_spread_evenly() {
    let ease = parse("linear(0, 0.1, 0.5 50% 60%, 2 55%, 1)").unwrap();
    let close = |t: f64, value: f64| assert!((ease.value(t) - value).abs() < 1e-15, "{t}");
    close(0.25, 0.1);
    close(0.125, 0.05);
    close(0.55, 0.5);
    // The time 55 % is raised to 60 %: a jump.
    close(0.6 - 1e-16, 0.5);
    close(0.6, 2.0);
    close(0.8, 1.5);
    // Lines go on beyond the first and the last stop.
    let short = parse("linear(0 20%, 1 60%)").unwrap();
    assert!((short.value(0.0) + 0.5).abs() < 1e-15);
    assert!((short.value(1.0) - 2.0).abs() < 1e-15);
    assert_eq!(parse("linear").unwrap().value(0.3), 0.3);
}

#[test]
fn notation_of_style_sheets() {
    for text in [
        "cubic-bezier(0.25, 0.1, 0.25, 1)",
        " Cubic-Bezier( .25,+1e-1 , 25e-2,1.0 ) ",
        "ease",
    ] {
        let ease = parse(text).unwrap();
        for i in 0..=10 {
            let t = f64::from(i) / 10.0;
            assert_eq!(ease.value(t), CubicBezier::EASE.value(t), "{text}");
        }
    }
    assert!(parse("constant-acceleration").is_ok());
    let wrong = [
        ("", 1, "name"),
        ("cubic-bezier(0.25, 0.1, 0.25)", 29, "comma"),
        ("cubic-bezier(0.25, 0.1, 0.25, 1, 2)", 32, "left over"),
        ("cubic-bezier(0.25, nan, 0.25, 1)", 20, "number"),
        ("cubic-bezier(0.25, 1e999, 0.25, 1)", 20, "too large"),
        ("cubic-bezier(0.25, 1., 0.25, 1)", 22, "digit"),
        ("steps(3, jump-often)", 10, "jump-start"),
        ("steps(3", 8, "parenthesis"),
        ("linear(0, 20%, 1)", 11, "needs a number"),
        ("linear(0, 0.3 0.4, 1)", 18, "comma"),
        ("linear(0, 1 20% 30% 40%)", 24, "percentages"),
        ("linear(0, 20% 1 30%)", 20, "together"),
        ("ease é", 6, "follow"),
        ("é", 1, "name"),
    ];
    for (text, place, part) in wrong {
        match parse(text).unwrap_err() {
            CurveError::Text {
                character, problem, ..
            } => {
                assert_eq!(character, place, "{text}: {problem}");
                assert!(problem.contains(part), "{text}: {problem}");
            }
            other => panic!("{text}: {other:?}"),
        }
    }
    let others = [
        ("cubic-bezier(1.5, 0, 0, 1)", "x1 is 1.5"),
        ("steps(0)", "count is 0"),
        ("steps(1, jump-none)", "from 2"),
        ("steps(2.5)", "whole number"),
        ("steps(4000000000)", "1000000"),
        ("linear(1)", "at least 2"),
        ("ease-outt", "no ease is called `ease-outt`"),
        ("spring(1, 2)", "cubic-bezier(), steps(), linear()"),
    ];
    for (text, part) in others {
        let message = parse(text).unwrap_err().to_string();
        assert!(message.contains(part), "{text}: {message}");
    }
}

#[test]
fn settings_are_checked() {
    let acceleration = entry("constant-acceleration").unwrap();
    let built = acceleration.construct(&[("t1", 0.2.into()), ("t2", 0.7.into())]);
    assert!((built.unwrap().value(0.05) - 0.008_333_333_333_333_333).abs() < 1e-15);
    let wrong: [(&[(&str, Setting<'_>)], &str); 5] = [
        (
            &[("t3", Setting::Number(0.5))],
            "no parameter of this ease is called `t3`",
        ),
        (
            &[("t1", Setting::Word("soon"))],
            "t1 is a word, but must be a number",
        ),
        (&[("t1", Setting::Number(f64::NAN))], "t1 is NaN"),
        (&[("t1", Setting::Number(-0.1))], "from 0 to 1"),
        (&[("t1", Setting::Number(0.9))], "from t1 to 1"),
    ];
    for (given, part) in wrong {
        let message = acceleration.construct(given).unwrap_err().to_string();
        assert!(message.contains(part), "{message}");
    }
    let stuck = ease("spring", &[("damping", 0.0.into())])
        .unwrap_err()
        .to_string();
    assert!(stuck.contains("change the damping"), "{stuck}");
}

/// A spring against its equation, solved by the classical Runge–Kutta method.
#[test]
fn springs_obey_their_equation() {
    for (damping, velocity) in [
        (1.0, 0.0),
        (5.0, -3.0),
        (20.0, 0.0),
        (20.0, 30.0),
        (70.0, 5.0),
    ] {
        let spring = Spring::new(1.0, 100.0, damping, velocity, 1e-6).unwrap();
        let unit = spring.settling_time();
        let force = |x: f64, v: f64| -100.0 * x - damping * v;
        let (mut x, mut v) = (-1.0, velocity);
        let steps = 40_000;
        let h = unit / f64::from(steps);
        for i in 1..=steps {
            let (k1, l1) = (v, force(x, v));
            let (k2, l2) = (v + 0.5 * h * l1, force(x + 0.5 * h * k1, v + 0.5 * h * l1));
            let (k3, l3) = (v + 0.5 * h * l2, force(x + 0.5 * h * k2, v + 0.5 * h * l2));
            let (k4, l4) = (v + h * l3, force(x + h * k3, v + h * l3));
            x += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
            v += h / 6.0 * (l1 + 2.0 * l2 + 2.0 * l3 + l4);
            if i % 500 == 0 {
                let t = f64::from(i) / f64::from(steps);
                // The correction that settles it is of the size of `rest`.
                let error = (spring.value(t) - 1.0 - x).abs();
                assert!(error < 2e-5, "{damping}, {velocity} at {t}: {error:e}");
            }
        }
        assert!((spring.speed(0.0) - velocity * unit).abs() < 1e-9 * unit * 40.0);
        assert!(spring.speed(1.0).abs() < 1e-9);
    }
}

/// Every registered ease with its usual parameters at 11 times.
#[test]
fn snapshot() {
    let mut lines = Vec::new();
    for entry in registry() {
        let ease = entry.construct(&[]).unwrap();
        let values: Vec<String> = (0..=10)
            .map(|i| {
                let text = format!("{:.9}", ease.value(f64::from(i) / 10.0));
                text.strip_prefix('-')
                    .filter(|t| *t == "0.000000000")
                    .map_or(text.clone(), str::to_owned)
            })
            .collect();
        lines.push(format!("{}: {}", entry.name, values.join(" ")));
    }
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path("snapshots");
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!("eases", lines.join("\n")));
}
