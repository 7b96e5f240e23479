//! The page `curves.md` of the documentation: how well five methods measure hard curves.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Reparameterizing by arc length" (errata C11).

use crate::motion::drawing::Frame;
use anamorph_core::Plane;
use anamorph_core::glam::dvec2;
use anamorph_curves::arc_length::methods::{Measured, methods};
use anamorph_curves::families::registry::{Given, Path, family};
use anamorph_preview::{Anchor, Figure, Ink};
use std::fmt::Write;

/// A curve that is hard to measure.
struct Hard {
    name: &'static str,
    about: &'static str,
    family: &'static str,
    points: &'static [[f64; 2]],
}

const HARD: &[Hard] = &[
    Hard {
        name: "smooth",
        about: "a cubic without surprises, to compare with",
        family: "bezier",
        points: &[[0.0, 0.0], [1.0, 2.0], [3.0, -1.0], [4.0, 1.0]],
    },
    Hard {
        name: "nearly a cusp",
        about: "a cubic that almost stops in the middle",
        family: "bezier",
        points: &[[0.0, 0.0], [4.0, 3.0], [0.001, 3.0], [4.0, 0.0]],
    },
    Hard {
        name: "cusp",
        about: "a cubic that stops and turns sharply at a third of its parameter",
        family: "bezier",
        points: &[[0.0, 0.0], [4.0, 3.0], [-0.5, 1.0], [1.5, -3.0]],
    },
    Hard {
        name: "there and back",
        about: "all points on a line: the speed has two zeros",
        family: "bezier",
        points: &[[0.0, 0.0], [5.0, 0.0], [-3.0, 0.0], [1.7, 0.0]],
    },
    Hard {
        name: "crowded end",
        about: "three control points within a thousandth: nearly all of the parameter goes a little way",
        family: "bezier",
        points: &[[0.0, 0.0], [0.001, 0.0], [0.0, 0.001], [9.0, 1.0]],
    },
    Hard {
        name: "many pieces",
        about: "a Catmull-Rom curve through zigzagging points",
        family: "catmull-rom",
        points: &[
            [0.0, 0.0],
            [1.0, 3.0],
            [1.2, -2.0],
            [2.0, 2.5],
            [2.1, -2.5],
            [3.0, 3.0],
            [3.05, 0.0],
            [6.0, 0.1],
        ],
    },
];

/// Accuracies asked for, in shares of the length.
const ACCURACIES: [f64; 8] = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9];
/// That of the table.
const TABLE: f64 = 1e-6;
/// Below this an error is rounding.
const LEAST: f64 = 1e-13;

impl Hard {
    fn curve(&self) -> Option<Box<dyn Path<Plane>>> {
        let given = Given {
            points: self.points.iter().map(|[x, y]| dvec2(*x, *y)).collect(),
            ..Given::default()
        };
        family(self.family)?.make(&given).ok()
    }
}

/// What a method did, with its error as a share of the length.
fn measured(curve: &dyn Path<Plane>, method: usize, accuracy: f64, length: f64) -> (Measured, f64) {
    let found = methods::<Plane>()[method].measure(curve, accuracy * length);
    (found, ((found.length - length).abs() / length).max(LEAST))
}

const COLOURS: [Ink; 5] = [
    Ink::new(150, 104, 190),
    Ink::new(200, 150, 20),
    Ink::new(38, 150, 100),
    Ink::new(36, 99, 190),
    Ink::new(214, 70, 60),
];

/// The plot: a panel a curve, error over evaluations, both by powers of ten.
pub(super) fn svg() -> String {
    let (ink, faint) = (Ink::new(38, 46, 56), Ink::new(120, 130, 142));
    let grid = Ink::new(226, 230, 234);
    let mut figure = Figure::new(1200.0, 810.0, Ink::new(255, 255, 255));
    for (i, hard) in (0_u32..).zip(HARD) {
        let (column, row) = (f64::from(i % 3), f64::from(i / 3));
        let (left, top) = (72.0 + 380.0 * column, 110.0 + 380.0 * row);
        let room = Frame {
            left,
            top,
            right: left + 300.0,
            bottom: top + 280.0,
        };
        // Evaluations from 10 to 10^7, errors from 1 to 1e-16.
        // What lies beyond is drawn at the edge.
        let x = |n: f64| {
            let share = ((n.log10() - 1.0) / 6.0).clamp(0.0, 1.0);
            room.left + share * (room.right - room.left)
        };
        let y = |e: f64| {
            let share = (-e.log10() / 16.0).clamp(0.0, 1.0);
            room.top + share * (room.bottom - room.top)
        };
        for power in 1..=7 {
            let at = x(10.0_f64.powi(power));
            figure.line(&[[at, room.top], [at, room.bottom]], grid, 1.0);
            if power % 2 == 1 {
                figure.words(
                    [at, room.bottom + 18.0],
                    9.0,
                    Anchor::Middle,
                    faint,
                    &format!("1e{power}"),
                );
            }
        }
        for power in (0..=16).step_by(4) {
            let at = y(10.0_f64.powi(-power));
            figure.line(&[[room.left, at], [room.right, at]], grid, 1.0);
            figure.words(
                [room.left - 8.0, at + 4.0],
                9.0,
                Anchor::End,
                faint,
                &if power == 0 {
                    "1".to_owned()
                } else {
                    format!("1e-{power}")
                },
            );
        }
        figure.words(
            [room.left, room.top - 14.0],
            12.0,
            Anchor::Start,
            ink,
            hard.name,
        );
        let Some(curve) = hard.curve() else {
            continue;
        };
        let length = curve.length(1e-14);
        for (method, colour) in COLOURS.into_iter().enumerate() {
            let points: Vec<[f64; 2]> = ACCURACIES
                .iter()
                .map(|accuracy| {
                    let (found, error) = measured(curve.as_ref(), method, *accuracy, length);
                    #[allow(clippy::cast_precision_loss)]
                    [x(found.evaluations as f64), y(error)]
                })
                .collect();
            figure.line(&points, colour, 2.0);
            for at in points {
                figure.disc(at, 3.0, colour);
            }
        }
    }
    let mut at = 72.0;
    for (method, colour) in methods::<Plane>().iter().zip(COLOURS) {
        figure.line(&[[at, 38.0], [at + 26.0, 38.0]], colour, 3.0);
        figure.words([at + 34.0, 43.0], 11.0, Anchor::Start, ink, method.name());
        at += 215.0;
    }
    figure.words([72.0, 72.0], 10.0, Anchor::Start, faint, "error, as a share of the length, over evaluations; one dot for each accuracy asked for, 1e-2 to 1e-9");
    figure.svg("Error against evaluations of five methods of measuring the length of six curves")
}

