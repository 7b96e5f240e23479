//! Small plots of functions as inline SVG.
//!
//! Draws `y = f(x)` by straight lines between samples, clipped to the frame; the colours are the page's, so that one plot
//! serves both themes. *Source*: W3C, *Scalable Vector Graphics (SVG) 2*, 2018.

use std::fmt::Write;

/// Width and height of a plot in CSS pixels, and the free edge around its frame.
const SIZE: [f64; 2] = [220.0, 140.0];
const EDGE: [f64; 2] = [26.0, 16.0];
/// Straight pieces of a curve: less than two pixels each.
const PIECES: u32 = 160;

/// A plot of `function` over `x`, showing the values in `y`; `label` says what it is to those who cannot see it.
pub(super) fn plot(
    label: &str,
    x: [f64; 2],
    y: [f64; 2],
    ticks: &[f64],
    function: impl Fn(f64) -> f64,
) -> String {
    let [width, height] = SIZE;
    let [left, top] = EDGE;
    let (right, bottom) = (width - 8.0, height - 20.0);
    let to_x = |value: f64| left + (value - x[0]) / (x[1] - x[0]) * (right - left);
    let to_y = |value: f64| bottom - (value - y[0]) / (y[1] - y[0]) * (bottom - top);
    let mut svg = format!(
        "<svg class=\"plot\" viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{}\">",
        super::page::escape(label)
    );
    for &tick in ticks {
        let at = to_x(tick);
        let _ = write!(
            svg,
            "<path class=\"grid\" d=\"M{at:.1} {top:.1}V{bottom:.1}\"/><text x=\"{at:.1}\" y=\"{:.1}\" \
             text-anchor=\"middle\">{tick}</text>",
            bottom + 13.0
        );
    }
    for tick in [0.0, 1.0] {
        let at = to_y(tick);
        let _ = write!(
            svg,
            "<path class=\"grid\" d=\"M{left:.1} {at:.1}H{right:.1}\"/><text x=\"{:.1}\" y=\"{:.1}\" \
             text-anchor=\"end\">{tick}</text>",
            left - 5.0,
            at + 3.5
        );
    }
    let mut points: Vec<[f64; 2]> = Vec::new();
    for piece in 0..=PIECES {
        let at = x[0] + (x[1] - x[0]) * f64::from(piece) / f64::from(PIECES);
        let value = function(at);
        // What is not a number is not drawn; what leaves the frame ends at its edge.
        if !value.is_nan() {
            points.push([to_x(at), to_y(value.clamp(y[0], y[1]))]);
        }
    }
    svg.push_str("<polyline class=\"curve\" points=\"");
    for [x, y] in points {
        let _ = write!(svg, "{x:.1},{y:.1} ");
    }
    svg.push_str("\"/></svg>");
    svg
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_stay_in_the_frame() {
        let svg = plot("1/x & co", [0.0, 2.0], [0.0, 2.0], &[0.0, 1.0], |x| 1.0 / x);
        assert!(svg.contains("aria-label=\"1/x &amp; co\""));
        let (_, curve) = svg.split_once("points=\"").unwrap();
        let (curve, _) = curve.split_once('"').unwrap();
        let points: Vec<&str> = curve.split_whitespace().collect();
        assert_eq!(points.len(), 161);
        for point in points {
            let (x, y) = point.split_once(',').unwrap();
            let (x, y): (f64, f64) = (x.parse().unwrap(), y.parse().unwrap());
            assert!((26.0..=212.0).contains(&x) && (16.0..=120.0).contains(&y));
        }
        // Infinity at 0 is drawn at the upper edge.
        assert!(curve.starts_with("26.0,16.0"));
    }
}
