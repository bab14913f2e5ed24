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
