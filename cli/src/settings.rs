//! Algorithms and settings on the command line.

use crate::failure::Failure;
use cede_train::run::{Algorithm, TrainSettings};
use clap::builder::PossibleValue;

/// An algorithm by its name.
#[derive(Clone, Copy)]
pub(crate) struct AlgorithmName(pub(crate) Algorithm);

impl clap::ValueEnum for AlgorithmName {
    fn value_variants<'a>() -> &'a [Self] {
        const ALL: [AlgorithmName; 5] = {
            let [a, b, c, d, e] = Algorithm::ALL;
            [
                AlgorithmName(a),
                AlgorithmName(b),
                AlgorithmName(c),
                AlgorithmName(d),
                AlgorithmName(e),
            ]
        };
        &ALL
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(PossibleValue::new(self.0.name()))
    }
}

/// A row of `cede reproduce`: an algorithm with its settings.
#[derive(Clone)]
pub(crate) struct RowSettings {
    pub(crate) algorithm: Algorithm,
    pub(crate) settings: TrainSettings,
}

/// `name=word` as TOML: adds the quotes that a string needs.
pub(crate) fn quoted(set: &str) -> String {
    match set.split_once('=') {
        Some((name, value)) if set.parse::<toml::Table>().is_err() => format!("{name}=\"{value}\""),
        _ => set.to_owned(),
    }
}

/// `settings` with the values of `text` (TOML). `origin` names the source of `text` in errors.
pub(crate) fn with(
    settings: &TrainSettings,
    text: &str,
    origin: &str,
) -> Result<TrainSettings, Failure> {
    let wrong = |error: toml::de::Error| {
        let problem = format!("{origin}: {}", error.to_string().trim_end());
        Failure::input(
            problem,
            "--show-settings prints all settings and their defaults",
        )
    };
    let table: toml::Table = text.parse().map_err(wrong)?;
    settings.with(&table).map_err(wrong)
}

/// The rows of `cede reproduce` with their settings for one site or for `several`, changed by `sets`, as in
/// `apg.width=64`.
///
/// # Errors
/// A setting is unknown or out of its range, or its row is not among `rows`.
pub(crate) fn of_rows(
    rows: &[Algorithm],
    several: bool,
    sets: &[String],
) -> Result<Vec<RowSettings>, Failure> {
    let mut settled: Vec<RowSettings> = rows
        .iter()
        .map(|row| RowSettings {
            algorithm: *row,
            settings: if several {
                row.several_sites()
            } else {
                row.reproduction()
            },
        })
        .collect();
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
        let Some(row) = settled.iter_mut().find(|row| row.algorithm.name() == name) else {
            let rows: Vec<_> = rows.iter().map(|row| row.name()).collect();
            let (set, rows) = (format!("--set {set}"), rows.join(","));
            return Err(Failure::ignored(&set, &format!("--rows {rows}")));
        };
        row.settings = with(&row.settings, &quoted(rest), "--set")?;
    }
    for row in &settled {
        check(&row.settings)?;
    }
    Ok(settled)
}

/// Checks that every setting is in its range.
///
/// # Errors
/// A setting is out of its range.
pub(crate) fn check(settings: &TrainSettings) -> Result<(), Failure> {
    let mend = "--show-settings prints all settings and their defaults";
    settings
        .check()
        .map_err(|wrong| Failure::input(wrong, mend))
}
