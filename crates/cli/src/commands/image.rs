//! `anamorph warp` of images: every pixel of the result is looked up where the recipe takes it from, or every pixel of the
//! source is moved.
//!
//! The coordinates of a recipe are pixels: x goes right and y goes down, as in the file, and a pixel's centre is half a
//! pixel from its corner. Percentages refer to the display window.

use super::image_maps::{motion, read_stmap, stmap};
use super::image_report::{report, summary};
use super::jobs::Job;
use super::panels::Panels;
use super::promises::fold;
use super::warp::Run;
use crate::arguments::{ImageOptions, MappingName, WarpOptions};
use crate::error::{Failure, say};
use crate::files::{self, Pending};
use crate::model::{self, ModelSpace};
use crate::picture;
use anamorph_catalog::Context;
use anamorph_core::glam::{DVec2, dvec2};
use anamorph_core::{
    Affine, Bounds, Deformation, Domain, Facts, Inverse, Plane, Site, Stack, Unmapped,
    map_all_parallel,
};
use anamorph_io::images::{
    Channel, ChannelKind, EncodeOptions, ImageFile, ImageFormat, ImageLayer, ImageLimits,
    SampleType,
};
use anamorph_raster::{
    Edge, Filter, Hierarchy, HierarchyReport, PixelMap, Raster, RasterError, SplatOptions, Window,
    hierarchical_map, resample, splat,
};
use anamorph_recipe::BuiltRecipe;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Points along each side of the display window by which bounds and folds are found.
const LATTICE: usize = 65;

/// The most pixels that `--grow` makes of one.
const GROWTH: usize = 16;

/// Whether a file is an image, by its first bytes; without reading a stream.
pub(super) fn is_image(path: &Path) -> bool {
    let mut head = Vec::new();
    !files::is_immediate(path)
        && std::fs::File::open(path)
            .and_then(|file| file.take(16).read_to_end(&mut head))
            .is_ok()
        && ImageFormat::of_content(&head).is_some()
}

/// The format of images that a name asks for.
pub(super) fn named_format(path: &Path) -> Option<ImageFormat> {
    let extension = path.extension().and_then(|e| e.to_str())?;
    ImageFormat::of_extension(extension)
}

/// Whether bytes are to be read as an image: they are one, or the file's name says so.
pub(super) fn concerns(path: &Path, bytes: &[u8]) -> bool {
    ImageFormat::of_content(bytes).is_some() || named_format(path).is_some()
}

/// Refuses options that only images have.
pub(super) fn refuse_options(options: &WarpOptions) -> Result<(), Failure> {
    match options.image.given() {
        Some(name) => Err(Failure::usage(format!(
            "{name} is for images (PNG, JPEG, TIFF, WebP, OpenEXR); leave it out for models"
        ))),
        None => Ok(()),
    }
}

/// Refuses what images do not have.
pub(super) fn check(job: &Job, options: &WarpOptions) -> Result<(), Failure> {
    let image = files::shown(&job.model);
    let refuse = |given: bool, what: &str, mend: &str| {
        if given {
            return Err(Failure::usage(format!(
                "{image}: {what} of an image is not built; {mend}"
            )));
        }
        Ok(())
    };
    refuse(
        options.turntable.is_some(),
        "a turntable",
        "leave out --turntable: a picture has one side",
    )?;
    refuse(
        options.preview_field.is_some(),
        "a painted preview",
        "leave out --preview-field",
    )?;
    refuse(
        options.binding.is_some(),
        "a binding",
        "leave out --binding",
    )?;
    refuse(options.rest.is_some(), "a rest model", "leave out --rest")?;
    let several = options.models.len() > 1;
    let maps = [&options.image.stmap, &options.image.motion_vectors];
    if (several || options.frames.is_some()) && maps.iter().any(|path| path.is_some()) {
        return Err(Failure::usage(
            "--stmap and --motion-vectors are of one image; warp the images, or the frames by --set, one by one",
        ));
    }
    let known = |path: &PathBuf| (!files::is_stream(path)).then(|| files::identity(path));
    let mut taken: Vec<Option<PathBuf>> = job.results().map(|(path, _)| known(path)).collect();
    let inputs = std::iter::once(&job.model).chain(&options.recipe);
    taken.extend(inputs.map(known));
    for path in maps.into_iter().flatten() {
        let own = known(path);
        if own.is_none() || taken.contains(&own) {
            return Err(Failure::usage(format!(
                "{}: a map needs a file of its own; choose another name",
                path.display()
            )));
        }
        if named_format(path) != Some(ImageFormat::OpenExr) {
            return Err(Failure::usage(format!(
                "{}: a map is written as OpenEXR; name it .exr",
                path.display()
            )));
        }
        files::refuse_existing(path, options.force)?;
        taken.push(own);
    }
    Ok(())
}

