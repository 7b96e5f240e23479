//! The steps of a morph, from each image to the next: recipes, their features, and where features are at a time.

use crate::arguments::{FitName, MorphOptions};
use crate::error::Failure;
use crate::files::{self, short};
use crate::meshes::RecipeFiles;
use crate::model::ModelSpace;
use anamorph_catalog::{Context, Meshes, Value};
use anamorph_core::glam::{DMat2, DVec2, dvec2};
use anamorph_core::{Affine, Bounds, Deformation, Plane, Site, Stack};
use anamorph_io::landmarks::Landmarks;
use anamorph_morph::grid::{CoordinateGrid, GridWarp, Spline};
use anamorph_morph::images::Back;
use anamorph_morph::places::{LinePath, between_lines, between_points};
use anamorph_raster::Window;
use anamorph_recipe::{MorphFeatures, MorphWay, Recipe, RecipeError};
use serde_json::json;
use std::path::Path;

/// Features may stand outside of an image by this share of its size; some places of a face that is cut off do.
const FAR: f64 = 1.0;

/// Warps between landmarks that are joined to lines.
const LINES: [&str; 3] = ["lines", "global-lines", "elements"];
/// Warps between landmarks that are points.
const POINTS: [&str; 5] = ["thin-plate", "multilevel", "radial", "points", "scodef"];
/// Pieces of an edge between pins, where images lie within one another.
const EDGE_STEPS: usize = 8;

/// Features up to which all in-betweens are built before the first is drawn.
const MANY: usize = 300;
/// Places along each side of the frame at which folds are looked for.
const FOLDS: usize = 24;

/// Refuses landmarks that say that they are of an image of another size.
pub(super) fn check_landmarks(path: &Path, lie: &Lie, image: &str) -> Result<(), Failure> {
    let bytes = files::read(path)?;
    if !Landmarks::are(&bytes) {
        return Ok(());
    }
    let landmarks = Landmarks::read(&bytes)
        .map_err(|error| Failure::new(format!("{}: {error}", files::shown(path))))?;
    let (width, height) = (lie.display.width(), lie.display.height());
    match landmarks.size {
        Some([w, h]) if [w, h] != [width as f64, height as f64] => Err(Failure::new(format!(
            "{}: these are landmarks of an image of {} × {} pixels, and {image} has {width} × {height}; scale them, or take those of this \
             image",
            files::shown(path),
            short(w),
            short(h)
        ))),
        _ => Ok(()),
    }
}

/// From one image to the next.
pub(super) struct Step {
    recipe: Recipe,
    beside: RecipeFiles,
    /// Where the features are landmarks, whose messages speak of no recipe.
    landmarks: Option<Named>,
    /// The features, where they do not depend on the time.
    still: Option<MorphFeatures<Plane>>,
}

/// Where an image lies in the frame of the first.
#[derive(Clone, Copy)]
pub(super) struct Lie {
    display: Window,
    /// From its own pixels to the frame's; none if they are the same.
    to_frame: Option<Affine<Plane>>,
}

impl Lie {
    /// The place of an image of one display window in a frame of another.
    pub(super) fn of(
        display: Window,
        frame: Window,
        fit: Option<FitName>,
        name: &str,
    ) -> Result<Self, Failure> {
        let size = |w: Window| dvec2(w.width() as f64, w.height() as f64);
        let (own, wanted) = (size(display), size(frame));
        if own == wanted && display.corner() == frame.corner() {
            return Ok(Self {
                display,
                to_frame: None,
            });
        }
        let scale = match fit {
            None if own == wanted => DVec2::ONE,
            None => {
                return Err(Failure::new(format!(
                    "{name}: it is {} × {} pixels, and the first image {} × {}; say how it is to lie on it: --fit stretch, contain \
                     or cover",
                    own.x, own.y, wanted.x, wanted.y
                )));
            }
            Some(FitName::Stretch) => wanted / own,
            Some(FitName::Contain) => DVec2::splat((wanted / own).min_element()),
            Some(FitName::Cover) => DVec2::splat((wanted / own).max_element()),
        };
        let middle = |w: Window, s: DVec2| w.corner() + 0.5 * s;
        Ok(Self {
            display,
            to_frame: Some(Affine {
                linear: DMat2::from_diagonal(scale),
                translation: middle(frame, wanted) - scale * middle(display, own),
            }),
        })
    }

