//! What drives the vehicle at every intersection.

use crate::contract::{cede_contract, checked_contract};
use crate::detail::{cede_detail, told};
use crate::object::{Storage, lend, store};
use crate::policy::cede_policy;
use crate::status::cede_status;
use cede_controller::{Drive, Part};

/// Words of eight bytes of a cede_drive.
pub const CEDE_DRIVE_WORDS: usize = 42;

/// The part of the left-turner, or of the one that has to give way.
pub const CEDE_PART_LEFT: u8 = 0;
/// The part of the one whom the left-turner meets.
pub const CEDE_PART_OTHER: u8 = 1;

/// What drives the vehicle at every intersection: a policy, a contract and a part.
#[repr(C)]
pub struct cede_drive {
    /// The library's.
    pub storage: [u64; CEDE_DRIVE_WORDS],
}

impl Storage for cede_drive {
    type Value = Drive<'static>;
    const KIND: u32 = u32::from_le_bytes(*b"cedr");
}

/// Makes a drive. Policy and contract are copied; the policy's weights are not. `part`, CEDE_PART_LEFT or
/// CEDE_PART_OTHER, matters to a joint policy alone.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_drive_init(
    drive: *mut cede_drive,
    policy: *const cede_policy,
    contract: *const cede_contract,
    part: u8,
    detail: *mut cede_detail,
) -> cede_status {
    // SAFETY: the header's contract of pointers.
    unsafe { told(init(drive, policy, contract, part), detail) }
}

unsafe fn init(
    drive: *mut cede_drive,
    policy: *const cede_policy,
    contract: *const cede_contract,
    part: u8,
) -> Result<(), cede_detail> {
    // SAFETY: by the header's contract of pointers.
    unsafe {
        let policy = lend(policy)?.policy;
        let contract = checked_contract(contract)?;
        let part = match part {
            CEDE_PART_LEFT => Part::Left,
            CEDE_PART_OTHER => Part::Other,
            _ => return Err(cede_status::UnknownChoice.into()),
        };
        Ok(store(drive, Drive::new(policy, contract, part))?)
    }
}