/// Where target pixels come from; not a number where no place was found.
struct Back<D>(Inverse<D>);

impl<D: Deformation<Plane>> Deformation<Plane> for Back<D> {
    fn map(&self, site: &Site<Plane>) -> Plane {
        let mut point = [site.point];
        let _ = self.map_points(site.index, &mut point);
        point[0]
    }
    fn facts(&self) -> Facts<Plane> {
        self.0.facts()
    }
    fn domain(&self) -> Domain {
        Deformation::<Plane>::domain(&self.0)
    }
    fn map_points(&self, first: usize, points: &mut [Plane]) -> Unmapped {
        let unmapped = self.0.map_points(first, points);
        for index in unmapped.indices() {
            if let Some(point) = index.checked_sub(first).and_then(|i| points.get_mut(i)) {
                *point = DVec2::NAN;
            }
        }
        unmapped
    }
}

/// The recipe's deformation, both ways.
struct Ways {
    forward: Box<dyn Deformation<Plane>>,
    back: Box<dyn Deformation<Plane>>,
}

impl Ways {
    fn new(built: &BuiltRecipe<Plane>, inverted: bool, size: f64) -> Self {
        if inverted {
            Self {
                forward: Box::new(Back(Inverse::new(built.stack(), size))),
                back: Box::new(built.stack()),
            }
        } else {
            Self {
                forward: Box::new(built.stack()),
                back: Box::new(Back(Inverse::new(built.stack(), size))),
            }
        }
    }
}

/// Points of a window: its corners, borders and some between.
fn lattice(window: Window) -> Vec<Plane> {
    let size = dvec2(window.width() as f64, window.height() as f64);
    let share = |i: usize| i as f64 / (LATTICE - 1) as f64;
    let at = |i: usize| dvec2(share(i % LATTICE), share(i / LATTICE));
    (0..LATTICE * LATTICE)
        .map(|i| window.corner() + size * at(i))
        .collect()
}

fn build(run: &Run<'_>, points: &[Plane]) -> Result<BuiltRecipe<Plane>, Failure> {
    let context = Context {
        bounds: Bounds::of(points),
        scaling: None,
        attributes: None,
        meshes: Some(&run.beside),
    };
    let mut bounds_after = |parts: &[Arc<dyn Deformation<Plane>>]| {
        let mut moved = points.to_vec();
        let parts = parts.iter().map(|part| Box::new(Arc::clone(part)) as _);
        let _ = map_all_parallel(&Stack::new(parts.collect()), &mut moved, &|_| {});
        Bounds::of(&moved)
    };
    run.recipe
        .build(&Plane::registry(), &context, &mut bounds_after)
        .map_err(Failure::new)
}

/// Coverage from which on a pixel counts as covered; filters round.
const COVERED: f32 = 1.0 - 1e-5;

/// What the options say about drawing.
pub(super) struct Drawing<'a> {
    pub(super) options: &'a ImageOptions,
    pub(super) filter: Filter,
    max_error: f64,
}

impl<'a> Drawing<'a> {
    fn of(options: &'a ImageOptions) -> Result<Self, Failure> {
        let filter = options
            .pixels
            .filter
            .as_deref()
            .map(Filter::by_name)
            .transpose();
        let filter = filter.map_err(|error| Failure::usage(format!("--filter: {error}")))?;
        Ok(Self {
            options,
            filter: filter.unwrap_or(Filter::ANISOTROPIC),
            max_error: options
                .pixels
                .max_error
                .unwrap_or(Hierarchy::default().max_error),
        })
    }

