//! Strain against time, as the paper on strain fields plots it: of the method that is drawn, and beside it of vertices that go straight.
//!
//! Plots the strain of eq. (1) for chosen triangles, or of all the mean by area and where the middle four fifths of the area lie. Triangles are
//! counted over all parts in the order in which `anamorph mesh` writes them. Parts that come from a point or go into one are left out of means.
//!
//! *Source*: H.-B. Yan, S.-M. Hu, R. Martin, *Morphing based on strain field interpolation*, 2004, Figure 3.

use super::super::film::fill;
use super::inputs::Input;
use super::{Step, sheets};
use crate::arguments::MorphOptions;
use crate::error::Failure;
use anamorph_morph::strain::{self, Frame, InBetween, Settings, Strain};
use anamorph_preview::{Anchor, Figure, Ink};
use std::fmt::Write as _;
use std::path::Path;

/// Times at which strains are taken.
const TIMES: usize = 60;
/// What stands beside the method that is drawn.
const BASELINE: &str = "vertex-linear";
/// Rows of a picture at most.
const MOST_ROWS: usize = 24;
/// Ends of the middle four fifths.
const SHARES: [f64; 2] = [0.1, 0.9];

/// What a component does over time.
const COMPONENTS: [(&str, Ink); 3] = [
    ("strain x", Ink::new(0, 114, 178)),
    ("strain y", Ink::new(213, 94, 0)),
    ("shear xy", Ink::new(0, 158, 115)),
];

/// A component at a time.
#[derive(Clone, Copy)]
struct Value {
    mean: f64,
    /// Where the middle four fifths begin and end, and all.
    middle: [f64; 2],
    all: [f64; 2],
}

/// Curves of one mesh by one method.
struct Panel {
    method: &'static str,
    /// Of each time, the three components.
    values: Vec<[Value; 3]>,
}

/// Panels with a scale in common.
struct Row {
    step: usize,
    triangle: Option<usize>,
    title: String,
    panels: Vec<Panel>,
}

/// Refuses files of other forms.
pub(super) fn check(path: &Path) -> Result<(), Failure> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    match extension.as_deref() {
        Some("svg" | "png" | "csv") => Ok(()),
        _ => Err(Failure::usage(format!(
            "--strain-plot {}: name a picture (.svg, .png) or a table (.csv)",
            path.display()
        ))),
    }
}

/// Writes the plots of all steps.
pub(super) fn write(
    path: &Path,
    options: &MorphOptions,
    inputs: &[Input],
    steps: &[Step],
) -> Result<(), Failure> {
    let chosen = &options.between.triangles;
    let times: Vec<f64> = (0..=TIMES).map(|i| i as f64 / TIMES as f64).collect();
    let mut rows = Vec::new();
    for (number, step) in steps.iter().enumerate() {
        let name = format!(
            "{} to {}",
            inputs[number].short_name(),
            inputs[number + 1].short_name()
        );
        let found = strains(step, &times)?;
        if chosen.is_empty() {
            rows.push(Row {
                step: number,
                triangle: None,
                title: name.clone(),
                panels: found.iter().map(Found::mean).collect(),
            });
        }
        for &triangle in chosen {
            let panels = found.iter().map(|found| found.triangle(triangle));
            let panels: Option<Vec<Panel>> = panels.collect();
            let panels = panels.ok_or_else(|| {
                let count = found.first().map_or(0, |found| found.areas.len());
                Failure::usage(format!(
                    "--triangles: there is no triangle {triangle}; {name} has {count}, counted from 0"
                ))
            })?;
            rows.push(Row {
                step: number,
                triangle: Some(triangle),
                title: format!("{name}: triangle {triangle}"),
                panels,
            });
        }
    }
    let is_table = path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("csv"));
    if is_table {
        let text = table(&rows, &times);
        return fill(path, options.force, |out| {
            out.write_all(text.as_bytes())
                .map_err(|error| Failure::written(path, &error))
        });
    }
    if rows.len() > MOST_ROWS {
        return Err(Failure::usage(format!(
            "--strain-plot: {} plots are too many for a picture; choose at most {MOST_ROWS}, or write a .csv",
            rows.len()
        )));
    }
    sheets::write_figure(
        path,
        options.force,
        &drawn(&rows, &times),
        "strain against time",
    )
}

/// Strains of all triangles of a step by one method.
struct Found {
    method: &'static str,
    /// Areas in the source; 0 where a part comes from a point or goes into one.
    areas: Vec<f64>,
    /// Of each time, all triangles.
    strains: Vec<Vec<Strain>>,
}

