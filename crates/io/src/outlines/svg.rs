//! SVG drawings as filled shapes: paths and basic shapes of all groups, with transforms, fills and fill rules resolved.
//!
//! Coordinates are those of the drawing's pixels (its `width` and `height`, or those of the `viewBox`): y grows downwards. They pass through
//! 32-bit numbers. Clips, masks, filters and blend modes are left out, gradients become their mean colour, text and pictures are not
//! converted; notes say so. No other file is opened. What would unfold to more than [`MOST_ELEMENTS`], or is nested deeper than
//! [`DEEPEST`], is refused before anything is unfolded.
//!
//! *Source*: W3C, *Scalable Vector Graphics (SVG) 2*, 2018; parsed by `roxmltree` and `usvg`, which resolve entities, shapes, references
//! and styles.

use super::drawing::{Contour, Drawing, Part, Rule, Segment, Stroke};
use crate::error::{ReadError, ReadErrorKind};
use anamorph_core::glam::{DVec2, dvec2};
use std::collections::HashMap;
use usvg::roxmltree;
use usvg::tiny_skia_path::{PathSegment, Transform};

/// Elements of a drawing at most, once `use` elements are replaced by what they refer to.
pub const MOST_ELEMENTS: u64 = 1_000_000;
/// Elements inside of each other at most.
pub const DEEPEST: usize = 512;
/// Bytes of a file at most.
const LARGEST: usize = 1 << 28;
/// Points of all contours at most.
const MOST_POINTS: usize = 1 << 23;
/// Rounds of unfolding after which references are said to be too deep.
const ROUNDS: usize = 256;

fn damaged(what: impl Into<String>, mend: &str) -> ReadError {
    ReadError::new(ReadErrorKind::Syntax, what, mend)
}

fn too_large(what: impl Into<String>) -> ReadError {
    let mend = "keep only the paths that are needed, and export them as plain SVG";
    ReadError::new(ReadErrorKind::TooLarge, what, mend)
}

/// Reads the filled and stroked paths of an SVG drawing.
///
/// # Errors
/// What is no SVG drawing, unfolds to too much, or shows no path.
pub fn read_svg(bytes: &[u8]) -> Result<Drawing, ReadError> {
    if bytes.len() > LARGEST {
        return Err(too_large("this drawing is larger than 256 MiB"));
    }
    if bytes.starts_with(&[0x1f, 0x8b]) {
        return Err(ReadError::new(
            ReadErrorKind::Unsupported,
            "this drawing is compressed (SVGZ)",
            "unpack it with gunzip",
        ));
    }
    let text = core::str::from_utf8(bytes).map_err(|error| {
        let what = "this drawing is not UTF-8 text";
        ReadError::new(ReadErrorKind::Encoding, what, "save it as UTF-8")
            .at(bytes, error.valid_up_to())
    })?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let options = roxmltree::ParsingOptions {
        allow_dtd: true,
        nodes_limit: 8_000_000,
        ..Default::default()
    };
    let xml = roxmltree::Document::parse_with_options(text, options).map_err(|error| {
        let place = error.pos();
        let mut refused = match error {
            roxmltree::Error::EntityReferenceLoop(_) => damaged(
                "entities of this drawing refer to each other without end",
                "write the text itself in place of the entities",
            ),
            roxmltree::Error::NodesLimitReached => too_large("this drawing has too many elements"),
            _ => damaged(
                format!("this is no drawing that can be read: {error}"),
                "export it as plain SVG",
            ),
        };
        if place.row > 0 {
            refused.line = Some(u64::from(place.row));
            refused.column = Some(u64::from(place.col));
        }
        refused
    })?;
    check_size(&xml)?;
    let tree = usvg::Tree::from_xmltree(&xml, &crate::drawings::options()).map_err(|error| {
        damaged(
            format!("this is no drawing that can be read: {error}"),
            "export it as plain SVG",
        )
    })?;
    let mut reader = Reader::default();
    reader.group(tree.root(), 1.0, None)?;
    if reader.parts.is_empty() {
        return Err(ReadError::new(
            ReadErrorKind::NoPath,
            "this drawing shows no path that can be read",
            "draw one, with a fill or a stroke, mend its path data, or turn text into paths",
        ));
    }
    let named = |name: &'static str| {
        xml.descendants()
            .filter(move |n| n.has_tag_name((SVG, name)))
    };
    let texts = named("text").count();
    reader.note(texts, "text", "not converted; turn it into paths");
    let pictures = named("image").count();
    reader.note(pictures, "picture", "left out");
    let title = named("title").next().and_then(|title| title.text());
    let size = tree.size();
    Ok(Drawing {
        name: title
            .map(|title| title.trim().to_owned())
            .filter(|t| !t.is_empty()),
        units: Some("px".to_owned()),
        parts: core::mem::take(&mut reader.parts),
        canvas: Some([0.0, 0.0, f64::from(size.width()), f64::from(size.height())]),
        y_down: true,
        notes: reader.finish(),
    })
}