    pub(super) fn display(&self) -> Window {
        self.display
    }

    /// The pixels of the frame that a window of its own pixels lies on; none where it lies beside.
    pub(super) fn window_in(&self, own: Window, frame: Window) -> Result<Option<Window>, Failure> {
        let Some(affine) = self.to_frame else {
            return Ok(Some(own));
        };
        let size = |w: Window| dvec2(w.width() as f64, w.height() as f64);
        let low = affine.apply(own.corner()).max(frame.corner()).floor();
        let high = affine.apply(own.corner() + size(own));
        let high = high.min(frame.corner() + size(frame)).ceil();
        if !(low.cmplt(high).all()) {
            return Ok(None);
        }
        let extent = high - low;
        Window::new(
            low.x as i64,
            low.y as i64,
            extent.x as usize,
            extent.y as usize,
        )
        .map(Some)
        .map_err(Failure::new)
    }

    fn place(&self, own: DVec2) -> DVec2 {
        self.to_frame.map_or(own, |affine| affine.apply(own))
    }

    /// Refuses features that stand farther outside of the image than it is large: they are those of another.
    fn refuse_far(
        &self,
        features: &[Vec<DVec2>],
        name: &str,
        called: &dyn Fn(usize) -> String,
    ) -> Result<(), Failure> {
        let bounds = self.bounds();
        let reach = (bounds.max - bounds.min) * FAR;
        let is_far =
            |p: &&DVec2| p.cmplt(bounds.min - reach).any() || p.cmpgt(bounds.max + reach).any();
        let all = features.iter().enumerate();
        let mut places = all.flat_map(|(number, list)| list.iter().map(move |p| (number, p)));
        match places.find(|(_, place)| is_far(place)) {
            None => Ok(()),
            Some((number, place)) => Err(Failure::new(format!(
                "{name}: {} stands at ({}, {}), far outside of its {} × {} pixels; take the features of this image, in its pixels",
                called(number),
                short(place.x),
                short(place.y),
                self.display.width(),
                self.display.height()
            ))),
        }
    }

    /// From the frame's pixels to its own.
    fn own(&self) -> Option<Affine<Plane>> {
        let to = self.to_frame?;
        let linear =
            DMat2::from_diagonal(dvec2(1.0 / to.linear.x_axis.x, 1.0 / to.linear.y_axis.y));
        Some(Affine {
            linear,
            translation: -(linear * to.translation),
        })
    }

    fn bounds(&self) -> Bounds<Plane> {
        let corner = self.display.corner();
        let size = dvec2(self.display.width() as f64, self.display.height() as f64);
        Bounds::new(corner, corner + size)
    }
}

/// What leads back to an image.
enum Way {
    Still,
    Map(Box<dyn Deformation<Plane>>),
    Grid(GridWarp),
}

/// The in-between of a step at a time.
pub(super) struct Between {
    /// The features on the in-between, in the frame.
    pub(super) places: Vec<Vec<DVec2>>,
    /// How far the colours have gone.
    pub(super) dissolve: f64,
    /// Back to either image.
    ways: [Way; 2],
}

/// The keys by which options change recipes.
fn put_time(recipe: &mut Recipe, options: &MorphOptions) -> Result<(), Failure> {
    for (key, value) in [("ease", &options.ease), ("dissolve", &options.dissolve)] {
        if let Some(name) = value {
            anamorph_curves::eases::parse(name)
                .map_err(|error| Failure::usage(format!("--{key}: {error}")))?;
            let argument = format!("time.{key}={name:?}");
            recipe.set(&argument).map_err(Failure::new)?;
        }
    }
    for argument in &options.set {
        recipe.set(argument).map_err(Failure::new)?;
    }
    Ok(())
}

