//! The rule-based drivers by name.

use super::{
    DriverFactory, Human, Idm, InitialSpeed, Logistic, MeanSpeed, NearerFirst, Replay,
    RuleOfTheRoad,
};
use cede_data::encounter::Encounter;
use std::fmt;
use std::str::FromStr;
use thiserror::Error;

/// A driver that every table shows beside what is learned.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Baseline {
    /// Recorded accelerations: the floor of the simulator's own error.
    Replay,
    /// Constant initial speed.
    InitialSpeed,
    /// Constant mean speed of the training encounters, per role and manoeuvre.
    MeanSpeed,
    /// The nearer goes, the other stops.
    NearerFirst,
    /// Who has the right of way goes; the other waits.
    RuleOfTheRoad,
    /// The intelligent driver model with stop-sign behaviour.
    Idm,
    /// The human driver of the synthetic scenarios.
    Human,
    /// A logistic model on the initial state says who goes; the other stops.
    Logistic,
}

/// Why there are no drivers of a kind.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum FitError {
    /// It learns from recorded encounters, and there is none to learn from.
    #[error("driver `{0}` is fitted on the training split, which is empty here")]
    NoTraining(Baseline),
}

impl Baseline {
    /// All of them, in the order of the table.
    pub const ALL: [Self; 8] = [
        Self::Replay,
        Self::InitialSpeed,
        Self::MeanSpeed,
        Self::NearerFirst,
        Self::RuleOfTheRoad,
        Self::Idm,
        Self::Human,
        Self::Logistic,
    ];

    /// Name on the command line and in tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Replay => "replay",
            Self::InitialSpeed => "initial-speed",
            Self::MeanSpeed => "mean-speed",
            Self::NearerFirst => "nearer-first",
            Self::RuleOfTheRoad => "rule-of-the-road",
            Self::Idm => "idm",
            Self::Human => "human",
            Self::Logistic => "logistic",
        }
    }

    /// Makes its drivers; those that learn do so from `training`.
    ///
    /// # Errors
    /// [`FitError::NoTraining`] if it learns and `training` is empty.
    pub fn fit(self, training: &[&Encounter]) -> Result<Box<dyn DriverFactory>, FitError> {
        Ok(match self {
            Self::Replay => Box::new(Replay),
            Self::InitialSpeed => Box::new(InitialSpeed),
            Self::MeanSpeed => {
                Box::new(MeanSpeed::fit(training).ok_or(FitError::NoTraining(self))?)
            }
            Self::NearerFirst => Box::new(NearerFirst),
            Self::RuleOfTheRoad => Box::new(RuleOfTheRoad),
            Self::Idm => Box::new(Idm),
            Self::Human => Box::new(Human),
            Self::Logistic => Box::new(Logistic::fit(training).ok_or(FitError::NoTraining(self))?),
        })
    }
}

impl fmt::Display for Baseline {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// There is no baseline of that name.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("no driver is called `{0}`; there are: {names}", names = Baseline::ALL.map(Baseline::name).join(", "))]
pub struct UnknownBaseline(String);

impl FromStr for Baseline {
    type Err = UnknownBaseline;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        Self::ALL
            .into_iter()
            .find(|baseline| baseline.name() == name)
            .ok_or_else(|| UnknownBaseline(name.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::episode::{End, Episode};
    use crate::evaluate::clearance;
    use crate::fixture::crossing;
    use crate::meeting::Meeting;
    use cede_data::encounter::Role;

    fn run(baseline: Baseline, training: &[&Encounter], encounter: &Encounter) -> Episode {
        let factory = baseline.fit(training).unwrap();
        let meeting = Meeting::new(encounter).unwrap();
        let mut drivers = [0, 1].map(|i| factory.driver(&meeting, i, 0));
        Episode::run(encounter, &mut drivers, Some(clearance(&meeting)))
    }

    #[test]
    fn names_are_read_back() {
        for baseline in Baseline::ALL {
            assert_eq!(baseline.name().parse(), Ok(baseline));
        }
        assert!("nobody".parse::<Baseline>().is_err());
    }

    #[test]
    fn what_learns_needs_training() {
        for baseline in Baseline::ALL {
            let learns = matches!(baseline, Baseline::MeanSpeed | Baseline::Logistic);
            assert_eq!(baseline.fit(&[]).is_err(), learns, "{baseline}");
        }
    }

    #[test]
    fn the_nearer_goes_and_the_other_waits() {
        for (left, other, first) in [
            ([15.0, 3.0], [25.0, 3.0], Role::Left),
            ([30.0, 3.0], [25.0, 3.0], Role::Other),
        ] {
            let episode = run(Baseline::NearerFirst, &[], &crossing(left, other));
            assert_eq!(episode.first(), Some(first));
            assert_eq!(episode.end, End::Finished);
        }
    }

    #[test]
    fn the_one_that_stopped_first_goes_first() {
        let encounter = crossing([12.0, 5.0], [30.0, 5.0]);
        let episode = run(Baseline::Idm, &[], &encounter);
        assert_eq!(episode.end, End::Finished);
        assert_eq!(episode.first(), Some(Role::Left));
        let slowest = |i: usize| {
            let speeds = episode.states.iter().map(|states| states[i].v);
            speeds.fold(f32::INFINITY, f32::min)
        };
        assert!(
            slowest(0) < 0.3 && slowest(1) < 0.3,
            "both stop at the sign"
        );
    }

    #[test]
    fn the_logistic_model_learns_who_goes_first() {
        // Whoever needs less time goes first: distance alone does not tell.
        let training: Vec<Encounter> = (0_u8..60)
            .map(|i| {
                let (x, y) = (f32::from(i % 10), f32::from(i / 10));
                crossing([20.0 + 2.0 * x, 4.0 + y], [30.0, 9.0 - y])
            })
            .collect();
        let references: Vec<&Encounter> = training.iter().collect();
        let model = Logistic::fit(&references).unwrap();
        let right = training.iter().filter(|e| model.first(e) == e.first);
        assert!(right.count() >= 57);
    }

    #[test]
    fn the_mean_speed_is_that_of_the_role() {
        let training = [crossing([20.0, 4.0], [30.0, 7.0])];
        let references: Vec<&Encounter> = training.iter().collect();
        let episode = run(
            Baseline::MeanSpeed,
            &references,
            &crossing([40.0, 6.0], [60.0, 6.0]),
        );
        let last = episode.states.last().unwrap();
        assert!((last[0].v - 4.0).abs() < 1e-4 && (last[1].v - 7.0).abs() < 1e-4);
    }
}