const SVG: &str = "http://www.w3.org/2000/svg";
const XLINK: &str = "http://www.w3.org/1999/xlink";

/// Refuses drawings that would unfold to too much.
fn check_size(xml: &roxmltree::Document<'_>) -> Result<(), ReadError> {
    // Numbers of nodes grow in the order of the document, parents before children.
    let mut known: HashMap<&str, usize> = HashMap::new();
    let mut depth: Vec<usize> = Vec::new();
    let mut nodes: Vec<(Option<usize>, Option<&str>)> = Vec::new();
    let mut number: HashMap<roxmltree::NodeId, usize> = HashMap::new();
    for node in xml.descendants().filter(roxmltree::Node::is_element) {
        let own = nodes.len();
        let parent = node
            .parent()
            .and_then(|parent| number.get(&parent.id()).copied());
        let deep = parent.map_or(0, |parent| depth[parent] + 1);
        if deep > DEEPEST {
            return Err(too_large(format!(
                "elements of this drawing are nested deeper than {DEEPEST}"
            )));
        }
        if let Some(id) = node.attribute("id") {
            known.entry(id).or_insert(own);
        }
        let href = node
            .attribute("href")
            .or_else(|| node.attribute((XLINK, "href")));
        let used = href.filter(|_| node.tag_name().name() == "use");
        let used = used.and_then(|href| href.trim().strip_prefix('#'));
        number.insert(node.id(), own);
        depth.push(deep);
        nodes.push((parent, used));
    }
    let uses: Vec<Option<usize>> = nodes
        .iter()
        .map(|(_, used)| used.and_then(|id| known.get(id).copied()))
        .collect();
    let mut sizes = vec![1u64; nodes.len()];
    for _ in 0..ROUNDS {
        let mut next = vec![1u64; nodes.len()];
        for own in (0..nodes.len()).rev() {
            if let Some(used) = uses[own] {
                next[own] = next[own].saturating_add(sizes[used]);
            }
            if let Some(parent) = nodes[own].0 {
                next[parent] = next[parent].saturating_add(next[own]);
            }
        }
        if next.iter().any(|size| *size > MOST_ELEMENTS) {
            return Err(too_large(format!(
                "this drawing unfolds to more than {MOST_ELEMENTS} elements"
            )));
        }
        if next == sizes {
            return Ok(());
        }
        sizes = next;
    }
    Err(too_large(
        "elements of this drawing refer to each other without end, or too deeply",
    ))
}

#[derive(Default)]
struct Reader {
    parts: Vec<Part>,
    points: usize,
    clips: usize,
    masks: usize,
    filters: usize,
    blends: usize,
    gradients: usize,
    patterns: usize,
    notes: Vec<String>,
}

impl Reader {
    fn note(&mut self, count: usize, what: &str, outcome: &str) {
        let (number, plural, verb) = match count {
            0 => return,
            1 => ("1".to_owned(), "", "is"),
            more => (more.to_string(), "s", "are"),
        };
        self.notes
            .push(format!("{number} {what}{plural} {verb} {outcome}"));
    }

    fn finish(mut self) -> Vec<String> {
        let counts = [
            (self.clips, "clip", "left out"),
            (self.masks, "mask", "left out"),
            (self.filters, "filter", "left out"),
            (self.blends, "blend mode", "left out"),
            (self.gradients, "gradient", "replaced by the mean colour"),
            (self.patterns, "pattern", "replaced by grey"),
        ];
        for (count, what, outcome) in counts {
            self.note(count, what, outcome);
        }
        self.notes
    }

