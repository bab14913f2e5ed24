//! A number with its noun.

use std::fmt;

/// Prints as `1 recording`, `2 recordings`.
pub(crate) struct Count(pub(crate) usize, pub(crate) &'static str);

impl fmt::Display for Count {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(n, noun) = self;
        let ending = if *n == 1 { "" } else { "s" };
        write!(f, "{n} {noun}{ending}")
    }
}

#[cfg(test)]
mod tests {
    use super::Count;

    #[test]
    fn one_is_singular() {
        let said = [0, 1, 2].map(|n| Count(n, "recording").to_string());
        assert_eq!(said, ["0 recordings", "1 recording", "2 recordings"]);
    }
}
