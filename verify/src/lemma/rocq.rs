//! The bounds and margins as definitions for Rocq, printed from the code that flies: `proofs/` is about these.

use super::contract::{any_contract, any_drivetrain};
use super::formula::whole_over;
use super::term::{Node, Term};
use cede_controller::dangerous::unchecked;
use cede_controller::shield::actuation::{Inherited, hold, strongest, weakest};
use cede_controller::shield::margin::Departure;
use cede_controller::shield::reach::Reach;
use cede_controller::shield::{Contract, choice, margin};
use std::collections::BTreeMap;
use std::fmt::Write as _;

const HEAD: &str = "\
(* The shield's bounds and margins, printed from the functions that the vehicle runs:
   cede verify lemmas --write rocq proofs/Shipped.v
   Do not edit: a test compares this file with what the code says now. *)
Require Import Reals.
Require Import Contract.
Open Scope R_scope.
";

/// Every bound and margin of the shield, as a file of Rocq definitions over the reals.
///
/// The two times that a contract with jitter is judged by have names of their own there.
#[must_use]
pub fn shipped() -> String {
    let k = &timed_contract();
    let from = Reach {
        distance: named("distance from"),
        speed: named("speed from"),
    };
    let [a, cap, time, target, v] = ["acceleration", "cap", "time", "target", "v"].map(named);
    let mut file = File::new(k);
    file.define("start (v : R) : reach", &Reach::start(v));
    file.define(
        "at_most (from : reach) (acceleration time : R) : reach",
        &from.at_most(a, time),
    );
    file.define(
        "at_least (from : reach) (acceleration cap time : R) : reach",
        &from.at_least(a, cap, time),
    );
    file.define(
        "rushing (from : reach) (acceleration cap time : R) : reach",
        &from.rushing(a, cap, time),
    );
    file.define(
        "rest_of (from : reach) (braking : R) : R",
        &from.rest(named("braking")),
    );
    file.define(
        "until (from : reach) (target acceleration cap : R) : R * R",
        &from.until(target, a, cap),
    );
    file.define(
        "unlimited (k : contract) : R",
        &margin::unlimited::<Term>(k),
    );
    let [sensed, least, most, command] =
        ["sensed", "previous_least", "previous_most", "command"].map(named);
    file.define(
        "departure (k : contract) (sensed previous_least previous_most command : R) : departs",
        &margin::departure(k, sensed, &Inherited::all(k, [least, most]), command),
    );
    file.define(
        "clearing (k : contract) (from : reach) (target : R) : R * R",
        &margin::clearing(k, from, target),
    );
    file.define(
        "rest (k : contract) (from : reach) (time : R) : R",
        &margin::rest(k, from, time),
    );
    file.define(
        "stops_short (k : contract) (limit rests : R) : R",
        &margin::stops_short(k, named("limit"), named("rests")),
    );
    file.define(
        "rush (k : contract) (v time : R) : reach",
        &margin::rush(k, v, time),
    );
    file.define(
        "dawdle (k : contract) (v time : R) : reach",
        &margin::dawdle(k, v, time),
    );
    file.define(
        "clears_before (k : contract) (away : R) (from : reach) : R",
        &margin::clears_before(k, named("away"), from),
    );
    file.define(
        "safe_gap (k : contract) (v ego_v : R) : R",
        &margin::safe_gap(k, v, named("ego_v")),
    );
    file.define(
        "enters_ahead (k : contract) (gap : R) (from : reach) (needed : R) : R",
        &margin::enters_ahead(k, named("gap"), from, named("needed")),
    );
    file.define(
        "earliest_rest (k : contract) (v : R) : R",
        &margin::earliest_rest(k, v),
    );
    file.define(
        "most_command (k : contract) (sensed in_effect : R) : R",
        &choice::most(k, sensed, named("in_effect")),
    );
    file.text + &of_a_drivetrain()
}

