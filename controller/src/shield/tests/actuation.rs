//! Bounds on the ego against a drivetrain that is simulated: late, with a lag, not exact.

use super::*;
use crate::shield::actuation::{Commands, anything};

/// Seconds from one state of the drivetrain to the next.
const STEP: f64 = 0.001;

/// How the drivetrain uses what the contract allows.
#[derive(Clone, Copy, Debug)]
struct Drivetrain {
    /// The share of the latency that a command takes, for two kinds of command in turn.
    late: [f64; 2],
    /// The share of the largest time constant.
    lag: f64,
    /// The share of the largest departure from a command, for two kinds of command in turn.
    off: [f64; 2],
}

fn drivetrains() -> impl Strategy<Value = Drivetrain> {
    let share = || prop_oneof![Just(0.0), Just(1.0), 0.0..=1.0];
    let sign = || prop_oneof![Just(-1.0), Just(1.0), -1.0..=1.0];
    ([share(), share()], share(), [sign(), sign()]).prop_map(|(late, lag, off)| Drivetrain {
        late,
        lag,
        off,
    })
}

/// Contracts whose ego may be held back up to `spare` (m/s) below its limit, or not that much.
fn contracts(spare: core::ops::Range<f32>) -> impl Strategy<Value = Contract> {
    let jitter = prop_oneof![Just(0.0_f32), 0.0..0.0125_f32];
    let inexact = prop_oneof![Just((0.0_f32, 0.0_f32)), (0.0..0.2_f32, 0.0..0.4_f32)];
    let late = prop_oneof![Just(0.0_f32), 0.0..0.5_f32];
    let lag = prop_oneof![Just(0.0_f32), 0.0..0.4_f32];
    (jitter, late, lag, inexact, spare).prop_map(
        |(jitter, latency, lag, (gain, disturbance), spare)| {
            let builder = Contract::builder()
                .jitter(jitter)
                .latency(latency)
                .speed_error(0.1)
                .ego_acceleration(2.0)
                .ego_go(1.5)
                .ego_emergency(6.0)
                .ego_lag(lag)
                .ego_gain(gain)
                .ego_disturbance(disturbance)
                .other_max_speed(100.0);
            // The message names the least limit.
            let [least, _] = builder.ego_max_speed(0.0).build().unwrap_err().range();
            builder.ego_max_speed(least + spare).build().unwrap()
        },
    )
}

/// The ego, its commands, and what the shield remembers of them.
struct Plant {
    contract: Contract,
    drivetrain: Drivetrain,
    commands: Commands,
    /// When each command takes effect, and to what acceleration it leads.
    effects: std::vec::Vec<(f64, f64)>,
    time: f64,
    s: f64,
    v: f64,
    a: f64,
}

impl Plant {
    fn new(contract: Contract, drivetrain: Drivetrain, v: f64, a: f64) -> Self {
        Self {
            contract,
            drivetrain,
            commands: Commands::unknown(),
            effects: std::vec![(0.0, a)],
            time: 100.0,
            s: 0.0,
            v,
            a,
        }
    }

    fn now(&self) -> Instant {
        Instant::from_micros((self.time * 1e6).round() as u64)
    }

    /// Sensed with an error.
    fn speed(&self) -> f32 {
        let error = f64::from(self.contract.speed_error) * self.drivetrain.off[0];
        (self.v + error).max(0.0) as f32
    }

    fn most(&self) -> f32 {
        let [_, in_effect] = self.commands.inherited(&self.contract, self.now()).bounds();
        most(&self.contract, self.speed(), in_effect)
    }

    fn command(&mut self, command: f32) {
        let command = allowed(&self.contract.ego, self.most(), command);
        self.commands.give(&self.contract, command, self.now());
        let kind = self.effects.len() % 2;
        let late = self.drivetrain.late[kind] * f64::from(self.contract.latency);
        let before = self.effects.last().map_or(0.0, |(at, _)| *at);
        let ego = self.contract.ego;
        let off = f64::from(ego.gain * command.abs() + ego.disturbance);
        let leads_to = f64::from(command) + self.drivetrain.off[kind] * off;
        self.effects.push((before.max(self.time + late), leads_to));
    }

    /// Runs until `time`; `look` sees the state after every step.
    fn run(&mut self, time: f64, mut look: impl FnMut(&Self)) {
        let lag = self.drivetrain.lag * f64::from(self.contract.ego.lag);
        while self.time < time {
            let later = self.effects.iter().map(|(at, _)| at - self.time);
            let change = later.filter(|wait| *wait > 1e-9).fold(STEP, f64::min);
            let step = change.min(time - self.time);
            let in_effect = self.effects.iter().rev();
            let mut in_effect = in_effect.skip_while(|(at, _)| *at > self.time + 1e-9);
            let target = in_effect.next().map_or(0.0, |(_, a)| *a);
            let before = self.a;
            self.a = if lag > 0.0 {
                target + (self.a - target) * (-step / lag).exp()
            } else {
                target
            };
            let a = if lag > 0.0 {
                0.5 * (before + self.a)
            } else {
                target
            };
            let next = (self.v + a * step).max(0.0);
            self.s += 0.5 * (self.v + next) * step;
            self.v = next;
            self.time += step;
            look(self);
        }
    }
}

/// Commands of the past, in m/s².
fn history() -> impl Strategy<Value = std::vec::Vec<f32>> {
    let command = prop_oneof![
        Just(-6.0_f32),
        Just(-3.0),
        Just(0.0),
        Just(2.0),
        -6.0..2.0_f32
    ];
    proptest::collection::vec(command, 0..12)
}

