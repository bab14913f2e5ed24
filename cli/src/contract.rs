//! The contract that the user names: one with a name, or one in a TOML file.

use crate::failure::Failure;
use crate::input;
use cede_controller::Contract;
use clap::builder::{PossibleValue, TypedValueParser, ValueParserFactory};
use std::path::PathBuf;

/// The contracts with a name, and what they say.
const NAMED: [(&str, Contract, &str); 2] = [
    (
        "worst-case",
        Contract::WORST_CASE,
        "Others may cross at any time, whoever has the right of way",
    ),
    (
        "all-way-stop",
        Contract::ALL_WAY_STOP,
        "Whoever arrived first goes first",
    ),
];

/// Those that are files of their own, with their numbers and what they say.
const FILES: [(&str, &str, &str); 4] = [
    (
        "queues",
        include_str!("../../contracts/queues.toml"),
        "All-way stop, where whoever is second in a queue does not count yet",
    ),
    (
        "passenger-car",
        include_str!("../../contracts/passenger-car.toml"),
        "All-way stop; brakes that are late and not exact, sensors that err; dry road",
    ),
    (
        "passenger-car-wet",
        include_str!("../../contracts/passenger-car-wet.toml"),
        "The same on a wet road",
    ),
    (
        "lorry",
        include_str!("../../contracts/lorry.toml"),
        "The same for a lorry with air brakes",
    ),
];

/// A contract that was named on the command line.
#[derive(Clone, Debug)]
pub(crate) enum Named {
    Known(Contract),
    File(PathBuf),
}

impl Named {
    /// The contract.
    ///
    /// # Errors
    /// The file is not a contract.
    pub(crate) fn read(&self) -> Result<Contract, Failure> {
        match self {
            Self::Known(contract) => Ok(*contract),
            Self::File(path) => {
                let contract = toml::from_str(&input::text(path, WHAT)?);
                contract.map_err(|error| input::unusable(path, error, WHAT))
            }
        }
    }
}

/// What a contract's file should be.
const WHAT: &str = "the numbers of a contract, as contracts/worst-case.toml has them";

/// The contract that was named, or else the worst case.
///
/// # Errors
/// The file is not a contract.
pub(crate) fn or_worst_case(named: Option<&Named>) -> Result<Contract, Failure> {
    named.map_or(Ok(Contract::WORST_CASE), Named::read)
}

/// Reads [`Named`] from a name or the path of a file.
#[derive(Clone, Copy)]
pub(crate) struct Parser;

impl ValueParserFactory for Named {
    type Parser = Parser;

    fn value_parser() -> Parser {
        Parser
    }
}

impl TypedValueParser for Parser {
    type Value = Named;

    fn parse_ref(
        &self,
        command: &clap::Command,
        argument: Option<&clap::Arg>,
        value: &std::ffi::OsStr,
    ) -> Result<Named, clap::Error> {
        clap::builder::StringValueParser::new()
            .try_map(|text| named(&text))
            .parse_ref(command, argument, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        let named = NAMED.into_iter().map(|(name, _, help)| (name, help));
        let files = FILES.into_iter().map(|(name, _, help)| (name, help));
        let values = named.chain(files);
        let values = values.map(|(name, help)| PossibleValue::new(name).help(help));
        let file = PossibleValue::new("FILE.toml").help("The numbers of a file; see contracts/");
        Some(Box::new(values.into_iter().chain([file])))
    }
}

/// A contract by its name, or a file's path.
fn named(text: &str) -> Result<Named, String> {
    if let Some((_, contract, _)) = NAMED.iter().find(|(name, ..)| *name == text) {
        return Ok(Named::Known(*contract));
    }
    if let Some((_, numbers, _)) = FILES.iter().find(|(name, ..)| *name == text) {
        let known = toml::from_str(numbers).map(Named::Known);
        return known.map_err(|error| error.to_string());
    }
    let path = PathBuf::from(text);
    if path.extension().is_none() {
        let known = NAMED.iter().map(|(name, ..)| *name);
        let names: Vec<_> = known.chain(FILES.iter().map(|(name, ..)| *name)).collect();
        let names = names.join(", ");
        return Err(format!("no contract has this name: {names}, or FILE.toml"));
    }
    Ok(Named::File(path))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Contract, String> {
        named(text)?.read().map_err(|failure| match failure {
            Failure::Input(report) => report.to_string(),
            _ => unreachable!("reading fails for its input alone"),
        })
    }

    #[test]
    fn the_files_say_what_the_named_contracts_are() {
        for (name, contract, _) in NAMED {
            let file = format!("{}/../contracts/{name}.toml", env!("CARGO_MANIFEST_DIR"));
            assert_eq!(read(&file).unwrap(), contract, "{name}");
            assert_eq!(read(name).unwrap(), contract);
        }
        for (name, _, _) in FILES {
            let contract = read(name).unwrap();
            assert_eq!(contract.ego().lag > 0.0, name != "queues", "{name}");
            assert!(contract.precedence().is_some(), "{name}");
        }
    }

    #[test]
    fn a_wrong_file_is_refused_with_its_line_and_the_range() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("mine.toml");
        let numbers = include_str!("../../contracts/worst-case.toml");
        let wrong = |text: String| {
            std::fs::write(&file, text).unwrap();
            read(file.to_str().unwrap()).unwrap_err()
        };
        let misspelt = wrong(numbers.replace("reaction", "reacts"));
        assert!(misspelt.contains("line 2"), "{misspelt}");
        let outside = wrong(numbers.replace("braking = 3.0 ", "braking = 9.0 "));
        assert!(
            outside.contains("ego.braking = 9 is outside (0, 8]"),
            "{outside}"
        );
        assert!(read("worst").unwrap_err().contains("worst-case"));
    }
}
