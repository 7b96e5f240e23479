//! What becomes of the `vn` lines of an OBJ file.
//!
//! A normal may be shared by many corners. Each *use*, a pair of normal and vertex, gets a new value. Where all uses of a
//! normal agree, its line is rewritten. Where they do not, one value stays on the line — the old one if some use keeps
//! it, else that of the first use in the file — and the others are added at the end of the file, to which the corners
//! with these uses are redirected.

use super::{Keyword, Text, position, write::same};
use crate::faces::{Faces, NONE};
use crate::normals::{Mean, angle, unit_normal};
use crate::text;
use crate::{Normals, document::NormalMap};
use anamorph_core::glam::DVec3;

/// Values that differ by less than this, relative to their largest coordinate, are one: a flat wall with one normal must
/// not end up with a normal for each corner because of rounding. It is far below what files store.
const AGREE: f64 = 1e-12;

fn agree(a: DVec3, b: DVec3) -> bool {
    (a - b).abs().max_element() <= AGREE * a.abs().max_element()
}

/// What to write.
pub(super) struct Plan {
    /// The normals as stored; NaN where a line is unreadable.
    pub(super) old: Vec<DVec3>,
    /// What their lines shall say.
    pub(super) new: Vec<DVec3>,
    /// Uses whose corners get another index (from 0), sorted.
    pub(super) redirected: Vec<(u64, u64)>,
    /// Normals to add, in the order of their indices.
    pub(super) added: Vec<DVec3>,
    /// Uses for which there was no usable new value.
    pub(super) kept: usize,
}

impl Plan {
    /// The index that a corner shall refer to instead, if it shall.
    pub(super) fn redirect(&self, normal: u32, vertex: u32) -> Option<u64> {
        let key = key(normal, vertex);
        self.redirected
            .binary_search_by_key(&key, |entry| entry.0)
            .ok()
            .map(|at| self.redirected[at].1)
    }
}

fn key(normal: u32, vertex: u32) -> u64 {
    u64::from(normal) << 32 | u64::from(vertex)
}

/// All uses, numbered: use `n` is the first of normal `n`, and the others follow. Most normals have but one.
struct Uses {
    /// For each normal the vertex that uses it first, or [`NONE`].
    first: Vec<u32>,
    /// The other uses as [`key`]s, sorted.
    others: Vec<u64>,
}

impl Uses {
    fn of(faces: &Faces, normals: usize) -> Self {
        let mut first = vec![NONE; normals];
        let mut others = Vec::new();
        for (&vertex, &normal) in faces.vertices.iter().zip(&faces.normals) {
            match first.get_mut(normal as usize) {
                Some(slot) if *slot == NONE => *slot = vertex,
                Some(slot) if *slot != vertex => others.push(key(normal, vertex)),
                _ => {}
            }
        }
        others.sort_unstable();
        others.dedup();
        Self { first, others }
    }
    fn len(&self) -> usize {
        self.first.len() + self.others.len()
    }
    /// Normal and vertex of a use; `None` for a normal that is not used.
    fn get(&self, number: usize) -> Option<(u32, u32)> {
        match self.first.get(number) {
            Some(&vertex) => (vertex != NONE).then_some((number as u32, vertex)),
            None => {
                let key = self.others[number - self.first.len()];
                Some(((key >> 32) as u32, key as u32))
            }
        }
    }
    fn number(&self, normal: u32, vertex: u32) -> Option<usize> {
        if *self.first.get(normal as usize)? == vertex {
            return Some(normal as usize);
        }
        self.others
            .binary_search(&key(normal, vertex))
            .ok()
            .map(|at| self.first.len() + at)
    }
}

/// The plan for a policy; `None` where the normals stay as they are.
pub(super) fn plan(text: &Text, moved: &[DVec3], policy: Normals<'_>) -> Option<Plan> {
    if text.totals.normals == 0 || matches!(policy, Normals::Keep) {
        return None;
    }
    let old = stored(text);
    let faces = text.elements(true).faces;
    let uses = Uses::of(&faces, old.len());
    let values = match policy {
        Normals::Keep => return None,
        Normals::Transform(map) => transformed(&uses, &old, &text.positions, map),
        Normals::Recompute => recomputed(&uses, &old, &faces, &text.positions, moved),
    };
    Some(assign(old, &uses, &values))
}

/// The normals of the file.
pub(super) fn stored(text: &Text) -> Vec<DVec3> {
    let parts = text::map(&text.chunks, |chunk| -> Vec<DVec3> {
        let lines = text
            .statements(chunk)
            .filter(|s| s.keyword == Keyword::Normal);
        lines
            .map(|line| position(&text.bytes, &line).unwrap_or(DVec3::NAN))
            .collect()
    });
    parts.concat()
}

