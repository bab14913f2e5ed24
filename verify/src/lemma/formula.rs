//! What is said of terms, and how solvers are told.

use super::symbol::Symbol;
use super::term::{Node, Term};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

/// A statement about terms.
#[derive(Clone, Debug)]
pub(crate) enum Formula {
    Less(Term, Term),
    AtMost(Term, Term),
    Equal(Term, Term),
    All(Vec<Formula>),
    Any(Vec<Formula>),
    Not(Box<Formula>),
}

impl Term {
    /// `self` < `other`. (Named, because `<` compares how terms came about.)
    pub(crate) fn less(self, other: Self) -> Formula {
        Formula::Less(self, other)
    }

    /// `self` ≤ `other`.
    pub(crate) fn at_most(self, other: Self) -> Formula {
        Formula::AtMost(self, other)
    }

    /// `self` = `other`.
    pub(crate) fn equal(self, other: Self) -> Formula {
        Formula::Equal(self, other)
    }
}

/// All of them hold.
pub(crate) fn all(formulas: impl IntoIterator<Item = Formula>) -> Formula {
    Formula::All(formulas.into_iter().collect())
}

/// One of them holds, or more.
pub(crate) fn any(formulas: impl IntoIterator<Item = Formula>) -> Formula {
    Formula::Any(formulas.into_iter().collect())
}

/// It does not hold.
pub(crate) fn not(formula: Formula) -> Formula {
    Formula::Not(Box::new(formula))
}

impl Formula {
    /// What it speaks of.
    pub(crate) fn symbols(&self) -> BTreeSet<Symbol> {
        fn visit(term: Term, seen: &mut BTreeSet<Term>, symbols: &mut BTreeSet<Symbol>) {
            if !seen.insert(term) {
                return;
            }
            if let Node::Symbol(symbol) = term.node() {
                symbols.insert(symbol);
            }
            for part in term.node().parts() {
                visit(part, seen, symbols);
            }
        }
        let (mut seen, mut symbols) = (BTreeSet::new(), BTreeSet::new());
        self.terms(&mut |term| visit(term, &mut seen, &mut symbols));
        symbols
    }

    fn terms(&self, visit: &mut impl FnMut(Term)) {
        match self {
            Self::Less(a, b) | Self::AtMost(a, b) | Self::Equal(a, b) => {
                visit(*a);
                visit(*b);
            }
            Self::All(parts) | Self::Any(parts) => parts.iter().for_each(|p| p.terms(visit)),
            Self::Not(part) => part.terms(visit),
        }
    }
}

/// What a solver is asked: `unsat` proves that the conclusion follows from the assumptions.
#[derive(Clone, Debug)]
pub struct Script {
    /// SMT-LIB 2, logic QF_NRA, ending in `(check-sat)`.
    pub text: String,
    /// The symbols of which a witness consists.
    pub(super) symbols: Vec<Symbol>,
}

impl Script {
    /// Does `conclusion` follow from `given`? What `of` says stands in front, as a comment. Of the terms in `opaque`
    /// nothing is told: what follows then follows whatever they are.
    pub(crate) fn new(of: &str, given: &[Formula], conclusion: &Formula, opaque: &[Term]) -> Self {
        let mut writer = Writer {
            opaque: opaque.iter().copied().collect(),
            ..Writer::default()
        };
        let _ = write!(writer.text, "; {of}\n(set-logic QF_NRA)\n");
        let denied = not(conclusion.clone());
        let asserted = || given.iter().chain([&denied]);
        for formula in asserted() {
            formula.terms(&mut |term| writer.count(term));
        }
        for formula in asserted() {
            let said = writer.formula(formula);
            let _ = writeln!(writer.text, "(assert {said})");
        }
        writer.text.push_str("(check-sat)\n");
        Self {
            text: writer.text,
            symbols: writer.symbols.into_values().collect(),
        }
    }
}

#[derive(Default)]
struct Writer {
    text: String,
    symbols: BTreeMap<&'static str, Symbol>,
    uses: BTreeMap<Term, u32>,
    said: BTreeMap<Term, String>,
    opaque: BTreeSet<Term>,
    declared: BTreeSet<&'static str>,
}

impl Writer {
    fn count(&mut self, term: Term) {
        let uses = self.uses.entry(term).or_default();
        *uses += 1;
        if *uses == 1 {
            term.node().parts().for_each(|part| self.count(part));
        }
    }

    fn formula(&mut self, formula: &Formula) -> String {
        match formula {
            Formula::Less(a, b) => self.operation("<", [*a, *b]),
            Formula::AtMost(a, b) => self.operation("<=", [*a, *b]),
            Formula::Equal(a, b) => self.operation("=", [*a, *b]),
            Formula::All(parts) => self.junction("and", "true", parts),
            Formula::Any(parts) => self.junction("or", "false", parts),
            Formula::Not(part) => format!("(not {})", self.formula(part)),
        }
    }

