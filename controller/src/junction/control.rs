//! What obliges a vehicle to give way where it enters a junction.

/// What obliges a vehicle to give way where it enters a junction: its signs, or that there are none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Control {
    /// It is not known: no map says so.
    #[default]
    Unknown,
    /// Nothing: the vehicle is on the major road, or there are no signs.
    Free,
    /// It gives way.
    Yield,
    /// It stops and gives way.
    Stop,
    /// It stops, as everybody does: who has stopped first goes first.
    AllWayStop,
}

impl Control {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::Unknown,
        Self::Free,
        Self::Yield,
        Self::Stop,
        Self::AllWayStop,
    ];

    /// Name in tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Unknown => "unknown",
            Self::Free => "free",
            Self::Yield => "yield",
            Self::Stop => "stop",
            Self::AllWayStop => "all-way stop",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_has_a_name_of_its_own() {
        let names = Control::ALL.map(Control::name);
        for (i, name) in names.iter().enumerate() {
            assert!(!name.is_empty() && !names[..i].contains(name), "{names:?}");
        }
    }
}