    pub(super) fn is_forward(&self) -> bool {
        self.options.mapping == Some(MappingName::Forward)
    }

    /// What stands beyond a layer's pixels.
    fn edge(&self, layer: &ImageLayer, display: Window) -> Result<Edge, Failure> {
        if let Some(name) = &self.options.pixels.edge {
            return Edge::by_name(name).map_err(|error| Failure::usage(format!("--edge: {error}")));
        }
        // A data window of its own says that nothing is beyond.
        let open = layer.has_alpha() || self.options.grow || layer.window() != Some(display);
        Ok(if open { Edge::Transparent } else { Edge::Clamp })
    }

    /// The map of a window, and how good it is.
    fn map(
        &self,
        back: &dyn Deformation<Plane>,
        window: Window,
    ) -> Result<(PixelMap, Option<HierarchyReport>), RasterError> {
        if self.max_error == 0.0 {
            return Ok((PixelMap::from_deformation(back, window)?, None));
        }
        let (map, report) = hierarchical_map(back, window, &Hierarchy::within(self.max_error))?;
        Ok((map, Some(report)))
    }
}

/// Where a window's pixels go: the smallest window around them. Itself if nothing moves.
fn result_window(
    forward: &dyn Deformation<Plane>,
    window: Window,
) -> Result<Option<Window>, RasterError> {
    // The border pixel by pixel, and some places between, for what folds over it.
    let mut points = lattice(window);
    let (width, height) = (window.width() as f64, window.height() as f64);
    for x in 0..=window.width() {
        points.extend([0.0, height].map(|y| window.corner() + dvec2(x as f64, y)));
    }
    for y in 0..=window.height() {
        points.extend([0.0, width].map(|x| window.corner() + dvec2(x, y as f64)));
    }
    let still = points.clone();
    let _ = map_all_parallel(forward, &mut points, &|_| {});
    if points == still {
        return Ok(Some(window));
    }
    points.retain(|point| point.is_finite());
    let Some(bounds) = Bounds::of(&points) else {
        return Ok(None);
    };
    // A pixel more on each side for what lies between the places looked at.
    let (low, high) = (bounds.min.floor() - 1.0, bounds.max.ceil() + 1.0);
    let size = high - low;
    Window::new(low.x as i64, low.y as i64, size.x as usize, size.y as usize).map(Some)
}

/// What two windows share.
fn shared(a: Window, b: Window) -> Option<Window> {
    let end = |start: i64, size: usize| start.saturating_add_unsigned(size as u64);
    let (x, y) = (a.x().max(b.x()), a.y().max(b.y()));
    let right = end(a.x(), a.width()).min(end(b.x(), b.width()));
    let bottom = end(a.y(), a.height()).min(end(b.y(), b.height()));
    let size = |from: i64, to: i64| usize::try_from(to.checked_sub(from)?).ok();
    Window::new(x, y, size(x, right)?, size(y, bottom)?).ok()
}

/// The pixels that a layer has in the result.
fn target(
    drawing: &Drawing<'_>,
    forward: &dyn Deformation<Plane>,
    source: Window,
    image: &ImageFile,
) -> Result<Window, Failure> {
    let has_data_windows = image.format() == ImageFormat::OpenExr;
    if !drawing.options.grow && !has_data_windows {
        return Ok(source);
    }
    let around = result_window(forward, source).map_err(Failure::new)?;
    let wanted = match around {
        None => return Ok(source),
        Some(around) if drawing.options.grow => Some(around),
        Some(around) => shared(around, image.display()),
    };
    let grown = wanted
        .map_or(Ok(source), |wanted| {
            if has_data_windows {
                source.union(&wanted)
            } else {
                Ok(wanted)
            }
        })
        .map_err(Failure::new)?;
    let most = source.pixels().and_then(|n| n.checked_mul(GROWTH));
    let least = LATTICE * LATTICE;
    match (grown.pixels(), most) {
        (Some(pixels), Some(most)) if pixels <= most.max(least) => Ok(grown),
        _ => Err(Failure::new(format!(
            "the result would cover {grown}, over {GROWTH} times as many pixels as the image; leave out --grow, or mask the warp"
        ))),
    }
}

