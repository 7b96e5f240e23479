//! Hard settings of every registered warp, as recipes write them.

use crate::subjects::Registered;
use anamorph_core::Scaling;
use anamorph_fields::falloffs::{FALLOFFS, Falloff};

/// A warp's kind with parameters.
#[derive(Debug, Clone)]
pub struct Setting {
    /// The registered kind.
    pub kind: &'static str,
    /// Its parameters as TOML.
    pub toml: String,
    /// The scaling method the recipe asks for.
    pub scaling: Option<Scaling>,
    /// Whether it is the registry's own example.
    pub example: bool,
}

/// Both scaling methods.
const BOTH: [Option<Scaling>; 2] = [Some(Scaling::Displacement), Some(Scaling::Composition)];

/// Names of the falloffs that end.
fn compact() -> Vec<&'static str> {
    let all = FALLOFFS.iter().copied().filter(Falloff::compact);
    all.map(Falloff::name).collect()
}

/// Collects settings; text may use `«a;b;c»` for a list with one entry per axis of the space, and `~…~` around what
/// only space has (such as the axis of a turn).
struct List<S> {
    all: Vec<Setting>,
    space: core::marker::PhantomData<S>,
}

impl<S: Registered> List<S> {
    fn text(text: &str) -> String {
        let mut out = String::new();
        let mut rest = text;
        while let Some(at) = rest.find(['«', '~']) {
            out.push_str(&rest[..at]);
            if let Some(tail) = rest[at..].strip_prefix('«') {
                let end = tail.find('»').expect("a closing mark");
                let entries: Vec<&str> = tail[..end].split(';').take(S::DIM).collect();
                out.push('[');
                out.push_str(&entries.join(","));
                out.push(']');
                rest = &tail[end + '»'.len_utf8()..];
            } else {
                let tail = &rest[at + 1..];
                let end = tail.find('~').expect("a closing tilde");
                if S::DIM == 3 {
                    out.push_str(&tail[..end]);
                }
                rest = &tail[end + 1..];
            }
        }
        out.push_str(rest);
        out
    }

    fn add(&mut self, kind: &'static str, scalings: &[Option<Scaling>], text: &str) {
        for &scaling in scalings {
            self.all.push(Setting {
                kind,
                toml: Self::text(text),
                scaling,
                example: false,
            });
        }
    }
}

/// The registry's examples and the hard settings.
pub fn settings<S: Registered>() -> Vec<Setting> {
    let mut list = List::<S> {
        all: Vec::new(),
        space: core::marker::PhantomData,
    };
    for entry in S::registry() {
        list.all.push(Setting {
            kind: entry.kind,
            toml: entry.example.to_owned(),
            scaling: None,
            example: true,
        });
    }
    features(&mut list);
    lattices(&mut list);
    axes(&mut list);
    lines(&mut list);
    meshes(&mut list);
    curves(&mut list);
    radial(&mut list);
    scodef(&mut list);
    multilevel(&mut list);
    list.all
}

fn scodef<S: Registered>(list: &mut List<S>) {
    // Overlapping, apart, one within another; two in one place; so near to each other that they depend.
    let spread = "point = [{ from = \"20%\", by = «\"9%\";0;\"3%\"» }, { from = «\"60%\";\"20%\";\"50%\"», by = \"7%\", radius = \"15%\" }, \
         { from = «\"65%\";\"30%\";\"45%\"» }, { from = \"85%\", by = «0;\"-6%\";\"5%\"», radius = \"60%\" }]";
    let twice = "point = [{ from = \"40%\", by = \"5%\" }, { from = \"40%\", by = \"5%\" }, \
         { from = \"70%\", by = «\"-4%\";\"3%\";0» }, { from = \"70%\", by = «\"-4%\";\"3%\";0», radius = \"20%\" }]";
    let near = "point = [{ from = \"50%\", by = \"5%\" }, { from = \"50.00000001%\", by = «\"5%\";\"-4%\";0» }, { from = \"80%\" }]";
    for points in [spread, twice, near] {
        list.add("scodef", &[None], &format!("radius = \"35%\"\n{points}"));
        for more in ["", "basis = \"box\"\n"] {
            list.add(
                "scodef",
                &[None],
                &format!("{more}radius = \"90%\"\n{points}"),
            );
        }
        list.add(
            "scodef",
            &[None],
            &format!("basis = \"box\"\nradius = «\"50%\";\"20%\";\"70%\"»\n{points}"),
        );
    }
}

