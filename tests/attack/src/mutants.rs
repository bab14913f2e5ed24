//! Shields with one broken rule each: an attacker that does not catch them proves nothing.

use crate::scenario::{FAMILIES, Family};
use crate::tally::{Case, Tally};
use cede_controller::dangerous::{Rules, Sound, unchecked};
use cede_controller::shield::actuation::Inherited;
use cede_controller::shield::margin::{self, Departure};
use cede_controller::shield::reach::Reach;
use cede_controller::{Bounds, Contract, Plan, Zone};
use std::fmt;
use std::ops::Range;

/// A broken shield.
#[derive(Clone, Copy, Debug)]
pub struct Mutant {
    /// What is broken.
    pub name: &'static str,
    /// The family in which it is looked for first.
    family: &'static str,
    campaign: fn(&Family, u64, u64) -> Tally,
}

/// How a broken shield was caught.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Caught {
    /// The family of the scenario.
    pub family: &'static str,
    /// Scenarios until then.
    pub scenarios: u64,
    /// Its seed.
    pub seed: u64,
    /// What was wrong.
    pub what: String,
}

impl fmt::Display for Caught {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            family,
            scenarios,
            seed,
            what,
        } = self;
        write!(f, "after {scenarios} scenarios: {family} {seed}: {what}")
    }
}

/// Scenarios between two looks at what came of them.
const CHUNK: u64 = 128;

impl Mutant {
    /// Whether it is caught within `scenarios` scenarios of a family, and how: in a scenario that the sound shield passes.
    #[must_use]
    pub fn hunt(&self, seed: u64, scenarios: u64) -> Option<Caught> {
        let first = Family::named(self.family).into_iter();
        let rest = FAMILIES
            .iter()
            .filter(|family| family.name != self.family && !family.searches);
        let mut played = 0;
        for family in first.chain(rest) {
            for from in (seed..seed + scenarios).step_by(CHUNK as usize) {
                let to = (from + CHUNK).min(seed + scenarios);
                let tally = (self.campaign)(family, from, to - from);
                played += tally.scenarios;
                let case = tally
                    .case
                    .and_then(|case| self.proper(family, case, from..to));
                if let Some(case) = case {
                    return Some(Caught {
                        family: family.name,
                        scenarios: played,
                        seed: case.seed,
                        what: case.what,
                    });
                }
            }
        }
        None
    }

    /// This case, unless the sound shield has it, too; else another one of these scenarios.
    fn proper(&self, family: &Family, case: Case, seeds: Range<u64>) -> Option<Case> {
        let sound = |seed: u64| !family.campaign::<Sound>(seed, 1).is_bad();
        if sound(case.seed) {
            return Some(case);
        }
        let cases = seeds.filter_map(|seed| (self.campaign)(family, seed, 1).case);
        cases.into_iter().find(|case| sound(case.seed))
    }
}

macro_rules! mutants {
    ($($name:literal in $family:literal: $type:ident { $($rule:tt)* })*) => {
        $(
            #[derive(Clone, Copy, Debug)]
            struct $type;
            impl Rules for $type { $($rule)* }
        )*
        /// All of them. A static, so that they are compiled once, with this crate.
        pub static ALL: &[Mutant] = &[$(Mutant {
            name: $name,
            family: $family,
            campaign: |family, from, count| family.campaign::<$type>(from, count),
        }),*];
    };
}

