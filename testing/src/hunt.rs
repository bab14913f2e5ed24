//! Looks for a case that fails, and for a simpler one that fails as well.

use crate::run::{Miss, Verdict};
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Cases that are tried to make a failing one simpler, at most.
const SIMPLER: u32 = 3000;

/// What became of the cases of a check.
#[derive(Clone, Debug)]
pub(crate) struct Catch<T> {
    /// Cases that were judged.
    pub(crate) judged: u32,
    /// Cases that did not count.
    pub(crate) skipped: u32,
    /// Why most of them did not count.
    pub(crate) why: Option<String>,
    /// The simplest case that fails, and why it does.
    pub(crate) failure: Option<(T, String)>,
}

/// Runs `test` on up to `cases` values that count, drawn from `seed` for the check `id`.
///
/// A panic is a failure.
pub(crate) fn hunt<S: Strategy>(
    (id, seed, cases): (&str, u64, u32),
    strategy: &S,
    test: impl Fn(&S::Value) -> Verdict,
) -> Catch<S::Value> {
    let mut runner = runner(id, seed);
    let mut whys: BTreeMap<String, u32> = BTreeMap::new();
    let mut caught = Catch {
        judged: 0,
        skipped: 0,
        why: None,
        failure: None,
    };
    while caught.judged < cases && caught.skipped < 20 * cases {
        let Ok(mut tree) = strategy.new_tree(&mut runner) else {
            caught.skipped += 1;
            continue;
        };
        match guarded(&test, &tree.current()) {
            Ok(()) => caught.judged += 1,
            Err(Miss::Skip(why)) => {
                caught.skipped += 1;
                *whys.entry(without_numbers(&why)).or_default() += 1;
            }
            Err(Miss::Broken(what)) => {
                caught.judged += 1;
                caught.failure = Some(simplest(&mut tree, &test, what));
                break;
            }
        }
    }
    caught.why = whys
        .into_iter()
        .max_by_key(|(_, count)| *count)
        .map(|(why, _)| why);
    caught
}

/// The simplest value that still fails.
fn simplest<T: ValueTree>(
    tree: &mut T,
    test: &impl Fn(&T::Value) -> Verdict,
    what: String,
) -> (T::Value, String) {
    let mut best = (tree.current(), what);
    let mut more = tree.simplify();
    for _ in 0..SIMPLER {
        if !more {
            break;
        }
        let value = tree.current();
        more = match guarded(test, &value) {
            Err(Miss::Broken(what)) => {
                best = (value, what);
                tree.simplify()
            }
            _ => tree.complicate(),
        };
    }
    best
}

/// The verdict on `value`; a panic breaks the check.
fn guarded<T>(test: &impl Fn(&T) -> Verdict, value: &T) -> Verdict {
    catch_unwind(AssertUnwindSafe(|| test(value))).unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<&str>().map(ToString::to_string);
        let text = text.or_else(|| panic.downcast_ref::<String>().cloned());
        Err(Miss::Broken(format!(
            "panicked: {}",
            text.unwrap_or_default()
        )))
    })
}

/// The same reason for all numbers.
fn without_numbers(why: &str) -> String {
    let mut text = String::new();
    for c in why.chars() {
        let digit = c.is_ascii_digit() || (c == '.' && text.ends_with('#'));
        match digit {
            true if text.ends_with('#') => {}
            true => text.push('#'),
            false => text.push(c),
        }
    }
    text
}

/// A source of values for the check `id`: those of one check do not depend on which others run.
pub(crate) fn runner(id: &str, seed: u64) -> TestRunner {
    let mut bytes = [0; 32];
    bytes[..8].copy_from_slice(&seed.to_le_bytes());
    for (i, byte) in id.bytes().enumerate() {
        bytes[8 + i % 24] ^= byte.rotate_left((i / 24) as u32);
    }
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &bytes);
    let config = Config {
        failure_persistence: None,
        ..Config::default()
    };
    TestRunner::new_with_rng(config, rng)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_simplest_failing_value_is_found() {
        let found = hunt(("id", 1, 1000), &(0_u32..1000), |x| {
            if *x >= 77 {
                Err(Miss::broken(x))
            } else {
                Ok(())
            }
        });
        assert_eq!(found.failure, Some((77, "77".to_owned())));
    }

    #[test]
    fn a_panic_fails_and_what_does_not_count_is_counted() {
        let found = hunt(("id", 1, 10), &(0_u32..1000), |_| panic!("no {}", 7));
        assert_eq!(found.failure.unwrap().1, "panicked: no 7");
        let found = hunt(("id", 1, 10), &(0_u32..1000), |x| {
            Err(Miss::skip(format!("{x}.5 m")))
        });
        assert_eq!((found.judged, found.skipped), (0, 200));
        assert_eq!(found.why.unwrap(), "# m");
    }

    #[test]
    fn the_same_seed_gives_the_same_values() {
        let values = |id, seed| {
            let seen = std::cell::RefCell::new(Vec::new());
            hunt((id, seed, 5), &(0_u32..1000), |x| {
                seen.borrow_mut().push(*x);
                Ok(())
            });
            seen.into_inner()
        };
        assert_eq!(values("a", 1), values("a", 1));
        assert_ne!(values("a", 1), values("a", 2));
        assert_ne!(values("a", 1), values("b", 1));
    }
}
