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
    /// A word with something in brackets behind it.
    Element(&'a str, &'a str, Place),
    List(Vec<Sexp<'a>>, Place),
}

impl Sexp<'_> {
    /// Its word, or the beginning of a long one; empty of a list.
    pub(super) fn word(&self) -> String {
        match self {
            Self::Word(word, _) | Self::Element(word, _, _) => format!("{word:.80}"),
            Self::List(..) => String::new(),
        }
    }

    /// Where it starts.
    pub(super) fn place(&self) -> Place {
        match self {
            Self::Word(_, place) | Self::Element(_, _, place) | Self::List(_, place) => *place,
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
                b'[' => {
                    let end = rest.find(']').ok_or_else(|| {
                        place.error("a '[' that is not closed in its line".to_owned())
                    })?;
                    let last = open.last_mut().and_then(|outer| outer.0.last_mut());
                    let Some(Sexp::Word(word, at)) = last.as_deref() else {
                        return Err(place.error("a '[' that follows no word".to_owned()));
                    };
                    let element = Sexp::Element(word, &rest[1..end], *at);
                    if let Some(last) = last {
                        *last = element;
                    }
                    end + 1
                }
                b'"' => {
                    let end = rest[1..].find('"').ok_or_else(|| {
                        place.error("a '\"' that is not closed in its line".to_owned())
                    })?;
                    if let Some(outer) = open.last_mut() {
                        outer.0.push(Sexp::Word(&rest[..end + 2], place));
                    }
                    end + 2
                }
                _ => {
                    let end = rest
                        .find(|c: char| c.is_whitespace() || matches!(c, '(' | ')' | '['))
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