/// A recipe of the features of two files of landmarks, and the pins of the border that come behind them.
fn of_landmarks(
    [source, target]: [&Path; 2],
    method: &str,
    fit: Option<FitName>,
) -> (Value, Vec<[String; 2]>) {
    let file = |path: &Path| path.to_string_lossy().into_owned();
    let mut warp = json!({ "kind": method, "source": file(source), "target": file(target) });
    let mut pins = Vec::new();
    if !LINES.contains(&method) {
        // The border goes to the border, or images would come off it. Where one lies within the other's its edges move, and are held at more
        // places, so that they stay straight on their way.
        let steps = match fit {
            Some(FitName::Contain | FitName::Cover) => EDGE_STEPS,
            _ => 2,
        };
        let share = |step: usize| format!("{}%", 100.0 * step as f64 / steps as f64);
        let inner = |step: usize| step != 0 && step != steps;
        for x in 0..=steps {
            for y in (0..=steps).filter(|&y| !(inner(x) && inner(y))) {
                pins.push([share(x), share(y)]);
            }
        }
        let points: Vec<Value> = pins.iter().map(|place| json!({ "from": place })).collect();
        warp["point"] = Value::from(points);
    }
    (json!({ "version": 1, "warp": [warp] }), pins)
}

/// Two files of landmarks, as messages name them.
struct Named {
    files: String,
    /// How many landmarks the first has; pins come behind.
    count: usize,
    pins: Vec<[String; 2]>,
}

impl Named {
    /// A feature by its number.
    fn feature(&self, number: usize) -> String {
        match number.checked_sub(self.count).map(|pin| self.pins.get(pin)) {
            Some(Some([x, y])) => format!("the border pin at ({x}, {y})"),
            _ => format!("landmark {number}"),
        }
    }

    /// A message of a warp, its numbers of points replaced by what they are.
    fn words(&self, message: &str) -> String {
        let mut words: Vec<String> = message.split(' ').map(str::to_owned).collect();
        let mut at = 0;
        while at + 1 < words.len() {
            let number = |word: &str| word.parse::<usize>().ok();
            match (words[at].as_str(), number(&words[at + 1])) {
                ("point" | "points" | "feature", Some(first)) => {
                    words[at].clear();
                    words[at + 1] = self.feature(first);
                    let and = words.get(at + 2).is_some_and(|word| word == "and");
                    if let Some(second) = words.get(at + 3).and_then(|word| number(word))
                        && and
                    {
                        words[at + 3] = self.feature(second);
                    }
                    at += 2;
                }
                _ => at += 1,
            }
        }
        words.retain(|word| !word.is_empty());
        words.join(" ")
    }

    /// A problem of the recipe that stands for the landmarks.
    fn failure(&self, error: &RecipeError) -> Failure {
        let each = error.problems.iter().map(|problem| {
            let message = self.words(&problem.message);
            // Hints about keys of recipes and their files are of no use here.
            let is_foreign = problem.path.ends_with(".kind")
                || problem.hint.contains("file")
                || problem.hint.contains('`');
            if message.ends_with("has no line") {
                format!(
                    "{}: {message}; list its chains, or take another --method",
                    self.files
                )
            } else if is_foreign || problem.hint.is_empty() {
                format!("{}: {message}", self.files)
            } else {
                format!("{}: {message}; {}", self.files, problem.hint)
            }
        });
        Failure::new(each.collect::<Vec<_>>().join("\n"))
    }
}

/// The steps between so many images.
pub(super) fn steps(options: &MorphOptions, images: usize) -> Result<Vec<Step>, Failure> {
    let needed = images - 1;
    let step = |mut recipe: Recipe, beside, landmarks| {
        put_time(&mut recipe, options)?;
        Ok(Step {
            landmarks,
            ..Step::new(recipe, beside)
        })
    };
    if !options.landmarks.is_empty() {
        if options.landmarks.len() != images {
            return Err(Failure::usage(format!(
                "-l/--landmarks: there are {} files for {images} images; give one for each, in the same order",
                options.landmarks.len()
            )));
        }
        let method = options.method.as_deref().unwrap_or("thin-plate");
        if !LINES.iter().chain(&POINTS).any(|known| *known == method) {
            return Err(Failure::usage(format!(
                "--method {method}: landmarks go by {} or {}",
                POINTS.join(", "),
                LINES.join(", ")
            )));
        }
        let pairs = options.landmarks.windows(2);
        return pairs
            .map(|pair| {
                let (value, pins) = of_landmarks([&pair[0], &pair[1]], method, options.fit);
                let name = format!("{} and {}", pair[0].display(), pair[1].display());
                let recipe = Recipe::from_json(&value.to_string(), &name).map_err(Failure::new)?;
                // The files are named on the command line, relative to where it runs.
                let beside = RecipeFiles::beside(Path::new("-"), true);
                let read = beside.mesh(&pair[0].to_string_lossy());
                let named = Named {
                    files: name,
                    count: read.map_or(0, |mesh| mesh.points.len()),
                    pins,
                };
                step(recipe, beside, Some(named))
            })
            .collect();
    }
    if options.recipe.len() != needed {
        return Err(Failure::usage(format!(
            "-r/--recipe: {} for {images} images; a chain needs one for each step, {needed} here: -r FIRST -r SECOND",
            match options.recipe.len() {
                1 => "there is one recipe".to_owned(),
                count => format!("there are {count} recipes"),
            }
        )));
    }
    options
        .recipe
        .iter()
        .map(|path| {
            let bytes = files::read(path)?;
            let recipe = Recipe::read(&bytes, &files::shown(path)).map_err(Failure::new)?;
            step(
                recipe,
                RecipeFiles::beside(path, options.allow_outside),
                None,
            )
        })
        .collect()
}

