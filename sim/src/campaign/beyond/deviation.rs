//! By how much the world is not what the contract says.

use cede_controller::Contract;

/// What differs from the contract, the rest is within it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// The others accelerate harder by this factor.
    pub acceleration: f32,
    /// A command takes effect later by this factor.
    pub latency: f32,
    /// The ego brakes by this factor of what it is commanded.
    pub braking: f32,
    /// The ego's acceleration follows with a time constant that is larger by this factor,
    pub slower: f32,
    /// and by this many seconds.
    pub lag: f32,
    /// The ego's acceleration differs from the command in effect by so many times what the contract allows for.
    pub gain: f32,
    /// What nobody commands is larger by this factor.
    pub disturbance: f32,
    /// Places and speeds err by so many times what the contract allows for,
    pub errors: f32,
    /// and by this much more, in m and m/s.
    pub error: f32,
    /// Probability that a track is missing in an observation.
    pub dropout: f64,
    /// Seconds for which the observation stays what it was, once in an encounter.
    pub frozen: f32,
    /// Share of the period by which a call is early or late.
    pub jitter: f32,
    /// Probability that a call does not take place: the last command stays.
    pub missed: f64,
}

/// A row of the table: what deviates, in words.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// As it is printed.
    pub name: &'static str,
    /// In numbers.
    pub deviation: Deviation,
}

impl Row {
    /// Whether it deviates from this contract: a factor changes nothing of a number that is 0.
    #[must_use]
    pub fn deviates(&self, contract: &Contract) -> bool {
        let ego = contract.ego();
        let factors = [
            (self.deviation.latency, contract.latency()),
            (self.deviation.slower, ego.lag),
            (self.deviation.gain, ego.gain),
            (self.deviation.disturbance, ego.disturbance),
            (
                self.deviation.errors,
                contract.position_error().max(contract.speed_error()),
            ),
        ];
        factors
            .iter()
            .all(|&(factor, number)| factor == 1.0 || number > 0.0)
    }
}

impl Deviation {
    /// Everything is as the contract says.
    pub const NONE: Self = Self {
        acceleration: 1.0,
        latency: 1.0,
        braking: 1.0,
        slower: 1.0,
        lag: 0.0,
        gain: 1.0,
        disturbance: 1.0,
        errors: 1.0,
        error: 0.0,
        dropout: 0.0,
        frozen: 0.0,
        jitter: 0.0,
        missed: 0.0,
    };
}

const NONE: Deviation = Deviation::NONE;

/// The rows of the table. The first one is within the contract.
pub const ROWS: [Row; 21] = [
    row("within the contract", NONE),
    row(
        "others accelerate 1.5 ×",
        Deviation {
            acceleration: 1.5,
            ..NONE
        },
    ),
    row(
        "others accelerate 2 ×",
        Deviation {
            acceleration: 2.0,
            ..NONE
        },
    ),
    row(
        "latency 2 ×",
        Deviation {
            latency: 2.0,
            ..NONE
        },
    ),
    row(
        "latency 3 ×",
        Deviation {
            latency: 3.0,
            ..NONE
        },
    ),
    row(
        "brakes −10 %",
        Deviation {
            braking: 0.9,
            ..NONE
        },
    ),
    row(
        "brakes −20 %",
        Deviation {
            braking: 0.8,
            ..NONE
        },
    ),
    row("lag 0.1 s", Deviation { lag: 0.1, ..NONE }),
    row("lag 0.2 s", Deviation { lag: 0.2, ..NONE }),
    row("lag 0.3 s", Deviation { lag: 0.3, ..NONE }),
    row(
        "lag 2 ×",
        Deviation {
            slower: 2.0,
            ..NONE
        },
    ),
    row("gain error 2 ×", Deviation { gain: 2.0, ..NONE }),
    row(
        "disturbance 2 ×",
        Deviation {
            disturbance: 2.0,
            ..NONE
        },
    ),
    row(
        "sensors err 2 ×",
        Deviation {
            errors: 2.0,
            ..NONE
        },
    ),
    row(
        "sensors err 0.3 m, 0.3 m/s more",
        Deviation { error: 0.3, ..NONE },
    ),
    row(
        "sensors err 0.6 m, 0.6 m/s more",
        Deviation { error: 0.6, ..NONE },
    ),
    row(
        "1 % of the tracks missing",
        Deviation {
            dropout: 0.01,
            ..NONE
        },
    ),
    row(
        "5 % of the tracks missing",
        Deviation {
            dropout: 0.05,
            ..NONE
        },
    ),
    row(
        "observation frozen for 0.5 s",
        Deviation {
            frozen: 0.5,
            ..NONE
        },
    ),
    row(
        "calls ± 30 % of the period",
        Deviation {
            jitter: 0.3,
            ..NONE
        },
    ),
    row(
        "5 % of the calls missed",
        Deviation {
            missed: 0.05,
            ..NONE
        },
    ),
];

const fn row(name: &'static str, deviation: Deviation) -> Row {
    Row { name, deviation }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_factor_of_what_is_0_is_no_deviation() {
        let left_out = |contract: &Contract| -> Vec<&str> {
            let rows = ROWS.iter().filter(|row| !row.deviates(contract));
            rows.map(|row| row.name).collect()
        };
        let exact = [
            "lag 2 ×",
            "gain error 2 ×",
            "disturbance 2 ×",
            "sensors err 2 ×",
        ];
        assert_eq!(left_out(&Contract::WORST_CASE), exact);
        let sensed = Contract::builder().speed_error(0.3).latency(0.0).build();
        assert_eq!(
            left_out(&sensed.unwrap()),
            ["latency 2 ×", "latency 3 ×", exact[0], exact[1], exact[2]]
        );
    }
}
