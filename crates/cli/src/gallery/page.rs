//! The page itself, as HTML for browsers and as Markdown for the documentation.

use super::plots::plot;
use super::scenes::Part;
use super::{Promised, Shown, curves, images, motions, shapes};
use anamorph_fields::FALLOFFS;
use std::fmt::Write;

/// Text that stands for itself in HTML, in attributes too.
pub(super) fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            c => escaped.push(c),
        }
    }
    escaped
}

/// A recipe with comments and headings of tables marked.
pub(super) fn highlighted(recipe: &str) -> String {
    let mut html = String::new();
    for line in recipe.trim_end().lines() {
        // A `#` after an even number of quotes begins a comment; recipes here have no escaped quotes.
        let quotes = |end: usize| line[..end].matches('"').count();
        let comment = line.match_indices('#').map(|(at, _)| at);
        let comment = comment.filter(|&at| quotes(at).is_multiple_of(2)).min();
        let (code, comment) = line.split_at(comment.unwrap_or(line.len()));
        if code.trim_start().starts_with('[') {
            let _ = write!(html, "<span class=\"table\">{}</span>", escape(code));
        } else {
            html.push_str(&escape(code));
        }
        if !comment.is_empty() {
            let _ = write!(html, "<span class=\"comment\">{}</span>", escape(comment));
        }
        html.push('\n');
    }
    html
}

fn promises_html(all: &[Promised]) -> String {
    let mut html = String::from("<div class=\"promises\">");
    for promised in all {
        if all.len() > 1 {
            let _ = write!(html, "<h4>{}</h4>", escape(&promised.title));
        }
        html.push_str("<dl>");
        for [verdict, property, statement] in &promised.rows {
            let _ = write!(
                html,
                "<dt><span class=\"{0}\">{0}</span>{1}</dt><dd>{2}</dd>",
                escape(verdict),
                escape(property),
                escape(statement)
            );
        }
        html.push_str("</dl>");
        for note in &promised.notes {
            let _ = write!(html, "<p class=\"note\">{}</p>", escape(note));
        }
    }
    html.push_str("</div>");
    html
}

/// The name over a scene: its kind, or what it is called where it has several.
fn title(shown: &Shown) -> String {
    match shown.kinds.as_slice() {
        [kind] if shown.scene.name == *kind => kind.clone(),
        [kind] => format!("{kind} ({})", shown.scene.name),
        _ => shown.scene.name.to_owned(),
    }
}

/// What is drawn, for those who cannot see it.
fn alternative(shown: &Shown) -> String {
    format!(
        "A model before and after the warp {}, with source features in orange and targets in blue",
        title(shown)
    )
}

fn where_from(shown: &Shown) -> String {
    if shown.figure.is_empty() {
        String::new()
    } else {
        format!("framework paper, {}", shown.figure)
    }
}

fn scene_html(shown: &Shown) -> String {
    let [light, dark] = &shown.pictures;
    let (width, height) = shown.size;
    let name = shown.scene.name;
    let picture = |class: &str, file: &str| {
        format!(
            "<img class=\"{class}\" src=\"{file}\" width=\"{width}\" height=\"{height}\" loading=\"lazy\" alt=\"{}\">",
            escape(&alternative(shown))
        )
    };
    format!(
        "<article id=\"{name}\"><div class=\"head\"><h3><a href=\"#{name}\">{title}</a></h3>\
         <span class=\"figure\">{from}</span></div>\
         <div class=\"text\"><p>{summary}</p>{reference}</div>\
         <figure class=\"picture\">{light}{dark}<figcaption>{credit}. Before and after; sources orange, targets blue.\
         </figcaption></figure>\
         <div class=\"two\"><div class=\"recipe\"><div class=\"bar\"><span>{name}.toml</span>\
         <button type=\"button\">Copy</button></div><pre><code>{recipe}</code></pre></div>\
         {promises}</div></article>\n",
        title = escape(&title(shown)),
        from = escape(&where_from(shown)),
        summary = escape(&sentence(&shown.summary)),
        reference = if shown.reference.is_empty() {
            String::new()
        } else {
            format!("<p class=\"reference\">{}</p>", escape(&shown.reference))
        },
        light = picture("light", light),
        dark = picture("dark", dark),
        credit = escape(shown.scene.exhibit.credit),
        recipe = highlighted(shown.scene.recipe),
        promises = promises_html(&shown.promises),
    )
}

/// A summary as a sentence.
fn sentence(text: &str) -> String {
    let mut characters = text.chars();
    match characters.next() {
        Some(first) => format!("{}{}.", first.to_uppercase(), characters.as_str()),
        None => String::new(),
    }
}

/// Every falloff: its curve, its class and its reach.
fn falloffs_html() -> String {
    let mut html = String::new();
    for falloff in FALLOFFS {
        let label = format!("the falloff {} over the relative distance", falloff.name());
        let svg = plot(
            &label,
            [0.0, 1.5],
            [0.0, 1.25],
            &[0.0, 0.5, 1.0, 1.5],
            |t| falloff.value(t),
        );
        let reach = match falloff.reach() {
            Some(reach) => format!("0 from {reach} radii on"),
            None => "reaches everywhere".to_owned(),
        };
        let _ = writeln!(
            html,
            "<figure>{svg}<figcaption><b>{}</b><br>{}, {reach}</figcaption></figure>",
            escape(falloff.name()),
            escape(&falloff.smoothness().to_string()),
        );
    }
    html
}

const ABOUT: &str = "Every warp that a recipe can name, on a real model. Source features are orange, targets blue, as in \
    Milliron, Jensen, Barzel and Finkelstein, A Framework for Geometric Warps and Deformations (ACM Transactions on Graphics \
    21(1), 2002), whose order and figure numbers this page keeps. What a warp promises is proved, refuted or unknown; nothing \
    is guessed.";

