//! Whose turn it is when two vehicles wait for each other.
//!
//! While both rest, precedence goes round: whoever has it and does not take it for a whole turn loses it.
//! `docs/shield.md` proves that never both have it.

use super::contract::Contract;
use crate::observation::Vehicle;

/// Whether a vehicle, or each of two, is at rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Rest {
    /// It is not, whoever looks.
    No,
    /// It may be, for somebody who sees it otherwise.
    Perhaps,
    /// It is, and whoever looks finds that it may be.
    Surely,
}

impl Rest {
    /// What the `vehicle` is seen to do: at rest if it has a quarter of the speed that `go` gives in a period.
    ///
    /// If it is surely at rest here, it is faster than that by twice the error at most, and another
    /// sensor, or its own, shows one error more.
    pub(super) fn of(contract: &Contract, vehicle: &Vehicle) -> Self {
        let (slow, error) = (slow(contract), contract.speed_error);
        if vehicle.speed <= slow + error {
            Self::Surely
        } else if vehicle.speed <= slow + 3.0 * error {
            Self::Perhaps
        } else {
            Self::No
        }
    }
}

/// The speed (m/s) below which a vehicle counts as one at rest.
fn slow(contract: &Contract) -> f32 {
    0.25 * contract.ego.go * contract.period
}

/// Whether a vehicle that goes is faster, some time, than one that may be taken for one at rest.
pub(super) fn tells_going_from_rest(contract: &Contract) -> bool {
    slow(contract) + 2.0 * contract.speed_error < contract.ego.max_speed
}

/// Periods from the end of one vehicle's turn to the other's: the former, if seen at rest, then has no
/// plan left that counts on its turn, and would be seen to move if it went on.
pub(super) fn grace(contract: &Contract) -> u16 {
    let gain = contract.ego.go * contract.period;
    // Truncates towards zero and saturates.
    let hidden = ((slow(contract) + 2.0 * contract.speed_error) / gain) as u16;
    hidden.saturating_add(4)
}

/// Whose turn it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Turn {
    /// Whoever goes first by arrival or right of way.
    #[default]
    First,
    /// Not the ego's.
    Past,
    /// The ego's.
    Ego,
}

/// How long the ego and an other have been at rest, both at a time, and whose turn it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Waiting {
    /// Periods for which both may have been at rest: at least as many as the other surely counts, but for one.
    perhaps: u16,
    /// Periods for which both have surely been at rest.
    surely: u16,
    /// One of them was moving when last seen. It may have been so for that one moment, which the
    /// other can have missed.
    moved: bool,
    pub(super) turn: Turn,
}

impl Waiting {
    /// One more period. Turns last `patience` periods; number 0 is whose it has been, and
    /// `mine` says which of the others are the ego's.
    pub(super) fn note(
        &mut self,
        rest: Rest,
        patience: u16,
        grace: u16,
        mine: impl Fn(u16) -> bool,
    ) {
        let moves = rest == Rest::No;
        self.perhaps = if moves && self.moved {
            0
        } else {
            self.perhaps.saturating_add(1)
        };
        self.surely = if rest == Rest::Surely {
            self.surely.saturating_add(1)
        } else {
            0
        };
        self.moved = moves;
        let number = |periods: u16| periods.checked_div(patience).unwrap_or(0);
        let turn = number(self.perhaps);
        if turn == 0 {
            return;
        }
        if turn.saturating_mul(patience) == self.perhaps {
            self.turn = Turn::Past;
        }
        if number(self.surely.saturating_sub(grace)) == turn && mine(turn) {
            self.turn = Turn::Ego;
        }
    }

    /// The other is not to be seen.
    pub(super) fn lose(&mut self) {
        let turn = match self.turn {
            Turn::First => Turn::First,
            Turn::Past | Turn::Ego => Turn::Past,
        };
        *self = Self {
            turn,
            ..Self::default()
        };
    }
}
