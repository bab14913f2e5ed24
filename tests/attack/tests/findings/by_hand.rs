//! Findings that are single moments.

use crate::stage::{car_way, crossing, sensed, site};
use cede_attack::motion::State;
use cede_attack::numbers::Numbers;
use cede_attack::site::Site;
use cede_controller::{Cause, Contract, Fault, Instant, Observation, PathId, Shield, Track};

fn shield(site: &Site, contract: Contract) -> Shield<'_> {
    Shield::enter(contract, &*site.junctions[0], PathId::new(0)).unwrap()
}

/// Another is about to be where the ego is, and the proposal is not a number: what matters is that there is no plan.
#[test]
fn e13_a_proposal_that_is_not_a_number_hides_no_missing_plan() {
    let site = crossing(None);
    let [from, _] = site.areas(0, 1)[0].ego;
    let other = sensed(&site, 1, site.areas(0, 1)[0].other[0] - 5.0, 12.0);
    let tracks = [Track::on(1, PathId::new(1), other)];
    let observation = Observation {
        ego: sensed(&site, 0, from - 3.0, 10.0),
        tracks: &tracks,
    };
    for proposal in [f32::NAN, f32::INFINITY, 0.0] {
        let mut shield = shield(&site, Contract::WORST_CASE);
        let decision = shield.filter(Instant::from_millis(0), &observation, proposal);
        assert_eq!(decision.plan, None);
        assert_eq!(decision.cause, Cause::Fallback(Fault::NoPlan));
    }
}

/// The ego stands a little in a zone, without a plan, and another stands ahead of it in plain sight.
#[test]
fn e14_the_way_out_leads_into_nobody() {
    let east = car_way(&[[-90.0, 0.0], [90.0, 0.0]]);
    let north = car_way(&[[0.0, -90.0], [0.0, 90.0]]);
    let site = site(&[east, north], None);
    let area = site.areas(0, 1)[0];
    for gap in [4.6, 2.0, 1.0] {
        let mut shield = shield(&site, Contract::WORST_CASE);
        let ahead = area.ego[0] + 0.7 + 5.0 + gap;
        let mut ego = State {
            s: area.ego[0] + 0.7,
            v: 0.0,
        };
        let mut unplanned = 0;
        for period in 0..20 {
            let comes = sensed(&site, 1, area.other[0] - 14.0 + 0.4 * period as f64, 4.0);
            let stands = sensed(&site, 0, ahead, 0.0);
            let tracks = [
                Track::on(1, PathId::new(1), comes),
                Track::on(2, PathId::new(0), stands),
            ];
            let observation = Observation {
                ego: sensed(&site, 0, ego.s, ego.v),
                tracks: &tracks,
            };
            let decision = shield.filter(Instant::from_millis(100 * period), &observation, 3.0);
            unplanned += u32::from(decision.plan.is_none());
            ego = ego.after(decision.acceleration.into(), 0.1, 15.0);
            assert!(
                ego.s + 5.0 < ahead,
                "it hits the one ahead at {} m/s",
                ego.v
            );
        }
        assert!(unplanned > 0, "vacuous: there was a plan");
    }
}

/// The ego merges by precedence; the other does not give way, and the ego comes to rest centimetres past the entry of
/// their lane.
#[test]
fn e16_an_ego_past_the_entry_still_sees_who_comes_from_behind() {
    let main = car_way(&[[-110.0, 0.0], [110.0, 0.0]]);
    let ramp = car_way(&[
        [-86.6, -50.0],
        [-8.66, -5.0],
        [-4.0, -2.5],
        [0.0, -0.9],
        [4.0, -0.2],
        [8.0, 0.0],
        [110.0, 0.0],
    ]);
    let site = site(&[ramp, main], Some(vec![0, 1]));
    let area = *site.areas(0, 1).iter().find(|area| area.lane).unwrap();
    let numbers = Numbers::of(&Contract::ALL_WAY_STOP);
    let mut near = 0;
    for start in 0..40 {
        for away in 0..50 {
            near += u32::from(merges(
                &site,
                area.ego[0],
                f64::from(start) * 0.2,
                f64::from(away),
                &numbers,
            ));
        }
    }
    assert!(near > 20, "vacuous: {near}");
}

/// One drive; whether the ego came to stand, or nearly so, just past the entry while the other was too near behind it.
fn merges(site: &Site, entry: f64, start: f64, away: f64, numbers: &Numbers) -> bool {
    let area = *site.areas(0, 1).iter().find(|area| area.lane).unwrap();
    let mut shield = shield(site, Contract::ALL_WAY_STOP);
    let mut ego = State {
        s: site.line(0) - 13.0 - start,
        v: 4.0,
    };
    let mut other = State {
        s: site.line(1) - 20.0 - away,
        v: 13.0,
    };
    let mut near = false;
    for period in 0..60 {
        let tracks = [Track::on(
            3,
            PathId::new(1),
            sensed(site, 1, other.s, other.v),
        )];
        let observation = Observation {
            ego: sensed(site, 0, ego.s, ego.v),
            tracks: &tracks,
        };
        let decision = shield.filter(Instant::from_millis(100 * period), &observation, 3.0);
        let gap = ego.s - other.s - area.lead[1];
        let past = (0.0..1.0).contains(&(ego.s - entry));
        if past
            && gap < numbers.safe_gap(other.v, ego.v) - 1.0
            && other.s < area.other[0] + 5.0
            && gap > -3.0
        {
            near |= ego.v < 2.0;
            let carefree = decision.cause == Cause::Policy && decision.margin > 1e4;
            assert!(
                !carefree,
                "{gap} m ahead of one at {} m/s: {decision:?}",
                other.v
            );
        }
        ego = ego.after(decision.acceleration.into(), 0.1, 15.0);
        other = other.after(0.0, 0.1, 15.0);
        if other.s > 200.0 || ego.s > 190.0 {
            break;
        }
    }
    near
}