    /// `id` is that of a group around.
    fn group(
        &mut self,
        group: &usvg::Group,
        opacity: f64,
        id: Option<&str>,
    ) -> Result<(), ReadError> {
        self.clips += usize::from(group.clip_path().is_some());
        self.masks += usize::from(group.mask().is_some());
        self.filters += group.filters().len();
        self.blends += usize::from(group.blend_mode() != usvg::BlendMode::Normal);
        let opacity = opacity * f64::from(group.opacity().get());
        // The name of a group is that of its path where it has but one.
        let own = Some(group.id()).filter(|id| !id.is_empty());
        let id = own.or(id).filter(|_| group.children().len() == 1);
        for node in group.children() {
            match node {
                usvg::Node::Group(inner) => self.group(inner, opacity, id)?,
                usvg::Node::Path(path) if path.is_visible() => self.path(path, opacity, id)?,
                _ => {}
            }
        }
        Ok(())
    }

    fn path(
        &mut self,
        path: &usvg::Path,
        opacity: f64,
        group: Option<&str>,
    ) -> Result<(), ReadError> {
        let transform = path.abs_transform();
        let contours = contours(path.data().segments(), transform);
        let finite = |contour: &Contour| contour.points().all(DVec2::is_finite);
        if contours.is_empty() || !contours.iter().all(finite) {
            return Ok(());
        }
        self.points += contours
            .iter()
            .map(|contour| contour.points().count())
            .sum::<usize>();
        if self.points > MOST_POINTS {
            return Err(too_large(format!(
                "this drawing has more than {MOST_POINTS} points"
            )));
        }
        let fill = path.fill().map(|fill| {
            let colour = self.colour(fill.paint());
            with_opacity(colour, f64::from(fill.opacity().get()) * opacity)
        });
        let stroke = path
            .stroke()
            .map(|stroke| self.stroke(stroke, transform, opacity));
        let rule = match path.fill().map(usvg::Fill::rule) {
            Some(usvg::FillRule::EvenOdd) => Rule::EvenOdd,
            _ => Rule::NonZero,
        };
        let id = Some(path.id()).filter(|id| !id.is_empty()).or(group);
        self.parts.push(Part {
            id: id.map(str::to_owned),
            name: id.map_or_else(|| format!("path {}", self.parts.len() + 1), str::to_owned),
            fill,
            stroke,
            rule,
            contours,
        });
        Ok(())
    }

    fn stroke(&mut self, stroke: &usvg::Stroke, transform: Transform, opacity: f64) -> Stroke {
        let [sx, ky, kx, sy] =
            [transform.sx, transform.ky, transform.kx, transform.sy].map(f64::from);
        let scale = (sx * sy - ky * kx).abs().sqrt();
        let colour = self.colour(stroke.paint());
        let dashes = stroke.dasharray().unwrap_or_default();
        Stroke {
            colour: with_opacity(colour, f64::from(stroke.opacity().get()) * opacity),
            width: f64::from(stroke.width().get()) * scale,
            cap: match stroke.linecap() {
                usvg::LineCap::Butt => "butt",
                usvg::LineCap::Round => "round",
                usvg::LineCap::Square => "square",
            },
            join: match stroke.linejoin() {
                usvg::LineJoin::Miter | usvg::LineJoin::MiterClip => "miter",
                usvg::LineJoin::Round => "round",
                usvg::LineJoin::Bevel => "bevel",
            },
            miter_limit: f64::from(stroke.miterlimit().get()),
            dashes: dashes.iter().map(|dash| f64::from(*dash) * scale).collect(),
        }
    }

    fn colour(&mut self, paint: &usvg::Paint) -> [f64; 4] {
        match paint {
            usvg::Paint::Color(colour) => of_colour(*colour, 1.0),
            usvg::Paint::LinearGradient(gradient) => {
                self.gradients += 1;
                mean(gradient.stops())
            }
            usvg::Paint::RadialGradient(gradient) => {
                self.gradients += 1;
                mean(gradient.stops())
            }
            usvg::Paint::Pattern(_) => {
                self.patterns += 1;
                [0.5, 0.5, 0.5, 1.0]
            }
        }
    }
}

fn of_colour(colour: usvg::Color, opacity: f64) -> [f64; 4] {
    let [red, green, blue] =
        [colour.red, colour.green, colour.blue].map(|code| f64::from(code) / 255.0);
    [red, green, blue, opacity]
}

