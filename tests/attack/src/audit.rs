//! Whether the controller's zones cover every overlap, by a search of the attacker's own.

use crate::plane::{Place, direction, minus, norm, separation};
use crate::rng::Rng;
use crate::site::{Area, Lane, Site};
use crate::sway::Sway;

/// How a vehicle's heading follows its lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Heading {
    /// That of its lane, to within the tolerance; through kinks all directions in between, on the spot.
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
        let sways = lanes.map(|lane| Sway::random(site.tolerance, lane.size.radius(), rng));
        let shares = [rng.unit(), rng.unit()];
        let gap = |at: [f64; 2]| {
            let [p, q] = [0, 1].map(|i| place(lanes[i], at[i], heading, shares[i], sways[i]));
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

fn inside(lanes: [&Lane; 2], at: [f64; 2]) -> bool {
    (0..2).all(|i| (0.0..=lanes[i].line.length()).contains(&at[i]))
}

/// Whether a zone covers both arc lengths.
fn covered(areas: &[Area], [s, t]: [f64; 2]) -> bool {
    let within = |[from, to]: [f64; 2], x: f64| from - ROUNDING <= x && x <= to + ROUNDING;
    areas.iter().any(|area| {
        within(area.ego, s) && within(area.other, t) && within(area.lead, s - t)
    })
}

/// At an edge of a zone, at a kink, or anywhere.
fn start(lanes: [&Lane; 2], areas: &[Area], rng: &mut Rng) -> [f64; 2] {
    let one = |i: usize, rng: &mut Rng| {
        let lane = lanes[i];
        let edge = |area: &Area| if i == 0 { area.ego } else { area.other };
        match rng.below(4) {
            0 if !lane.kinks.is_empty() => lane.kinks[rng.below(lane.kinks.len())].s,
            1 | 2 if !areas.is_empty() => {
                let edge = edge(&areas[rng.below(areas.len())])[rng.below(2)];
                edge.clamp(0.0, lane.line.length()) + rng.within(-0.15, 0.15)
            }
            _ => rng.within(0.0, lane.line.length()),
        }
    };
    [one(0, rng), one(1, rng)]
}

fn place(lane: &Lane, s: f64, heading: Heading, share: f64, sway: Sway) -> Place {
    match heading {
        Heading::Lane => {
            let kink = lane.kinks.iter().find(|kink| kink.s == s);
            let nominal = match kink {
                Some(kink) => Place {
                    at: lane.line.place(s).at,
                    to: kink.between(share),
                },
                None => lane.line.turning_place(s, lane.gentle),
            };
            sway.displace(nominal, s)
        }
        Heading::Chord(reach) => {
            let at = lane.line.place(s).at;
            let chord = minus(lane.line.place(s + reach).at, lane.line.place(s - reach).at);
            let to = if norm(chord) > 1e-6 { direction(chord) } else { lane.line.place(s).to };
            Place { at, to }
        }
    }
}
