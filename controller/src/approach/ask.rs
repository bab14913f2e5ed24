//! Whom the policy is asked about, and what it proposes.

use super::Approach;
use super::nearby::{Nearby, nearby, traffic};
use crate::decision::Prediction;
use crate::fault::Fault;
use crate::instant::Instant;
use crate::junction::{Path, Way};
use crate::observation::{Observation, Vehicle};
use crate::policy::features::arrival;
use crate::policy::pair::{Pair, VehicleState};
use crate::policy::svo;
use crate::shield::door;
use heapless::Vec;

impl<'j, const N: usize> Approach<'j, '_, N> {
    /// What the policy proposes, and at least `first` (m/s²) for those over whom the ego has precedence; nothing, if nobody
    /// is left to meet. And what the path's profile allows (m/s²). Not inlined, because its stack is free again when the shield needs its own.
    #[inline(never)]
    pub(super) fn ask(
        &mut self,
        now: Option<Instant>,
        observation: &Observation<'_>,
        first: f32,
    ) -> Result<(Option<(f32, Prediction)>, f32), Fault> {
        let (way, contract) = (self.shield.way(), self.shield.contract());
        let ego = door::ego(way, contract, &observation.ego)?.vehicle;
        let nearby = nearby::<N>(way, contract, &ego, observation.tracks);
        let (profile, response) = (way.profile(), contract.response());
        let limit = profile.acceleration(ego.s, ego.speed, response);
        Ok((self.propose(now, way, &ego, &nearby, first), limit))
    }

    fn propose(
        &mut self,
        now: Option<Instant>,
        way: Way<'j>,
        ego: &Vehicle,
        nearby: &Vec<Nearby<'j>, N>,
        first: f32,
    ) -> Option<(f32, Prediction)> {
        // Only estimates need the time.
        #[cfg(not(feature = "estimates"))]
        let _ = now;
        let mine = way.path(way.ego())?;
        let (mut critical, mut pair) = (None, None);
        for other in nearby.iter().filter(|other| other.meets(ego)) {
            let traffic = traffic(ego, nearby, other.number).nearest(self.around);
            let seen = Pair {
                ego: VehicleState {
                    leader: traffic.leader,
                    crosser: traffic.crosser,
                    ..vehicle_state(ego, mine, other.conflict.ego_conflict)
                },
                other: vehicle_state(&other.vehicle, other.path, other.conflict.other_conflict),
                kind: other.conflict.kind,
                right_of_way: other.conflict.right_of_way,
                part: self.part,
                last_svo: self.orientation(other.number),
            };
            let svo = seen.svo();
            self.remember(other.number, svo, nearby);
            let urgency = Urgency {
                waits: self.shield.goes_before(other.number),
                arrives: arrival(&seen.other),
            };
            if critical.is_none_or(|least| urgency.precedes(least)) {
                (critical, pair) = (Some(urgency), Some((other.number, svo, seen)));
            }
        }
        let (urgency, (other, svo, pair)) = critical.zip(pair)?;
        let [mut acceleration, expected] = self.policy.act(&pair);
        if acceleration < first && urgency.waits {
            acceleration = first;
        }
        let prediction = Prediction {
            other,
            svo,
            acceleration: expected,
            #[cfg(feature = "estimates")]
            shown: now.and_then(|now| self.look(now, other, &pair)),
        };
        Some((acceleration, prediction))
    }

    /// The ego's SVO towards track `number` at the last step; the first one, if there was none.
    fn orientation(&self, number: u16) -> f32 {
        let known = self
            .orientations
            .iter()
            .find(|&&(known, _)| known == number);
        known.map_or(svo::FIRST, |&(_, svo)| svo)
    }

    /// Remembers the SVO towards track `number`, in the place of one that is not nearby if there is no other.
    fn remember(&mut self, number: u16, svo: f32, nearby: &Vec<Nearby<'j>, N>) {
        let there = |number| nearby.iter().any(|other| other.number == number);
        self.orientations.retain(|&(known, _)| known != number);
        if self.orientations.is_full() {
            self.orientations.retain(|&(known, _)| there(known));
        }
        // As many as there are places are nearby, this one among them.
        let _ = self.orientations.push((number, svo));
    }
}

/// How soon the ego has to mind another: whoever waits for it comes last, and of the rest whoever arrives first comes first.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct Urgency {
    /// Whether the ego has precedence over it.
    pub(super) waits: bool,
    /// Seconds to the conflict point at its present speed.
    pub(super) arrives: f32,
}

impl Urgency {
    pub(super) fn precedes(self, other: Self) -> bool {
        if self.waits == other.waits {
            self.arrives < other.arrives
        } else {
            other.waits
        }
    }
}

fn vehicle_state(vehicle: &Vehicle, path: &Path, conflict: f32) -> VehicleState {
    VehicleState {
        pose: vehicle.pose,
        exit: path.exit(),
        speed: vehicle.speed,
        distance: conflict - vehicle.s,
        footprint: path.footprint(),
        leader: None,
        crosser: None,
        control: path.control(),
    }
}
