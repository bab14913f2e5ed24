//! The junctions of recorded encounters: they are those of the records, and nobody drives out of them.

use cede_controller::junction::zone::{MAX_ZONES, Span};
use cede_controller::policy::embedded;
use cede_controller::{Cause, Contract, Fault, Footprint, Policy};
use cede_data::{Dataset, Encounter, Role};
use cede_sim::Meeting;
use cede_sim::driver::{Baseline, Cede, DriverFactory, Replay, Shielded};
use cede_sim::episode::Until;
use cede_sim::evaluate::{Mode, Protocol, evaluate};
use cede_sim::meeting::{conflict, crossroads};

/// Needs the INTERACTION recordings, whose licence keeps them out of the repository.
fn recordings() -> Option<Dataset> {
    let dir = cede_tests::interaction()?;
    Some(Dataset::load(&dir, "EP0").unwrap())
}

#[test]
fn roads_past_the_records_change_nothing_on_them() {
    let Some(data) = recordings() else { return };
    for encounter in &data.encounters {
        let routes = Role::BOTH.map(|role| (&encounter.judged(role).route, Footprint::PAPER));
        let recorded = crossroads(routes).unwrap();
        let meeting = Meeting::new(encounter).unwrap();
        for index in 0..2 {
            let (short, long) = (conflict(&recorded, index), meeting.conflict(index));
            let (short, long) = (short.unwrap(), long.unwrap());
            assert_eq!(short.kind, long.kind, "{:?}", encounter.id);
            let points = [short, long].map(|c| [c.ego_conflict, c.other_conflict]);
            for (a, b) in points[0].into_iter().zip(points[1]) {
                assert!((a - b).abs() < 1e-3, "{:?}: {points:?}", encounter.id);
            }
            for zone in short.zones() {
                let same = |z: &&cede_controller::Zone| {
                    (z.ego.from - zone.ego.from).abs() < 1e-2
                        && (z.other.from - zone.other.from).abs() < 1e-2
                        && z.is_lane() == zone.is_lane()
                };
                // Of more parts than there is room for, those nearest to each other are one zone.
                let part = |z: &&cede_controller::Zone| {
                    let within = |a: Span, b: Span| b.from <= a.from + 1e-2 && a.to <= b.to + 1e-2;
                    within(zone.ego, z.ego) && within(zone.other, z.other) && !z.is_lane()
                };
                let full = long.zones().count() == MAX_ZONES;
                assert!(
                    long.zones().any(|z| same(&z) || (full && part(&z))),
                    "{:?}: {zone:?}",
                    encounter.id
                );
            }
        }
    }
}

#[test]
fn whoever_is_shielded_is_sensed_on_its_path() {
    let Some(data) = recordings() else { return };
    let encounters: Vec<&Encounter> = data.encounters.iter().collect();
    let policy = Policy::new(embedded::words()).unwrap();
    let shielded = |baseline: Baseline| {
        let drivers = baseline.fit(&encounters).unwrap();
        Shielded::new(drivers, Contract::WORST_CASE)
    };
    let mut drivers: Vec<Box<dyn DriverFactory>> =
        vec![Box::new(Cede::new(policy, Contract::WORST_CASE))];
    drivers.extend(Baseline::ALL.map(|b| Box::new(shielded(b)) as Box<dyn DriverFactory>));
    for factory in &drivers {
        for mode in [Mode::Joint, Mode::Ego(&Replay)] {
            let protocol = Protocol {
                mode,
                until: Until::Cleared,
                seed: 0,
            };
            let evaluation = evaluate(&**factory, &encounters, protocol);
            assert!(evaluation.refused.is_empty());
            for drive in evaluation.drives {
                let causes = drive.episode.actions.iter().flatten().map(|a| a.cause);
                let refused = |cause| matches!(cause, Cause::Fallback(Fault::Input(_)));
                assert!(!causes.into_iter().any(refused), "{:?}", drive.encounter.id);
            }
        }
    }
}
