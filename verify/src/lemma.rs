//! The steps of the shield's theorem (`docs/theorem.md`) as lemmas over the reals, for an SMT solver.
//!
//! The shield's margins are generic over their numbers. Here they run on expressions, so what the
//! solver is asked about is the code that flies, of a contract whose numbers are names: a lemma
//! holds for every contract in its range. How vehicles really move is written down beside it.
//! Every lemma is also asked with a broken rule, and must then fail.

mod apart;
mod coast;
mod contract;
mod departure;
mod entry;
mod formula;
mod limit;
mod motion;
mod reach;
mod rocq;
mod symbol;
mod tail;
mod term;
#[cfg(test)]
mod tests;
mod z3;

use formula::Formula;
pub use formula::Script;
pub use rocq::shipped;
use std::collections::BTreeSet;
use std::time::{Duration, Instant};
use term::Term;
pub use z3::{Answer, Quantity, Solver, SolverError, abandon};

/// A step of the theorem.
#[derive(Clone, Debug)]
pub struct Lemma {
    /// Its name in `docs/theorem.md`.
    pub id: &'static str,
    /// What it says, in a line.
    pub says: &'static str,
    /// Of what, in a line.
    pub given: &'static str,
    /// It is proved if the answer is `unsat`.
    pub claim: Script,
    /// The same with a broken rule.
    pub broken: Broken,
}

/// A lemma that must not hold.
#[derive(Clone, Debug)]
pub struct Broken {
    /// What is broken.
    pub what: &'static str,
    /// It is caught if the answer is `sat`.
    pub claim: Script,
}

/// A claim before it is written out.
struct Claim {
    given: Vec<Formula>,
    conclusion: Formula,
    opaque: Vec<Term>,
}

impl Claim {
    fn new(given: impl IntoIterator<Item = Formula>, conclusion: Formula) -> Self {
        Self {
            given: given.into_iter().collect(),
            conclusion,
            opaque: Vec::new(),
        }
    }

    /// Without telling the solver anything of these terms: what it proves holds whatever they are.
    fn whatever(self, opaque: Vec<Term>) -> Self {
        Self { opaque, ..self }
    }

    fn script(&self, title: &str) -> Script {
        Script::new(title, &self.all_given(), &self.conclusion, &self.opaque)
    }

    /// For a witness, of which everything must be true.
    fn script_of_all(&self, title: &str) -> Script {
        Script::new(title, &self.all_given(), &self.conclusion, &[])
    }

    /// With what a contract demands of those of its numbers that the claim speaks of.
    fn all_given(&self) -> Vec<Formula> {
        let said = self.given.iter().chain([&self.conclusion]);
        let symbols: BTreeSet<_> = said.flat_map(Formula::symbols).collect();
        let assumed = contract::assumed().into_iter();
        let relevant = assumed.filter(|formula| formula.symbols().is_subset(&symbols));
        self.given.iter().cloned().chain(relevant).collect()
    }
}

impl Lemma {
    fn new(
        [id, says, given]: [&'static str; 3],
        claim: &Claim,
        (what, broken): (&'static str, &Claim),
    ) -> Self {
        Self {
            id,
            says,
            given,
            claim: claim.script(&format!("{id}: {says}\n; given: {given}")),
            broken: Broken {
                what,
                claim: broken
                    .script_of_all(&format!("{id}: {says}\n; given: {given}\n; broken: {what}")),
            },
        }
    }

    /// Asks `solver`, for at most `limit` each time.
    ///
    /// # Errors
    /// If the solver does not start.
    pub fn settle(&self, solver: &Solver, limit: Duration) -> Result<Settled, SolverError> {
        let began = Instant::now();
        let answer = solver.ask(&self.claim, limit)?;
        let time = began.elapsed();
        let broken = solver.ask(&self.broken.claim, limit)?;
        Ok(Settled {
            answer,
            broken,
            time,
        })
    }
}

/// What came of a lemma.
#[derive(Clone, Debug)]
pub struct Settled {
    /// [`Answer::Unsat`] if it is proved.
    pub answer: Answer,
    /// The same with the broken rule: [`Answer::Sat`] if that is caught.
    pub broken: Answer,
    /// How long the lemma took, without the broken one.
    pub time: Duration,
}

impl Settled {
    /// Whether the lemma holds, and would not if its rule were broken.
    #[must_use]
    pub fn proved(&self) -> bool {
        self.answer == Answer::Unsat && matches!(self.broken, Answer::Sat(_))
    }
}

/// Every lemma, in the theorem's order.
///
/// Cost: milliseconds; nothing is asked yet.
#[must_use]
pub fn lemmas() -> Vec<Lemma> {
    let groups = [
        reach::lemmas(),
        departure::lemmas(),
        tail::lemmas(),
        apart::lemmas(),
        entry::lemmas(),
        limit::lemmas(),
        coast::lemmas(),
        limit::unlimited_lemmas(),
    ];
    groups.into_iter().flatten().collect()
}
