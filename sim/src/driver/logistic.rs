//! Who goes first, by a logistic model of the initial state.

use super::nearer_first::Decided;
use super::right_of_way::CRUISE;
use super::{Driver, DriverFactory};
use crate::meeting::Meeting;
use crate::statistics::LogisticRegression;
use cede_data::Rights;
use cede_data::encounter::{Encounter, Manoeuvre, Role};
use std::collections::HashMap;

/// Distances to the conflict point and speeds of both: d, v, d̂, v̂.
const INPUTS: usize = 4;
/// A right of way has a model of its own with at least this many examples.
const ENOUGH: usize = 20;

/// The vehicle that a logistic model on the initial (d, v, d̂, v̂) expects first goes; the other stops.
///
/// One model for each manoeuvre of the vehicle that the left-turner meets and each right of way; without
/// examples enough one for the manoeuvre.
#[derive(Clone, Debug)]
pub struct Logistic {
    by_rights: HashMap<(Manoeuvre, Rights), LogisticRegression<INPUTS>>,
    models: HashMap<Manoeuvre, LogisticRegression<INPUTS>>,
    /// For a manoeuvre that did not occur in training.
    overall: LogisticRegression<INPUTS>,
}

impl Logistic {
    /// Fits the models; `None` if `training` is empty.
    #[must_use]
    pub fn fit(training: &[&Encounter]) -> Option<Self> {
        let mut samples: HashMap<Manoeuvre, Vec<_>> = HashMap::new();
        let mut by_rights: HashMap<(Manoeuvre, Rights), Vec<_>> = HashMap::new();
        let mut all = Vec::with_capacity(training.len());
        for encounter in training {
            let sample = (inputs(encounter), encounter.first == Role::Left);
            let manoeuvre = encounter.judged(Role::Other).manoeuvre;
            samples.entry(manoeuvre).or_default().push(sample);
            let rights = (manoeuvre, encounter.rights);
            by_rights.entry(rights).or_default().push(sample);
            all.push(sample);
        }
        Some(Self {
            overall: LogisticRegression::fit(&all)?,
            by_rights: by_rights
                .into_iter()
                .filter(|(_, s)| s.len() >= ENOUGH)
                .filter_map(|(key, s)| Some((key, LogisticRegression::fit(&s)?)))
                .collect(),
            models: samples
                .into_iter()
                .filter_map(|(manoeuvre, s)| Some((manoeuvre, LogisticRegression::fit(&s)?)))
                .collect(),
        })
    }

    /// Who goes first, by the initial state of `encounter`.
    #[must_use]
    pub fn first(&self, encounter: &Encounter) -> Role {
        let manoeuvre = encounter.judged(Role::Other).manoeuvre;
        let model = self
            .by_rights
            .get(&(manoeuvre, encounter.rights))
            .or_else(|| self.models.get(&manoeuvre))
            .unwrap_or(&self.overall);
        if model.probability(&inputs(encounter)) >= 0.5 {
            Role::Left
        } else {
            Role::Other
        }
    }
}

fn inputs(encounter: &Encounter) -> [f64; INPUTS] {
    let [[d, v], [other_d, other_v]] = Role::BOTH.map(|role| {
        let vehicle = encounter.judged(role);
        let (s, v) = vehicle
            .record
            .first()
            .map_or((0.0, 0.0), |sample| (sample.s, sample.v));
        [f64::from(vehicle.conflict_s - s), f64::from(v)]
    });
    [d, v, other_d, other_v]
}

impl DriverFactory for Logistic {
    fn name(&self) -> &str {
        "logistic"
    }

    fn driver<'m>(&self, meeting: &'m Meeting<'_>, _: usize, _: u64) -> Box<dyn Driver + 'm> {
        Box::new(Decided {
            first: self.first(meeting.encounter),
            cruise: CRUISE,
        })
    }
}
