//! What a step has led to: collisions, SVO, rewards and outcomes.

use super::{Block, Outcome};
use crate::batch::Lanes;
use crate::batch::lanes::{separation, svo, svo_deviation};
use crate::batch::library::Library;
use crate::reward::{COLLISION, PAST_THE_RECORD};
use cede_data::encounter::Role;
use wide::f32x8;

impl<const N: usize> Block<N> {
    /// Distances, SVO, rewards and outcomes of the states that the step has led to.
    #[inline]
    pub(super) fn score(&mut self, library: &Library) {
        self.gap = self.least_gap(library);
        let [left, other] = [&self.vehicles[0], &self.vehicles[1]];
        let speed = [left.v, other.v].map(f32x8::from);
        let distance = [
            f32x8::from(self.conflict_s[0]) - f32x8::from(left.s),
            f32x8::from(self.conflict_s[1]) - f32x8::from(other.s),
        ];
        self.distance = distance.map(f32x8::to_array);
        let svo = svo(speed, distance, self.svo.into());
        self.svo = svo.to_array();

        let (step, recorded) = (f32x8::from(self.step), f32x8::from(self.recorded));
        let arrived = distance[0].simd_le(f32x8::ZERO) | distance[1].simd_le(f32x8::ZERO);
        let collided = f32x8::from(self.gap).simd_le(f32x8::ZERO);
        let late = step.simd_ge(recorded + recorded);

        let reference = f32x8::from(self.reference.map(|index| library.svo(index)));
        let past_record = f32x8::splat(PAST_THE_RECORD);
        let deviation = svo_deviation(svo, reference);
        let compared = step.simd_lt(recorded).bitselect(deviation, past_record);
        // At the conflict point itself the SVO is pinned, and says nothing.
        let social = arrived.bitselect(f32x8::ZERO, compared);
        let reward = collided.bitselect(f32x8::splat(COLLISION), f32x8::ZERO) - social;
        self.reward = reward.to_array();
        self.earned = (f32x8::from(self.earned) + reward).to_array();
        self.speeds = (f32x8::from(self.speeds) + (speed[0] + speed[1])).to_array();

        let mut ended = (arrived | collided | late).to_bitmask();
        self.ended |= ended;
        while ended != 0 {
            let lane = ended.trailing_zeros() as usize;
            self.outcome[lane] = self.verdict(lane);
            ended &= ended - 1;
        }
    }

    fn verdict(&self, lane: usize) -> Outcome {
        let past = [-self.distance[0][lane], -self.distance[1][lane]];
        if self.gap[lane] <= 0.0 {
            Outcome::Collided
        } else if past[0] >= 0.0 || past[1] >= 0.0 {
            // Both in one step: whoever reached it after the lesser share of its way, as in `Episode`.
            let [moved, other_moved] =
                [&self.vehicles[0], &self.vehicles[1]].map(|m| m.moved[lane]);
            let earlier = past[0] * other_moved >= past[1] * moved;
            let left = past[1] < 0.0 || (past[0] >= 0.0 && earlier);
            Outcome::Arrived(if left { Role::Left } else { Role::Other })
        } else if self.step[lane] >= 2.0 * self.recorded[lane] {
            Outcome::TimedOut
        } else {
            Outcome::Running
        }
    }

    #[inline]
    fn least_gap(&self, library: &Library) -> Lanes {
        let mut least = f32x8::splat(f32::INFINITY);
        for ego in 0..2 {
            for other in ego + 1..N {
                least = self.narrow(ego, other, library, least);
            }
        }
        least.to_array()
    }

    /// The lesser of `least` and the separation of two vehicles, where both are there.
    #[inline]
    fn narrow(&self, ego: usize, other: usize, library: &Library, least: f32x8) -> f32x8 {
        let (a, b) = (self.vehicles[ego].boxes(), self.vehicles[other].boxes());
        let [x, y] = [b.centre[0] - a.centre[0], b.centre[1] - a.centre[1]];
        if (x * x + y * y)
            .simd_gt(f32x8::splat(library.reach_squared))
            .all()
        {
            return least;
        }
        let gap = separation(a, b, library.footprint);
        let mut counts = gap.simd_lt(least);
        if other >= 2 {
            counts &= self.presence[other].mask(self.step);
        }
        counts.bitselect(gap, least)
    }
}
