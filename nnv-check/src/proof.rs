//! The tree of a branch and bound, as a record that others can check.

use std::fmt::Write as _;

/// How a region is cut in two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Split {
    /// Input at most `at`, then input at least `at`.
    Input {
        /// Which input.
        input: u32,
        /// Where.
        at: f64,
    },
    /// One of the conjunctions, then the others.
    Conjunction {
        /// Index of the one.
        index: u32,
    },
    /// Pre-activation of a ReLU ≥ 0, then ≤ 0.
    Phase {
        /// Which neuron, counted over all neurons that have an activation.
        neuron: u32,
    },
}

/// Why a region misses a conjunction: the bound of the weighted sum of its atoms is positive.
#[derive(Clone, Debug, PartialEq)]
pub struct Refutation {
    /// Index of the conjunction in the query.
    pub conjunction: u32,
    /// Weights ≥ 0 of its atoms.
    pub weights: Vec<f64>,
    /// Multipliers ≥ 0 of the assumed phases, by neuron.
    pub multipliers: Vec<(u32, f64)>,
    /// Lower slopes in [0, 1] of unstable neurons, where they are not the usual ones.
    pub slopes: Vec<(u32, f64)>,
    /// The bound that the prover found.
    pub bound: f64,
}

/// How a side of the range of a neuron's pre-activation is bounded.
#[derive(Clone, Debug, PartialEq)]
pub struct Tightening {
    /// Which neuron, counted over all neurons that have an activation.
    pub neuron: u32,
    /// Whether it is the upper side.
    pub upper: bool,
    /// Multipliers ≥ 0 of the assumed phases, by neuron.
    pub multipliers: Vec<(u32, f64)>,
    /// Lower slopes in [0, 1] of unstable neurons, where they are not the usual ones.
    pub slopes: Vec<(u32, f64)>,
}

/// One region of the tree.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cell {
    /// Whether the neurons keep the bounds of the larger region; else all are found anew.
    pub kept: bool,
    /// Bounds that are found then, in the order of the layers.
    pub tightened: Vec<Tightening>,
    /// What is refuted on the whole region.
    pub refuted: Vec<Refutation>,
    /// Whether the assumed phases contradict each other here.
    pub empty: bool,
    /// How the region goes on, if anything is left, and the index of the first of two children.
    pub split: Option<(Split, u32)>,
}

/// The tree of one query; the root is cell 0, and children stand behind their parents.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Proof {
    /// The regions.
    pub cells: Vec<Cell>,
}

/// A certificate that cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {what}")]
#[non_exhaustive]
pub struct ProofError {
    /// Line of the text, from 1.
    pub line: usize,
    /// What is wrong.
    pub what: &'static str,
}

impl Proof {
    /// The proof as lines of text, children after their parent, the first one first: `k` (kept);
    /// `t` neuron side | multipliers | slopes; `r` conjunction bound weights | multipliers | slopes; `e` (empty); then `x` input at,
    /// `z` neuron, `c` conjunction, or `l` (leaf).
    #[must_use]
    pub fn to_text(&self) -> String {
        let mut text = String::new();
        let mut stack = vec![0];
        while let Some(cell) = stack.pop().and_then(|i: usize| self.cells.get(i)) {
            let pairs = |pairs: &[(u32, f64)]| {
                pairs
                    .iter()
                    .map(|(n, v)| format!(" {n}:{v:?}"))
                    .collect::<String>()
            };
            if cell.kept {
                text.push_str("k\n");
            }
            for t in &cell.tightened {
                let side = if t.upper { "upper" } else { "lower" };
                let (multipliers, slopes) = (pairs(&t.multipliers), pairs(&t.slopes));
                let _ = writeln!(text, "t {} {side} |{multipliers} |{slopes}", t.neuron);
            }
            for r in &cell.refuted {
                let weights: String = r.weights.iter().map(|w| format!(" {w:?}")).collect();
                // Writing to a string cannot fail.
                let _ = writeln!(
                    text,
                    "r {} {:?}{weights} |{} |{}",
                    r.conjunction,
                    r.bound,
                    pairs(&r.multipliers),
                    pairs(&r.slopes)
                );
            }
            if cell.empty {
                text.push_str("e\n");
            }
            let _ = match cell.split {
                Some((Split::Input { input, at }, _)) => writeln!(text, "x {input} {at:?}"),
                Some((Split::Conjunction { index }, _)) => writeln!(text, "c {index}"),
                Some((Split::Phase { neuron }, _)) => writeln!(text, "z {neuron}"),
                None => writeln!(text, "l"),
            };
            if let Some((_, first)) = cell.split {
                stack.extend([first as usize + 1, first as usize]);
            }
        }
        text
    }

