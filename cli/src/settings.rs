//! Settings of a training, as the command line has them.

use crate::failure::Failure;
use cede_train::run::{Algorithm, Settings};

/// `name=word` as TOML, which wants quotes around a word.
pub(crate) fn quoted(set: &str) -> String {
    match set.split_once('=') {
        Some((name, value)) if set.parse::<toml::Table>().is_err() => format!("{name}=\"{value}\""),
        _ => set.to_owned(),
    }
}

/// `settings` with those replaced that `text`, which comes from `origin`, names in TOML.
pub(crate) fn with(settings: &Settings, text: &str, origin: &str) -> Result<Settings, Failure> {
    let wrong = |error: toml::de::Error| {
        let problem = format!("{origin}: {}", error.to_string().trim_end());
        Failure::input(
            problem,
            "see all settings and their defaults with --show-settings",
        )
    };
    let table: toml::Table = text.parse().map_err(wrong)?;
    settings.with(&table).map_err(wrong)
}

/// The settings of a row of `cede reproduce`, with those replaced that `sets` name, as in
/// `apg.width=64`; those of other rows are passed over.
pub(crate) fn of_row(row: Algorithm, sets: &[String]) -> Result<Settings, Failure> {
    let settings = sets.iter().try_fold(row.reproduction(), |settings, set| {
        let (name, rest) = set.split_once('.').unwrap_or((set, ""));
        let known = Algorithm::ALL.iter().any(|known| known.name() == name);
        if rest.is_empty() || !known {
            let mend = "name the row first, as in --set apg.width=64";
            return Err(Failure::input(
                format!("--set {set}: names no setting of a row"),
                mend,
            ));
        }
        if name == row.name() {
            with(&settings, &quoted(rest), "--set")
        } else {
            Ok(settings)
        }
    })?;
    checked(settings)
}

/// The settings, if a training can begin with them.
pub(crate) fn checked(settings: Settings) -> Result<Settings, Failure> {
    match settings.check() {
        Ok(()) => Ok(settings),
        Err(wrong) => Err(Failure::input(
            wrong,
            "see the settings with --show-settings",
        )),
    }
}
