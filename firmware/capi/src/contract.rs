//! The contract as plain numbers.

use crate::detail::{cede_detail, told};
use crate::field::field;
use crate::memory::{Plain, read, write};
use crate::status::cede_status;
use cede_controller::{Contract, ContractError, Precedence};

/// What the shield assumes of the world. docs/manual.md says what each number means, docs/integration.md where it comes
/// from on a vehicle. Start from cede_contract_worst_case() and change what you know.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct cede_contract {
    /// Time from one decision to the next in s, in [0.01, 1].
    pub period: f32,
    /// A command takes effect within this time in s, in [0, 10 period - 6 jitter].
    pub latency: f32,
    /// How far (s) a call may be from the grid of periods, either way, in [0, 0.35 period]; with precedence up to
    /// period/8.
    pub jitter: f32,
    /// Largest error of a sensed arc length in m, in [0, 10].
    pub position_error: f32,
    /// Largest error of a sensed speed in m/s, in [0, 10].
    pub speed_error: f32,
    /// Subtracted from every margin in m, in [0.01, 10].
    pub slack: f32,
    /// No command accelerates the ego beyond this speed in m/s, in (0, other_max_speed].
    pub ego_max_speed: f32,
    /// Hardest acceleration that is commanded in m/s^2; what it may lead to is in (0, other_acceleration].
    pub ego_acceleration: f32,
    /// Acceleration that is commanded when the ego must clear a zone, in m/s^2, up to ego_acceleration; it leads to 0.01 at
    /// least.
    pub ego_go: f32,
    /// Braking that plans command in m/s^2, the hardest while there is one; it leads to 0.01 at least and other_braking at
    /// most.
    pub ego_braking: f32,
    /// Braking that is commanded while no plan is safe, in m/s^2, in [ego_braking, other_braking]; 0: ego_braking.
    pub ego_emergency: f32,
    /// Time constant in s, at most, of the lag with which the ego's acceleration follows a command, in [0, 1].
    pub ego_lag: f32,
    /// By which share of a command the ego's acceleration may differ from it, in [0, 0.5].
    pub ego_gain: f32,
    /// Acceleration in m/s^2, either way, that nobody commands, in [0, 5]: g times the steepest grade, wind.
    pub ego_disturbance: f32,
    /// Highest speed of another in m/s, in (0, 100].
    pub other_max_speed: f32,
    /// Hardest acceleration of another in m/s^2, in (0, 20].
    pub other_acceleration: f32,
    /// Hardest braking of another in m/s^2, in (0, 20].
    pub other_braking: f32,
    /// Reaction time in s of one behind the ego, in [0, 10].
    pub follower_reaction: f32,
    /// Braking in m/s^2 of one behind the ego, in (0, other_braking].
    pub follower_braking: f32,
    /// Metres before its zone at which a vehicle has arrived, in (0, 200].
    pub precedence_distance: f32,
    /// Braking in m/s^2 with which one that gives way is expected to stop, in (0, 20]; with patience, at most ego_braking.
    pub precedence_braking: f32,
    /// Arrivals within this many periods of each other are a tie.
    pub precedence_tie: u16,
    /// Periods after which the turn passes on while both rest: 0 for never, else at least 5.
    pub precedence_patience: u16,
    /// 1 if the others keep the rule of precedence; 0 if not, and then its numbers are not looked at.
    pub has_precedence: u8,
    /// Ignored.
    pub reserved: [u8; 3],
}

// SAFETY: numbers.
unsafe impl Plain for cede_contract {}

/// The worst case: others accelerate at 3 m/s^2 up to 15 m/s and may brake at 8; a command takes effect one period late;
/// nobody is courteous; sensors are exact.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_contract_worst_case(contract: *mut cede_contract) -> cede_status {
    // SAFETY: the header's contract of pointers.
    unsafe { write(contract, plain(&Contract::WORST_CASE)) }.into()
}

