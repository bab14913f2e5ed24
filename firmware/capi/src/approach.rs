//! One vehicle on its way through one junction.

use crate::contract::{cede_contract, checked_contract};
use crate::decision::{cede_decision, cede_fault, cede_reason};
use crate::detail::{cede_detail, told};
use crate::drive::cede_drive;
use crate::junction::{CEDE_MAX_PATHS, cede_junction};
use crate::memory::{Plain, checked, offer, read, slice, write};
use crate::object::{Storage, change, lend, seal_of, store};
use crate::observation::{Seen, cede_observation};
use crate::policy::cede_policy;
use crate::self_test::float_environment;
use crate::status::cede_status;
use cede_controller::{
    Approach, Crosser, EnterError, Instant, Leader, MAX_SIGHTS, NotReady, PathId, Sight,
    SightError, TrafficContext, Vehicle,
};

/// Words of eight bytes of a cede_approach.
pub const CEDE_APPROACH_WORDS: usize = 392;

/// Most paths of which a part is out of sight, in one approach.
pub const CEDE_MAX_SIGHTS: usize = 8;

const _: () = assert!(CEDE_MAX_SIGHTS == MAX_SIGHTS);

/// One vehicle on its way through one junction: plan, precedence and tracks. The next junction begins with a new one. It
/// refers to its junction and to its policy's weights.
#[repr(C)]
pub struct cede_approach {
    /// The library's.
    pub storage: [u64; CEDE_APPROACH_WORDS],
}

impl Storage for cede_approach {
    type Value = Entered;
    const KIND: u32 = u32::from_le_bytes(*b"ceap");
}

/// An approach, and the junction that it refers to.
pub(crate) struct Entered {
    pub(crate) approach: Approach<'static, 'static>,
    junction: *const cede_junction,
    /// The junction's checksum: another one is another junction.
    seal: u32,
}

/// What traffic there is that is not on the junction's paths.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct cede_traffic {
    /// Metres from bumper to bumper to the vehicle ahead in the ego's lane.
    pub leader_gap: f32,
    /// Its speed in m/s.
    pub leader_speed: f32,
    /// Metres that the ego still has to where a third one crosses its way.
    pub crosser_distance: f32,
    /// Metres that the third one has to it.
    pub crosser_its_distance: f32,
    /// The third one's speed in m/s.
    pub crosser_its_speed: f32,
    /// 1 if there is a vehicle ahead.
    pub has_leader: u8,
    /// 1 if there is one that crosses.
    pub has_crosser: u8,
    /// Ignored.
    pub reserved: [u8; 2],
}

// SAFETY: numbers.
unsafe impl Plain for cede_traffic {}

/// How much of a path the sensors see at one moment.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct cede_sight {
    /// Arc length in m from which they see the path: whoever has its centre there or beyond, towards the path's end, is
    /// certainly among the tracks. Before it somebody may be.
    pub from: f32,
    /// Nobody out of sight is faster than this (m/s), in (0, 100], nor than other_max_speed.
    pub speed: f32,
    /// The path.
    pub path: u8,
    /// Ignored.
    pub reserved: [u8; 3],
}

// SAFETY: numbers.
unsafe impl Plain for cede_sight {}

/// Whether control can be handed over.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct cede_readiness {
    /// Metres to spare of the best plan; negative if none is safe.
    pub margin: f32,
    /// What stands in the way.
    pub reason: cede_reason,
    /// What is wrong with the inputs, if something is.
    pub fault: cede_fault,
}

/// Begins an approach by path number `path` of a junction that is built. What the drive says is copied.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_approach_enter(
    approach: *mut cede_approach,
    drive: *const cede_drive,
    junction: *const cede_junction,
    path: u8,
    detail: *mut cede_detail,
) -> cede_status {
    // SAFETY: the header's contract of pointers.
    unsafe { told(enter(approach, drive, junction, path), detail) }
}

