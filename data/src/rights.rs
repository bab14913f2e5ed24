//! Who has to give way to whom where the ways of two vehicles meet: from the map, or by the general rules.

use super::crossing::Point;
use super::lanelet::{Map, Regulation, RegulationKind, Sign, Trace};
use super::tracks::{Track, wrap};
use crate::encounter::{Manoeuvre, Role};
use cede_controller::Control;

/// What a vehicle finds where it enters a junction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Entry {
    /// What obliges it to give way.
    pub control: Control,
    /// Arc length (m) on its route at which its centre crosses the line where it waits; negative if it had
    /// crossed it before its route begins. `None` without a [`Control`] that has a line.
    pub line: Option<f32>,
    /// The lowest speed limit (m/s) on its way through the map, if there is one.
    pub limit: Option<f32>,
}

/// Who goes first by the rules of the road, and by which rule.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Rights {
    /// The vehicle that has the right of way; at an all-way stop the one that has it if both stop at once.
    /// `None` if no rule decides.
    pub first: Option<Role>,
    /// The rule.
    pub rule: Rule,
}

/// The rule by which it is known who goes first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Rule {
    /// None: there is no map, or the vehicles were not on it.
    #[default]
    Unknown,
    /// Both stop; who has stopped first goes first.
    AllWayStop,
    /// The map says that one of the two lanes gives way to the other.
    Regulation,
    /// One of the two has a sign that tells it to give way, and the other has none.
    MinorRoad,
    /// Who turns left gives way to oncoming traffic.
    LeftTurn,
    /// Right before left.
    Right,
    /// The two come from the same side, or no rule decides.
    Open,
}

impl Rights {
    /// Who goes first whatever the order in which the two arrive; `None` at an all-way stop.
    #[must_use]
    pub fn settled(self) -> Option<Role> {
        self.first.filter(|_| self.rule != Rule::AllWayStop)
    }
}

/// A vehicle with its way through the map, until it reaches the place where it meets another.
#[derive(Clone, Copy)]
pub(crate) struct Party<'t> {
    pub(crate) track: &'t Track,
    pub(crate) trace: &'t Trace,
    pub(crate) manoeuvre: Manoeuvre,
    /// Index of its state where it meets the other.
    pub(crate) arrival: usize,
}

/// What a vehicle is told on its way, and where.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Duty {
    pub(crate) control: Control,
    /// Index of the state before which the vehicle crosses its line.
    pub(crate) line: Option<usize>,
    /// Indices of the regulations that it gives way by.
    regulations: Vec<usize>,
}

impl Map {
    /// The last thing that `party` is told before it meets the other.
    pub(crate) fn duty(&self, party: Party<'_>) -> Duty {
        let on = party.trace.0.iter().filter(|on| on.from <= party.arrival);
        let regulated = on.rev().find_map(|on| {
            let place = party.trace.0.iter().position(|other| other == on)?;
            let regulations: Vec<usize> = self.yielding(on.lanelet);
            let lines = regulations.iter().flat_map(|&r| &self.regulations[r].lines);
            let line =
                crossed(party, lines).or_else(|| Some(party.trace.0.get(place + 1)?.from))?;
            (!regulations.is_empty() && line <= party.arrival).then_some((regulations, line))
        });
        match regulated {
            Some((regulations, line)) => Duty {
                control: self.control(&regulations),
                line: Some(line),
                regulations,
            },
            None => Duty {
                control: if party.trace.0.is_empty() {
                    Control::Unknown
                } else {
                    Control::Free
                },
                ..Duty::default()
            },
        }
    }

    /// The lowest speed limit (m/s) of the lanelets of `trace`.
    pub(crate) fn limit(&self, trace: &Trace) -> Option<f64> {
        let limits = trace.0.iter().map(|on| self.lanelets[on.lanelet].limit);
        limits.flatten().reduce(f64::min)
    }