    /// Reads one proof from numbered lines, and stops behind its last leaf.
    ///
    /// # Errors
    /// With the line, if the text is not what [`Self::to_text`] writes.
    pub fn from_lines<'a>(
        lines: &mut impl Iterator<Item = (usize, &'a str)>,
    ) -> Result<Self, ProofError> {
        let mut cells = vec![Cell::default()];
        let mut stack = vec![0_usize];
        while let Some(&index) = stack.last() {
            let (line, text) = lines.next().ok_or(ProofError {
                line: 0,
                what: "the proof ends before its last leaf",
            })?;
            let fault = |what| ProofError { line, what };
            let mut words = text.split_whitespace();
            match words.next() {
                Some("k") => cells[index].kept = true,
                Some("t") => cells[index].tightened.push(tightening(words, line)?),
                Some("r") => cells[index].refuted.push(refutation(words, line)?),
                Some("e") => cells[index].empty = true,
                Some("l") => {
                    stack.pop();
                }
                Some(kind @ ("c" | "x" | "z")) => {
                    let which = words
                        .next()
                        .and_then(|w| w.parse().ok())
                        .ok_or(fault("no index"))?;
                    let split = match kind {
                        "c" => Split::Conjunction { index: which },
                        "z" => Split::Phase { neuron: which },
                        _ => {
                            let at = words
                                .next()
                                .and_then(number)
                                .ok_or(fault("no finite place to split at"))?;
                            Split::Input { input: which, at }
                        }
                    };
                    let first =
                        u32::try_from(cells.len()).map_err(|_| fault("too many regions"))?;
                    cells[index].split = Some((split, first));
                    cells.extend([Cell::default(), Cell::default()]);
                    stack.pop();
                    stack.extend([first as usize + 1, first as usize]);
                }
                _ => return Err(fault("expected k, t, r, e, c, x, z or l")),
            }
        }
        Ok(Self { cells })
    }
}

fn number(word: &str) -> Option<f64> {
    word.parse().ok().filter(|v: &f64| v.is_finite())
}

/// The words of a line by its parts: head, multipliers, slopes.
type Parts<'a> = (Vec<&'a str>, Vec<(u32, f64)>, Vec<(u32, f64)>);

fn parts<'a>(words: impl Iterator<Item = &'a str>, line: usize) -> Result<Parts<'a>, ProofError> {
    let fault = |what| ProofError { line, what };
    let mut parts = [const { Vec::new() }; 3];
    let mut part = 0;
    for word in words {
        match (word, parts.get_mut(part)) {
            ("|", _) => part += 1,
            (word, Some(words)) => words.push(word),
            (_, None) => return Err(fault("too many parts")),
        }
    }
    let pairs = |words: Vec<&str>| {
        let pair = |word: &str| {
            let (neuron, value) = word.split_once(':')?;
            Some((neuron.parse().ok()?, number(value)?))
        };
        words
            .into_iter()
            .map(pair)
            .collect::<Option<Vec<_>>>()
            .ok_or(fault("expected neuron:value"))
    };
    let [head, multipliers, slopes] = parts;
    Ok((head, pairs(multipliers)?, pairs(slopes)?))
}

fn tightening<'a>(
    words: impl Iterator<Item = &'a str>,
    line: usize,
) -> Result<Tightening, ProofError> {
    let fault = |what| ProofError { line, what };
    let (head, multipliers, slopes) = parts(words, line)?;
    let [neuron, side @ ("lower" | "upper")] = head[..] else {
        return Err(fault("expected a neuron, and lower or upper"));
    };
    Ok(Tightening {
        neuron: neuron.parse().map_err(|_| fault("no index of a neuron"))?,
        upper: side == "upper",
        multipliers,
        slopes,
    })
}

fn refutation<'a>(
    words: impl Iterator<Item = &'a str>,
    line: usize,
) -> Result<Refutation, ProofError> {
    let fault = |what| ProofError { line, what };
    let (head, multipliers, slopes) = parts(words, line)?;
    let [conjunction, bound, weights @ ..] = head.as_slice() else {
        return Err(fault("expected a conjunction and a bound"));
    };
    Ok(Refutation {
        conjunction: conjunction
            .parse()
            .map_err(|_| fault("no index of a conjunction"))?,
        bound: number(bound).ok_or(fault("the bound is not a number"))?,
        weights: weights
            .iter()
            .map(|w| number(w))
            .collect::<Option<_>>()
            .ok_or(fault("a weight is not a number"))?,
        multipliers,
        slopes,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn example() -> Proof {
        let leaf = |bound| Cell {
            refuted: vec![Refutation {
                conjunction: 1,
                weights: vec![0.25, 0.75],
                multipliers: vec![(7, 0.5)],
                slopes: vec![(3, 0.125), (9, 1.0)],
                bound,
            }],
            ..Cell::default()
        };
        let tightening = Tightening {
            neuron: 4,
            upper: true,
            multipliers: vec![(2, 0.5)],
            slopes: vec![(1, 0.25)],
        };
        let root = Cell {
            tightened: vec![tightening],
            split: Some((Split::Input { input: 2, at: -0.1 }, 1)),
            ..Cell::default()
        };
        let others = Cell {
            kept: true,
            split: Some((Split::Conjunction { index: 1 }, 5)),
            ..Cell::default()
        };
        let inner = Cell {
            split: Some((Split::Phase { neuron: 7 }, 3)),
            ..leaf(0.5)
        };
        let empty = Cell {
            empty: true,
            ..Cell::default()
        };
        Proof {
            cells: vec![
                root,
                inner,
                others,
                leaf(1e300),
                empty,
                leaf(1.0),
                leaf(1e-3),
            ],
        }
    }

    #[test]
    fn a_proof_survives_its_text() {
        let text = example().to_text();
        let read = Proof::from_lines(&mut text.lines().enumerate());
        assert_eq!(read.as_ref().map(Proof::to_text), Ok(text));
        assert_eq!(read.map(|p| p.cells.len()), Ok(7));
    }

    proptest! {
        #[test]
        fn a_damaged_text_is_read_or_refused(at in 0_usize..300, with in "[ktrecxzl0-9.:| \n-]{0,4}") {
            let mut text = example().to_text();
            let at = at.min(text.len() - 1);
            text.replace_range(at..=at, &with);
            let _ = Proof::from_lines(&mut text.lines().enumerate());
        }
    }
}
