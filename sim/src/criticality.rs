//! How critical a recorded encounter was, by the measures of the literature.
//!
//! The conflict area is where the lanes of the two vehicles overlap, if the map has them; otherwise where
//! their footprints can touch on their recorded paths.

use crate::meeting;
use crate::metrics::{half_diagonal, least_ttc, recorded_states};
use cede_controller::kinematics::{STEP, State};
use cede_controller::separation::OrientedBox;
use cede_controller::{RouteConflict, Span};
use cede_data::Dataset;
use cede_data::encounter::{Encounter, Participant, Role};
use cede_data::lanelet::{ConflictArea, rectangle};
use geo::{Distance, Euclidean};

/// Step (m) in which a route is searched for the ends of the conflict area.
const SEARCH: f32 = 0.25;
/// Halvings of such a step: to less than a millimetre.
const HALVINGS: u32 = 9;

/// What the conflict area is taken from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AreaOf {
    /// The lanes of the map.
    Lanes,
    /// The recorded paths and the vehicles' sizes.
    Paths,
}

impl AreaOf {
    /// As in tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Lanes => "lanes",
            Self::Paths => "paths",
        }
    }
}

/// The measures of one encounter; for each role in the order of [`Role::BOTH`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Criticality {
    /// Least time to collision (s; Hayward 1972): until the two would touch, if both kept their speeds on their
    /// routes. `None` above [`crate::metrics::TTC_HORIZON`].
    pub ttc: Option<f64>,
    /// What the conflict area is taken from; `None` if there is none.
    pub area: Option<AreaOf>,
    /// Encroachment time (s; Allen, Shin and Cooper 1978): how long a vehicle is in the conflict area. `None` if the
    /// record lacks its entry or its exit.
    pub encroachment: [Option<f64>; 2],
    /// Post-encroachment time (s; the same): from the exit of the first to the entry of the second. `None` if the
    /// record lacks one of them, or if both were in the area at once.
    pub post_encroachment: Option<f64>,
    /// Smallest distance (m) between the two footprints at one time.
    pub gap: f64,
    /// Greatest deceleration (m/s²) at which the second vehicle would have had to brake in order to enter the
    /// conflict area no sooner than the first, keeping its speed, would have left it (after Cooper and Ferguson
    /// 1976). 0 if it never had to; `None` if both were in the area at once, or the record does not say.
    pub deceleration: Option<f64>,
}

impl Criticality {
    /// Of the record of `encounter`, which is of `dataset`.
    ///
    /// Cost: about a millisecond, and the matching of two tracks to the map.
    #[must_use]
    pub fn of(dataset: &Dataset, encounter: &Encounter) -> Self {
        let bodies = Role::BOTH.map(|role| encounter.judged(role).footprint);
        let states: Vec<[State; 2]> = recorded_states(encounter).collect();
        let (area, spans) = conflict(dataset, encounter);
        let stays = spans.map(|spans| {
            Role::BOTH.map(|role| Stay::of(encounter.judged(role), spans[role as usize]))
        });
        Self {
            ttc: least_ttc(encounter, &states, bodies).map(|(_, seconds)| seconds),
            area,
            encroachment: stays.map_or([None; 2], |stays| stays.map(Stay::duration)),
            post_encroachment: stays.and_then(post_encroachment),
            gap: gap(encounter, &states),
            deceleration: spans
                .zip(stays)
                .and_then(|(spans, stays)| deceleration(&states, spans, stays)),
        }
    }
}

/// The conflict area, as arc lengths of both routes (m).
fn conflict(dataset: &Dataset, encounter: &Encounter) -> (Option<AreaOf>, Option<[Span; 2]>) {
    let lanes = dataset.conflict_area(encounter);
    let [left, other] = Role::BOTH.map(|role| {
        lanes
            .as_ref()
            .and_then(|area| in_area(encounter.judged(role), area))
    });
    if let (Some(left), Some(other)) = (left, other) {
        return (Some(AreaOf::Lanes), Some([left, other]));
    }
    let paths = paths(encounter);
    (paths.map(|_| AreaOf::Paths), paths)
}

/// Where the footprints can touch first on the recorded paths.
fn paths(encounter: &Encounter) -> Option<[Span; 2]> {
    let junction = meeting::recorded(encounter, |vehicle| vehicle.footprint).ok()?;
    let zones = meeting::conflict(&junction, 0)
        .into_iter()
        .flat_map(RouteConflict::zones);
    let first = zones.min_by(|a, b| a.ego.from.total_cmp(&b.ego.from))?;
    Some([first.ego, first.other])
}