mutants! {
    "margin of the wrong sign" in "crossroads": MarginSign {
        fn stops_short(contract: &Contract, limit: f32, rest: f32) -> f32 {
            -margin::stops_short(contract, limit, rest)
        }
    }
    "no slack for stopping" in "lane": StopsTooFar {
        fn stops_short(contract: &Contract, limit: f32, rest: f32) -> f32 {
            margin::stops_short(contract, limit, rest) + 0.3
        }
    }
    "zone ends where it begins" in "crossroads": ZoneEnd {
        fn cleared_at(zone: &Zone) -> f32 {
            zone.ego.from
        }
    }
    "others do not accelerate" in "crossroads": Coasting {
        fn rush(_: &Contract, speed: f32, time: f32) -> Reach<f32> {
            Reach { distance: speed * time, speed }
        }
    }
    "others accelerate less" in "search": HalfRush {
        fn rush(contract: &Contract, speed: f32, time: f32) -> Reach<f32> {
            let whole = margin::rush(contract, speed, time);
            Reach { distance: 0.9 * whole.distance, ..whole }
        }
    }
    "others leave when they enter" in "crossroads": LeftTooEarly {
        fn left(zone: &Zone, other: f32) -> bool {
            other >= zone.other.from
        }
    }
    "stale plan" in "blind": StalePlan {
        fn tail(plan: Plan) -> Plan {
            plan
        }
    }
    "no latency" in "crossroads": NoLatency {
        fn departure(contract: &Contract, speed: f32, inherited: &Inherited<f32>, command: f32) -> Departure<f32> {
            let prompt = unchecked(contract.to_builder().latency(0.0));
            margin::departure(&prompt, speed, &Inherited::all(&prompt, inherited.bounds()), command)
        }
    }
    "no lag" in "drivetrain": NoLag {
        fn departure(contract: &Contract, speed: f32, inherited: &Inherited<f32>, command: f32) -> Departure<f32> {
            let prompt = unchecked(contract.to_builder().ego_lag(0.0));
            margin::departure(&prompt, speed, &Inherited::all(&prompt, inherited.bounds()), command)
        }
    }
    "no gain" in "drivetrain": NoGain {
        fn departure(contract: &Contract, speed: f32, inherited: &Inherited<f32>, command: f32) -> Departure<f32> {
            let exact = unchecked(contract.to_builder().ego_gain(0.0).ego_disturbance(0.0));
            margin::departure(&exact, speed, inherited, command)
        }

        fn rest(contract: &Contract, from: Reach<f32>, time: f32) -> f32 {
            let exact = unchecked(contract.to_builder().ego_gain(0.0).ego_disturbance(0.0));
            margin::rest(&exact, from, time)
        }
    }
    "one command in flight" in "drivetrain": OneInFlight {
        fn departure(contract: &Contract, speed: f32, inherited: &Inherited<f32>, command: f32) -> Departure<f32> {
            let newest = inherited.parts(contract).last().map_or([command; 2], |part| part.bounds);
            margin::departure(contract, speed, &Inherited::all(contract, newest), command)
        }
    }
    "stop without the first period" in "crossroads": StopsNow {
        fn departure(contract: &Contract, speed: f32, inherited: &Inherited<f32>, command: f32) -> Departure<f32> {
            Departure {
                braking: Reach::start(speed),
                ..margin::departure(contract, speed, inherited, command)
            }
        }
    }
    "no errors of speed" in "blurred": ExactSpeed {
        fn departure(contract: &Contract, speed: f32, inherited: &Inherited<f32>, command: f32) -> Departure<f32> {
            let exact = unchecked(contract.to_builder().speed_error(0.0));
            margin::departure(&exact, speed, inherited, command)
        }
    }
    "hazards in the wrong order" in "blind": WrongOrder {
        fn sooner(a: f32, b: f32) -> bool {
            a > b
        }
    }
    "lane without a gap" in "merge": NoGap {
        fn safe_gap(_: &Contract, _: f32, _: f32) -> f32 {
            0.0
        }
    }
    "leader that brakes gently" in "lane": GentleLeader {
        fn earliest_rest(contract: &Contract, speed: f32) -> f32 {
            2.0 * margin::earliest_rest(contract, speed)
        }
    }
    "plan that does not stop" in "crossroads": RestsWhereItClears {
        fn rest(_: &Contract, from: Reach<f32>, _: f32) -> f32 {
            from.distance
        }
    }
    "missing tracks stand still" in "gaps": Frozen {
        fn coast(_: &Contract, bounds: Bounds, _: f32) -> Bounds {
            bounds
        }
    }
    "always ahead in a lane" in "lane": AlwaysAhead {
        fn is_ahead(_: &Zone, _: f32) -> bool {
            true
        }
    }
    "plans kept against newcomers" in "surprise": KeepsAll {
        fn keeps(_: f32) -> bool {
            true
        }
    }
    "turns without an end" in "stop-turns": Endless {
        fn ends(_: u16, _: u16, _: u16, _: u16) -> bool {
            false
        }
    }
    "turns without a grace" in "humans": NoGrace {
        fn grace(_: &Contract) -> u16 {
            0
        }
    }
}