impl Between {
    /// Whether an image, 0 or 1, stands as it is.
    pub(super) fn is_still(&self, image: usize) -> bool {
        matches!(self.ways[image], Way::Still)
    }

    /// A place of the frame around which an image is turned over, if there is one.
    pub(super) fn fold(&self, image: usize, frame: Window) -> Option<DVec2> {
        let Way::Map(map) = &self.ways[image] else {
            return None;
        };
        let size = dvec2(frame.width() as f64, frame.height() as f64);
        let place = |i: usize| {
            let share = |i: usize| (i as f64 + 0.5) / FOLDS as f64;
            frame.corner() + size * dvec2(share(i % FOLDS), share(i / FOLDS))
        };
        let turned = |p: &DVec2| {
            let jacobian = map.jacobian(&Site::anywhere(*p), size.length());
            jacobian.is_some_and(|jacobian| jacobian.determinant() < 0.0)
        };
        (0..FOLDS * FOLDS).map(place).find(turned)
    }

    /// What leads back to an image, 0 or 1.
    pub(super) fn back(&self, image: usize) -> Back<'_> {
        match &self.ways[image] {
            Way::Still => Back::Still,
            Way::Map(map) => Back::Map(map.as_ref()),
            Way::Grid(warp) => Back::Grid(warp),
        }
    }
}

impl Step {
    pub(super) fn new(recipe: Recipe, beside: RecipeFiles) -> Self {
        Self {
            recipe,
            beside,
            landmarks: None,
            still: None,
        }
    }

    pub(super) fn recipe(&self) -> &Recipe {
        &self.recipe
    }

    pub(super) fn beside(&self) -> &RecipeFiles {
        &self.beside
    }

    fn features(&self, time: f64, lies: [&Lie; 2]) -> Result<MorphFeatures<Plane>, Failure> {
        let context = |lie: &Lie| Context {
            bounds: Some(lie.bounds()),
            meshes: Some(&self.beside),
            ..Context::default()
        };
        let (source, target) = (context(lies[0]), context(lies[1]));
        self.recipe
            .morph_features(time, &Plane::registry(), &source, &target)
            .map_err(|error| match &self.landmarks {
                Some(named) => named.failure(&error),
                None => Failure::new(error),
            })
    }

    /// A feature as messages name it.
    fn feature(&self, number: usize) -> String {
        match &self.landmarks {
            Some(named) => named.feature(number),
            None => format!("feature {number}"),
        }
    }

    /// Builds what does not depend on the time, and says what the features are.
    pub(super) fn prepare(
        &mut self,
        lies: [&Lie; 2],
        names: [&str; 2],
    ) -> Result<(String, usize), Failure> {
        let features = self.features(0.0, lies)?;
        for (list, (lie, name)) in [&features.sources, &features.targets]
            .into_iter()
            .zip(lies.into_iter().zip(names))
        {
            lie.refuse_far(list, name, &|number| self.feature(number))?;
            let vanishes = |places: &Vec<DVec2>| matches!(places.as_slice(), [a, b] if a == b);
            if let Some(number) = list.iter().position(vanishes) {
                let place = list[number][0];
                return Err(Failure::new(format!(
                    "{name}: {} is a line without length, at ({}, {}); move one of its ends",
                    self.feature(number),
                    short(place.x),
                    short(place.y)
                )));
            }
        }
        let found = (features.title.clone(), features.sources.len());
        if self.recipe.track_count() == 0 {
            self.still = Some(features);
        }
        Ok(found)
    }

