//! What is wrong with the safety file itself: gaps, and names of what is not there.

use super::model::{Assumption, Evidence, FOLDER, Kind, Requirement, SafetyFile};
use super::places::{Tree, declares};
use std::collections::BTreeSet;
use std::fmt;
use std::path::Path;

/// What the program knows, whose names the safety file may use.
pub(crate) struct Known {
    pub(crate) lemmas: Vec<String>,
    pub(crate) margins: Vec<String>,
    pub(crate) zones: Vec<String>,
    pub(crate) campaign: Vec<String>,
    pub(crate) beyond: Vec<String>,
    /// Headings under which it says that results are.
    pub(crate) records: Vec<String>,
    /// Files that the program carries or prints, as it has them.
    pub(crate) carried: Vec<(&'static str, String)>,
}

/// Something that is wrong with the safety file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Defect {
    file: String,
    /// The entry and its field; empty where it is about the file.
    place: String,
    problem: String,
    mend: &'static str,
}

impl fmt::Display for Defect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            file,
            place,
            problem,
            mend,
        } = self;
        let colon = if place.is_empty() { "" } else { ": " };
        write!(f, "{file}{colon}{place}: {problem}; {mend}")
    }
}

const HAZARDS: &str = "hazards.toml";
const REQUIREMENTS: &str = "requirements.toml";
const ASSUMPTIONS: &str = "assumptions.toml";

const NAME: &str = "name what is there";
const DEFINE: &str = "define it, or name one that is defined";

/// All that is wrong with the safety file of the repository in `root`.
pub(crate) fn defects(file: &SafetyFile, root: &Path, known: &Known) -> Vec<Defect> {
    let mut found = Finder {
        file,
        known,
        tree: Tree::new(root),
        defects: Vec::new(),
    };
    found.identifiers();
    found.goals();
    for requirement in &file.requirements {
        found.requirement(requirement);
    }
    for assumption in &file.assumptions {
        found.assumption(assumption);
    }
    found.conditions();
    found.documents();
    found.carried();
    found.defects
}

struct Finder<'f> {
    file: &'f SafetyFile,
    known: &'f Known,
    tree: Tree,
    defects: Vec<Defect>,
}