fn with_opacity([red, green, blue, own]: [f64; 4], opacity: f64) -> [f64; 4] {
    // Opacities are 32-bit numbers: 0.5 is exact, 0.1 is not, and shorter numbers are those that were meant.
    let opacity = (own * opacity * 1e6).round() / 1e6;
    [red, green, blue, opacity]
}

/// The mean of a gradient along its line, from 0 to 1.
fn mean(stops: &[usvg::Stop]) -> [f64; 4] {
    let (mut sum, mut weight) = ([0.0; 4], 0.0);
    for (i, stop) in stops.iter().enumerate() {
        let place = |stop: &usvg::Stop| f64::from(stop.offset().get());
        let before = i.checked_sub(1).map_or(-place(stop), |i| place(&stops[i]));
        let after = stops.get(i + 1).map_or(2.0 - place(stop), place);
        let share = 0.5 * (after - before);
        let colour = of_colour(stop.color(), f64::from(stop.opacity().get()));
        for (sum, value) in sum.iter_mut().zip(colour) {
            *sum += share * value;
        }
        weight += share;
    }
    if weight > 0.0 {
        sum.map(|value| value / weight)
    } else {
        [0.5, 0.5, 0.5, 1.0]
    }
}

/// The contours of a path. One without a segment has no inside and is left out.
fn contours(segments: impl Iterator<Item = PathSegment>, transform: Transform) -> Vec<Contour> {
    let [sx, ky, kx, sy, tx, ty] = [
        transform.sx,
        transform.ky,
        transform.kx,
        transform.sy,
        transform.tx,
        transform.ty,
    ]
    .map(f64::from);
    let place = |p: usvg::tiny_skia_path::Point| {
        let (x, y) = (f64::from(p.x), f64::from(p.y));
        dvec2(sx * x + kx * y + tx, ky * x + sy * y + ty)
    };
    let mut contours: Vec<Contour> = Vec::new();
    let mut current: Option<Contour> = None;
    let begin = |start| Contour {
        start,
        segments: Vec::new(),
        closed: false,
    };
    let mut last = DVec2::ZERO;
    for segment in segments {
        let piece = match segment {
            PathSegment::MoveTo(p) => {
                contours.extend(current.take());
                last = place(p);
                current = Some(begin(last));
                continue;
            }
            PathSegment::Close => {
                if let Some(mut contour) = current.take() {
                    contour.closed = true;
                    last = contour.start;
                    contours.push(contour);
                }
                continue;
            }
            PathSegment::LineTo(p) => Segment::Line(place(p)),
            PathSegment::QuadTo(a, p) => Segment::Quadratic([place(a), place(p)]),
            PathSegment::CubicTo(a, b, p) => Segment::Cubic([place(a), place(b), place(p)]),
        };
        let contour = current.get_or_insert_with(|| begin(last));
        contour.segments.push(piece);
    }
    contours.extend(current);
    contours.retain(|contour| !contour.segments.is_empty());
    contours
}

#[cfg(test)]
mod tests {
    use super::*;

    fn svg(inside: &str) -> Vec<u8> {
        let xlink = "xmlns:xlink=\"http://www.w3.org/1999/xlink\"";
        let head = format!("<svg xmlns=\"{SVG}\" {xlink} width=\"100\" height=\"80\">");
        format!("{head}{inside}</svg>").into_bytes()
    }

