//! In-betweens by strain fields: prepared once, then any time on its own.
//!
//! A frame at `t` has the strains that its scheme wants there, as nearly as its elements can: the guess puts every element between by its unwound
//! rotation and its stretch and stitches them together, and Newton's search ends at the least energy. Where a guess has
//! elements turned over, or a search comes to no end, the frame is reached from the nearer end in steps of `t`, small elements being held up
//! on the way; what had to be held up to the last is counted.
//!
//! *Source*: H.-B. Yan, S.-M. Hu, R. Martin, *Morphing based on strain field interpolation*, 2004; errata S1 to S13.

use super::body::{Body, Domain};
use super::newton::{self, Effort, Halt, Room, Search, THRESHOLD};
use super::placement::{Motion, place};
use super::schemes::Scheme;
use super::settings::{Rigid, Settings, Solver};
use super::tensor::{Strain, cross, turn};
use super::{Frame, FrameError, InBetween, Pair, PrepareError, Solution};
use anamorph_core::glam::{DMat2, DVec2};
use std::sync::{Mutex, PoisonError};

/// Pieces of time in which a frame is reached that cannot be reached at once.
const PIECES: usize = 16;
/// Stretches below this are wanted no smaller while elements are turned back.
const LEAST_STRETCH: f64 = 1e-3;

/// How a frame was found.
#[derive(Debug, Clone, Copy, Default)]
struct Way {
    effort: Effort,
    subdivisions: usize,
    held_up: usize,
    unfinished: usize,
}

/// A prepared morph by strain fields.
pub struct StrainMorph {
    scheme: &'static dyn Scheme,
    settings: Settings,
    source: Vec<DVec2>,
    target: Vec<DVec2>,
    parts: Vec<(Body, Motion)>,
    /// Rooms that no frame is using, for each part.
    rooms: Vec<Mutex<Vec<Room>>>,
}

impl std::fmt::Debug for StrainMorph {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("StrainMorph")
            .field("scheme", &self.scheme.name())
            .field("vertices", &self.source.len())
            .field("parts", &self.parts.len())
            .finish_non_exhaustive()
    }
}

fn check(pair: &Pair, scheme: &dyn Scheme, settings: &Settings) -> Result<(), PrepareError> {
    if !(settings.tolerance > 0.0 && settings.tolerance <= 1e-2) {
        return Err(PrepareError::OutOfRange {
            name: "tolerance",
            value: settings.tolerance,
            range: "above 0, to 0.01",
        });
    }
    for (name, value) in [("chain", settings.chain), ("stages", settings.stages)] {
        if value == 0 || value > 10_000 {
            return Err(PrepareError::OutOfRange {
                name,
                value: value as f64,
                range: "from 1 to 10 000",
            });
        }
    }
    let needs_area = settings.symmetric || scheme.needs_area();
    if let (true, Some(&element)) = (needs_area, pair.vanishing().first()) {
        return Err(PrepareError::Vanishing { element });
    }
    Ok(())
}

/// The motion of each part.
fn motions(pair: &Pair, bodies: &[Body], settings: &Settings) -> Result<Vec<Motion>, PrepareError> {
    let anchors = match settings.rigid {
        Rigid::Best => None,
        Rigid::Anchors(a, b) => Some([a, b]),
    };
    if let Some(anchors) = anchors {
        let part_of = |vertex: usize| {
            let found = bodies
                .iter()
                .position(|body| body.vertices.binary_search(&vertex).is_ok());
            found.ok_or(PrepareError::NoAnchor { vertex })
        };
        if part_of(anchors[0])? != part_of(anchors[1])? {
            return Err(PrepareError::AnchorsApart {
                first: anchors[0],
                second: anchors[1],
            });
        }
    }
    let each = bodies.iter().map(|body| {
        let places = |list: &[DVec2]| -> Vec<DVec2> {
            body.vertices.iter().map(|&vertex| list[vertex]).collect()
        };
        let (source, target) = (places(pair.source()), places(pair.target()));
        let own = anchors.map(|list| list.map(|v| body.vertices.binary_search(&v)));
        match (own, anchors) {
            (Some([Ok(a), Ok(b)]), Some([first, second])) => {
                let motion = Motion::anchors([a, b], &source, &target, settings.turns);
                motion.ok_or(PrepareError::AnchorsTogether { first, second })
            }
            _ => Ok(Motion::best(body, &source, &target, settings.turns)),
        }
    });
    each.collect()
}

