//! A short campaign: every family, the broken rules, and the same results on any number of threads.

use cede_attack::campaign::Round;
use cede_attack::mutants;
use cede_attack::scenario::{FAMILIES, Family, SHARE};
use cede_attack::sight::Sensing;
use cede_attack::sight::View;
use cede_attack::tally::Tally;
use cede_controller::dangerous::Sound;

/// Families in which there are more others than the shield has room for: a newcomer without room closes its zones, and
/// voids a plan that passes there.
const FULL: [&str; 2] = ["crowd", "jam"];

/// Nobody touches anybody and nobody is accused, in every family; and a plan that is verified once is never missed.
#[test]
fn the_shield_holds_in_every_family() {
    let mut unplanned = 0;
    for family in FAMILIES {
        let tally = family.campaign::<Sound>(0, SHARE);
        assert!(tally.scenarios > 0 && tally.steps > 0, "{}", family.name);
        assert_eq!(tally.overlaps, 0, "{}: {tally:?}", family.name);
        let false_reports = tally.false_breaches + tally.false_faults + tally.different;
        assert_eq!(false_reports, 0, "{}: {tally:?}", family.name);
        if FULL.contains(&family.name) {
            unplanned += tally.unplanned;
        } else {
            assert_eq!(tally.unplanned, 0, "{}: {tally:?}", family.name);
        }
    }
    println!("{unplanned} steps without a plan in {FULL:?}");
}

/// A shield that is not told where its view ends is met, or loses its plan.
#[test]
fn whoever_comes_out_of_sight_has_to_be_expected() {
    let mut family = *Family::named("occluded").unwrap();
    family.sensing = |_| Sensing {
        view: View::Untold,
        ..Sensing::PLAIN
    };
    let tally = family.campaign::<Sound>(0, 4 * SHARE);
    assert!(tally.overlaps > 0 && tally.unplanned > 0, "{tally:?}");
}

/// A shield with a broken rule is caught by an overlap, each where it is looked for first.
#[test]
fn broken_rules_are_caught() {
    for name in [
        "lane without a gap",
        "always ahead in a lane",
        "stale plan",
        "hazards in the wrong order",
        "plans kept against newcomers",
    ] {
        let mutant = mutants::ALL.iter().find(|mutant| mutant.name == name);
        let caught = mutant.and_then(|mutant| mutant.hunt(0, 512));
        let caught = caught.unwrap_or_else(|| panic!("{name} is not caught"));
        assert!(caught.what.contains("overlap"), "{name}: {caught}");
    }
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let families = ["queue", "all-merge", "surprise"].map(|name| Family::named(name).unwrap());
    let round = |threads: usize| -> Vec<Tally> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let pool = pool.build().unwrap();
        pool.install(|| Round::from(77).next::<Sound>(&families))
    };
    assert_eq!(round(1), round(3));
}