const CURVES: &str = "Every family of curves, with the same seven points.";
const EASES: &str = "How the share of the distance grows with the share of the time.";
const ORIENTATIONS: &str = "Every orientation on the same path: forward blue, up green, left red; then ways from key to key, and \
    what changes frames.";

/// The page.
pub(super) fn html(
    parts: &[(&Part, Vec<Shown>)],
    pixels: &[images::Shown],
    between: &[shapes::Shown],
    moving: &[motions::Shown],
) -> String {
    let mut html = String::from(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>anamorph: gallery</title>\n<style>\n",
    );
    html.push_str(include_str!("page.css"));
    html.push_str("</style>\n</head>\n<body>\n<header>\n<h1>anamorph gallery</h1>\n");
    html.push_str("<button class=\"theme\" type=\"button\">Light / dark</button>\n");
    let _ = write!(html, "<p class=\"about\">{}</p>\n<nav>", escape(ABOUT));
    for shown in parts.iter().flat_map(|(_, shown)| shown) {
        let name = shown.scene.name;
        let _ = write!(html, "<a href=\"#{name}\">{}</a>", escape(name));
    }
    for name in ["falloffs", "curves", "eases", "orientations", "motions"] {
        let _ = write!(html, "<a href=\"#{name}\">{name}</a>");
    }
    html.push_str("</nav>\n</header>\n<main>\n");
    for (part, scenes) in parts {
        let _ = writeln!(
            html,
            "<section><h2>{}</h2><p class=\"about\">{}</p>",
            escape(part.title),
            escape(part.about)
        );
        for shown in scenes {
            html.push_str(&scene_html(shown));
        }
        html.push_str("</section>\n");
    }
    let _ = write!(
        html,
        "<section id=\"falloffs\"><h2>Falloffs</h2><p class=\"about\">How influence fades with the distance from a feature, \
         in radii. The class is that of the whole function of space, the feature's own place included.</p>\
         <div class=\"plots\">\n{}</div></section>\n",
        falloffs_html()
    );
    for (id, title, about, plots) in [
        ("curves", "Curves", CURVES, curves::families_html()),
        ("eases", "Eases", EASES, curves::eases_html()),
        (
            "orientations",
            "Orientations",
            ORIENTATIONS,
            curves::orientations_html(),
        ),
    ] {
        let _ = writeln!(
            html,
            "<section id=\"{id}\"><h2>{title}</h2><p class=\"about\">{}</p><div class=\"plots\">\n{plots}</div></section>",
            escape(about)
        );
    }
    let _ = write!(
        html,
        "<section id=\"images\"><h2>Images</h2><p class=\"about\">{}</p>\n{}</section>\n",
        escape(images::ABOUT),
        images::html(pixels)
    );
    let _ = write!(
        html,
        "<section id=\"shapes\"><h2>Shapes</h2><p class=\"about\">{}</p>\n{}</section>\n",
        escape(shapes::ABOUT),
        shapes::html(between)
    );
    let _ = write!(
        html,
        "<section id=\"motions\"><h2>Motions</h2><p class=\"about\">{}</p>\n{}</section>\n</main>\n",
        escape(motions::ABOUT),
        motions::html(moving)
    );
    let _ = write!(
        html,
        "<footer>Made by anamorph {} with <code>anamorph gallery</code>.</footer>\n<script>\n{}</script>\n</body>\n</html>\n",
        env!("CARGO_PKG_VERSION"),
        include_str!("page.js")
    );
    html
}

/// The same for the documentation: pictures in the light, recipes by their files.
pub(super) fn markdown(
    parts: &[(&Part, Vec<Shown>)],
    pixels: &[images::Shown],
    between: &[shapes::Shown],
    moving: &[motions::Shown],
) -> String {
    let mut text = format!(
        "# Gallery\n\nWritten by `cargo xtask gallery`. {ABOUT} `anamorph gallery --out DIR` makes the same as a page with \
         recipes to copy, promises and plots.\n"
    );
    for (part, scenes) in parts {
        let _ = write!(text, "\n## {}\n\n{}\n", part.title, part.about);
        for shown in scenes {
            let from = where_from(shown);
            let _ = write!(
                text,
                "\n### `{}`\n\n{}{}{}\n\n![{}]({})\n\nRecipe: [{name}.toml](recipes/{name}.toml). Model: {}.\n",
                title(shown),
                sentence(&shown.summary),
                if from.is_empty() { "" } else { " In the " },
                if from.is_empty() {
                    String::new()
                } else {
                    format!("{from}.")
                },
                alternative(shown),
                shown.pictures[0],
                shown.scene.exhibit.credit,
                name = shown.scene.name,
            );
        }
    }
    text.push_str(&images::markdown(pixels));
    text.push_str(&shapes::markdown(between));
    text.push_str(&motions::markdown(moving));
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn recipes_are_marked_and_escaped() {
        let html = highlighted("a = \"#1 <b>\" # why & how\n[[warp]]\nb = 2\n");
        assert_eq!(
            html,
            "a = &quot;#1 &lt;b&gt;&quot; <span class=\"comment\"># why &amp; how</span>\n\
             <span class=\"table\">[[warp]]</span>\nb = 2\n"
        );
    }

    #[test]
    fn every_falloff_is_plotted() {
        let html = falloffs_html();
        assert_eq!(html.matches("<svg").count(), FALLOFFS.len());
        for falloff in FALLOFFS {
            assert!(html.contains(&format!("<b>{}</b>", falloff.name())));
        }
    }
}