fn multilevel<S: Registered>(list: &mut List<S>) {
    let points = "point = [{ from = \"15%\", by = «\"9%\";0;\"3%\"» }, { from = «\"60%\";\"20%\";\"50%\"», by = \"7%\" }, \
         { from = «\"62%\";\"23%\";\"47%\"» }, { from = \"85%\", by = «0;\"-6%\";\"5%\"» }]";
    for how in [
        "",
        "levels = 1",
        "levels = 4\nfaces = \"still\"",
        "margin = 0\ntolerance = \"1%\"",
        "levels = 3\nbox = { min = \"-20%\", max = \"130%\" }",
        "levels = 4\none_to_one = true",
        "levels = 2\none_to_one = true\nmargin = \"50%\"",
    ] {
        list.add("multilevel", &[None], &format!("{how}\n{points}"));
    }
}

fn radial<S: Registered>(list: &mut List<S>) {
    // So many points within a radius that only those in reach are looked at, and that equations are sparse.
    for (count, more) in [(70, ""), (520, "affine = true\n")] {
        let mut random = crate::random::Random::new(count);
        let mut points = String::new();
        for _ in 0..count {
            let at: [f64; 3] = core::array::from_fn(|_| random.between(0.0, 100.0));
            let [x, y, z] = at.map(|x| format!("\"{x:.3}%\""));
            points += &format!("{{ from = «{x};{y};{z}», by = «\"1%\";0;\"-1%\"» }}, ");
        }
        list.add(
            "radial",
            &[None],
            &format!("kernel = \"wendland\"\nradius = \"15%\"\n{more}smoothing = 0.05\npoint = [{points}]"),
        );
    }
    // As many points as coefficients, and more.
    for (degree, count) in [(1, 4), (1, 12), (2, 16), (2, 30), (3, 40), (4, 60), (5, 90)] {
        let mut points = String::new();
        let mut random = crate::random::Random::new(count);
        for _ in 0..count {
            let at: [f64; 3] = core::array::from_fn(|_| random.between(0.0, 100.0));
            let by: [f64; 3] = core::array::from_fn(|_| random.between(-4.0, 4.0));
            let [x, y, z] = at.map(|x| format!("\"{x:.3}%\""));
            let [u, v, w] = by.map(|x| format!("\"{x:.3}%\""));
            points += &format!("{{ from = «{x};{y};{z}», by = «{u};{v};{w}» }}, ");
        }
        list.add(
            "polynomial",
            &[None],
            &format!("degree = {degree}\npoint = [{points}]"),
        );
    }
    if S::DIM == 2 {
        for cells in ["bilinear", "smooth"] {
            for text in [
                "columns = 2\nrows = 2\nmove = [{ index = [1, 0], by = [\"20%\", \"10%\"] }]",
                "columns = 5\nrows = [\"-10%\", \"20%\", \"35%\", \"110%\"]\nmove = [{ index = [\"*\", 1], by = [\"9%\", 0] }, \
                 { index = [2, 2], to = \"50%\" }, { index = [[0, 1], -1], turn = \"30deg\", scale = 0.9 }]",
                // The outer nodes stay; the outer two.
                "columns = 4\nrows = 5\nmove = [{ index = [[1, 2], 3], by = [\"6%\", \"-7%\"] }]",
                "columns = 6\nrows = [\"0%\", \"10%\", \"30%\", \"45%\", \"80%\", \"100%\"]\n\
                 move = [{ index = [[2, 3], 2], by = [\"3%\", \"-4%\"] }]",
            ] {
                list.add("grid", &[None], &format!("cells = \"{cells}\"\n{text}"));
            }
        }
    }
    let points = r#"point = [{ from = «"20%";"30%";"10%"», by = «"8%";"-5%";"6%"» }, { from = «"70%";"20%";"40%"» },
        { from = «"40%";"80%";"60%"», by = «"-10%";"4%";"3%"» }, { from = «"85%";"75%";"15%"», to = «"80%";"80%";"20%"» },
        { from = «"50%";"50%";"90%"», by = «0;"7%";"-9%"» }]"#;
    // One of them twice, and so near to another that it matters.
    let close = r#"point = [{ from = «"20%";"30%";"10%"», by = «"8%";"-5%";"6%"» }, { from = «"70%";"20%";"40%"» },
        { from = «"70%";"20%";"40%"» }, { from = «"70.01%";"20%";"40%"», by = «"0.003%";0;"0.002%"» },
        { from = «"40%";"80%";"60%"», by = «"-10%";"4%";"3%"» }, { from = «"85%";"75%";"15%"» }]"#;
    for points in [points, close] {
        list.add("thin-plate", &[None], points);
        list.add(
            "thin-plate",
            &[None],
            &format!("smoothing = 0.01\n{points}"),
        );
        for kernel in [
            "kernel = \"linear\"",
            "kernel = \"linear\"\naffine = false",
            "kernel = \"cubic\"",
            "kernel = \"thin-plate\"",
            "kernel = \"logarithmic\"",
            "kernel = \"gaussian\"\nwidth = \"25%\"",
            "kernel = \"gaussian\"\nwidth = \"40%\"\naffine = false\nsmoothing = 0.1",
            "kernel = \"multiquadric\"\nwidth = \"10%\"",
            "kernel = \"multiquadric\"\nwidth = \"20%\"\naffine = false",
            "kernel = \"inverse-multiquadric\"\nwidth = \"20%\"",
            "kernel = \"inverse-multiquadric\"\nwidth = \"30%\"\naffine = false",
            "kernel = \"wendland\"\nradius = \"35%\"",
            "kernel = \"wendland\"\nradius = \"120%\"\naffine = true",
        ] {
            list.add("radial", &[None], &format!("{kernel}\n{points}"));
        }
    }
    list.add(
        "radial",
        &[None],
        "kernel = \"wendland\"\nradius = \"30%\"\npoint = [{ from = \"60%\", by = «\"9%\";0;\"3%\"» }]",
    );
}

