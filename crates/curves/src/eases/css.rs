//! The notation of style sheets.
//!
//! *Source*: W3C, *CSS Easing Functions Level 2*, grammar of `<easing-function>`; numbers and percentages after *CSS
//! Values and Units*. Names are matched whatever their case. Registered eases are known by their names, too, with their
//! usual parameters.

use super::registry;
use super::{CubicBezier, Ease, StepPosition, Steps, Stops};
use crate::CurveError;

/// Reads an ease: `"ease-in-out"`, `"cubic-bezier(0.25, 0.1, 0.25, 1)"`, `"steps(4, jump-end)"`,
/// `"linear(0, 0.2 30%, 1)"`, or the name of a registered ease.
///
/// # Errors
/// [`CurveError::Text`] with the place of what is wrong, [`CurveError::UnknownName`] for an unknown keyword, and what the
/// constructors say of numbers outside their range.
pub fn parse(text: &str) -> Result<Box<dyn Ease>, CurveError> {
    let mut reader = Reader { text, at: 0 };
    reader.space();
    let name = reader.word();
    if name.is_empty() {
        return Err(reader.wrong("an ease starts with its name: write, for example, `ease-in-out`"));
    }
    let built: Box<dyn Ease> = if reader.take('(') {
        let built: Box<dyn Ease> = match name.as_str() {
            "cubic-bezier" => {
                let x1 = reader.number()?;
                let mut rest = [0.0; 3];
                for number in &mut rest {
                    reader.comma("cubic-bezier() has four numbers, x1, y1, x2, y2")?;
                    *number = reader.number()?;
                }
                Box::new(CubicBezier::new(x1, rest[0], rest[1], rest[2])?)
            }
            "steps" => reader.steps()?,
            "linear" => reader.stops()?,
            _ => {
                return Err(CurveError::UnknownName {
                    what: "function of time",
                    name,
                    known: "cubic-bezier(), steps(), linear()".to_owned(),
                });
            }
        };
        reader.space();
        if !reader.take(')') {
            return Err(reader.wrong("a closing parenthesis is missing, or something is left over"));
        }
        built
    } else {
        match name.as_str() {
            "step-start" => Box::new(Steps::STEP_START),
            "step-end" => Box::new(Steps::STEP_END),
            _ => registry::ease(&name, &[])?,
        }
    };
    reader.space();
    if reader.peek().is_some() {
        return Err(reader.wrong("nothing may follow the ease: remove this"));
    }
    Ok(built)
}

/// Position in the text.
struct Reader<'a> {
    text: &'a str,
    /// Byte, on the boundary of a character.
    at: usize,
}

impl Reader<'_> {
    fn rest(&self) -> &str {
        self.text.get(self.at..).unwrap_or_default()
    }
    fn peek(&self) -> Option<char> {
        self.rest().chars().next()
    }
    fn wrong(&self, problem: impl Into<String>) -> CurveError {
        let before = self.text.get(..self.at).unwrap_or_default();
        CurveError::Text {
            text: self.text.to_owned(),
            character: before.chars().count() + 1,
            problem: problem.into(),
        }
    }
    fn take(&mut self, wanted: char) -> bool {
        let found = self.peek() == Some(wanted);
        if found {
            self.at += wanted.len_utf8();
        }
        found
    }
    fn span(&mut self, belongs: impl Fn(char) -> bool) -> String {
        let rest = self.rest();
        let length = rest.find(|c| !belongs(c)).unwrap_or(rest.len());
        let found = rest[..length].to_owned();
        self.at += length;
        found
    }
    fn space(&mut self) {
        self.span(|c| c.is_ascii_whitespace());
    }
    /// A name, in lower case.
    fn word(&mut self) -> String {
        self.span(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_')
            .to_ascii_lowercase()
    }
    fn comma(&mut self, otherwise: &str) -> Result<(), CurveError> {
        self.space();
        if self.take(',') {
            Ok(())
        } else {
            Err(self.wrong(format!("a comma is missing: {otherwise}")))
        }
    }

    /// Whether a number starts here: a digit, sign or point.
    fn number_starts(&self) -> bool {
        self.peek()
            .is_some_and(|c| c.is_ascii_digit() || matches!(c, '+' | '-' | '.'))
    }

    fn number(&mut self) -> Result<f64, CurveError> {
        self.space();
        let start = self.at;
        let mut text = String::new();
        if matches!(self.peek(), Some('+' | '-')) {
            text.push_str(&self.rest()[..1]);
            self.at += 1;
        }
        let whole = self.span(|c| c.is_ascii_digit());
        text.push_str(&whole);
        let mut decimals = String::new();
        if self.take('.') {
            decimals = self.span(|c| c.is_ascii_digit());
            text.push('.');
            text.push_str(&decimals);
            if decimals.is_empty() {
                return Err(self.wrong("a digit must follow the point"));
            }
        }
        if whole.is_empty() && decimals.is_empty() {
            self.at = start;
            return Err(self.wrong("a number is missing"));
        }
        if matches!(self.peek(), Some('e' | 'E')) {
            self.at += 1;
            text.push('e');
            if matches!(self.peek(), Some('+' | '-')) {
                text.push_str(&self.rest()[..1]);
                self.at += 1;
            }
            text.push_str(&self.span(|c| c.is_ascii_digit()));
        }
        match text.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(number),
            _ => {
                self.at = start;
                Err(self.wrong("this is no number, or one too large"))
            }
        }
    }

    fn steps(&mut self) -> Result<Box<dyn Ease>, CurveError> {
        let count = self.number()?;
        self.space();
        let mut position = StepPosition::End;
        if self.take(',') {
            self.space();
            let start = self.at;
            let word = self.word();
            match StepPosition::WORDS.iter().find(|known| known.0 == word) {
                Some(known) => position = known.1,
                None => {
                    self.at = start;
                    return Err(self.wrong(
                        "steps() jump at jump-start, jump-end, jump-none, jump-both, start or end",
                    ));
                }
            }
        }
        Ok(Box::new(Steps::new(count, position)?))
    }

    /// A number, and up to two percentages before or after it, the second of which repeats the value.
    fn stops(&mut self) -> Result<Box<dyn Ease>, CurveError> {
        let mut stops: Vec<(Option<f64>, f64)> = Vec::new();
        loop {
            let start = {
                self.space();
                self.at
            };
            let (mut value, mut times) = (None, Vec::new());
            let mut time_first = false;
            while {
                self.space();
                self.number_starts()
            } {
                let number = self.number()?;
                if self.take('%') {
                    if times.is_empty() {
                        time_first = value.is_none();
                    } else if times.len() == 2 || (time_first && value.is_some()) {
                        return Err(self.wrong(
                            "a stop of linear() has at most two percentages, which stand together",
                        ));
                    }
                    times.push(number / 100.0);
                } else if value.replace(number).is_some() {
                    return Err(self
                        .wrong("a stop of linear() has one number: write a comma between stops"));
                }
            }
            let Some(value) = value else {
                self.at = start;
                return Err(self.wrong("a stop of linear() needs a number"));
            };
            match times.as_slice() {
                [] => stops.push((None, value)),
                times => stops.extend(times.iter().map(|&time| (Some(time), value))),
            }
            self.space();
            if !self.take(',') {
                break;
            }
        }
        Ok(Box::new(Stops::listed(&stops)?))
    }
}
