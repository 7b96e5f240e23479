//! Polylines of SVG drawings: every visible path, in the order of the drawing, with its transforms applied and its curves flattened.
//!
//! Coordinates are those of the drawing's user units: x to the right, y *downwards*.
//!
//! *Source*: W3C, *Scalable Vector Graphics (SVG) 2*, 2018; parsed by `usvg`, which resolves shapes, groups, references and styles;
//! flattening by `kurbo` (R. Levien, *Flattening quadratic Béziers*, 2019).

use crate::error::{ReadError, ReadErrorKind};
use anamorph_core::glam::{DVec2, dvec2};
use kurbo::{BezPath, PathEl};
use usvg::tiny_skia_path::PathSegment;

/// Points of a drawing and the lines between them, by number.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Drawing {
    /// All points, path after path.
    pub points: Vec<DVec2>,
    /// Segments by the numbers of their ends, in the order in which the paths are drawn.
    pub lines: Vec<[u32; 2]>,
}

/// Bytes of a drawing at most.
const LARGEST: usize = 1 << 28;
/// Points of a drawing at most.
const MOST: usize = 1 << 24;

/// Whether a file's bytes may be those of an SVG drawing.
pub fn is_svg(bytes: &[u8]) -> bool {
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(4096)]);
    head.contains("<svg")
}

/// The polylines of a drawing. Curves are flattened to `tolerance`, a share of the drawing's extent.
///
/// # Errors
/// What is no SVG drawing, shows no path, or has too many points.
pub fn polylines(bytes: &[u8], tolerance: f64) -> Result<Drawing, ReadError> {
    if bytes.len() > LARGEST {
        return Err(ReadError::new(
            ReadErrorKind::TooLarge,
            "this drawing is larger than 256 MiB",
            "keep only the paths that are needed",
        ));
    }
    let tree = usvg::Tree::from_data(bytes, &options()).map_err(|error| {
        ReadError::new(
            ReadErrorKind::Syntax,
            format!("this is no drawing that can be read: {error}"),
            "export it as plain SVG",
        )
    })?;
    let mut paths = Vec::new();
    gather(tree.root(), &mut paths);
    let mut extent: Option<kurbo::Rect> = None;
    for path in &paths {
        let own = kurbo::Shape::bounding_box(path);
        extent = Some(extent.map_or(own, |all| all.union(own)));
    }
    let Some(extent) = extent else {
        return Err(ReadError::new(
            ReadErrorKind::Syntax,
            "this drawing shows no path that can be read",
            "draw one, with a stroke or a fill, mend its path data, or turn text into paths",
        ));
    };
    let tolerance = tolerance * extent.width().max(extent.height()).max(f64::MIN_POSITIVE);
    let mut drawing = Drawing::default();
    for path in &paths {
        drawing.add(path, tolerance)?;
    }
    Ok(drawing)
}

/// How drawings are parsed: pictures in them are left out, and no other file is opened for them, wherever it lies.
pub(crate) fn options() -> usvg::Options<'static> {
    usvg::Options {
        image_href_resolver: usvg::ImageHrefResolver {
            resolve_data: Box::new(|_, _, _| None),
            resolve_string: Box::new(|_, _| None),
        },
        ..usvg::Options::default()
    }
}

/// The visible paths of a group and of those in it.
fn gather(group: &usvg::Group, paths: &mut Vec<BezPath>) {
    for node in group.children() {
        match node {
            usvg::Node::Group(group) => gather(group, paths),
            usvg::Node::Path(path) if path.is_visible() => {
                let transform = path.abs_transform();
                let place = |p: usvg::tiny_skia_path::Point| {
                    let (x, y) = (f64::from(p.x), f64::from(p.y));
                    let row =
                        |a: f32, b: f32, c: f32| f64::from(a) * x + f64::from(b) * y + f64::from(c);
                    kurbo::Point::new(
                        row(transform.sx, transform.kx, transform.tx),
                        row(transform.ky, transform.sy, transform.ty),
                    )
                };
                let mut outline = BezPath::new();
                for segment in path.data().segments() {
                    match segment {
                        PathSegment::MoveTo(p) => outline.move_to(place(p)),
                        PathSegment::LineTo(p) => outline.line_to(place(p)),
                        PathSegment::QuadTo(a, p) => outline.quad_to(place(a), place(p)),
                        PathSegment::CubicTo(a, b, p) => {
                            outline.curve_to(place(a), place(b), place(p));
                        }
                        PathSegment::Close => outline.close_path(),
                    }
                }
                paths.push(outline);
            }
            _ => {}
        }
    }
}

