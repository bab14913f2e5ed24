//! `cede help`: the commands, grouped by who needs them.

use clap::Command;

/// Groups of commands, and what they are for. A command that has commands of its own stands for those of them that
/// no group names.
const GROUPS: [(&str, &[&str]); 6] = [
    ("A first look", &["demo", "play"]),
    (
        "Firmware: a policy and a contract for a vehicle",
        &[
            "import",
            "export",
            "verify margins",
            "verify zones",
            "verify beyond",
        ],
    ),
    ("Safety: proofs, and checks of proofs", &["verify"]),
    (
        "Research: recordings, training, judgement",
        &["data", "train", "evaluate", "reproduce"],
    ),
    (
        "Simulation: traffic and single encounters",
        &["data synthesize", "replay"],
    ),
    ("This program", &["completions", "man", "help"]),
];

/// The layout of the help on `grammar`, in clap's notation.
pub(crate) fn template(grammar: &Command) -> String {
    let mut text = "{about-with-newline}\n{usage-heading} {usage}\n".to_owned();
    for (title, paths) in GROUPS {
        text += &format!("\n{title}:\n");
        for (path, about) in paths.iter().flat_map(|path| lines(grammar, path)) {
            text += &format!("  {path:<18} {about}\n");
        }
    }
    text + "\nOptions:\n{options}"
}

/// The commands that `path` stands for, with what they do.
fn lines(grammar: &Command, path: &str) -> Vec<(String, String)> {
    if path == "help" {
        let about = "Print this, or the options of a command: `cede help evaluate`";
        return vec![(path.to_owned(), about.to_owned())];
    }
    let Some(command) = find(grammar, path) else {
        return Vec::new();
    };
    let about = |command: &Command| command.get_about().unwrap_or_default().to_string();
    if !command.has_subcommands() {
        return vec![(path.to_owned(), about(command))];
    }
    let named = |path: &str| GROUPS.iter().any(|(_, paths)| paths.contains(&path));
    command
        .get_subcommands()
        .map(|command| (format!("{path} {}", command.get_name()), about(command)))
        .filter(|(path, _)| !named(path))
        .collect()
}

/// The command at `path`, as in `verify lemmas`.
fn find<'c>(grammar: &'c Command, path: &str) -> Option<&'c Command> {
    let mut words = path.split(' ');
    words.try_fold(grammar, |command, word| command.find_subcommand(word))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arguments::Arguments;
    use clap::CommandFactory;

    #[test]
    fn every_command_is_in_one_group() {
        let grammar = Arguments::command();
        let mut all: Vec<String> = Vec::new();
        for command in grammar.get_subcommands() {
            let name = command.get_name();
            let inner = command.get_subcommands();
            all.extend(inner.map(|inner| format!("{name} {}", inner.get_name())));
            if !command.has_subcommands() {
                all.push(name.to_owned());
            }
        }
        let paths = GROUPS.iter().flat_map(|(_, paths)| *paths);
        let listed = paths.flat_map(|path| lines(&grammar, path));
        let mut listed: Vec<String> = listed.map(|(path, _)| path).collect();
        listed.retain(|path| path != "help");
        all.sort();
        listed.sort();
        assert_eq!(listed, all);
        for (_, paths) in GROUPS {
            for path in paths.iter().filter(|path| **path != "help") {
                assert!(find(&grammar, path).is_some(), "{path}");
            }
        }
    }
}
