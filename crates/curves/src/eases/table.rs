//! Every ease, one entry each: the laws, lists and galleries go through this table.
//!
//! References name the slide of *Interpolation Techniques*, chapter 2, the section of W3C, *CSS Easing Functions Level 2*,
//! or R. Penner, *Programming Macromedia Flash MX*, 2002, chapter 7.

use super::{
    Back, Bounce, Circular, ConstantAcceleration, Cubic, CubicBezier, Directed, Direction, Ease,
    Elastic, Exponential, Linear, PiecewiseSinusoidal, Power, Quintic, Sine, Sinusoidal, Spring,
    StepPosition, Steps, Stops,
    registry::{EaseEntry, EaseParameter, Setting},
};
use crate::CurveError;

const fn number(name: &'static str, summary: &'static str, default: f64) -> EaseParameter {
    EaseParameter {
        name,
        summary,
        default: Setting::Number(default),
    }
}

const POWER: &[EaseParameter] = &[number(
    "exponent",
    "the power of the time, from 1 to 100",
    2.5,
)];
const RATE: &[EaseParameter] = &[number(
    "rate",
    "how often it doubles, from 0.1 to 100",
    10.0,
)];
const OVERSHOOT: &[EaseParameter] = &[number(
    "overshoot",
    "coefficient of the run-up, from 0 to 100; 1.70158 goes back by a tenth",
    1.70158,
)];
const ELASTIC: &[EaseParameter] = &[
    number("amplitude", "from 1 to 100", 1.0),
    number(
        "period",
        "of a swing, in shares of the time, from 0.01 to 100",
        0.3,
    ),
];
const BOUNCE: &[EaseParameter] = &[
    number("bounces", "how many, from 0 to 30", 3.0),
    number(
        "restitution",
        "speed after a bounce over speed before it, from 0.01 to 1",
        0.5,
    ),
];

fn boxed<E: Ease + 'static>(ease: E) -> Result<Box<dyn Ease>, CurveError> {
    Ok(Box::new(ease))
}

