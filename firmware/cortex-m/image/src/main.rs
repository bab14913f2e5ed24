//! Cede on a bare core, under QEMU: decides on every golden observation, compares with the host
//! bit for bit, and counts instructions and RAM. Exit status 0 only if all decisions are the same.
//!
//! No `core::fmt` and nothing that can panic: `firmware/check.sh` looks at the symbols.
#![no_std]
#![no_main]

mod board;
mod console;
mod counter;
mod stack;

use cede_controller::policy::embedded;
use cede_controller::policy::weights::Aligned;
use cede_controller::{Approach, Decision, Policy, Weights};
use cede_golden::{Golden, Junction, QUESTION, Question, Wrong, answer};
use counter::{Counter, Range};

const GOLDEN_BYTES: &[u8] = include_bytes!(concat!(env!("CEDE_GOLDEN"), "/golden.bin"));
#[unsafe(link_section = ".golden")]
static GOLDEN: Aligned<{ GOLDEN_BYTES.len() / 4 }> = Aligned::new(GOLDEN_BYTES);

/// What the board starts.
fn main() -> ! {
    let result = run();
    if let Err(why) = result {
        console::line(why, None);
    }
    board::exit(result.is_ok())
}

/// The policy: in integers by the feature `i16`.
fn weights() -> &'static [u32] {
    if cfg!(feature = "i16") {
        embedded::words_i16()
    } else {
        embedded::words()
    }
}

/// What is measured on the way.
struct Tally {
    counter: Counter,
    network: Range,
    decision: Range,
    /// Bytes of RAM, statics included, that preparing a junction and deciding need.
    preparing: u32,
    deciding: u32,
    decisions: u32,
    wrong: u32,
}

fn run() -> Result<(), &'static str> {
    let weights = weights();
    let policy = Policy::new(weights).map_err(|_| "the weights file is damaged")?;
    planted::fault(weights);

    let mut counter = Counter::take().ok_or("no SysTick")?;
    let mut tally = Tally {
        network: network(&mut counter, weights).ok_or("the weights file is too short")?,
        counter,
        decision: Range::EMPTY,
        preparing: 0,
        deciding: 0,
        decisions: 0,
        wrong: 0,
    };
    let mut words: &[u32] = &GOLDEN.0;
    while let Some(golden) = Golden::next(&mut words) {
        tally
            .drive(&policy, &golden)
            .ok_or("a junction that is none")?;
    }
    tally.report();
    tally.verdict()
}

impl Tally {
    fn drive(&mut self, policy: &Policy<'_>, golden: &Golden<'_>) -> Option<()> {
        stack::paint();
        let junction = junction(golden).ok()?;
        self.preparing = self.preparing.max(stack::touched());
        self.decide(policy, golden, &junction)
    }

    /// Not inlined, so that the approach has its place only when there is one.
    #[inline(never)]
    fn decide(
        &mut self,
        policy: &Policy<'_>,
        golden: &Golden<'_>,
        junction: &Junction,
    ) -> Option<()> {
        let approach = &mut golden.approach(policy, junction).ok()?;
        stack::paint();
        for step in golden.steps {
            let (question, expected) = step.split_first_chunk()?;
            let (decision, count) = decide(&mut self.counter, approach, question);
            self.decision.add(count);
            self.decisions += 1;
            self.wrong += u32::from(answer(&decision) != *expected);
        }
        self.deciding = self.deciding.max(stack::touched());
        Some(())
    }

    fn report(&self) {
        for (what, number) in [
            ("decisions", self.decisions),
            ("decisions that differ from the host's", self.wrong),
            ("instructions of the network, least", self.network.least),
            ("instructions of the network, most", self.network.most),
            ("instructions of a decision, least", self.decision.least),
            ("instructions of a decision, most", self.decision.most),
            ("RAM to prepare a junction, bytes", self.preparing),
            ("RAM to decide, bytes", self.deciding),
        ] {
            console::line(what, Some(number));
        }
    }

    fn verdict(&self) -> Result<(), &'static str> {
        if self.decisions == 0 {
            Err("no golden decisions")
        } else if self.wrong > 0 {
            Err("the decisions differ from the host's")
        } else if cfg!(target_abi = "eabihf") && self.network.least != self.network.most {
            Err("the network's instructions depend on its inputs")
        } else {
            Ok(())
        }
    }
}

/// Inputs of the embedded network.
const INPUTS: usize = 22;

/// Instructions of the embedded network, over any inputs.
#[inline(never)]
fn network(counter: &mut Counter, weights: &[u32]) -> Option<Range> {
    let weights = Weights::parse(weights).ok()?;
    let mut range = Range::EMPTY;
    for words in GOLDEN.0.as_chunks::<INPUTS>().0.iter().take(1000) {
        let inputs = words.map(f32::from_bits);
        range.add(counter.count(|| weights.network().forward(&inputs)).1);
    }
    Some(range)
}

/// Not inlined, so that its frame is gone when a decision is made.
#[inline(never)]
fn junction(golden: &Golden<'_>) -> Result<Junction, Wrong> {
    golden.junction()
}

/// Not inlined, so that the frame is the same for every step.
#[inline(never)]
fn decide(
    counter: &mut Counter,
    approach: &mut Approach<'_, '_>,
    words: &[u32; QUESTION],
) -> (Decision, u32) {
    let question = Question::new(words);
    let observation = question.observation();
    counter.count(|| approach.decide(question.now, &observation))
}

/// Faults on purpose, by feature, that the checks on the linked image must find.
mod planted {
    /// A panic that the compiler cannot rule out, or what stands for an allocation.
    pub(crate) fn fault(words: &[u32]) {
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
