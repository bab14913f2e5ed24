//! One step of the closed loop, and the tube that many make.

use super::scenario::{EGO, OTHER, Scenario, geometry};
use super::shield::{Commands, Shield, Zone, spent};
use super::states::{Moment, States};
use crate::interval::Interval;
use crate::policy::{Response, Subject};
use cede_controller::Real;
use cede_controller::RouteConflict;
use cede_controller::kinematics::STEP;
use cede_controller::shield::Contract;

/// The sets of states from one box of initial states, one a step.
#[derive(Clone, Debug, PartialEq)]
pub struct Tube {
    /// The moments, 0.1 s apart.
    pub moments: Vec<Moment>,
}

/// Allowance for the `f32` rounding of a step of the kinematics (m and m/s).
const ROUNDING: f64 = 2e-5;
/// Allowance for the `f32` rounding of a distance along a route of some hundred metres.
const PLACE: f64 = 1e-4;
/// The last of a zone (m) is not counted: whether one that is there has left it is a matter of
/// rounding. Zones are larger than they need be by ten times that.
const EDGE: f64 = 2e-3;
/// What is proposed when there is nobody left to meet, m/s².
const FREE: f64 = cede_controller::FREE as f64;
/// Largest proposal of any policy, m/s².
const MOST: f64 = cede_controller::policy::MAX_ACCELERATION as f64;

/// The closed loop of a scenario.
pub struct Loop<'a> {
    /// The policy; any proposal whatsoever without one.
    response: Option<Response<'a>>,
    pub(super) shield: Shield,
    /// Whether the shield is on.
    shielded: bool,
    other_acceleration: Interval,
}

impl<'a> Loop<'a> {
    /// The loop of `scenario`, with the embedded contract of the worst case.
    #[must_use]
    pub fn new(subject: &'a Subject<'a>, scenario: &Scenario) -> Self {
        let setting = scenario.setting();
        let junction = geometry(&setting);
        let conflict = junction.conflict(EGO, OTHER);
        let [ego_conflict, other_conflict] =
            conflict.map_or([0.0; 2], |c| [c.ego_conflict, c.other_conflict]);
        let offset = |from: f32, to: f32, conflict: f32| {
            let at = |x: f32| f64::from(x) - f64::from(conflict);
            Interval::new(at(from), at(to))
        };
        let mut zones = conflict.into_iter().flat_map(RouteConflict::zones);
        let zone = zones.next().map_or(
            Zone {
                ego: Interval::ZERO,
                other: Interval::ZERO,
            },
            |zone| Zone {
                ego: offset(zone.ego.from, zone.ego.to, ego_conflict),
                other: offset(zone.other.from, zone.other.to, other_conflict),
            },
        );
        let [least, most] = scenario.other_acceleration;
        Self {
            response: scenario.policy.then(|| Response::new(subject, setting)),
            shield: Shield {
                contract: Contract::WORST_CASE,
                zone,
            },
            shielded: scenario.shield,
            other_acceleration: Interval::new(least, most),
        }
    }

    /// The states of a box.
    pub(super) fn start(&self, [d, v, other_d, other_v]: Moment) -> States {
        let side = |[lo, hi]: [f64; 2]| Interval::new(lo, hi);
        let mut states = States {
            distance: side(d),
            speed: side(v),
            other_distance: side(other_d),
            other_speed: side(other_v),
            spare: Interval::new(f64::NEG_INFINITY, f64::INFINITY),
        };
        states.spare = self.spare_of(&states);
        states
    }

    fn spare_of(&self, states: &States) -> Interval {
        let braking = Interval::of(self.shield.contract.ego().braking);
        let stop = states.speed.mul(states.speed).div(braking.scale(2.0));
        states.distance.add(self.shield.zone.ego.low()).sub(stop)
    }

