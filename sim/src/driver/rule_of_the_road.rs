//! The rules of the road: who has to give way waits, unless there is time enough to go before the other.

use super::nearer_first::Decided;
use super::right_of_way::CRUISE;
use super::{Driver, DriverFactory};
use crate::meeting::Meeting;
use cede_data::Rule;
use cede_data::encounter::{Encounter, Role};

/// Who gives way goes first all the same if it arrives earlier by this many seconds: the base critical
/// headway of a left turn from the major road (Highway Capacity Manual 2010, exhibit 19-10: 4.1 s).
const CRITICAL_HEADWAY: f32 = 4.1;
/// At an all-way stop two whose arrivals differ by less than this many seconds have stopped at once.
const AT_ONCE: f32 = 0.5;

/// Drives by right of way, as the map says it: who has it goes; the other waits, unless it arrives earlier
/// by a critical headway. At an all-way stop, and where nothing is known, who arrives sooner goes.
///
/// Arrival times are those at the initial speeds, or at a calm turn's where they are lower.
#[derive(Clone, Copy, Debug)]
pub struct RuleOfTheRoad;

impl DriverFactory for RuleOfTheRoad {
    fn name(&self) -> &str {
        "rule-of-the-road"
    }

    fn driver<'m>(&self, meeting: &'m Meeting<'_>, ego: usize, _: u64) -> Box<dyn Driver + 'm> {
        let encounter = meeting.encounter;
        let speed = encounter.participants.get(ego).map_or(0.0, first_speed);
        Box::new(Decided {
            first: first(encounter),
            cruise: CRUISE.max(speed),
        })
    }
}

/// Who goes first, by the rules and the initial states of `encounter`.
fn first(encounter: &Encounter) -> Role {
    let [left, other] = Role::BOTH.map(|role| arrival(encounter, role));
    let sooner = if left <= other {
        Role::Left
    } else {
        Role::Other
    };
    let (rights, lead) = (encounter.rights, (left - other).abs());
    let margin = match rights.rule {
        Rule::AllWayStop => AT_ONCE,
        _ => CRITICAL_HEADWAY,
    };
    match rights.first {
        Some(first) if sooner != first && lead < margin => first,
        _ => sooner,
    }
}

/// Seconds until the vehicle arrives at its conflict point.
fn arrival(encounter: &Encounter, role: Role) -> f32 {
    let vehicle = encounter.judged(role);
    let start = vehicle.record.first().map_or(0.0, |sample| sample.s);
    (vehicle.conflict_s - start) / CRUISE.max(first_speed(vehicle))
}

fn first_speed(vehicle: &cede_data::Participant) -> f32 {
    vehicle.record.first().map_or(0.0, |sample| sample.v)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::crossing;
    use cede_data::Rights;

    fn goes_first(left: [f32; 2], other: [f32; 2], first: Option<Role>, rule: Rule) -> Role {
        let mut encounter = crossing(left, other);
        encounter.rights = Rights { first, rule };
        super::first(&encounter)
    }

    #[test]
    fn who_has_the_right_of_way_goes_first_unless_the_other_has_time_enough() {
        // 2.5 s against 3.75 s.
        let (soon, later) = ([20.0, 8.0], [30.0, 8.0]);
        assert_eq!(
            goes_first(soon, later, Some(Role::Other), Rule::LeftTurn),
            Role::Other
        );
        assert_eq!(
            goes_first(soon, later, Some(Role::Other), Rule::AllWayStop),
            Role::Left
        );
        assert_eq!(goes_first(soon, later, None, Rule::Unknown), Role::Left);
        assert_eq!(
            goes_first(later, soon, Some(Role::Other), Rule::Regulation),
            Role::Other
        );
        // 2.5 s against 7.5 s.
        assert_eq!(
            goes_first(soon, [60.0, 8.0], Some(Role::Other), Rule::MinorRoad),
            Role::Left
        );
        // Both at once.
        assert_eq!(
            goes_first(soon, [21.0, 8.0], Some(Role::Other), Rule::AllWayStop),
            Role::Other
        );
    }
}
