//! A shielded vehicle among replayed humans gets through, and soon after they have.

use cede_controller::kinematics::{State, advance};
use cede_controller::{Cause, Contract, Fault, Observation, RouteConflict, Shield, Track};
use cede_data::{Dataset, Encounter};
use cede_sim::Meeting;
use cede_sim::meeting::{instant, path, sensed};
use rayon::prelude::*;

/// Where the ego would like to be in terms of speed, in m/s.
const CRUISE: f32 = 8.0;

/// Steps from the moment at which the other is out of every zone, or gone, until the ego has passed the
/// zones in which it met it; `None` if it begins without a safe plan, for then nothing is promised.
fn delay(encounter: &Encounter, ego: usize) -> Option<u32> {
    let (me, them) = (
        &encounter.participants[ego],
        &encounter.participants[1 - ego],
    );
    let meeting = Meeting::new(encounter).unwrap();
    let conflict = meeting.conflict(ego).into_iter();
    let zones: Vec<_> = conflict.flat_map(RouteConflict::zones).collect();
    let mut shield =
        Shield::<1>::enter(Contract::WORST_CASE, &meeting.junction, path(ego)).unwrap();
    let mut state = me.record.first().map(|r| State { s: r.s, v: r.v })?;
    let (rival, mut free) = (1, 0);
    for step in 0..10_000 {
        let other = them.recorded(step).map(|r| State { s: r.s, v: r.v });
        let track = other.map(|o| Track::on(rival, path(1 - ego), sensed(&them.route, o)));
        if track.is_none() {
            // Its record has ended: it is gone.
            shield.forget(rival);
        }
        let seen = Observation {
            ego: sensed(&me.route, state),
            tracks: track.as_slice(),
        };
        // Into a lane the ego need only enter: it may have to follow the other for ever.
        let passed =
            |z: &&cede_controller::Zone| state.s >= if z.is_lane() { z.ego.from } else { z.ego.to };
        if zones.iter().all(passed) {
            return Some(free);
        }
        let gone = |z: &&cede_controller::Zone| other.is_none_or(|o| o.s >= z.other.to);
        free += u32::from(zones.iter().all(gone));
        let decision = shield.filter(instant(step), &seen, (CRUISE - state.v).clamp(-3.0, 3.0));
        if step == 0 && decision.cause == Cause::Fallback(Fault::NoPlan) {
            return None;
        }
        state = advance(state, decision.acceleration);
    }
    panic!("{:?}: vehicle {ego} never gets through", encounter.id);
}

/// Needs the INTERACTION recordings, whose licence keeps them out of the repository.
#[test]
fn nobody_waits_longer_than_it_takes_to_drive_off_once_the_human_has_gone() {
    let Some(dir) = cede_tests::interaction() else {
        return;
    };
    let data = Dataset::load(&dir, "EP0").unwrap();
    let delays: Vec<Option<u32>> = data
        .encounters
        .par_iter()
        .flat_map_iter(|encounter| [0, 1].map(|ego| delay(encounter, ego)))
        .collect();
    let promised: Vec<u32> = delays.iter().copied().flatten().collect();
    let longest = promised.iter().max().copied().unwrap_or(0);
    println!(
        "{} of {} begin with a safe plan; longest delay {longest} steps",
        promised.len(),
        delays.len()
    );
    assert_eq!(promised.len(), delays.len());
    assert!(longest <= 80, "{longest} steps");
}
