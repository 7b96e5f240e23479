//! Curves, eases and orientations: a small plot of each that is registered.
//!
//! *Source*: the order of *Interpolation Techniques*, chapters 2 and 3.

use super::page::escape;
use super::plots::plot;
use anamorph_core::Plane;
use anamorph_core::Solid;
use anamorph_core::glam::DVec2;
use anamorph_curves::eases::{self, EaseEntry};
use anamorph_curves::families::registry::{FAMILIES, Family, Given};
use anamorph_curves::orientation::registry::{MODIFIERS, ORIENTATIONS};
use anamorph_recipe::{BuiltMotion, KEYED, Recipe};
use std::fmt::Write;

/// Width and height of a small picture, as those of plots.
const SIZE: [f64; 2] = [220.0, 140.0];

/// The control points of all families: seven, of which every family can make an open curve.
const POINTS: [[f64; 2]; 7] = [
    [20.0, 96.0],
    [42.0, 30.0],
    [84.0, 26.0],
    [104.0, 84.0],
    [128.0, 122.0],
    [172.0, 112.0],
    [200.0, 42.0],
];

/// What a family makes of the points; velocities are half the way from neighbour to neighbour.
pub(super) fn example(family: &Family) -> Given<Plane> {
    let points: Vec<Plane> = POINTS.map(|[x, y]| DVec2::new(x, y)).to_vec();
    let last = points.len() - 1;
    let velocity = |i: usize| (points[(i + 1).min(last)] - points[i.saturating_sub(1)]) * 0.5;
    Given {
        velocities: if family.velocities {
            (0..=last).map(velocity).collect()
        } else {
            Vec::new()
        },
        points,
        ..Given::default()
    }
}

fn polyline(class: &str, points: impl Iterator<Item = [f64; 2]>) -> String {
    let mut svg = format!("<polyline class=\"{class}\" points=\"");
    for [x, y] in points {
        let _ = write!(svg, "{x:.1},{y:.1} ");
    }
    svg.push_str("\"/>");
    svg
}

fn figure(svg: &str, name: &str, about: &str) -> String {
    format!(
        "<figure>{svg}<figcaption><b>{}</b><br>{}</figcaption></figure>\n",
        escape(name),
        escape(about)
    )
}

fn opened(label: &str) -> String {
    let [width, height] = SIZE;
    format!(
        "<svg class=\"plot\" viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{}\">",
        escape(label)
    )
}

/// Every family through the same points.
pub(super) fn families_html() -> String {
    let mut html = String::new();
    for family in FAMILIES {
        let mut svg = opened(&format!("the curve {}", family.name));
        svg.push_str(&polyline("grid", POINTS.into_iter()));
        for [x, y] in POINTS {
            let _ = write!(svg, "<circle class=\"dot\" cx=\"{x}\" cy=\"{y}\" r=\"3\"/>");
        }
        if let Ok(curve) = family.make(&example(family)) {
            let (start, end) = curve.domain();
            let at = |i: u32| curve.point(start + (end - start) * f64::from(i) / 160.0);
            svg.push_str(&polyline("curve", (0..=160).map(|i| at(i).to_array())));
        }
        svg.push_str("</svg>");
        html.push_str(&figure(
            &svg,
            family.name,
            &format!("{}; {}", family.title, family.reference),
        ));
    }
    html
}

/// The plot of an ease, with all that it overshoots.
fn ease_svg(entry: &EaseEntry) -> Option<String> {
    let ease = entry.construct(entry.example).ok()?;
    let values = (0..=400).map(|i| ease.value(f64::from(i) / 400.0));
    let [low, high] = values.fold([0.0_f64, 1.0], |m, v| [m[0].min(v), m[1].max(v)]);
    let room = 0.06 * (high - low);
    Some(plot(
        &format!("the ease {}: distance over time", entry.name),
        [0.0, 1.0],
        [if low < 0.0 { low - room } else { 0.0 }, high + room],
        &[0.0, 0.5, 1.0],
        |t| ease.value(t),
    ))
}

/// Every ease.
pub(super) fn eases_html() -> String {
    let shown = eases::registry().iter();
    shown
        .filter_map(|entry| Some(figure(&ease_svg(entry)?, entry.name, entry.title)))
        .collect()
}

/// A path that climbs, turns both ways and has an inflection.
const PATH: &str = "path = { kind = \"catmull-rom\", points = [[-3, 0, 0.6], [-1.9, 1.7, 1.9], [-0.4, 0.6, 1.2], [0.7, -0.5, -0.9], \
    [2, 0.9, -1.7], [3.1, 2.2, 0.2]] }";