unsafe fn enter(
    approach: *mut cede_approach,
    drive: *const cede_drive,
    junction: *const cede_junction,
    path: u8,
) -> Result<(), cede_detail> {
    // SAFETY: by the header's contract of pointers. A junction that is made anew has another checksum, which is
    // compared before the approach is looked at.
    unsafe {
        let site = lend(junction)?.built()?;
        let entered = Entered {
            approach: lend(drive)?.enter(site, PathId::new(path))?,
            junction,
            seal: seal_of(junction)?,
        };
        Ok(store(approach, entered)?)
    }
}

/// The ego's acceleration for the period that begins at `now_us`, in microseconds of a clock that never goes back. To be
/// called once a period.
///
/// Whatever is returned, `decision` holds an acceleration that is finite and admissible, unless the pointer itself is bad.
/// If the observation cannot be read, the step is decided as one without sensors: by the plan that was verified last. If
/// the approach cannot be used, the cause is CEDE_CAUSE_NONE and the acceleration -CEDE_LAST_RESORT_BRAKING.
///
/// CEDE_STATUS_FLOAT_ENVIRONMENT: the step was decided, but the FPU's mode is not the one that the guarantee was proved for.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_approach_decide(
    approach: *mut cede_approach,
    now_us: u64,
    observation: *const cede_observation,
    decision: *mut cede_decision,
) -> cede_status {
    // SAFETY: the header's contract of pointers.
    unsafe { decide(approach, now_us, None, observation, decision) }.into()
}

/// cede_approach_decide() for a vehicle that has a driver of its own for everything but the others at the junction, of its
/// speed limit, curves and leader for example: no more than `most` (m/s^2) is proposed, and `most` where nobody is left to
/// meet who goes first. NaN counts as full braking.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_approach_decide_up_to(
    approach: *mut cede_approach,
    now_us: u64,
    most: f32,
    observation: *const cede_observation,
    decision: *mut cede_decision,
) -> cede_status {
    // SAFETY: the header's contract of pointers.
    unsafe { decide(approach, now_us, Some(most), observation, decision) }.into()
}

unsafe fn decide(
    approach: *mut cede_approach,
    now_us: u64,
    most: Option<f32>,
    observation: *const cede_observation,
    decision: *mut cede_decision,
) -> Result<(), cede_status> {
    checked(decision)?;
    // SAFETY: by the header's contract of pointers.
    unsafe {
        let mut seen = Seen::nothing();
        let read = seen.copy(observation);
        let now = Instant::from_micros(now_us);
        let decided = with(approach, |approach| match most {
            None => approach.decide(now, &seen.observation()),
            Some(most) => approach.decide_up_to(now, &seen.observation(), most),
        });
        let result = decided.as_ref().map_or(cede_decision::NONE, Into::into);
        write(decision, result)?;
        decided.and(read)?;
        float_environment()
    }
}

/// Whether a plan is safe before control is handed over. CEDE_STATUS_OK, CEDE_STATUS_NOT_READY_FAULT or
/// CEDE_STATUS_NOT_READY_NO_PLAN; `readiness`, which may be null, says more. Nothing is remembered.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_approach_ready(
    approach: *const cede_approach,
    now_us: u64,
    observation: *const cede_observation,
    readiness: *mut cede_readiness,
) -> cede_status {
    // SAFETY: the header's contract of pointers.
    unsafe { ready(approach, now_us, observation, readiness) }.into()
}

unsafe fn ready(
    approach: *const cede_approach,
    now_us: u64,
    observation: *const cede_observation,
    readiness: *mut cede_readiness,
) -> Result<(), cede_status> {
    // SAFETY: by the header's contract of pointers.
    unsafe {
        let mut seen = Seen::nothing();
        seen.copy(observation)?;
        let approach = &current(approach)?.approach;
        let ready = approach.ready(Instant::from_micros(now_us), &seen.observation());
        let (status, told) = explained(ready);
        offer(readiness, told)?;
        status
    }
}

