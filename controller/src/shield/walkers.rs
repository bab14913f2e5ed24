//! Pedestrians on crossings: each may turn back at any time.

use super::contract::Contract;
use super::door;
use super::findings::Findings;
use super::hazard::{Hazard, Passage, Who};
use super::own::Own;
use super::unwatched::{Place, Unwatched, first_zone, unplaced};
use crate::headroom::Room;
use crate::instant::Instant;
use crate::junction::zone::{FAR, Span, Zone};
use crate::junction::{Class, PathId, Way};
use crate::observation::{Candidate, Track};
use crate::real::Real;
use heapless::Vec;

/// So many pedestrians are watched one by one; the crossings of the rest are closed.
pub(super) const MAX_WALKERS: usize = 4;

/// A pedestrian.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Walker {
    number: u16,
    path: PathId,
    /// Its highest speed, either way, in m/s.
    pace: f32,
    /// Where it was at `at`.
    base: Span,
    at: Instant,
    seen: bool,
    /// The remembered plan has not been verified against it.
    suspect: bool,
}

/// Those who are known.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Walkers {
    known: Vec<Walker, MAX_WALKERS>,
    /// The present.
    now: Instant,
}

impl Walker {
    /// Where it may be at `now`.
    fn span(&self, now: Instant) -> Span {
        let gone = self.pace * now.seconds_since(self.at);
        Span {
            from: self.base.from - gone,
            to: self.base.to + gone,
        }
    }

    /// Notes that it is seen at `s` (m) with `speed` (m/s), and what is left until it cannot have come there.
    fn meet(&mut self, contract: &Contract, (s, speed): (f32, f32), now: Instant) -> [Room; 2] {
        let spare = contract.position_error + contract.slack;
        let Span { from, to } = self.span(now);
        let fastest = self.pace + contract.speed_error + contract.slack;
        let rooms = [
            Room::between(s, [from - spare, to + spare]),
            Room::between(speed, [-fastest, fastest]),
        ];
        self.base = around(contract, s);
        (self.at, self.seen) = (now, true);
        self.suspect = !Room::hold(rooms);
        rooms
    }
}

fn around(contract: &Contract, s: f32) -> Span {
    Span {
        from: s - contract.position_error,
        to: s + contract.position_error,
    }
}

impl Walkers {
    pub(super) const fn new() -> Self {
        Self {
            known: Vec::new(),
            now: Instant::from_micros(0),
        }
    }

    /// Nobody with this number is there any more.
    pub(super) fn forget(&mut self, number: u16) {
        self.known.retain(|walker| walker.number != number);
    }

    /// It is `now`, and nobody has been seen yet.
    pub(super) fn advance(&mut self, now: Instant) {
        self.now = now;
        for walker in &mut self.known {
            (walker.seen, walker.suspect) = (false, false);
        }
    }

    /// Until the present everybody kept to one contract, from now on to another one.
    pub(super) fn rebase(&mut self) {
        for walker in &mut self.known {
            (walker.base, walker.at) = (walker.span(self.now), self.now);
        }
    }