impl StrainMorph {
    /// Prepares the in-betweens of a pair.
    ///
    /// # Errors
    /// [`PrepareError`] for settings out of range, anchors that cannot be, and elements without area in the target where the scheme or the
    /// symmetric energy needs one.
    pub fn new(
        pair: &Pair,
        scheme: &'static dyn Scheme,
        settings: &Settings,
    ) -> Result<Self, PrepareError> {
        check(pair, scheme, settings)?;
        let bodies = pair
            .parts()
            .iter()
            .map(|part| Body::new(pair, part, settings.symmetric))
            .collect::<Result<Vec<_>, _>>()?;
        let motions = motions(pair, &bodies, settings)?;
        let rooms = bodies.iter().map(|_| Mutex::default()).collect();
        Ok(Self {
            scheme,
            settings: settings.clone(),
            source: pair.source().to_vec(),
            target: pair.target().to_vec(),
            parts: bodies.into_iter().zip(motions).collect(),
            rooms,
        })
    }

    /// The scheme.
    pub fn scheme(&self) -> &'static dyn Scheme {
        self.scheme
    }

    /// Neighbouring elements whose rotations do not close about a hole (errata S12): between them the guess tears, and what it becomes is up
    /// to the search.
    pub fn open_windings(&self) -> Vec<(usize, usize)> {
        let lists = self.parts.iter().map(|(body, _)| &body.open);
        lists.flatten().copied().collect()
    }

    /// The search of a frame's places in a part; they are left in the room.
    fn find(&self, body: &Body, room: &mut Room, t: f64) -> Result<Solution, FrameError> {
        let search = Search {
            shear: self.settings.shear.weight(),
            tolerance: self.settings.tolerance,
            guarded: !self.settings.allow_flips,
            barrier: false,
        };
        let mut way = Way::default();
        let halted = match self.settings.solver {
            Solver::Projected => self.projected(body, room, t, search, &mut way).err(),
            Solver::Newton => {
                self.guess(body, room, t)
                    .map_err(|error| FrameError::Solver { time: t, error })?;
                body.want(self.scheme, t, &mut room.wanted);
                let done = newton::plain(body, room, search, 1);
                done.map(|more| way.effort += more).err()
            }
            Solver::Continuation => {
                room.positions.copy_from_slice(&body.source);
                let mut halted = None;
                for time in self.chain_to(0.0, t) {
                    halted = self.link(body, room, time, &mut way.effort).err();
                    if halted.is_some() {
                        break;
                    }
                }
                halted
            }
        };
        let (smallest, element) = body.smallest_determinant(&room.positions);
        if let Some(halt) = halted {
            return Err(match halt {
                Halt::Stalled => FrameError::Stalled {
                    time: t,
                    residual: newton::residual(body, room, search.shear),
                    element,
                },
                Halt::Indefinite => FrameError::Indefinite { time: t },
                Halt::Solver(error) => FrameError::Solver { time: t, error },
            });
        }
        if smallest <= 0.0 && !self.settings.allow_flips {
            return Err(FrameError::Flipped { time: t, element });
        }
        Ok(self.solution(body, room, t, way))
    }

    /// What is said of the places in the room.
    fn solution(&self, body: &Body, room: &mut Room, t: f64, way: Way) -> Solution {
        let shear = self.settings.shear.weight();
        body.want(self.scheme, t, &mut room.wanted);
        let energy = newton::energy(body, &room.wanted, None, shear, &room.positions);
        let unit = if self.settings.symmetric {
            1.0
        } else {
            body.scale * body.scale
        };
        let residual = newton::residual(body, room, shear);
        Solution {
            steps: way.effort.steps,
            corrections: way.effort.corrections,
            projected: way.effort.projected,
            subdivisions: way.subdivisions,
            held_up: way.held_up,
            unfinished: way.unfinished,
            energy: energy * unit,
            residual,
        }
    }

    /// The times of the chain from `from` to `t`.
    fn chain_to(&self, from: f64, t: f64) -> Vec<f64> {
        let count = self.settings.chain;
        let knots = (1..=count).map(|k| k as f64 / count as f64);
        let mut times: Vec<f64> = knots.filter(|&k| k > from && k < t).collect();
        times.push(t);
        times
    }

    /// One frame of the chain, from the places in the room.
    fn link(&self, body: &Body, room: &mut Room, t: f64, effort: &mut Effort) -> Result<(), Halt> {
        let search = Search {
            shear: self.settings.shear.weight(),
            tolerance: self.settings.tolerance,
            guarded: false,
            barrier: false,
        };
        body.want(self.scheme, t, &mut room.wanted);
        *effort += newton::plain(body, room, search, self.settings.stages)?;
        Ok(())
    }

    /// Elements between by rotation and stretch, stitched together (errata S13).
    fn guess(
        &self,
        body: &Body,
        room: &mut Room,
        t: f64,
    ) -> Result<(), anamorph_solvers::SolverError> {
        body.want(self.scheme, t, &mut room.wanted);
        let Room {
            positions,
            right,
            wanted,
            stitch,
            ..
        } = room;
        let Domain { points, .. } = &body.domains[0];
        let wanted = &wanted[0];
        let between =
            |point: usize| turn(t * body.angles[point]) * wanted[point].stretch().matrix();
        body.stitching
            .places(points, stitch, between, right, positions)
    }

    /// The determinants that the barrier begins at.
    fn set_thresholds(&self, body: &Body, room: &mut Room, t: f64) {
        let wanted = body.guarded.iter().map(|&full| {
            let stretch = self.scheme.strain(full, t).stretch().matrix();
            let wanted = cross(stretch.x_axis, stretch.y_axis);
            THRESHOLD * wanted.max(1e-5)
        });
        room.thresholds.clear();
        room.thresholds.extend(wanted);
    }

    /// How many elements the barrier holds up.
    fn held_up(&self, body: &Body, room: &Room) -> usize {
        let mut held: Vec<usize> = Vec::new();
        body.guards
            .each_gradient(&room.positions, |point, element, gradient| {
                if cross(gradient.x_axis, gradient.y_axis) < room.thresholds[point] {
                    held.push(element);
                }
            });
        held.sort_unstable();
        held.dedup();
        held.len()
    }

    fn projected(
        &self,
        body: &Body,
        room: &mut Room,
        t: f64,
        search: Search,
        way: &mut Way,
    ) -> Result<(), Halt> {
        self.guess(body, room, t).map_err(Halt::Solver)?;
        if !search.guarded {
            way.effort += newton::projected(body, room, search)?;
            return Ok(());
        }
        let whole = body.smallest_determinant(&room.positions).0 > 0.0;
        if whole && self.at_once(body, room, search, way)? {
            return Ok(());
        }
        // From where nothing is turned over, near to what is wanted.
        let untangled = self.untangle(body, room, t, way)?;
        if untangled && body.smallest_determinant(&room.positions).0 > 0.0 {
            if self.at_once(body, room, search, way)? {
                return Ok(());
            }
            self.set_thresholds(body, room, t);
            return self.held(body, room, search, way);
        }
        way.subdivisions = PIECES;
        self.in_pieces(body, room, t, search, way)
    }

    /// Whether the search comes to an end at which nothing has vanished; if not, the vertices stay where they are.
    fn at_once(
        &self,
        body: &Body,
        room: &mut Room,
        search: Search,
        way: &mut Way,
    ) -> Result<bool, Halt> {
        let start = room.positions.clone();
        match newton::projected(body, room, search) {
            Ok(more) => way.effort += more,
            Err(Halt::Stalled) => {
                room.positions.copy_from_slice(&start);
                return Ok(false);
            }
            Err(other) => return Err(other),
        }
        let sound = body.smallest_determinant(&room.positions).0 > 0.0;
        if !sound {
            room.positions.copy_from_slice(&start);
        }
        Ok(sound)
    }

    /// Turns back what the guess has turned over.
    fn untangle(&self, body: &Body, room: &mut Room, t: f64, way: &mut Way) -> Result<bool, Halt> {
        self.guess(body, room, t).map_err(Halt::Solver)?;
        let inverse = |full: &Strain| {
            let wanted = self
                .scheme
                .strain(*full, t)
                .floored(LEAST_STRETCH)
                .stretch();
            wanted.matrix().inverse()
        };
        let inverses: Vec<DMat2> = body.guarded.iter().map(inverse).collect();
        newton::untangle(body, room, &inverses, &mut way.effort)
    }

    /// From the nearer end, with small elements held up, then without.
    fn in_pieces(
        &self,
        body: &Body,
        room: &mut Room,
        t: f64,
        search: Search,
        way: &mut Way,
    ) -> Result<(), Halt> {
        let from_target = t > 0.5 && body.smallest_determinant(&body.target).0 > 0.0;
        let (end, start) = if from_target {
            (1.0, &body.target)
        } else {
            (0.0, &body.source)
        };
        room.positions.copy_from_slice(start);
        for piece in 1..=way.subdivisions {
            let time = end + (t - end) * (piece as f64 / way.subdivisions as f64);
            body.want(self.scheme, time, &mut room.wanted);
            self.set_thresholds(body, room, time);
            let held = Search {
                barrier: true,
                guarded: true,
                ..search
            };
            if piece == way.subdivisions {
                return self.held(body, room, search, way);
            }
            match newton::projected(body, room, held) {
                Ok(more) => way.effort += more,
                // What has been reached lies right, and is where the next piece begins.
                Err(Halt::Stalled) => {}
                Err(other) => return Err(other),
            }
        }
        Ok(())
    }

    /// With small elements held up, then without.
    fn held(
        &self,
        body: &Body,
        room: &mut Room,
        search: Search,
        way: &mut Way,
    ) -> Result<(), Halt> {
        let held = Search {
            barrier: true,
            guarded: true,
            ..search
        };
        match newton::projected(body, room, held) {
            Ok(more) => way.effort += more,
            // What has been reached has nothing turned over; its energy is the least that was found.
            Err(Halt::Stalled) => way.unfinished = 1,
            Err(other) => return Err(other),
        }
        way.held_up = self.held_up(body, room);
        // Perhaps it was held up on the way only.
        if way.held_up > 0 && self.at_once(body, room, search, way)? {
            (way.held_up, way.unfinished) = (0, 0);
        }
        Ok(())
    }

    fn take(&self, part: usize, body: &Body) -> Room {
        let taken = self.rooms[part]
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .pop();
        taken.unwrap_or_else(|| Room::new(body))
    }

    fn give(&self, part: usize, room: Room) {
        self.rooms[part]
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .push(room);
    }

    /// Vertices of no element, which go straight, and both ends.
    fn straight(&self, t: f64) -> Vec<DVec2> {
        let pairs = self.source.iter().zip(&self.target);
        pairs.map(|(a, b)| a.lerp(*b, t)).collect()
    }

    fn end(&self, t: f64) -> Frame {
        let places = if t == 0.0 { &self.source } else { &self.target };
        Frame {
            time: t,
            positions: places.clone(),
            solution: Solution::default(),
        }
    }

    fn put(&self, part: usize, room: &mut Room, t: f64, frame: &mut Frame, solution: Solution) {
        let (body, motion) = &self.parts[part];
        place(body, motion, t, &mut room.positions);
        for (&vertex, place) in body.vertices.iter().zip(&room.positions) {
            frame.positions[vertex] = *place;
        }
        frame.solution.add(&solution);
    }

    /// The paper's chain through ascending times.
    fn chained(&self, times: &[f64]) -> Result<Vec<Frame>, FrameError> {
        let mut order: Vec<usize> = (0..times.len()).collect();
        order.sort_by(|&a, &b| times[a].total_cmp(&times[b]));
        let mut frames: Vec<Frame> = times
            .iter()
            .map(|&time| Frame {
                time,
                positions: self.straight(time),
                solution: Solution::default(),
            })
            .collect();
        for (part, (body, _)) in self.parts.iter().enumerate() {
            let mut room = self.take(part, body);
            let mut last = 0.0;
            let mut knot = body.source.clone();
            for &number in &order {
                let t = times[number];
                if t == 0.0 || t == 1.0 {
                    frames[number] = self.end(t);
                    continue;
                }
                let mut effort = Effort::default();
                room.positions.copy_from_slice(&knot);
                for time in self.chain_to(last, t) {
                    self.link(body, &mut room, time, &mut effort)
                        .map_err(|halt| match halt {
                            Halt::Stalled => FrameError::Stalled {
                                time,
                                residual: f64::NAN,
                                element: body.numbers[0],
                            },
                            Halt::Indefinite => FrameError::Indefinite { time },
                            Halt::Solver(error) => FrameError::Solver { time, error },
                        })?;
                    if time < t {
                        last = time;
                        knot.copy_from_slice(&room.positions);
                    }
                }
                let (smallest, element) = body.smallest_determinant(&room.positions);
                if smallest <= 0.0 && !self.settings.allow_flips {
                    return Err(FrameError::Flipped { time: t, element });
                }
                let solution = self.solution(
                    body,
                    &mut room,
                    t,
                    Way {
                        effort,
                        ..Way::default()
                    },
                );
                self.put(part, &mut room, t, &mut frames[number], solution);
            }
            self.give(part, room);
        }
        Ok(frames)
    }
}

impl InBetween for StrainMorph {
    fn name(&self) -> &'static str {
        self.scheme.name()
    }

    fn at(&self, t: f64) -> Result<Frame, FrameError> {
        super::check_time(t)?;
        if t == 0.0 || t == 1.0 {
            return Ok(self.end(t));
        }
        let mut frame = Frame {
            time: t,
            positions: self.straight(t),
            solution: Solution::default(),
        };
        for (part, (body, _)) in self.parts.iter().enumerate() {
            let mut room = self.take(part, body);
            let found = self.find(body, &mut room, t);
            if let Ok(solution) = found {
                self.put(part, &mut room, t, &mut frame, solution);
            }
            self.give(part, room);
            found?;
        }
        Ok(frame)
    }

    fn frames(&self, times: &[f64]) -> Result<Vec<Frame>, FrameError> {
        if self.settings.solver == Solver::Continuation {
            times.iter().try_for_each(|&t| super::check_time(t))?;
            return self.chained(times);
        }
        super::each_alone(self, times)
    }

    fn wanted(&self, target: Strain, t: f64) -> Option<Strain> {
        Some(self.scheme.strain(target, t))
    }
}