    /// Whether in-betweens are quickly built, so that all can be tried before any is drawn.
    pub(super) fn is_light(&self) -> bool {
        let few = |features: &MorphFeatures<Plane>| features.sources.len() <= MANY;
        self.still.as_ref().is_some_and(few)
    }

    /// What is between two images at a time from 0 to 1.
    pub(super) fn between(&self, time: f64, lies: [&Lie; 2]) -> Result<Between, Failure> {
        let own;
        let features = match &self.still {
            Some(features) => features,
            None => {
                own = self.features(time, lies)?;
                &own
            }
        };
        let title = &features.title;
        let in_frame = |list: &[Vec<DVec2>], lie: &Lie| -> Vec<Vec<DVec2>> {
            let each = list.iter();
            each.map(|places| places.iter().map(|&p| lie.place(p)).collect())
                .collect()
        };
        let ends = [
            in_frame(&features.sources, lies[0]),
            in_frame(&features.targets, lies[1]),
        ];
        let ways = self.recipe.morph_ways(time, ends[0].len());
        let turns = self.recipe.morph_turns();
        let pairs = ends[0].iter().zip(&ends[1]).zip(&ways);
        let places: Vec<Vec<DVec2>> = pairs
            .map(
                |((from, to), &way)| match (from.as_slice(), to.as_slice()) {
                    (&[a, b], &[c, d]) if turns => {
                        // A turn has no beyond.
                        let turned =
                            between_lines([a, b], [c, d], way.clamp(0.0, 1.0), LinePath::Turning);
                        turned.map_or_else(|_| from.clone(), Vec::from)
                    }
                    _ => from
                        .iter()
                        .zip(to)
                        .map(|(&p, &q)| between_points(p, q, way))
                        .collect(),
                },
            )
            .collect();
        let wrong = |message: String| Failure::new(format!("{title} at time {time}: {message}"));
        let grid = |nodes: &[Vec<DVec2>]| -> Result<Option<(CoordinateGrid, Spline)>, Failure> {
            let MorphWay::Grid {
                columns,
                rows,
                curves,
            } = &features.way
            else {
                return Ok(None);
            };
            let nodes = nodes.iter().flatten().copied().collect();
            let grid = CoordinateGrid::new(*columns, *rows, nodes)
                .map_err(|error| wrong(error.to_string()))?;
            let spline = curves.as_deref().map(Spline::by_name).transpose();
            let spline = spline.map_err(|error| wrong(error.to_string()))?;
            Ok(Some((grid, spline.unwrap_or_default())))
        };
        let back = |end: usize| -> Result<Way, Failure> {
            let (image, lie) = (&ends[end], lies[end]);
            let still = places == *image;
            match (lie.own(), grid(image)?) {
                (None, _) if still => Ok(Way::Still),
                (fit, Some((image, spline))) => {
                    let Some((between, _)) = grid(&places)? else {
                        return Ok(Way::Still);
                    };
                    let warp = GridWarp::new(&between, &image, spline)
                        .map_err(|error| wrong(error.to_string()))?;
                    Ok(match fit {
                        None => Way::Grid(warp),
                        Some(fit) => {
                            Way::Map(Box::new(Stack::new(vec![Box::new(warp), Box::new(fit)])))
                        }
                    })
                }
                (fit, None) => {
                    let MorphWay::Warp(with) = &features.way else {
                        return Ok(Way::Still);
                    };
                    let warp = with(&places, image).map_err(|error| {
                        let meet = if time > 0.0 && time < 1.0 {
                            "; features that meet on their way are kept apart by a schedule, or by other targets"
                        } else {
                            ""
                        };
                        let message = match &self.landmarks {
                            Some(named) => named.words(&error.message),
                            None if matches!(error.path.as_str(), "" | "source" | "target") => {
                                error.message
                            }
                            None => format!("{}: {}", error.path, error.message),
                        };
                        wrong(format!("{message}{meet}"))
                    })?;
                    Ok(Way::Map(match fit {
                        None => Box::new(warp),
                        Some(fit) => Box::new(Stack::new(vec![Box::new(warp), Box::new(fit)])),
                    }))
                }
            }
        };
        let ways = [back(0)?, back(1)?];
        Ok(Between {
            dissolve: self.recipe.morph_dissolve(time),
            places,
            ways,
        })
    }
}
