//! The drivers that can be named on the command line.

use crate::failure::Failure;
use crate::input;
use cede_controller::policy::weights;
use cede_controller::{Contract, Policy};
use cede_data::Encounter;
use cede_formats::cede;
use cede_sim::driver::{Baseline, Cede, DriverFactory, FitError, PolicyAlone, Shielded};
use std::path::Path;
use std::str::FromStr;

/// The drivers that the user has named, in order.
#[derive(Clone, Debug)]
pub(crate) struct Drivers {
    names: Vec<Name>,
    /// Whether drivers that cannot be fitted are left out, as with `all`; otherwise they are an error.
    pub(crate) lenient: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Name {
    Baseline(Baseline),
    Cede,
}

impl Name {
    fn all() -> impl Iterator<Item = Self> {
        let baselines = Baseline::ALL.into_iter().map(Self::Baseline);
        baselines.chain([Self::Cede])
    }

    const fn text(self) -> &'static str {
        match self {
            Self::Baseline(baseline) => baseline.name(),
            Self::Cede => "cede",
        }
    }
}

impl Drivers {
    /// All drivers that can be fitted.
    pub(crate) fn all() -> Self {
        Self {
            names: Name::all().collect(),
            lenient: true,
        }
    }

    /// The drivers. `weights` is the file of Cede's policy; the default is the embedded one.
    ///
    /// # Errors
    /// The file cannot be used, or Cede is not among the drivers.
    pub(crate) fn contenders(&self, weights: Option<&Path>) -> Result<Vec<Contender>, Failure> {
        if weights.is_some() && !self.names.contains(&Name::Cede) {
            let drivers: Vec<_> = self.names.iter().map(|name| name.text()).collect();
            let drivers = format!("--driver {}", drivers.join(","));
            return Err(Failure::ignored("--weights", &drivers));
        }
        let mut contenders = Vec::new();
        for &name in &self.names {
            contenders.push(match name {
                Name::Baseline(baseline) => Contender::Baseline(baseline),
                Name::Cede => Contender::Cede(policy(weights)?),
            });
        }
        Ok(contenders)
    }
}

/// What a weights file should be.
pub(crate) const WEIGHTS: &str = "a .cede file as `cede train` writes it";

/// The policy of a weights file, or the embedded one.
///
/// # Errors
/// The file cannot be used.
pub(crate) fn policy(file: Option<&Path>) -> Result<Policy<'static>, Failure> {
    let Some(file) = file else {
        let words = cede_controller::policy::embedded::words();
        return Policy::new(words).map_err(|error| Failure::input(error, "report this as a bug"));
    };
    let words: Vec<u32> = weights::words(&input::bytes(file, WEIGHTS)?).collect();
    cede::keep(&words).map_err(|error| input::unusable(file, error, WEIGHTS))
}

impl FromStr for Drivers {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        if text.split(',').any(|name| name.trim() == "all") {
            return Ok(Self::all());
        }
        let named = |name: &str| {
            let known = Name::all().find(|known| known.text() == name.trim());
            known.ok_or_else(|| {
                let all: Vec<_> = Name::all().map(Name::text).collect();
                let all = all.join(", ");
                format!("no driver is called `{name}`; there are: all, {all}")
            })
        };
        let mut names = Vec::new();
        for name in text.split(',') {
            let name = named(name)?;
            if !names.contains(&name) {
                names.push(name);
            }
        }
        let lenient = false;
        Ok(Self { names, lenient })
    }
}

/// A driver that is judged.
#[expect(clippy::large_enum_variant, reason = "a handful of them exist")]
pub(crate) enum Contender {
    /// A baseline, with or without the shield.
    Baseline(Baseline),
    /// The controller, or its policy alone if there is no shield.
    Cede(Policy<'static>),
}

impl Contender {
    /// Name in tables.
    pub(crate) const fn name(&self) -> &'static str {
        match self {
            Self::Baseline(baseline) => baseline.name(),
            Self::Cede(_) => Name::Cede.text(),
        }
    }

    /// Makes its drivers. Drivers that learn are fitted to `training`. With a `contract` there is a shield.
    ///
    /// # Errors
    /// The driver learns, and `training` is empty.
    pub(crate) fn fit(
        &self,
        training: &[&Encounter],
        contract: Option<Contract>,
    ) -> Result<Box<dyn DriverFactory>, FitError> {
        Ok(match (self, contract) {
            (Self::Baseline(baseline), None) => baseline.fit(training)?,
            (Self::Baseline(baseline), Some(contract)) => {
                Box::new(Shielded::new(baseline.fit(training)?, contract))
            }
            (Self::Cede(policy), None) => Box::new(PolicyAlone::new(*policy)),
            (Self::Cede(policy), Some(contract)) => Box::new(Cede::new(*policy, contract)),
        })
    }
}
