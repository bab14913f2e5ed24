//! A first scene description, from the tracks alone: arms where tracks begin and end, and what vehicles do between them.

use crate::Dataset;
use crate::role::Manoeuvre;
use crate::site::{by_turn, is_oncoming};
use crate::tracks::{RawState, Track};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// Side of the squares (m) in which the ends of tracks are counted.
const SQUARE: f64 = 4.0;
/// A square with fewer ends is none of an arm's.
const FEWEST_ENDS: usize = 3;
/// An arm holds at least this share of all ends.
const LEAST_SHARE: f64 = 0.02;
/// Metres around an arm's squares.
const MARGIN: f64 = 2.0;
/// A way that fewer tracks take is left out.
const FEWEST_TRACKS: usize = 3;
/// A shorter track (m) is of a vehicle that stands, or is cut off.
const SHORTEST: f64 = 15.0;

/// The text (TOML) of a scene description of `dataset`'s site; `None` if its tracks show fewer than two arms.
#[must_use]
pub fn draft(dataset: &Dataset) -> Option<String> {
    let tracks: Vec<&Track> = whole_tracks(dataset).collect();
    let arms = arms(&tracks);
    if arms.len() < 2 {
        return None;
    }
    let ways = ways(&tracks, &arms);
    let mut text = format!(
        "# A draft by `cede data new-site`, from {} tracks: look at its drawing (`cede data inspect`), and correct it.\n\n\
         name = {:?}\nfolder = {:?}\n\n\
         # An arm holds the tracks that begin or end within its bounds (metres, the recordings' frame).\n",
        tracks.len(),
        dataset.site.name,
        dataset.site.folder,
    );
    for arm in &arms {
        arm.write(&mut text);
    }
    text += "# What vehicles do on the way from one arm to another.\n";
    for way in &ways {
        way.write(&mut text);
    }
    conflicts(&ways, &mut text);
    let (validation, test) = split(dataset);
    text += &format!(
        "# Numbers of the recording files; a file that is in none of the lists is for training.\n\
         [split]\nvalidation = {validation:?}\ntest = {test:?}\n"
    );
    Some(text)
}

/// The tracks that neither begin nor end with their recording, and lead somewhere.
fn whole_tracks(dataset: &Dataset) -> impl Iterator<Item = &Track> {
    dataset.recordings.iter().flat_map(|recording| {
        let begin = recording.tracks.iter().map(|track| track.first_ms).min();
        let end = recording.tracks.iter().map(Track::last_ms).max();
        recording.tracks.iter().filter(move |track| {
            let [a, b] = [track.first(), track.last()];
            let inside = Some(track.first_ms) != begin && Some(track.last_ms()) != end;
            inside && (a.x - b.x).hypot(a.y - b.y) >= SHORTEST
        })
    })
}

/// A place where tracks begin and end.
struct Arm {
    name: String,
    low: [f64; 2],
    high: [f64; 2],
    ends: usize,
}

impl Arm {
    fn holds(&self, state: RawState) -> bool {
        let within = |i: usize, value: f64| self.low[i] < value && value < self.high[i];
        within(0, state.x) && within(1, state.y)
    }

    fn middle(&self) -> [f64; 2] {
        [0, 1].map(|i| (self.low[i] + self.high[i]) / 2.0)
    }

    fn write(&self, text: &mut String) {
        let Self {
            name,
            low: [west, south],
            high: [east, north],
            ends,
        } = self;
        let _ = write!(
            text,
            "[[arm]] # {ends} ends of tracks\nname = \"{name}\"\nabove_x = {west:.1}\nbelow_x = {east:.1}\n\
             above_y = {south:.1}\nbelow_y = {north:.1}\n\n"
        );
    }
}

type Square = (i64, i64);

/// Neighbouring squares with enough ends make an arm.
fn arms(tracks: &[&Track]) -> Vec<Arm> {
    let ends: Vec<RawState> = tracks
        .iter()
        .flat_map(|track| [track.first(), track.last()])
        .collect();
    let mut counts: BTreeMap<Square, usize> = BTreeMap::new();
    for end in &ends {
        let square = [end.x, end.y].map(|c| (c / SQUARE).floor() as i64);
        *counts.entry((square[0], square[1])).or_default() += 1;
    }
    counts.retain(|_, count| *count >= FEWEST_ENDS);
    let mut left: BTreeSet<Square> = counts.keys().copied().collect();
    let mut arms = Vec::new();
    while let Some(first) = left.pop_first() {
        let squares = neighbours_of(first, &mut left);
        let count = squares.iter().map(|square| counts[square]).sum::<usize>();
        if count as f64 >= LEAST_SHARE * ends.len() as f64 {
            arms.push(around(&squares, count));
        }
    }
    name(&mut arms);
    arms
}

/// Takes the squares out of `left` that hang together with `first`.
fn neighbours_of(first: Square, left: &mut BTreeSet<Square>) -> Vec<Square> {
    let mut squares = vec![first];
    let mut next = 0;
    while let Some(&(x, y)) = squares.get(next) {
        next += 1;
        for near in (-1..=1).flat_map(|i| (-1..=1).map(move |j| (x + i, y + j))) {
            if left.remove(&near) {
                squares.push(near);
            }
        }
    }
    squares
}

