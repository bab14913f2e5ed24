//! What drives a vehicle at every intersection.

use super::Approach;
use crate::junction::{Junction, PathId};
use crate::policy::pair::Part;
use crate::policy::traffic::TrafficContext;
use crate::policy::{Orientation, OrientationError, Policy};
use crate::shield::{Contract, EnterError, Shield};
use heapless::Vec;

/// What drives a vehicle, at every intersection: `'w` is the life of the policy's weights.
#[derive(Clone, Copy, Debug)]
pub struct Drive<'w> {
    policy: Policy<'w>,
    contract: Contract,
    part: Part,
    #[cfg(feature = "estimates")]
    estimates: bool,
}

impl<'w> Drive<'w> {
    /// Drives with `policy` within `contract`; `part` is the one that a joint policy gives the ego.
    #[must_use]
    pub const fn new(policy: Policy<'w>, contract: Contract, part: Part) -> Self {
        Self {
            policy,
            contract,
            part,
            #[cfg(feature = "estimates")]
            estimates: false,
        }
    }

    /// Whether the orientations of others are estimated at every intersection to come. See [`Approach::set_estimates`].
    #[cfg(feature = "estimates")]
    pub const fn set_estimates(&mut self, wanted: bool) {
        self.estimates = wanted;
    }

    /// Shows `orientation` at every intersection to come. See [`Approach::set_orientation`].
    ///
    /// # Errors
    /// See [`Policy::oriented`]; nothing is changed then.
    pub fn set_orientation(&mut self, orientation: Orientation) -> Result<(), OrientationError> {
        self.policy = self.policy.oriented(orientation)?;
        Ok(())
    }

    /// Begins to approach `junction` on `path`, and watches up to [`crate::MAX_OTHERS`] others that matter.
    ///
    /// # Errors
    /// See [`EnterError`].
    pub fn enter<'j, const R: usize, const P: usize, const E: usize>(
        &self,
        junction: &'j Junction<R, P, E>,
        path: PathId,
    ) -> Result<Approach<'j, 'w>, EnterError> {
        self.enter_with_room(junction, path)
    }

    /// [`Drive::enter`], watching up to `N` others, 1 to [`crate::MAX_OTHERS`].
    ///
    /// # Errors
    /// See [`EnterError`].
    pub fn enter_with_room<'j, const N: usize, const R: usize, const P: usize, const E: usize>(
        &self,
        junction: &'j Junction<R, P, E>,
        path: PathId,
    ) -> Result<Approach<'j, 'w, N>, EnterError> {
        Ok(Approach {
            policy: self.policy,
            part: self.part,
            shield: Shield::enter(self.contract, junction, path)?,
            orientations: Vec::new(),
            #[cfg(feature = "estimates")]
            filters: self.estimates.then(Vec::new),
            around: TrafficContext::default(),
            prediction: None,
        })
    }
}