fn meshes<S: Registered>(list: &mut List<S>) {
    // A fan with a middle; a chain on a line with a loose vertex; all points told where to go.
    for more in [
        "",
        "uncovered = \"nearest\"\nmu = 0.5\n",
        "alpha = 0\nbeta = 0.4\ngamma = 0\nmu = 0.9\n",
    ] {
        list.add(
            "mesh",
            &[None],
            &format!(
                r#"{more}points = [«"50%";"50%";"50%"», «"10%";"20%";"30%"», «"90%";"25%";"40%"», «"60%";"95%";"50%"», «"30%";"70%";"90%"»]
                edges = [[0, 1], [0, 2], [0, 3], [4, 0], [1, 2], [3, 4]]
                move = [{{ index = 0, by = «"12%";"-9%";"5%"» }}, {{ index = 3, to = "80%" }}]"#
            ),
        );
        list.add(
            "mesh",
            &[None],
            &format!(
                r#"{more}points = ["10%", "40%", "80%", "90%"]
                edges = [[0, 1], [1, 2], [1, 2]]
                move = [{{ index = 1, by = «"10%";0;"3%"» }}]"#
            ),
        );
    }
}

fn features<S: Registered>(list: &mut List<S>) {
    // Shepard's method without end, one point pinned.
    list.add(
        "points",
        &[None],
        r#"point = [{ from = "25%", by = «"10%";"20%";"-5%"» }, { from = "75%" },
            { from = «"25%";"75%";"50%"», to = "50%" }]"#,
    );
    // Two features in one place.
    list.add(
        "points",
        &[None],
        r#"radius = "60%"
        point = [{ from = "40%", by = "10%" }, { from = "40%", by = "-20%" }, { from = "70%", by = «"9%";0;0» }]"#,
    );
    for falloff in compact() {
        // Reaches that overlap, end in each other, and one that ends nowhere near.
        list.add(
            "points",
            &[None],
            &format!(
                r#"falloff = "{falloff}"
                point = [{{ from = "30%", by = «"10%";"20%";"-5%"», radius = "25%" }},
                    {{ from = "60%", by = «"-10%";0;"5%"», radius = "40%" }},
                    {{ from = «"90%";"10%";"50%"», by = "5%", radius = "10%" }}]"#
            ),
        );
        list.add(
            "vortex",
            &BOTH,
            &format!(
                r#"centre = «"40%";"55%";"50%"»
                ~axis = [1, 2, -2]
                ~angle = "1.3turn"
                radius = "35%"
                falloff = "{falloff}""#
            ),
        );
    }
    // A mirror, a half turn, a shear, a pinned frame; with an end and without.
    for radius in ["", "radius = \"45%\"\n"] {
        let mirror = if S::DIM == 2 {
            "[[-1, 0], [0.2, 1]]"
        } else {
            "[[-1, 0, 0], [0.2, 1, 0], [0, 0.3, 1.2]]"
        };
        let skew = if S::DIM == 2 {
            "[[1, 0.5], [-0.3, 2]]"
        } else {
            "[[1, 0.5, 0], [-0.3, 2, 0], [0, 1, 1]]"
        };
        list.add(
            "frames",
            &BOTH,
            &format!(
                r#"{radius}
                frame = [{{ at = "25%", target_axes = {mirror} }},
                    {{ at = "70%", by = "5%", turn = "180deg"~, axis = [2, -1, 2]~ }},
                    {{ at = «"80%";"20%";"50%"», axes = {skew}, target_axes = {mirror} }},
                    {{ at = «"20%";"80%";"40%"» }}]"#
            ),
        );
    }
    list.add(
        "frames",
        &BOTH,
        r#"frame = [{ at = "50%", by = "3%", turn = "-200deg"~, axis = "x"~, scale = 0.4, radius = "70%",
            falloff = "smootherstep" }]"#,
    );
}

