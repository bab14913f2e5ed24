//! One step of an episode: the two judged vehicles move, may touch, may arrive, and the episode may end.
//!
//! [`step`] is written once, for every number. Evaluation and training step one encounter
//! at a time on `f32` ([`Stepper`]); the batch steps eight on vectors ([`crate::batch::Block`]).
//! Campaigns and the differentiable roll-out need only its motion, [`advance`]: the former judge contacts by
//! rapier2d and have no conflict point, the latter has neither contacts nor an end.

mod lanes;

pub(crate) use lanes::Eight;

use cede_controller::Elementary;
use cede_controller::Footprint;
use cede_controller::kinematics::{self, State};
use cede_controller::separation::OrientedBox;
use cede_data::encounter::{Encounter, Role};

/// How an episode ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum End {
    /// As it should: see [`crate::episode::Until`].
    Finished,
    /// The two footprints touched.
    Collision,
    /// Not finished in time: a face-off.
    TimeOut,
}

/// What ends an episode, beside a collision.
#[derive(Clone, Copy, Debug)]
pub struct Goal<R = f32> {
    /// Arc lengths (m) of the judged vehicles' conflict points.
    pub conflict_s: [R; 2],
    /// The episode is finished when both have passed these arc lengths (m); without them, when the
    /// first reaches its conflict point.
    pub exits: Option<[R; 2]>,
    /// Steps after which it is a time-out.
    pub limit: R,
}

/// A step, and what it has led to.
///
/// What can end an episode is a margin that is positive as long as it does not, so that vectors need no branches.
#[derive(Clone, Copy, Debug)]
pub struct Step<R = f32> {
    /// States before the step.
    before: [State<R>; 2],
    /// States after the step.
    pub states: [State<R>; 2],
    /// Steps since the start, this one included.
    pub taken: R,
    /// Separation (m) of a judged vehicle from what it may touch.
    pub gap: R,
    conflict_s: [R; 2],
    /// Metres that each still has to go to its conflict point.
    pub distance: [R; 2],
    /// Metres to the finish.
    finish: R,
    /// Steps left to the time-out.
    left: R,
}

/// Moves every vehicle by one step under its acceleration (m/s²), taken as it is.
#[inline]
pub fn advance<R: Elementary>(states: &mut [State<R>], accelerations: &[R]) {
    for (state, &acceleration) in states.iter_mut().zip(accelerations) {
        *state = kinematics::advance(*state, acceleration);
    }
}

/// Moves the two judged vehicles by one step and says what that has led to.
///
/// `taken`: steps before this one. `accelerations` (m/s²) are taken as they are. `gap` gives the
/// separation (m) of a judged vehicle from what it may touch, from the states after the step.
#[inline]
pub fn step<R: Elementary>(
    goal: &Goal<R>,
    taken: R,
    before: [State<R>; 2],
    accelerations: [R; 2],
    gap: impl FnOnce(&[State<R>; 2]) -> R,
) -> Step<R> {
    let mut states = before;
    advance(&mut states, &accelerations);
    let taken = taken + R::of(1.0);
    let to = |ends: &[R; 2]| [ends[0] - states[0].s, ends[1] - states[1].s];
    let distance = to(&goal.conflict_s);
    let finish = match goal.exits.as_ref().map(to) {
        None => distance[0].min(distance[1]),
        Some([left, other]) => left.max(other),
    };
    Step {
        before,
        states,
        taken,
        gap: gap(&states),
        conflict_s: goal.conflict_s,
        distance,
        finish,
        left: goal.limit - taken,
    }
}

impl<R: Elementary> Step<R> {
    /// `then` if the vehicles touch, else `otherwise`.
    #[must_use]
    #[inline]
    pub fn if_touching(&self, then: R, otherwise: R) -> R {
        (-self.gap).not_negative(then, otherwise)
    }

    /// `then` if a vehicle is at its conflict point or beyond it, else `otherwise`.
    #[must_use]
    #[inline]
    pub fn if_arrived(&self, then: R, otherwise: R) -> R {
        (-self.distance[0].min(self.distance[1])).not_negative(then, otherwise)
    }

    /// The least margin: the episode is over if it is not positive.
    #[must_use]
    #[inline]
    pub fn margin(&self) -> R {
        self.left.min(self.finish).min(self.gap)
    }
}

impl Step {
    /// Whether the vehicles touch.
    #[must_use]
    pub fn touching(&self) -> bool {
        self.gap <= 0.0
    }

    /// Whether a vehicle is at its conflict point or beyond it.
    #[must_use]
    pub fn arrived(&self) -> bool {
        self.distance.iter().any(|&distance| distance <= 0.0)
    }

    /// How the step has ended the episode; `None` if it goes on.
    #[must_use]
    pub fn end(&self) -> Option<End> {
        if self.touching() {
            Some(End::Collision)
        } else if self.finish <= 0.0 {
            Some(End::Finished)
        } else {
            (self.left <= 0.0).then_some(End::TimeOut)
        }
    }

    /// When each reached its conflict point, in steps from the start and within the step by linear
    /// interpolation: at the step's start if it had been there before, `None` if it is not there yet.
    #[must_use]
    pub fn arrivals(&self) -> [Option<f32>; 2] {
        [0, 1].map(|i| {
            let (before, after) = (self.before[i].s, self.states[i].s);
            let covered = (self.conflict_s[i] - before) / (after - before).max(f32::EPSILON);
            let when = self.taken - 1.0 + covered.clamp(0.0, 1.0);
            (self.distance[i] <= 0.0).then_some(when)
        })
    }
}