/// By the method that is drawn, and by the baseline.
fn strains(step: &Step, times: &[f64]) -> Result<Vec<Found>, Failure> {
    let couples = step.figure.couples();
    let baseline = strain::method(BASELINE).map_err(Failure::new)?;
    let own = couples.first().map_or("", |couple| couple.between().name());
    let mut methods = vec![own];
    if own != baseline.name {
        methods.push(baseline.name);
    }
    let mut found: Vec<Found> = methods
        .into_iter()
        .map(|method| Found {
            method,
            areas: Vec::new(),
            strains: vec![Vec::new(); times.len()],
        })
        .collect();
    for couple in couples {
        let pair = couple.pair();
        let is_whole = couple.source.is_some() && couple.target.is_some();
        let straight = baseline
            .prepare(pair, &Settings::default())
            .map_err(Failure::new)?;
        let ways: [&dyn InBetween; 2] = [couple.between(), &*straight];
        for (found, way) in found.iter_mut().zip(ways) {
            let frames: Vec<Frame> = way.frames(times).map_err(Failure::new)?;
            for (strains, frame) in found.strains.iter_mut().zip(&frames) {
                strains.extend(strain::strains(pair, &frame.positions));
            }
            let area = |corners: &[u32; 3]| {
                let [a, b, c] = corners.map(|i| couple.mesh.source[i as usize]);
                0.5 * (b - a).perp_dot(c - a).abs()
            };
            let areas = couple.mesh.triangles.iter().map(area);
            found
                .areas
                .extend(areas.map(|area| if is_whole { area } else { 0.0 }));
        }
    }
    Ok(found)
}

fn components(strain: &Strain) -> [f64; 3] {
    [strain.x, strain.y, strain.shear]
}

impl Found {
    /// Of one triangle; none if there is no such.
    fn triangle(&self, triangle: usize) -> Option<Panel> {
        let values = self.strains.iter().map(|strains| {
            let strain = strains.get(triangle)?;
            Some(components(strain).map(|value| Value {
                mean: value,
                middle: [value; 2],
                all: [value; 2],
            }))
        });
        let values: Option<Vec<[Value; 3]>> = values.collect();
        Some(Panel {
            method: self.method,
            values: values?,
        })
    }

    /// Of all triangles, by area.
    fn mean(&self) -> Panel {
        let total: f64 = self.areas.iter().sum();
        let values = self.strains.iter().map(|strains| {
            [0, 1, 2].map(|component: usize| {
                let mut list: Vec<(f64, f64)> = strains
                    .iter()
                    .zip(&self.areas)
                    .filter(|(_, area)| **area > 0.0)
                    .map(|(strain, area)| (components(strain)[component], *area))
                    .collect();
                list.sort_by(|a, b| a.0.total_cmp(&b.0));
                let mean = list.iter().map(|(value, area)| value * area).sum::<f64>() / total;
                let at = |share: f64| {
                    let mut sum = 0.0;
                    let reached = list.iter().find(|(_, area)| {
                        sum += area;
                        sum >= share * total
                    });
                    reached.or(list.last()).map_or(0.0, |(value, _)| *value)
                };
                Value {
                    mean: if total > 0.0 { mean } else { 0.0 },
                    middle: SHARES.map(at),
                    all: [at(0.0), list.last().map_or(0.0, |(value, _)| *value)],
                }
            })
        });
        Panel {
            method: self.method,
            values: values.collect(),
        }
    }
}

/// The numbers that are plotted, each as the shortest that reads back the same.
fn table(rows: &[Row], times: &[f64]) -> String {
    let alone = rows.first().is_some_and(|row| row.triangle.is_some());
    let mut text = String::from("step,method,");
    text.push_str(if alone {
        "triangle,time,strain_x,strain_y,shear_xy"
    } else {
        "time"
    });
    if !alone {
        for component in ["strain_x", "strain_y", "shear_xy"] {
            for what in ["mean", "low", "high", "least", "most"] {
                let _ = write!(text, ",{component}_{what}");
            }
        }
    }
    text.push('\n');
    for row in rows {
        for panel in &row.panels {
            for (time, values) in times.iter().zip(&panel.values) {
                let _ = write!(text, "{},{},", row.step + 1, panel.method);
                if let Some(triangle) = row.triangle {
                    let _ = write!(text, "{triangle},");
                }
                let _ = write!(text, "{time}");
                for value in values {
                    let _ = write!(text, ",{}", value.mean);
                    if !alone {
                        for value in value.middle.iter().chain(&value.all) {
                            let _ = write!(text, ",{value}");
                        }
                    }
                }
                text.push('\n');
            }
        }
    }
    text
}

const WIDTH: f64 = 400.0;
const HEIGHT: f64 = 240.0;
const LEFT: f64 = 62.0;
const TOP: f64 = 64.0;
const GAP: [f64; 2] = [64.0, 92.0];
const DARK: Ink = Ink::new(40, 44, 52);
const GREY: Ink = Ink::new(222, 226, 231);