/// How many pixels of the result have no place, or several.
#[derive(Default)]
pub(super) struct Counts {
    pub(super) pixels: usize,
    pub(super) lost: usize,
    pub(super) folded: usize,
}

/// What shows of that which lies outside of an image without alpha.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Outside {
    /// Nothing.
    Unseen,
    /// It is transparent, by an alpha channel that the result has got.
    Alpha,
    /// It is black, because the format holds no alpha.
    Black,
}

/// All layers drawn, and the maps that they were drawn through.
pub(super) struct Drawn {
    pub(super) counts: Counts,
    pub(super) maps: Vec<(PixelMap, Option<HierarchyReport>)>,
    pub(super) edge: Edge,
    pub(super) outside: Outside,
}

/// The channels of a layer that are drawn.
fn mixed(layer: &ImageLayer) -> Vec<&str> {
    let mixed = |c: &&Channel| c.sample() != SampleType::Integer32;
    let mixed = layer.channels().iter().filter(mixed);
    mixed.map(Channel::name).collect()
}

/// The image with other channels in a layer.
fn rearrange(image: &mut ImageFile, layer: usize, names: &[&str]) -> Result<(), Failure> {
    let rest = image.without_pixels();
    let whole = std::mem::replace(image, rest);
    *image = whole
        .with_channels(layer, names)
        .map_err(|error| Failure::new(error.to_string()))?;
    Ok(())
}

/// Gives layers of colours coverage where what is outside is asked to be transparent; says which, with the channels they had.
fn cover(
    image: &mut ImageFile,
    drawing: &Drawing<'_>,
    edges: &[Edge],
) -> Result<Vec<(usize, Vec<String>)>, Failure> {
    let asked = drawing.options.grow || drawing.options.pixels.edge.is_some();
    let mut given = Vec::new();
    for (number, edge) in edges.iter().enumerate() {
        let layer = &image.layers()[number];
        let is_colour = |c: &Channel| c.kind() == ChannelKind::Colour && !c.name().contains('.');
        if !asked
            || *edge != Edge::Transparent
            || layer.has_alpha()
            || !layer.channels().iter().any(is_colour)
        {
            continue;
        }
        let own: Vec<String> = mixed(layer).into_iter().map(str::to_owned).collect();
        let mut names: Vec<&str> = own.iter().map(String::as_str).chain(["A"]).collect();
        if image.format() == ImageFormat::OpenExr {
            names.sort_unstable();
        }
        rearrange(image, number, &names)?;
        given.push((number, own));
    }
    Ok(given)
}

/// Takes coverage back where nothing outside is seen, or where the format cannot hold it.
fn uncover(
    image: &mut ImageFile,
    given: Vec<(usize, Vec<String>)>,
    format: ImageFormat,
) -> Result<Outside, Failure> {
    let mut outside = Outside::Unseen;
    for (number, own) in given {
        let layer = &image.layers()[number];
        let alpha = mixed(layer).iter().position(|name| *name == "A");
        let (Some(raster), Some(alpha)) = (&layer.raster, alpha) else {
            continue;
        };
        let pixels = raster.samples().chunks_exact(raster.channels());
        let seen = pixels.into_iter().any(|pixel| pixel[alpha] < COVERED);
        if seen && format != ImageFormat::Jpeg {
            outside = Outside::Alpha;
            continue;
        }
        if seen {
            outside = Outside::Black;
        }
        let own: Vec<&str> = own.iter().map(String::as_str).collect();
        rearrange(image, number, &own)?;
    }
    Ok(outside)
}

