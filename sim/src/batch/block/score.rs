//! What a step has led to: collisions, SVO, rewards and outcomes.

use super::{Block, Outcome};
use crate::batch::library::Library;
use crate::reward::{COLLISION, PAST_THE_RECORD, svo_deviation};
use crate::stepper::{Eight, End, Step, first};
use cede_controller::policy::svo::svo;
use cede_controller::{Elementary, Real};
use cede_data::encounter::Role;

impl<const N: usize> Block<N> {
    /// Distances, SVO, rewards and outcomes of the states that the step has led to.
    #[inline]
    pub(super) fn score(&mut self, step: &Step<Eight>, library: &Library) {
        self.gap = step.gap.lanes();
        self.distance = step.distance.map(Eight::lanes);
        let [left, other] = step.states;
        let [d, other_d] = step.distance;
        let svo = svo(left.v, d, other.v, other_d, self.svo.into());
        self.svo = svo.lanes();

        let reference = self.reference.map(|index| library.svo(index));
        let deviation = svo_deviation(svo, reference.into());
        let past_record = step.taken - self.recorded.into();
        let compared = past_record.not_negative(Eight::of(PAST_THE_RECORD), deviation);
        // At the conflict point itself the SVO is pinned, and says nothing.
        let nothing = Eight::of(0.0);
        let social = step.if_arrived(nothing, compared);
        let reward = step.if_touching(Eight::of(COLLISION), nothing) - social;
        self.reward = reward.lanes();
        self.earned = (Eight::from(self.earned) + reward).lanes();
        self.speeds = (Eight::from(self.speeds) + (left.v + other.v)).lanes();

        let mut ended = step.margin().not_positive();
        self.ended |= ended;
        while ended != 0 {
            let lane = ended.trailing_zeros() as usize;
            self.outcome[lane] = outcome(&step.lane(lane));
            ended &= ended - 1;
        }
    }

    /// The least separation (m) of a judged vehicle from any other that is there.
    #[inline]
    pub(super) fn least_gap(&self, library: &Library) -> Eight {
        let mut least = Eight::of(f32::INFINITY);
        for ego in 0..2 {
            for other in ego + 1..N {
                least = self.narrow(ego, other, library, least);
            }
        }
        least
    }

    /// The lesser of `least` and the separation of two vehicles, where both are there.
    #[inline]
    fn narrow(&self, ego: usize, other: usize, library: &Library, least: Eight) -> Eight {
        let [a, b] = [ego, other].map(|i| self.vehicles[i].outlines(library.footprint));
        let reach = Eight::of(library.reach_squared);
        if a.centres_apart_squared(&b).all_greater(reach) {
            return least;
        }
        let lesser = least.min(a.separation(&b));
        if other < 2 {
            return lesser;
        }
        let there = [self.presence[other].from, self.presence[other].until];
        lesser.during(there.map(Eight::from), self.step.into(), least)
    }
}

/// How far an episode has come with its last `step`.
fn outcome(step: &Step) -> Outcome {
    match (step.end(), first(step.arrivals())) {
        (None, _) => Outcome::Running,
        (Some(End::Collision), _) => Outcome::Collided,
        (Some(End::Finished), Some(Role::Other)) => Outcome::Arrived(Role::Other),
        (Some(End::Finished), _) => Outcome::Arrived(Role::Left),
        (Some(End::TimeOut), _) => Outcome::TimedOut,
    }
}
