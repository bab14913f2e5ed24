//! One intersection, from entry to exit: what a driver sees there, through policy and shield, becomes a decision.

use crate::decision::{Decision, Prediction};
use crate::fault::Fault;
use crate::instant::Instant;
use crate::junction::{
    Class, ConflictKind, Junction, MAX_OTHERS, Path, PathId, RouteConflict, Way,
};
use crate::observation::{Observation, Sight, Track, Vehicle};
use crate::policy::features::arrival;
use crate::policy::pair::{Pair, Part, VehicleState};
use crate::policy::svo;
use crate::policy::traffic::{NearbyVehicle, TrafficContext};
#[cfg(feature = "estimates")]
use crate::policy::{Estimate, OrientationFilter};
use crate::policy::{Orientation, OrientationError, Policy};
use crate::shield::door::{self, Admitted};
use crate::shield::{Contract, EnterError, NotReady, Plan, Shield, SightError};
use heapless::Vec;

/// Acceleration (m/s²) that is proposed when there is nobody left to meet.
pub const FREE: f32 = 1.0;

/// An ego that is slower than this (m/s) and has precedence sets off.
const SLOW: f32 = 2.0;

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

    /// Begins to approach `junction` on `path`, and watches up to [`MAX_OTHERS`] others that matter.
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

    /// [`Drive::enter`], watching up to `N` others, 1 to [`MAX_OTHERS`].
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

/// One vehicle on its way through one junction, which it borrows.
///
/// Plan, precedence, tracks and SVO live as long as it: the next intersection begins with a new one.
#[derive(Clone, Debug)]
pub struct Approach<'j, 'w, const N: usize = MAX_OTHERS> {
    policy: Policy<'w>,
    part: Part,
    shield: Shield<'j, N>,
    /// The ego's SVO towards each track at the last step.
    orientations: Vec<(u16, f32), N>,
    /// What the tracks have shown that the policy was asked about last, if that is wanted.
    #[cfg(feature = "estimates")]
    filters: Option<Vec<Filter, WATCHED>>,
    /// See [`Approach::set_traffic`].
    around: TrafficContext,
    prediction: Option<Prediction>,
}

/// Tracks of which it is known what they have shown: the policy is asked about one, sometimes about two by turns.
#[cfg(feature = "estimates")]
const WATCHED: usize = 2;

/// What is known of the orientation of a track.
#[cfg(feature = "estimates")]
#[derive(Clone, Copy, Debug)]
struct Filter {
    number: u16,
    /// When it was looked at last.
    at: Instant,
    filter: OrientationFilter,
}

/// Braking (m/s²) to its line, up to which an ego with a driver of its own leaves everything to that one.
pub const GENTLE: f32 = 1.5;

/// What is wanted of the ego, in m/s².
struct Wanted {
    most: f32,
    /// At least, for those over whom it has precedence.
    first: f32,
    /// With nobody left to meet.
    free: f32,
    /// The policy is asked from where stopping at the line takes more braking than this.
    gentle: f32,
}

/// A track on a path that has a zone ahead with the ego's.
struct Nearby<'j> {
    number: u16,
    vehicle: Vehicle,
    path: &'j Path,
    conflict: &'j RouteConflict,
}

