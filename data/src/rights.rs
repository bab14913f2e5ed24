//! Who has to give way to whom where the ways of two vehicles meet: from the map, or by the general rules.

use super::crossing::{Point, crosses};
use super::lanelet::{Map, Regulation, RegulationKind, Sign, Trace};
use super::tracks::{Track, wrap};
use crate::role::{Manoeuvre, Role};
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
    /// None: there is no map, it has no regulations, or the vehicles were not on it.
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

impl Rule {
    /// As in tables, and as it is serialized.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Unknown => "unknown",
            Self::AllWayStop => "all-way-stop",
            Self::Regulation => "regulation",
            Self::MinorRoad => "minor-road",
            Self::LeftTurn => "left-turn",
            Self::Right => "right",
            Self::Open => "open",
        }
    }
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
    /// The last thing that `party` is told before it meets the other. Nothing is known of a map without any
    /// regulation: it may have been drawn without its signs.
    pub(crate) fn duty(&self, party: Party<'_>) -> Duty {
        let on = party.trace.0.iter().filter(|on| on.from <= party.arrival);
        let regulated = on.rev().find_map(|on| {
            let place = party.trace.0.iter().position(|other| other == on)?;
            let regulations: Vec<usize> = self.yielding(on.lanelet);
            let of = |&index: &usize| self.regulations[index].lines.iter();
            let lines: Vec<&Vec<Point>> = regulations.iter().flat_map(of).collect();
            let after = party.trace.0.get(place + 1);
            let line = crossed(party, &lines).or_else(|| Some(after?.from))?;
            (!regulations.is_empty() && line <= party.arrival).then_some((regulations, line))
        });
        match regulated {
            Some((regulations, line)) => Duty {
                control: self.control(&regulations),
                line: Some(line),
                regulations,
            },
            None => Duty {
                control: if party.trace.0.is_empty() || self.regulations.is_empty() {
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
fn crossed(party: Party<'_>, lines: &[&Vec<Point>]) -> Option<usize> {
    let states = party.track.states.get(..=party.arrival)?;
    let mut steps = states.windows(2).zip(1..);
    steps.find_map(|(step, index)| {
        let (from, to) = (step[0].position(), step[1].position());
        let mut pieces = lines.iter().flat_map(|line| line.windows(2));
        pieces
            .any(|piece| crosses(from, to, piece[0], piece[1]))
            .then_some(index)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanelet::{Lanelet, OnLanelet};
    use crate::tracks::RawState;

    /// A vehicle that comes from afar with this heading (rad), on lanelet `lanelet`, then on the next.
    fn track(heading: f64) -> Track {
        let state = |i: i32| {
            let s = f64::from(i) - 30.0;
            RawState {
                x: s * heading.cos(),
                y: s * heading.sin(),
                vx: 0.0,
                vy: 0.0,
                heading,
            }
        };
        Track {
            id: 1,
            first_ms: 0,
            length: 4.0,
            width: 2.0,
            states: (0..30).map(state).collect(),
        }
    }

    fn trace(lanelet: usize) -> Trace {
        let on = |lanelet, from| OnLanelet {
            lanelet,
            from,
            changed: false,
        };
        Trace(vec![on(lanelet, 0), on(lanelet + 1, 20)])
    }

    fn regulation(first: &[usize], yielding: &[usize], sign: Option<Sign>) -> Regulation {
        Regulation {
            kind: RegulationKind::RightOfWay,
            first: first.to_vec(),
            yielding: yielding.to_vec(),
            lines: Vec::new(),
            sign,
        }
    }

    /// What is read if the left-turner drives east on lanelets 0 and 1, the other with `heading` (rad) on
    /// 2 and 3.
    fn read(regulations: Vec<Regulation>, heading: f64) -> ([Control; 2], Rights) {
        let lanelet = || Lanelet::new(&[[0.0, 2.0], [9.0, 2.0]], &[[0.0, 0.0], [9.0, 0.0]], None);
        let map = Map {
            lanelets: (0..4).map(|_| lanelet()).collect(),
            regulations,
            ..Map::default()
        };
        let (tracks, traces) = ([track(0.0), track(heading)], [trace(0), trace(2)]);
        let party = |i: usize| Party {
            track: &tracks[i],
            trace: &traces[i],
            manoeuvre: [Manoeuvre::Left, Manoeuvre::Straight][i],
            arrival: 29,
        };
        let parties = [party(0), party(1)];
        let duties = parties.map(|party| map.duty(party));
        let rights = map.rights(parties, [&duties[0], &duties[1]]);
        (duties.map(|duty| duty.control), rights)
    }

    const WEST: f64 = std::f64::consts::PI;
    const NORTH: f64 = WEST / 2.0;

    #[test]
    fn without_signs_oncoming_traffic_and_who_comes_from_the_right_go_first() {
        // A sign somewhere else.
        let elsewhere = || vec![regulation(&[], &[], None)];
        let by = |heading| read(elsewhere(), heading).1;
        let first = |first, rule| Rights {
            first: Some(first),
            rule,
        };
        assert_eq!(by(WEST), first(Role::Other, Rule::LeftTurn));
        assert_eq!(by(NORTH), first(Role::Other, Rule::Right));
        assert_eq!(by(-NORTH), first(Role::Left, Rule::Right));
        assert_eq!(
            by(0.1),
            Rights {
                first: None,
                rule: Rule::Open
            }
        );
        assert_eq!(read(elsewhere(), WEST).0, [Control::Free; 2]);
        assert_eq!(
            read(Vec::new(), WEST),
            ([Control::Unknown; 2], Rights::default())
        );
    }

    #[test]
    fn who_has_a_sign_gives_way_to_who_has_none() {
        let stop = || vec![regulation(&[], &[2], Some(Sign::Stop))];
        let (controls, rights) = read(stop(), WEST);
        assert_eq!(controls, [Control::Free, Control::Stop]);
        assert_eq!(
            (rights.first, rights.rule),
            (Some(Role::Left), Rule::MinorRoad)
        );
        assert_eq!(rights.settled(), Some(Role::Left));
        // Both stop: the general rule counts again.
        let both = regulation(&[], &[0], Some(Sign::Yield));
        let (controls, rights) = read([stop(), vec![both]].concat(), WEST);
        assert_eq!(controls, [Control::Yield, Control::Stop]);
        assert_eq!(rights.rule, Rule::LeftTurn);
    }

    #[test]
    fn a_regulation_that_names_both_counts_more_and_a_signed_one_most() {
        let named = regulation(&[0], &[2], Some(Sign::Stop));
        let (_, rights) = read(vec![named.clone()], NORTH);
        assert_eq!(
            (rights.first, rights.rule),
            (Some(Role::Left), Rule::Regulation)
        );
        let unsigned = regulation(&[2], &[0], None);
        let (controls, rights) = read(vec![unsigned.clone()], NORTH);
        assert_eq!(controls, [Control::Free; 2]);
        assert_eq!(
            (rights.first, rights.rule),
            (Some(Role::Other), Rule::Regulation)
        );
        let (_, rights) = read(vec![unsigned, named], NORTH);
        assert_eq!(rights.first, Some(Role::Left));
    }

    #[test]
    fn at_an_all_way_stop_nothing_is_settled_but_a_tie() {
        let stop = Regulation {
            kind: RegulationKind::AllWayStop,
            ..regulation(&[], &[0, 2], None)
        };
        let (controls, rights) = read(vec![stop], WEST);
        assert_eq!(controls, [Control::AllWayStop; 2]);
        assert_eq!(
            (rights.first, rights.rule),
            (Some(Role::Other), Rule::AllWayStop)
        );
        assert_eq!(rights.settled(), None);
    }

    #[test]
    fn the_line_is_where_the_path_crosses_it_before_the_meeting() {
        let mut stop = regulation(&[], &[0], Some(Sign::Stop));
        // The left-turner is at x = −9 in its state 21.
        stop.lines = vec![vec![[-9.5, -3.0], [-9.5, 3.0]]];
        let lanelet = || Lanelet::new(&[[0.0, 2.0], [9.0, 2.0]], &[[0.0, 0.0], [9.0, 0.0]], None);
        let map = Map {
            lanelets: vec![lanelet(), lanelet()],
            regulations: vec![stop],
            ..Map::default()
        };
        let (track, trace) = (track(0.0), trace(0));
        let duty = |arrival| {
            map.duty(Party {
                track: &track,
                trace: &trace,
                manoeuvre: Manoeuvre::Left,
                arrival,
            })
        };
        assert_eq!((duty(29).control, duty(29).line), (Control::Stop, Some(21)));
        // Who meets the other before its line is told nothing there.
        assert_eq!(duty(15).control, Control::Free);
    }
}
