//! Who is who in an encounter, and what each does there.

/// Which of the two judged vehicles; `role as usize` is its index in [`crate::Encounter::participants`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Role {
    /// The left-turner (in generic encounters: the vehicle that has to give way).
    Left = 0,
    /// The vehicle that it meets.
    Other = 1,
}

impl Role {
    /// Both, in the order of [`crate::Encounter::participants`].
    pub const BOTH: [Self; 2] = [Self::Left, Self::Other];
}

/// What a vehicle does at the intersection.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Manoeuvre {
    /// Turns left: heading changes by +50° to +130°.
    Left,
    /// Goes straight on: heading changes by less than 40°.
    Straight,
    /// Turns right: heading changes by −50° to −130°.
    Right,
    /// Anything else (a U-turn, a track that begins or ends in the middle).
    Unknown,
}
