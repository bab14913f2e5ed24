//! How near the monitored conditions are to their limits.

use super::*;
use crate::headroom::Condition;
use std::vec::Vec;

/// Sensors that err.
fn contract() -> Contract {
    let contract = WORST.to_builder().position_error(0.2).speed_error(0.3);
    contract.build().unwrap()
}

/// What happens in one period.
#[derive(Clone, Copy, Debug)]
struct Period {
    /// What is proposed, m/s².
    proposal: f32,
    /// The share of the latency after which the command takes effect.
    late: f32,
    /// The other's acceleration, m/s².
    other: f32,
    /// Errors in units of the contract's: the ego's place and speed, and the other's.
    errors: [State; 2],
}

fn periods() -> impl Strategy<Value = Vec<Period>> {
    let error = || (-1.0_f32..=1.0, -1.0_f32..=1.0);
    let period = (
        -3.0_f32..3.0,
        0.0_f32..=1.0,
        -8.0_f32..3.0,
        error(),
        error(),
    );
    let period = period.prop_map(|(proposal, late, other, (a, b), (c, d))| Period {
        proposal,
        late,
        other,
        errors: [[a, b], [c, d]],
    });
    prop::collection::vec(period, 2..25)
}

/// Goes on for `time` at `acceleration`, forwards, up to 15 m/s.
pub(super) fn go([s, v]: [f64; 2], acceleration: f64, time: f64) -> [f64; 2] {
    let (mut s, mut v) = (s, v);
    let steps = 200;
    for _ in 0..steps {
        let next = (v + acceleration * time / f64::from(steps)).clamp(0.0, 15.0);
        s += 0.5 * (v + next) * time / f64::from(steps);
        v = next;
    }
    [s, v]
}

/// The decisions of a drive within the contract, to the last observation of which `outside` is added: to the ego's place and
/// speed, and the other's.
fn drive(start: [[f64; 2]; 2], periods: &[Period], outside: [State; 2]) -> Vec<Decision> {
    let (site, contract) = (crossing(), contract());
    let mut run = Run::new(&site, contract);
    let [mut own, mut other] = start;
    let mut before = 0.0;
    let mut decisions = Vec::new();
    for (i, period) in periods.iter().enumerate() {
        let last = i + 1 == periods.len();
        let sensed = |[s, v]: [f64; 2], [e, f]: State, [x, y]: State| {
            let (x, y) = if last { (x, y) } else { (0.0, 0.0) };
            [s as f32 + 0.2 * e + x, v as f32 + 0.3 * f + y]
        };
        let own_seen = sensed(own, period.errors[0], outside[0]);
        let other_seen = sensed(other, period.errors[1], outside[1]);
        // Like this the poses fit; nothing but the numbers is outside.
        let decision = run.decide(own_seen, &[(1, other_seen)], period.proposal);
        let command = f64::from(decision.acceleration);
        let late = f64::from(period.late) * 0.1;
        own = go(go(own, before, late), command, 0.1 - late);
        other = go(other, f64::from(period.other), 0.1);
        before = command;
        decisions.push(decision);
    }
    decisions
}

/// Whether a place or a speed is outside of what the contract allows.
fn motion_is_outside(headroom: &Headroom) -> bool {
    let motion = [
        headroom.ego_position,
        headroom.ego_speed,
        headroom.other_position,
        headroom.other_speed,
    ];
    motion.iter().flatten().any(|room| room.left < 0.0)
}

fn starts() -> impl Strategy<Value = [[f64; 2]; 2]> {
    (2.0_f64..20.0, 0.0_f64..12.0, 2.0_f64..20.0, 0.0_f64..15.0)
        .prop_map(|(a, b, c, d)| [[a, b], [c, d]])
}

proptest! {
    #[test]
    fn within_the_contract_nothing_is_broken(start in starts(), periods in periods()) {
        for decision in drive(start, &periods, [[0.0; 2]; 2]) {
            let headroom = decision.headroom;
            prop_assert_eq!(decision.breach, None);
            prop_assert_eq!(decision.fault, None);
            for (condition, room) in headroom.conditions() {
                prop_assert!(room.is_none_or(|room| room.left >= 0.0), "{:?}: {}", condition, headroom);
                prop_assert!(room.is_none_or(|room| (0.0..=1.0001).contains(&room.share)), "{:?}: {}", condition, headroom);
            }
        }
    }

    #[test]
    fn a_breach_is_less_than_nothing_left(
        start in starts(),
        periods in periods(),
        outside in prop::array::uniform2(prop::array::uniform2(-1.0_f32..1.0)),
        scale in 0.0_f32..2.0,
    ) {
        let outside = outside.map(|it| it.map(|value| value * scale));
        for decision in drive(start, &periods, outside) {
            prop_assert_eq!(decision.breach.is_some(), motion_is_outside(&decision.headroom), "{}", decision.headroom);
        }
    }
}

#[test]
fn what_is_far_outside_is_broken_and_named() {
    let calm = Period {
        proposal: 0.0,
        late: 1.0,
        other: 0.0,
        errors: [[0.0; 2]; 2],
    };
    let start = [[5.0, 5.0], [5.0, 5.0]];
    let last = |outside| drive(start, &[calm; 4], outside).pop().unwrap();
    let broken = |decision: &Decision| {
        let least = decision.headroom.least();
        least
            .filter(|(_, room)| room.left < 0.0)
            .map(|(condition, room)| (condition, room.track))
    };
    let inside = last([[0.0; 2]; 2]);
    assert_eq!((inside.breach, broken(&inside)), (None, None));
    let faster = last([[0.0; 2], [0.0, 1.5]]);
    assert_eq!(faster.breach, Some(Breach::Other(1)));
    assert_eq!(broken(&faster), Some((Condition::OtherSpeed, Some(1))));
    let slid = last([[1.5, 0.0], [0.0; 2]]);
    assert_eq!(slid.breach, Some(Breach::Ego));
    assert_eq!(broken(&slid), Some((Condition::EgoPosition, None)));
}

#[test]
fn a_pose_beside_its_path_and_a_late_call_are_named() {
    let site = crossing();
    let mut run = Run::new(&site, WORST);
    let state = [20.0, 0.0];
    let first = run.decide(state, &[(1, state)], 0.0);
    assert_eq!(first.headroom.period, None);
    let mut beside = track(&site, 1, state);
    beside.pose.position.x += 5.0;
    let own = ego(&site, state);
    let decision = run.observe(own, &[beside], 0.0);
    let offset = decision.headroom.offset.unwrap();
    assert!(offset.left < -4.9 && offset.track == Some(1));
    assert!(decision.headroom.period.unwrap().left >= 0.0);
    run.millis += 30;
    let late = run.observe(own, &[], 0.0);
    let period = late.headroom.period.unwrap();
    assert!((period.left + 0.03).abs() < 1e-5, "{period:?}");
    assert!(matches!(late.fault, Some(Fault::OffPeriod { .. })));
}

#[test]
fn headroom_is_one_line() {
    let calm = Period {
        proposal: 0.0,
        late: 0.0,
        other: 0.0,
        errors: [[0.0; 2]; 2],
    };
    let decisions = drive([[5.0, 5.0], [5.0, 5.0]], &[calm; 2], [[0.0; 2]; 2]);
    assert_eq!(
        decisions[1].headroom.to_string(),
        "ego position 0.410 m (100 %), ego speed 0.610 m/s (100 %), other 1 position 0.455 m (97 %), \
         other 1 speed 0.910 m/s (78 %), other 1 offset 0.220 m (100 %), other 1 heading 0.500 (100 %), \
         period 0.000 s (100 %)"
    );
}
