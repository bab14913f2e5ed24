//! A number that is not known: what the shield's own functions make of it is an expression.

use super::symbol::{Symbol, stands_for};
use cede_controller::Real;
use std::cell::RefCell;
use std::collections::HashMap;
use std::marker::PhantomData;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// How a term came about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Node {
    Symbol(Symbol),
    /// The bits of a finite `f32`.
    Constant(u32),
    Add(Term, Term),
    Sub(Term, Term),
    Mul(Term, Term),
    Div(Term, Term),
    Neg(Term),
    Sqrt(Term),
    Min(Term, Term),
    Max(Term, Term),
}

impl Node {
    /// The terms that it is made of.
    pub(crate) fn parts(self) -> impl Iterator<Item = Term> {
        let parts = match self {
            Self::Symbol(_) | Self::Constant(_) => [None, None],
            Self::Neg(a) | Self::Sqrt(a) => [Some(a), None],
            Self::Add(a, b)
            | Self::Sub(a, b)
            | Self::Mul(a, b)
            | Self::Div(a, b)
            | Self::Min(a, b)
            | Self::Max(a, b) => [Some(a), Some(b)],
        };
        parts.into_iter().flatten()
    }
}

#[derive(Default)]
struct Arena {
    nodes: Vec<Node>,
    known: HashMap<Node, u32>,
}

thread_local! {
    // `Real::of` has nothing but a number to work with, so the expressions' home cannot be an argument.
    static ARENA: RefCell<Arena> = RefCell::default();
}

/// A real number as an expression of [`Symbol`]s; equal expressions are one term.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct Term {
    index: u32,
    // It means something only in the thread that made it.
    local: PhantomData<*const ()>,
}

impl Term {
    pub(crate) fn symbol(name: &'static str, unit: &'static str) -> Self {
        Self::new(Node::Symbol(Symbol { name, unit }))
    }

    /// How it came about.
    pub(crate) fn node(self) -> Node {
        ARENA.with_borrow(|arena| arena.nodes[self.index as usize])
    }

    fn new(node: Node) -> Self {
        let index = ARENA.with_borrow_mut(|Arena { nodes, known }| {
            *known.entry(node).or_insert_with(|| {
                nodes.push(node);
                u32::try_from(nodes.len() - 1).expect("fewer terms than 2³²")
            })
        });
        Self {
            index,
            local: PhantomData,
        }
    }
}

impl Real for Term {
    /// The number; the contract's symbol, if it is the stand-in of one.
    fn of(value: f32) -> Self {
        match stands_for(value) {
            Some(symbol) => Self::new(Node::Symbol(symbol)),
            None => Self::new(Node::Constant(value.to_bits())),
        }
    }

    fn sqrt(self) -> Self {
        Self::new(Node::Sqrt(self))
    }

    fn min(self, other: Self) -> Self {
        Self::new(Node::Min(self, other))
    }

    fn max(self, other: Self) -> Self {
        Self::new(Node::Max(self, other))
    }
}

impl Add for Term {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::new(Node::Add(self, other))
    }
}

impl Sub for Term {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::new(Node::Sub(self, other))
    }
}

impl Mul for Term {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self::new(Node::Mul(self, other))
    }
}

impl Div for Term {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        Self::new(Node::Div(self, other))
    }
}

impl Neg for Term {
    type Output = Self;
    fn neg(self) -> Self {
        Self::new(Node::Neg(self))
    }
}