fn draw(
    image: &mut ImageFile,
    ways: &Ways,
    drawing: &Drawing<'_>,
    given: Option<PixelMap>,
    format: ImageFormat,
) -> Result<Drawn, Failure> {
    let given_window = given.as_ref().map(PixelMap::window);
    let mut drawn = Drawn {
        counts: Counts::default(),
        maps: given.map(|map| (map, None)).into_iter().collect(),
        edge: Edge::Clamp,
        outside: Outside::Unseen,
    };
    let display = image.display();
    let mut targets = Vec::new();
    for layer in image.layers() {
        let source = layer.window().unwrap_or(display);
        let window = match given_window {
            Some(window) => window,
            None => target(drawing, ways.forward.as_ref(), source, image)?,
        };
        targets.push((window, drawing.edge(layer, display)?));
    }
    let edges: Vec<Edge> = targets.iter().map(|(_, edge)| *edge).collect();
    let covered = cover(image, drawing, &edges)?;
    for (layer, (window, edge)) in image.layers_mut().iter_mut().zip(targets) {
        drawn.edge = edge;
        if drawing.is_forward() {
            draw_forward(layer, ways, window, &mut drawn.counts)?;
            continue;
        }
        let known = drawn
            .maps
            .iter()
            .position(|(map, _)| map.window() == window);
        let at = match known {
            Some(at) => at,
            None => {
                let new = drawing
                    .map(ways.back.as_ref(), window)
                    .map_err(Failure::new)?;
                drawn.maps.push(new);
                drawn.maps.len() - 1
            }
        };
        let map = &drawn.maps[at].0;
        let placeless = map.offsets().iter();
        let placeless = placeless.filter(|[x, y]| !(x.is_finite() && y.is_finite()));
        drawn.counts.lost += placeless.count();
        drawn.counts.pixels += map.offsets().len();
        for (raster, filter) in [
            (&mut layer.raster, drawing.filter),
            (&mut layer.identifiers, Filter::NEAREST),
        ] {
            if let Some(source) = raster {
                *source = resample(source, map, filter, edge).map_err(Failure::new)?;
            }
        }
    }
    drawn.outside = uncover(image, covered, format)?;
    Ok(drawn)
}

/// Moves a layer's pixels.
fn draw_forward(
    layer: &mut ImageLayer,
    ways: &Ways,
    window: Window,
    counts: &mut Counts,
) -> Result<(), Failure> {
    if layer.identifiers.is_some() {
        return Err(Failure::new(
            "forward mapping mixes pixels, and a layer has channels of whole numbers that must not be mixed; leave out \
             --mapping forward",
        ));
    }
    let Some(source) = &layer.raster else {
        return Ok(());
    };
    let done = splat(
        source,
        ways.forward.as_ref(),
        window,
        SplatOptions::default(),
    );
    let done = done.map_err(Failure::new)?;
    counts.pixels += done.layers.len();
    counts.lost += done.layers.iter().filter(|&&layers| layers == 0).count();
    counts.folded += done.layers.iter().filter(|&&layers| layers > 1).count();
    layer.raster = Some(done.raster);
    Ok(())
}

/// The format to be written.
fn output_format(job: &Job, image: &ImageFile) -> Result<ImageFormat, Failure> {
    if let Some(format) = named_format(&job.output) {
        return Ok(format);
    }
    let extension = job.output.extension().and_then(|e| e.to_str());
    let extension = extension.map(str::to_ascii_lowercase).unwrap_or_default();
    let known = anamorph_io::formats().iter();
    if let Some(other) = known
        .clone()
        .find(|f| f.extensions().contains(&extension.as_str()))
    {
        let names: Vec<&str> = ImageFormat::ALL
            .into_iter()
            .map(ImageFormat::name)
            .collect();
        return Err(Failure::new(format!(
            "{}: an image cannot become {}; name the output one of these: .{}",
            job.output.display(),
            other.name().to_uppercase(),
            names.join(", .")
        )));
    }
    if !extension.is_empty() && !files::is_stream(&job.output) {
        say!(
            "{}: .{extension} is the name of no format that is written; the file is {}",
            job.output.display(),
            image.format().title()
        );
    }
    Ok(image.format())
}

