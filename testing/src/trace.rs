//! What happened in a case, as a picture and a table in one: a person sees who was where, and when.

use crate::case::Case;
use crate::place::{Road, TestJunction};
use crate::world::{Overlap, World};
use cede_controller::{Cause, Decision};
use std::fmt;

/// Metres from the left edge of the picture to the beginning of a zone.
const BEFORE: f64 = 40.0;
/// Metres in the picture.
const WIDTH: usize = 60;
/// Rows, at most.
const ROWS: usize = 40;

/// One call.
#[derive(Clone, Debug)]
pub(crate) struct Moment {
    time: f64,
    ego: (f64, f64),
    others: Vec<(u16, Road, f64, f64)>,
    acceleration: f32,
    cause: &'static str,
}

impl Moment {
    pub(crate) fn of(world: &World<'_>, decision: &Decision) -> Self {
        let others = world.others.iter();
        Self {
            time: world.time(),
            ego: (world.ego.state.s, world.ego.state.v),
            others: others
                .map(|other| (other.number, other.road, other.state.s, other.state.v))
                .collect(),
            acceleration: decision.acceleration,
            cause: match decision.cause {
                Cause::Policy => "accepted",
                Cause::Shielded(_) => "shielded",
                _ => "fallback",
            },
        }
    }
}

/// All calls of a run.
pub(crate) struct Trace {
    /// For each road, where the ego's first zone with it begins and ends, and where it begins for the other.
    zones: Vec<Option<[f64; 3]>>,
    /// The road whose zone the ego's place is drawn against.
    reference: Road,
    pub(crate) moments: Vec<Moment>,
    pub(crate) overlap: Option<Overlap>,
}

impl Trace {
    pub(crate) fn new(case: &Case, junction: &TestJunction) -> Self {
        let zones = Road::ALL.map(|road| {
            let conflict = junction.conflict(Road::Own.path(), road.path())?;
            let bounded = conflict.zones().filter(|zone| zone.ego.from > -1e5);
            let first = bounded.min_by(|a, b| a.ego.from.total_cmp(&b.ego.from))?;
            Some([first.ego.from, first.ego.to, first.other.from].map(f64::from))
        });
        let mut roads = case.others.iter().map(|other| other.road);
        let reference = roads.find(|road| zones[*road as usize].is_some());
        Self {
            zones: zones.to_vec(),
            reference: reference.unwrap_or(Road::First),
            moments: Vec::new(),
            overlap: None,
        }
    }

    /// Metres past the beginning of the zone.
    fn past(&self, road: Road, s: f64) -> f64 {
        let origin = match (
            self.zones[road as usize],
            self.zones[self.reference as usize],
        ) {
            (Some([_, _, other]), _) => other,
            (None, Some([ego, ..])) => ego,
            (None, None) => 80.0,
        };
        s - origin
    }

    fn row(&self, moment: &Moment) -> String {
        let zone = self.zones[self.reference as usize].unwrap_or([80.0, 80.0, 80.0]);
        let mut row = vec![b' '; WIDTH];
        let mut mark = |metres: f64, letter: u8| {
            let at = metres + BEFORE;
            if at >= 0.0 && at < WIDTH as f64 {
                let place = &mut row[at as usize];
                *place = if *place == b' ' || *place == b'|' {
                    letter
                } else {
                    b'*'
                };
            }
        };
        mark(0.0, b'|');
        mark(zone[1] - zone[0], b'|');
        mark(moment.ego.0 - zone[0], b'E');
        for (number, road, s, _) in &moment.others {
            mark(self.past(*road, *s), b'0' + (*number % 10) as u8);
        }
        String::from_utf8_lossy(&row).into_owned()
    }
}

impl fmt::Display for Trace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "One column is 1 m of the road of each. E: the ego, 1, 2, …: the others, *: two at once; \
             |: where the zone begins and where the ego has left it."
        )?;
        writeln!(
            f,
            "{:>6} {:WIDTH$} {:>8} {:>7} {:9} others' m/s",
            "s", "", "ego m/s", "m/s²", ""
        )?;
        let every = self.moments.len().div_ceil(ROWS).max(1);
        let last = self.moments.len().saturating_sub(1);
        let rows = self.moments.iter().enumerate();
        for (_, moment) in rows.filter(|(i, _)| i % every == 0 || *i == last) {
            let speeds: Vec<_> = moment
                .others
                .iter()
                .map(|(.., v)| format!("{v:.1}"))
                .collect();
            let Moment {
                time,
                ego: (_, v),
                acceleration,
                cause,
                ..
            } = moment;
            let (row, speeds) = (self.row(moment), speeds.join(" "));
            writeln!(
                f,
                "{time:6.2} {row} {v:8.1} {acceleration:7.2} {cause:9} {speeds}"
            )?;
        }
        match self.overlap {
            None => Ok(()),
            Some(overlap) => write!(f, "{overlap}"),
        }
    }
}

impl fmt::Display for Overlap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            other,
            time,
            speeds: [ego, its],
        } = self;
        write!(
            f,
            "the ego ({ego:.1} m/s) and other {other} ({its:.1} m/s) overlap after {time:.2} s"
        )
    }
}
