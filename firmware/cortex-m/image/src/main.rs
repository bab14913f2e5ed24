//! Cede on a bare Cortex-M, under QEMU: answers every golden question, compares with the host bit for
//! bit, and counts instructions and RAM. Exit status 0 only if all answers are the same.
//!
//! No `core::fmt` and nothing that can panic: `firmware/check.sh` looks at the symbols.
#![no_std]
#![no_main]

mod console;
mod counter;
mod stack;

use cede_controller::weights::Aligned;
use cede_controller::{Policy, include_weights};
use cortex_m_rt::entry;
use cortex_m_semihosting::debug;

const GOLDEN_BYTES: &[u8] = include_bytes!(concat!(env!("CEDE_GOLDEN"), "/golden.bin"));
#[unsafe(link_section = ".golden")]
static GOLDEN: Aligned<{ GOLDEN_BYTES.len() / 4 }> = Aligned::new(GOLDEN_BYTES);

#[entry]
fn main() -> ! {
    debug::exit(match run() {
        Ok(()) => debug::EXIT_SUCCESS,
        Err(why) => {
            console::line(why, None);
            debug::EXIT_FAILURE
        }
    });
    loop {}
}

fn run() -> Result<(), &'static str> {
    let mut counter = counter::Counter::take().ok_or("no SysTick")?;
    let weights = include_weights!(concat!(env!("CEDE_GOLDEN"), "/policy.cede"));
    let policy = Policy::new(weights).map_err(|_| "the weights file is damaged")?;
    planted::panic(weights);

    let (mut network, mut decision) = (counter::Range::EMPTY, counter::Range::EMPTY);
    let (mut cases, mut wrong) = (0, 0);
    for case in GOLDEN.0.as_chunks::<{ cede_golden::WORDS }>().0 {
        let Some((question, expected)) = case.split_first_chunk() else {
            continue;
        };
        let inputs = policy.inputs(&cede_golden::pair(question));
        let (_, spent) = counter.count(|| policy.weights().network.forward(&inputs));
        network.add(spent);
        let (answer, spent) = counter.count(|| cede_golden::answer(&policy, question));
        decision.add(spent);
        cases += 1;
        wrong += u32::from(answer != *expected);
    }
    console::line("cases", Some(cases));
    console::line("answers that differ from the host's", Some(wrong));
    console::line("instructions of the network, least", Some(network.least));
    console::line("instructions of the network, most", Some(network.most));
    console::line("instructions of a decision, least", Some(decision.least));
    console::line("instructions of a decision, most", Some(decision.most));
    console::line("RAM touched, bytes", Some(stack::touched()));
    if cases == 0 {
        Err("no golden cases")
    } else if wrong > 0 {
        Err("the answers differ from the host's")
    } else if network.least != network.most {
        Err("the network's instructions depend on its inputs")
    } else {
        Ok(())
    }
}

/// Faults on purpose, by feature, that the checks on the linked image must find.
mod planted {
    /// A panic that the compiler cannot rule out.
    pub(crate) fn panic(words: &[u32]) {
        #[cfg(feature = "planted-panic")]
        core::hint::black_box(words[core::hint::black_box(1)]);
        #[cfg(feature = "planted-allocation")]
        allocation::__rust_alloc(words.len());
        let _ = words;
    }

    #[cfg(feature = "planted-allocation")]
    mod allocation {
        /// Stands for the symbol that every allocation goes through.
        #[unsafe(no_mangle)]
        #[inline(never)]
        pub(super) extern "C" fn __rust_alloc(size: usize) -> usize {
            core::hint::black_box(size)
        }
    }
}

/// Nothing may panic: this handler calls what does not exist, so an image with a reachable panic does not link.
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    unsafe extern "C" {
        fn cede_a_panic_is_reachable() -> !;
    }
    // SAFETY: never linked, see above.
    unsafe { cede_a_panic_is_reachable() }
}
