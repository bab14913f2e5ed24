//! Short searches of three vehicles.

use cede_controller::dangerous::{Rules, Sound};
use cede_precedence_model::broken::Endless;
use cede_precedence_model::{Outcome, Watched, deadlock, search, setting::Setting, suite};
use std::time::Duration;

fn run<R: Rules + Send + Sync + 'static>(name: &str, model: Watched<3, R>) -> Outcome {
    let outcome = search(model, 0, Duration::from_secs(40));
    println!("{name}: {outcome}");
    outcome
}

#[test]
fn never_both_of_three() {
    for (name, setting) in suite::three(1) {
        let outcome = run(name, Watched::<3, Sound>::new(setting));
        assert!(outcome.is_sound(), "{outcome}\n{:?}", outcome.both);
    }
}

#[test]
fn a_turn_of_three_that_does_not_end_is_found() {
    let (name, setting) = suite::three(0).remove(0);
    assert!(
        run(name, Watched::<3, Endless>::new(setting))
            .both
            .is_some()
    );
}

#[test]
fn which_three_wait_for_ever_is_known() {
    use deadlock::Kind;
    let setting = Setting::<3>::new(10, 0);
    for story in deadlock::stories::<3>(2) {
        if let Some(waits) = deadlock::waits(&setting, &story, 200) {
            let kind = deadlock::kind(&story, waits);
            assert_ne!(kind, Kind::Other, "{story:?} {waits:?}");
        }
    }
}
