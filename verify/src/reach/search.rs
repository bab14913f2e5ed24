//! Branching over the initial states until every tube shows the claim.

use super::scenario::{Claim, Scenario};
use super::states::{Moment, States};
use super::step::Loop;
use crate::interval::Interval;
use crate::policy::Subject;
use cede_controller::kinematics::STEP;
use rayon::prelude::*;
use std::time::Instant;

/// How a scenario was settled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Finding {
    /// Every trajectory is as claimed.
    Proved,
    /// Not shown for these initial states, however small the box, or not in time.
    Unsettled(Moment),
}

/// A finding and what it took.
#[derive(Clone, Debug, PartialEq)]
pub struct Settled {
    /// How it ended.
    pub finding: Finding,
    /// Tubes that were followed.
    pub tubes: u64,
    /// For an arrival: by when all have arrived, in s.
    pub latest: f64,
    /// The hull of all tubes, 0.1 s apart, as far as they were followed.
    pub hull: Vec<Moment>,
}

/// Boxes of initial states followed side by side.
const ROUND: usize = 64;
/// A box is not cut any more often than this.
const CUTS: u32 = 24;

enum Outcome {
    Shown { steps: usize, moments: Vec<Moment> },
    Open,
}

/// Settles a scenario. The same on any number of threads, as long as the time suffices.
#[must_use]
pub fn settle(subject: &Subject<'_>, scenario: &Scenario, deadline: Instant) -> Settled {
    let closed = Loop::new(subject, scenario);
    let mut settled = Settled {
        finding: Finding::Proved,
        tubes: 0,
        latest: 0.0,
        hull: Vec::new(),
    };
    let mut stack = vec![(scenario.region(), 0)];
    while !stack.is_empty() {
        let batch = stack.split_off(stack.len().saturating_sub(ROUND));
        settled.tubes += batch.len() as u64;
        let follow =
            |(region, cuts): (Moment, u32)| (region, cuts, follow(&closed, scenario.claim, region));
        let done: Vec<_> = batch.into_par_iter().map(follow).collect();
        for (region, cuts, outcome) in done {
            match outcome {
                Outcome::Shown { steps, moments } => {
                    settled.latest = settled.latest.max(steps as f64 * f64::from(STEP));
                    widen(&mut settled.hull, &moments);
                }
                Outcome::Open if cuts < CUTS && Instant::now() < deadline => {
                    stack.extend(halves(region).map(|half| (half, cuts + 1)));
                }
                Outcome::Open => {
                    settled.finding = Finding::Unsettled(region);
                    return settled;
                }
            }
        }
    }
    settled
}

/// Follows the tube of a box until the claim is shown, or cannot be.
fn follow(closed: &Loop<'_>, claim: Claim, region: Moment) -> Outcome {
    let (Claim::Arrives { within: time, .. } | Claim::NeverBoth { during: time }) = claim;
    let steps = (time / f64::from(STEP)).floor() as usize;
    let mut states = closed.start(region);
    let most = f64::from(cede_controller::policy::MAX_ACCELERATION);
    let mut previous = Interval::new(-most, most);
    let mut moments = vec![states.moment()];
    for step in 0..=steps {
        match verdict(closed, claim, &states) {
            Verdict::Shown => {
                return Outcome::Shown {
                    steps: step,
                    moments,
                };
            }
            Verdict::Broken => return Outcome::Open,
            Verdict::GoOn => {}
        }
        if step == steps {
            break;
        }
        let (after, command) = closed.step(&states, previous);
        let between = states.hull(&after);
        if matches!(claim, Claim::NeverBoth { .. }) && closed.in_zone(&between) == [true; 2] {
            return Outcome::Open;
        }
        moments.push(after.moment());
        let left = match claim {
            Claim::NeverBoth { .. } => closed.not_past(after),
            Claim::Arrives { .. } => Some(after),
        };
        let Some(left) = left else {
            return Outcome::Shown {
                steps: step + 1,
                moments,
            };
        };
        (states, previous) = (left, command);
    }
    match claim {
        Claim::Arrives { .. } => Outcome::Open,
        Claim::NeverBoth { .. } => Outcome::Shown { steps, moments },
    }
}

enum Verdict {
    Shown,
    Broken,
    GoOn,
}

fn verdict(closed: &Loop<'_>, claim: Claim, states: &States) -> Verdict {
    match claim {
        Claim::Arrives { at_least, .. } => {
            if states.distance.hi <= 0.0 {
                Verdict::Shown
            } else if states.speed.lo < at_least {
                Verdict::Broken
            } else {
                Verdict::GoOn
            }
        }
        Claim::NeverBoth { .. } if closed.in_zone(states) == [true; 2] => Verdict::Broken,
        Claim::NeverBoth { .. } => Verdict::GoOn,
    }
}

/// Halves a box across the variable that is widest beside its usual range.
fn halves(region: Moment) -> [Moment; 2] {
    let usual = [8.0, 1.0, 16.0, 2.0];
    let share = |i: usize| (region[i][1] - region[i][0]) / usual[i];
    let widest = (1..4).fold(0, |best, i| if share(i) > share(best) { i } else { best });
    let at = 0.5 * (region[widest][0] + region[widest][1]);
    let (mut below, mut above) = (region, region);
    below[widest][1] = at;
    above[widest][0] = at;
    [above, below]
}

fn widen(hull: &mut Vec<Moment>, moments: &[Moment]) {
    for (all, one) in hull.iter_mut().zip(moments) {
        for (all, one) in all.iter_mut().zip(one) {
            *all = [all[0].min(one[0]), all[1].max(one[1])];
        }
    }
    let known = hull.len().min(moments.len());
    hull.extend_from_slice(&moments[known..]);
}

impl States {
    fn hull(&self, other: &Self) -> Self {
        Self {
            distance: self.distance.hull(other.distance),
            speed: self.speed.hull(other.speed),
            other_distance: self.other_distance.hull(other.other_distance),
            other_speed: self.other_speed.hull(other.other_speed),
            spare: self.spare.hull(other.spare),
        }
    }
}
