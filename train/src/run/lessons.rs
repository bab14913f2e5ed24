//! What a run learns from.

use crate::driving::episodes::Course;
use cede_data::Encounter;
use cede_formats::property::StateProperty;
use cede_sim::ObservationModel;
use rayon::prelude::*;

/// What a run learns from, prepared once.
pub struct Lessons<'e> {
    /// The encounters to imitate, as episodes.
    pub courses: Vec<Course<'e>>,
    /// The observations in all encounters: first the [`Lessons::own`] ones to imitate, then the
    /// auxiliary ones, which only a refinement uses.
    pub models: Vec<ObservationModel<'e>>,
    /// Number of encounters to imitate; see [`Lessons::models`].
    pub own: usize,
    /// Properties that the policy shall have; only the analytic policy gradient learns them.
    pub claims: Vec<StateProperty>,
}

impl<'e> Lessons<'e> {
    /// Prepares the encounters to imitate and the auxiliary ones, on the threads of the current rayon pool.
    ///
    /// Cost: about 0.4 ms a bystander of an encounter.
    #[must_use]
    pub fn new(own: &[&'e Encounter], auxiliary: &[&'e Encounter]) -> Self {
        let courses: Vec<_> = own
            .par_iter()
            .map(|encounter| Course::new(encounter))
            .collect();
        let of_own = courses.par_iter().map(|course| course.model.clone());
        let of_auxiliary = auxiliary
            .par_iter()
            .map(|encounter| ObservationModel::new(encounter));
        Self {
            models: of_own.chain(of_auxiliary).collect(),
            courses,
            own: own.len(),
            claims: Vec::new(),
        }
    }
}
