//! The truth about one vehicle.

use crate::setting::{ARRIVED, Approach, INSIDE, LAST, Setting};

/// Where a vehicle is, in places from where it arrives, and how fast, in steps of acceleration.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Body {
    /// Place.
    pub place: i8,
    /// Speed.
    pub speed: u8,
}

impl Body {
    /// Whether it can still stop before the zone.
    #[must_use]
    pub fn is_outside(self) -> bool {
        self.place < INSIDE
    }

    /// Everything that it can be one step later, and what that costs of the disturbances.
    pub fn next<const N: usize>(self, setting: &Setting<N>) -> Vec<(Self, u8)> {
        if self.place < ARRIVED && setting.approach != Approach::Creeping {
            let at = |place| {
                let speed = setting.top;
                (Self { place, speed }, 0)
            };
            return match setting.approach {
                Approach::Brisk => vec![at(self.place + 1)],
                _ => vec![at(self.place), at(self.place + 1)],
            };
        }
        let speeds = self.speed.saturating_sub(setting.braking)..=(self.speed + 1).min(setting.top);
        let mut all = Vec::new();
        for speed in speeds {
            // One that has arrived is expected to brake.
            let goes = self.place >= ARRIVED && speed > 0 && speed >= self.speed;
            let drives = setting.enters && speed > 0 && self.place < LAST;
            for advance in 0..=i8::from(self.place < ARRIVED || drives) {
                let place = self.place + advance;
                all.push((Self { place, speed }, u8::from(goes)));
            }
        }
        all
    }
}
