//! Who rests for how long, while two vehicles wait for each other.

use super::contract::Contract;
use crate::observation::Vehicle;

/// Whether a vehicle is at rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RestState {
    /// Nobody takes it for one at rest.
    No,
    /// Somebody may, who sees it otherwise.
    Perhaps,
    /// It is, and nobody takes it for one that moves.
    Surely,
}

impl RestState {
    /// What `vehicle` does; to be at rest is to have [`Contract::rest_speed`] or less.
    ///
    /// One surely at rest here is faster than that by twice the error at most, and any other
    /// sensor shows one error more: for that one it is perhaps at rest.
    pub(super) fn of(contract: &Contract, vehicle: &Vehicle) -> Self {
        let (slow, error) = (contract.rest_speed(), contract.speed_error);
        if vehicle.speed <= slow + error {
            Self::Surely
        } else if vehicle.speed <= slow + 3.0 * error {
            Self::Perhaps
        } else {
            Self::No
        }
    }
}

/// Periods from the end of one vehicle's turn to the beginning of the other's. One seen at rest until then
/// has no plan left that counts on its turn and goes: it would be seen to move.
pub(super) fn grace(contract: &Contract) -> u16 {
    let gain = contract.ego.go * contract.period;
    // Truncates towards zero and saturates.
    let hidden = ((contract.rest_speed() + 2.0 * contract.speed_error) / gain) as u16;
    hidden.saturating_add(4)
}

/// For how many periods a vehicle has rested.
///
/// It is counted twice, so that two shields can rely on each other: who `surely` rests in one has
/// rested `perhaps` in the other for as long, or for one period less if one of them sees everything a period later.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Standstill {
    pub(super) perhaps: u16,
    pub(super) surely: u16,
    /// It moved when it was last seen: perhaps for that one moment only, which somebody else may have missed.
    moved: bool,
}

impl Standstill {
    /// One more period.
    pub(super) fn note(&mut self, rest: RestState) {
        let moves = rest == RestState::No;
        let count = |keeps: bool, periods: u16| {
            if keeps { periods.saturating_add(1) } else { 0 }
        };
        self.perhaps = count(!(moves && self.moved), self.perhaps);
        self.surely = count(rest == RestState::Surely, self.surely);
        self.moved = moves;
    }
}
