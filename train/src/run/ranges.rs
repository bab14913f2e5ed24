//! The ranges of the settings.

use crate::algorithm::apg::ApgSettings;
use crate::algorithm::bc::BcSettings;
use crate::algorithm::sac::SacSettings;
use cede_controller::policy::mlp::{LANES, MAX_WIDTH};

/// A setting that is out of its range.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{name} must be {range}, not {value}")]
pub struct OutOfRange {
    /// Name of the setting.
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    /// Its range in words.
    pub range: &'static str,
}

/// The name of a setting, its value, whether it is in its range, and the range in words.
type Check = (&'static str, f64, bool, &'static str);

const COUNT: &str = "1 to 1,000,000";
const HORIZON: &str = "1 to 1,000";
const POSITIVE: &str = "above 0 and finite";
const NOT_NEGATIVE: &str = "0 or more and finite";
const SHARE: &str = "0 to 1";

fn count(name: &'static str, n: usize) -> Check {
    (name, n as f64, (1..=1_000_000).contains(&n), COUNT)
}

fn positive(name: &'static str, x: f32) -> Check {
    (name, x.into(), x > 0.0 && x.is_finite(), POSITIVE)
}

fn not_negative(name: &'static str, x: f32) -> Check {
    (name, x.into(), x >= 0.0 && x.is_finite(), NOT_NEGATIVE)
}

fn share(name: &'static str, x: f32) -> Check {
    (name, x.into(), (0.0..=1.0).contains(&x), SHARE)
}

fn width(width: usize) -> Check {
    let fits = width.is_multiple_of(LANES) && (LANES..=MAX_WIDTH).contains(&width);
    ("width", width as f64, fits, "a multiple of 16 up to 128")
}

pub(super) fn check_bc(s: &BcSettings) -> Result<(), OutOfRange> {
    first_violation(vec![
        width(s.width),
        count("batch", s.batch),
        positive("rate", s.rate),
    ])
}

pub(super) fn check_sac(s: &SacSettings) -> Result<(), OutOfRange> {
    let rates = &s.rates;
    first_violation(vec![
        width(s.width),
        count("batch", s.batch),
        count("parallel", s.parallel),
        count("steps_per_update", s.steps_per_update as usize),
        (
            "buffer",
            s.buffer as f64,
            (1..=10_000_000).contains(&s.buffer),
            "1 to 10,000,000",
        ),
        (
            "buffer_minimum",
            s.buffer_minimum as f64,
            s.buffer_minimum <= s.buffer,
            "no more than buffer",
        ),
        positive("rates.policy", rates.policy),
        positive("rates.critic", rates.critic),
        positive("rates.temperature", rates.temperature),
        share("rates.discount", rates.discount),
        share("rates.softness", rates.softness),
        share("rates.averaging", rates.averaging),
        (
            "rates.target_entropy",
            rates.target_entropy.into(),
            rates.target_entropy.is_finite(),
            "a number",
        ),
        positive("rates.initial_temperature", rates.initial_temperature),
    ])
}

pub(super) fn check_apg(s: &ApgSettings) -> Result<(), OutOfRange> {
    let (cost, refinement, claims) = (&s.cost, &s.refinement, &s.claims);
    let joint = s.width.saturating_mul(s.members as usize);
    let updates = |name, n: u32| (name, f64::from(n), n <= 10_000_000, "0 to 10,000,000");
    let horizon = |name, n: usize| (name, n as f64, (1..=1_000).contains(&n), HORIZON);
    first_violation(vec![
        width(s.width),
        (
            "members",
            f64::from(s.members),
            (1..=MAX_WIDTH).contains(&joint),
            "1 or more, and times width at most 128",
        ),
        updates("updates", s.updates),
        updates("refinement.updates", s.refinement.updates),
        count("batch", s.batch),
        positive("rate", s.rate),
        horizon("horizon", s.horizon),
        horizon("last_horizon", s.last_horizon),
        share("from_start", s.from_start),
        share("carry_on", s.carry_on),
        not_negative("position_jitter", s.position_jitter),
        not_negative("speed_jitter", s.speed_jitter),
        positive("clip", s.clip),
        positive("cost.huber", cost.huber),
        not_negative("cost.speed", cost.speed),
        not_negative("cost.expectation", cost.expectation),
        not_negative("cost.order", cost.order),
        not_negative("cost.late", cost.late),
        not_negative("cost.contact", cost.contact),
        not_negative("cost.gap", cost.gap),
        positive("refinement.rate", refinement.rate),
        (
            "refinement.places",
            refinement.places as f64,
            refinement.places <= 1_000_000,
            "0 to 1,000,000",
        ),
        not_negative("refinement.hold", refinement.hold),
        not_negative("claims.weight", claims.weight),
        not_negative("claims.margin", claims.margin),
        not_negative("claims.slope_margin", claims.slope_margin),
        (
            "claims.fresh",
            claims.fresh as f64,
            claims.fresh <= 10_000,
            "0 to 10,000",
        ),
        (
            "claims.hard",
            claims.hard as f64,
            claims.hard <= 10_000,
            "0 to 10,000",
        ),
    ])
}

fn first_violation(checks: Vec<Check>) -> Result<(), OutOfRange> {
    match checks.into_iter().find(|(_, _, holds, _)| !holds) {
        Some((name, value, _, range)) => Err(OutOfRange { name, value, range }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algorithm::apg::cost::Cost;

    #[test]
    fn a_setting_out_of_range_is_named() {
        let bc = |change: fn(&mut BcSettings)| {
            let mut settings = BcSettings::default();
            change(&mut settings);
            check_bc(&settings).unwrap_err().name
        };
        let sac = |change: fn(&mut SacSettings)| {
            let mut settings = SacSettings::default();
            change(&mut settings);
            check_sac(&settings).unwrap_err().name
        };
        let apg = |change: fn(&mut ApgSettings)| {
            let mut settings = ApgSettings::default();
            change(&mut settings);
            check_apg(&settings).unwrap_err().name
        };
        for (named, name) in [
            (bc(|s| s.batch = 0), "batch"),
            (bc(|s| s.rate = f32::NAN), "rate"),
            (sac(|s| s.width = 100), "width"),
            (sac(|s| s.buffer = 10), "buffer_minimum"),
            (apg(|s| s.width = 100_000_000_000), "width"),
            (apg(|s| s.members = 0), "members"),
            (apg(|s| s.members = 3), "members"),
            (apg(|s| s.horizon = 0), "horizon"),
            (
                apg(|s| {
                    s.cost = Cost {
                        gap: -1.0,
                        ..s.cost
                    }
                }),
                "cost.gap",
            ),
        ] {
            assert_eq!(named, name);
        }
    }
}
