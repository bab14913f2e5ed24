//! Rules of which one is broken: the search must find what comes of it.

use cede_controller::Contract;
use cede_controller::dangerous::Rules;

/// A turn begins when the other's ends.
#[derive(Clone, Debug)]
pub struct NoGrace;

impl Rules for NoGrace {
    fn grace(_: &Contract) -> u16 {
        0
    }
}

/// A turn never ends.
#[derive(Clone, Debug)]
pub struct Endless;

impl Rules for Endless {
    fn ends(_: u16, _: u16, _: u16, _: u16) -> bool {
        false
    }
}