/// Ticks at round numbers, seven of them at most, and how many decimals they take.
fn ticks(low: f64, high: f64) -> (Vec<f64>, usize) {
    let rough = (high - low) / 7.0;
    let power = 10_f64.powf(rough.log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0];
    let step = steps.into_iter().find(|step| step * power >= rough);
    let step = step.unwrap_or(10.0) * power;
    let (first, last) = ((low / step).ceil() as i64, (high / step).floor() as i64);
    let decimals = (-(step.log10() + 1e-9).floor()).max(0.0) as usize;
    ((first..=last).map(|i| i as f64 * step).collect(), decimals)
}

/// The least and the largest value that a row shows, with room around.
fn range(row: &Row) -> [f64; 2] {
    let (mut low, mut high) = (0.0_f64, 0.0_f64);
    let values = row.panels.iter().flat_map(|panel| panel.values.iter());
    for value in values.flatten() {
        let ends = [value.mean, value.middle[0], value.middle[1]];
        for end in ends.into_iter().filter(|end| end.is_finite()) {
            (low, high) = (low.min(end), high.max(end));
        }
    }
    let room = (0.06 * (high - low)).max(1e-3);
    [low - room, high + room]
}

fn drawn(rows: &[Row], times: &[f64]) -> Figure {
    let columns = rows.iter().map(|row| row.panels.len()).max().unwrap_or(1) as f64;
    let across = LEFT + columns * WIDTH + (columns - 1.0) * GAP[0] + 24.0;
    let down = TOP + rows.len() as f64 * (HEIGHT + GAP[1]) - 20.0;
    let mut figure = Figure::new(across, down, Ink::new(255, 255, 255));
    let mut at = LEFT;
    for (name, ink) in COMPONENTS {
        figure.line(&[[at, 21.0], [at + 26.0, 21.0]], ink, 2.4);
        figure.words([at + 34.0, 26.0], 10.0, Anchor::Start, DARK, name);
        at += 130.0;
    }
    if rows.iter().any(|row| row.triangle.is_none()) {
        let words = "lines: mean by area, bands: middle 80 % of the area";
        figure.words([across - 24.0, 26.0], 9.0, Anchor::End, DARK, words);
    }
    for (number, row) in rows.iter().enumerate() {
        let top = TOP + number as f64 * (HEIGHT + GAP[1]) + 18.0;
        figure.words([LEFT, top - 28.0], 10.0, Anchor::Start, DARK, &row.title);
        for (column, panel) in row.panels.iter().enumerate() {
            let left = LEFT + column as f64 * (WIDTH + GAP[0]);
            plot(&mut figure, [left, top], range(row), panel, times);
        }
    }
    figure
}

fn plot(
    figure: &mut Figure,
    [left, top]: [f64; 2],
    [low, high]: [f64; 2],
    panel: &Panel,
    times: &[f64],
) {
    let x = |time: f64| left + time * WIDTH;
    let y = |value: f64| top + (high - value) / (high - low) * HEIGHT;
    let (marks, decimals) = ticks(low, high);
    for mark in marks {
        figure.line(&[[x(0.0), y(mark)], [x(1.0), y(mark)]], GREY, 1.0);
        let text = format!("{mark:.decimals$}");
        figure.words([left - 8.0, y(mark) + 4.0], 8.5, Anchor::End, DARK, &text);
    }
    for time in [0.0, 0.25, 0.5, 0.75, 1.0] {
        figure.line(&[[x(time), top], [x(time), top + HEIGHT]], GREY, 1.0);
        let place = [x(time), top + HEIGHT + 16.0];
        figure.words(place, 8.5, Anchor::Middle, DARK, &format!("{time}"));
    }
    figure.line(&[[x(0.0), y(0.0)], [x(1.0), y(0.0)]], DARK.fading(0.6), 1.0);
    let place = [x(0.5), top + HEIGHT + 32.0];
    figure.words(place, 8.5, Anchor::Middle, DARK, "time");
    for (component, (_, ink)) in COMPONENTS.into_iter().enumerate() {
        let edge = |end: usize| {
            let values = times.iter().zip(&panel.values);
            values.map(move |(time, values)| [x(*time), y(values[component].middle[end])])
        };
        let back: Vec<[f64; 2]> = edge(0).collect();
        let band: Vec<[f64; 2]> = edge(1).chain(back.into_iter().rev()).collect();
        figure.area(&band, ink.fading(0.12));
        for end in [0, 1] {
            let border: Vec<[f64; 2]> = edge(end).collect();
            figure.line(&border, ink.fading(0.45), 0.7);
        }
    }
    for (component, (_, ink)) in COMPONENTS.into_iter().enumerate() {
        let values = times.iter().zip(&panel.values);
        let curve: Vec<[f64; 2]> = values
            .map(|(time, values)| [x(*time), y(values[component].mean)])
            .collect();
        figure.line(&curve, ink, 2.0);
    }
    let place = [left + WIDTH - 6.0, top - 8.0];
    figure.words(place, 9.5, Anchor::End, DARK, panel.method);
}