    /// Who of two goes first, in the order of [`Role::BOTH`], with what each is told.
    pub(crate) fn rights(&self, parties: [Party<'_>; 2], duties: [&Duty; 2]) -> Rights {
        let [left, other] = duties;
        if [left, other]
            .iter()
            .any(|duty| duty.control == Control::Unknown)
        {
            return Rights::default();
        }
        let named = [0, 1].map(|i| self.gives_way_to(duties[i], parties[1 - i].trace));
        let bound = duties.map(|duty| duty.control != Control::Free);
        let by = |yields: [bool; 2], rule| {
            let first = match yields {
                [true, false] => Some(Role::Other),
                [false, true] => Some(Role::Left),
                _ => None,
            };
            first.map(|first| Rights {
                first: Some(first),
                rule,
            })
        };
        // Of two regulations that contradict each other the one with a sign counts.
        let signed = named.map(|named| named == Some(true));
        let general = general(parties);
        if duties
            .iter()
            .all(|duty| duty.control == Control::AllWayStop)
        {
            return Rights {
                first: general.first,
                rule: Rule::AllWayStop,
            };
        }
        by(named.map(|named| named.is_some()), Rule::Regulation)
            .or_else(|| by(signed, Rule::Regulation))
            .or_else(|| by(bound, Rule::MinorRoad))
            .unwrap_or(general)
    }

    /// The regulations by which vehicles of `lanelet` give way.
    fn yielding(&self, lanelet: usize) -> Vec<usize> {
        let all = self.regulations.iter().enumerate();
        let of_it = all.filter(|(_, regulation)| regulation.yielding.contains(&lanelet));
        of_it.map(|(index, _)| index).collect()
    }

    fn control(&self, regulations: &[usize]) -> Control {
        let of = |&index: &usize| match &self.regulations[index] {
            Regulation {
                kind: RegulationKind::AllWayStop,
                ..
            } => Control::AllWayStop,
            Regulation {
                sign: Some(Sign::Stop),
                ..
            } => Control::Stop,
            Regulation {
                sign: Some(Sign::Yield),
                ..
            } => Control::Yield,
            // It binds towards the lanelets that it names, and makes no minor road.
            Regulation { sign: None, .. } => Control::Free,
        };
        let controls = regulations.iter().map(of);
        controls
            .max_by_key(|control| *control as u8)
            .unwrap_or_default()
    }

    /// Whether a regulation of `duty` names a lanelet of `trace` as the one to give way to, and if so, whether
    /// there is a sign that says so.
    fn gives_way_to(&self, duty: &Duty, trace: &Trace) -> Option<bool> {
        let regulations = duty.regulations.iter().map(|&r| &self.regulations[r]);
        let naming = regulations.filter(|regulation| trace.follows(&regulation.first));
        naming.map(|regulation| regulation.sign.is_some()).max()
    }
}

/// The first state of `party` past one of `lines`, if it crosses one on its way to the other.
fn crossed<'l>(
    party: Party<'_>,
    lines: impl Iterator<Item = &'l Vec<Point>> + Clone,
) -> Option<usize> {
    let states = party.track.states.get(..=party.arrival)?;
    let mut steps = states.windows(2).zip(1..);
    steps.find_map(|(step, index)| {
        let (from, to) = (step[0].position(), step[1].position());
        let pieces = lines.clone().flat_map(|line| line.windows(2));
        let mut pieces = pieces.map(|piece| super::crossing::crosses(from, to, piece[0], piece[1]));
        pieces.any(|crosses| crosses).then_some(index)
    })
}

/// Two that come from the same side differ by less than this (degrees) in their headings.
const SAME_SIDE_DEGREES: f64 = 45.0;
/// Two that come from opposite sides differ by more than this.
const OPPOSITE_DEGREES: f64 = 135.0;

/// Who goes first where no sign tells: oncoming traffic before who turns left, and who comes from the right.
fn general(parties: [Party<'_>; 2]) -> Rights {
    let heading = |party: Party<'_>| party.track.first().heading;
    let [left, other] = parties;
    let apart = wrap(heading(other) - heading(left)).to_degrees();
    let turns = parties.map(|party| party.manoeuvre == Manoeuvre::Left);
    let (first, rule) = if apart.abs() > OPPOSITE_DEGREES {
        let first = match turns {
            [true, false] => Some(Role::Other),
            [false, true] => Some(Role::Left),
            _ => None,
        };
        (first, Rule::LeftTurn)
    } else if apart.abs() > SAME_SIDE_DEGREES {
        // Who comes from the right drives to the left.
        let right = if apart > 0.0 { Role::Other } else { Role::Left };
        (Some(right), Rule::Right)
    } else {
        (None, Rule::Open)
    };
    Rights {
        first,
        rule: if first.is_some() { rule } else { Rule::Open },
    }
}