fn lattices<S: Registered>(list: &mut List<S>) {
    // All sizes alike, mixed, as large as allowed.
    let mut shapes: Vec<String> = (2..=9).map(|n| format!("«{n};{n};{n}»")).collect();
    shapes.extend(["«2;5;3»", "«9;2;4»", "«32;3;2»", "«3;12;10»"].map(str::to_owned));
    for shape in &shapes {
        list.add(
            "lattice",
            &[None],
            &format!(
                r#"shape = {shape}
                move = [{{ index = «"*";-1;"*"», by = «"25%";0;"7%"» }}, {{ index = «0;0;0», to = "10%" }},
                    {{ index = «[0, 1];"*";-1», turn = "50deg"~, axis = "y"~, scale = 1.3 }}]"#
            ),
        );
    }
    let skew = r#"box = { origin = «"5%";"-10%";"3%"»,
        edges = [«"90%";"20%";"5%"», «"-15%";"110%";0»~, [0, "25%", "85%"]~] }"#;
    let corners = r#"box = { min = "20%", max = "70%" }
        margin = "5%""#;
    for place in [skew, corners] {
        list.add(
            "lattice",
            &[None],
            &format!(
                r#"shape = «4;4;4»
                {place}
                move = [{{ index = «1;2;[1, 2]», by = "30%" }}, {{ index = «-1;"*";"*"», by = «"12%";0;0» }}]"#
            ),
        );
        // Two still planes at every face: C1 across it.
        list.add(
            "lattice",
            &[None],
            &format!(
                "shape = «6;5;7»\n{place}\nmove = [{{ index = «[2, 3];2;[2, 3, 4]», by = \"30%\" }}]"
            ),
        );
        for degree in 1..=5 {
            list.add(
                "spline-lattice",
                &[None],
                &format!(
                    r#"shape = «8;7;6»
                    degree = {degree}
                    knots = "{}"
                    {place}
                    move = [{{ index = «"*";-1;"*"», by = «"10%";"3%";0» }}, {{ index = «3;3;3», by = "20%" }}]"#,
                    if degree % 2 == 0 { "uniform" } else { "clamped" }
                ),
            );
        }
        list.add(
            "frame-lattice",
            &BOTH,
            &format!(
                r#"shape = «4;3;5»
                {place}
                frame = [{{ index = «1;1;[1, 2]», turn = "100deg"~, axis = [1, 1, 0]~, by = "10%" }},
                    {{ index = «-1;"*";0», scale = -0.6 }}]"#
            ),
        );
    }
    for degree in 1..=5 {
        for knots in ["uniform", "clamped"] {
            // A smallest lattice, one with a moved middle only, and one with many points.
            let smallest = degree + 1;
            for shape in [
                format!("«{smallest};{};{smallest}»", smallest + 1),
                "«9;8;7»".to_owned(),
                "«21;16;9»".to_owned(),
            ] {
                list.add(
                    "spline-lattice",
                    &[None],
                    &format!(
                        r#"shape = {shape}
                        degree = {degree}
                        knots = "{knots}"
                        move = [{{ index = «1;1;-2», by = "15%" }}, {{ index = «-2;"*";[0, 1]», scale = 0.7 }}]"#
                    ),
                );
            }
        }
    }
    list.add(
        "frame-lattice",
        &BOTH,
        r#"shape = «2;7;3»
        frame = [{ index = «0;3;1», turn = "300deg"~, axis = "z"~ }, { index = «0;3;1», by = "5%", scale = 2 }]"#,
    );
}

