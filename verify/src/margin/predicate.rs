//! The shield's predicates: its margins, put together as `shield/verified.rs` and `shield/hazard.rs` do.

use cede_controller::Real;
use cede_controller::junction::MAX_PACE;
use cede_controller::shield::actuation::Inherited;
use cede_controller::shield::{Contract, margin};

/// Inputs of a predicate, at most.
pub(super) const INPUTS: usize = 6;

/// A box of inputs: an interval of `f32` for each. Those that a predicate does not have are 0.
pub type Region = [[f32; 2]; INPUTS];

/// An input of a predicate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Input {
    /// The ego's sensed speed (m/s).
    Speed,
    /// The command (m/s²) before: the one that may still be in effect.
    Previous,
    /// The command (m/s²) that is judged.
    Command,
    /// The sensed speed (m/s) of the other.
    OtherSpeed,
    /// Periods for which a plan goes.
    Periods,
    /// Metres that the ego must go to have cleared a zone.
    Target,
    /// The highest speed (m/s) of a pedestrian.
    Pace,
    /// A distance (m) along a route, ahead if positive: how far the ego may go, how far the other is from its
    /// zone, or how far one of the two is behind the other.
    Distance,
}

impl Input {
    /// What it is called.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Speed => "speed",
            Self::Previous => "previous command",
            Self::Command => "command",
            Self::OtherSpeed => "other's speed",
            Self::Periods => "periods",
            Self::Pace => "pace",
            Self::Target => "target",
            Self::Distance => "distance",
        }
    }

    /// The operating domain.
    fn range(self, contract: &Contract) -> [f32; 2] {
        match self {
            Self::Speed | Self::OtherSpeed => [0.0, 20.0],
            // It may have been given while no plan was safe.
            Self::Previous => [-contract.ego().emergency, contract.ego().acceleration],
            Self::Command => [-contract.ego().braking, contract.ego().acceleration],
            // Plans that go for more than a minute are not made.
            Self::Periods => [0.0, 60.0 / contract.period()],
            Self::Pace => [0.0, MAX_PACE],
            Self::Target | Self::Distance => [-512.0, 512.0],
        }
    }
}

/// What the shield asks: each has a margin in metres, and the answer is yes if it is not negative.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Predicate {
    /// Does the ego come to rest in time if it brakes after the command?
    Stops,
    /// Does it come to rest behind an other ahead of it in its lane?
    StopsBehind,
    /// Does it come to rest in time if it goes for some periods after the command, and then brakes?
    StopsAfterGoing,
    /// Does it clear a crossing before the other arrives?
    Crosses,
    /// Does it enter a lane with the gap that the other needs behind it?
    EntersAhead,
    /// Does it clear a crossing before a pedestrian can come to it?
    CrossesBeforeWalker,
}

impl Predicate {
    /// Every one.
    pub const ALL: [Self; 6] = [
        Self::Stops,
        Self::StopsBehind,
        Self::StopsAfterGoing,
        Self::Crosses,
        Self::EntersAhead,
        Self::CrossesBeforeWalker,
    ];

    /// What it is called.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Stops => "stops",
            Self::StopsBehind => "stops behind a leader",
            Self::StopsAfterGoing => "stops after going",
            Self::Crosses => "crosses before the other",
            Self::EntersAhead => "enters ahead of the other",
            Self::CrossesBeforeWalker => "crosses before a pedestrian",
        }
    }

    /// What it depends on, in the order of a [`Region`].
    #[must_use]
    pub const fn inputs(self) -> &'static [Input] {
        use Input::{Command, Distance, OtherSpeed, Pace, Periods, Previous, Speed, Target};
        match self {
            Self::Stops => &[Speed, Previous, Command, Distance],
            Self::StopsBehind => &[Speed, Previous, Command, Distance, OtherSpeed],
            Self::StopsAfterGoing => &[Speed, Previous, Command, Distance, Periods],
            Self::Crosses | Self::EntersAhead => {
                &[Speed, Previous, Command, Distance, OtherSpeed, Target]
            }
            Self::CrossesBeforeWalker => &[Speed, Previous, Command, Distance, Pace, Target],
        }
    }

    /// The operating domain.
    pub(super) fn domain(self, contract: &Contract) -> Region {
        let mut region = [[0.0; 2]; INPUTS];
        for (range, input) in region.iter_mut().zip(self.inputs()) {
            *range = input.range(contract);
        }
        region
    }

    /// The margin, for values in the order of [`Predicate::inputs`].
    pub(super) fn margin<R: Real>(self, contract: &Contract, values: [R; INPUTS]) -> R {
        let [speed, previous, command, distance, fifth, target] = values;
        let departure = margin::departure(
            contract,
            speed,
            &Inherited::all(contract, [previous, previous]),
            command,
        );
        let error = R::of(contract.speed_error());
        let braking = margin::braking(contract);
        let stops = |limit| margin::stops_short(contract, limit, departure.braking.rest(braking));
        let clears = || margin::clearing(contract, departure.least, target);
        match self {
            Self::Stops => stops(distance),
            Self::StopsBehind => {
                let slowest = (fifth - error).max(R::of(0.0));
                stops(distance + margin::earliest_rest(contract, slowest))
            }
            Self::StopsAfterGoing => {
                let time = fifth * R::of(contract.period());
                let rest = margin::rest(contract, departure.most, time);
                margin::stops_short(contract, distance, rest)
            }
            Self::Crosses => {
                let (time, _) = clears();
                let rush = margin::rush(contract, fifth + error, time);
                margin::clears_before(contract, distance, rush)
            }
            Self::EntersAhead => {
                let (time, ego_speed) = clears();
                let rush = margin::rush(contract, fifth + error, time);
                let needed = margin::safe_gap(contract, rush.speed, ego_speed);
                margin::enters_ahead(contract, distance, rush, needed)
            }
            Self::CrossesBeforeWalker => {
                let (time, _) = clears();
                margin::walks_clear(contract, distance, fifth, time)
            }
        }
    }
}