impl Finder<'_> {
    fn add(&mut self, file: &str, place: &str, problem: impl Into<String>, mend: &'static str) {
        let file = match file.contains('/') || file == README {
            true => file.to_owned(),
            false => format!("{FOLDER}/{file}"),
        };
        self.defects.push(Defect {
            file,
            place: place.to_owned(),
            problem: problem.into(),
            mend,
        });
    }

    /// Identifiers have their form, and each is defined once.
    fn identifiers(&mut self) {
        let mut seen = BTreeSet::new();
        for (file, prefix, id) in self.file.identifiers() {
            if !id.strip_prefix(prefix).is_some_and(is_number) {
                let problem = format!("is not of the form {prefix}nn");
                self.add(file, id, problem, "give it a number of two digits or more");
            }
            if !seen.insert(id) {
                self.add(
                    file,
                    id,
                    "is defined twice",
                    "give one of them another number",
                );
            }
        }
    }

    /// Every hazard has a goal, and every goal a requirement.
    fn goals(&mut self) {
        let file = self.file;
        for hazard in &file.hazards.hazard {
            self.defined(HAZARDS, &hazard.id, "goals", &hazard.goals);
            if hazard.goals.is_empty() {
                self.add(
                    HAZARDS,
                    &hazard.id,
                    "has no goal",
                    "name a goal that answers it",
                );
            }
        }
        for goal in &file.hazards.goal {
            let mut requirements = file.requirements.iter();
            if !requirements.any(|requirement| requirement.goals.contains(&goal.id)) {
                self.add(HAZARDS, &goal.id, "no requirement serves it", "add one");
            }
        }
    }

    /// All of `ids` are defined.
    fn defined(&mut self, file: &'static str, id: &str, field: &str, ids: &[String]) {
        let known: BTreeSet<&str> = self.file.identifiers().map(|(_, _, id)| id).collect();
        for name in ids.iter().filter(|name| !known.contains(name.as_str())) {
            let place = format!("{id}, {field}");
            self.add(file, &place, format!("{name} is not defined"), DEFINE);
        }
    }

    fn requirement(&mut self, requirement: &Requirement) {
        let id = &requirement.id;
        self.defined(REQUIREMENTS, id, "goals", &requirement.goals);
        self.defined(REQUIREMENTS, id, "rests_on", &requirement.rests_on);
        if requirement.goals.is_empty() {
            self.add(
                REQUIREMENTS,
                id,
                "serves no goal",
                "name a goal of hazards.toml",
            );
        }
        if requirement.evidence.each().next().is_none() && requirement.open.is_none() {
            let mend = "name what shows it, or say in `open` that nothing does";
            self.add(REQUIREMENTS, id, "has no evidence", mend);
        }
        if requirement.code.is_empty() {
            self.add(REQUIREMENTS, id, "names no code", "name what implements it");
        }
        for place in &requirement.code {
            self.must(REQUIREMENTS, id, "code", place, self.tree.item(place));
        }
        self.variants(REQUIREMENTS, id, "diagnostics", &requirement.diagnostics);
        for evidence in requirement.evidence.each() {
            let field = format!("evidence ({})", evidence.kind);
            let there = self.evidence(evidence);
            self.must(REQUIREMENTS, id, &field, evidence.name, there);
        }
    }

    fn assumption(&mut self, assumption: &Assumption) {
        let id = &assumption.id;
        self.variants(ASSUMPTIONS, id, "monitors", &assumption.monitors);
        for place in &assumption.tests {
            self.must(ASSUMPTIONS, id, "tests", place, self.tree.test(place));
        }
        if assumption.monitors.is_empty() && assumption.unseen.is_none() {
            let mend = "name a monitor, or say in `unseen` that nothing tells when it is broken";
            self.add(
                ASSUMPTIONS,
                id,
                "says nothing of how a breach is seen",
                mend,
            );
        }
        if !assumption.monitors.is_empty() && assumption.tests.is_empty() {
            self.add(ASSUMPTIONS, id, "its monitors have no test", "name one");
        }
        let mut requirements = self.file.requirements.iter();
        if !requirements.any(|requirement| requirement.rests_on.contains(id)) {
            let mend = "name it in rests_on of those that need it, or leave it out";
            self.add(ASSUMPTIONS, id, "no requirement rests on it", mend);
        }
    }

    /// Adds what is missing, if anything is.
    fn must(&mut self, file: &str, id: &str, field: &str, name: &str, there: Result<(), String>) {
        if let Err(problem) = there {
            let place = format!("{id}, {field} = {name:?}");
            self.add(file, &place, problem, NAME);
        }
    }

    /// All of `names`, Enum::Variant, are diagnostics of the controller.
    fn variants(&mut self, file: &str, id: &str, field: &str, names: &[String]) {
        for name in names {
            let there = self.variant(name);
            self.must(file, id, field, name, there);
        }
    }

    fn variant(&self, name: &str) -> Result<(), String> {
        let (owner, variant) = name.split_once("::").ok_or("Enum::Variant is needed")?;
        let sources = self.tree.files("controller/src", &[".rs"]);
        let declared = sources.iter().any(|path| {
            let text = self.tree.text(path).unwrap_or_default();
            text.contains(&format!("pub enum {owner} {{")) && declares(&text, variant)
        });
        declared
            .then_some(())
            .ok_or(format!("the controller has no {name}"))
    }

    /// Whether a piece of evidence is there.
    fn evidence(&self, Evidence { kind, name }: Evidence<'_>) -> Result<(), String> {
        let among = |names: &[String]| {
            let there = names.iter().any(|known| known == name);
            there
                .then_some(())
                .ok_or(format!("there is no {kind} of this name"))
        };
        match kind {
            Kind::Lemma => among(&self.known.lemmas),
            Kind::Margin => among(&self.known.margins),
            Kind::Zones => among(&self.known.zones),
            Kind::Campaign => among(&self.known.campaign),
            Kind::Beyond => among(&self.known.beyond),
            Kind::Property => among(&self.file.properties),
            Kind::Scenario => among(&self.file.scenarios),
            Kind::Theorem => self.theorem(name),
            Kind::Test => self.tree.test(name),
            Kind::Record => self.tree.heading(name),
        }
    }

    fn theorem(&self, name: &str) -> Result<(), String> {
        let asked = self.tree.text("proofs/Assumptions.v")?;
        if !asked.contains(&format!("Print Assumptions {name}.")) {
            return Err("proofs/Assumptions.v does not ask what it rests on".to_owned());
        }
        let files = self.tree.files("proofs", &[".v"]);
        let mut texts = files.iter().filter_map(|path| self.tree.text(path).ok());
        let declared = texts.any(|text| declares(&text, name));
        declared
            .then_some(())
            .ok_or("no file in proofs/ states it".to_owned())
    }

    /// Every condition of theorem and manual is taken up, and nothing else is.
    fn conditions(&mut self) {
        let documents = ["docs/theorem.md", "docs/manual.md"];
        let texts = documents.map(|path| self.tree.text(path).unwrap_or_default());
        let stated: BTreeSet<&str> = texts.iter().flat_map(|text| conditions(text)).collect();
        let file = self.file;
        let requirements = file.requirements.iter();
        let taken = requirements.map(|it| (REQUIREMENTS, &it.id, &it.sources));
        let assumptions = file.assumptions.iter();
        let taken = taken.chain(assumptions.map(|it| (ASSUMPTIONS, &it.id, &it.sources)));
        let mut all = BTreeSet::new();
        for (name, id, sources) in taken {
            for source in sources {
                all.insert(source.as_str());
                if !stated.contains(source.as_str()) {
                    let place = format!("{id}, sources");
                    let problem = format!("no table of theorem and manual states {source}");
                    self.add(name, &place, problem, NAME);
                }
            }
        }
        for condition in stated.difference(&all) {
            let mend = "name it in `sources` of a requirement or an assumption";
            self.add(
                ASSUMPTIONS,
                condition,
                "nothing takes up this condition",
                mend,
            );
        }
    }

    /// Documents use no identifier that is not defined, and point to what is there.
    fn documents(&mut self) {
        let known: BTreeSet<String> = self
            .file
            .identifiers()
            .map(|(_, _, id)| id.into())
            .collect();
        let mut files = self.tree.files("docs", &[".md", ".toml"]);
        files.push(README.to_owned());
        for path in files {
            let text = self.tree.text(&path).unwrap_or_default();
            for id in used(&text).filter(|id| !known.contains(*id)) {
                self.add(&path, "", format!("{id} is not defined"), DEFINE);
            }
            if path.starts_with(FOLDER) && path.ends_with(".md") {
                for place in quoted(&text).filter(|place| place.contains(".rs::")) {
                    self.must(&path, "text", "place", place, self.tree.item(place));
                }
                for link in links(&text) {
                    self.must(
                        &path,
                        "text",
                        "link",
                        link,
                        self.tree.heading(&beside(&path, link)),
                    );
                }
            }
        }
    }

    /// The program was built from this tree, and points to what is there.
    fn carried(&mut self) {
        for record in &self.known.records {
            self.must(
                README,
                "verify all",
                "record",
                record,
                self.tree.heading(record),
            );
        }
        for (path, carried) in &self.known.carried {
            if self.tree.text(path).as_deref() != Ok(carried) {
                let problem = "differs from what the program has";
                self.add(path, "", problem, "build the program from this tree");
            }
        }
    }
}

