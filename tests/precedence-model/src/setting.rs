//! What is modelled, and its bounds.

use cede_controller::dangerous::precedence::Right;
use cede_controller::{Contract, Precedence, Priority, RightOfWay};

/// Metres from one place to the next: also the contract's error of sensed places.
pub const UNIT: f32 = 0.1;

/// Where a vehicle waits, in places; it arrives at place 0.
pub const LINE: i8 = 3;

/// From here on a vehicle is certainly in the zone, in places.
pub const INSIDE: i8 = 4;

/// The last place; nobody leaves the zone.
pub const LAST: i8 = 6;

/// From here on a vehicle is seen to have arrived, whatever the contract's errors are.
pub const ARRIVED: i8 = 2;

/// How vehicles come to where they arrive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Approach {
    /// A place in every step.
    Brisk,
    /// A place in any step.
    Slow,
    /// The same, at any speed, at rest, too.
    Creeping,
}

/// A search.
#[derive(Clone, Debug)]
pub struct Setting<const N: usize> {
    /// What every shield assumes.
    pub contract: Contract,
    /// The rule of precedence in it.
    pub rule: Precedence,
    /// Who has the right of way: `rights[i][j]` is what vehicle i knows of itself and j.
    pub rights: [[RightOfWay; N]; N],
    /// When it counts.
    pub priority: Priority,
    /// Whether the numbers of the vehicles\' paths go up.
    pub ascending: bool,
    /// Steps a period.
    pub grain: u8,
    /// Steps by which each shield's calls are later than the grid of periods.
    pub phases: [u8; N],
    /// Steps by which a call may be early or late.
    pub jitter: u8,
    /// Where everybody may be at the beginning, in places.
    pub starts: [i8; N],
    /// Whether the first vehicle's shield may be switched on at any later time.
    pub late: bool,
    /// How vehicles come to where they arrive.
    pub approach: Approach,
    /// Whether shields miss vehicles and calls.
    pub misses: bool,
    /// Whether vehicles go on from where they have arrived, into the zone.
    pub enters: bool,
    /// Steps after which nobody may still have to arrive.
    pub arrive_by: u8,
    /// In how many steps in all a vehicle that has arrived goes, or a shield begins to miss something.
    pub disturbances: u8,
    /// The highest speed, in steps of acceleration.
    pub top: u8,
    /// The hardest braking, in steps of acceleration.
    pub braking: u8,
    /// Periods for which all may have rested, at most.
    pub longest: u16,
    /// Largest error of a sensed place, in places; the contract's is one.
    pub place_error: i8,
}

impl<const N: usize> Setting<N> {
    /// Exact sensors of speed, two steps a period, nobody has the right of way.
    ///
    /// # Panics
    /// If the contract is not valid.
    #[must_use]
    pub fn new(patience: u16, tie: u16) -> Self {
        let mut rule = Precedence::ALL_WAY_STOP;
        rule.distance = UNIT * f32::from(LINE);
        (rule.patience, rule.tie) = (patience, tie);
        Self {
            contract: contract(rule, 0.0, 0.0),
            rule,
            rights: [[RightOfWay::Unsettled; N]; N],
            priority: Priority::FirstCome,
            ascending: true,
            grain: 2,
            phases: [0; N],
            jitter: 0,
            starts: [-1; N],
            late: false,
            approach: Approach::Slow,
            misses: false,
            enters: false,
            arrive_by: 6,
            disturbances: 0,
            top: 2,
            braking: 2,
            longest: 2 * patience + 6,
            place_error: 1,
        }
    }

    /// Vehicle `first` has the right of way over `second`.
    #[must_use]
    pub fn right(mut self, first: usize, second: usize) -> Self {
        self.rights[first][second] = RightOfWay::Ego;
        self.rights[second][first] = RightOfWay::Other;
        self
    }

    /// The right of way counts whoever arrives first.
    #[must_use]
    pub const fn unsigned(mut self) -> Self {
        self.priority = Priority::Unsigned;
        self
    }

    /// The first vehicle is on the path with the highest number, so that its turn comes first.
    #[must_use]
    pub const fn descending(mut self) -> Self {
        self.ascending = false;
        self
    }

    /// What vehicle `one` knows of itself and `two`.
    #[must_use]
    pub fn right_of(&self, one: usize, two: usize) -> Right {
        let by_number = if (one < two) == self.ascending {
            RightOfWay::Ego
        } else {
            RightOfWay::Other
        };
        let of_way = self.rights[one][two];
        Right {
            of_way,
            priority: self.priority,
            in_turns: match self.priority {
                Priority::Signed => of_way,
                _ => by_number,
            },
        }
    }

    /// Sensed speeds err by so much (m/s).
    #[must_use]
    pub fn speed_error(mut self, error: f32) -> Self {
        self.contract = contract(self.rule, error, self.contract.jitter());
        self
    }

    /// Calls of one step more or less, of `grain` a period.
    #[must_use]
    pub fn jitter(mut self, grain: u8) -> Self {
        let jitter = self.contract.period() / f32::from(grain);
        self.grain = grain;
        self.jitter = 1;
        self.contract = contract(self.rule, self.contract.speed_error(), jitter);
        self
    }

    /// Seconds a step.
    #[must_use]
    pub fn step(&self) -> f32 {
        self.contract.period() / f32::from(self.grain)
    }

    /// Speed (m/s) that is gained in one step at full acceleration.
    #[must_use]
    pub fn gain(&self) -> f32 {
        self.contract.other().acceleration * self.step()
    }
}

/// Braking is twice as hard as acceleration: speeds then lie on one grid.
fn contract(rule: Precedence, speed_error: f32, jitter: f32) -> Contract {
    Contract::builder()
        .latency(0.02)
        .other_acceleration(3.0)
        .other_braking(6.0)
        .position_error(UNIT)
        .speed_error(speed_error)
        .jitter(jitter)
        .precedence(Some(rule))
        .build()
        .expect("a valid contract")
}