/// The same of a drivetrain that is late and not exact: the response is over in the first period, or what is inherited is
/// divided by the end of it.
fn of_a_drivetrain() -> String {
    let k = &drivetrain(0.119_202_9);
    let mut file = File::of_drivetrain(k);
    let from = Reach {
        distance: named("distance from"),
        speed: named("speed from"),
    };
    let [command, sensed, time, target] = ["command", "sensed", "time", "target"].map(named);
    file.define(
        "strongest (k : drivetrain) (command : R) : R",
        &strongest(k, command),
    );
    file.define(
        "weakest (k : drivetrain) (command : R) : R",
        &weakest(k, command),
    );
    file.define(
        "fading (from : reach) (cap loss : R) : reach",
        &from.fading(named("cap"), named("loss")),
    );
    file.define(
        "sinking (from : reach) (acceleration cap time floor : R) : reach",
        &from.sinking(named("acceleration"), named("cap"), time, named("floor")),
    );
    file.define(
        "unlimited_driven (k : drivetrain) : R",
        &margin::unlimited::<Term>(k),
    );
    file.define(
        "hold (k : drivetrain) (least most : R) : R",
        &hold(k, named("least"), named("most")),
    );
    let departs = |k: &Contract| {
        let inherited = Inherited::all(k, ["lowest", "highest"].map(named));
        margin::departure(k, sensed, &inherited, command)
    };
    let signature = "(k : drivetrain) (sensed lowest highest command : R) : departs";
    file.define(&format!("departure_soon {signature}"), &departs(k));
    file.define(
        "clearing_driven (k : drivetrain) (from : reach) (target : R) : R * R",
        &margin::clearing(k, from, target),
    );
    file.define(
        "rest_driven (k : drivetrain) (from : reach) (time : R) : R",
        &margin::rest(k, from, time),
    );
    file.define(
        "safe_gap_driven (k : drivetrain) (v ego_v : R) : R",
        &margin::safe_gap(k, named("v"), named("ego_v")),
    );
    let late = &drivetrain(0.907_202_9);
    let mut last = File::of_drivetrain(late);
    last.define(&format!("departure_late {signature}"), &departs(late));
    file.text + &last.text
}

/// A contract with such a drivetrain, whose times are known by their numbers.
fn drivetrain(latency: f32) -> Contract {
    let builder = any_drivetrain(0.071_313_7).to_builder();
    unchecked(
        builder
            .period(0.731_058_6)
            .latency(latency)
            .jitter(0.017_986_2),
    )
}

/// A contract with jitter. The code computes its two times in `f32`, where symbols are of no use: here they are numbers
/// that occur nowhere else, by which the printer knows them.
fn timed_contract() -> Contract {
    let builder = any_contract().to_builder();
    unchecked(
        builder
            .period(0.731_058_6)
            .latency(0.119_202_9)
            .jitter(0.017_986_2),
    )
}

fn named(name: &'static str) -> Term {
    Term::symbol(name, "")
}

struct File {
    text: String,
    /// The contract's times by their bits.
    times: BTreeMap<u32, &'static str>,
}

impl File {
    /// Without a head.
    fn of_drivetrain(k: &Contract) -> Self {
        let (period, response) = (k.shortest_period(), k.response());
        let times = [
            (k.period(), "period k"),
            (period, "shortest_period k"),
            (response, "response k"),
            (k.ego().lag, "ego_lag k"),
            (response - period, "(response k - shortest_period k)"),
        ];
        Self {
            text: String::new(),
            times: times.map(|(time, name)| (time.to_bits(), name)).into(),
        }
    }

    fn new(k: &Contract) -> Self {
        let times = [
            (k.period(), "period k"),
            (k.shortest_period(), "shortest_period k"),
            (k.switching(), "switching k"),
        ];
        Self {
            text: HEAD.to_owned(),
            times: times.map(|(time, name)| (time.to_bits(), name)).into(),
        }
    }

    fn define(&mut self, signature: &str, value: &impl Value) {
        let mut writer = Writer {
            times: &self.times,
            uses: BTreeMap::new(),
            named: BTreeMap::new(),
            text: String::new(),
        };
        for term in value.terms() {
            writer.count(term);
        }
        for term in value.terms() {
            writer.name_shared(term);
        }
        let said = value.said(&mut |term| writer.term(term));
        let _ = write!(
            self.text,
            "\nDefinition {signature} :=\n{}  {said}.\n",
            writer.text
        );
    }
}

/// What a definition may be.
trait Value {
    fn terms(&self) -> Vec<Term>;
    fn said(&self, term: &mut dyn FnMut(Term) -> String) -> String;
}

impl Value for Term {
    fn terms(&self) -> Vec<Term> {
        vec![*self]
    }

    fn said(&self, term: &mut dyn FnMut(Term) -> String) -> String {
        term(*self)
    }
}

impl Value for (Term, Term) {
    fn terms(&self) -> Vec<Term> {
        vec![self.0, self.1]
    }

    fn said(&self, term: &mut dyn FnMut(Term) -> String) -> String {
        format!("({}, {})", term(self.0), term(self.1))
    }
}

impl Value for Reach<Term> {
    fn terms(&self) -> Vec<Term> {
        vec![self.distance, self.speed]
    }