    /// Notes a track of a pedestrian, on each of its candidates.
    pub(super) fn note(
        &mut self,
        (contract, way): (&Contract, Way<'_>),
        (ego, unwatched): (&Own, &mut Unwatched),
        track: &Track,
        findings: &mut Findings,
    ) {
        for candidate in track.candidates() {
            let others = (ego, &mut *unwatched);
            self.note_candidate((contract, way), others, (track, candidate), findings);
        }
    }

    fn note_candidate(
        &mut self,
        (contract, way): (&Contract, Way<'_>),
        (ego, unwatched): (&Own, &mut Unwatched),
        (track, candidate): (&Track, Candidate),
        findings: &mut Findings,
    ) {
        let (number, path, now) = (track.number, candidate.path, self.now);
        let same = |it: &&mut Walker| (it.number, it.path) == (number, path) && !it.seen;
        let known = self.known.iter_mut().find(same);
        let admitted = match door::track(way, contract, track, candidate) {
            Ok(admitted) => admitted,
            Err(fault) => {
                // One that is known coasts.
                if known.is_none()
                    && unwatched.placed(number, path).is_none()
                    && let Some(from) = unplaced(way, path, Class::Pedestrian, ego.least)
                {
                    unwatched.close(number, path, Place::Unknown, from);
                }
                findings.headroom.note_fault(fault);
                findings.fault = findings.fault.or(Some(fault));
                return;
            }
        };
        let seen = (admitted.vehicle.s, admitted.vehicle.speed);
        if let Some(walker) = known {
            let rooms = walker.meet(contract, seen, now);
            findings.headroom.note_pose(Some(number), admitted.pose);
            findings.moved(number, rooms);
            return;
        }
        findings.headroom.note_pose(Some(number), admitted.pose);
        let ahead = |path| way.conflict(path).and_then(|it| first_zone(it, ego.least));
        let Some(from) = ahead(path) else { return };
        if self.known.is_full() {
            self.known.retain(|walker| ahead(walker.path).is_some());
        }
        if self.known.is_full() {
            unwatched.close(number, path, Place::OnFoot, from);
            return;
        }
        // One that was not watched may be somebody of whom the plan in force keeps clear.
        let suspect = !unwatched.open(number, path);
        let _ = self.known.push(Walker {
            number,
            path,
            pace: way.path(path).map_or(0.0, |path| path.pace()),
            base: around(contract, seen.0),
            at: now,
            seen: true,
            suspect,
        });
    }

    /// What they are to the ego. They come from either side of their zones, and the ego waits for all of them.
    pub(super) fn hazards<'w>(
        &'w self,
        contract: &'w Contract,
        way: Way<'w>,
        ego: &'w Own,
    ) -> impl Iterator<Item = Hazard> {
        self.known.iter().flat_map(move |walker| {
            let span = walker.span(self.now);
            let zones = way.conflict(walker.path).map(|conflict| conflict.zones());
            let ahead = |zone: &&Zone| ego.least < zone.ego.to;
            (zones.into_iter().flatten().filter(ahead)).map(move |zone| {
                let error = contract.position_error;
                let stop = zone.ego.from - ego.s - error;
                Hazard {
                    who: Who::Watched {
                        number: walker.number,
                        place: u8::MAX,
                    },
                    zone: 0,
                    suspect: walker.suspect,
                    yields: true,
                    target: zone.ego.to - ego.s + 3.0 * error,
                    limit: stop,
                    rest: stop,
                    rest_beyond: FAR,
                    passage: Passage::Walks {
                        distance: Real::max(zone.other.from - span.to, span.from - zone.other.to),
                        speed: walker.pace,
                    },
                }
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One who was at 10 m, to within 0.3 m, a second ago, and walks at 2 m/s at most.
    fn walker() -> Walker {
        Walker {
            number: 3,
            path: PathId::new(1),
            pace: 2.0,
            base: Span {
                from: 9.7,
                to: 10.3,
            },
            at: Instant::from_millis(1000),
            seen: false,
            suspect: false,
        }
    }

    #[track_caller]
    fn near(a: f32, b: f32) {
        assert!((a - b).abs() < 1e-4, "{a}, {b}");
    }

    #[test]
    fn one_on_foot_may_have_gone_either_way() {
        let span = walker().span(Instant::from_millis(1500));
        near(span.from, 8.7);
        near(span.to, 11.3);
        let mut walkers = Walkers::new();
        walkers.known.push(walker()).unwrap();
        walkers.advance(Instant::from_millis(1500));
        walkers.rebase();
        assert_eq!(walkers.known[0].base, span);
        assert_eq!(walkers.known[0].at, Instant::from_millis(1500));
        walkers.forget(4);
        assert_eq!(walkers.known.len(), 1);
        walkers.forget(3);
        assert!(walkers.known.is_empty());
    }

    #[test]
    fn one_on_foot_is_suspect_beyond_its_pace_errors_and_slack() {
        let contract = Contract::builder()
            .position_error(0.3)
            .speed_error(0.2)
            .slack(0.05);
        let contract = contract.build().unwrap();
        let now = Instant::from_millis(1500);
        for (s, speed, suspect) in [
            (11.6, 0.0, false),
            (11.7, 0.0, true),
            (8.4, 0.0, false),
            (8.3, 0.0, true),
            (10.0, 2.2, false),
            (10.0, 2.3, true),
            (10.0, -2.2, false),
            (10.0, -2.3, true),
        ] {
            let mut walker = walker();
            let [place, pace] = walker.meet(&contract, (s, speed), now);
            assert_eq!(
                (walker.suspect, walker.seen),
                (suspect, true),
                "{s} m, {speed} m/s"
            );
            near(place.left, 1.65 - (s - 10.0).abs());
            near(pace.left, 2.25 - speed.abs());
            near(walker.base.from, s - 0.3);
            near(walker.base.to, s + 0.3);
            assert_eq!(walker.at, now);
        }
    }

    #[test]
    fn a_crossing_is_a_hazard_as_far_as_the_nearer_of_its_sides() {
        use crate::geometry::{Footprint, Point};
        use crate::junction::{Junction, Route};
        let route = |from: (f32, f32), to: (f32, f32)| {
            Route::<2>::new([from, to].map(|(x, y)| Point::new(x, y))).unwrap()
        };
        let mut builder = Junction::<2, 4, 1>::builder();
        let car = route((-50.0, 0.0), (50.0, 0.0));
        builder.path(&car, Class::Car, Footprint::PAPER).unwrap();
        let small = Footprint {
            length: 0.6,
            width: 0.6,
        };
        builder
            .path(&route((0.0, -20.0), (0.0, 20.0)), Class::Pedestrian, small)
            .unwrap();
        let junction = builder.build().unwrap();
        let way = junction.way(PathId::new(0)).unwrap();
        let zone = *way
            .conflict(PathId::new(1))
            .unwrap()
            .zones()
            .next()
            .unwrap();
        let contract = Contract::builder().position_error(0.3).build().unwrap();
        let own = Own {
            s: 20.0,
            speed: 5.0,
            least: 19.7,
        };
        for (at, distance) in [(10.0, zone.other.from - 11.3), (30.0, 28.7 - zone.other.to)] {
            let mut walkers = Walkers::new();
            let base = Span {
                from: at - 0.3,
                to: at + 0.3,
            };
            walkers.known.push(Walker { base, ..walker() }).unwrap();
            walkers.advance(Instant::from_millis(1500));
            let hazards: std::vec::Vec<_> = walkers.hazards(&contract, way, &own).collect();
            let [hazard] = hazards[..] else {
                panic!("{hazards:?}");
            };
            let place = u8::MAX;
            assert_eq!(hazard.who, Who::Watched { number: 3, place });
            assert!(hazard.yields && !hazard.suspect);
            near(hazard.target, zone.ego.to - 20.0 + 0.9);
            near(hazard.limit, zone.ego.from - 20.3);
            near(hazard.rest, zone.ego.from - 20.3);
            let Passage::Walks {
                distance: is,
                speed,
            } = hazard.passage
            else {
                panic!("{hazard:?}");
            };
            near(is, distance);
            assert_eq!(speed, 2.0);
            let past = Own {
                s: 80.0,
                speed: 5.0,
                least: 79.7,
            };
            assert_eq!(walkers.hazards(&contract, way, &past).count(), 0);
            let count = |least: f32| {
                let own = Own { least, ..own };
                walkers.hazards(&contract, way, &own).count()
            };
            assert_eq!([zone.ego.to - 0.1, zone.ego.to].map(count), [1, 0]);
        }
    }
}