impl Step<Eight> {
    /// The step of one of the eight.
    pub(crate) fn lane(&self, lane: usize) -> Step {
        let one = |eight: Eight| eight.lanes()[lane];
        let state = |state: State<Eight>| State {
            s: one(state.s),
            v: one(state.v),
        };
        Step {
            before: self.before.map(state),
            states: self.states.map(state),
            taken: one(self.taken),
            gap: one(self.gap),
            conflict_s: self.conflict_s.map(one),
            distance: self.distance.map(one),
            finish: one(self.finish),
            left: one(self.left),
        }
    }
}

/// Who arrived first; the left-turner in a tie, `None` if nobody did.
#[must_use]
pub fn first(arrivals: [Option<f32>; 2]) -> Option<Role> {
    match arrivals {
        [None, None] => None,
        [Some(left), Some(other)] if other < left => Some(Role::Other),
        [Some(_), _] => Some(Role::Left),
        [None, Some(_)] => Some(Role::Other),
    }
}

/// Steps the two judged vehicles of an encounter, both 5.0 m × 2.0 m as the paper's.
#[derive(Clone, Copy, Debug)]
pub struct Stepper<'e> {
    encounter: &'e Encounter,
    goal: Goal,
}

impl<'e> Stepper<'e> {
    /// Episodes of `encounter` that end at the conflict point, or with `clearance` when both have passed these
    /// arc lengths (m).
    #[must_use]
    pub fn new(encounter: &'e Encounter, clearance: Option<[f32; 2]>) -> Self {
        let goal = Goal {
            conflict_s: Role::BOTH.map(|role| encounter.judged(role).conflict_s),
            exits: clearance,
            limit: time_limit(encounter, clearance) as f32,
        };
        Self { encounter, goal }
    }

    /// The states in which an episode begins: the recorded ones.
    #[must_use]
    pub fn start(&self) -> [State; 2] {
        Role::BOTH.map(|role| {
            let first = self.encounter.judged(role).record.first();
            first.map_or_else(State::default, |sample| State {
                s: sample.s,
                v: sample.v,
            })
        })
    }

    /// One step from `states`, `taken` steps after the start, under `accelerations` (m/s²), taken as they are.
    #[must_use]
    pub fn step(&self, taken: usize, states: [State; 2], accelerations: [f32; 2]) -> Step {
        step(&self.goal, taken as f32, states, accelerations, |states| {
            let [left, other] = Role::BOTH.map(|role| {
                let route = &self.encounter.judged(role).route;
                OrientedBox::new(route.pose(states[role as usize].s), Footprint::PAPER)
            });
            left.separation(&other)
        })
    }
}

/// Steps after which an episode is a time-out: twice what was recorded.
fn time_limit(encounter: &Encounter, clearance: Option<[f32; 2]>) -> u32 {
    let recorded = clearance.map_or(encounter.steps, |exits| {
        let left_zone = Role::BOTH.map(|role| {
            let record = &encounter.judged(role).record;
            record.partition_point(|sample| sample.s < exits[role as usize])
        });
        encounter.steps.max(left_zone[0].max(left_zone[1]) as u32)
    });
    2 * recorded
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::crossing;

    /// The first step of a stepper under `accelerations`.
    fn first_step(encounter: &Encounter, accelerations: [f32; 2]) -> Step {
        let stepper = Stepper::new(encounter, None);
        stepper.step(0, stepper.start(), accelerations)
    }

    #[test]
    fn both_arrive_in_one_step_and_the_share_of_the_way_decides() {
        // 1 m a step: the left-turner has 0.75 m to go, the other 0.5 m.
        let encounter = crossing([0.75, 10.0], [0.5, 10.0]);
        let step = first_step(&encounter, [0.0; 2]);
        let arrivals = step.arrivals().map(Option::unwrap);
        assert!((arrivals[0] - 0.75).abs() < 1e-4 && (arrivals[1] - 0.5).abs() < 1e-4);
        assert_eq!(first(step.arrivals()), Some(Role::Other));
        assert!(step.arrived() && step.if_arrived(1.0, 0.0) == 1.0);
        let tie = crossing([0.5, 10.0], [0.5, 10.0]);
        assert_eq!(
            first(first_step(&tie, [0.0; 2]).arrivals()),
            Some(Role::Left)
        );
    }

    #[test]
    fn a_collision_goes_before_an_arrival_and_an_arrival_before_a_time_out() {
        let goal = Goal {
            conflict_s: [1.0, 100.0],
            exits: None,
            limit: 5.0,
        };
        let states = [State { s: 0.5, v: 10.0 }; 2];
        let end = |taken: f32, gap: f32, goal: &Goal| {
            let step = step(goal, taken, states, [0.0; 2], |_| gap);
            assert_eq!(step.end().is_some(), step.margin() <= 0.0);
            step.end()
        };
        assert_eq!(end(4.0, 0.0, &goal), Some(End::Collision));
        assert_eq!(end(4.0, 0.1, &goal), Some(End::Finished));
        let far = Goal {
            conflict_s: [50.0, 100.0],
            ..goal
        };
        assert_eq!(end(4.0, 0.1, &far), Some(End::TimeOut));
        assert_eq!(end(3.0, 0.1, &far), None);
    }

    #[test]
    fn with_exits_an_episode_is_finished_when_the_last_has_left() {
        let goal = |exits| Goal {
            conflict_s: [1.0; 2],
            exits: Some(exits),
            limit: 100.0,
        };
        let states = [State { s: 0.5, v: 10.0 }; 2];
        let end = |exits| step(&goal(exits), 0.0, states, [0.0; 2], |_| 1.0).end();
        assert_eq!(end([1.25, 1.75]), None);
        assert_eq!(end([1.25, 1.5]), Some(End::Finished));
    }
}