fn explained(ready: Result<f32, NotReady>) -> (Result<(), cede_status>, cede_readiness) {
    let mut told = cede_readiness {
        margin: 0.0,
        reason: cede_reason::NONE,
        fault: cede_fault::NONE,
    };
    let status = match ready {
        Ok(margin) => {
            told.margin = margin;
            Ok(())
        }
        Err(NotReady::Fault(fault)) => {
            told.fault = fault.into();
            Err(cede_status::NotReadyFault)
        }
        Err(NotReady::NoPlan {
            reason,
            margin,
            fault,
        }) => {
            told.margin = margin;
            told.reason = reason.into();
            told.fault = fault.map_or(cede_fault::NONE, Into::into);
            Err(cede_status::NotReadyNoPlan)
        }
        Err(_) => Err(cede_status::Other),
    };
    (status, told)
}

/// What the policy alone would do, in m/s^2 within 3: to measure what the shield costs, never to drive. Once a period
/// instead of cede_approach_decide(); 0 if the ego's state has a fault.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_approach_proposal(
    approach: *mut cede_approach,
    observation: *const cede_observation,
    acceleration: *mut f32,
) -> cede_status {
    // SAFETY: the header's contract of pointers.
    unsafe { propose(approach, observation, acceleration) }.into()
}

unsafe fn propose(
    approach: *mut cede_approach,
    observation: *const cede_observation,
    acceleration: *mut f32,
) -> Result<(), cede_status> {
    checked(acceleration)?;
    // SAFETY: by the header's contract of pointers.
    unsafe {
        let mut seen = Seen::nothing();
        seen.copy(observation)?;
        let proposal = with(approach, |approach| approach.proposal(&seen.observation()))?;
        write(acceleration, proposal)
    }
}

/// Drives with another policy from the next decision on; the plan is kept.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_approach_set_policy(
    approach: *mut cede_approach,
    policy: *const cede_policy,
) -> cede_status {
    // SAFETY: the header's contract of pointers.
    unsafe {
        lend(policy)
            .map(|held| held.policy)
            .and_then(|policy| with(approach, |approach| approach.set_policy(policy)))
    }
    .into()
}

/// Drives within another contract from the next decision on; the plan is kept if it is safe under it. A contract that is
/// refused changes nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_approach_set_contract(
    approach: *mut cede_approach,
    contract: *const cede_contract,
    detail: *mut cede_detail,
) -> cede_status {
    // SAFETY: the header's contract of pointers.
    unsafe { told(replace(approach, contract), detail) }
}

unsafe fn replace(
    approach: *mut cede_approach,
    contract: *const cede_contract,
) -> Result<(), cede_detail> {
    // SAFETY: by the header's contract of pointers.
    unsafe {
        let contract = checked_contract(contract)?;
        Ok(with(approach, |approach| approach.set_contract(contract))??)
    }
}

/// Tells the policy of traffic that is not on the junction's paths, for the decisions to come; the shield considers the
/// tracks alone.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_approach_set_traffic(
    approach: *mut cede_approach,
    traffic: *const cede_traffic,
) -> cede_status {
    // SAFETY: the header's contract of pointers.
    unsafe {
        read(traffic)
            .and_then(|traffic| with(approach, |approach| approach.set_traffic((&traffic).into())))
    }
    .into()
}

/// Says of `count` paths how much of them is in sight at `now_us`, for cede_approach_decide() or cede_approach_ready() at that
/// time: before each of these places somebody may be, and is expected to be in every decision to come. Where nothing is said
/// of a path that was named before, those who were out of sight may have come on. Name a path whose view may ever be limited
/// from the first decision on. Sights that are refused change nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_approach_set_sight(
    approach: *mut cede_approach,
    now_us: u64,
    sights: *const cede_sight,
    count: u32,
    detail: *mut cede_detail,
) -> cede_status {
    // SAFETY: the header's contract of pointers.
    unsafe { told(see(approach, now_us, sights, count), detail) }
}