/// All eases.
pub(super) static EASES: &[EaseEntry] = &[
    EaseEntry {
        name: "linear",
        aliases: &[],
        title: "Even motion",
        reference: "CSS Easing Functions 2, the keyword linear",
        parameters: &[],
        example: &[],
        build: |_| boxed(Linear),
    },
    EaseEntry {
        name: "sinusoidal",
        aliases: &[],
        title: "Half of a sine wave",
        reference: "Interpolation Techniques, chapter 2, Ease-in: Sinusoidal",
        parameters: &[],
        example: &[],
        build: |_| boxed(Sinusoidal),
    },
    EaseEntry {
        name: "piecewise-sinusoidal",
        aliases: &[],
        title: "Sine, even motion, sine",
        reference: "Interpolation Techniques, chapter 2, Ease-in: Piecewise Sinusoidal (errata C4)",
        parameters: &[
            number(
                "k1",
                "time at which the even motion begins, from 0 to k2",
                0.3,
            ),
            number("k2", "time at which it ends, from k1 to 1", 0.7),
        ],
        example: &[],
        build: |s| boxed(PiecewiseSinusoidal::new(s.number(0)?, s.number(1)?)?),
    },
    EaseEntry {
        name: "cubic",
        aliases: &["smoothstep"],
        title: "Single cubic",
        reference: "Interpolation Techniques, chapter 2, Ease-in: Single Cubic",
        parameters: &[],
        example: &[],
        build: |_| boxed(Cubic),
    },
    EaseEntry {
        name: "quintic",
        aliases: &["smootherstep"],
        title: "Quintic without acceleration at the ends",
        reference: "K. Perlin, Improving Noise, SIGGRAPH 2002",
        parameters: &[],
        example: &[],
        build: |_| boxed(Quintic),
    },
    EaseEntry {
        name: "constant-acceleration",
        aliases: &[],
        title: "Constant acceleration, even motion, constant deceleration",
        reference: "Interpolation Techniques, chapter 2, Ease-in: Constant Acceleration (errata C12)",
        parameters: &[
            number(
                "t1",
                "time at which the even motion begins, from 0 to t2",
                0.25,
            ),
            number("t2", "time at which it ends, from t1 to 1", 0.75),
        ],
        example: &[],
        build: |s| boxed(ConstantAcceleration::new(s.number(0)?, s.number(1)?)?),
    },
    EaseEntry {
        name: "sine-in",
        aliases: &[],
        title: "Quarter of a sine wave, slow at the start",
        reference: "Penner 2002, chapter 7",
        parameters: &[],
        example: &[],
        build: |_| boxed(Directed::new(Sine, Direction::In)),
    },
    EaseEntry {
        name: "sine-out",
        aliases: &[],
        title: "Quarter of a sine wave, slow at the end",
        reference: "Penner 2002, chapter 7",
        parameters: &[],
        example: &[],
        build: |_| boxed(Directed::new(Sine, Direction::Out)),
    },
    EaseEntry {
        name: "sine-in-out",
        aliases: &[],
        title: "Quarter of a sine wave, slow at both ends",
        reference: "Penner 2002, chapter 7",
        parameters: &[],
        example: &[],
        build: |_| boxed(Directed::new(Sine, Direction::InOut)),
    },
    EaseEntry {
        name: "quad-in",
        aliases: &[],
        title: "Square, slow at the start",
        reference: "Penner 2002, chapter 7",
        parameters: &[],
        example: &[],
        build: |_| boxed(Directed::new(Power::QUAD, Direction::In)),
    },
    EaseEntry {
        name: "quad-out",
        aliases: &[],
        title: "Square, slow at the end",
        reference: "Penner 2002, chapter 7",
        parameters: &[],
        example: &[],
        build: |_| boxed(Directed::new(Power::QUAD, Direction::Out)),
    },
    EaseEntry {
        name: "quad-in-out",
        aliases: &[],
        title: "Square, slow at both ends",
        reference: "Penner 2002, chapter 7",
        parameters: &[],
        example: &[],
        build: |_| boxed(Directed::new(Power::QUAD, Direction::InOut)),
    },
    EaseEntry {
        name: "cubic-in",
        aliases: &[],
        title: "Third power, slow at the start",
        reference: "Penner 2002, chapter 7",
        parameters: &[],
        example: &[],
        build: |_| boxed(Directed::new(Power::CUBIC, Direction::In)),
    },
    EaseEntry {
        name: "cubic-out",
        aliases: &[],
        title: "Third power, slow at the end",
        reference: "Penner 2002, chapter 7",
        parameters: &[],
        example: &[],
        build: |_| boxed(Directed::new(Power::CUBIC, Direction::Out)),
    },
    EaseEntry {
        name: "cubic-in-out",
        aliases: &[],
        title: "Third power, slow at both ends",
        reference: "Penner 2002, chapter 7",
        parameters: &[],
        example: &[],
        build: |_| boxed(Directed::new(Power::CUBIC, Direction::InOut)),
    },
    EaseEntry {
        name: "quart-in",
        aliases: &[],
        title: "Fourth power, slow at the start",
        reference: "Penner 2002, chapter 7",
        parameters: &[],
        example: &[],
        build: |_| boxed(Directed::new(Power::QUART, Direction::In)),
    },
    EaseEntry {
        name: "quart-out",
        aliases: &[],
        title: "Fourth power, slow at the end",
        reference: "Penner 2002, chapter 7",
        parameters: &[],
        example: &[],
        build: |_| boxed(Directed::new(Power::QUART, Direction::Out)),
    },
    EaseEntry {
        name: "quart-in-out",
        aliases: &[],
        title: "Fourth power, slow at both ends",
        reference: "Penner 2002, chapter 7",
        parameters: &[],
        example: &[],
        build: |_| boxed(Directed::new(Power::QUART, Direction::InOut)),
    },
    EaseEntry {
        name: "quint-in",
        aliases: &[],
        title: "Fifth power, slow at the start",
        reference: "Penner 2002, chapter 7",
        parameters: &[],
        example: &[],
        build: |_| boxed(Directed::new(Power::QUINT, Direction::In)),
    },
    EaseEntry {
        name: "quint-out",
        aliases: &[],
        title: "Fifth power, slow at the end",
        reference: "Penner 2002, chapter 7",
        parameters: &[],
        example: &[],
        build: |_| boxed(Directed::new(Power::QUINT, Direction::Out)),
    },
    EaseEntry {
        name: "quint-in-out",
        aliases: &[],
        title: "Fifth power, slow at both ends",
        reference: "Penner 2002, chapter 7",
        parameters: &[],
        example: &[],
        build: |_| boxed(Directed::new(Power::QUINT, Direction::InOut)),
    },
    EaseEntry {
        name: "power-in",
        aliases: &[],
        title: "Any power, slow at the start",
        reference: "Penner 2002, chapter 7, generalized",
        parameters: POWER,
        example: &[],
        build: |s| boxed(Directed::new(Power::new(s.number(0)?)?, Direction::In)),
    },
    EaseEntry {
        name: "power-out",
        aliases: &[],
        title: "Any power, slow at the end",
        reference: "Penner 2002, chapter 7, generalized",
        parameters: POWER,
        example: &[],
        build: |s| boxed(Directed::new(Power::new(s.number(0)?)?, Direction::Out)),
    },
    EaseEntry {
        name: "power-in-out",
        aliases: &[],
        title: "Any power, slow at both ends",
        reference: "Penner 2002, chapter 7, generalized",
        parameters: POWER,
        example: &[],
        build: |s| boxed(Directed::new(Power::new(s.number(0)?)?, Direction::InOut)),
    },
    EaseEntry {
        name: "exponential-in",
        aliases: &[],
        title: "Exponential, slow at the start",
        reference: "Penner 2002, chapter 7, starting exactly at 0",
        parameters: RATE,
        example: &[],
        build: |s| {
            boxed(Directed::new(
                Exponential::new(s.number(0)?)?,
                Direction::In,
            ))
        },
    },
    EaseEntry {
        name: "exponential-out",
        aliases: &[],
        title: "Exponential, slow at the end",
        reference: "Penner 2002, chapter 7, starting exactly at 0",
        parameters: RATE,
        example: &[],
        build: |s| {
            boxed(Directed::new(
                Exponential::new(s.number(0)?)?,
                Direction::Out,
            ))
        },
    },
    EaseEntry {
        name: "exponential-in-out",
        aliases: &[],
        title: "Exponential, slow at both ends",
        reference: "Penner 2002, chapter 7, starting exactly at 0",
        parameters: RATE,
        example: &[],
        build: |s| {
            boxed(Directed::new(
                Exponential::new(s.number(0)?)?,
                Direction::InOut,
            ))
        },
    },
    EaseEntry {
        name: "circular-in",
        aliases: &[],
        title: "Quarter of a circle, slow at the start",
        reference: "Penner 2002, chapter 7",
        parameters: &[],
        example: &[],
        build: |_| boxed(Directed::new(Circular, Direction::In)),
    },
    EaseEntry {
        name: "circular-out",
        aliases: &[],
        title: "Quarter of a circle, slow at the end",
        reference: "Penner 2002, chapter 7",
        parameters: &[],
        example: &[],
        build: |_| boxed(Directed::new(Circular, Direction::Out)),
    },
    EaseEntry {
        name: "circular-in-out",
        aliases: &[],
        title: "Quarter of a circle, slow at both ends",
        reference: "Penner 2002, chapter 7",
        parameters: &[],
        example: &[],
        build: |_| boxed(Directed::new(Circular, Direction::InOut)),
    },
    EaseEntry {
        name: "back-in",
        aliases: &[],
        title: "Run-up, slow at the start",
        reference: "Penner 2002, chapter 7",
        parameters: OVERSHOOT,
        example: &[],
        build: |s| boxed(Back::new(s.number(0)?)?.directed(Direction::In)),
    },
    EaseEntry {
        name: "back-out",
        aliases: &[],
        title: "Run-up, slow at the end",
        reference: "Penner 2002, chapter 7",
        parameters: OVERSHOOT,
        example: &[],
        build: |s| boxed(Back::new(s.number(0)?)?.directed(Direction::Out)),
    },
    EaseEntry {
        name: "back-in-out",
        aliases: &[],
        title: "Run-up, slow at both ends",
        reference: "Penner 2002, chapter 7",
        parameters: OVERSHOOT,
        example: &[],
        build: |s| boxed(Back::new(s.number(0)?)?.directed(Direction::InOut)),
    },
    EaseEntry {
        name: "elastic-in",
        aliases: &[],
        title: "Rubber band, slow at the start",
        reference: "Penner 2002, chapter 7, starting exactly at 0",
        parameters: ELASTIC,
        example: &[],
        build: |s| boxed(Elastic::new(s.number(0)?, s.number(1)?)?.directed(Direction::In)),
    },
    EaseEntry {
        name: "elastic-out",
        aliases: &[],
        title: "Rubber band, slow at the end",
        reference: "Penner 2002, chapter 7, starting exactly at 0",
        parameters: ELASTIC,
        example: &[],
        build: |s| boxed(Elastic::new(s.number(0)?, s.number(1)?)?.directed(Direction::Out)),
    },
    EaseEntry {
        name: "elastic-in-out",
        aliases: &[],
        title: "Rubber band, slow at both ends",
        reference: "Penner 2002, chapter 7, starting exactly at 0",
        parameters: ELASTIC,
        example: &[],
        build: |s| boxed(Elastic::new(s.number(0)?, s.number(1)?)?.directed(Direction::InOut)),
    },
    EaseEntry {
        name: "bounce-in",
        aliases: &[],
        title: "Bouncing ball, slow at the start",
        reference: "Penner 2002, chapter 7, with any restitution",
        parameters: BOUNCE,
        example: &[],
        build: |s| {
            boxed(Directed::new(
                Bounce::new(s.number(0)?, s.number(1)?)?,
                Direction::In,
            ))
        },
    },
    EaseEntry {
        name: "bounce-out",
        aliases: &[],
        title: "Bouncing ball, slow at the end",
        reference: "Penner 2002, chapter 7, with any restitution",
        parameters: BOUNCE,
        example: &[],
        build: |s| {
            boxed(Directed::new(
                Bounce::new(s.number(0)?, s.number(1)?)?,
                Direction::Out,
            ))
        },
    },
    EaseEntry {
        name: "bounce-in-out",
        aliases: &[],
        title: "Bouncing ball, slow at both ends",
        reference: "Penner 2002, chapter 7, with any restitution",
        parameters: BOUNCE,
        example: &[],
        build: |s| {
            boxed(Directed::new(
                Bounce::new(s.number(0)?, s.number(1)?)?,
                Direction::InOut,
            ))
        },
    },
    EaseEntry {
        name: "ease",
        aliases: &[],
        title: "Keyword of style sheets, quick start, slow end",
        reference: "CSS Easing Functions 2, Cubic Bézier easing functions",
        parameters: &[],
        example: &[],
        build: |_| boxed(CubicBezier::EASE),
    },
    EaseEntry {
        name: "ease-in",
        aliases: &[],
        title: "Keyword of style sheets, slow start",
        reference: "CSS Easing Functions 2, Cubic Bézier easing functions",
        parameters: &[],
        example: &[],
        build: |_| boxed(CubicBezier::EASE_IN),
    },
    EaseEntry {
        name: "ease-out",
        aliases: &[],
        title: "Keyword of style sheets, slow end",
        reference: "CSS Easing Functions 2, Cubic Bézier easing functions",
        parameters: &[],
        example: &[],
        build: |_| boxed(CubicBezier::EASE_OUT),
    },
    EaseEntry {
        name: "ease-in-out",
        aliases: &[],
        title: "Keyword of style sheets, slow at both ends",
        reference: "CSS Easing Functions 2, Cubic Bézier easing functions",
        parameters: &[],
        example: &[],
        build: |_| boxed(CubicBezier::EASE_IN_OUT),
    },
    EaseEntry {
        name: "cubic-bezier",
        aliases: &[],
        title: "Cubic Bézier curve over the time",
        reference: "CSS Easing Functions 2, Cubic Bézier easing functions",
        parameters: &[
            number("x1", "time of the first control point, from 0 to 1", 0.25),
            number("y1", "distance of the first control point", 0.1),
            number("x2", "time of the second control point, from 0 to 1", 0.25),
            number("y2", "distance of the second control point", 1.0),
        ],
        example: &[
            ("x1", Setting::Number(0.3)),
            ("y1", Setting::Number(-0.6)),
            ("x2", Setting::Number(0.6)),
            ("y2", Setting::Number(1.7)),
        ],
        build: |s| {
            boxed(CubicBezier::new(
                s.number(0)?,
                s.number(1)?,
                s.number(2)?,
                s.number(3)?,
            )?)
        },
    },
    EaseEntry {
        name: "steps",
        aliases: &[],
        title: "Staircase",
        reference: "CSS Easing Functions 2, Step easing functions",
        parameters: &[
            number("count", "how many intervals, from 1 to 1000000", 4.0),
            EaseParameter {
                name: "position",
                summary: "jump-start, jump-end, jump-none or jump-both",
                default: Setting::Word("jump-end"),
            },
        ],
        example: &[],
        build: |s| {
            let word = s.word(1)?;
            let known = StepPosition::WORDS.iter().find(|known| known.0 == word);
            let Some(&(_, position)) = known else {
                let words: Vec<&str> = StepPosition::WORDS.iter().map(|known| known.0).collect();
                return Err(CurveError::UnknownName {
                    what: "position of steps",
                    name: word.to_owned(),
                    known: words.join(", "),
                });
            };
            boxed(Steps::new(s.number(0)?, position)?)
        },
    },
    EaseEntry {
        name: "stops",
        aliases: &[],
        title: "Straight lines between stops",
        reference: "CSS Easing Functions 2, The linear easing function",
        parameters: &[EaseParameter {
            name: "stops",
            summary: "(time, distance) of each, at least two",
            default: Setting::Stops(&[(0.0, 0.0), (0.3, 0.2), (1.0, 1.0)]),
        }],
        example: &[],
        build: |s| boxed(Stops::new(s.stops(0)?)?),
    },
    EaseEntry {
        name: "spring",
        aliases: &[],
        title: "Mass on a damped spring",
        reference: "the damped harmonic oscillator",
        parameters: &[
            number("mass", "positive", 1.0),
            number("stiffness", "force for a distance, positive", 100.0),
            number(
                "damping",
                "force for a speed; twice the root of stiffness times mass is critical",
                10.0,
            ),
            number(
                "velocity",
                "at the start, in whole distances for a second",
                0.0,
            ),
            number(
                "rest",
                "share of the distance that counts as at rest, from 0.000001 to 0.1",
                1e-3,
            ),
        ],
        example: &[],
        build: |s| {
            boxed(Spring::new(
                s.number(0)?,
                s.number(1)?,
                s.number(2)?,
                s.number(3)?,
                s.number(4)?,
            )?)
        },
    },
];
