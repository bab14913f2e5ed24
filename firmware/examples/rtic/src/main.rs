//! Cede in an RTIC application: a task at 100 Hz keeps what the sensors see, one at 10 Hz, which it may interrupt, decides.
//!
//! The exit status under QEMU is 0 if each of 20 decisions was the policy's or the shield's, within its plan.
#![no_std]
#![no_main]

mod device;
mod vehicle;

use cortex_m_rt as _; // the vectors and what comes before RTIC
use cortex_m_semihosting::debug;
use rtic_monotonics::systick::prelude::*;

systick_monotonic!(Mono, 1000);

/// The core's clock in Hz.
const CLOCK: u32 = 25_000_000;

/// Milliseconds from one decision to the next: not those of the contract, by the feature `planted-late`.
const PERIOD: u32 = if cfg!(feature = "planted-late") {
    130
} else {
    100
};

/// Decisions until the application ends.
const DECISIONS: u32 = 20;

#[rtic::app(device = crate::device, peripherals = false, dispatchers = [UARTRX0, UARTTX0])]
mod app {
    use super::{CLOCK, DECISIONS, Mono, PERIOD, end, vehicle};
    use crate::vehicle::{Site, Vehicles};
    use cede_controller::{Approach, Cause, Instant, Observation};
    use rtic_monotonics::systick::prelude::*;

    /// What both tasks use.
    #[shared]
    struct Shared {
        vehicles: Vehicles,
    }

    /// What one task alone uses.
    #[local]
    struct Local {
        approach: Approach<'static, 'static>,
    }

    #[init(local = [site: Option<Site> = None])]
    fn init(context: init::Context) -> (Shared, Local) {
        let Some(approach) = vehicle::enter(context.local.site) else {
            end(false)
        };
        Mono::start(context.core.SYST, CLOCK);
        if sense::spawn().is_err() || decide::spawn().is_err() {
            end(false);
        }
        let vehicles = Vehicles::START;
        (Shared { vehicles }, Local { approach })
    }

    /// The sensors: here they are where the vehicles move.
    #[task(priority = 2, shared = [vehicles])]
    async fn sense(mut context: sense::Context) {
        let mut next = Mono::now();
        loop {
            context.shared.vehicles.lock(Vehicles::advance);
            next += 10.millis();
            Mono::delay_until(next).await;
        }
    }

    #[task(priority = 1, local = [approach], shared = [vehicles])]
    async fn decide(mut context: decide::Context) {
        let mut next = Mono::now();
        let mut sound = true;
        for _ in 0..DECISIONS {
            // A copy, so that deciding holds nobody up.
            let (ego, tracks) = context.shared.vehicles.lock(|now| now.seen());
            let observation = Observation {
                ego,
                tracks: &tracks,
            };
            let now = Instant::from_millis(Mono::now().duration_since_epoch().as_millis().into());
            let decision = context.local.approach.decide(now, &observation);
            let command = decision.acceleration;
            context.shared.vehicles.lock(|now| now.command = command);
            sound &= matches!(decision.cause, Cause::Policy | Cause::Shielded { .. });
            sound &= decision.plan.is_some() && decision.fault.is_none();
            next += PERIOD.millis();
            Mono::delay_until(next).await;
        }
        end(sound)
    }
}

/// Ends the emulator; a vehicle goes on to the next junction.
fn end(sound: bool) -> ! {
    debug::exit(if sound {
        debug::EXIT_SUCCESS
    } else {
        debug::EXIT_FAILURE
    });
    loop {
        cortex_m::asm::wfi();
    }
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    end(false)
}