impl Drawing {
    fn add(&mut self, path: &BezPath, tolerance: f64) -> Result<(), ReadError> {
        // The first point of the subpath, and the last one drawn.
        let (mut first, mut last): (Option<u32>, Option<u32>) = (None, None);
        let mut full = false;
        let point = |all: &mut Vec<DVec2>, p: kurbo::Point| {
            all.push(dvec2(p.x, p.y));
            u32::try_from(all.len() - 1).unwrap_or(u32::MAX)
        };
        kurbo::flatten(path, tolerance, |element| {
            if self.points.len() >= MOST {
                full = true;
                return;
            }
            match element {
                PathEl::MoveTo(p) => {
                    first = Some(point(&mut self.points, p));
                    last = first;
                }
                PathEl::LineTo(p) => {
                    let Some(from) = last else { return };
                    // A point drawn twice is one.
                    if self.points[from as usize] == dvec2(p.x, p.y) {
                        return;
                    }
                    let to = point(&mut self.points, p);
                    self.lines.push([from, to]);
                    last = Some(to);
                }
                PathEl::ClosePath => {
                    if let (Some(from), Some(to)) = (last, first) {
                        self.close(from, to);
                        last = first;
                    }
                }
                _ => {}
            }
        });
        if full {
            return Err(ReadError::new(
                ReadErrorKind::TooLarge,
                format!("this drawing has more than {MOST} points"),
                "keep only the paths that are needed",
            ));
        }
        Ok(())
    }

    /// Joins the last point of a ring to its first, which may lie in the same place.
    fn close(&mut self, from: u32, to: u32) {
        if from == to {
            return;
        }
        if self.points[from as usize] == self.points[to as usize]
            && let Some(line) = self.lines.last_mut().filter(|line| line[1] == from)
        {
            line[1] = to;
            if from as usize + 1 == self.points.len() {
                self.points.pop();
            }
            return;
        }
        self.lines.push([from, to]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn svg(inside: &str) -> Vec<u8> {
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"100\" height=\"100\">{inside}</svg>"
        )
        .into_bytes()
    }

    #[test]
    fn paths_shapes_and_transforms_become_polylines() {
        let drawing = polylines(
            &svg("<g transform=\"translate(10 20) scale(2)\"><polyline points=\"0,0 5,0 5,5\" fill=\"none\" stroke=\"black\"/></g>\
                  <rect x=\"50\" y=\"50\" width=\"10\" height=\"4\"/>"),
            1e-4,
        )
        .unwrap();
        let line: Vec<_> = drawing.points[..3].to_vec();
        assert_eq!(
            line,
            [dvec2(10.0, 20.0), dvec2(20.0, 20.0), dvec2(20.0, 30.0)]
        );
        assert_eq!(drawing.lines[..2], [[0, 1], [1, 2]]);
        // The rectangle is a ring of four.
        assert_eq!(drawing.points.len(), 7);
        assert_eq!(drawing.lines[2..], [[3, 4], [4, 5], [5, 6], [6, 3]]);
    }

    #[test]
    fn curves_are_flattened_to_the_tolerance() {
        let circle = svg("<circle cx=\"50\" cy=\"50\" r=\"40\"/>");
        for tolerance in [1e-2, 1e-4, 1e-5] {
            let drawing = polylines(&circle, tolerance).unwrap();
            let middle = |[a, b]: &[u32; 2]| {
                (drawing.points[*a as usize] + drawing.points[*b as usize]) * 0.5
            };
            let off = drawing
                .lines
                .iter()
                .map(|line| (middle(line).distance(dvec2(50.0, 50.0)) - 40.0).abs());
            // The circle itself is four cubics, 3e-4 of its radius off.
            let worst = off.fold(0.0, f64::max);
            assert!(
                worst <= 80.0 * tolerance + 40.0 * 3e-4,
                "{tolerance}: {worst}"
            );
            assert_eq!(drawing.points.len(), drawing.lines.len());
        }
    }

    #[test]
    fn no_other_file_is_opened_for_pictures() {
        let href = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../docs/images/arc-length.svg"
        );
        // Left to itself, the parser opens it.
        let usual = usvg::Options::default();
        assert!((usual.image_href_resolver.resolve_string)(href, &usual).is_some());
        let own = options();
        assert!((own.image_href_resolver.resolve_string)(href, &own).is_none());
        let picture = format!("<image href=\"{href}\" width=\"10\" height=\"10\"/>");
        assert!(polylines(&svg(&picture), 1e-4).is_err());
        let beside = format!("{picture}<path d=\"M0 0H10\" stroke=\"black\"/>");
        assert_eq!(polylines(&svg(&beside), 1e-4).unwrap().lines.len(), 1);
    }

    #[test]
    fn what_is_no_drawing_is_an_error() {
        for bytes in [
            &b""[..],
            b"v 0 0 0",
            b"<svg",
            &svg(""),
            &svg("<g><g></g></g>"),
        ] {
            assert!(polylines(bytes, 1e-4).is_err());
        }
        let deep = format!("{}{}", "<g>".repeat(20_000), "</g>".repeat(20_000));
        assert!(polylines(&svg(&deep), 1e-4).is_err());
    }
}