unsafe fn see(
    approach: *mut cede_approach,
    now_us: u64,
    sights: *const cede_sight,
    count: u32,
) -> Result<(), cede_detail> {
    // SAFETY: by the header's contract of pointers.
    unsafe {
        let mut told = heapless::Vec::<Sight, CEDE_MAX_PATHS>::new();
        for sight in slice(sights, count)? {
            let path = PathId::new(sight.path);
            let (from, speed) = (sight.from, sight.speed);
            let room = told.push(Sight { path, from, speed });
            room.map_err(|_| cede_status::TooManySights)?;
        }
        let now = Instant::from_micros(now_us);
        Ok(with(approach, |approach| approach.set_sight(now, &told))??)
    }
}

/// Says that the track with this number is known not to be there any more.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_approach_forget(
    approach: *mut cede_approach,
    number: u16,
) -> cede_status {
    // SAFETY: the header's contract of pointers.
    unsafe { with(approach, |approach| approach.forget(number)) }.into()
}

impl Entered {
    /// Whether the junction is still the one that was entered.
    ///
    /// # Safety
    /// The junction's storage is where it was.
    unsafe fn is_current(&self) -> Result<(), cede_status> {
        // SAFETY: by the caller's contract.
        match unsafe { seal_of(self.junction) } {
            Ok(seal) if seal == self.seal => Ok(()),
            _ => Err(cede_status::Stale),
        }
    }
}

/// The approach, if its junction is still the one that it entered.
///
/// # Safety
/// As [`lend`].
pub(crate) unsafe fn current<'a>(
    approach: *const cede_approach,
) -> Result<&'a Entered, cede_status> {
    // SAFETY: by the header's contract of pointers.
    unsafe {
        let entered: &Entered = lend(approach)?;
        entered.is_current()?;
        Ok(entered)
    }
}

/// What `work` gives on an approach whose junction is still the one that it entered.
unsafe fn with<R>(
    approach: *mut cede_approach,
    work: impl FnOnce(&mut Approach<'static, 'static>) -> R,
) -> Result<R, cede_status> {
    // SAFETY: by the header's contract of pointers.
    unsafe {
        change(approach, |entered| {
            entered.is_current()?;
            Ok(work(&mut entered.approach))
        })
    }?
}

impl From<EnterError> for cede_detail {
    fn from(error: EnterError) -> Self {
        let number = |path: PathId| u8::try_from(path.index()).unwrap_or(u8::MAX);
        match error {
            EnterError::Path { path } => Self {
                path: number(path),
                ..Self::new(cede_status::EnterPath)
            },
            EnterError::PositionError { path, value, below } => Self {
                path: number(path),
                value,
                high: below,
                excludes_high: 1,
                contract_field: crate::field::cede_contract_field::PositionError,
                ..Self::new(cede_status::EnterPositionError)
            },
            _ => cede_status::Other.into(),
        }
    }
}

impl From<SightError> for cede_detail {
    fn from(error: SightError) -> Self {
        let about = |status, path: PathId, value, high| Self {
            path: u8::try_from(path.index()).unwrap_or(u8::MAX),
            value,
            high,
            ..Self::new(status)
        };
        match error {
            SightError::Path { path } => about(cede_status::JunctionUnknownPath, path, 0.0, 0.0),
            SightError::From {
                path,
                value,
                length,
            } => about(cede_status::SightFrom, path, value, length),
            SightError::Speed { path, value } => Self {
                excludes_low: 1,
                ..about(cede_status::SightSpeed, path, value, Vehicle::MAX_SPEED)
            },
            SightError::TooMany => cede_status::TooManySights.into(),
            _ => cede_status::Other.into(),
        }
    }
}

impl From<&cede_traffic> for TrafficContext {
    fn from(traffic: &cede_traffic) -> Self {
        Self {
            leader: (traffic.has_leader != 0).then_some(Leader {
                gap: traffic.leader_gap,
                speed: traffic.leader_speed,
            }),
            crosser: (traffic.has_crosser != 0).then_some(Crosser {
                distance: traffic.crosser_distance,
                its_distance: traffic.crosser_its_distance,
                its_speed: traffic.crosser_its_speed,
            }),
        }
    }
}
