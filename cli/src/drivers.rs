//! The drivers that can be named on the command line.

use crate::failure::Failure;
use crate::input;
use cede_controller::policy::weights;
use cede_controller::{Contract, Orientation, Policy};
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

/// The name of one driver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Name {
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

    /// The driver of that name. `weights` is the file of Cede's policy.
    ///
    /// # Errors
    /// The file cannot be used.
    pub(crate) fn contender(self, weights: Option<&Path>) -> Result<Contender, Failure> {
        Ok(match self {
            Self::Baseline(baseline) => Contender::Baseline(baseline),
            Self::Cede => Contender::Cede(policy(weights)?, self.text().to_owned()),
        })
    }
}

impl FromStr for Name {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let known = Self::all().find(|known| known.text() == text.trim());
        known.ok_or_else(|| {
            let all: Vec<_> = Self::all().map(Self::text).collect();
            let all = all.join(", ");
            format!("no driver is called `{text}`; there are: {all}")
        })
    }
}

/// The orientation that the policy shows, in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Degrees(f32, Orientation);

impl FromStr for Degrees {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let degrees: f32 = text
            .trim()
            .parse()
            .map_err(|_| format!("`{text}` is not a number of degrees"))?;
        let orientation = Orientation::from_degrees(degrees).map_err(|error| error.to_string())?;
        Ok(Self(degrees, orientation))
    }
}

impl Degrees {
    /// The policy that shows this orientation.
    ///
    /// # Errors
    /// `policy` cannot.
    pub(crate) fn shown_by(self, policy: Policy<'static>) -> Result<Policy<'static>, Failure> {
        policy.oriented(self.1).map_err(|error| {
            Failure::input(
                error,
                "leave out --svo, or name another policy with --weights: `cede train apg` trains such",
            )
        })
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

    /// The drivers. `weights` is the file of Cede's policy; the default is the embedded one. Cede is there once for each
    /// of the `orientations`, if there are any.
    ///
    /// # Errors
    /// The file cannot be used, its policy cannot show an orientation, or Cede is not among the drivers.
    pub(crate) fn contenders(
        &self,
        weights: Option<&Path>,
        orientations: &[Degrees],
    ) -> Result<Vec<Contender>, Failure> {
        let without_cede = !self.names.contains(&Name::Cede);
        let given = [
            ("--weights", weights.is_some()),
            ("--svo", !orientations.is_empty()),
        ];
        if without_cede && let Some((option, _)) = given.iter().find(|(_, given)| *given) {
            let drivers: Vec<_> = self.names.iter().map(|name| name.text()).collect();
            let drivers = format!("--driver {}", drivers.join(","));
            return Err(Failure::ignored(option, &drivers));
        }
        let mut contenders = Vec::new();
        for &name in &self.names {
            let plain = name.contender(weights)?;
            match plain {
                Contender::Cede(policy, _) if !orientations.is_empty() => {
                    for &degrees in orientations {
                        contenders.push(Contender::oriented(policy, degrees)?);
                    }
                }
                plain => contenders.push(plain),
            }
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
        let mut names = Vec::new();
        for name in text.split(',') {
            let name = Name::from_str(name).map_err(|error| error + ", all")?;
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
    /// The controller, or its policy alone if there is no shield; and its name in tables.
    Cede(Policy<'static>, String),
}

impl Contender {
    /// Name in tables.
    pub(crate) fn name(&self) -> &str {
        match self {
            Self::Baseline(baseline) => baseline.name(),
            Self::Cede(_, name) => name,
        }
    }

    /// Cede with another orientation.
    fn oriented(policy: Policy<'static>, degrees: Degrees) -> Result<Self, Failure> {
        let name = format!("{} {}°", Name::Cede.text(), degrees.0);
        Ok(Self::Cede(degrees.shown_by(policy)?, name))
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
            (Self::Cede(policy, _), None) => Box::new(PolicyAlone::new(*policy)),
            (Self::Cede(policy, _), Some(contract)) => Box::new(Cede::new(*policy, contract)),
        })
    }
}
