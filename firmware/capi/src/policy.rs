//! A policy: weights that were checked, where they lie.

use crate::memory::{checked, slice, write};
use crate::object::{Storage, lend, store};
use crate::status::cede_status;
use cede_controller::{FeatureSet, Perspective, Policy, WeightsError};

/// Words of eight bytes of a cede_policy.
pub const CEDE_POLICY_WORDS: usize = 32;

/// A policy. It refers to the weights that it was initialised with: they stay where and as they are for as long as the
/// policy, or a drive or an approach with it, is used.
#[repr(C)]
pub struct cede_policy {
    /// The library's.
    pub storage: [u64; CEDE_POLICY_WORDS],
}

impl Storage for cede_policy {
    type Value = Held;
    const KIND: u32 = u32::from_le_bytes(*b"cepo");
}

pub(crate) struct Held {
    pub(crate) policy: Policy<'static>,
    words: &'static [u32],
}

/// What a policy is.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct cede_policy_info {
    /// SHA-256 of what the network was made from.
    pub provenance: [u8; 32],
    /// Neurons of a hidden layer.
    pub width: u16,
    /// Features that the network is told: 0 raw, 1 route, 2 traffic, 3 scene, 4 rights.
    pub features: u8,
    /// Whose commands it gives: 0 joint, 1 the ego's.
    pub perspective: u8,
}

/// Makes a policy of a weights file (.cede): `bytes` bytes at `weights`, which are on a boundary of 4 (64 is fastest).
///
/// The time is linear in the size: the checksum of all weights is checked.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_policy_init(
    policy: *mut cede_policy,
    weights: *const u32,
    bytes: u32,
) -> cede_status {
    // SAFETY: the header's contract of pointers.
    unsafe { init(policy, weights, bytes) }.into()
}

unsafe fn init(
    policy: *mut cede_policy,
    weights: *const u32,
    bytes: u32,
) -> Result<(), cede_status> {
    checked(policy)?;
    checked(weights)?;
    if !bytes.is_multiple_of(4) {
        return Err(cede_status::WeightsShape);
    }
    // SAFETY: by the header's contract the weights are there as long as the policy.
    unsafe { keep(policy, slice(weights, bytes / 4)?) }
}

unsafe fn keep(policy: *mut cede_policy, words: &'static [u32]) -> Result<(), cede_status> {
    let sound = Policy::new(words)?;
    let held = Held {
        policy: sound,
        words,
    };
    // SAFETY: by the header's contract of pointers.
    unsafe { store(policy, held) }
}

/// Makes a policy of the weights that are part of the library.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_policy_init_embedded(policy: *mut cede_policy) -> cede_status {
    #[cfg(feature = "embedded-policy")]
    // SAFETY: the header's contract of pointers.
    let result = unsafe { keep(policy, cede_controller::policy::embedded::words()) };
    #[cfg(not(feature = "embedded-policy"))]
    let result = checked(policy).and(Err(cede_status::WeightsNotEmbedded));
    result.into()
}

/// Checks the weights' checksum again: a test for the background, to find memory that has changed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_policy_check(policy: *const cede_policy) -> cede_status {
    // SAFETY: the header's contract of pointers.
    unsafe { lend(policy) }
        .and_then(|held| Ok(Policy::new(held.words).map(|_| ())?))
        .into()
}

/// What the policy is.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_policy_describe(
    policy: *const cede_policy,
    info: *mut cede_policy_info,
) -> cede_status {
    // SAFETY: the header's contract of pointers.
    unsafe { lend(policy).and_then(|held| write(info, described(&held.policy))) }.into()
}

fn described(policy: &Policy<'_>) -> cede_policy_info {
    let weights = policy.weights();
    cede_policy_info {
        provenance: weights.provenance(),
        width: u16::try_from(weights.network().width()).unwrap_or(u16::MAX),
        features: (0..)
            .zip(FeatureSet::ALL)
            .find(|&(_, set)| set == weights.features())
            .map_or(u8::MAX, |(number, _)| number),
        perspective: match weights.perspective() {
            Perspective::Joint => 0,
            Perspective::Ego => 1,
        },
    }
}

impl From<WeightsError> for cede_status {
    fn from(error: WeightsError) -> Self {
        match error {
            WeightsError::Magic => Self::WeightsMagic,
            WeightsError::Checksum => Self::WeightsChecksum,
            WeightsError::Unknown => Self::WeightsUnknown,
            WeightsError::Shape => Self::WeightsShape,
            WeightsError::OutOfRange => Self::WeightsOutOfRange,
            WeightsError::Overflow => Self::WeightsOverflow,
            _ => Self::Other,
        }
    }
}
