//! A cross-entropy search for accelerations of the others that bring them as near to the ego as possible.

use crate::human::Manner;
use crate::outcome::Outcome;
use crate::rng::Rng;
use crate::setup::{Driver, Setup};
use crate::world::play;
use cede_controller::dangerous::Rules;

/// Rounds of the search, trials of a round, and those from which the next round learns.
const ROUNDS: usize = 14;
const TRIALS: usize = 16;
const ELITE: usize = 4;

/// What is learned of one acceleration.
#[derive(Clone, Copy, Debug)]
struct Guess {
    mean: f64,
    spread: f64,
}

/// Plays `setup` with better and better accelerations of those who drive by [`Manner::Profile`], until an overlap or
/// the last round. All steps count.
#[must_use]
pub fn search<R: Rules + Clone>(setup: &Setup<'_>, trace: bool) -> Outcome {
    let mut rng = Rng::new(setup.seed ^ 0x5EA2);
    let slots = setup.cars.iter().map(|car| profile(car).len()).sum();
    let other = setup.contract.other();
    let (low, high) = (-f64::from(other.braking), f64::from(other.acceleration));
    let guess = Guess {
        mean: 0.5 * high,
        spread: high - low,
    };
    let mut guesses: Vec<Guess> = vec![guess; slots];
    let mut total = Outcome::default();
    let mut best = f64::INFINITY;
    for round in 0..ROUNDS {
        let mut trials: Vec<(f64, Vec<f64>)> = Vec::with_capacity(TRIALS);
        for _ in 0..TRIALS {
            let drawn = guesses
                .iter()
                .map(|guess| guess.mean + guess.spread * rng.normal());
            let drawn: Vec<f64> = drawn.map(|a| a.clamp(low, high)).collect();
            let outcome = play::<R>(&with(setup, &drawn), false);
            let bad = outcome.verified && outcome.is_bad();
            if bad && trace {
                let _ = play::<R>(&with(setup, &drawn), true);
            }
            trials.push((outcome.closest, drawn));
            let steps = total.steps;
            total = outcome;
            total.steps += steps;
            best = best.min(total.closest);
            total.closest = best;
            if bad || !total.verified {
                return total;
            }
        }
        trials.sort_by(|a, b| a.0.total_cmp(&b.0));
        learn(&mut guesses, &trials[..ELITE]);
        if trace {
            println!("round {round}: {:.3} m", trials[0].0);
        }
    }
    total
}

fn learn(guesses: &mut [Guess], elite: &[(f64, Vec<f64>)]) {
    let count = elite.len() as f64;
    for (slot, guess) in guesses.iter_mut().enumerate() {
        let values = || elite.iter().map(|(_, drawn)| drawn[slot]);
        let mean = values().sum::<f64>() / count;
        let variance = values().map(|a| (a - mean) * (a - mean)).sum::<f64>() / count;
        guess.mean = 0.3 * guess.mean + 0.7 * mean;
        guess.spread = 0.3 * guess.spread + 0.7 * variance.sqrt() + 0.05;
    }
}

fn profile(car: &crate::setup::Car) -> &[f64] {
    match &car.driver {
        Driver::Human(Manner::Profile(profile)) => profile,
        _ => &[],
    }
}

/// The set-up with these accelerations.
fn with<'s>(setup: &Setup<'s>, drawn: &[f64]) -> Setup<'s> {
    let mut next = drawn.iter().copied();
    let mut setup = setup.clone();
    for car in &mut setup.cars {
        if let Driver::Human(Manner::Profile(profile)) = &mut car.driver {
            profile.iter_mut().zip(&mut next).for_each(|(a, b)| *a = b);
        }
    }
    setup
}
