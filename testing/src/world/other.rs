//! Another vehicle: it follows a script within the contract, keeps its distance, or has a shield of its own.

use super::Seen;
use super::commanded::Commanded;
use super::follower::Follower;
use super::motion::State;
use crate::case::{Other, Push, quarters};
use crate::place::{Road, TestJunction};
use crate::vehicle::Truth;
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
    shield: Option<(Shield<'j>, Commanded)>,
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
        let first = zones
            .map(|zone| zone.other.from)
            .fold(f32::INFINITY, f32::min);
        let before = f64::from(other.before) / 10.0;
        let s = match f64::from(first) {
            // In the ego's lane from the start.
            first if first < -1e5 => ego.s + before,
            first if first < 1e5 => first - before,
            // No zone.
            _ => 100.0 - before,
        };
        let state = State {
            s,
            v: f64::from(other.speed) / 10.0,
        };
        let shield = match contract.precedence() {
            Some(_) => {
                let entered = Shield::enter(*contract, junction, other.road.path());
                Some((
                    entered.map_err(|error| error.to_string())?,
                    Commanded::new(state),
                ))
            }
            None => None,
        };
        Ok(Self {
            number: i as u16 + 1,
            road: other.road,
            state,
            gone: false,
            script: other.script.clone(),
            wanted: 0.0,
            follower: Follower::default(),
            shield,
        })
    }

    pub(crate) fn is_shielded(&self) -> bool {
        self.shield.is_some()
    }

    /// The plan of its shield, if it has one.
    pub(crate) fn plan(&self) -> Option<Option<Plan>> {
        self.shield.as_ref().map(|(shield, _)| shield.plan())
    }

    /// Decides for the next period, number `step`; a command of its shield takes effect after the share `late` of
    /// the latency.
    pub(crate) fn decide(
        &mut self,
        contract: &Contract,
        view: Option<Seen>,
        (step, late): (u32, f64),
    ) {
        let share = f64::from(quarters(&self.script, step).unwrap_or(0)) / 4.0;
        let limits = contract.other();
        let wanted = share
            * f64::from(if share < 0.0 {
                limits.braking
            } else {
                limits.acceleration
            });
        match (&mut self.shield, view) {
            (Some((shield, body)), Some(seen)) => {
                let decision = shield.filter(seen.now, &seen.observation(), wanted as f32);
                let late = late * f64::from(contract.latency());
                body.command(decision.acceleration, late);
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
        if let Some((_, body)) = &mut self.shield {
            body.advance(&Truth::as_contracted(contract), time);
            self.state = body.state;
            return;
        }
        let cap = f64::from(contract.other().max_speed);
        let wanted = (self.wanted, time);
        let acceleration = self
            .follower
            .keep_distance(contract, zones, (ego, self.state), wanted);
        self.state = self.state.after(acceleration, time, cap);
    }

    /// Notes whether it has left its zones, and its road of `length` metres.
    pub(crate) fn leave(&mut self, mut zones: impl Iterator<Item = &'j Zone>, length: f64) {
        let s = self.state.s;
        self.gone |= s > length - 6.0 && zones.all(|zone| s >= f64::from(zone.other.to));
    }
}