/// A recipe that shows an orientation.
pub(super) fn recipe(name: &str) -> String {
    let orientation = match name {
        "look-at" => "{ kind = \"look-at\", target = [0, 0.6, 3] }".to_owned(),
        "look-ahead" => "{ kind = \"look-ahead\", distance = \"15%\" }".to_owned(),
        "auxiliary" => "{ kind = \"auxiliary\", curve = { kind = \"catmull-rom\", points = [[-2, 2.2, 1], [0, 2.6, -0.5], [3, 2.2, 0]] } }"
            .to_owned(),
        "banking" => "{ kind = \"up\", banking = { speed = 2.6, smoothing = \"8%\" } }".to_owned(),
        name if KEYED.iter().any(|entry| entry.name == name) => format!(
            "{{ kind = \"{name}\", keys = [{{ time = 0, axis = \"y\", angle = \"40deg\" }}, \
             {{ time = \"30%\", axis = [1, 0, 1], angle = \"120deg\" }}, {{ time = \"70%\", axis = \"x\", angle = \"-60deg\" }}, \
             {{ time = \"100%\", axis = \"y\", angle = \"90deg\" }}] }}"
        ),
        name => format!("\"{name}\""),
    };
    format!("version = 1\n[motion]\nduration = 1\n{PATH}\norientation = {orientation}\n")
}

/// The names of all orientations and of what changes them.
pub(super) fn orientations() -> impl Iterator<Item = (&'static str, &'static str)> {
    let along = ORIENTATIONS.iter().map(|e| (e.name, e.summary));
    let keyed = KEYED.iter().map(|e| (e.name, e.summary));
    let changes = MODIFIERS.iter().map(|e| (e.name, e.summary));
    along.chain(keyed).chain(changes)
}

/// Frames along the path, seen from the front right and above.
fn frames_svg(name: &str, built: &BuiltMotion) -> String {
    const ARM: f64 = 0.85;
    const FRAMES: u32 = 12;
    let flat = |p: Solid| [0.87 * p.x - 0.45 * p.z, 0.92 * p.y - 0.2 * p.x - 0.36 * p.z];
    let motion = &built.motion;
    let line = (0..=160).map(|i| flat(motion.position(f64::from(i) / 160.0)));
    let times: Vec<f64> = (0..=FRAMES)
        .map(|i| f64::from(i) / f64::from(FRAMES))
        .collect();
    let mut lines = vec![("curve", line.collect::<Vec<_>>())];
    for (time, q) in times.iter().zip(built.rotations(&times)) {
        let at = motion.position(*time);
        for (class, axis) in [("left", Solid::X), ("up", Solid::Y), ("forward", Solid::Z)] {
            lines.push((class, vec![flat(at), flat(at + q * axis * ARM)]));
        }
    }
    // As large as the picture holds.
    let all = lines.iter().flat_map(|(_, points)| points);
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for point in all {
        for k in 0..2 {
            low[k] = low[k].min(point[k]);
            high[k] = high[k].max(point[k]);
        }
    }
    let scales = [0, 1].map(|k| (SIZE[k] - 16.0) / (high[k] - low[k]));
    let scale = scales[0].min(scales[1]);
    let place = |[x, y]: [f64; 2]| {
        [
            0.5 * SIZE[0] + scale * (x - 0.5 * (low[0] + high[0])),
            0.5 * SIZE[1] - scale * (y - 0.5 * (low[1] + high[1])),
        ]
    };
    let mut svg = opened(&format!("frames of the orientation {name}"));
    for (class, points) in lines {
        svg.push_str(&polyline(class, points.into_iter().map(place)));
    }
    svg.push_str("</svg>");
    svg
}

/// Every orientation on the same path.
pub(super) fn orientations_html() -> String {
    let mut html = String::new();
    for (name, summary) in orientations() {
        let built =
            Recipe::from_toml(&recipe(name), name).and_then(|recipe| recipe.build_motion(None));
        if let Ok(built) = built {
            html.push_str(&figure(&frames_svg(name, &built), name, summary));
        }
    }
    html
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_registered_is_shown() {
        let families = families_html();
        for family in FAMILIES {
            assert!(families.contains(&format!("<b>{}</b>", family.name)));
            family.make(&example(family)).unwrap();
        }
        assert_eq!(families.matches("class=\"curve\"").count(), FAMILIES.len());
        let plots = eases_html();
        for entry in eases::registry() {
            assert!(
                plots.contains(&format!("<b>{}</b>", entry.name)),
                "{}",
                entry.name
            );
        }
        let frames = orientations_html();
        for (name, _) in orientations() {
            let recipe = Recipe::from_toml(&recipe(name), name).unwrap();
            recipe
                .build_motion(None)
                .map_err(|error| error.to_string())
                .unwrap();
            assert!(frames.contains(&format!("<b>{name}</b>")), "{name}");
        }
    }

    #[test]
    fn small_pictures_stay_in_their_frame() {
        for html in [families_html(), orientations_html(), eases_html()] {
            for list in html.split(" points=\"").skip(1) {
                let (points, _) = list.split_once('"').unwrap();
                for point in points.split_whitespace() {
                    let (x, y) = point.split_once(',').unwrap();
                    let (x, y): (f64, f64) = (x.parse().unwrap(), y.parse().unwrap());
                    assert!(
                        (0.0..=220.0).contains(&x) && (0.0..=140.0).contains(&y),
                        "{point}"
                    );
                }
            }
        }
    }
}
