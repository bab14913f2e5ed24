//! What one vehicle senses of the others: errors, gaps, numbers and the order of tracks.

use crate::error::{ErrorSource, Shape};
use crate::rng::Rng;
use cede_controller::PathId;

/// How much a shielded vehicle sees of the others' lanes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum View {
    /// All.
    Whole,
    /// From corners on, and its shield is told where they are.
    Corners,
    /// From corners on, and its shield is not told: beyond the contract.
    Untold,
}

/// How well vehicles see, within the contract.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensing {
    /// Shape of the errors; none: each vehicle has one of its own.
    pub shape: Option<Shape>,
    /// Errors in units of the contract's bounds; more than 1 is outside of it.
    pub scale: f64,
    /// Probability that a track is missing from one observation.
    pub gaps: f64,
    /// Probability at each observation that a track is missing from now on for up to 3 s.
    pub bursts: f64,
    /// Probability at each observation that the ego's own state, or a track's, is not a number for up to 2 s.
    pub faults: f64,
    /// Probability, at each decision with a plan that goes, that the ego's own state is not a number from then on, for as long
    /// as the plan goes and up to 2 s more.
    pub blinds: f64,
    /// Vehicles without a zone with the ego's come and go.
    pub blinking: bool,
    /// Tracks have all the paths that they may be on, until their pose tells.
    pub undecided: bool,
    /// Those who are still too far away to matter are not seen.
    pub newcomers: bool,
    /// Others come into sight wherever they are: beyond the contract. A plan that is reported after that has to hold.
    pub surprises: bool,
    /// How much is in sight of the others' lanes. Whoever comes into sight is in every observation from then on.
    pub view: View,
    /// The observation is frozen for so many periods now and then: outside of the contract.
    pub frozen: u32,
}

impl Sensing {
    /// Every track in every observation, with errors of any shape.
    pub const PLAIN: Self = Self {
        shape: None,
        scale: 1.0,
        gaps: 0.0,
        bursts: 0.0,
        faults: 0.0,
        blinds: 0.0,
        blinking: false,
        undecided: false,
        newcomers: false,
        surprises: false,
        view: View::Whole,
        frozen: 0,
    };
}

/// How one vehicle senses one vehicle, itself or another.
#[derive(Clone, Debug)]
pub struct Sight {
    /// The track's number.
    pub number: u16,
    place: ErrorSource,
    speed: ErrorSource,
    /// Observations for which it is still missing.
    missing: u32,
    /// Observations for which it is still not a number.
    broken: u32,
    /// It has not been seen yet.
    pub hidden: bool,
    /// Paths on which it certainly is not.
    pub excluded: Vec<PathId>,
}

/// Whether and how a vehicle is in an observation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// With its errors.
    Seen,
    /// Not at all.
    Missing,
    /// With a state that is not a number.
    Broken,
}

impl Sight {
    /// With a number and errors of its own.
    #[must_use]
    pub fn new(sensing: &Sensing, number: u16, rng: &mut Rng) -> Self {
        let mut source = || {
            let shape = sensing.shape.unwrap_or_else(|| rng.pick(&Shape::WRONG));
            let sign = rng.sign();
            ErrorSource::new(shape, sign, rng.fork())
        };
        Self {
            number,
            place: source(),
            speed: source(),
            missing: 0,
            broken: 0,
            hidden: sensing.newcomers || sensing.surprises,
            excluded: Vec::new(),
        }
    }

    /// Whether it is in the next observation; it certainly is if it is the `first` one.
    pub fn shown(&mut self, sensing: &Sensing, first: bool, rng: &mut Rng) -> Shown {
        // One that appears later than that is a newcomer.
        if first {
            return Shown::Seen;
        }
        if self.broken > 0 {
            self.broken -= 1;
            return Shown::Broken;
        }
        if self.missing > 0 {
            self.missing -= 1;
            return Shown::Missing;
        }
        if sensing.faults > 0.0 && rng.chance(sensing.faults) {
            self.broken = rng.below(20) as u32;
            return Shown::Broken;
        }
        if sensing.bursts > 0.0 && rng.chance(sensing.bursts) {
            self.missing = rng.below(30) as u32;
            return Shown::Missing;
        }
        if sensing.gaps > 0.0 && rng.chance(sensing.gaps) {
            return Shown::Missing;
        }
        Shown::Seen
    }

    /// From the next observation on, its state is not a number for so many of them.
    pub fn blind(&mut self, observations: u32) {
        self.broken = self.broken.max(observations);
    }

    /// The next errors of place and speed, in units of their bounds.
    pub fn errors(&mut self) -> [f64; 2] {
        [self.place.draw(), self.speed.draw()]
    }
}

/// Different track numbers.
#[must_use]
pub fn numbers(count: usize, rng: &mut Rng) -> Vec<u16> {
    let mut numbers: Vec<u16> = Vec::new();
    while numbers.len() < count {
        let any = rng.bits() as u16;
        let number = rng.pick(&[0, u16::MAX, any, any, any]);
        if !numbers.contains(&number) {
            numbers.push(number);
        }
    }
    numbers
}