/// The worst case among vehicles that keep the rule of precedence of an all-way stop.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_contract_all_way_stop(contract: *mut cede_contract) -> cede_status {
    // SAFETY: the header's contract of pointers.
    unsafe { write(contract, plain(&Contract::ALL_WAY_STOP)) }.into()
}

/// Whether every number of the contract is in its range; `detail` names the first that is not, with value and range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_contract_check(
    contract: *const cede_contract,
    detail: *mut cede_detail,
) -> cede_status {
    // SAFETY: the header's contract of pointers.
    unsafe { told(checked_contract(contract).map(|_| ()), detail) }
}

/// The contract that is read at `contract`, if it is one.
///
/// # Safety
/// As [`read`].
pub(crate) unsafe fn checked_contract(
    contract: *const cede_contract,
) -> Result<Contract, cede_detail> {
    // SAFETY: by the caller's contract.
    let numbers = unsafe { read(contract) }?;
    Ok(sound(&numbers)?)
}

fn sound(numbers: &cede_contract) -> Result<Contract, ContractError> {
    let precedence = Precedence::new(
        numbers.precedence_distance,
        numbers.precedence_tie,
        numbers.precedence_braking,
        numbers.precedence_patience,
    );
    let emergency = if numbers.ego_emergency == 0.0 {
        numbers.ego_braking
    } else {
        numbers.ego_emergency
    };
    Contract::builder()
        .period(numbers.period)
        .latency(numbers.latency)
        .jitter(numbers.jitter)
        .position_error(numbers.position_error)
        .speed_error(numbers.speed_error)
        .slack(numbers.slack)
        .ego_max_speed(numbers.ego_max_speed)
        .ego_acceleration(numbers.ego_acceleration)
        .ego_go(numbers.ego_go)
        .ego_braking(numbers.ego_braking)
        .ego_emergency(emergency)
        .ego_lag(numbers.ego_lag)
        .ego_gain(numbers.ego_gain)
        .ego_disturbance(numbers.ego_disturbance)
        .other_max_speed(numbers.other_max_speed)
        .other_acceleration(numbers.other_acceleration)
        .other_braking(numbers.other_braking)
        .follower_reaction(numbers.follower_reaction)
        .follower_braking(numbers.follower_braking)
        .precedence((numbers.has_precedence != 0).then_some(precedence))
        .build()
}

/// The numbers of a contract.
#[must_use]
pub fn plain(contract: &Contract) -> cede_contract {
    let (ego, other, follower) = (contract.ego(), contract.other(), contract.follower());
    let rule = contract.precedence().unwrap_or(Precedence::ALL_WAY_STOP);
    cede_contract {
        period: contract.period(),
        latency: contract.latency(),
        jitter: contract.jitter(),
        position_error: contract.position_error(),
        speed_error: contract.speed_error(),
        slack: contract.slack(),
        ego_max_speed: ego.max_speed,
        ego_acceleration: ego.acceleration,
        ego_go: ego.go,
        ego_braking: ego.braking,
        ego_emergency: if ego.emergency > ego.braking {
            ego.emergency
        } else {
            0.0
        },
        ego_lag: ego.lag,
        ego_gain: ego.gain,
        ego_disturbance: ego.disturbance,
        other_max_speed: other.max_speed,
        other_acceleration: other.acceleration,
        other_braking: other.braking,
        follower_reaction: follower.reaction,
        follower_braking: follower.braking,
        precedence_distance: rule.distance,
        precedence_braking: rule.braking,
        precedence_tie: rule.tie,
        precedence_patience: rule.patience,
        has_precedence: contract.precedence().is_some().into(),
        reserved: [0; 3],
    }
}

impl From<ContractError> for cede_detail {
    fn from(error: ContractError) -> Self {
        let [low, high] = error.range();
        Self {
            value: error.value(),
            low,
            high,
            contract_field: field(error.field()),
            excludes_low: error.excludes_low().into(),
            ..Self::new(cede_status::ContractOutOfRange)
        }
    }
}
