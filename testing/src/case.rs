//! One case of a closed loop: where everybody starts, what the others do, and what the sensors make of it.

use crate::place::{Place, Road};
use std::fmt;

/// Who is where at the start, and what happens then. It shrinks to few vehicles, straight roads and round numbers.
///
/// Displays as sentences, one a line.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// The junction.
    pub place: Place,
    /// Decimetres from the ego to its line; it starts within its road.
    pub before: u16,
    /// The ego's speed in dm/s.
    pub speed: u16,
    /// The others; their track numbers are 1, 2, …
    pub others: Vec<Other>,
    /// Who proposes.
    pub proposals: Proposals,
    /// Errors of the sensors, delays and gaps.
    pub noise: Noise,
}

/// Another vehicle.
#[derive(Clone, Debug, PartialEq)]
pub struct Other {
    /// Where it drives.
    pub road: Road,
    /// Decimetres to its first zone with the ego; in the ego's own lane, decimetres that it is ahead of the ego.
    pub before: i16,
    /// Its speed in dm/s.
    pub speed: u16,
    /// What it does, one piece after the other, and then it keeps its speed.
    pub script: Vec<Push>,
}

/// An acceleration for a while.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Push {
    /// Periods of the contract.
    pub periods: u8,
    /// Quarters of the hardest acceleration (above 0, up to 4) or braking (below 0) that the contract allows; beyond ± 4
    /// it exceeds the contract.
    pub quarters: i8,
}

/// Who proposes what the shield filters.
#[derive(Clone, Debug, PartialEq)]
pub enum Proposals {
    /// The policy.
    Policy,
    /// Somebody who always accelerates as hard as the contract allows.
    Reckless,
    /// Somebody with a script, in quarters of the contract's limits for the ego; afterwards full acceleration.
    Script(Vec<Push>),
}

/// What the sensors and the actuators make of the world, within what the vehicle achieves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Noise {
    /// What it is drawn from.
    pub seed: u16,
    /// Errors of arc lengths and speeds.
    pub errors: Level,
    /// Delay of commands.
    pub delay: Level,
    /// How far calls are off the grid of periods.
    pub jitter: Level,
    /// How far vehicles are beside their routes.
    pub beside: Level,
    /// Of 64 observations of a track, so many are missing, for 1, 2, 4, 8 or 16 periods each; half as many of the ego.
    pub missing: u8,
}

/// How much of what is allowed is used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// Nothing.
    None,
    /// All, always upwards.
    All,
    /// Something in between.
    Some,
    /// Nothing, or all of it either way, at random.
    Corners,
}

impl Noise {
    /// Exact sensors, and commands that act at once.
    pub const NONE: Self = Self {
        seed: 0,
        errors: Level::None,
        delay: Level::None,
        jitter: Level::None,
        beside: Level::None,
        missing: 0,
    };

    /// A number that looks random, the same for the same `step` and `channel`.
    pub(crate) fn bits(&self, step: u32, channel: u32) -> u64 {
        let mut x = u64::from(self.seed) << 48 ^ u64::from(channel) << 32 ^ u64::from(step);
        x = x.wrapping_add(0x9E37_79B9_7F4A_7C15);
        x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        x ^ (x >> 31)
    }

    /// A share within [−1, 1].
    pub(crate) fn share(&self, level: Level, step: u32, channel: u32) -> f64 {
        let bits = self.bits(step, channel);
        match level {
            Level::None => 0.0,
            Level::All => 1.0,
            Level::Some => (bits >> 11) as f64 / (1_u64 << 53) as f64 * 2.0 - 1.0,
            Level::Corners => [-1.0, 0.0, 1.0, 1.0][(bits % 4) as usize],
        }
    }

    /// Whether something is missing that is missing so many of 64 times.
    pub(crate) fn misses(&self, of_64: u8, step: u32, channel: u32) -> bool {
        let burst = u32::from(self.seed % 5);
        self.bits(step >> burst, channel) % 64 < u64::from(of_64)
    }
}

/// The quarters of a script at period number `step`.
pub(crate) fn quarters(script: &[Push], step: u32) -> Option<i8> {
    let mut end = 0;
    script.iter().find_map(|push| {
        end += u32::from(push.periods);
        (step < end).then_some(push.quarters)
    })
}

