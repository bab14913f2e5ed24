//! What the safety file points to: items, tests, theorems and headings in the repository's files.

use std::path::{Path, PathBuf};

/// What declares an item, in Rust and in Rocq.
const KEYWORDS: [&str; 15] = [
    "fn",
    "struct",
    "enum",
    "trait",
    "type",
    "const",
    "static",
    "mod",
    "impl",
    "Theorem",
    "Lemma",
    "Corollary",
    "Definition",
    "Record",
    "Inductive",
];

/// The repository's files.
pub(crate) struct Tree {
    root: PathBuf,
}

impl Tree {
    pub(super) fn new(root: &Path) -> Self {
        Self {
            root: root.to_owned(),
        }
    }

    /// The text of a file.
    pub(super) fn text(&self, path: &str) -> Result<String, String> {
        std::fs::read_to_string(self.root.join(path)).map_err(|_| format!("no file {path}"))
    }

    /// The files in `folder` and below with one of these endings, by their paths, sorted.
    pub(super) fn files(&self, folder: &str, endings: &[&str]) -> Vec<String> {
        let mut found = Vec::new();
        let entries = std::fs::read_dir(self.root.join(folder));
        for entry in entries.into_iter().flatten().flatten() {
            let path = format!("{folder}/{}", entry.file_name().to_string_lossy());
            if entry.path().is_dir() {
                found.extend(self.files(&path, endings));
            } else if endings.iter().any(|ending| path.ends_with(ending)) {
                found.push(path);
            }
        }
        found.sort();
        found
    }

    /// Whether `place`, path::Item or path::Type::item, is there.
    pub(super) fn item(&self, place: &str) -> Result<(), String> {
        let (path, items) = place.split_once("::").ok_or("path::item is needed")?;
        let text = self.text(path)?;
        match items.split("::").find(|item| !declares(&text, item)) {
            None => Ok(()),
            Some(item) => Err(format!("no item {item} in {path}")),
        }
    }

    /// Whether `place`, path::function, is a test that `cargo test` runs.
    pub(super) fn test(&self, place: &str) -> Result<(), String> {
        let (path, name) = place.split_once("::").ok_or("path::function is needed")?;
        let text = self.text(path)?;
        let attributes = attributes(&text, name).ok_or(format!("no function {name} in {path}"))?;
        if !attributes.iter().any(|line| line.starts_with("#[test]")) {
            return Err(format!("{name} in {path} is no test"));
        }
        if attributes.iter().any(|line| line.starts_with("#[ignore")) {
            return Err(format!("{name} in {path} is a test that is not run"));
        }
        Ok(())
    }

    /// Whether `place`, path#heading, is there; or the file alone.
    pub(super) fn heading(&self, place: &str) -> Result<(), String> {
        let (path, heading) = place.split_once('#').unwrap_or((place, ""));
        if heading.is_empty() {
            let there = self.root.join(path).exists();
            return there.then_some(()).ok_or(format!("no file {path}"));
        }
        let text = self.text(path)?;
        let there = text.lines().filter_map(anchor).any(|it| it == heading);
        there
            .then_some(())
            .ok_or(format!("no heading #{heading} in {path}"))
    }
}

/// Whether an item, or a variant of an enumeration, of this name is declared.
pub(super) fn declares(text: &str, name: &str) -> bool {
    let code = text.lines().map(str::trim_start);
    code.filter(|line| !line.starts_with("//")).any(|line| {
        let variant = line.strip_prefix(name).is_some_and(|rest| {
            rest.starts_with([',', '(']) || rest.starts_with(" {") || rest.starts_with(" =")
        });
        variant || declared(line).any(|item| item == name)
    })
}

/// The names that a line declares.
fn declared(line: &str) -> impl Iterator<Item = &str> {
    let word = |c: char| c.is_alphanumeric() || c == '_';
    let words = line.split(move |c| !word(c)).filter(|it| !it.is_empty());
    let followers = words.clone().skip(1);
    let implemented = line.starts_with("impl");
    words
        .zip(followers)
        .filter(move |(before, _)| implemented || KEYWORDS.contains(before))
        .map(|(_, name)| name)
}

/// The attributes of the function `name`, line by line; none if there is no such function.
fn attributes<'t>(text: &'t str, name: &str) -> Option<Vec<&'t str>> {
    let lines: Vec<&str> = text.lines().map(str::trim_start).collect();
    let head = format!("fn {name}(");
    let place = lines.iter().position(|line| line.contains(&head))?;
    let above = lines[..place].iter().rev();
    let above = above.take_while(|line| line.starts_with("#[") || line.starts_with("//"));
    Some(above.copied().collect())
}

/// The anchor of a heading in Markdown; none of another line.
fn anchor(line: &str) -> Option<String> {
    let heading = line.strip_prefix('#')?.trim_start_matches('#');
    let heading = heading.strip_prefix(' ')?.trim().to_lowercase();
    let kept = heading
        .chars()
        .filter(|c| c.is_alphanumeric() || " -_".contains(*c));
    Some(kept.map(|c| if c == ' ' { '-' } else { c }).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    const CODE: &str = "\
//! fn quoted(
pub enum Breach {
    /// Words.
    Ego,
    Other(u16),
}
impl<'j, const N: usize> Shield<'j, N> {
    pub const fn plan(&self) {}
}
    #[test]
    // A comment.
    fn it_runs() {}
    #[test]
    #[ignore = \"long\"]
    fn it_rests() {}
    fn helper() {}
";

    #[test]
    fn items_are_found_where_they_are_declared() {
        for name in ["Breach", "Ego", "Other", "Shield", "plan", "helper"] {
            assert!(declares(CODE, name), "{name}");
        }
        for name in ["quoted", "Words", "u16", "Eg", "pla", "missing"] {
            assert!(!declares(CODE, name), "{name}");
        }
    }

    #[test]
    fn a_test_is_a_function_that_is_run() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a.rs"), CODE).unwrap();
        let test = |name: &str| Tree::new(folder.path()).test(&format!("a.rs::{name}"));
        assert_eq!(test("it_runs"), Ok(()));
        assert_eq!(test("helper"), Err("helper in a.rs is no test".to_owned()));
        let ignored = "it_rests in a.rs is a test that is not run";
        assert_eq!(test("it_rests"), Err(ignored.to_owned()));
        assert_eq!(test("gone"), Err("no function gone in a.rs".to_owned()));
    }

    #[test]
    fn anchors_are_those_of_markdown() {
        assert_eq!(
            anchor("## What is (not) shown, `x_y`").unwrap(),
            "what-is-not-shown-x_y"
        );
        assert_eq!(anchor("#hashtag"), None);
        assert_eq!(anchor("words"), None);
    }
}
