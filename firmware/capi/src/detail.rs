//! What a refusal is about.

use crate::field::cede_contract_field;
use crate::memory::offer;
use crate::status::cede_status;

/// What a refusal is about. A function that takes a pointer to one fills it in whenever the pointer is not null; what
/// does not apply is 0.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct cede_detail {
    /// What the function returns.
    pub status: cede_status,
    /// The number that is out of its range, and the ends of the range.
    pub value: f32,
    /// The least that is accepted.
    pub low: f32,
    /// The most that is accepted.
    pub high: f32,
    /// A number of points or paths, or the index of a point.
    pub index: u32,
    /// The path.
    pub path: u8,
    /// The field of a contract.
    pub contract_field: cede_contract_field,
    /// 1 if `low` itself is refused.
    pub excludes_low: u8,
    /// 1 if `high` itself is refused.
    pub excludes_high: u8,
}

impl cede_detail {
    /// A status of which there is no more to say.
    pub(crate) const fn new(status: cede_status) -> Self {
        Self {
            status,
            value: 0.0,
            low: 0.0,
            high: 0.0,
            index: 0,
            path: 0,
            contract_field: cede_contract_field::None,
            excludes_low: 0,
            excludes_high: 0,
        }
    }
}

impl From<cede_status> for cede_detail {
    fn from(status: cede_status) -> Self {
        Self::new(status)
    }
}

/// The status of `result`; and all of it at `detail`, if the caller wants it.
///
/// # Safety
/// As [`offer`].
pub(crate) unsafe fn told(
    result: Result<(), cede_detail>,
    detail: *mut cede_detail,
) -> cede_status {
    let what = result.err().unwrap_or(cede_detail::new(cede_status::Ok));
    // SAFETY: by the caller's contract.
    let offered = unsafe { offer(detail, what) };
    match what.status {
        cede_status::Ok => offered.into(),
        status => status,
    }
}
