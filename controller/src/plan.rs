//! Fail-safe plans: go for a number of periods, then brake to rest.

/// What the ego can do without looking again: go for a while, then brake to rest.
///
/// A plan is a fixed sequence of commands, so that it can be carried out blindly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Plan {
    /// For so many periods the ego accelerates at [`crate::Ego::go`]; then it brakes.
    pub go: u16,
}

impl Plan {
    /// What is left of the plan after one period.
    #[must_use]
    pub const fn tail(self) -> Self {
        Self {
            go: self.go.saturating_sub(1),
        }
    }
}