    #[test]
    fn groups_transforms_fills_and_rules_are_resolved() {
        let drawing = read_svg(&svg(
            "<title>two things</title><g id=\"box\" transform=\"translate(10 20) scale(2)\" opacity=\"0.5\" fill=\"#ff8000\">\
             <path d=\"M0 0H4V4H0Z M1 1H3V3H1Z\" fill-rule=\"evenodd\" fill-opacity=\"0.5\"/></g>\
             <circle id=\"dot\" cx=\"50\" cy=\"50\" r=\"5\" fill=\"none\" stroke=\"blue\" stroke-width=\"3\"/>",
        ))
        .unwrap();
        assert_eq!(drawing.name.as_deref(), Some("two things"));
        assert_eq!(drawing.canvas, Some([0.0, 0.0, 100.0, 80.0]));
        assert!(drawing.y_down && drawing.notes.is_empty());
        let [ring, dot] = &drawing.parts[..] else {
            panic!("{drawing:?}")
        };
        assert_eq!(ring.id.as_deref(), Some("box"));
        assert_eq!(ring.rule, Rule::EvenOdd);
        assert_eq!(ring.fill, Some([1.0, 128.0 / 255.0, 0.0, 0.25]));
        let points = |x: &[[f64; 2]]| x.iter().map(|p| dvec2(p[0], p[1])).collect::<Vec<_>>();
        assert_eq!(
            ring.contours[0].flatten(1.0),
            points(&[[10.0, 20.0], [18.0, 20.0], [18.0, 28.0], [10.0, 28.0]])
        );
        assert_eq!(ring.contours.len(), 2);
        assert!(ring.contours.iter().all(|contour| contour.closed));
        assert_eq!(
            (dot.id.as_deref(), dot.fill, dot.rule),
            (Some("dot"), None, Rule::NonZero)
        );
        let stroke = dot.stroke.as_ref().unwrap();
        assert_eq!((stroke.colour, stroke.width), ([0.0, 0.0, 1.0, 1.0], 3.0));
        for point in dot.contours[0].flatten(1e-3) {
            assert!((point.distance(dvec2(50.0, 50.0)) - 5.0).abs() < 5e-3);
        }
    }

    #[test]
    fn what_is_left_out_is_noted() {
        let drawing = read_svg(&svg(
            "<defs><clipPath id=\"c\"><rect width=\"5\" height=\"5\"/></clipPath>\
             <linearGradient id=\"g\"><stop offset=\"0\" stop-color=\"black\"/><stop offset=\"1\" stop-color=\"white\"/></linearGradient></defs>\
             <g clip-path=\"url(#c)\"><rect width=\"9\" height=\"9\" fill=\"url(#g)\"/></g>\
             <text x=\"1\" y=\"9\">A</text><image href=\"other.png\" width=\"3\" height=\"3\"/>",
        ))
        .unwrap();
        assert_eq!(drawing.parts.len(), 1);
        assert_eq!(drawing.parts[0].fill, Some([0.5, 0.5, 0.5, 1.0]));
        let notes = drawing.notes.join("; ");
        for note in [
            "1 text is not converted",
            "1 picture",
            "1 clip",
            "1 gradient",
        ] {
            assert!(notes.contains(note), "{notes}");
        }
    }

    #[test]
    fn bombs_are_refused_before_they_unfold() {
        let mut uses = String::from("<defs><path id=\"x0\" d=\"M0 0H1V1Z\"/>");
        for level in 1..=30 {
            let inner = format!("<use xlink:href=\"#x{}\"/>", level - 1).repeat(10);
            uses.push_str(&format!("<g id=\"x{level}\">{inner}</g>"));
        }
        uses.push_str("</defs><use href=\"#x30\"/>");
        let groups = format!(
            "{}<path d=\"M0 0H1V1Z\"/>{}",
            "<g>".repeat(20_000),
            "</g>".repeat(20_000)
        );
        for bomb in [uses, groups] {
            let error = read_svg(&svg(&bomb)).unwrap_err();
            assert_eq!(error.kind, ReadErrorKind::TooLarge, "{error}");
        }
        // Ten of ten are no bomb.
        let few = format!(
            "<defs><g id=\"a\">{}</g></defs>{}",
            "<path d=\"M0 0H1V1Z\"/>".repeat(10),
            "<use href=\"#a\"/>".repeat(10)
        );
        assert_eq!(read_svg(&svg(&few)).unwrap().parts.len(), 100);
    }

    #[test]
    fn what_shows_no_path_is_an_error() {
        let kinds = [
            (&b""[..], ReadErrorKind::Syntax),
            (b"<svg", ReadErrorKind::Syntax),
            (b"\xff\xfe<svg/>", ReadErrorKind::Encoding),
            (b"\x1f\x8b\x08", ReadErrorKind::Unsupported),
        ];
        for (bytes, kind) in kinds {
            assert_eq!(read_svg(bytes).unwrap_err().kind, kind);
        }
        for inside in [
            "",
            "<text>A</text>",
            "<path d=\"\"/>",
            "<path d=\"M0 0H9V9Z\" visibility=\"hidden\"/>",
        ] {
            let error = read_svg(&svg(inside)).unwrap_err();
            assert_eq!(error.kind, ReadErrorKind::NoPath, "{inside}: {error}");
        }
    }
}