fn axes<S: Registered>(list: &mut List<S>) {
    let limits = [
        "",
        "range = [\"20%\", \"75%\"]\n",
        "range = [\"20%\", \"75%\"]\nlimits = \"smooth\"\n",
        "limits = \"smooth\"\nblend = 0.5\n",
    ];
    for limit in limits {
        let axis = format!("{limit}axis = «1;2;2»\ncentre = «\"45%\";\"50%\";\"60%\"»\n");
        list.add("taper", &BOTH, &format!("{axis}factor = -0.3"));
        list.add(
            "taper",
            &[None],
            &format!("{axis}profile = [[0, 1], [0.5, 0.6], [0.8, 1.4], [1, 1]]"),
        );
        list.add(
            "bend",
            &BOTH,
            &format!("{axis}toward = «1;0;0»\nangle = \"140deg\""),
        );
        list.add(
            "bend",
            &[None],
            &format!("{axis}toward = «-1;0;3»\nangle = \"-400deg\"\npivot = \"60%\""),
        );
        list.add(
            "bend",
            &[None],
            &format!("{axis}toward = «0;1;0»\nradius = \"150%\"\npivot = \"-40%\""),
        );
        list.add(
            "axial",
            &BOTH,
            &format!(
                "{axis}across = «1;0;0»\nscale = [[0, 1, 1], [0.4, 1.5, 0.5], [1, 1, 2]]\n\
                 ~turn = [[0, \"0deg\"], [0.3, \"80deg\"], [1, \"-20deg\"]]\n~\
                 shift = [[0, 0, 0, 0], [0.5, \"9%\", \"3%\", \"-6%\"], [1, 0, 0, \"4%\"]]"
            ),
        );
        if S::DIM == 3 {
            list.add(
                "twist",
                &BOTH,
                &format!("{axis}angle = \"500deg\"\nstart = \"-30deg\""),
            );
            list.add(
                "twist",
                &[None],
                &format!("{axis}profile = [[0, \"0deg\"], [0.5, \"90deg\"], [1, \"0deg\"]]"),
            );
        }
    }
    // Polynomials hold everywhere, or to the ends of a range.
    for range in ["", "range = [\"10%\", \"90%\"]\n"] {
        list.add(
            "taper",
            &BOTH,
            &format!("{range}axis = \"-y\"\npolynomial = [1, -0.3, 0.05]"),
        );
        if S::DIM == 3 {
            list.add(
                "twist",
                &BOTH,
                &format!("{range}axis = \"x\"\npolynomial = [0.1, 0.8, 0.2, -0.01]"),
            );
        }
    }
    list.add("taper", &[None], "axis = \"x\"\nprofile = [[0.3, 0.5]]");
}

fn lines<S: Registered>(list: &mut List<S>) {
    // All kinds of elements at once, oblique ones too; met exactly, nearly, hardly at all.
    let point = r#"{ source = ["10%"], by = «"10%";"-5%";"5%"» }"#;
    let segment = r#"{ source = [«"30%";"20%";"20%"», «"20%";"60%";"40%"»],
        target = [«"25%";"30%";"10%"», «"50%";"60%";"50%"»] }"#;
    let plate = r#"{ source = [«"60%";"20%";"30%"», «"90%";"25%";"30%"», «"65%";"50%";"35%"»],
        target = [«"60%";"10%";"30%"», «"80%";"40%";"40%"», «"50%";"50%";"25%"»] }"#;
    let solid = if S::DIM == 3 {
        r#", { source = [["55%", "65%", "60%"], ["85%", "65%", "60%"], ["55%", "90%", "65%"], ["60%", "65%", "90%"]],
            target = [["60%", "65%", "60%"], ["80%", "75%", "50%"], ["45%", "90%", "65%"], ["60%", "65%", "100%"]] }"#
    } else {
        ""
    };
    for constants in [
        "",
        "a = \"2%\"\nb = 1",
        "b = 1.5\np = 0.5",
        "a = \"30%\"\nb = 0.5\np = 1",
        "b = 0",
        "b = 3",
    ] {
        list.add(
            "elements",
            &BOTH,
            &format!("{constants}\nelement = [{point}, {segment}, {plate}{solid}]"),
        );
    }
    // One that turns half, one that loses its length, one without any, one with its own constants.
    list.add(
        "elements",
        &[None],
        r#"element = [{ source = ["40%", «"60%";"40%";"40%"»], target = ["40%", «"20%";"40%";"40%"»], b = 1 },
            { source = [«"30%";"80%";"30%"», «"70%";"80%";"30%"»], target = ["80%", "80%"], a = "5%" },
            { source = ["15%", "15%"], target = ["10%", "20%"] }]"#,
    );
    // Two in one place that part: the mean of both.
    list.add(
        "elements",
        &[None],
        r#"element = [{ source = ["40%"], by = "10%" }, { source = ["40%"], by = "-20%" },
            { source = ["70%", "90%"], by = «"9%";0;0» }]"#,
    );
    if S::DIM == 3 {
        return;
    }
    let chain = r#"line = [
        { source = [["20%", "30%"], ["50%", "40%"]], target = [["20%", "40%"], ["50%", "30%"]] },
        { source = [["50%", "40%"], ["80%", "25%"]], target = [["50%", "30%"], ["85%", "45%"]] },
        { source = [["30%", "80%"], ["70%", "75%"]] }]"#;
    let crossing = r#"line = [
        { source = [["20%", "50%"], ["80%", "50%"]], target = [["25%", "55%"], ["75%", "45%"]] },
        { source = [["48%", "22%"], ["55%", "85%"]], target = [["30%", "30%"], ["70%", "80%"]], b = 1, a = "4%" },
        { source = [["10%", "10%"], ["10%", "10%"]], by = "5%" }]"#;
    for kind in ["lines", "global-lines"] {
        for constants in [
            "",
            "a = \"3%\"",
            "b = 1\np = 1",
            "a = \"10%\"\nb = 1.25\np = 0.5",
        ] {
            for lines in [chain, crossing] {
                list.add(kind, &BOTH, &format!("{constants}\n{lines}"));
            }
        }
    }
}

