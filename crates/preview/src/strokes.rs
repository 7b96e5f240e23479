//! Letters and digits as lines, so that pictures need no font.
//!
//! The glyphs are our own, on a grid like that of A. V. Hershey's *Calligraphy for Computers*, 1967: the baseline is at 0,
//! small letters reach to 4, digits and tall letters to 6, below the baseline to −2.

/// Height of digits on the grid.
pub(crate) const HEIGHT: f64 = 6.0;
/// Free space between two glyphs.
const GAP: f64 = 1.7;
/// Width of a blank.
const BLANK: f64 = 2.2;

/// The strokes of a glyph: for each point a digit for x and one for y, counted from 2 below the baseline.
const GLYPHS: &[(char, &str)] = &[
    ('0', "12 03 07 18 38 47 43 32 12"),
    ('1', "06 28 22"),
    ('2', "07 18 38 47 45 02 42"),
    ('3', "08 48 25 35 44 43 32 12 03"),
    ('4', "32 38 04 44"),
    ('5', "48 08 05 35 44 43 32 12 03"),
    ('6', "38 18 06 03 12 32 43 44 35 15 04"),
    ('7', "08 48 12"),
    ('8', "15 06 07 18 38 47 46 35 15 04 03 12 32 43 44 35"),
    ('9', "12 32 44 47 38 18 07 06 15 35 46"),
    ('a', "16 36 45 42;44 14 03 12 32 43"),
    ('b', "08 02;05 16 36 45 43 32 12 03"),
    ('c', "45 36 16 05 03 12 32 43"),
    ('d', "48 42;45 36 16 05 03 12 32 43"),
    ('e', "04 44 45 36 16 05 03 12 32 43"),
    ('f', "38 28 17 12;06 36"),
    ('g', "46 41 30 10 01;45 36 16 05 03 12 32 43"),
    ('h', "08 02;05 16 36 45 42"),
    ('i', "02 06;07 08"),
    ('j', "16 11 00;17 18"),
    ('k', "08 02;46 04;15 42"),
    ('l', "08 03 12"),
    ('m', "06 02;05 16 26 35 32;35 46 56 65 62"),
    ('n', "06 02;05 16 36 45 42"),
    ('o', "16 05 03 12 32 43 45 36 16"),
    ('p', "06 00;05 16 36 45 43 32 12 03"),
    ('q', "46 40;45 36 16 05 03 12 32 43"),
    ('r', "06 02;05 16 36"),
    ('s', "45 36 16 05 14 34 43 32 12 03"),
    ('t', "18 13 22 32;06 36"),
    ('u', "06 03 12 32 43;46 42"),
    ('v', "06 22 46"),
    ('w', "06 12 25 32 46"),
    ('x', "06 42;46 02"),
    ('y', "06 22;46 10 00"),
    ('z', "06 46 02 42"),
    ('.', "02 03"),
    (',', "13 01"),
    (':', "02 03;05 06"),
    ('-', "05 35"),
    ('+', "05 45;23 27"),
    ('(', "18 06 04 12"),
    (')', "08 16 14 02"),
    ('/', "02 38"),
    ('%', "02 48;08 18 17 07 08;32 42 43 33 32"),
    ('=', "04 44;06 46"),
    ('<', "46 04 42"),
    ('>', "06 44 02"),
    ('·', "04 05"),
    ('°', "08 18 17 07 08"),
];

/// The strokes of a character; capitals are drawn as small letters, unknown ones as a box.
fn glyph(c: char) -> &'static str {
    let plain = match c.to_ascii_lowercase() {
        '–' | '−' => '-',
        'é' => 'e',
        'ü' => 'u',
        'ö' => 'o',
        'ä' => 'a',
        other => other,
    };
    let known = GLYPHS.iter().find(|(name, _)| *name == plain);
    known.map_or("02 42 48 08 02", |(_, strokes)| strokes)
}

fn points(strokes: &str) -> impl Iterator<Item = [f64; 2]> + '_ {
    strokes.split_whitespace().map(|pair| {
        let digits = pair.as_bytes();
        let digit = |i: usize| f64::from(digits.get(i).copied().unwrap_or(b'0')) - f64::from(b'0');
        [digit(0), digit(1) - 2.0]
    })
}

fn advance(c: char) -> f64 {
    if c.is_whitespace() {
        return BLANK;
    }
    let strokes = glyph(c).split(';');
    let widest = strokes.flat_map(points).map(|[x, _]| x).fold(0.0, f64::max);
    widest + GAP
}

/// The width of a text on the grid.
pub(crate) fn width(text: &str) -> f64 {
    (text.chars().map(advance).sum::<f64>() - GAP).max(0.0)
}

/// The lines of a text that starts at 0, y up from the baseline.
pub(crate) fn lines(text: &str) -> Vec<Vec<[f64; 2]>> {
    let mut lines = Vec::new();
    let mut at = 0.0;
    for c in text.chars() {
        if !c.is_whitespace() {
            for stroke in glyph(c).split(';') {
                lines.push(points(stroke).map(|[x, y]| [at + x, y]).collect());
            }
        }
        at += advance(c);
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_glyph_is_well_formed_and_unlike_the_others() {
        for (i, (name, strokes)) in GLYPHS.iter().enumerate() {
            for pair in strokes.split([' ', ';']) {
                assert!(
                    pair.len() == 2 && pair.bytes().all(|b| b.is_ascii_digit()),
                    "{name}: {pair}"
                );
                assert!(pair.as_bytes()[1] <= b'8', "{name}");
            }
            assert!(
                GLYPHS[..i].iter().all(|(n, s)| n != name && s != strokes),
                "{name}"
            );
        }
        let needed = ('a'..='z').chain('0'..='9').chain(".,:-+()/%".chars());
        for c in needed {
            assert!(GLYPHS.iter().any(|(name, _)| *name == c), "{c}");
        }
    }

    #[test]
    fn widths_add_up() {
        assert_eq!(width(""), 0.0);
        assert!(width("ii") < width("mm"));
        let last = lines("v t")
            .concat()
            .iter()
            .map(|p| p[0])
            .fold(0.0, f64::max);
        assert!((last - width("v t")).abs() < 1e-12);
    }
}
