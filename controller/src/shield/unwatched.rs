//! Those who matter and for whom there is no room: their zones are closed.

use super::bounds::Bounds;
use super::precedence::ZoneSet;
use crate::instant::Instant;
use crate::junction::zone::{FAR, Zone};
use crate::junction::{Class, PathId, RouteConflict, Way};
use crate::observation::Track;
use crate::real::Real;
use heapless::Vec;

/// So many of them are remembered with their bounds while they are not seen.
const ROOM: usize = 16;

/// Of so many more, their numbers.
const MORE_ROOM: usize = 20;

/// Zones that the ego must not enter, because somebody who is not watched may be there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Closed {
    /// Track number of who is not watched.
    pub(crate) number: u16,
    /// Arc length (m) of the ego at which the first of them begins.
    pub(crate) from: f32,
}

/// Somebody who is not watched, on one of the paths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Entry {
    pub(super) number: u16,
    pub(super) path: PathId,
    pub(super) place: Place,
    /// Arc length (m) of the ego at which the first of its zones begins; [`FAR`] if it has just left them.
    pub(super) from: f32,
    /// It is in the present observation.
    pub(super) seen: bool,
    /// The plan in force is safe from it.
    pub(super) holds: bool,
}

/// What is known of where somebody unwatched is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Place {
    /// On its path.
    Known {
        /// Where it was when it was seen last.
        base: Bounds,
        /// When that was.
        at: Instant,
        /// Lanes in which the ego is ahead of it, and it has had the gap to keep its distance.
        settled: ZoneSet,
    },
    /// On foot on its path, where it may stay for ever.
    OnFoot,
    /// Nothing. One that is not seen again was perhaps never there.
    Unknown,
}

impl Entry {
    const fn is_placed(&self) -> bool {
        !matches!(self.place, Place::Unknown)
    }
}

/// Takes out what is at `place`, which the last one gets. `swap_remove` would need 1.5 KB of `memmove` on the target.
pub(super) fn take<T, const N: usize>(all: &mut Vec<T, N>, place: usize) -> Option<T> {
    let (last, others) = all.split_last_mut()?;
    if let Some(other) = others.get_mut(place) {
        core::mem::swap(other, last);
    }
    all.pop()
}

/// Everybody who is not watched.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Unwatched {
    entries: Vec<Entry, ROOM>,
    /// The first zones of those whom there is no room to remember with their bounds.
    beyond: Option<Closed>,
    /// Their numbers.
    numbers: Vec<u16, MORE_ROOM, u8>,
    /// There were more, of whom not even the numbers are known.
    nameless: bool,
}

impl Unwatched {
    pub(super) const fn new() -> Self {
        Self {
            entries: Vec::new(),
            beyond: None,
            numbers: Vec::new(),
            nameless: false,
        }
    }

    #[cfg(test)]
    pub(super) fn iter(&self) -> impl Iterator<Item = &Entry> {
        self.entries.iter()
    }

    pub(super) fn iter_mut(&mut self) -> impl Iterator<Item = &mut Entry> {
        self.entries.iter_mut()
    }

    /// The first zones of those who are not remembered.
    pub(super) const fn beyond(&self) -> Option<Closed> {
        self.beyond
    }

    /// A new observation of `tracks` begins, with an ego at `ego` (m). Nobody has been noted yet.
    pub(super) fn begin(&mut self, way: Way<'_>, ego: f32, tracks: &[Track]) {
        self.entries.iter_mut().for_each(|entry| entry.seen = false);
        if self.beyond.is_some() {
            self.leave_closed(way, ego, tracks);
        }
    }

    /// As long as one of those beyond the room is missing, what is closed stays so; once the ego is past it, whatever
    /// comes next.
    // Rare, and not inlined: it takes flash.
    #[cold]
    #[inline(never)]
    fn leave_closed(&mut self, way: Way<'_>, ego: f32, tracks: &[Track]) {
        let seen = |number| tracks.iter().any(|track| track.number == number);
        self.numbers.retain(|&number| !seen(number));
        let missing = !self.numbers.is_empty() || self.nameless;
        self.beyond = match self.beyond {
            Some(closed) if missing && closed.from <= ego => {
                let next = anybody(way, ego, closed.from);
                next.map(|from| Closed { from, ..closed })
            }
            beyond => beyond.filter(|_| missing),
        };
        if self.beyond.is_none() {
            self.numbers.clear();
            self.nameless = false;
        }
    }

