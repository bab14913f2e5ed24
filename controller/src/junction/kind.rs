//! In which way two routes meet.

/// How two routes conflict.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ConflictKind {
    /// The routes cross and part again: a bounded zone on each.
    Crossing,
    /// The routes run into one lane: from the merge on they share it.
    Merging,
    /// The routes share a lane from the start: one vehicle is behind the other.
    Following,
    /// The footprints cannot touch, wherever the vehicles are on their routes.
    #[default]
    None,
}