fn curves<S: Registered>(list: &mut List<S>) {
    let first = r#"{ source = { kind = "bezier", points = [«"10%";"20%";"40%"», «"20%";"90%";"50%"», «"70%";"-10%";"60%"», «"90%";"80%";"50%"»] },
        target = { points = [«"0%";"50%";"40%"», «"60%";"60%";"80%"», «"110%";"30%";"50%"»] }"#;
    let second = r#"{ source = { kind = "b-spline", degree = 1, closed = true, points = [«"30%";"30%";"30%"», «"80%";"40%";"70%"», «"50%";"80%";"50%"»] },
        by = «"10%";"-5%";"3%"», scale = [[0, 1], [0.5, 1.7], [1, 1]]"#;
    let holds = r#"anchor = [{ curve = { points = [«"0%";"0%";"0%"», «"40%";"50%";"50%"»] }, radius = "12%" }]"#;
    let wires = |m1: f64, m2: f64| {
        format!(
            "wire = [{first}, radius = \"35%\", exponent = {m1} }}, {second}, radius = [[0, \"15%\"], [1, \"30%\"]], \
             exponent = {m2}, locality = 1.5 }}]\n{holds}\n"
        )
    };
    for (m1, m2) in [(1.0, 1.0), (0.0, 2.0), (-1.0, 0.5)] {
        list.add("wires", &[None], &wires(m1, m2));
        if S::DIM == 3 {
            let wires = wires(m1, m2);
            list.add(
                "depth-wires",
                &[None],
                &format!("view = [1, 2, 2]\n{wires}"),
            );
        }
    }
    // Where exponents differ a weight can fall below another's within less than any step of a measurement; where they are
    // negative it is a quotient by what rounding leaves.
    for (m, sampling) in [
        (1.0, "\"nearest\""),
        (1.0, "{ uniform = 24 }"),
        (0.0, "{ uniform = 40 }"),
        (2.0, "{ gauss-legendre = 12 }"),
    ] {
        let text = format!("{}sampling = {sampling}", wires(m, m));
        list.add("continuous-wires", &[None], &text);
        if S::DIM == 3 && m == 0.0 {
            list.add("depth-wires", &[None], &format!("view = \"y\"\n{text}"));
        }
    }
    // A wire whose directions are opposite, with a domain curve and a crimp; and one that stays.
    list.add(
        "wires",
        &[None],
        r#"radius = "40%"
        [[wire]]
        source = { kind = "general-bezier", points = [«"20%";"50%";"50%"», «"80%";"50%";"50%"»] }
        target = { kind = "general-bezier", points = [«"80%";"50%";"50%"», «"20%";"50%";"50%"»] }
        domain = { points = [«"20%";"90%";"50%"», «"80%";"70%";"50%"»] }
        crimp = [[0, 0], [0.5, 0.2], [1, 1]]
        [[wire]]
        source = { points = [«"50%";"0%";"50%"», «"50%";"100%";"40%"»] }"#,
    );
    let curve = r#"target = { points = [«"10%";"20%";"40%"», «"40%";"70%";"20%"», «"90%";"60%";"80%"», «"120%";"120%";"50%"»] }"#;
    let across = "~across = [1, 0, 0]\ntwist = [[0, \"0deg\"], [1, \"200deg\"]]\n~";
    for (reach, falloff) in [
        ("", ""),
        ("reach = [\"10%\", \"40%\"]\n", ""),
        ("reach = [0, \"30%\"]\n", "falloff = \"smootherstep\"\n"),
    ] {
        list.add(
            "axial-curve",
            &BOTH,
            &format!("{reach}{falloff}axis = «1;2;2»\ncentre = «\"45%\";\"50%\";\"60%\"»\n{across}scale = [[0, 1], [1, 0.5]]\n{curve}"),
        );
        list.add(
            "axial-curve",
            &[None],
            &format!("{reach}{falloff}axis = \"-y\"\nrange = [\"20%\", \"75%\"]\nlength = \"keep\"\n{curve}"),
        );
        list.add(
            "axial-curve",
            &[None],
            &format!("{reach}{falloff}source = {{ points = [«\"0%\";\"40%\";\"50%\"», «\"50%\";\"60%\";\"40%\"», «\"100%\";\"50%\";\"60%\"»] }}\n{curve}"),
        );
    }
}