    /// One is seen whose first zone begins at `from` (m).
    pub(super) fn close(&mut self, number: u16, path: PathId, place: Place, from: f32) {
        let placed = !matches!(place, Place::Unknown);
        let key = (number, path, placed);
        let known = |entry: &&mut Entry| (entry.number, entry.path, entry.is_placed()) == key;
        if let Some(entry) = self.entries.iter_mut().find(known) {
            entry.place = place;
            // The same twice: both count.
            entry.from = if entry.seen {
                Real::min(entry.from, from)
            } else {
                from
            };
            entry.seen = true;
            return;
        }
        let entry = Entry {
            number,
            path,
            place,
            from,
            seen: true,
            holds: false,
        };
        // Who has left makes room.
        let left = |it: &Entry| it.from >= FAR;
        if from < FAR
            && self.entries.is_full()
            && let Some(place) = self.entries.iter().position(left)
        {
            let _ = take(&mut self.entries, place);
        }
        if self.entries.push(entry).is_err() && from < FAR {
            self.beyond = sooner(self.beyond, Closed { number, from });
            if placed && !self.numbers.contains(&number) {
                self.nameless |= self.numbers.push(number).is_err();
            }
        }
    }

    /// Who is known to be on its path.
    pub(super) fn placed(&mut self, number: u16, path: PathId) -> Option<&mut Entry> {
        let key = (number, path, true);
        let known = |entry: &&mut Entry| (entry.number, entry.path, entry.is_placed()) == key;
        self.entries.iter_mut().find(known)
    }

    /// One is watched from now on, or matters no more. Whether the plan in force is safe from it.
    pub(super) fn open(&mut self, number: u16, path: PathId) -> bool {
        // Not another one with its number, that is seen somewhere in this observation.
        let it = |entry: &Entry| {
            (entry.number, entry.path) == (number, path) && (entry.is_placed() || !entry.seen)
        };
        let holds = self.entries.iter().any(|entry| it(entry) && entry.holds);
        self.entries.retain(|entry| !it(entry));
        holds
    }

    /// Whether somebody with this number is remembered who has not left its zones.
    pub(super) fn knows(&self, number: u16) -> bool {
        let mut all = self.entries.iter();
        all.any(|entry| entry.number == number && entry.from < FAR)
            || self.numbers.contains(&number)
    }

    /// Nobody with this number is there.
    pub(super) fn forget(&mut self, number: u16) {
        self.entries.retain(|entry| entry.number != number);
        self.numbers.retain(|&it| it != number);
    }

    /// Whether `stays` is true for everybody.
    pub(super) fn all(&self, stays: impl Fn(&Entry) -> bool) -> bool {
        self.entries.iter().all(stays)
    }

    /// Forgets whoever `stays` is false for.
    pub(super) fn retain(&mut self, stays: impl Fn(&Entry) -> bool) {
        self.entries.retain(stays);
    }

    /// An observation ends. Who is missing in it is somewhere on its path; the first zone that is closed for an ego at
    /// `ego` (m).
    pub(super) fn end(&mut self, way: Way<'_>, ego: f32) -> Option<Closed> {
        let ahead = |path| way.conflict(path).and_then(|it| first_zone(it, ego));
        self.entries
            .retain(|it| it.seen || (it.is_placed() && ahead(it.path).is_some()));
        // Who has left its zones has left them for ever.
        let missing = |entry: &&mut Entry| !entry.seen && entry.from < FAR;
        for entry in self.entries.iter_mut().filter(missing) {
            if let Some(from) = ahead(entry.path) {
                entry.from = from;
            }
        }
        let closed = self.entries.iter().filter(|entry| entry.from < FAR);
        closed.fold(self.beyond, |first, entry| {
            let Entry { number, from, .. } = *entry;
            sooner(first, Closed { number, from })
        })
    }
}

/// The one of which the zones begin first.
pub(super) fn sooner(first: Option<Closed>, other: Closed) -> Option<Closed> {
    first
        .filter(|first| first.from <= other.from)
        .or(Some(other))
}

/// Where (m) the ego, at `ego` (m), enters the first zone that it has not passed.
pub(super) fn first_zone(conflict: &RouteConflict, ego: f32) -> Option<f32> {
    first_from(conflict, ego, -FAR)
}