/// How the value of a use was found.
#[derive(Clone, Copy)]
enum Value {
    New(DVec3),
    /// Nothing bears on it.
    Old,
    /// There should be a new one, but it has no direction.
    Unusable,
}

fn usable(value: DVec3) -> Value {
    if value.is_finite() && value != DVec3::ZERO {
        Value::New(value)
    } else {
        Value::Unusable
    }
}

/// Uses evaluated together.
const BATCH: usize = 1 << 14;

fn transformed(uses: &Uses, old: &[DVec3], positions: &[DVec3], map: NormalMap<'_>) -> Vec<Value> {
    let starts: Vec<usize> = (0..uses.len()).step_by(BATCH).collect();
    let parts = text::map(&starts, |&start| -> Vec<Value> {
        let numbers = start..(start + BATCH).min(uses.len());
        numbers
            .map(|number| match uses.get(number) {
                Some((n, v))
                    if old[n as usize].is_finite() && positions[v as usize].is_finite() =>
                {
                    usable(map(v as usize, old[n as usize]))
                }
                _ => Value::Old,
            })
            .collect()
    });
    parts.concat()
}

fn recomputed(
    uses: &Uses,
    old: &[DVec3],
    faces: &Faces,
    positions: &[DVec3],
    moved: &[DVec3],
) -> Vec<Value> {
    let mut means = vec![Mean::default(); uses.len()];
    let mut touched = vec![false; uses.len()];
    for f in 0..faces.len() {
        let face = faces.vertices(f);
        let moves = face
            .iter()
            .any(|v| !same(positions[*v as usize], moved[*v as usize]));
        let normal = unit_normal(face, moved);
        for (i, (&v, &n)) in face.iter().zip(faces.normals(f)).enumerate() {
            if let Some(number) = uses.number(n, v) {
                touched[number] |= moves;
                if let Some(normal) = normal {
                    means[number].add(normal, angle(face, i, moved));
                }
            }
        }
    }
    let value = |number: usize| match uses.get(number) {
        Some((n, _)) if touched[number] && old[n as usize].is_finite() => {
            means[number].result().map_or(Value::Unusable, usable)
        }
        _ => Value::Old,
    };
    (0..uses.len()).map(value).collect()
}

/// Decides which values stay on their lines and which are added.
fn assign(old: Vec<DVec3>, uses: &Uses, values: &[Value]) -> Plan {
    let value = |number: usize, old: DVec3| match values[number] {
        Value::New(value) if !agree(old, value) => value,
        _ => old,
    };
    let mut plan = Plan {
        new: old
            .iter()
            .enumerate()
            .map(|(n, old)| value(n, *old))
            .collect(),
        redirected: Vec::new(),
        added: Vec::new(),
        kept: values
            .iter()
            .filter(|value| matches!(value, Value::Unusable))
            .count(),
        old,
    };
    let mut at = 0;
    for same_normal in uses.others.chunk_by(|a, b| a >> 32 == b >> 32) {
        let n = (same_normal[0] >> 32) as usize;
        let number = uses.first.len() + at;
        at += same_normal.len();
        // All uses of this normal, the first one first.
        let old = plan.old[n];
        let first = (key(n as u32, uses.first[n]), plan.new[n]);
        let others = same_normal
            .iter()
            .enumerate()
            .map(|(i, key)| (*key, value(number + i, old)));
        let mut all: Vec<(u64, DVec3)> = core::iter::once(first).chain(others).collect();
        if all.iter().any(|(_, value)| same(*value, old)) {
            plan.new[n] = old;
        }
        let on_line = plan.new[n];
        all.retain(|(_, value)| !same(*value, on_line) && !agree(on_line, *value));
        // Like values together; the order of those that differ is of no account, but must be fixed.
        all.sort_by(|a, b| {
            let coordinates = a.1.to_array().into_iter().zip(b.1.to_array());
            coordinates
                .map(|(a, b)| a.total_cmp(&b))
                .find(|order| order.is_ne())
                .unwrap_or(a.0.cmp(&b.0))
        });
        let mut last: Option<DVec3> = None;
        for (key, value) in all {
            if !last.is_some_and(|last| agree(last, value)) {
                plan.added.push(value);
                last = Some(value);
            }
            plan.redirected
                .push((key, (uses.first.len() + plan.added.len() - 1) as u64));
        }
    }
    plan.redirected.sort_unstable();
    plan
}
