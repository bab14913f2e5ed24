//! Short searches of two vehicles: none of them rely on precedence over each other; with one thing broken they do.

use cede_controller::dangerous::{Rules, Sound};
use cede_precedence_model::broken::{Endless, NoGrace};
use cede_precedence_model::setting::Setting;
use cede_precedence_model::{Outcome, Watched, deadlock, search, suite};
use std::time::Duration;

fn run<R: Rules + Send + Sync + 'static>(name: &str, model: Watched<2, R>) -> Outcome {
    let outcome = search(model, 0, Duration::from_secs(40));
    println!("{name}: {outcome}");
    outcome
}

fn is_sound(name: &str, setting: Setting<2>) {
    let outcome = run(name, Watched::<2, Sound>::new(setting));
    assert!(outcome.is_sound(), "{outcome}\n{:?}", outcome.both);
}

#[test]
fn never_both_in_turns() {
    is_sound("turns", suite::turns(1));
}

#[test]
fn never_both_when_frames_and_calls_are_missed() {
    let longest = 20;
    is_sound(
        "misses",
        Setting {
            longest,
            ..suite::misses(1)
        },
    );
}

#[test]
fn never_both_when_a_shield_starts_late() {
    is_sound("late", suite::late(0).right(1, 0).descending());
    is_sound("late equals", suite::late(0));
}

#[test]
fn never_both_in_spite_of_errors_of_speed() {
    let longest = 12;
    is_sound(
        "noise",
        Setting {
            longest,
            ..suite::noise(0)
        },
    );
}

#[test]
fn never_both_at_the_zone() {
    is_sound("zone", suite::zone(0));
}

#[test]
fn never_both_when_calls_jitter() {
    is_sound("jitter", suite::jitter(0));
}

#[test]
fn never_both_by_arrival() {
    is_sound("arrivals", suite::arrivals(0, 0).right(0, 1));
    is_sound("arrivals of equals", suite::arrivals(0, 0));
}

#[test]
fn never_both_where_the_right_counts_whoever_arrives_first() {
    is_sound("unsigned", suite::turns(1).unsigned());
    is_sound("late", suite::late(0).right(0, 1).unsigned());
    is_sound("late second", suite::late(0).right(1, 0).unsigned());
}

#[test]
fn a_turn_that_begins_when_the_other_ends_is_found() {
    let outcome = run("no grace", Watched::<2, NoGrace>::new(suite::turns(0)));
    assert!(outcome.at_once.is_some());
}

#[test]
fn a_turn_that_does_not_end_is_found() {
    let outcome = run("endless", Watched::<2, Endless>::new(suite::turns(0)));
    assert!(outcome.both.is_some());
}

#[test]
fn errors_of_sensed_places_beyond_the_contract_are_found() {
    let setting = Setting {
        place_error: 3,
        ..suite::arrivals(0, 0).right(0, 1)
    };
    let outcome = run("place error", Watched::<2, Sound>::new(setting));
    assert!(outcome.both.is_some());
}

#[test]
fn a_late_shield_that_takes_everybody_for_one_that_just_moved_is_found() {
    // The first two turns are the late one's, as it counts; the third is the other's, as that one counts.
    let setting = Setting {
        longest: 40,
        ..suite::late(0).right(1, 0).descending()
    };
    let model = Watched::<2, Sound>::new(setting).hasty();
    let outcome = run("hasty", model);
    assert!(outcome.both.is_some());
}

#[test]
fn who_waits_for_ever_is_known() {
    use deadlock::Kind;
    let setting = Setting::<2>::new(10, 0);
    for story in deadlock::stories::<2>(5) {
        if let Some(waits) = deadlock::waits(&setting, &story, 300) {
            let kind = deadlock::kind(&story, waits);
            assert!(matches!(kind, Kind::Late | Kind::NoOrder), "{story:?}");
        }
    }
}
