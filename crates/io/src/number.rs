//! Decimal numbers: read exactly, written as the shortest text that reads back to the same `f64`.
//!
//! *Source*: the quick path of reading is that of W. D. Clinger, "How to Read Floating Point Numbers Accurately", PLDI
//! 1990: a whole number below 2⁵³ times or divided by a power of ten up to 10²² is one correctly rounded operation.
//! Everything else goes to the standard library, which is correctly rounded as well. Writing is the `zmij` crate.

/// The powers of ten that an `f64` holds exactly.
const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
    1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
];
/// The largest whole number up to which all are exact in an `f64`.
const EXACT: u64 = 1 << 53;

/// Reads a number at the beginning of `text` by the quick path: the value and the length of its text, or `None` when
/// the text begins with no number or with one that needs [`parse`]. The caller checks what follows.
#[inline]
pub(crate) fn quick(text: &[u8]) -> Option<(f64, usize)> {
    let mut at = 0;
    let negative = match text.first()? {
        b'-' => {
            at = 1;
            true
        }
        b'+' => {
            at = 1;
            false
        }
        _ => false,
    };
    let mut mantissa = 0u64;
    let mut digits = at;
    while let Some(digit) = digit_at(text, at) {
        mantissa = mantissa.wrapping_mul(10).wrapping_add(digit);
        at += 1;
    }
    digits = at - digits;
    let mut scale = 0;
    if text.get(at) == Some(&b'.') {
        at += 1;
        let point = at;
        while let Some(digit) = digit_at(text, at) {
            mantissa = mantissa.wrapping_mul(10).wrapping_add(digit);
            at += 1;
        }
        scale = at - point;
    }
    digits += scale;
    // 19 digits always fit 64 bits; leading zeros are counted too, which only sends a few more to the long path.
    if digits == 0 || digits > 19 || mantissa > EXACT {
        return None;
    }
    let mut exponent = -(scale as i64);
    if matches!(text.get(at), Some(b'e' | b'E')) {
        at += 1;
        let minus = text.get(at) == Some(&b'-');
        if matches!(text.get(at), Some(b'-' | b'+')) {
            at += 1;
        }
        let begin = at;
        let mut power = 0i64;
        while let Some(digit) = digit_at(text, at) {
            power = power.saturating_mul(10).saturating_add(digit as i64);
            at += 1;
        }
        if at == begin {
            return None;
        }
        exponent = exponent.saturating_add(if minus { -power } else { power });
    }
    let whole = mantissa as f64;
    let value = match exponent {
        0..=22 => whole * POWERS[exponent as usize],
        -22..=-1 => whole / POWERS[(-exponent) as usize],
        _ => return None,
    };
    Some((if negative { -value } else { value }, at))
}

#[inline(always)]
fn digit_at(text: &[u8], at: usize) -> Option<u64> {
    let digit = text.get(at)?.wrapping_sub(b'0');
    (digit < 10).then_some(u64::from(digit))
}

/// Reads all of `text` as a number, or `None` when it is not one. NaN and infinities are numbers here, also in the
/// spellings of C libraries (`-nan`, `nan(ind)`, `1.#IND`, `-1.#INF`); a number beyond the range of `f64` is infinite.
pub(crate) fn parse(text: &[u8]) -> Option<f64> {
    if let Some((value, length)) = quick(text)
        && length == text.len()
    {
        return Some(value);
    }
    let text = core::str::from_utf8(text).ok()?;
    text.parse().ok().or_else(|| c_spelling(text))
}

/// NaN and infinity as C run-time libraries print them.
fn c_spelling(text: &str) -> Option<f64> {
    let lower = text.to_ascii_lowercase();
    let (sign, body) = match lower.strip_prefix('-') {
        Some(rest) => (-1.0, rest),
        None => (1.0, lower.strip_prefix('+').unwrap_or(&lower)),
    };
    let special = match body.strip_prefix("1.#") {
        Some(rest) => rest.trim_end_matches('0'),
        None => body
            .strip_prefix("nan(")
            .and_then(|rest| rest.strip_suffix(')'))
            .map(|_| "nan")?,
    };
    match special {
        "inf" => Some(sign * f64::INFINITY),
        "ind" | "qnan" | "snan" | "nan" => Some(f64::NAN),
        _ => None,
    }
}

/// Appends the shortest text that reads back to exactly `value` (`1`, not `1.0`). `value` must be finite.
pub(crate) fn write(value: f64, out: &mut Vec<u8>) {
    let mut buffer = zmij::Buffer::new();
    let text = buffer.format(value);
    out.extend_from_slice(text.strip_suffix(".0").unwrap_or(text).as_bytes());
}