const README: &str = "README.md";

impl SafetyFile {
    /// All identifiers: the file that defines it, its prefix, and itself.
    fn identifiers(&self) -> impl Iterator<Item = (&'static str, &'static str, &str)> {
        let hazards = self
            .hazards
            .hazard
            .iter()
            .map(|it| (HAZARDS, "H-", it.id.as_str()));
        let goals = self
            .hazards
            .goal
            .iter()
            .map(|it| (HAZARDS, "SG-", it.id.as_str()));
        let requirements = self.requirements.iter();
        let requirements = requirements.map(|it| (REQUIREMENTS, "SR-", it.id.as_str()));
        let assumptions = self.assumptions.iter();
        let assumptions = assumptions.map(|it| (ASSUMPTIONS, "AOU-", it.id.as_str()));
        hazards.chain(goals).chain(requirements).chain(assumptions)
    }
}

fn is_number(text: &str) -> bool {
    text.len() >= 2 && text.bytes().all(|byte| byte.is_ascii_digit())
}

/// The identifiers that a text uses.
fn used(text: &str) -> impl Iterator<Item = &str> {
    let words = text.split(|c: char| !c.is_ascii_alphanumeric() && c != '-');
    words.filter(|word| {
        let mut prefixes = ["H-", "SG-", "SR-", "AOU-"].into_iter();
        prefixes.any(|prefix| word.strip_prefix(prefix).is_some_and(is_number))
    })
}

/// The conditions that a document states: rows of tables that begin with A1, C1, P1 or U1.
fn conditions(text: &str) -> impl Iterator<Item = &str> {
    let first = |line: &'_ str| {
        line.strip_prefix("| ")?
            .split_once(" |")
            .map(|it| it.0.len())
    };
    text.lines().filter_map(move |line| {
        let name = line.get(2..2 + first(line)?)?;
        let number = name.strip_prefix(['A', 'C', 'P', 'U'])?;
        let numbered = !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit());
        numbered.then_some(name)
    })
}

/// What stands between backticks.
fn quoted(text: &str) -> impl Iterator<Item = &str> {
    text.lines()
        .flat_map(|line| line.split('`').skip(1).step_by(2))
}

/// Where the links of a document lead, without those to other hosts.
fn links(text: &str) -> impl Iterator<Item = &str> {
    let targets = text
        .split("](")
        .skip(1)
        .filter_map(|rest| rest.split_once(')'));
    targets
        .map(|(target, _)| target)
        .filter(|target| !target.contains("://"))
}

/// The path of a link in the document at `path`.
fn beside(path: &str, link: &str) -> String {
    if link.starts_with('#') {
        return format!("{path}{link}");
    }
    let mut parts: Vec<&str> = path.split('/').collect();
    parts.pop();
    for part in link.split('/') {
        match part {
            ".." => drop(parts.pop()),
            "." => {}
            part => parts.push(part),
        }
    }
    parts.join("/")
}
