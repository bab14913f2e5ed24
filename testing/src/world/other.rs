//! Another vehicle: it follows a script within the contract, keeps its distance, or has a shield of its own.

use super::Seen;
use super::follower::Follower;
use super::motion::State;
use crate::case::{Other, Push, quarters};
use crate::place::{Road, TestJunction};
use cede_controller::{Contract, Plan, Shield, Zone};

/// Another vehicle on its way.
#[derive(Clone, Debug)]
pub(crate) struct Driven<'j> {
    pub(crate) number: u16,
    pub(crate) road: Road,
    pub(crate) state: State,
    /// It has left all its zones with the ego and its road.
    pub(crate) gone: bool,
    script: Vec<Push>,
    /// What it does unless it has to keep its distance, in m/s².
    wanted: f64,
    follower: Follower,
    /// Where a rule of precedence is assumed, the others keep it because they have a shield as well.
    shield: Option<Shield<'j>>,
    /// The command (m/s²) that is on its way, and the seconds until it takes effect.
    coming: Option<(f64, f64)>,
}

impl<'j> Driven<'j> {
    /// Number `i` of a case.
    pub(crate) fn new(
        i: usize,
        other: &Other,
        ego: State,
        (contract, junction): (&Contract, &'j TestJunction),
    ) -> Result<Self, String> {
        let conflict = junction.conflict(Road::Own.path(), other.road.path());
        let zones = conflict.into_iter().flat_map(|conflict| conflict.zones());
        let first = zones.map(|zone| zone.other.from).fold(f32::INFINITY, f32::min);
        let before = f64::from(other.before) / 10.0;
        let s = match f64::from(first) {
            // In the ego's lane from the start.
            first if first < -1e5 => ego.s + before,
            first if first < 1e5 => first - before,
            // No zone.
            _ => 100.0 - before,
        };
        let shield = match contract.precedence() {
            Some(_) => {
                let entered = Shield::enter(*contract, junction, other.road.path());
                Some(entered.map_err(|error| error.to_string())?)
            }
            None => None,
        };
        Ok(Self {
            number: i as u16 + 1,
            road: other.road,
            state: State { s, v: f64::from(other.speed) / 10.0 },
            gone: false,
            script: other.script.clone(),
            wanted: 0.0,
            follower: Follower::default(),
            shield,
            coming: None,
        })
    }

    pub(crate) fn is_shielded(&self) -> bool {
        self.shield.is_some()
    }

    /// The plan of its shield, if it has one.
    pub(crate) fn plan(&self) -> Option<Option<Plan>> {
        self.shield.as_ref().map(Shield::plan)
    }

    /// Decides for the next period, number `step`; a command of its shield takes effect after the share `late` of
    /// the latency.
    pub(crate) fn decide(&mut self, contract: &Contract, view: Option<Seen>, (step, late): (u32, f64)) {
        let share = f64::from(quarters(&self.script, step).unwrap_or(0)) / 4.0;
        let limits = contract.other();
        let wanted = share * f64::from(if share < 0.0 { limits.braking } else { limits.acceleration });
        match (&mut self.shield, view) {
            (Some(shield), Some(seen)) => {
                let decision = shield.filter(seen.now, &seen.observation(), wanted as f32);
                let late = late * f64::from(contract.latency());
                self.coming = Some((late, decision.acceleration.into()));
            }
            _ => self.wanted = wanted,
        }
    }

    /// Moves on by `time` (s), the ego being at `ego`.
    pub(crate) fn advance(
        &mut self,
        contract: &Contract,
        zones: impl Iterator<Item = &'j Zone>,
        ego: State,
        time: f64,
    ) {
        let cap = f64::from(contract.other().max_speed);
        let mut left = time;
        if let Some((late, command)) = self.coming {
            if late <= time {
                self.state = self.state.after(self.wanted, late, cap);
                self.wanted = command;
                self.coming = None;
                left -= late;
            } else {
                self.coming = Some((late - time, command));
            }
        }
        let acceleration = match self.shield {
            Some(_) => self.wanted,
            None => self.follower.keep_distance(contract, zones, (ego, self.state), (self.wanted, time)),
        };
        self.state = self.state.after(acceleration, left, cap);
    }

    /// Notes whether it has left its zones, and its road of `length` metres.
    pub(crate) fn leave(&mut self, mut zones: impl Iterator<Item = &'j Zone>, length: f64) {
        let s = self.state.s;
        self.gone |= s > length - 6.0 && zones.all(|zone| s >= f64::from(zone.other.to));
    }
}
