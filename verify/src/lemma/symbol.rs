//! The quantities that lemmas speak of, and stand-ins for those of a contract.
//!
//! The margins read a contract's `f32` and turn each into [`Real::of`](cede_controller::Real::of). A NaN is no number that a contract
//! may have, so its payload is free to say which symbol it stands for.

/// A quantity that a lemma speaks of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct Symbol {
    /// As solvers see it.
    pub(crate) name: &'static str,
    /// Its SI unit.
    pub(crate) unit: &'static str,
}

/// A quiet NaN; the low bits number the symbol.
const STAND_IN: u32 = 0x7fc0_0000;

const COUNT: usize = 17;

/// The numbers of a contract.
const SYMBOLS: [Symbol; COUNT] = [
    named("period", "s"),
    named("latency", "s"),
    named("position_error", "m"),
    named("speed_error", "m/s"),
    named("slack", "m"),
    named("ego.max_speed", "m/s"),
    named("ego.acceleration", "m/s²"),
    named("ego.go", "m/s²"),
    named("ego.braking", "m/s²"),
    named("other.max_speed", "m/s"),
    named("other.acceleration", "m/s²"),
    named("other.braking", "m/s²"),
    named("follower.reaction", "s"),
    named("follower.braking", "m/s²"),
    named("ego.emergency", "m/s²"),
    named("ego.gain", ""),
    named("ego.disturbance", "m/s²"),
];

const fn named(name: &'static str, unit: &'static str) -> Symbol {
    Symbol { name, unit }
}

/// What `value` stands for, if it is a stand-in.
pub(super) fn stands_for(value: f32) -> Option<Symbol> {
    let number = value.to_bits().checked_sub(STAND_IN)?;
    SYMBOLS.get(usize::try_from(number).ok()?).copied()
}

/// A stand-in for each number of a contract; those of an inexact drivetrain are the last three.
pub(super) fn stand_ins() -> [f32; COUNT] {
    std::array::from_fn(|i| f32::from_bits(STAND_IN + i as u32))
}
