//! Warps under test: every setting built in every box, and the points they are tried on.

use crate::models::boxes;
use crate::random::Random;
use crate::settings::{Setting, settings};
use anamorph_catalog::{Built, ConstructError, Context, Value, WarpEntry};
use anamorph_core::{
    Average, Bounds, Influences, Plane, Site, Smoothness, Solid, Space, Support, Warp,
};
use anamorph_transforms::Rotational;

/// A space with its registry of warps.
pub trait Registered: Rotational {
    /// Every registered warp.
    fn registry() -> Vec<WarpEntry<Self>>;
}
impl Registered for Plane {
    fn registry() -> Vec<WarpEntry<Self>> {
        anamorph_warps::registry::plane()
    }
}
impl Registered for Solid {
    fn registry() -> Vec<WarpEntry<Self>> {
        anamorph_warps::registry::solid()
    }
}

/// The registry entry of a kind.
pub fn entry<S: Registered>(kind: &str) -> WarpEntry<S> {
    let all = S::registry();
    *all.iter().find(|e| e.kind == kind).expect(kind)
}

/// Parameters as a recipe writes them, read.
pub fn parameters(toml: &str) -> Value {
    toml::from_str(toml).unwrap_or_else(|error| panic!("{error} in\n{toml}"))
}

/// One setting in one box.
pub struct Subject<S: Space> {
    /// The setting.
    pub setting: Setting,
    /// The box of the model.
    pub bounds: Bounds<S>,
    entry: WarpEntry<S>,
    value: Value,
}

impl<S: Registered> Subject<S> {
    /// The setting in a box.
    pub fn new(setting: Setting, bounds: Bounds<S>) -> Self {
        Self {
            entry: entry(setting.kind),
            value: parameters(&setting.toml),
            setting,
            bounds,
        }
    }

    /// Every setting in every box.
    pub fn all() -> Vec<Self> {
        let all = settings::<S>();
        let each = |bounds| {
            all.iter()
                .map(move |setting| Self::new(setting.clone(), bounds))
        };
        boxes().into_iter().flat_map(each).collect()
    }

    /// Every setting in the ordinary and the uneven box.
    pub fn some() -> Vec<Self> {
        let boxes = boxes::<S>();
        let keep = |s: &Self| boxes[..2].contains(&s.bounds);
        Self::all().into_iter().filter(keep).collect()
    }

    /// The registry's own examples in the uneven box.
    pub fn examples() -> Vec<Self> {
        let bounds = boxes()[1];
        let examples = settings::<S>().into_iter().filter(|s| s.example);
        examples.map(|setting| Self::new(setting, bounds)).collect()
    }

    /// What construction gives.
    ///
    /// # Errors
    /// Those of the entry's construction.
    pub fn try_build(&self) -> Result<Built<S>, ConstructError> {
        let context = Context {
            bounds: Some(self.bounds),
            scaling: self.setting.scaling,
            attributes: None,
            meshes: None,
        };
        (self.entry.construct)(&self.value, &context)
    }

    /// A fresh copy of the warp.
    pub fn warp(&self) -> Box<dyn Warp<S>> {
        self.try_build()
            .unwrap_or_else(|error| panic!("{self}: {error}"))
            .warp
    }

    /// The model's size.
    pub fn size(&self) -> f64 {
        self.bounds.diagonal()
    }

    /// The size of numbers that rounding errors near the model are relative to.
    pub fn scale(&self) -> f64 {
        let corner = self.bounds.min.largest().max(self.bounds.max.largest());
        self.size().max(corner)
    }

    /// A random point of the box.
    pub fn inside(&self, random: &mut Random) -> S {
        self.bounds.at(S::from_fn(|_| random.between(0.0, 1.0)))
    }

    /// `count` points: inside, on faces, edges and corners, outside, at features and next to them, on and about the edge
    /// of the support, very far away.
    pub fn points(&self, count: usize, seed: u64) -> Vec<S> {
        let warp = self.warp();
        let mut random = Random::new(seed);
        let features: Vec<S> = warp.conditions().iter().map(|c| c.source).collect();
        let support = warp.facts().support;
        let feature = |random: &mut Random| match features.as_slice() {
            [] => self.bounds.centre(),
            list => list[random.below(list.len())],
        };
        (0..count)
            .map(|i| match i % 10 {
                0..=2 => self.inside(&mut random),
                3 => {
                    let sides: [f64; 3] = core::array::from_fn(|_| match random.below(3) {
                        0 => 0.0,
                        1 => 1.0,
                        _ => random.between(0.0, 1.0),
                    });
                    self.bounds.at(S::from_fn(|axis| sides[axis]))
                }
                4 => self.bounds.at(S::from_fn(|_| random.between(-1.0, 2.0))),
                5 => feature(&mut random),
                6 => {
                    let exponent = random.between(-14.0, -1.0);
                    let offset = anamorph_core::math::pow(10.0, exponent) * self.size();
                    feature(&mut random) + random.direction::<S>() * offset
                }
                7 => match support {
                    Support::Ball { centre, radius } => centre + random.direction::<S>() * radius,
                    Support::Box(b) => {
                        let mut at = S::from_fn(|_| random.between(0.0, 1.0));
                        let axis = random.below(S::DIM);
                        let end = f64::from(u8::from(random.below(2) == 1));
                        at = S::from_fn(|i| if i == axis { end } else { at.component(i) });
                        b.at(at)
                    }
                    Support::Nowhere | Support::Everywhere => self.inside(&mut random),
                },
                8 => self.inside(&mut random) * 1e6,
                _ => {
                    let at = S::from_fn(|_| [0.0, 0.25, 0.5, 0.75, 1.0][random.below(5)]);
                    self.bounds.at(at)
                }
            })
            .collect()
    }

    /// The size of the numbers that make up the image of a point: where terms are summed without an average, rounding errors are
    /// relative to the largest of them.
    pub fn in_play(&self, warp: &dyn Warp<S>, p: S, image: S) -> f64 {
        let mut size = self.scale().max(p.largest()).max(image.largest());
        if warp.average() == Average::Plain {
            let mut list = Influences::default();
            warp.influences(&Site::anywhere(p), &mut list);
            for influence in &list.list {
                let term = warp.scaled(influence.address, influence.strength);
                size = size.max(term.displacement(p).largest());
            }
        }
        size
    }

    /// A random line through the neighbourhood of the box, sampled; see [`crate::measure::breaks`].
    pub fn line(&self, random: &mut Random) -> Vec<S> {
        let end = |random: &mut Random| self.bounds.at(S::from_fn(|_| random.between(-0.4, 1.4)));
        let (from, to) = (end(random), end(random));
        let last = f64::from(u32::try_from(crate::measure::SAMPLES).unwrap() - 1);
        (0..crate::measure::SAMPLES)
            .map(|i| from + (to - from) * (f64::from(u32::try_from(i).unwrap()) / last))
            .collect()
    }

    /// The class the warp claims over the whole of space.
    pub fn claimed(&self) -> Smoothness {
        self.warp().facts().smoothness()
    }
}

impl<S: Space> core::fmt::Display for Subject<S> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Setting {
            kind,
            toml,
            scaling,
            ..
        } = &self.setting;
        write!(f, "{kind} {scaling:?} in {:?} with\n{toml}", self.bounds)
    }
}
