//! From a family and a seed to a scenario.

mod cast;
mod describe;
mod family;
mod terms;

pub use cast::{Cast, Manners, Start, can_begin};
pub use family::{FAMILIES, Family};
pub use terms::Terms;

use crate::rng::Rng;
use crate::setup::{Outside, Setup};
use crate::site::Site;
use cede_controller::Priority;

/// So many scenarios in a row have one site, because a site costs more than a scenario.
pub const SHARE: u64 = 32;

/// How often a site, or a cast for it, is drawn before it is given up.
const ATTEMPTS: u32 = 12;

impl Family {
    /// The family of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<&'static Self> {
        FAMILIES.iter().find(|family| family.name == name)
    }

    /// The site of scenario `seed`; none if the controller refuses all that are drawn.
    #[must_use]
    pub fn site(&self, seed: u64) -> Option<Site> {
        let mut rng = Rng::new(self.salt() ^ (seed / SHARE).wrapping_mul(0x9E37_79B9));
        (0..ATTEMPTS).find_map(|_| {
            let ways = (self.ways)(&mut rng);
            let tolerance = rng.pick(&[0.0, 0.1, 0.1, 0.3]);
            let order = (self.ordered && rng.chance(0.85))
                .then(|| Site::random_order(ways.len(), &mut rng));
            let priority = rng.pick(&[Priority::FirstCome, Priority::Unsigned, Priority::Signed]);
            let back = rng.pick(&[None, None, Some(0.0), Some(0.5), Some(3.0)]);
            Site::with_lines(&ways, tolerance, (order, priority), back)
                .ok()
                .filter(|site| site.lanes.len() >= 2)
        })
    }

    /// Scenario `seed` on its `site`; none if there is no room for two vehicles.
    #[must_use]
    pub fn setup<'s>(&self, site: &'s Site, seed: u64) -> Option<Setup<'s>> {
        let mut rng = Rng::new(self.salt().rotate_left(17) ^ seed);
        (0..ATTEMPTS).find_map(|_| self.attempt(site, &mut rng))
    }

    fn attempt<'s>(&self, site: &'s Site, rng: &mut Rng) -> Option<Setup<'s>> {
        let contract = (self.terms)(rng).contract()?;
        let numbers = crate::numbers::Numbers::of(&contract);
        if !site.suits(&numbers) {
            return None;
        }
        let cast = (self.cast)(rng);
        let cars = cast.cars(site, &numbers, rng)?;
        Some(Setup {
            site,
            contract,
            cars,
            ticks: (self.seconds / crate::motion::TICK) as u64,
            sensing: (self.sensing)(rng),
            outside: Outside {
                missed: self.missed,
                ..Outside::NOT
            },
            seed: rng.bits(),
        })
    }

    fn salt(&self) -> u64 {
        // FNV-1a, so that a family's scenarios do not depend on the other families.
        let bytes = self.name.bytes();
        bytes.fold(0xCBF2_9CE4_8422_2325, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01B3)
        })
    }
}
