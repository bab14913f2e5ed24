//! What a desk can be asked.

/// A question. Lengths in m, speeds in m/s, accelerations in m/s², times in s; numbers are `f32` bits, and what is
/// counted or chosen is a whole word. A vehicle is `s, speed, x, y, direction x, direction y`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Call {
    /// `class, length, width, points, x, y, x, y, …`: adds a path. The ego's is the first one. Class: 0 car, 1 lorry,
    /// 2 bicycle.
    Path = 0,
    /// `first, second, priority`: vehicles of path `first` have the right of way over those of path `second`. Priority: `0`
    /// if both arrive at once, `1` whoever arrives first, without signs, `2` the same by signs.
    RightOfWay = 1,
    /// Builds the junction.
    Build = 2,
    /// `0` worst case, `1` all-way stop. Gives the numbers that [`Call::Contract`] takes.
    Named = 3,
    /// The contract's numbers in the order of [`Call::Named`]; see `src/contract.rs`.
    Contract = 4,
    /// Begins to drive.
    Enter = 5,
    /// `microseconds low, high, ego, tracks`, and for each track `number, class, path, vehicle`. Gives the words of
    /// the decision (`cede_golden::answer`), the policy's proposal, and for each acceleration of the shield's grid
    /// `acceleration, 1 if it is accepted, margin`.
    Decide = 6,
    /// The plan of the last decision, if there is one: the arc length at which the ego is at rest at the latest,
    /// and the arc lengths that it nominally reaches period by period.
    Plan = 7,
    /// The last decision, or why the last call was refused: the number of bytes, and UTF-8.
    Text = 8,
    /// `path, other`: their zones, path's vehicle as the ego: `kind, ego from, to, other from, to, lead from, to` for
    /// each. Kind: 0 crossing, 1 merging, 2 following.
    Zones = 9,
    /// `s, speed, time`: the arc lengths between which an other is `time` later: `from, to`.
    Reach = 10,
    /// `path, s`: `x, y, direction x, direction y`.
    Pose = 11,
    /// `path`: its length and its line.
    Line = 12,
    /// Twice `x, y, direction x, direction y, length, width`: the gap between the rectangles; negative if they overlap.
    Gap = 13,
    /// `number`: the track is known to be gone.
    Forget = 14,
    /// `path, s`: where vehicles of the path wait.
    SetLine = 15,
}

impl Call {
    const ALL: [Self; 16] = [
        Self::Path,
        Self::RightOfWay,
        Self::Build,
        Self::Named,
        Self::Contract,
        Self::Enter,
        Self::Decide,
        Self::Plan,
        Self::Text,
        Self::Zones,
        Self::Reach,
        Self::Pose,
        Self::Line,
        Self::Gap,
        Self::Forget,
        Self::SetLine,
    ];

    /// The call with this number.
    #[must_use]
    pub fn new(number: u32) -> Option<Self> {
        Self::ALL.into_iter().find(|call| *call as u32 == number)
    }
}
