//! Cede's learner.

use crate::{ACTIONS, FEATURES, Update, batch};
use cede_train::algorithm::sac::Rates;
use cede_train::algorithm::sac::learner::Learner;
use rand::SeedableRng;
use rand_pcg::Pcg64;

/// Cede's update with hidden layers of `width`.
#[must_use]
pub fn cede(width: usize) -> Update {
    let (batch, rates) = (batch(), Rates::default());
    let mut random = Pcg64::seed_from_u64(2);
    let mut learner = Learner::new(FEATURES, ACTIONS, width, &rates, &mut random);
    Box::new(move || Ok(learner.update(&batch, &rates, &mut random).critic))
}
