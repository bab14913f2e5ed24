//! Arguments and results as 32-bit words.

use crate::refusal::Refusal;
use cede_controller::geometry::unit;
use cede_controller::{Footprint, PathId, Point, Pose, Vehicle};
use heapless::Vec;

/// Most words of a question or an answer.
pub const WORDS: usize = 1024;

/// The words of a question, read from the front.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a>(pub &'a [u32]);

impl Input<'_> {
    pub(crate) fn word(&mut self) -> Result<u32, Refusal> {
        let (&first, rest) = self.0.split_first().ok_or(Refusal::Short)?;
        self.0 = rest;
        Ok(first)
    }

    pub(crate) fn number(&mut self) -> Result<f32, Refusal> {
        self.word().map(f32::from_bits)
    }

    pub(crate) fn path(&mut self) -> Result<PathId, Refusal> {
        // There is no path 255.
        Ok(PathId::new(u8::try_from(self.word()?).unwrap_or(u8::MAX)))
    }

    pub(crate) fn track_number(&mut self) -> Result<u16, Refusal> {
        u16::try_from(self.word()?).map_err(|_| Refusal::Choice)
    }

    pub(crate) fn point(&mut self) -> Result<Point, Refusal> {
        Ok(Point::new(self.number()?, self.number()?))
    }

    pub(crate) fn pose(&mut self) -> Result<Pose, Refusal> {
        let position = self.point()?;
        let direction = unit(self.number()?, self.number()?);
        Ok(Pose {
            position,
            direction,
        })
    }

    pub(crate) fn footprint(&mut self) -> Result<Footprint, Refusal> {
        let (length, width) = (self.number()?, self.number()?);
        Ok(Footprint { length, width })
    }

    pub(crate) fn vehicle(&mut self) -> Result<Vehicle, Refusal> {
        let (s, speed) = (self.number()?, self.number()?);
        let pose = self.pose()?;
        Ok(Vehicle { s, speed, pose })
    }
}

/// The words of an answer. What exceeds [`WORDS`] is left out.
#[derive(Clone, Debug, Default)]
pub struct Output(Vec<u32, WORDS>);

impl Output {
    /// No words yet.
    #[must_use]
    pub const fn new() -> Self {
        Self(Vec::new())
    }

    /// The words.
    #[must_use]
    pub fn words(&self) -> &[u32] {
        &self.0
    }

    pub(crate) fn word(&mut self, word: u32) {
        let _ = self.0.push(word);
    }

    pub(crate) fn number(&mut self, number: f32) {
        self.word(number.to_bits());
    }

    pub(crate) fn numbers<const N: usize>(&mut self, numbers: [f32; N]) {
        numbers.into_iter().for_each(|number| self.number(number));
    }

    pub(crate) fn text(&mut self, text: &str) {
        self.word(u32::try_from(text.len()).unwrap_or(0));
        for bytes in text.as_bytes().chunks(4) {
            let mut word = [0; 4];
            word.iter_mut()
                .zip(bytes)
                .for_each(|(to, from)| *to = *from);
            self.word(u32::from_le_bytes(word));
        }
    }
}