    /// All states after one step, and the commands that lead there; `previous` are those in effect.
    pub(super) fn step(&self, before: &States, previous: Interval) -> (States, Interval) {
        let sides = [
            before.distance.wider(PLACE),
            before.speed,
            before.other_distance.wider(PLACE),
            before.other_speed,
        ];
        let answer = self.response.as_ref().map(|response| response.on(sides));
        let proposal = answer
            .as_ref()
            .map_or(Interval::new(-MOST, MOST), |answer| answer.range);
        let asked = self.asked(before);
        let wanted = match asked {
            Asked::Always => proposal,
            Asked::Perhaps => proposal.hull(Interval::point(FREE)),
            Asked::Never => Interval::point(FREE),
        };
        let commands = if self.shielded {
            self.shield.commands(before, previous, wanted)
        } else {
            Commands {
                range: wanted,
                stops_short: false,
            }
        };
        let command = commands.range;
        let period = Interval::of(STEP);

        let free = before.speed.add(command.mul(period));
        let mut speed = free.clamp(0.0, f64::INFINITY);
        // Where the policy's own answer is what is done, the speed after the step as a mean value.
        if let (Some(answer), Asked::Always) = (&answer, asked)
            && command == proposal
        {
            let mut after = Interval::point(before.speed.middle()).add(answer.middle.mul(period));
            for (k, (side, slope)) in sides.iter().zip(answer.slopes).enumerate() {
                let own = Interval::point(f64::from(u8::from(k == 1)));
                let step = side.sub(Interval::point(side.middle()));
                if step.magnitude() > 0.0 {
                    after = after.add(own.add(slope.mul(period)).mul(step));
                }
            }
            speed = speed.and(after.clamp(0.0, f64::INFINITY));
        }
        // Perhaps it is not accelerated beyond its limit.
        let limit = Interval::of(self.shield.contract.ego().max_speed);
        speed = speed.hull(Real::min(speed, Real::max(limit, before.speed)));
        let speed = speed.wider(ROUNDING).clamp(0.0, f64::INFINITY);
        let travel = before.speed.add(speed).mul(period).scale(0.5);
        // One that comes to rest within the step travels no farther than that, and no less than nothing.
        let stops = free.lo < 0.0;
        let travel = Interval::new(if stops { 0.0 } else { travel.lo.max(0.0) }, travel.hi);
        let distance = before.distance.sub(travel).wider(ROUNDING);

        let (other_distance, other_speed) = self.other(before);
        let braking = Interval::of(self.shield.contract.ego().braking);
        let lost = spent(before.speed, speed, period, braking).clamp(0.0, f64::INFINITY);
        let mut spare = before
            .spare
            .sub(Interval::new(if stops { 0.0 } else { lost.lo }, lost.hi));
        if commands.stops_short {
            // Braking uses up nothing of what there is to spare, and a command that is accepted for
            // its stop leaves the slack: the latency that was counted on is not needed here.
            let left = f64::from(self.shield.contract.slack()) - super::shield::STOPPING;
            let least = before.spare.lo.min(left);
            spare = spare.clamp(least, f64::INFINITY);
        }
        let after = States {
            distance,
            speed,
            other_distance,
            other_speed,
            spare: spare.wider(ROUNDING),
        };
        (self.reconciled(after), command)
    }

    /// Cuts what distance, speed and what is to spare exclude of each other.
    fn reconciled(&self, mut states: States) -> States {
        states.spare = states.spare.and(self.spare_of(&states));
        let braking = Interval::of(self.shield.contract.ego().braking).scale(2.0);
        let entry = self.shield.zone.ego.low();
        let stop = states.speed.mul(states.speed).div(braking);
        let least = states.spare.add(stop).sub(entry).lo;
        states.distance = states.distance.clamp(least, f64::INFINITY);
        let room = states.distance.add(entry).sub(states.spare);
        let fastest = Real::sqrt(room.clamp(0.0, f64::INFINITY).mul(braking)).hi;
        states.speed = states.speed.clamp(0.0, fastest);
        states
    }

    /// The states without those in which either is past the zone: of these nothing is left to show.
    pub(super) fn not_past(&self, states: States) -> Option<States> {
        let behind = |distance: Interval, zone: Interval| {
            let end = EDGE - zone.hi;
            (distance.hi >= end).then(|| distance.clamp(end, f64::INFINITY))
        };
        Some(States {
            distance: behind(states.distance, self.shield.zone.ego)?,
            other_distance: behind(states.other_distance, self.shield.zone.other)?,
            ..states
        })
    }

    fn other(&self, before: &States) -> (Interval, Interval) {
        let period = Interval::of(STEP);
        let free = before.other_speed.add(self.other_acceleration.mul(period));
        let most = f64::from(self.shield.contract.other().max_speed).max(before.other_speed.hi);
        let speed = free
            .clamp(0.0, most)
            .wider(ROUNDING)
            .clamp(0.0, f64::INFINITY);
        let travel = before.other_speed.add(speed).mul(period).scale(0.5);
        let travel = Interval::new(
            if free.lo < 0.0 {
                0.0
            } else {
                travel.lo.max(0.0)
            },
            travel.hi,
        );
        (before.other_distance.sub(travel).wider(ROUNDING), speed)
    }

    /// Whether the controller asks its policy: while neither is past the zone.
    fn asked(&self, states: &States) -> Asked {
        let ends = [
            states.distance.add(self.shield.zone.ego.high()),
            states.other_distance.add(self.shield.zone.other.high()),
        ];
        if ends.iter().all(|end| end.lo > PLACE) {
            Asked::Always
        } else if ends.iter().any(|end| end.hi < -PLACE) {
            Asked::Never
        } else {
            Asked::Perhaps
        }
    }

    /// Whether the ego can be in its zone, and whether the other can be in its own.
    pub(super) fn in_zone(&self, states: &States) -> [bool; 2] {
        let within = |distance: Interval, zone: Interval| {
            (-distance).meets(Interval::new(zone.lo, zone.hi - EDGE))
        };
        [
            within(states.distance, self.shield.zone.ego),
            within(states.other_distance, self.shield.zone.other),
        ]
    }

    /// The tube from a box of initial states.
    #[must_use]
    pub fn tube(&self, from: Moment, steps: usize) -> Tube {
        let mut states = self.start(from);
        let mut previous = Interval::new(-MOST, MOST);
        let mut moments = vec![states.moment()];
        for _ in 0..steps {
            (states, previous) = self.step(&states, previous);
            moments.push(states.moment());
        }
        Tube { moments }
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Asked {
    Always,
    Perhaps,
    Never,
}
