//! The searches that are made.

use crate::setting::{Approach, Setting};

/// Periods of patience: a turn of the first round must not be over before it is taken, by one who has
/// perhaps rested a few periods longer than surely.
const PATIENCE: u16 = 7;

/// A search and its name.
pub type Named<const N: usize> = (&'static str, Setting<N>);

/// Of two vehicles, with so many disturbances.
#[must_use]
pub fn two(disturbances: u8) -> Vec<Named<2>> {
    let mut all = vec![
        ("turns", turns(disturbances)),
        ("misses", misses(disturbances)),
        ("late", late(disturbances)),
        ("noise", noise(disturbances)),
        ("zone", zone(disturbances)),
        ("jitter", jitter(disturbances)),
        ("creeping", creeping(disturbances)),
        ("unsigned", turns(disturbances).unsigned()),
        ("unsigned, misses", misses(disturbances).unsigned()),
        ("unsigned, late", late(disturbances).right(0, 1).unsigned()),
        (
            "unsigned, late second",
            late(disturbances).right(1, 0).unsigned(),
        ),
    ];
    for (name, tie) in [("arrivals", 0), ("ties of 1", 1), ("ties of 2", 2)] {
        all.push((name, arrivals(tie, disturbances).right(0, 1)));
    }
    all.push(("arrivals of equals", arrivals(1, disturbances)));
    all
}

/// Both rest, go a little and rest again.
#[must_use]
pub fn turns(disturbances: u8) -> Setting<2> {
    Setting {
        approach: Approach::Brisk,
        starts: [-4, -7],
        arrive_by: 9,
        phases: [0, 1],
        disturbances,
        ..Setting::new(PATIENCE, 0).right(0, 1)
    }
}

/// The same, through four turns, while frames, bursts of them and calls are missed.
#[must_use]
pub fn misses(disturbances: u8) -> Setting<2> {
    Setting {
        misses: true,
        longest: 4 * PATIENCE + 6,
        top: 1,
        ..turns(disturbances)
    }
}

/// The same without a right of way, and one shield is switched on at any time.
#[must_use]
pub fn late(disturbances: u8) -> Setting<2> {
    Setting {
        late: true,
        starts: [-7, -4],
        ..Setting {
            rights: Setting::<2>::new(PATIENCE, 0).rights,
            ..turns(disturbances)
        }
    }
}

/// The same with errors of sensed speeds.
#[must_use]
pub fn noise(disturbances: u8) -> Setting<2> {
    let mut setting = turns(disturbances).speed_error(0.05);
    setting.top = 3;
    setting
}

/// Both may go on into the zone.
#[must_use]
pub fn zone(disturbances: u8) -> Setting<2> {
    Setting {
        enters: true,
        ..turns(disturbances)
    }
}

/// Calls are early or late by a tenth of a period.
#[must_use]
pub fn jitter(disturbances: u8) -> Setting<2> {
    Setting {
        phases: [0, 4],
        top: 1,
        starts: [-14, -22],
        arrive_by: 24,
        ..turns(disturbances).jitter(10)
    }
}

/// Both come to the line at any speed, and creep over it at rest.
#[must_use]
pub fn creeping(disturbances: u8) -> Setting<2> {
    Setting {
        approach: Approach::Creeping,
        starts: [-3, -3],
        top: 1,
        longest: PATIENCE + 6,
        disturbances: disturbances.saturating_sub(1),
        ..turns(disturbances)
    }
}

/// Both arrive at any time, and the first one's shield is switched on at any time; no turns.
#[must_use]
pub fn arrivals(tie: u16, disturbances: u8) -> Setting<2> {
    Setting {
        approach: Approach::Slow,
        misses: true,
        late: true,
        phases: [0, 1],
        starts: [-2, -2],
        arrive_by: 7 + 2 * u8::try_from(tie).unwrap_or(0),
        disturbances: disturbances.saturating_sub(1),
        longest: 2,
        top: 1,
        ..Setting::new(0, tie)
    }
}

/// Of three vehicles, with so many disturbances.
#[must_use]
pub fn three(disturbances: u8) -> Vec<Named<3>> {
    let turns = Setting {
        approach: Approach::Brisk,
        starts: [-4, -7, -9],
        phases: [0, 1, 0],
        arrive_by: 11,
        top: 1,
        place_error: 0,
        disturbances,
        ..Setting::new(PATIENCE, 0)
            .right(0, 1)
            .right(1, 2)
            .right(0, 2)
    };
    let late = Setting {
        late: true,
        ..turns.clone()
    };
    let misses = Setting {
        misses: true,
        ..turns.clone()
    };
    let cycle = turns.clone().right(2, 0);
    let sides = cycle.clone().unsigned();
    vec![
        ("turns", turns),
        ("turns of a cycle", cycle),
        ("unsigned rights in a cycle", sides),
        ("late", late),
        ("misses", misses),
    ]
}