/// The same of those that begin at `from` (m) or later.
// Not inlined: once in flash.
#[inline(never)]
fn first_from(conflict: &RouteConflict, ego: f32, from: f32) -> Option<f32> {
    let ahead = |zone: &&Zone| ego < zone.ego.to && from <= zone.ego.from;
    conflict
        .zones()
        .filter(ahead)
        .map(|zone| zone.ego.from)
        .reduce(Real::min)
}

/// Where (m) the ego, at `ego` (m), enters the first zone with somebody of whom no more is known than the path and the
/// class, or not even that.
pub(super) fn unplaced(way: Way<'_>, path: PathId, class: Class, ego: f32) -> Option<f32> {
    let known = way.path(path).is_some_and(|path| path.class() == class);
    match way.conflict(path).filter(|_| known) {
        Some(conflict) => first_zone(conflict, ego),
        None => anybody(way, ego, -FAR),
    }
}

/// Where (m) the ego, at `ego` (m), enters the first zone with anybody that begins at `from` (m) or later.
// Not inlined: once in flash.
#[inline(never)]
fn anybody(way: Way<'_>, ego: f32, from: f32) -> Option<f32> {
    let zones = way.conflicts();
    zones
        .filter_map(|(_, conflict)| first_from(conflict, ego, from))
        .reduce(Real::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Footprint, Point};
    use crate::junction::{Junction, Route};
    use crate::observation::Vehicle;

    const PATH: PathId = PathId::new(1);

    #[test]
    fn the_sooner_of_two_closed_zones_counts_and_of_equals_the_first() {
        let closed = |number, from| Closed { number, from };
        let first = Some(closed(1, 5.0));
        assert_eq!(sooner(None, closed(2, 9.0)), Some(closed(2, 9.0)));
        assert_eq!(sooner(first, closed(2, 5.0)), first);
        assert_eq!(sooner(first, closed(2, 4.9)), Some(closed(2, 4.9)));
    }

    #[test]
    fn what_is_taken_out_leaves_the_others() {
        let mut all: Vec<u8, 4> = Vec::from_slice(&[1, 2, 3, 4]).unwrap();
        assert_eq!(take(&mut all, 1), Some(2));
        assert_eq!(all, [1, 4, 3]);
        assert_eq!(take(&mut all, 2), Some(3));
        assert_eq!(take(&mut Vec::<u8, 4>::new(), 0), None);
    }

    #[test]
    fn of_those_who_are_seen_twice_the_nearer_counts_and_of_those_seen_again_the_last() {
        let site = site();
        let mut unwatched = Unwatched::new();
        let mut from = |from, begin: bool| {
            if begin {
                unwatched.begin(site.way(PathId::new(0)).unwrap(), 0.0, &all());
            }
            unwatched.close(7, PATH, Place::OnFoot, from);
            assert_eq!(unwatched.entries.len(), 1);
            unwatched.placed(7, PATH).unwrap().from
        };
        assert_eq!(
            [from(9.0, false), from(12.0, false), from(5.0, false)],
            [9.0, 9.0, 5.0]
        );
        assert_eq!(from(11.0, true), 11.0);
    }

    #[test]
    fn one_of_unknown_place_is_another_entry() {
        let mut unwatched = Unwatched::new();
        unwatched.close(7, PATH, Place::Unknown, 9.0);
        assert!(unwatched.placed(7, PATH).is_none());
        unwatched.close(7, PATH, Place::OnFoot, 8.0);
        unwatched.close(8, PATH, Place::OnFoot, 7.0);
        unwatched.close(7, PathId::new(2), Place::OnFoot, 6.0);
        assert_eq!(unwatched.entries.len(), 4);
        assert_eq!(unwatched.placed(7, PATH).unwrap().from, 8.0);
        // Who is watched now is not, and the one of unknown place stays while it is seen.
        unwatched.placed(7, PATH).unwrap().holds = true;
        assert!(unwatched.open(7, PATH) && !unwatched.open(8, PATH));
        assert_eq!(unwatched.entries.len(), 2);
        unwatched.begin(site().way(PathId::new(0)).unwrap(), 0.0, &all());
        assert!(!unwatched.open(7, PATH));
        assert_eq!(unwatched.entries.len(), 1);
    }

    #[test]
    fn who_has_left_makes_room_and_beyond_the_room_the_nearest_counts() {
        let mut unwatched = Unwatched::new();
        let mut close = |number, from| {
            unwatched.close(number, PATH, Place::OnFoot, from);
            (
                unwatched.entries.len(),
                unwatched.beyond().map(|it| (it.number, it.from)),
            )
        };
        for number in 0..15 {
            close(number, 50.0);
        }
        assert_eq!(close(20, FAR), (16, None));
        assert_eq!(close(21, FAR), (16, None));
        assert_eq!(close(22, 40.0), (16, None));
        assert_eq!(close(23, 30.0), (16, Some((23, 30.0))));
        assert_eq!(close(24, 35.0), (16, Some((23, 30.0))));
        assert_eq!(close(25, 20.0), (16, Some((25, 20.0))));
        assert_eq!(close(26, FAR), (16, Some((25, 20.0))));
        assert!(unwatched.placed(20, PATH).is_none() && unwatched.placed(22, PATH).is_some());
        unwatched.begin(site().way(PathId::new(0)).unwrap(), 0.0, &all());
        assert_eq!(unwatched.beyond(), None);
    }

    #[test]
    fn who_is_beyond_the_room_stays_while_it_is_missing_and_until_the_ego_is_past() {
        let site = site();
        let way = site.way(PathId::new(0)).unwrap();
        let [near, far] = [1, 2].map(|path| zone(way, path));
        let crowd = |more: &[(u16, f32)]| {
            let mut unwatched = Unwatched::new();
            (100..116).for_each(|number| unwatched.close(number, PATH, Place::OnFoot, far[0]));
            for &(number, from) in more {
                unwatched.close(number, PATH, Place::OnFoot, from);
            }
            unwatched
        };
        let begun = |mut unwatched: Unwatched, ego, seen: &[u16]| {
            unwatched.begin(way, ego, &tracks(seen));
            unwatched.beyond().map(|it| (it.number, it.from))
        };
        let two = crowd(&[(20, near[0]), (21, far[0])]);
        // Either of them counts where the nearer one was.
        assert_eq!(begun(two.clone(), 0.0, &[]), Some((20, near[0])));
        assert_eq!(begun(two.clone(), 0.0, &[20]), Some((20, near[0])));
        assert_eq!(begun(two.clone(), 0.0, &[20, 21]), None);
        // The ego passes the one zone, then the other.
        assert_eq!(begun(two.clone(), near[1] - 0.1, &[]), Some((20, near[0])));
        assert_eq!(begun(two.clone(), near[1], &[]), Some((20, far[0])));
        assert_eq!(begun(two.clone(), far[1], &[]), None);
        // Known not to be there.
        let mut forgotten = two.clone();
        assert!(forgotten.knows(21));
        forgotten.forget(21);
        assert!(!forgotten.knows(21));
        assert_eq!(begun(forgotten.clone(), 0.0, &[20]), None);
        assert_eq!(begun(forgotten, 0.0, &[]), Some((20, near[0])));
        // One whose place is not known was perhaps never there.
        let mut unplaced = crowd(&[]);
        unplaced.close(22, PATH, Place::Unknown, near[0]);
        assert_eq!(begun(unplaced, 0.0, &[]), None);
    }

    #[test]
    fn beyond_the_room_for_numbers_all_count_until_the_ego_is_past() {
        let site = site();
        let way = site.way(PathId::new(0)).unwrap();
        let [near, far] = [1, 2].map(|path| zone(way, path));
        let mut unwatched = Unwatched::new();
        (0..36).for_each(|number| unwatched.close(number, PATH, Place::OnFoot, near[0]));
        assert!(!unwatched.nameless);
        let mut seen = unwatched.clone();
        seen.begin(way, 0.0, &all());
        assert_eq!(seen.beyond(), None);
        unwatched.close(36, PATH, Place::OnFoot, near[0]);
        unwatched.begin(way, 0.0, &all());
        assert_eq!(unwatched.beyond().map(|it| it.from), Some(near[0]));
        unwatched.begin(way, far[1], &all());
        assert_eq!((unwatched.beyond(), unwatched.nameless), (None, false));
    }

    /// The ego's road, one that crosses it, and one that does so farther on.
    fn site() -> Junction<3, 6, 1> {
        let mut builder = Junction::builder();
        for ends in [
            [(-50.0, 0.0), (50.0, 0.0)],
            [(0.0, -50.0), (0.0, 50.0)],
            [(20.0, -50.0), (20.0, 50.0)],
        ] {
            let route = Route::<2>::new(ends.map(|(x, y)| Point::new(x, y))).unwrap();
            builder.path(&route, Class::Car, Footprint::PAPER).unwrap();
        }
        builder.build().unwrap()
    }

    /// Where the ego is in the zone of path `path`: from, to.
    /// Tracks of these numbers, wherever they are.
    fn tracks(numbers: &[u16]) -> std::vec::Vec<Track> {
        let vehicle = Vehicle {
            s: 1.0,
            speed: 0.0,
            pose: site().polyline(PATH).unwrap().pose(1.0),
        };
        let on = |&number: &u16| Track::on(number, PATH, vehicle);
        numbers.iter().map(on).collect()
    }

    fn all() -> std::vec::Vec<Track> {
        tracks(&(0..100).collect::<std::vec::Vec<_>>())
    }

    fn zone(way: Way<'_>, path: u8) -> [f32; 2] {
        let conflict = way.conflict(PathId::new(path)).unwrap();
        let Zone { ego, .. } = *conflict.zones().next().unwrap();
        [ego.from, ego.to]
    }

    #[test]
    fn a_path_is_closed_where_it_is_met_next_and_an_unknown_one_where_anybody_is() {
        let site = site();
        let way = site.way(PathId::new(0)).unwrap();
        let ([near, past], [far, _]) = (zone(way, 1), zone(way, 2));
        let first = |ego| first_zone(way.conflict(PATH).unwrap(), ego);
        assert_eq!(
            [0.0, near, past - 0.1, past].map(first),
            [Some(near), Some(near), Some(near), None]
        );
        let closed = |path, class, ego| unplaced(way, PathId::new(path), class, ego);
        assert_eq!(closed(2, Class::Car, 0.0), Some(far));
        assert_eq!(closed(1, Class::Car, past), None);
        // It may be on the ego's own road.
        for (path, class) in [(2, Class::Lorry), (7, Class::Car)] {
            assert_eq!(closed(path, class, past), Some(-FAR));
        }
    }

    #[test]
    fn who_is_missing_is_on_its_path_until_the_ego_has_passed_it() {
        let site = site();
        let way = site.way(PathId::new(0)).unwrap();
        let [near, past] = zone(way, 1);
        let mut unwatched = Unwatched::new();
        let froms = |unwatched: &mut Unwatched| {
            [1, 3].map(|number| unwatched.placed(number, PATH).map(|it| it.from))
        };
        let closed = |number, from| Some(Closed { number, from });
        unwatched.close(1, PATH, Place::OnFoot, 5.0);
        unwatched.close(2, PATH, Place::Unknown, 4.0);
        unwatched.close(3, PATH, Place::OnFoot, FAR);
        assert_eq!(unwatched.end(way, 0.0), closed(2, 4.0));
        assert_eq!(froms(&mut unwatched), [Some(5.0), Some(FAR)]);
        // One of unknown place was perhaps never there, and one that has left is gone for ever.
        unwatched.begin(way, 0.0, &[]);
        assert_eq!(unwatched.end(way, 0.0), closed(1, near));
        assert_eq!(froms(&mut unwatched), [Some(near), Some(FAR)]);
        assert_eq!(unwatched.entries.len(), 2);
        unwatched.begin(way, 0.0, &[]);
        unwatched.close(3, PATH, Place::OnFoot, FAR);
        assert_eq!(unwatched.end(way, past), None);
        assert_eq!(froms(&mut unwatched), [None, Some(FAR)]);
        unwatched.close(1, PATH, Place::OnFoot, 7.0);
        assert_eq!(unwatched.end(way, past), closed(1, 7.0));
    }

    #[test]
    fn who_has_left_is_not_known_any_more_and_takes_nobodys_room() {
        let mut unwatched = Unwatched::new();
        unwatched.close(0, PATH, Place::OnFoot, FAR);
        for number in 1..16 {
            unwatched.close(number, PATH, Place::OnFoot, 50.0);
        }
        unwatched.close(16, PATH, Place::OnFoot, FAR);
        assert!(unwatched.placed(0, PATH).is_some() && unwatched.placed(16, PATH).is_none());
        assert!(unwatched.knows(1) && !unwatched.knows(0) && !unwatched.knows(16));
    }
}