impl<'j, 'w, const N: usize> Approach<'j, 'w, N> {
    /// The shield.
    #[must_use]
    pub const fn shield(&self) -> &Shield<'j, N> {
        &self.shield
    }

    /// The plan that the shield falls back on; none is no guarantee.
    #[must_use]
    pub fn plan(&self) -> Option<Plan> {
        self.shield.plan()
    }

    /// Drives with `policy` from the next decision on.
    pub const fn set_policy(&mut self, policy: Policy<'w>) {
        self.policy = policy;
    }

    /// Shows `orientation` from the next decision on: 0 an egoist, π/4 as learned, π/2 an altruist.
    ///
    /// It reaches the policy's proposals alone: neither the shield nor what the ego does with its precedence
    /// ([`Approach::decide`]) depends on it.
    ///
    /// # Errors
    /// See [`Policy::oriented`]; nothing is changed then.
    pub fn set_orientation(&mut self, orientation: Orientation) -> Result<(), OrientationError> {
        self.policy = self.policy.oriented(orientation)?;
        Ok(())
    }

    /// Whether the orientation that the other shows is estimated from the next decision on, of the one that the policy is
    /// asked about: [`Prediction::shown`]. It changes no command.
    ///
    /// Cost: five more passes through the network in each decision.
    #[cfg(feature = "estimates")]
    pub fn set_estimates(&mut self, wanted: bool) {
        self.filters = match (wanted, self.filters.take()) {
            (true, known) => Some(known.unwrap_or_default()),
            (false, _) => None,
        };
    }

    /// Drives within `contract` from the next decision on. The remembered plan is kept if it is safe under it.
    ///
    /// # Errors
    /// [`EnterError::PositionError`]; nothing is changed then.
    pub fn set_contract(&mut self, contract: Contract) -> Result<(), EnterError> {
        self.shield.set_contract(contract)
    }

    /// Tells the policy of traffic that is not on the junction's paths, for the decisions to come; the shield
    /// considers the tracks alone.
    pub const fn set_traffic(&mut self, around: TrafficContext) {
        self.around = around;
    }

    /// See [`Shield::set_sight`].
    ///
    /// # Errors
    /// See [`SightError`]; nothing is changed then.
    pub fn set_sight(&mut self, now: Instant, sights: &[Sight]) -> Result<(), SightError> {
        self.shield.set_sight(now, sights)
    }

    /// See [`Shield::forget`].
    pub fn forget(&mut self, number: u16) {
        self.shield.forget(number);
    }

    /// Whether a plan is safe before control is handed over. See [`Shield::ready`].
    ///
    /// # Errors
    /// Why there is none.
    pub fn ready(&self, now: Instant, observation: &Observation<'_>) -> Result<f32, NotReady> {
        self.shield.ready(now, observation)
    }

    /// The ego's acceleration for the period that begins `now`. To be called once a period.
    ///
    /// The policy is asked about one of those whom the ego has yet to meet: of those who do not wait for it, the one that
    /// arrives first at the conflict point. Its proposal passes to the shield, which considers everybody. With nobody left
    /// to meet, the ego accelerates gently up to the contract's speed. Nothing is proposed that exceeds the speed limits of
    /// its path, or the junction's lateral acceleration in bends ([`crate::Profile`]). For those over whom it has
    /// precedence it does not brake, and sets off. See [`Shield::filter`].
    ///
    /// Cost: one pass through the network, two with another orientation than the learned, and the shield's. The
    /// acceleration is finite and within the contract's, whatever the bits of the observation.
    pub fn decide(&mut self, now: Instant, observation: &Observation<'_>) -> Decision {
        let first = if observation.ego.speed > SLOW {
            0.0
        } else {
            FREE
        };
        let wanted = Wanted {
            most: f32::INFINITY,
            first,
            free: FREE,
            gentle: 0.0,
        };
        self.decide_for(now, observation, &wanted)
    }

    /// [`Approach::decide`] for a vehicle that has a driver of its own for everything but the others at the junction, of
    /// its speed limit, curves and leader for example: no more than `most` (m/s²) is proposed, and `most` where nobody is
    /// left to meet who goes first, or while braking at [`GENTLE`] still stops the ego at its line. NaN counts as full
    /// braking.
    pub fn decide_up_to(
        &mut self,
        now: Instant,
        observation: &Observation<'_>,
        most: f32,
    ) -> Decision {
        let wanted = Wanted {
            most,
            first: most,
            free: most,
            gentle: GENTLE,
        };
        self.decide_for(now, observation, &wanted)
    }

    fn decide_for(
        &mut self,
        now: Instant,
        observation: &Observation<'_>,
        wanted: &Wanted,
    ) -> Decision {
        let mut proposed = 0.0;
        if self.shield.is_new(now) {
            // The shield finds a fault again and carries on with its plan.
            if let Ok((asked, limit)) = self.ask(Some(now), observation, wanted.first) {
                self.prediction = asked.map(|(_, prediction)| prediction);
                proposed = match asked {
                    None => wanted.free,
                    Some((acceleration, _))
                        if acceleration < wanted.most
                            && self.is_near(&observation.ego, wanted.gentle) =>
                    {
                        acceleration
                    }
                    Some(_) => wanted.most,
                };
                if limit < proposed {
                    proposed = limit;
                }
            } else {
                self.prediction = None;
            }
        }
        Decision {
            prediction: self.prediction,
            ..self.shield.filter(now, observation, proposed)
        }
    }

    /// Whether the ego has to brake by more than `gentle` (m/s²) to stop at its line, or is past it.
    fn is_near(&self, ego: &Vehicle, gentle: f32) -> bool {
        let way = self.shield.way();
        let line = way.path(way.ego()).map_or(0.0, Path::line);
        ego.speed * ego.speed >= 2.0 * gentle * (line - ego.s)
    }

    /// What the policy alone would do (m/s², within ± 3): to measure what the shield costs, never to drive.
    ///
    /// To be called once a period instead of [`Approach::decide`]; 0 if the ego's state has a fault.
    ///
    /// Cost: one pass through the network. Finite and within ± 3.
    pub fn proposal(&mut self, observation: &Observation<'_>) -> f32 {
        self.ask(None, observation, f32::MIN)
            .map_or(0.0, |(asked, _)| {
                asked.map_or(FREE, |(acceleration, _)| acceleration)
            })
    }

    /// What the policy proposes, and at least `first` (m/s²) for those over whom the ego has precedence; nothing, if nobody
    /// is left to meet. And what the path's profile allows (m/s²). Not inlined, because its stack is free again when the shield needs its own.
    #[inline(never)]
    fn ask(
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

    /// The orientation that track `number` has shown by `now`, if that is wanted.
    #[cfg(feature = "estimates")]
    #[inline(never)]
    fn look(&mut self, now: Instant, number: u16, pair: &Pair) -> Option<Estimate> {
        let period = self.shield.contract().period();
        let filters = self.filters.as_mut()?;
        let known = filters.iter().find(|known| known.number == number);
        let mut known = known.copied().unwrap_or(Filter {
            number,
            at: now,
            filter: OrientationFilter::default(),
        });
        filters.retain(|other| other.number != number);
        let elapsed = now.seconds_since(known.at);
        // Not looked at in between: what was expected then is of another time.
        if !(0.5 * period..1.5 * period).contains(&elapsed) {
            known.filter.skip();
        }
        known.at = now;
        let estimate = known.filter.look(&self.policy, pair, period);
        if filters.is_full() {
            let oldest = filters.iter().map(|other| other.at).min();
            filters.retain(|other| Some(other.at) != oldest);
        }
        // There is room.
        let _ = filters.push(known);
        Some(estimate)
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
struct Urgency {
    /// Whether the ego has precedence over it.
    waits: bool,
    /// Seconds to the conflict point at its present speed.
    arrives: f32,
}

impl Urgency {
    fn precedes(self, other: Self) -> bool {
        if self.waits == other.waits {
            self.arrives < other.arrives
        } else {
            other.waits
        }
    }
}

impl Nearby<'_> {
    /// Whether the two have yet to meet: in some zone neither has passed it. In a lane that they share they have met
    /// once either has reached the conflict point: it leads.
    fn meets(&self, ego: &Vehicle) -> bool {
        let conflict = self.conflict;
        conflict.zones().any(|zone| {
            let (ego_end, other_end) = match zone.kind {
                ConflictKind::Following | ConflictKind::Merging => {
                    (conflict.ego_conflict, conflict.other_conflict)
                }
                _ => (zone.ego.to, zone.other.to),
            };
            ego.s < ego_end && self.vehicle.s < other_end
        })
    }

    /// Metres that the ego still has to where the two meet; negative past it.
    fn away(&self, ego: &Vehicle) -> f32 {
        self.conflict.ego_conflict - ego.s
    }
}

/// The tracks that have a zone ahead with the ego, on each of their paths: of more than `N` the nearest. A track with a
/// fault is not there.
fn nearby<'j, const N: usize>(
    way: Way<'j>,
    contract: &Contract,
    ego: &Vehicle,
    tracks: &[Track],
) -> Vec<Nearby<'j>, N> {
    let mut nearest: Vec<Nearby<'j>, N> = Vec::new();
    // Of pedestrians the policy knows nothing.
    let driven = tracks
        .iter()
        .filter(|track| track.class != Class::Pedestrian);
    let candidates =
        driven.flat_map(|track| track.candidates().map(move |candidate| (track, candidate)));
    for (track, candidate) in candidates {
        let there = way.path(candidate.path).zip(way.conflict(candidate.path));
        let Some((path, conflict)) = there else {
            continue;
        };
        let Ok(Admitted { vehicle, .. }) = door::track(way, contract, track, candidate) else {
            continue;
        };
        let ahead = |zone: &crate::Zone| ego.s < zone.ego.to && vehicle.s < zone.other.to;
        if !conflict.zones().any(ahead) {
            continue;
        }
        let mut found = Nearby {
            number: track.number,
            vehicle,
            path,
            conflict,
        };
        if nearest.is_full() {
            for other in &mut nearest {
                if other.away(ego) > found.away(ego) {
                    core::mem::swap(other, &mut found);
                }
            }
        } else {
            // There is room.
            let _ = nearest.push(found);
        }
    }
    nearest
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

