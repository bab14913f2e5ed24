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

/// The rows of `cede reproduce` with their settings, those replaced that `sets` name, as in `apg.width=64`.
///
/// # Errors
/// A setting is not sound, or its row is not among `rows`.
pub(crate) fn of_rows(
    rows: &[Algorithm],
    sets: &[String],
) -> Result<Vec<(Algorithm, Settings)>, Failure> {
    let mut settled: Vec<_> = rows.iter().map(|row| (*row, row.reproduction())).collect();
    for set in sets {
        let (name, rest) = set.split_once('.').unwrap_or((set, ""));
        let known = Algorithm::ALL.iter().any(|known| known.name() == name);
        if rest.is_empty() || !known {
            let mend = "name the row first, as in --set apg.width=64";
            return Err(Failure::input(
                format!("--set {set}: names no setting of a row"),
                mend,
            ));
        }
        let Some((_, settings)) = settled.iter_mut().find(|(row, _)| row.name() == name) else {
            let rows: Vec<_> = rows.iter().map(|row| row.name()).collect();
            let (set, rows) = (format!("--set {set}"), rows.join(","));
            return Err(Failure::ignored(&set, &format!("--rows {rows}")));
        };
        *settings = with(settings, &quoted(rest), "--set")?;
    }
    let check = |(row, settings)| Ok((row, checked(settings)?));
    settled.into_iter().map(check).collect()
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
