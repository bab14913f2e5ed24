//! `--config FILE.toml`: options of a command from a file. Those on the command line win.

use crate::failure::Failure;
use crate::input;
use clap::error::{ContextKind, ContextValue};
use clap::parser::ValueSource;
use clap::{Arg, ArgAction, ArgMatches, Command};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use toml::de::{DeTable, DeValue};

/// The commands with the option, and what its file should be.
const COMMANDS: [&str; 2] = ["evaluate", "reproduce"];
const WHAT: &str = "lines of NAME = VALUE with the names of the command's long options";

/// `grammar` with the option `--config` of [`COMMANDS`].
pub(crate) fn with_option(grammar: Command) -> Command {
    let option = Arg::new("config")
        .long("config")
        .value_name("FILE.toml")
        .value_parser(clap::value_parser!(PathBuf))
        .help("Options from a file, as in `driver = \"idm,cede\"`: NAME = VALUE with the names of the long options. Options on the command line win");
    COMMANDS.into_iter().fold(grammar, |grammar, name| {
        grammar.mut_subcommand(name, |command| command.arg(option.clone()))
    })
}

/// A command line with the options of its configuration file.
pub(crate) struct Expanded {
    words: Vec<OsString>,
    file: PathBuf,
    options: Vec<FileOption>,
}

/// An option in the file.
struct FileOption {
    name: String,
    line: usize,
}

/// Adds the options of the configuration file that `words` names, if they name one. What else is wrong with them is
/// for [`Expanded::matches`] to say.
///
/// # Errors
/// The file cannot be used.
pub(crate) fn expand(grammar: &Command, words: Vec<OsString>) -> Result<Expanded, Failure> {
    let mut expanded = Expanded {
        words,
        file: PathBuf::new(),
        options: Vec::new(),
    };
    // What is required may be in the file.
    let lenient = COMMANDS.into_iter().fold(grammar.clone(), |grammar, name| {
        let optional = |command: Command| command.mut_args(|arg| arg.required(false));
        grammar.mut_subcommand(name, optional)
    });
    let Ok(matches) = lenient.try_get_matches_from(&expanded.words) else {
        return Ok(expanded);
    };
    let Some((name, given)) = matches
        .subcommand()
        .filter(|(name, _)| COMMANDS.contains(name))
    else {
        return Ok(expanded);
    };
    let command = grammar.find_subcommand(name);
    if let (Some(command), Some(file)) = (command, given.get_one::<PathBuf>("config")) {
        expanded.file.clone_from(file);
        expanded.add(command, given)?;
    }
    Ok(expanded)
}

impl Expanded {
    /// What the command line says. Ends the program if its words are wrong or ask for help.
    ///
    /// # Errors
    /// A value in the file is wrong.
    pub(crate) fn matches(&self, grammar: Command) -> Result<ArgMatches, Failure> {
        let matches = grammar.try_get_matches_from(&self.words);
        matches.map_err(|error| match self.blamed(&error) {
            Some(option) => {
                let text = error.to_string();
                let problem = text.lines().next().unwrap_or_default();
                let problem = problem.trim_start_matches("error: ");
                self.wrong(option.line, problem)
            }
            None => error.exit(),
        })
    }

    /// The option of the file that `error` is about.
    fn blamed(&self, error: &clap::Error) -> Option<&FileOption> {
        let Some(ContextValue::String(argument)) = error.get(ContextKind::InvalidArg) else {
            return None;
        };
        let name = argument.split([' ', '=']).next()?.strip_prefix("--")?;
        self.options.iter().find(|option| option.name == name)
    }

    fn add(&mut self, command: &Command, given: &ArgMatches) -> Result<(), Failure> {
        let text = input::text(&self.file, WHAT)?;
        let table = DeTable::parse(&text);
        let table = table.map_err(|error| input::unusable(&self.file, error, WHAT))?;
        for (name, value) in table.get_ref() {
            let line = text[..name.span().start].matches('\n').count() + 1;
            let (name, value) = (name.get_ref().as_ref(), value.get_ref());
            let known = command
                .get_arguments()
                .find(|arg| arg.get_long() == Some(name));
            let Some(arg) = known.filter(|_| name != "config") else {
                let names = command.get_arguments().filter_map(Arg::get_long);
                let names: Vec<_> = names.filter(|name| *name != "config").collect();
                let command = command.get_name();
                let problem = format!(
                    "`cede {command}` has no option `{name}`; it has {}",
                    names.join(", ")
                );
                return Err(self.wrong(line, &problem));
            };
            if given.value_source(arg.get_id().as_str()) == Some(ValueSource::CommandLine) {
                continue;
            }
            let words = words(arg, name, value).map_err(|problem| self.wrong(line, &problem))?;
            self.words.extend(words.into_iter().map(OsString::from));
            let name = name.to_owned();
            self.options.push(FileOption { name, line });
        }
        Ok(())
    }

    fn wrong(&self, line: usize, problem: &str) -> Failure {
        let place = Path::display(&self.file);
        Failure::input(format!("{place}:{line}: {problem}"), "correct the file")
    }
}

/// The option `--name` with the `value` of a file, as words of a command line.
fn words(arg: &Arg, name: &str, value: &DeValue<'_>) -> Result<Vec<String>, String> {
    if matches!(arg.get_action(), ArgAction::SetTrue) {
        return match value {
            DeValue::Boolean(true) => Ok(vec![format!("--{name}")]),
            DeValue::Boolean(false) => Ok(Vec::new()),
            _ => Err(format!("`{name}` has to be true or false")),
        };
    }
    let values = match value {
        DeValue::Array(values) => values.iter().map(|value| scalar(value.get_ref())).collect(),
        value => scalar(value).map(|value| vec![value]),
    };
    let Some(values) = values else {
        return Err(format!(
            "`{name}` has to be a string, a number, or an array of these"
        ));
    };
    Ok(match arg.get_action() {
        ArgAction::Append => values
            .iter()
            .map(|value| format!("--{name}={value}"))
            .collect(),
        _ => vec![format!("--{name}={}", values.join(","))],
    })
}

fn scalar(value: &DeValue<'_>) -> Option<String> {
    match value {
        DeValue::String(text) => Some(text.to_string()),
        DeValue::Integer(number) => Some(number.to_string()),
        DeValue::Float(number) => Some(number.to_string()),
        _ => None,
    }
}
