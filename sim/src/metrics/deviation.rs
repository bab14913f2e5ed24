//! How far an episode strays from its record.

use crate::episode::Episode;
use cede_data::encounter::{Encounter, Role};

/// The root of the mean of `squares`; `None` without any.
pub(super) fn root_mean(squares: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, n) = squares.fold((0.0, 0_u32), |(sum, n), x| (sum + x, n + 1));
    (n > 0).then(|| (sum / f64::from(n)).sqrt())
}

/// Position errors (m) along the route of the vehicles in `tested` after `step` steps, squared.
fn squared_errors<'a>(
    encounter: &'a Encounter,
    episode: &'a Episode,
    tested: &'a [Role],
    step: u32,
) -> impl Iterator<Item = f64> + 'a {
    tested.iter().filter_map(move |&role| {
        let driven = episode.states.get(step as usize)?[role as usize];
        let recorded = encounter.judged(role).recorded(step)?;
        Some(f64::from(driven.s - recorded.s).powi(2))
    })
}

/// Root mean square position error (m) of the vehicles in `tested` after `step` steps.
pub(super) fn position_at(
    encounter: &Encounter,
    episode: &Episode,
    tested: &[Role],
    step: u32,
) -> Option<f64> {
    root_mean(squared_errors(encounter, episode, tested, step))
}

/// Root mean square position error (m) of the vehicles in `tested` over all steps but the initial state.
pub(super) fn position(encounter: &Encounter, episode: &Episode, tested: &[Role]) -> f64 {
    let steps = 1..=episode.steps();
    root_mean(steps.flat_map(|step| squared_errors(encounter, episode, tested, step)))
        .unwrap_or(0.0)
}