/// The arc lengths (m) of `vehicle` from its entry into `area` to its exit.
fn in_area(vehicle: &Participant, area: &ConflictArea) -> Option<Span> {
    let inside = |s: f32| area.meets(&body(vehicle, s));
    let (from, to) = (vehicle.record.first()?.s, vehicle.record.last()?.s);
    let places = ((to - from) / SEARCH) as u32 + 1;
    let place = |i: u32| from + SEARCH * i as f32;
    let entry = (0..=places).find(|&i| inside(place(i)))?;
    let exit = (entry..=places).rev().find(|&i| inside(place(i)))?;
    let end = |outside: f32, within: f32| {
        let halve = |(outside, within): (f32, f32), _| match 0.5 * (outside + within) {
            middle if inside(middle) => (outside, middle),
            middle => (middle, within),
        };
        (0..HALVINGS).fold((outside, within), halve).1
    };
    Some(Span {
        from: if entry == 0 {
            f32::NEG_INFINITY
        } else {
            end(place(entry - 1), place(entry))
        },
        to: if exit == places {
            f32::INFINITY
        } else {
            end(place(exit + 1), place(exit))
        },
    })
}

fn body(vehicle: &Participant, s: f32) -> OrientedBox {
    OrientedBox::new(vehicle.route.pose(s), vehicle.footprint)
}

/// When a vehicle enters and leaves the conflict area, in s from the encounter's start; `None` where the record
/// lacks it.
#[derive(Clone, Copy)]
struct Stay {
    entry: Option<f64>,
    exit: Option<f64>,
}

impl Stay {
    fn of(vehicle: &Participant, span: Span) -> Self {
        Self {
            entry: passes(vehicle, span.from),
            exit: passes(vehicle, span.to),
        }
    }

    fn duration(self) -> Option<f64> {
        Some(self.exit? - self.entry?)
    }
}

/// When `vehicle` is first at the arc length `s` or beyond it, if it comes from before it.
fn passes(vehicle: &Participant, s: f32) -> Option<f64> {
    let mut steps = vehicle.record.windows(2).zip(0_u32..);
    let (step, index) = steps.find(|(step, _)| step[0].s < s && step[1].s >= s)?;
    let share = f64::from((s - step[0].s) / (step[1].s - step[0].s));
    Some((f64::from(index) + share) * f64::from(STEP))
}

/// Whoever enters the conflict area first, as an index.
fn first(stays: [Stay; 2]) -> Option<usize> {
    match stays.map(|stay| stay.entry) {
        [Some(left), Some(other)] => Some(usize::from(other < left)),
        [None, Some(_)] => stays[0].exit.map(|_| 0),
        [Some(_), None] => stays[1].exit.map(|_| 1),
        [None, None] => None,
    }
}

fn post_encroachment(stays: [Stay; 2]) -> Option<f64> {
    let first = first(stays)?;
    let time = stays[1 - first].entry? - stays[first].exit?;
    (time >= 0.0).then_some(time)
}

/// The smallest distance (m) between the footprints.
fn gap(encounter: &Encounter, states: &[[State; 2]]) -> f64 {
    let [left, other] = Role::BOTH.map(|role| encounter.judged(role));
    let reach = f64::from(half_diagonal(left.footprint) + half_diagonal(other.footprint));
    let mut least = f64::INFINITY;
    for state in states {
        let bodies = [body(left, state[0].s), body(other, state[1].s)];
        let centres = f64::from(bodies[0].centres_apart_squared(&bodies[1])).sqrt();
        if centres - reach < least {
            let [a, b] = [rectangle(&bodies[0]), rectangle(&bodies[1])];
            least = least.min(Euclidean.distance(&a, &b));
        }
    }
    least
}

fn deceleration(states: &[[State; 2]], spans: [Span; 2], stays: [Stay; 2]) -> Option<f64> {
    // Whoever entered too early would have had to brake without bound just before.
    post_encroachment(stays)?;
    let first = first(stays)?;
    let required = states.iter().map(|state| {
        let [lead, follower] = [state[first], state[1 - first]];
        required(lead, spans[first], follower, spans[1 - first])
    });
    Some(required.fold(0.0, f64::max))
}

/// The deceleration (m/s²) at which `follower` has to brake now in order to enter its `area` no sooner than `lead`
/// leaves its own, if that keeps its speed. 0 if it would be too late or too early to meet it.
fn required(lead: State, lead_area: Span, follower: State, area: Span) -> f64 {
    let time = |distance: f32, speed: f32| match distance > 0.0 {
        true => f64::from(distance) / f64::from(speed),
        false => 0.0,
    };
    let [v, distance] = [follower.v, area.from - follower.s].map(f64::from);
    let leaves = time(lead_area.to - lead.s, lead.v);
    let enters = time(lead_area.from - lead.s, lead.v);
    let gone = lead.s >= lead_area.to;
    let apart = distance / v >= leaves || time(area.to - follower.s, follower.v) <= enters;
    if gone || distance <= 0.0 || v <= 0.0 || apart {
        return 0.0;
    }
    if v * leaves <= 2.0 * distance {
        2.0 * (v * leaves - distance) / (leaves * leaves)
    } else {
        v * v / (2.0 * distance)
    }
}