/// Pairs of settings with the same source and other targets: a binding of the first serves the second.
pub fn retargetings<S: Registered>() -> Vec<[Setting; 2]> {
    let pairs: &[(&'static str, &str, &str, &str)] = &[
        (
            "points",
            "radius = \"50%\"\n",
            "point = [{ from = \"30%\", by = \"9%\" }, { from = \"60%\", by = \"-9%\" }]",
            "point = [{ from = \"30%\", to = \"50%\" }, { from = \"60%\" }]",
        ),
        (
            "frames",
            "",
            "frame = [{ at = \"30%\", by = \"9%\" }, { at = \"60%\", scale = 2 }]",
            "frame = [{ at = \"30%\", turn = \"70deg\"~, axis = \"y\"~ }, { at = \"60%\", scale = -1 }]",
        ),
        (
            "vortex",
            "centre = \"40%\"\nradius = \"40%\"\n~axis = [1, 2, 0]\n~",
            "angle = \"60deg\"",
            "angle = \"-1turn\"",
        ),
        (
            "lattice",
            "shape = «3;4;5»\n",
            "move = [{ index = «\"*\";-1;0», by = \"20%\" }]",
            "move = [{ index = «1;0;\"*\"», by = \"-20%\" }]",
        ),
        (
            "spline-lattice",
            "shape = «5;6;7»\nknots = \"clamped\"\n",
            "move = [{ index = «\"*\";-1;0», by = \"20%\" }]",
            "move = [{ index = «1;0;\"*\"», by = \"-20%\" }]",
        ),
        (
            "frame-lattice",
            "shape = «3;4;3»\n",
            "frame = [{ index = «\"*\";-1;0», by = \"20%\" }]",
            "frame = [{ index = «1;0;\"*\"», scale = 0.5 }]",
        ),
        (
            "elements",
            "b = 1\n",
            "element = [{ source = [\"30%\"], by = \"9%\" }, { source = [\"60%\", \"80%\"] }]",
            "element = [{ source = [\"30%\"] }, { source = [\"60%\", \"80%\"], target = [\"70%\", \"60%\"] }]",
        ),
        ("taper", "axis = «1;2;2»\n", "factor = 0.2", "factor = 2"),
        (
            "bend",
            "axis = «1;2;2»\nlimits = \"smooth\"\n",
            "toward = «1;0;0»\nangle = \"50deg\"",
            "toward = «0;1;0»\nradius = \"90%\"",
        ),
        (
            "mesh",
            "points = [\"20%\", \"60%\", «\"80%\";\"30%\";\"50%\"»]\nedges = [[0, 1], [1, 2]]\n",
            "move = [{ index = 1, by = \"9%\" }]",
            "move = [{ index = 0, by = \"-9%\" }, { index = 2, to = \"50%\" }]",
        ),
        (
            "wires",
            "radius = \"40%\"\nlocality = 1\n",
            "wire = [{ source = { points = [«\"20%\";\"30%\";\"50%\"», «\"80%\";\"60%\";\"40%\"»] }, by = \"9%\" }]",
            "wire = [{ source = { points = [«\"20%\";\"30%\";\"50%\"», «\"80%\";\"60%\";\"40%\"»] }, scale = 2, exponent = 2, \
             target = { points = [«\"90%\";\"30%\";\"50%\"», «\"30%\";\"60%\";\"70%\"», «\"0%\";\"60%\";\"70%\"»] } }]",
        ),
        (
            "continuous-wires",
            "radius = \"40%\"\nsampling = { uniform = 30 }\n",
            "wire = [{ source = { points = [«\"20%\";\"30%\";\"50%\"», «\"80%\";\"60%\";\"40%\"»] }, by = \"9%\" }]",
            "wire = [{ source = { points = [«\"20%\";\"30%\";\"50%\"», «\"80%\";\"60%\";\"40%\"»] }, scale = 2, exponent = 2, \
             target = { points = [«\"90%\";\"30%\";\"50%\"», «\"30%\";\"60%\";\"70%\"», «\"0%\";\"60%\";\"70%\"»] } }]",
        ),
        (
            "axial-curve",
            "axis = «1;2;2»\nreach = [\"10%\", \"50%\"]\n",
            "target = { points = [«\"20%\";\"30%\";\"50%\"», «\"80%\";\"60%\";\"40%\"»] }",
            "target = { points = [«\"20%\";\"90%\";\"50%\"», «\"80%\";\"60%\";\"40%\"», \"10%\"] }\nscale = 0.5",
        ),
        (
            "radial",
            "kernel = \"multiquadric\"\nwidth = \"20%\"\naffine = false\n",
            "point = [{ from = \"30%\", by = \"9%\" }, { from = «\"60%\";\"20%\";\"50%\"» }]",
            "point = [{ from = \"30%\" }, { from = «\"60%\";\"20%\";\"50%\"», by = \"9%\" }]",
        ),
        (
            "scodef",
            "radius = \"60%\"\n",
            "point = [{ from = \"30%\", by = \"9%\" }, { from = «\"60%\";\"20%\";\"50%\"» }]",
            "point = [{ from = \"30%\" }, { from = «\"60%\";\"20%\";\"50%\"», by = \"-12%\" }]",
        ),
        (
            "multilevel",
            "box = { min = \"-50%\", max = \"150%\" }\n",
            "point = [{ from = \"30%\", by = \"9%\" }, { from = «\"60%\";\"20%\";\"50%\"» }]",
            "point = [{ from = \"30%\" }, { from = «\"60%\";\"20%\";\"50%\"», by = \"-30%\" }]",
        ),
        (
            "polynomial",
            "degree = 1\n",
            "point = [{ from = \"30%\" }, { from = «\"60%\";\"20%\";\"50%\"» }, { from = «\"20%\";\"80%\";\"40%\"», by = \"9%\" }, \
             { from = «\"90%\";\"70%\";\"10%\"» }]",
            "point = [{ from = \"30%\", by = \"9%\" }, { from = «\"60%\";\"20%\";\"50%\"» }, { from = «\"20%\";\"80%\";\"40%\"» }, \
             { from = «\"90%\";\"70%\";\"10%\"», to = \"80%\" }]",
        ),
        (
            "thin-plate",
            "",
            "point = [{ from = \"30%\" }, { from = «\"60%\";\"20%\";\"50%\"» }, { from = «\"20%\";\"80%\";\"40%\"», by = \"9%\" }, \
             { from = «\"90%\";\"70%\";\"10%\"» }]",
            "point = [{ from = \"30%\", by = \"9%\" }, { from = «\"60%\";\"20%\";\"50%\"» }, { from = «\"20%\";\"80%\";\"40%\"» }, \
             { from = «\"90%\";\"70%\";\"10%\"», to = \"80%\" }]",
        ),
        (
            "axial",
            "axis = «1;2;2»\n",
            "scale = [[0, 1, 2], [1, 1, 1]]",
            "shift = [[0, 0, 0, 0], [1, 0, 0, \"5%\"]]",
        ),
    ];
    let solid: &[(&'static str, &str, &str, &str)] = &[(
        "twist",
        "axis = «1;2;2»\n",
        "angle = \"50deg\"",
        "polynomial = [0, 0.1]",
    )];
    let plane: &[(&'static str, &str, &str, &str)] = &[
        (
            "grid",
            "columns = 4\nrows = 3\ncells = \"smooth\"\n",
            "move = [{ index = [1, 1], by = \"9%\" }]",
            "move = [{ index = [\"*\", 0], by = \"-9%\" }]",
        ),
        (
            "lines",
            "a = \"3%\"\n",
            "line = [{ source = [\"20%\", [\"60%\", \"30%\"]], by = \"9%\" }]",
            "line = [{ source = [\"20%\", [\"60%\", \"30%\"]], target = [\"10%\", \"90%\"] }]",
        ),
        (
            "global-lines",
            "p = 1\n",
            "line = [{ source = [\"20%\", [\"60%\", \"30%\"]], by = \"9%\" }, { source = [\"70%\", \"90%\"] }]",
            "line = [{ source = [\"20%\", [\"60%\", \"30%\"]] }, { source = [\"70%\", \"90%\"], by = \"9%\" }]",
        ),
    ];
    let solid = if S::DIM == 3 { solid } else { plane };
    let setting = |kind, common: &str, own: &str| Setting {
        kind,
        toml: List::<S>::text(&format!("{common}{own}")),
        scaling: None,
        example: false,
    };
    pairs
        .iter()
        .chain(solid)
        .map(|(kind, common, a, b)| [setting(kind, common, a), setting(kind, common, b)])
        .collect()
}