/// Reads an image within the limits that are allowed.
pub(super) fn decoded(
    name: &str,
    bytes: &[u8],
    options: &ImageOptions,
) -> Result<ImageFile, Failure> {
    let limits = if options.pixels.allow_large {
        ImageLimits::NONE
    } else {
        ImageLimits::of_file(bytes.len())
    };
    ImageFile::read(bytes, limits).map_err(|error| {
        let mut message = format!("{name}: {error}");
        if matches!(error, anamorph_io::images::ImageError::TooLarge { .. }) {
            message.push_str(" with --allow-large");
        }
        Failure::new(message)
    })
}

/// The picture before and after, with the warp's features, and a grid that moves along.
fn preview(
    run: &Run<'_>,
    built: &BuiltRecipe<Plane>,
    ways: &Ways,
    inverted: bool,
    shown: Window,
    [before, after]: [&Raster; 2],
) -> Result<Vec<u8>, Failure> {
    let view = &run.options.view;
    let size = view.size.unwrap_or((1600, 900));
    let mut panels = Panels::new(size, view.theme, shown, 2)?;
    panels.image(0, before)?;
    panels.image(1, after)?;
    let over = before.window();
    panels.grid(0, over, &Affine::IDENTITY);
    if run.options.image.from_stmap.is_none() {
        panels.grid(1, over, ways.forward.as_ref());
    }
    let (mut sources, mut targets) = picture::marks(built);
    if inverted {
        std::mem::swap(&mut sources, &mut targets);
    }
    panels.marks(0, &sources);
    panels.marks(1, &targets);
    panels.png()
}

/// Warps the image that a file holds.
pub(super) fn warp(job: &Job, run: &Run<'_>, bytes: &[u8]) -> Result<(), Failure> {
    check(job, run.options)?;
    let image = decoded(&files::shown(&job.model), bytes, &run.options.image)?;
    warp_image(job, run, image)
}

/// An image after its warp, and what has been found out on the way.
struct Warped {
    built: BuiltRecipe<Plane>,
    ways: Ways,
    inverted: bool,
    /// Points of the display window, and its size.
    points: Vec<Plane>,
    size: f64,
    drawn: Drawn,
}

/// Draws an image as the recipe has it, for a format.
fn warped(
    name: &str,
    run: &Run<'_>,
    image: &mut ImageFile,
    drawing: &Drawing<'_>,
    format: ImageFormat,
) -> Result<Warped, Failure> {
    let options = run.options;
    let wrong = |error: &dyn core::fmt::Display| Failure::new(format!("{name}: {error}"));
    let display = image.display();
    let points = lattice(display);
    let size = model::size(&points);
    let built = build(run, &points)?;
    if built.stack().domain() == Domain::Model {
        return Err(wrong(
            &"the recipe reads attributes of a model's points, which pixels do not have; leave them out",
        ));
    }
    let inverted = run.recipe.is_inverse() != options.invert;
    let ways = Ways::new(&built, inverted, size);
    let given = options.image.from_stmap.as_deref();
    let given = given.map(|path| read_stmap(path, display)).transpose()?;
    let (given, shown) = given.unzip();
    let drawn = draw(image, &ways, drawing, given, format)?;
    if let Some(shown) = shown {
        // The picture is where the map is.
        image.set_display(shown).map_err(|error| wrong(&error))?;
    }
    Ok(Warped {
        built,
        ways,
        inverted,
        points,
        size,
        drawn,
    })
}

/// The fingerprints of all files that the recipe and the options name beside the image.
pub(super) fn fingerprints(run: &Run<'_>, image: &ImageFile) -> Result<Vec<String>, Failure> {
    // What a recipe reads is known when it is built.
    build(run, &lattice(image.display()))?;
    let read = run.beside.fingerprints().into_iter();
    let mut prints: Vec<u64> = read.map(|(_, print)| print).collect();
    if let Some(map) = &run.options.image.from_stmap {
        prints.push(files::fingerprint(&files::read(map)?).0);
    }
    Ok(prints.iter().map(|print| format!("{print:016x}")).collect())
}