    fn said(&self, term: &mut dyn FnMut(Term) -> String) -> String {
        let (distance, speed) = (term(self.distance), term(self.speed));
        format!("{{| distance := {distance}; speed := {speed} |}}")
    }
}

impl Value for Departure<Term> {
    fn terms(&self) -> Vec<Term> {
        [self.braking, self.most, self.least]
            .iter()
            .flat_map(Reach::terms)
            .collect()
    }

    fn said(&self, term: &mut dyn FnMut(Term) -> String) -> String {
        let [braking, most, least] =
            [self.braking, self.most, self.least].map(|reach| reach.said(term));
        format!("{{| braking := {braking};\n     most := {most};\n     least := {least} |}}")
    }
}

struct Writer<'a> {
    times: &'a BTreeMap<u32, &'static str>,
    uses: BTreeMap<Term, u32>,
    named: BTreeMap<Term, usize>,
    text: String,
}

/// How tightly what was printed holds together, the loosest first.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
enum Binding {
    Sum,
    Product,
    Application,
    Atom,
}

impl Writer<'_> {
    fn count(&mut self, term: Term) {
        let uses = self.uses.entry(term).or_default();
        *uses += 1;
        if *uses == 1 {
            term.node().parts().for_each(|part| self.count(part));
        }
    }

    /// Gives what is used more than once a name, parts first.
    fn name_shared(&mut self, term: Term) {
        let leaf = term.node().parts().next().is_none();
        if leaf || self.named.contains_key(&term) {
            return;
        }
        for part in term.node().parts() {
            self.name_shared(part);
        }
        if self.uses[&term] > 1 {
            let value = self.term(term);
            let name = self.named.len();
            self.named.insert(term, name);
            let _ = writeln!(self.text, "  let x{name} := {value} in");
        }
    }

    fn term(&self, term: Term) -> String {
        self.said(term).0
    }

    fn said(&self, term: Term) -> (String, Binding) {
        use Binding::{Application, Atom, Product, Sum};
        if let Some(name) = self.named.get(&term) {
            return (format!("x{name}"), Atom);
        }
        // Operations of one rank bind to the left.
        let apply = |word: &str, parts: &[Term]| {
            let parts: Vec<String> = parts
                .iter()
                .map(|part| self.at_least(*part, Atom))
                .collect();
            (format!("{word} {}", parts.join(" ")), Application)
        };
        let operate = |word: &str, [a, b]: [Term; 2], [left, right]: [Binding; 2]| {
            let (a, b) = (self.at_least(a, left), self.at_least(b, right));
            (format!("{a} {word} {b}"), left)
        };
        match term.node() {
            Node::Symbol(symbol) => symbol_said(symbol.name),
            Node::Constant(bits) => match self.times.get(&bits) {
                Some(name) => ((*name).to_owned(), Application),
                None => constant(f32::from_bits(bits)),
            },
            Node::Add(a, b) => operate("+", [a, b], [Sum, Product]),
            Node::Sub(a, b) => operate("-", [a, b], [Sum, Product]),
            Node::Mul(a, b) => operate("*", [a, b], [Product, Application]),
            Node::Div(a, b) => operate("/", [a, b], [Product, Application]),
            Node::Neg(a) => apply("Ropp", &[a]),
            Node::Sqrt(a) => apply("sqrt", &[a]),
            Node::Min(a, b) => apply("Rmin", &[a, b]),
            Node::Max(a, b) => apply("Rmax", &[a, b]),
        }
    }

    fn at_least(&self, term: Term, needed: Binding) -> String {
        match self.said(term) {
            (said, binding) if binding < needed => format!("({said})"),
            (said, _) => said,
        }
    }
}

/// A number of the contract, a part of the reach `from`, or a name.
fn symbol_said(name: &str) -> (String, Binding) {
    if name.contains('.') || is_of_contract(name) {
        (
            format!("{} k", name.replace('.', "_")),
            Binding::Application,
        )
    } else if name.contains(' ') {
        (name.to_owned(), Binding::Application)
    } else {
        (name.to_owned(), Binding::Atom)
    }
}

/// The contract's numbers whose names have no dot, but for its times.
fn is_of_contract(name: &str) -> bool {
    ["position_error", "speed_error", "slack"].contains(&name)
}

/// A finite `f32` exactly.
fn constant(value: f32) -> (String, Binding) {
    let (whole, over) = whole_over(value.abs());
    let size = match over == 1.0 {
        true => (format!("{whole:.0}"), Binding::Atom),
        false => (format!("{whole:.0} / {over:.0}"), Binding::Product),
    };
    match value < 0.0 {
        true => (format!("Ropp ({})", size.0), Binding::Application),
        false => size,
    }
}
