//! How two routes can meet, and who may go first where they do.

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

/// Who may go first, by the rules of the road and the order of arrival.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum RightOfWay {
    /// The ego.
    Ego,
    /// The other.
    Other,
    /// Not settled, or not known.
    #[default]
    Unsettled,
}
