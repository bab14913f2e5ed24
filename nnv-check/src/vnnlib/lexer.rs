//! S-expressions with their places in the text.

use super::VnnlibError;

/// A place in the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place {
    line: usize,
    column: usize,
}

impl Place {
    /// An error at this place.
    pub(super) fn error(self, what: String) -> VnnlibError {
        VnnlibError {
            line: self.line,
            column: self.column,
            what,
        }
    }
}

/// An S-expression.
#[derive(Clone, Debug)]
pub(super) enum Sexp<'a> {
    Word(&'a str, Place),
    List(Vec<Sexp<'a>>, Place),
}

impl Sexp<'_> {
    /// Where it starts.
    pub(super) fn place(&self) -> Place {
        match self {
            Self::Word(_, place) | Self::List(_, place) => *place,
        }
    }
}

/// The deepest nesting; beyond it a hostile file could exhaust the stack of whoever walks it.
const DEEPEST: usize = 100;

/// All top-level expressions of the text.
pub(super) fn parse(text: &str) -> Result<Vec<Sexp<'_>>, VnnlibError> {
    let mut open: Vec<(Vec<Sexp<'_>>, Place)> = vec![(Vec::new(), Place { line: 1, column: 1 })];
    for (index, line) in text.lines().enumerate() {
        let code = line.split(';').next().unwrap_or_default();
        let mut rest = code;
        while let Some(start) = rest.find(|c: char| !c.is_whitespace()) {
            rest = &rest[start..];
            let place = Place {
                line: index + 1,
                column: code.len() - rest.len() + 1,
            };
            let length = match rest.as_bytes()[0] {
                b'(' => {
                    if open.len() > DEEPEST {
                        return Err(place.error(format!("nested deeper than {DEEPEST} levels")));
                    }
                    open.push((Vec::new(), place));
                    1
                }
                b')' => {
                    if open.len() == 1 {
                        return Err(place.error("a ')' that closes nothing".to_owned()));
                    }
                    if let (Some((items, start)), Some(outer)) = (open.pop(), open.last_mut()) {
                        outer.0.push(Sexp::List(items, start));
                    }
                    1
                }
                _ => {
                    let end = rest
                        .find(|c: char| c.is_whitespace() || c == '(' || c == ')')
                        .unwrap_or(rest.len());
                    if let Some(outer) = open.last_mut() {
                        outer.0.push(Sexp::Word(&rest[..end], place));
                    }
                    end
                }
            };
            rest = &rest[length..];
        }
    }
    match (open.pop(), open.is_empty()) {
        (Some((items, _)), true) => Ok(items),
        (Some((_, place)), false) => Err(place.error("a '(' that is never closed".to_owned())),
        (None, _) => Ok(Vec::new()),
    }
}