    fn junction(&mut self, word: &str, empty: &str, parts: &[Formula]) -> String {
        let parts: Vec<String> = parts.iter().map(|part| self.formula(part)).collect();
        match parts.as_slice() {
            [] => empty.to_owned(),
            [one] => one.clone(),
            _ => format!("({word} {})", parts.join(" ")),
        }
    }

    fn operation(&mut self, word: &str, terms: [Term; 2]) -> String {
        let [a, b] = terms.map(|term| self.term(term));
        format!("({word} {a} {b})")
    }

    /// The term as an expression; one that is used more than once gets a name first.
    fn term(&mut self, term: Term) -> String {
        if let Some(said) = self.said.get(&term) {
            return said.clone();
        }
        let said = match term.node() {
            _ if self.opaque.contains(&term) => self.opaque(),
            Node::Symbol(symbol) => self.symbol(symbol),
            Node::Constant(bits) => rational(f32::from_bits(bits)),
            Node::Add(a, b) => self.shared(term, "+", [a, b]),
            Node::Sub(a, b) => self.shared(term, "-", [a, b]),
            Node::Mul(a, b) => self.shared(term, "*", [a, b]),
            Node::Neg(a) => format!("(- {})", self.term(a)),
            Node::Min(a, b) => self.choice("min", "<=", [a, b]),
            Node::Max(a, b) => self.choice("max", ">=", [a, b]),
            Node::Div(a, b) => self.quotient(a, b),
            Node::Sqrt(a) => self.root(a),
        };
        self.said.insert(term, said.clone());
        said
    }

    fn symbol(&mut self, symbol: Symbol) -> String {
        self.symbols.insert(symbol.name, symbol);
        if self.declared.insert(symbol.name) {
            let (name, unit) = (symbol.name, symbol.unit);
            let _ = writeln!(self.text, "(declare-const {name} Real) ; {unit}");
        }
        symbol.name.to_owned()
    }

    fn name(&self, kind: &str) -> String {
        format!("{kind}!{}", self.said.len())
    }

    fn shared(&mut self, term: Term, word: &str, parts: [Term; 2]) -> String {
        let value = self.operation(word, parts);
        if self.uses.get(&term).is_none_or(|uses| *uses < 2) {
            return value;
        }
        self.defined("shared", &value)
    }

    fn defined(&mut self, kind: &str, value: &str) -> String {
        let name = self.name(kind);
        let _ = writeln!(self.text, "(define-fun {name} () Real {value})");
        name
    }

    fn choice(&mut self, kind: &str, word: &str, [a, b]: [Term; 2]) -> String {
        let [a, b] = [self.term(a), self.term(b)];
        self.defined(kind, &format!("(ite ({word} {a} {b}) {a} {b})"))
    }

    /// Nothing is said of a division by what is not positive: the margins have none.
    fn quotient(&mut self, a: Term, b: Term) -> String {
        let constant = matches!(b.node(), Node::Constant(_));
        let [a, b] = [self.term(a), self.term(b)];
        if constant {
            return format!("(/ {a} {b})");
        }
        self.fresh("quotient", |q| {
            format!("(=> (> {b} 0.0) (= (* {q} {b}) {a}))")
        })
    }

    /// Nothing is said of the root of what is negative: the margins have none.
    fn root(&mut self, a: Term) -> String {
        let a = self.term(a);
        self.fresh("root", |r| {
            format!("(=> (>= {a} 0.0) (and (>= {r} 0.0) (= (* {r} {r}) {a})))")
        })
    }

    fn opaque(&mut self) -> String {
        let name = self.name("opaque");
        let _ = writeln!(self.text, "(declare-const {name} Real)");
        name
    }

    fn fresh(&mut self, kind: &str, axiom: impl Fn(&str) -> String) -> String {
        let name = self.name(kind);
        let axiom = axiom(&name);
        let _ = writeln!(self.text, "(declare-const {name} Real)\n(assert {axiom})");
        name
    }
}

/// A finite `f32` exactly, not negative: an integer over a power of two.
pub(super) fn whole_over(value: f32) -> (f64, f64) {
    let magnitude = f64::from(value);
    let mut power = 1.0;
    // Exact: doubling changes the exponent alone.
    while (magnitude * power).fract() != 0.0 {
        power *= 2.0;
    }
    (magnitude * power, power)
}

/// A finite `f32` as solvers read it.
fn rational(value: f32) -> String {
    let (whole, over) = whole_over(value.abs());
    let size = match over == 1.0 {
        true => format!("{whole:.1}"),
        false => format!("(/ {whole:.1} {over:.1})"),
    };
    if value < 0.0 {
        format!("(- {size})")
    } else {
        size
    }
}
