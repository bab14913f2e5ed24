//! An encounter as numbers: the states of both vehicles, and the shield's interventions.

use crate::report::{Class, called, words};
use cede_controller::kinematics::State;
use cede_data::{Encounter, Role};
use cede_sim::evaluate::{Drive, TableRow};
use cede_sim::metrics::{recorded_states, svo_series};

/// Steps between two rows of the table (0.5 s).
const EVERY: usize = 5;

/// Prints the encounter as it was recorded.
pub(super) fn record(encounter: &Encounter) {
    let left = match called(encounter, Role::Left).as_str() {
        "left-turner" => "Left-turner",
        _ => "Vehicle",
    };
    println!(
        "{left} {}, other {}: {} first after {:.1} s, the next {:.1} s later.\n",
        encounter.id.left,
        encounter.id.other,
        called(encounter, encounter.first),
        f64::from(encounter.steps) * 0.1,
        encounter.pet
    );
    let states: Vec<_> = recorded_states(encounter).collect();
    table(encounter, &states);
}

/// Prints the encounter as it was driven. Of a driver that replays the record it prints only the
/// shield's interventions.
pub(super) fn drive(row: &TableRow, drive: &Drive<'_>) {
    let episode = &drive.episode;
    let name = |role| called(drive.encounter, role);
    let first = episode.first().map_or("nobody".to_owned(), name);
    let overruled = overruled(drive);
    if row.driver != "replay" || !overruled.is_empty() {
        println!(
            "\n{}, shield {}: {first} first; {:?} after {:.1} s.\n",
            row.driver,
            row.shield,
            episode.end,
            f64::from(episode.steps()) * 0.1,
        );
        table(drive.encounter, &episode.states);
    }
    if row.shield == "on" {
        println!("\n{}, where the shield acted:", row.driver);
        if overruled.is_empty() {
            println!("  nowhere");
        }
        for Stretch {
            role,
            from,
            to,
            why,
            ..
        } in overruled
        {
            let (from, to) = (from as f64 * 0.1, (to + 1) as f64 * 0.1);
            println!("  {from:>5.1} to {to:>5.1} s  {:11}  {why}", name(role));
        }
    }
}

/// Consecutive steps in which one vehicle's shield intervenes for reasons of one class.
struct Stretch {
    role: Role,
    class: Class,
    from: usize,
    to: usize,
    /// The reason at its first step.
    why: String,
}

fn overruled(drive: &Drive<'_>) -> Vec<Stretch> {
    let mut stretches: Vec<Stretch> = Vec::new();
    for role in Role::BOTH {
        for (step, actions) in drive.episode.actions.iter().enumerate() {
            let cause = actions[role as usize].cause;
            let Some(class) = Class::of(cause) else {
                continue;
            };
            let goes_on = |s: &&mut Stretch| (s.role, s.class, s.to + 1) == (role, class, step);
            match stretches.last_mut().filter(goes_on) {
                Some(stretch) => stretch.to = step,
                None => stretches.push(Stretch {
                    role,
                    class,
                    from: step,
                    to: step,
                    why: words(drive.encounter, role, cause),
                }),
            }
        }
    }
    stretches.sort_by_key(|stretch| stretch.from);
    stretches
}

fn table(encounter: &Encounter, states: &[[State; 2]]) {
    let [left, other] = Role::BOTH.map(|role| called(encounter, role));
    println!("{left:>23}{other:>17}{:>17}", "SVO of");
    println!("  t, s   to go, m     m/s   to go, m     m/s   {left}, °");
    let mut orientations = svo_series(encounter, states.iter().copied());
    for (step, states) in states.iter().enumerate() {
        let orientation = orientations.next();
        if step % EVERY != 0 {
            continue;
        }
        let [left, other] = Role::BOTH.map(|role| {
            let state = states[role as usize];
            (encounter.judged(role).conflict_s - state.s, state.v)
        });
        let degrees = orientation.map_or(String::new(), |phi| format!("{:.0}", phi.to_degrees()));
        println!(
            "{:>6.1}   {:>8.1}  {:>6.1}   {:>8.1}  {:>6.1}   {degrees:>14}",
            step as f64 * 0.1,
            left.0,
            left.1,
            other.0,
            other.1
        );
    }
}