/// An image as a frame of a film.
pub(super) fn film_frame(
    job: &Job,
    run: &Run<'_>,
    mut image: ImageFile,
) -> Result<ImageFile, Failure> {
    let drawing = Drawing::of(&run.options.image)?;
    warped(
        &files::shown(&job.model),
        run,
        &mut image,
        &drawing,
        ImageFormat::Png,
    )?;
    Ok(image)
}

/// Warps an image.
pub(super) fn warp_image(job: &Job, run: &Run<'_>, mut image: ImageFile) -> Result<(), Failure> {
    let options = run.options;
    let name = files::shown(&job.model);
    let drawing = Drawing::of(&options.image)?;
    let wrong = |error: &dyn core::fmt::Display| Failure::new(format!("{name}: {error}"));
    let format = output_format(job, &image)?;
    run.beside
        .refuse_replacing(job.results().map(|(path, _)| path))?;
    let maps = [&options.image.stmap, &options.image.motion_vectors];
    run.beside.refuse_replacing(maps.into_iter().flatten())?;

    let display = image.display();
    let sources: Vec<Option<Window>> = image.layers().iter().map(ImageLayer::window).collect();
    let source = sources.into_iter().flatten().next().unwrap_or(display);
    let before = job.preview.as_ref().map(|_| image.light()).transpose();
    let before = before.map_err(|error| wrong(&error))?;
    let warped = warped(&name, run, &mut image, &drawing, format)?;
    let Warped {
        built, ways, drawn, ..
    } = &warped;

    let mut files = Vec::new();
    let mut begin = |path: &PathBuf| -> Result<usize, Failure> {
        files.push(Pending::create(path, run.replace)?);
        Ok(files.len() - 1)
    };
    let encoding = EncodeOptions {
        quality: options.image.pixels.quality.unwrap_or(95),
        whole: options.image.grow,
    };
    let (content, lost) = image
        .encode(format, &encoding)
        .map_err(|error| wrong(&error))?;
    let mut contents = Vec::new();
    if let Some(path) = &options.image.stmap {
        let own;
        let map = match drawn.maps.first() {
            Some((map, _)) => map,
            None => {
                own = drawing
                    .map(ways.back.as_ref(), display)
                    .map_err(Failure::new)?;
                &own.0
            }
        };
        contents.push((begin(path)?, exr(&stmap(map, display)?)?));
    }
    if let Some(path) = &options.image.motion_vectors {
        let vectors = motion(ways.forward.as_ref(), source, display)?;
        contents.push((begin(path)?, exr(&vectors)?));
    }
    if let (Some(path), Some(before)) = (&job.preview, &before) {
        let after = image.light().map_err(|error| wrong(&error))?;
        let shown = if options.image.grow {
            display
                .union(&after.window())
                .map_err(|error| wrong(&error))?
        } else {
            display
        };
        let png = preview(run, built, ways, warped.inverted, shown, [before, &after])?;
        contents.push((begin(path)?, png));
    }
    if let Some(path) = &job.report {
        let value = report(job, built, &image, format, &drawing, drawn, &lost);
        let text = serde_json::to_string_pretty(&value).map_err(Failure::new)?;
        contents.push((begin(path)?, format!("{text}\n").into_bytes()));
    }
    contents.push((begin(&job.output)?, content));
    for (at, content) in contents {
        files[at].fill(|out| out.write_all(&content))?;
    }
    files::keep_all(files)?;
    if !options.quiet {
        summary(job, run, built, &image, format, &drawing, drawn, &lost);
        if let Some(fold) = fold(built, &warped.points, warped.size) {
            say!("  warning: {fold}; `anamorph check` says more");
        }
    }
    Ok(())
}

fn exr(image: &ImageFile) -> Result<Vec<u8>, Failure> {
    let encoded = image.encode(ImageFormat::OpenExr, &EncodeOptions::default());
    encoded.map(|(bytes, _)| bytes).map_err(Failure::new)
}