fn around(squares: &[Square], ends: usize) -> Arm {
    let bounds = |pick: fn(&Square) -> i64| {
        let values = || squares.iter().map(pick);
        let low = values().min().unwrap_or_default() as f64 * SQUARE;
        let high = (values().max().unwrap_or_default() + 1) as f64 * SQUARE;
        [low - MARGIN, high + MARGIN]
    };
    let ([west, east], [south, north]) = (bounds(|s| s.0), bounds(|s| s.1));
    Arm {
        name: String::new(),
        low: [west, south],
        high: [east, north],
        ends,
    }
}

/// Names the arms by their direction from the middle of all of them: `N`, `NE`, and so on, with a number where two
/// lie in one direction.
fn name(arms: &mut [Arm]) {
    const DIRECTIONS: [&str; 8] = ["E", "NE", "N", "NW", "W", "SW", "S", "SE"];
    let count = arms.len() as f64;
    let middle = [0, 1].map(|i| arms.iter().map(|arm| arm.middle()[i]).sum::<f64>() / count);
    let mut taken: BTreeMap<&str, usize> = BTreeMap::new();
    for arm in arms {
        let [x, y] = arm.middle();
        let angle = (y - middle[1]).atan2(x - middle[0]).to_degrees();
        let direction = DIRECTIONS[((angle / 45.0).round() as i64).rem_euclid(8) as usize];
        let number = taken.entry(direction).or_default();
        *number += 1;
        arm.name = match number {
            1 => direction.to_owned(),
            number => format!("{direction}{number}"),
        };
    }
}

/// The tracks from one arm to another.
struct Way<'t> {
    from: String,
    to: String,
    manoeuvre: Manoeuvre,
    tracks: Vec<&'t Track>,
}

impl Way<'_> {
    fn table(&self) -> String {
        format!("{{ from = \"{}\", to = \"{}\" }}", self.from, self.to)
    }

    fn write(&self, text: &mut String) {
        let manoeuvre = match self.manoeuvre {
            Manoeuvre::Left => "left",
            Manoeuvre::Straight => "straight",
            Manoeuvre::Right => "right",
            Manoeuvre::Unknown => return,
        };
        let (count, way) = (self.tracks.len(), self.table());
        let _ = write!(
            text,
            "[[movement]] # {count} tracks\nway = {way}\nmanoeuvre = \"{manoeuvre}\"\n\n"
        );
    }

    /// Its track with the middle turn.
    fn typical(&self) -> &Track {
        let mut tracks = self.tracks.clone();
        tracks.sort_by(|a, b| a.turn().total_cmp(&b.turn()));
        tracks[tracks.len() / 2]
    }
}

fn ways<'t>(tracks: &[&'t Track], arms: &[Arm]) -> Vec<Way<'t>> {
    let mut groups: BTreeMap<(usize, usize), Vec<&Track>> = BTreeMap::new();
    for track in tracks {
        let arm = |state| arms.iter().position(|arm| arm.holds(state));
        if let (Some(from), Some(to)) = (arm(track.first()), arm(track.last())) {
            groups.entry((from, to)).or_default().push(track);
        }
    }
    let enough = groups
        .into_iter()
        .filter(|(_, tracks)| tracks.len() >= FEWEST_TRACKS);
    enough
        .map(|((from, to), tracks)| {
            let [from, to] = [from, to].map(|arm| arms[arm].name.clone());
            let mut way = Way {
                from,
                to,
                manoeuvre: Manoeuvre::Unknown,
                tracks,
            };
            way.manoeuvre = by_turn(way.typical().turn());
            way
        })
        .collect()
}

/// Writes the conflicts of left turns with oncoming ways; those with other ways as comments.
fn conflicts(ways: &[Way<'_>], text: &mut String) {
    *text += "# Which movements meet: the left-turner's, and the other's. By default those of oncoming traffic; to judge\n\
              # others too, take the `# ` away.\n";
    let lefts = ways.iter().filter(|way| way.manoeuvre == Manoeuvre::Left);
    for left in lefts {
        for other in ways.iter().filter(|other| other.from != left.from) {
            let kind = if other.to == left.to {
                "merging"
            } else if meet(left.typical(), other.typical()) {
                "crossing"
            } else {
                continue;
            };
            let oncoming = is_oncoming(left.typical().first(), other.typical().first());
            let mark = if oncoming { "" } else { "# " };
            let (left, other) = (left.table(), other.table());
            let _ = write!(
                text,
                "{mark}[[conflict]]\n{mark}left = {left}\n{mark}other = {other}\n{mark}kind = \"{kind}\"\n\n"
            );
        }
    }
}

/// Whether the two polylines cross.
fn meet(one: &Track, other: &Track) -> bool {
    let side = |a: RawState, b: RawState, p: RawState| {
        (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x) > 0.0
    };
    let apart = |a, b, p, q| side(a, b, p) != side(a, b, q);
    one.states.windows(2).any(|ab| {
        let (a, b) = (ab[0], ab[1]);
        let crosses = |pq: &[RawState]| apart(a, b, pq[0], pq[1]) && apart(pq[0], pq[1], a, b);
        other.states.windows(2).any(crosses)
    })
}

/// The last file is for test, the one before it for validation; with fewer than three files all are for training.
fn split(dataset: &Dataset) -> (Vec<u16>, Vec<u16>) {
    let numbers: Vec<u16> = dataset.recordings.iter().map(|r| r.file).collect();
    match numbers.as_slice() {
        [_, .., validation, test] => (vec![*validation], vec![*test]),
        _ => (Vec::new(), Vec::new()),
    }
}
