//! How near each monitored condition of the contract is to its limit.

use crate::fault::{Fault, Field, InputFault, Subject};
use core::fmt;

/// What is left of a tolerance before a condition of the contract is broken.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Room {
    /// What is left, in the condition's unit. Below 0 the condition is broken, at 0 it is not.
    pub left: f32,
    /// The same as a share of the most that can be left: 1 in the middle of what is allowed, 0 at its end.
    pub share: f32,
    /// Number of the track that has least left; none, if it is the ego or the call.
    pub track: Option<u16>,
}

impl Room {
    /// `left` of `most`, which is above 0.
    pub(crate) fn of(left: f32, most: f32) -> Self {
        Self {
            left,
            share: left / most,
            track: None,
        }
    }

    /// Of a value in [`low`, `high`].
    pub(crate) fn between(value: f32, [low, high]: [f32; 2]) -> Self {
        let (above, below) = (value - low, high - value);
        let left = if above < below { above } else { below };
        Self::of(left, 0.5 * (high - low))
    }

    /// Of a distance (m) that must not exceed `high`.
    pub(crate) fn up_to(high: f32, value: f32) -> Self {
        Self::of(high - value, high)
    }

    /// Of a cosine of at least `low`.
    pub(crate) fn cosine(low: f32, value: f32) -> Self {
        Self::of(value - low, 1.0 - low)
    }

    /// Whether the condition holds. It does not for what is not a number.
    pub(crate) fn holds(self) -> bool {
        self.left >= 0.0
    }

    /// Whether both conditions hold.
    pub(crate) fn hold([one, other]: [Self; 2]) -> bool {
        one.holds() && other.holds()
    }
}

/// How near each condition of the contract that the shield monitors is to its limit, in the last period.
///
/// Nothing, where there is nothing to compare: at the first observation, or if nobody is seen. Of several tracks the one that
/// has least left counts. A [`crate::Breach`] is a place or a speed of which less than 0 is left.
///
/// Displays as one line: `ego position 0.021 m (84 %), other 3 speed 0.12 m/s (40 %)`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Headroom {
    /// The ego's arc length, in m: how far it is inside of what its commands lead to.
    pub ego_position: Option<Room>,
    /// The ego's speed, in m/s: the same.
    pub ego_speed: Option<Room>,
    /// A track's arc length, in m: how far it is inside of what `other` of the contract allows since it was seen last.
    pub other_position: Option<Room>,
    /// A track's speed, in m/s: the same.
    pub other_speed: Option<Room>,
    /// The distance (m) between a pose and its place on the path, the ego's or a track's. Below 0 it is
    /// [`Field::Offset`].
    pub offset: Option<Room>,
    /// The cosine of the angle between a direction and the path, the ego's or a track's. Below 0 it is
    /// [`Field::Heading`].
    pub heading: Option<Room>,
    /// The time (s) since the last call, against period and jitter. Below 0 it is [`Fault::OffPeriod`].
    pub period: Option<Room>,
}

/// A condition of the contract that the shield monitors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Condition {
    /// [`Headroom::ego_position`].
    EgoPosition,
    /// [`Headroom::ego_speed`].
    EgoSpeed,
    /// [`Headroom::other_position`].
    OtherPosition,
    /// [`Headroom::other_speed`].
    OtherSpeed,
    /// [`Headroom::offset`].
    Offset,
    /// [`Headroom::heading`].
    Heading,
    /// [`Headroom::period`].
    Period,
}

impl Condition {
    /// What it is of, and its unit.
    const fn words(self) -> [&'static str; 2] {
        match self {
            Self::EgoPosition | Self::OtherPosition => ["position", " m"],
            Self::EgoSpeed | Self::OtherSpeed => ["speed", " m/s"],
            Self::Offset => ["offset", " m"],
            Self::Heading => ["heading", ""],
            Self::Period => ["period", " s"],
        }
    }
}

impl Headroom {
    /// Nothing was compared.
    pub(crate) const NONE: Self = Self {
        ego_position: None,
        ego_speed: None,
        other_position: None,
        other_speed: None,
        offset: None,
        heading: None,
        period: None,
    };

    /// Every condition, and what is left of it.
    #[must_use]
    pub const fn conditions(&self) -> [(Condition, Option<Room>); 7] {
        [
            (Condition::EgoPosition, self.ego_position),
            (Condition::EgoSpeed, self.ego_speed),
            (Condition::OtherPosition, self.other_position),
            (Condition::OtherSpeed, self.other_speed),
            (Condition::Offset, self.offset),
            (Condition::Heading, self.heading),
            (Condition::Period, self.period),
        ]
    }

    /// The condition of which the smallest share is left; nothing, if none was monitored.
    #[must_use]
    pub fn least(&self) -> Option<(Condition, Room)> {
        let known = self.conditions();
        let known = known
            .iter()
            .filter_map(|&(condition, room)| Some((condition, room?)));
        known.reduce(|least, it| {
            if it.1.share < least.1.share {
                it
            } else {
                least
            }
        })
    }

    /// The ego moved to where so much is left of its place and speed.
    pub(crate) const fn note_ego(&mut self, [position, speed]: [Room; 2]) {
        (self.ego_position, self.ego_speed) = (Some(position), Some(speed));
    }

    /// Track `number` moved to where so much is left of its place and speed.
    pub(crate) fn note_track(&mut self, number: u16, [position, speed]: [Room; 2]) {
        lower(&mut self.other_position, Some(number), position);
        lower(&mut self.other_speed, Some(number), speed);
    }

    /// The pose of the ego, or of track `number`, is so near to its path.
    pub(crate) fn note_pose(&mut self, number: Option<u16>, [offset, heading]: [Room; 2]) {
        lower(&mut self.offset, number, offset);
        lower(&mut self.heading, number, heading);
    }

    /// An input is refused.
    pub(crate) fn note_fault(&mut self, fault: Fault) {
        let Fault::Input(InputFault {
            subject,
            field,
            value,
            low,
            high,
        }) = fault
        else {
            return;
        };
        let number = match subject {
            Subject::Track(number) => Some(number),
            _ => None,
        };
        match field {
            Field::Offset => lower(&mut self.offset, number, Room::up_to(high, value)),
            Field::Heading => lower(&mut self.heading, number, Room::cosine(low, value)),
            _ => {}
        }
    }
}

/// Keeps what is less: `least`, or the `room` of whose number is `track`. What is not a number is nothing.
fn lower(least: &mut Option<Room>, track: Option<u16>, room: Room) {
    if least.is_none_or(|least| room.left < least.left) && !room.left.is_nan() {
        *least = Some(Room { track, ..room });
    }
}

impl fmt::Display for Headroom {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut between = "";
        for (condition, room) in self.conditions() {
            let Some(Room { left, share, track }) = room else {
                continue;
            };
            f.write_str(between)?;
            between = ", ";
            match (condition, track) {
                (Condition::Period, _) => {}
                (_, None) => f.write_str("ego ")?,
                (_, Some(number)) => write!(f, "other {number} ")?,
            }
            let [name, unit] = condition.words();
            write!(f, "{name} {left:.3}{unit} ({:.0} %)", 100.0 * share)?;
        }
        Ok(())
    }
}
