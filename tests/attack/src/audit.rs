//! Whether the controller's zones cover every overlap, by a search of the attacker's own.

use crate::lane::Lane;
use crate::plane::{Place, direction, minus, norm, separation};
use crate::rng::Rng;
use crate::scenario::{Family, SHARE};
use crate::site::{Area, Site};
use crate::sway::Sway;
use rayon::prelude::*;

/// How a vehicle's heading follows its lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Heading {
    /// That of its lane, to within the tolerance; before and after kinks all directions in between, as near to them as the
    /// junction allows.
    Lane,
    /// That of the chord from so many metres behind it to as many ahead: it turns before a kink and after it.
    Chord(f64),
}

/// An overlap outside of all zones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// How deep, in m.
    pub depth: f64,
    /// Arc lengths of both.
    pub at: [f64; 2],
}

/// Arc lengths of the controller are f32: a place is off by so much (m) at most. Half of the shield's slack.
const ROUNDING: f64 = 0.005;

/// Steps of a descent.
const STEPS: u32 = 40;

/// A search for overlaps of vehicles on lanes `a` and `b` that no zone covers: the deepest that is found.
#[must_use]
pub fn uncovered(
    site: &Site,
    (a, b): (usize, usize),
    heading: Heading,
    starts: u32,
    rng: &mut Rng,
) -> Option<Gap> {
    let areas = site.areas(a, b);
    let lanes = [&site.lanes[a], &site.lanes[b]];
    let mut worst: Option<Gap> = None;
    for _ in 0..starts {
        let mut at = start(lanes, areas, rng);
        let sways = lanes.map(|lane| Sway::random(site.tolerance, lane.size, rng));
        let gap = |at: [f64; 2]| {
            let [p, q] = [0, 1].map(|i| place(lanes[i], at[i], heading, sways[i]));
            separation(p, lanes[0].size, q, lanes[1].size)
        };
        let free = |at: [f64; 2]| inside(lanes, at) && !covered(areas, at);
        if !free(at) {
            continue;
        }
        let (mut least, mut step) = (gap(at), 2.0);
        for _ in 0..STEPS {
            let next = at.map(|s| s + rng.within(-step, step));
            let near = if free(next) { gap(next) } else { f64::INFINITY };
            if near < least {
                (at, least) = (next, near);
            } else {
                step *= 0.8;
            }
        }
        if least < 0.0 && worst.is_none_or(|worst| worst.depth < -least) {
            worst = Some(Gap { depth: -least, at });
        }
    }
    worst
}

/// What was found on the sites of one family.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Found {
    /// Pairs of lanes.
    pub pairs: u64,
    /// Those with an overlap outside of all zones.
    pub gaps: u64,
    /// The deepest: seed of its site, lanes, gap.
    pub deepest: Option<(u64, [usize; 2], Gap)>,
}

impl Found {
    fn plus(self, other: Self) -> Self {
        let deepest = match (self.deepest, other.deepest) {
            (Some(a), Some(b)) => Some(if a.2.depth >= b.2.depth { a } else { b }),
            (a, b) => a.or(b),
        };
        Self {
            pairs: self.pairs + other.pairs,
            gaps: self.gaps + other.gaps,
            deepest,
        }
    }
}

/// Searches the sites of the scenarios from `seed` on.
#[must_use]
pub fn of_family(family: &Family, seed: u64, sites: u64, starts: u32) -> Found {
    let seeds = (0..sites).into_par_iter().map(|i| seed + i * SHARE);
    let found = seeds.map(|seed| {
        let site = family.site(seed);
        site.map_or_else(Found::default, |site| of_site(&site, seed, starts))
    });
    found.reduce(Found::default, Found::plus)
}

fn of_site(site: &Site, seed: u64, starts: u32) -> Found {
    let mut rng = Rng::new(seed);
    let mut found = Found::default();
    let count = site.lanes.len();
    for (a, b) in (0..count).flat_map(|a| (0..count).map(move |b| (a, b))) {
        let gap = uncovered(site, (a, b), Heading::Lane, starts, &mut rng);
        found = found.plus(Found {
            pairs: 1,
            gaps: u64::from(gap.is_some()),
            deepest: gap.map(|gap| (seed, [a, b], gap)),
        });
    }
    found
}

fn inside(lanes: [&Lane; 2], at: [f64; 2]) -> bool {
    (0..2).all(|i| (0.0..=lanes[i].line.length()).contains(&at[i]))
}

/// Whether a zone covers both arc lengths.
fn covered(areas: &[Area], [s, t]: [f64; 2]) -> bool {
    let within = |[from, to]: [f64; 2], x: f64| from - ROUNDING <= x && x <= to + ROUNDING;
    areas
        .iter()
        .any(|area| within(area.ego, s) && within(area.other, t) && within(area.lead, s - t))
}

/// At an edge of a zone, at a kink, or anywhere.
fn start(lanes: [&Lane; 2], areas: &[Area], rng: &mut Rng) -> [f64; 2] {
    let one = |i: usize, rng: &mut Rng| {
        let lane = lanes[i];
        let edge = |area: &Area| if i == 0 { area.ego } else { area.other };
        match rng.below(4) {
            0 => lane.line.arc()[rng.below(lane.line.arc().len())] + rng.within(-0.3, 0.3),
            1 | 2 if !areas.is_empty() => {
                let edge = edge(&areas[rng.below(areas.len())])[rng.below(2)];
                edge.clamp(0.0, lane.line.length()) + rng.within(-0.15, 0.15)
            }
            _ => rng.within(0.0, lane.line.length()),
        }
    };
    [one(0, rng), one(1, rng)]
}

fn place(lane: &Lane, s: f64, heading: Heading, sway: Sway) -> Place {
    let Heading::Chord(reach) = heading else {
        return sway.place(&lane.line, s);
    };
    let at = |s: f64| lane.line.place(s);
    let chord = minus(at(s + reach).at, at(s - reach).at);
    Place {
        at: at(s).at,
        to: if norm(chord) > 1e-6 {
            direction(chord)
        } else {
            at(s).to
        },
    }
}
