//! Going times are whole periods: what rounding does to their number, for every `f32` there is.

use cede_controller::shield::{Contract, margin};
use rayon::prelude::*;

/// By how much (s) the periods for which a plan goes, counted in `f32`, can fall short of the time until the ego has
/// cleared its hazard: the most for every time up to a minute, each of which is tried.
///
/// Times up to one period need no going period at all: the first command lasts so long.
///
/// The same on any number of threads. Cost: a tenth of a second. Never panics.
#[must_use]
pub fn shortfall(contract: &Contract) -> f64 {
    let times = contract.shortest_period().to_bits()..=60.0_f32.to_bits();
    let short = |bits| short(contract, f32::from_bits(bits));
    times.into_par_iter().map(short).reduce(|| 0.0, f64::max)
}

/// The command that is judged lasts the shortest period, the going ones follow. Exact in `f64`, but for the subtraction,
/// which is exact where it matters: when the two are close.
fn short(contract: &Contract, clears: f32) -> f64 {
    let going = f64::from(margin::periods(contract, clears)) * f64::from(contract.period());
    f64::from(clears) - f64::from(contract.shortest_period()) - going
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plan_that_goes_a_period_less_falls_short() {
        let (contract, clears) = (Contract::WORST_CASE, 2.35);
        assert!(short(&contract, clears) < 0.0);
        assert!(short(&contract, clears) + f64::from(contract.period()) > 0.0);
        assert_eq!(margin::periods(&contract, contract.period()), 0);
    }
}