/// Appends the shortest text that reads back to exactly the 32-bit `value`, which must be finite.
pub(crate) fn write_single(value: f32, out: &mut Vec<u8>) {
    let mut buffer = zmij::Buffer::new();
    let text = buffer.format(value);
    out.extend_from_slice(text.strip_suffix(".0").unwrap_or(text).as_bytes());
}

/// As [`write`], also for NaN (`nan`) and infinities (`inf`, `-inf`).
pub(crate) fn write_any(value: f64, out: &mut Vec<u8>) {
    if value.is_finite() {
        write(value, out);
    } else if value.is_nan() {
        out.extend_from_slice(b"nan");
    } else {
        out.extend_from_slice(if value > 0.0 { b"inf" } else { b"-inf" });
    }
}

/// Appends a whole number.
pub(crate) fn write_whole(value: u64, out: &mut Vec<u8>) {
    let mut digits = [0u8; 20];
    let mut at = digits.len();
    let mut rest = value;
    loop {
        at -= 1;
        digits[at] = b'0' + (rest % 10) as u8;
        rest /= 10;
        if rest == 0 {
            break;
        }
    }
    out.extend_from_slice(&digits[at..]);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(value: f64) -> String {
        let mut out = Vec::new();
        write(value, &mut out);
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn reads_as_the_standard_library_does() {
        let mut state = 0x9e37_79b9_7f4a_7c15_u64;
        let mut next = move || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            state
        };
        for _ in 0..200_000 {
            let whole = next() >> (next() % 60);
            let text = match next() % 6 {
                0 => format!("{whole}"),
                1 => format!("-{}.{}", whole % 1000, next() % 1_000_000),
                2 => format!("+.{:08}", next() % 100_000_000),
                3 => format!("{}.e{}", whole % 100, next() % 40),
                4 => format!("{:.17e}", f64::from_bits(next())),
                _ => format!(
                    "{}.{:06}E-{:03}",
                    next() % 10,
                    next() % 1_000_000,
                    next() % 30
                ),
            };
            let expected: f64 = text.parse().unwrap();
            let read = parse(text.as_bytes()).unwrap();
            assert!(
                read.to_bits() == expected.to_bits() || read.is_nan() && expected.is_nan(),
                "{text}"
            );
        }
    }

    #[test]
    fn writes_what_reads_back_and_nothing_longer() {
        assert_eq!(written(1.0), "1");
        assert_eq!(written(-0.0), "-0");
        assert_eq!(written(0.1 + 0.2), "0.30000000000000004");
        assert_eq!(written(100.0), "100");
        let mut state = 88_172_645_463_325_252_u64;
        for _ in 0..100_000 {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            let value = f64::from_bits(state);
            if value.is_finite() {
                let text = written(value);
                assert_eq!(
                    parse(text.as_bytes()).unwrap().to_bits(),
                    value.to_bits(),
                    "{text}"
                );
                let digits = |s: &str| {
                    let m = s.split('e').next().unwrap();
                    let all: String = m.chars().filter(char::is_ascii_digit).collect();
                    all.trim_start_matches('0').trim_end_matches('0').len()
                };
                assert!(digits(&text) <= digits(&format!("{value:e}")), "{text}");
            }
        }
        let mut out = Vec::new();
        write_whole(0, &mut out);
        write_whole(u64::MAX, &mut out);
        assert_eq!(out, b"018446744073709551615");
    }

    #[test]
    fn odd_spellings() {
        assert_eq!(parse(b".8e-001"), Some(0.08));
        assert_eq!(parse(b"-.7e+02"), Some(-70.0));
        assert_eq!(parse(b"1."), Some(1.0));
        for nan in [
            "nan", "-nan", "NaN", "nan(ind)", "-1.#IND", "1.#QNAN0", "1.#IND00",
        ] {
            assert!(parse(nan.as_bytes()).is_some_and(f64::is_nan), "{nan}");
        }
        assert_eq!(parse(b"-1.#INF"), Some(f64::NEG_INFINITY));
        assert_eq!(parse(b"1e999"), Some(f64::INFINITY));
        for bad in [
            "", "-", ".", "1e", "e5", "1,5", "0x10", "1.#", "1.2.3", "--1", "1f", "\u{661}",
        ] {
            assert_eq!(parse(bad.as_bytes()), None, "{bad}");
        }
    }
}