/// Tenths as a decimal number.
fn tenths(value: i32) -> f64 {
    f64::from(value) / 10.0
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "Place: {}.", self.place)?;
        let (before, speed) = (tenths(self.before.into()), tenths(self.speed.into()));
        writeln!(
            f,
            "Ego: {before} m before its line at {speed} m/s; {}.",
            self.proposals
        )?;
        for (number, other) in (1..).zip(&self.others) {
            let from = if self.place.begins_in_one_lane(other.road) {
                "ahead of the ego"
            } else {
                "before its zone"
            };
            writeln!(f, "Other {number}: {}.", Told(other, from))?;
        }
        write!(f, "{}", self.noise)
    }
}

/// Another vehicle in words, and where its place is counted from.
struct Told<'a>(&'a Other, &'static str);

impl fmt::Display for Told<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(other, from) = self;
        let (before, speed) = (tenths(other.before.into()), tenths(other.speed.into()));
        write!(f, "{}, {before} m {from} at {speed} m/s", other.road)?;
        if other.script.is_empty() {
            return f.write_str(", keeps its speed");
        }
        write!(f, "; {}", Script(&other.script))
    }
}

/// A script in words.
struct Script<'a>(&'a [Push]);

impl fmt::Display for Script<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, push) in self.0.iter().enumerate() {
            let then = if i > 0 { ", then " } else { "" };
            let share = f64::from(push.quarters.unsigned_abs()) * 25.0;
            let periods = push.periods;
            match push.quarters {
                0 => write!(f, "{then}keeps its speed for {periods} periods")?,
                1.. => write!(f, "{then}accelerates at {share} % for {periods} periods")?,
                _ => write!(f, "{then}brakes at {share} % for {periods} periods")?,
            }
        }
        Ok(())
    }
}

impl fmt::Display for Proposals {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Policy => f.write_str("the policy proposes"),
            Self::Reckless => f.write_str("full acceleration is proposed"),
            Self::Script(script) if script.is_empty() => {
                f.write_str("full acceleration is proposed")
            }
            Self::Script(script) => {
                write!(
                    f,
                    "is proposed what {}, then full acceleration",
                    Script(script)
                )
            }
        }
    }
}

impl fmt::Display for Level {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::None => "none",
            Self::All => "full",
            Self::Some => "random",
            Self::Corners => "none or full at random",
        })
    }
}

impl fmt::Display for Noise {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if *self
            == (Self {
                seed: self.seed,
                ..Self::NONE
            })
        {
            return f.write_str("Sensors are exact, commands act at once.");
        }
        let Self {
            seed,
            errors,
            delay,
            jitter,
            beside,
            missing,
        } = self;
        write!(
            f,
            "Sensor errors: {errors}; delay: {delay}; jitter: {jitter}; beside the route: {beside}; \
             {missing} of 64 observations missing (noise {seed})."
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::place::{Right, Shape};

    #[test]
    fn a_case_reads_as_sentences() {
        let case = Case {
            place: Place {
                shape: Shape::RightAngle,
                arm: 80,
                tolerance: 0,
                right: Right::Nobody,
            },
            before: 205,
            speed: 80,
            others: vec![Other {
                road: Road::FirstLorry,
                before: 300,
                speed: 100,
                script: vec![
                    Push {
                        periods: 20,
                        quarters: -4,
                    },
                    Push {
                        periods: 5,
                        quarters: 2,
                    },
                ],
            }],
            proposals: Proposals::Reckless,
            noise: Noise::NONE,
        };
        assert_eq!(
            case.to_string(),
            "Place: two straight roads cross at a right angle; arms of 80 m, vehicles up to 0 cm off their routes.\n\
             Ego: 20.5 m before its line at 8 m/s; full acceleration is proposed.\n\
             Other 1: a lorry on the first road, 30 m before its zone at 10 m/s; \
             brakes at 100 % for 20 periods, then accelerates at 50 % for 5 periods.\n\
             Sensors are exact, commands act at once."
        );
    }

    #[test]
    fn scripts_are_read_piece_by_piece() {
        let script = [
            Push {
                periods: 2,
                quarters: 4,
            },
            Push {
                periods: 1,
                quarters: -1,
            },
        ];
        let read: Vec<_> = (0..4).map(|step| quarters(&script, step)).collect();
        assert_eq!(read, [Some(4), Some(4), Some(-1), None]);
    }
}