/// One more period, off by a jitter.
fn next(contract: &Contract, calls: usize, drivetrain: &Drivetrain) -> f64 {
    let off = f64::from(contract.jitter) * drivetrain.off[calls % 2];
    100.0 + calls as f64 * f64::from(contract.period) + off
}

/// A plan of a test: `first` (m/s²) for a period, then `go` until a target is cleared if there is one, then braking.
#[derive(Clone, Debug)]
struct Case {
    v: f64,
    a: f64,
    history: std::vec::Vec<f32>,
    first: f32,
    target: Option<f32>,
}

fn cases(fastest: f64) -> impl Strategy<Value = Case> {
    let target = proptest::option::weighted(0.7, 0.0_f32..60.0);
    let case = (
        0.0..fastest,
        -6.0..2.0_f64,
        history(),
        -3.0_f32..2.0,
        target,
    );
    case.prop_map(|(v, a, history, first, target)| Case {
        v,
        a,
        history,
        first,
        target,
    })
}

/// Carries a plan out.
fn carry_out(contract: Contract, drivetrain: Drivetrain, case: Case) -> Result<(), TestCaseError> {
    let mut plant = Plant::new(contract, drivetrain, case.v, case.a);
    let mut calls = 0;
    plant.time = next(&contract, calls, &drivetrain);
    plant.effects[0].0 = plant.time - 1.0;
    // Nothing is known of the acceleration at the beginning.
    let [_, most] = anything(&contract);
    let mut limit = f64::from(contract.ego.max_speed);
    limit = limit.max(case.v + f64::from(most * contract.response()));
    for command in case.history {
        plant.command(command);
        calls += 1;
        plant.run(next(&contract, calls, &drivetrain), |_| {});
    }
    let (from, start) = (plant.s, plant.time);
    let inherited = plant.commands.inherited(&contract, plant.now());
    if contract.ego.lag > 0.0 {
        let [low, high] = inherited.bounds();
        let known = f64::from(low) - 1e-4..=f64::from(high) + 1e-4;
        prop_assert!(known.contains(&plant.a), "{} m/s² in {known:?}", plant.a);
    }
    let first = allowed(&contract.ego, plant.most(), case.first);
    let departure = margin::departure(&contract, plant.speed(), &inherited, first);
    let target = case.target.unwrap_or(0.0);
    let (clears, speed) = margin::clearing(&contract, departure.least, target);
    if clears > 55.0 {
        // Not planned.
        return Ok(());
    }
    let mut plan = Plan {
        go: case
            .target
            .map_or(0, |_| margin::periods(&contract, clears)),
    };
    let rest = if plan.go > 0 {
        let time = f32::from(plan.go) * contract.period;
        margin::rest(&contract, departure.most, time)
    } else {
        departure.braking.rest(margin::braking(&contract))
    };
    plant.command(first);
    let mut cleared = None;
    let (mut farthest, mut fastest) = (0.0_f64, 0.0_f64);
    for _ in 0..1200 {
        calls += 1;
        plant.run(next(&contract, calls, &drivetrain), |plant| {
            farthest = farthest.max(plant.s - from);
            fastest = fastest.max(plant.v);
            if cleared.is_none() && plant.time >= start + f64::from(clears) {
                cleared = Some((plant.s - from, plant.v));
            }
        });
        if plan.go == 0 && plant.v == 0.0 && plant.a <= 0.0 {
            break;
        }
        plant.command(super::super::choice::next(&contract, plan));
        plan = plan.tail();
    }
    prop_assert!(
        farthest <= f64::from(rest) + 0.01,
        "{farthest} m, planned {rest} m"
    );
    prop_assert!(
        fastest <= limit + 0.002,
        "{fastest} m/s, at most {limit} m/s"
    );
    if let (Some((s, v)), Some(_)) = (cleared, case.target) {
        prop_assert!(
            s >= f64::from(target) - 0.01,
            "{s} m of {target} m after {clears} s"
        );
        prop_assert!(v >= f64::from(speed) - 0.02, "{v} m/s, planned {speed} m/s");
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn a_plan_holds_whatever_the_drivetrain_does(
        contract in contracts(20.0..40.0), drivetrain in drivetrains(), case in cases(12.0),
    ) {
        carry_out(contract, drivetrain, case)?;
    }

    #[test]
    fn it_does_near_the_limit_of_the_speed_too(
        contract in contracts(0.0..4.0), drivetrain in drivetrains(), case in cases(12.0),
    ) {
        carry_out(contract, drivetrain, case)?;
    }
}

/// From rest, with the brakes on: the first command, harder than `go`, is followed late, and the `go` after it at once.
#[test]
fn one_that_stands_is_no_farther_after_a_first_command_harder_than_go() {
    let contract = Contract::builder()
        .latency(0.03)
        .ego_acceleration(2.2)
        .ego_go(0.07)
        .ego_braking(8.0)
        .ego_emergency(8.0)
        .ego_lag(0.04)
        .build()
        .unwrap();
    let drivetrain = Drivetrain {
        late: [1.0, 0.0],
        lag: 1.0,
        off: [0.0; 2],
    };
    for target in [0.3, 1.0, 3.0, 10.0] {
        let case = Case {
            v: 0.0,
            a: -8.0,
            history: std::vec![-8.0; 3],
            first: 2.2,
            target: Some(target),
        };
        carry_out(contract, drivetrain, case).unwrap();
    }
}