/// What all the others but track `except` are to the ego.
fn traffic<const N: usize>(
    ego: &Vehicle,
    nearby: &Vec<Nearby<'_>, N>,
    except: u16,
) -> TrafficContext {
    let others = nearby.iter().filter(|other| other.number != except);
    let there = others.map(|other| NearbyVehicle {
        conflict: other.conflict,
        s: other.vehicle.s,
        speed: other.vehicle.speed,
    });
    TrafficContext::new(ego.s, there)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::decision::Cause;
    use crate::geometry::{Footprint, Point};
    use crate::junction::Route;
    use crate::policy::features::FeatureSet;
    use crate::policy::weights::Perspective;
    use crate::policy::weights::testing::file;
    use std::vec::Vec;

    type Site = Junction<4, 16, 1>;

    fn route(points: &[(f32, f32)]) -> Route<4> {
        Route::new(points.iter().map(|&(x, y)| Point::new(x, y))).unwrap()
    }

    /// The ego goes east; the others cross from the south, follow it, and come from the south further on.
    fn site() -> Site {
        let routes = [
            route(&[(-60.0, 0.0), (120.0, 0.0)]),
            route(&[(0.0, -60.0), (0.0, 60.0)]),
            route(&[(-60.0, 0.0), (120.0, 0.0)]),
            route(&[(30.0, -60.0), (30.0, 60.0)]),
        ];
        let mut builder = Site::builder();
        builder.tolerance(0.0);
        for route in &routes {
            builder.path(route, Class::Car, Footprint::PAPER).unwrap();
        }
        builder.build().unwrap()
    }

    fn on(site: &Site, path: u8, s: f32, speed: f32) -> Vehicle {
        let pose = site.polyline(PathId::new(path)).unwrap().pose(s);
        Vehicle { s, speed, pose }
    }

    fn tracks(site: &Site, others: &[(u8, f32, f32)]) -> Vec<Track> {
        let track = |&(path, s, speed): &(u8, f32, f32)| {
            Track::on(
                100 + u16::from(path),
                PathId::new(path),
                on(site, path, s, speed),
            )
        };
        others.iter().map(track).collect()
    }

    fn drive(file: &[u32]) -> Drive<'_> {
        let policy = Policy::new(file).unwrap();
        Drive::new(policy, Contract::WORST_CASE, Part::Left)
    }

    #[test]
    fn the_policy_is_asked_about_the_one_that_arrives_first() {
        let file = file(FeatureSet::Route, Perspective::Ego, 16);
        let site = site();
        let decide = |others: &[(u8, f32, f32)]| {
            let mut approach = drive(&file).enter(&site, PathId::new(0)).unwrap();
            let tracks = tracks(&site, others);
            let seen = Observation {
                ego: on(&site, 0, 0.0, 5.0),
                tracks: &tracks,
            };
            approach.ask(None, &seen, FREE).unwrap().0.unwrap()
        };
        let (a, c) = ((1, 5.0, 4.0), (3, 20.0, 9.0));
        // 55 m at 4 m/s, and 40 m at 9 m/s.
        let (first, third) = (decide(&[a]), decide(&[c]));
        assert_eq!(first.1.other, 101);
        assert_eq!(third.1.other, 103);
        assert_eq!(decide(&[a, c]), third);
        assert_eq!(decide(&[c, a]), third);
    }

    #[test]
    fn who_waits_for_the_ego_is_asked_about_last() {
        let [waits, comes, later] = [(true, 1.0), (false, 8.0), (false, 9.0)]
            .map(|(waits, arrives)| Urgency { waits, arrives });
        assert!(comes.precedes(waits) && !waits.precedes(comes));
        assert!(comes.precedes(later) && !later.precedes(comes));
        assert!(!comes.precedes(comes));
    }

    #[test]
    fn an_ego_with_a_driver_of_its_own_is_left_to_it_until_stopping_takes_more_than_gentle_braking()
    {
        let file = file(FeatureSet::Route, Perspective::Ego, 16);
        let site = site();
        let mut approach = drive(&file).enter(&site, PathId::new(0)).unwrap();
        let tracks = tracks(&site, &[(1, 20.0, 1.0)]);
        let line = site.path(PathId::new(0)).unwrap().line();
        let (speed, most) = (6.0, 0.25);
        let stop = speed * speed / (2.0 * GENTLE);
        let mut decide = |short: f32, at: u64| {
            let seen = Observation {
                ego: on(&site, 0, line - short, speed),
                tracks: &tracks,
            };
            let wanted = approach.ask(None, &seen, most).unwrap().0.unwrap().0;
            let decision = approach.decide_up_to(Instant::from_millis(at), &seen, most);
            (wanted, decision.acceleration)
        };
        let (asked, decided) = decide(stop + 1.0, 0);
        assert!(asked < most && decided == most, "{asked} {decided}");
        let (asked, decided) = decide(stop - 0.5, 100);
        assert!(
            asked < most && decided <= most.min(asked),
            "{asked} {decided}"
        );
    }

    #[test]
    fn one_ahead_in_the_lane_is_a_leader_and_nobody_to_meet() {
        let site = site();
        let (way, ego) = (site.way(PathId::new(0)).unwrap(), on(&site, 0, 0.0, 5.0));
        let tracks = tracks(&site, &[(2, 20.0, 4.0)]);
        let nearby = nearby::<8>(way, &Contract::WORST_CASE, &ego, &tracks);
        let leader = traffic(&ego, &nearby, 0).leader.unwrap();
        assert_eq!(leader.speed, 4.0);
        assert!((leader.gap - 15.0).abs() < 0.1, "{leader:?}");
        assert!(!nearby[0].meets(&ego));
    }

    #[test]
    fn with_nobody_to_meet_the_ego_drives_on_and_with_bad_senses_it_brakes() {
        let file = file(FeatureSet::Route, Perspective::Ego, 16);
        let site = site();
        let mut approach = drive(&file).enter(&site, PathId::new(0)).unwrap();
        let mut seen = Observation {
            ego: on(&site, 0, 0.0, 5.0),
            tracks: &[],
        };
        let decision = approach.decide(Instant::from_millis(0), &seen);
        assert_eq!(
            (decision.acceleration, decision.cause),
            (FREE, Cause::Policy)
        );
        assert_eq!(decision.prediction, None);
        seen.ego.s = f32::NAN;
        let decision = approach.decide(Instant::from_millis(100), &seen);
        assert!(matches!(decision.cause, Cause::Fallback(Fault::Input(_))));
        assert_eq!(decision.acceleration, -3.0);
    }

    #[test]
    fn another_policy_drives_on_with_the_same_plan() {
        let (one, two) = [16, 32]
            .map(|width| file(FeatureSet::Route, Perspective::Ego, width))
            .into();
        let site = site();
        let mut approach = drive(&one).enter(&site, PathId::new(0)).unwrap();
        let tracks = tracks(&site, &[(1, 5.0, 4.0)]);
        let seen = Observation {
            ego: on(&site, 0, 0.0, 5.0),
            tracks: &tracks,
        };
        approach.decide(Instant::from_millis(0), &seen);
        let plan = approach.plan();
        assert!(plan.is_some());
        approach.set_policy(Policy::new(&two).unwrap());
        assert_eq!(approach.plan(), plan);
    }

    #[cfg(feature = "estimates")]
    #[test]
    fn estimates_come_when_they_are_wanted_and_change_no_command() {
        let file = file(FeatureSet::Route, Perspective::Ego, 16);
        let site = site();
        let decisions = |wanted: bool| -> Vec<_> {
            let mut drive = drive(&file);
            drive.set_estimates(wanted);
            let mut approach = drive.enter(&site, PathId::new(0)).unwrap();
            let decide = |step: u16| {
                let t = 0.1 * f32::from(step);
                let tracks = tracks(&site, &[(1, 5.0 + 4.0 * t, 4.0), (3, 2.0 + 9.0 * t, 9.0)]);
                let seen = Observation {
                    ego: on(&site, 0, 5.0 * t, 5.0),
                    tracks: &tracks,
                };
                approach.decide(Instant::from_millis(100 * u64::from(step)), &seen)
            };
            (0..12).map(decide).collect()
        };
        for (plain, estimated) in decisions(false).iter().zip(&decisions(true)) {
            assert_eq!(plain.acceleration, estimated.acceleration);
            let (plain, estimated) = (plain.prediction.unwrap(), estimated.prediction.unwrap());
            assert_eq!((plain.shown, plain.svo), (None, estimated.svo));
            assert!((0.0..=1.0).contains(&estimated.shown.unwrap().confidence));
        }
    }

    #[test]
    fn a_dial_in_its_middle_changes_nothing_and_an_altruist_proposes_less() {
        let file = file(FeatureSet::Route, Perspective::Ego, 16);
        let site = site();
        let tracks = tracks(&site, &[(1, 20.0, 6.0)]);
        let seen = Observation {
            ego: on(&site, 0, 20.0, 5.0),
            tracks: &tracks,
        };
        let proposal = |degrees: Option<f32>| {
            let mut drive = drive(&file);
            if let Some(degrees) = degrees {
                let orientation = Orientation::from_degrees(degrees).unwrap();
                drive.set_orientation(orientation).unwrap();
            }
            let mut approach = drive.enter(&site, PathId::new(0)).unwrap();
            approach.proposal(&seen)
        };
        let plain = proposal(None);
        assert_eq!(proposal(Some(45.0)), plain);
        assert!(proposal(Some(75.0)) <= plain && plain <= proposal(Some(15.0)));
    }

    #[test]
    fn no_proposal_exceeds_the_profile() {
        let file = file(FeatureSet::Route, Perspective::Ego, 16);
        let mut builder = Site::builder();
        let east = route(&[(-60.0, 0.0), (120.0, 0.0)]);
        let path = builder.path(&east, Class::Car, Footprint::PAPER).unwrap();
        builder.speed_limit(path, 50.0, 6.0).unwrap();
        let site = builder.build().unwrap();
        let at = |s, most: Option<f32>| {
            let mut approach = drive(&file).enter(&site, path).unwrap();
            let seen = Observation {
                ego: on(&site, 0, s, 10.0),
                tracks: &[],
            };
            let now = Instant::from_millis(0);
            let decision = match most {
                Some(most) => approach.decide_up_to(now, &seen, most),
                None => approach.decide(now, &seen),
            };
            assert_eq!(decision.cause, Cause::Policy);
            decision.acceleration
        };
        // 64 m²/s² at 1.5 m/s² are 21.3 m.
        assert_eq!((at(0.0, None), at(0.0, Some(0.5))), (FREE, 0.5));
        for most in [None, Some(2.0)] {
            assert!((at(29.0, most) + 1.5).abs() < 0.2, "{}", at(29.0, most));
        }
        assert_eq!(at(29.0, Some(-2.5)), -2.5);
    }

    #[test]
    fn an_approach_fits_its_share_of_the_memory() {
        let share = 3072 + if cfg!(feature = "estimates") { 192 } else { 0 };
        let size = size_of::<Approach<'_, '_>>();
        assert!(size <= share, "{size}");
    }
}