/// A number of evaluations with blanks between thousands.
fn grouped(number: usize) -> String {
    let digits = number.to_string();
    let mut out = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push(' ');
        }
        out.push(digit);
    }
    out
}

/// The page.
pub(super) fn markdown() -> String {
    let mut text = String::from(
        "# Curves: five ways to measure them\n\n\
         Written by `cargo xtask gallery`. The slides name five ways to measure the length of a curve;\n\
         `anamorph_curves::arc_length::methods` has all of them, each with an explicit accuracy, for comparison. What the crate\n\
         itself uses (`ArcLength`, `LengthTable`) knows its error beforehand.\n\n\
         ![Error against evaluations of five methods on six curves](images/arc-length.svg)\n\n\
         Methods refine until two approximations agree to the accuracy asked for. Agreement is evidence, not proof: chords of a\n\
         path that goes there and back agree where they all miss the turning points. Straight chords (the first three) gain four\n\
         times the accuracy for twice the work; Gauss' rule of 16 nodes gains nearly everything at once where the speed is smooth,\n\
         and little where it vanishes, unless intervals shrink towards that place, as the last method's do. Forward differencing\n\
         costs additions alone, and gathers rounding until nothing else is left.\n\n",
    );
    let _ = writeln!(
        text,
        "Evaluations, and the error that is left, for the accuracy 1e-6 of the length:\n"
    );
    let mut header = "| curve |".to_owned();
    let mut rule = "| --- |".to_owned();
    for method in methods::<Plane>() {
        let _ = write!(header, " {} |", method.name());
        rule.push_str(" ---: |");
    }
    let _ = writeln!(text, "{header}\n{rule}");
    for hard in HARD {
        let Some(curve) = hard.curve() else {
            continue;
        };
        let length = curve.length(1e-14);
        let _ = write!(text, "| {} |", hard.name);
        for method in 0..COLOURS.len() {
            let (found, error) = measured(curve.as_ref(), method, TABLE, length);
            let failed = if found.converged { "" } else { " (gave up)" };
            let _ = write!(
                text,
                " {}, {error:.0e}{failed} |",
                grouped(found.evaluations)
            );
        }
        text.push('\n');
    }
    text.push_str("\nThe curves:\n\n| curve | what it is | points |\n| --- | --- | --- |\n");
    for hard in HARD {
        let points: Vec<String> = hard
            .points
            .iter()
            .map(|[x, y]| format!("({x}, {y})"))
            .collect();
        let _ = writeln!(
            text,
            "| {} | {} ({}) | {} |",
            hard.name,
            hard.about,
            hard.family,
            points.join(" ")
        );
    }
    text.push_str(
        "\nFamilies of curves, eases and orientations are listed by `anamorph list curves`, `list eases` and\n\
         `list orientations`, and shown by `anamorph gallery`; [recipes](recipes.md#motions) says how a motion names them.\n",
    );
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_of_the_documentation_is_what_is_written() {
        let docs = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs");
        let page = std::fs::read_to_string(docs.join("curves.md")).unwrap();
        assert!(
            page == markdown(),
            "docs/curves.md is not what `cargo xtask gallery` writes"
        );
        let plot = std::fs::read_to_string(docs.join("images/arc-length.svg")).unwrap();
        assert!(
            plot == svg(),
            "docs/images/arc-length.svg is not what `cargo xtask gallery` writes"
        );
    }

    #[test]
    fn errors_keep_what_was_asked_for_on_smooth_curves() {
        let curve = HARD[0].curve().unwrap();
        let length = curve.length(1e-14);
        for method in 0..COLOURS.len() {
            for accuracy in [1e-3, 1e-6] {
                let (found, error) = measured(curve.as_ref(), method, accuracy, length);
                assert!(
                    found.converged && error <= accuracy,
                    "{method} {accuracy} {error}"
                );
            }
        }
        assert_eq!(grouped(4_194_304), "4 194 304");
    }
}
