//! The occupied polygons that hang together become one.

use super::cell::Cell;
use super::patch::Patch;
use super::{FAR, MAX_ZONES};

/// Whether nothing that is occupied in the cell would change the patches: one covers it, and no other
/// one touches it.
pub(super) fn covered(patches: &[Option<Patch>; MAX_ZONES], cell: &Cell) -> bool {
    let touches = |patch: &&Patch| {
        patch.mixed == cell.opposite
            && patch.ego.touches(cell.ego)
            && patch.other.touches(cell.other)
    };
    let mut touching = patches.iter().flatten().filter(touches);
    touching.next().is_some_and(|patch| patch.covers(cell)) && touching.next().is_none()
}

/// Adds a patch, or widens those that it touches: what hangs together ends up in one. Without room, the two that make the
/// least of a larger one do, too.
pub(super) fn insert(patches: &mut [Option<Patch>; MAX_ZONES], patch: Patch) {
    // Most routes have one patch, and widen it.
    if let [Some(only), None, None] = patches
        && only.touches(&patch)
    {
        only.absorb(&patch);
        return;
    }
    let mut patch = hanging_together(patches, patch);
    // Each round empties a slot, or puts the patch into one.
    for _ in 0..MAX_ZONES {
        if let Some(slot) = patches.iter_mut().find(|slot| slot.is_none()) {
            *slot = Some(patch);
            return;
        }
        patch = joined(patches, patch);
        patch = hanging_together(patches, patch);
    }
}

/// The patch with those that it touches, which are taken out.
fn hanging_together(patches: &mut [Option<Patch>], mut patch: Patch) -> Patch {
    let touched = |patches: &mut [Option<Patch>], patch: &Patch| {
        patches
            .iter_mut()
            .find(|slot| slot.as_ref().is_some_and(|met| met.touches(patch)))
            .and_then(Option::take)
    };
    // Each round empties a slot. The wider patch may touch one that was passed over.
    while let Some(met) = touched(patches, &patch) {
        patch.absorb(&met);
    }
    patch
}

/// Makes one of two: of the patch and of those that fill all slots. It is taken out.
fn joined(patches: &mut [Option<Patch>], patch: Patch) -> Patch {
    let mut least = (FAR, 0, None);
    for (i, a) in patches.iter().enumerate() {
        let Some(a) = a else { continue };
        let others = patches.iter().enumerate().skip(i + 1);
        let others = others.filter_map(|(j, b)| Some((Some(j), (*b)?)));
        for (j, b) in others.chain([(None, patch)]) {
            let growth = a.growth(&b);
            if growth < least.0 {
                least = (growth, i, j);
            }
        }
    }
    let (_, i, j) = least;
    let taken = |patches: &mut [Option<Patch>], i: usize| patches.get_mut(i).and_then(Option::take);
    let mut whole = taken(patches, i).unwrap_or(patch);
    match j {
        // The patch itself gets the slot that is free now.
        Some(j) => {
            if let Some(other) = taken(patches, j) {
                whole.absorb(&other);
            }
            if let Some(slot) = patches.iter_mut().find(|slot| slot.is_none()) {
                *slot = Some(patch);
            }
        }
        None => whole.absorb(&patch),
    }
    whole.mixed = true;
    whole
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::junction::zone::Span;

    fn span(from: f32, to: f32) -> Span {
        Span { from, to }
    }

    /// Occupied from `from` to `to`, by the ego and by the other.
    fn square(from: f32, to: f32) -> Patch {
        Patch {
            ego: span(from, to),
            other: span(from, to),
            lead: span(-9.0, 9.0),
            parallel: None,
            starts: false,
            ends: false,
            mixed: false,
        }
    }

    #[test]
    fn a_cell_is_covered_by_the_only_patch_that_it_touches() {
        let cell = |from, to, opposite| Cell {
            ego: span(from, to),
            other: span(from, to),
            lead: span(-1.0, 1.0),
            parallel: false,
            opposite,
            end: false,
        };
        let one = [Some(square(0.0, 10.0)), None, None];
        assert!(covered(&one, &cell(2.0, 8.0, false)));
        assert!(
            !covered(&one, &cell(2.0, 12.0, false)) && !covered(&one, &cell(20.0, 22.0, false))
        );
        assert!(!covered(&one, &cell(2.0, 8.0, true)), "they meet head-on");
        // Another one that it does not touch, or only in one of the two.
        let beside = Patch {
            ego: span(20.0, 30.0),
            ..square(0.0, 10.0)
        };
        for other in [square(20.0, 30.0), beside] {
            let two = [Some(square(0.0, 10.0)), Some(other), None];
            assert!(covered(&two, &cell(2.0, 8.0, false)));
        }
        let two = [Some(square(0.0, 10.0)), Some(square(7.0, 17.0)), None];
        assert!(
            !covered(&two, &cell(2.0, 8.0, false)),
            "both hang together in it"
        );
    }

    /// What is occupied after a fourth patch is inserted.
    fn with_a_fourth(patches: [Patch; MAX_ZONES], patch: Patch) -> std::vec::Vec<(f32, f32, bool)> {
        let mut patches = patches.map(Some);
        insert(&mut patches, patch);
        let mut all: std::vec::Vec<_> = (patches.iter().flatten())
            .map(|it| (it.ego.from, it.ego.to, it.mixed))
            .collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        all
    }

    #[test]
    fn without_room_the_two_become_one_that_grow_least_and_of_equals_the_first() {
        let [a, b, c] = [square(0.0, 4.0), square(20.0, 24.0), square(40.0, 44.0)];
        assert_eq!(
            with_a_fourth([a, b, c], square(50.0, 54.0)),
            [(0.0, 4.0, false), (20.0, 24.0, false), (40.0, 54.0, true)]
        );
        assert_eq!(
            with_a_fourth([a, square(10.0, 14.0), c], square(90.0, 94.0)),
            [(0.0, 14.0, true), (40.0, 44.0, false), (90.0, 94.0, false)]
        );
        assert_eq!(
            with_a_fourth([a, b, c], square(90.0, 94.0)),
            [(0.0, 24.0, true), (40.0, 44.0, false), (90.0, 94.0, false)]
        );
    }
}
