//! Somebody in the way.

/// Somebody in the way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Obstacle {
    /// Metres from bumper to body.
    pub(super) gap: f32,
    /// Its speed (m/s) along the way.
    pub(super) speed: f32,
}
