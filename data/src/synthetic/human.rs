//! A human driver: free flow, car following, stop signs, gaps, courtesy and delay.
//!
//! Car following is the intelligent driver model (Treiber, Hennecke and Helbing 2000).
//! At the line the driver stops, or rolls over it, and goes when those who have the
//! right of way have gone or leave it a gap; how long a gap it asks for, and whom it
//! lets go first, shifts with its social value orientation. Once it goes, it gives way
//! only to those who entered the intersection before it, so nobody waits in a circle.

use cede_controller::kinematics::{STEP, clamp_acceleration};
use rand_distr::Distribution;
use rand_pcg::Pcg64;
use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};

/// Speeds (m/s) below this count as standing.
pub const STANDING: f32 = 0.3;

/// What kind of driver somebody is.
#[derive(Clone, Copy, Debug)]
pub struct Character {
    /// Speed relative to a plain driver's.
    pub pace: f32,
    /// Acceleration from rest in m/s².
    pub acceleration: f32,
    /// Usual deceleration in m/s².
    pub deceleration: f32,
    /// Time headway to the vehicle ahead in s.
    pub headway: f32,
    /// Distance between bumpers at rest in m.
    pub standstill: f32,
    /// Speed (m/s) at which it rolls over a stop line; 0 if it stops.
    pub rolling: f32,
    /// How long it stands at a stop line at least, s.
    pub dwell: f32,
    /// How far past the line (m) its bumper stops; negative before it.
    pub overshoot: f32,
    /// Social value orientation in rad, in [0, π/2]: π/4 is cooperative.
    pub svo: f32,
    /// Gap (s) that it accepts where all stop, in front of somebody whose turn it is.
    pub gap: f32,
    /// Gap (s) that it accepts in front of somebody who does not have to stop.
    pub lag: f32,
    /// Time (s) from seeing that the way is free until going.
    pub reaction: f32,
    /// How long (s) it waits for somebody who does not move.
    pub patience: f32,
    /// Standard deviation of the unsteady part of its acceleration, m/s².
    pub unsteadiness: f32,
    /// By how much (s) it mistakes who came first.
    pub misjudgement: f32,
}

impl Character {
    /// A driver drawn from the population. The numbers are of the order of the recorded ones.
    pub fn draw(rng: &mut Pcg64) -> Self {
        let mut around = |mean: f32, spread: f32, low: f32, high: f32| {
            let normal: f32 = rand_distr::StandardNormal.sample(rng);
            (mean + spread * normal).clamp(low, high)
        };
        let svo = around(FRAC_PI_4, 0.3, 0.0, FRAC_PI_2);
        let rolls = around(0.0, 1.0, -3.0, 3.0) > -0.5;
        Self {
            pace: around(0.97, 0.16, 0.6, 1.45),
            acceleration: around(1.75, 0.45, 0.8, 2.8),
            deceleration: around(1.45, 0.4, 0.8, 2.4),
            headway: around(1.3, 0.3, 0.7, 2.2),
            standstill: around(2.2, 0.6, 1.0, 4.0),
            rolling: if rolls {
                around(1.3, 0.6, 0.4, 3.0)
            } else {
                0.0
            },
            dwell: around(0.4, 0.7, 0.0, 2.5),
            overshoot: around(-0.6, 1.0, -3.0, 1.5),
            svo,
            gap: around(2.5, 0.5, 1.2, 4.0) * (0.6 + 0.4 * svo / FRAC_PI_4),
            lag: around(1.2, 0.7, -0.3, 3.0) + 0.5 * (svo - FRAC_PI_4) / FRAC_PI_4,
            reaction: around(0.8, 0.3, 0.3, 1.8),
            patience: around(2.5, 0.8, 1.0, 5.0),
            unsteadiness: around(0.2, 0.08, 0.05, 0.4),
            misjudgement: around(0.0, 0.4, -1.2, 1.2) + 0.6 * (svo - FRAC_PI_4) / FRAC_PI_4,
        }
    }

    /// How far past the place where it waits (m) its bumper stops: only a line is overshot.
    fn overshoot(&self, line: bool) -> f32 {
        if line {
            self.overshoot
        } else {
            self.overshoot.min(0.0)
        }
    }
}

/// The vehicle ahead in the same lane.
#[derive(Clone, Copy, Debug)]
pub struct Leader {
    /// Metres from bumper to bumper.
    pub gap: f32,
    /// Its speed in m/s.
    pub speed: f32,
}

/// Who goes first by the rules, as long as neither is in the intersection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Right {
    /// The driver itself.
    Mine,
    /// The other.
    Theirs,
    /// Who came first: the other came so many seconds earlier (later if negative).
    FirstCome(f32),
}

/// Another vehicle whose way conflicts.
#[derive(Clone, Copy, Debug)]
pub struct Rival {
    /// Distances (m) until the driver enters and leaves the shared zone.
    pub own: (f32, f32),
    /// Distances (m) until the other enters and leaves it.
    pub other: (f32, f32),
    /// The other's speed in m/s.
    pub speed: f32,
    /// Whether the other entered the intersection, and before the driver did, or is in the zone already.
    pub ahead: bool,
    /// Who goes first by the rules.
    pub right: Right,
}

/// What a driver sees.
#[derive(Clone, Copy, Debug)]
pub struct Situation<'a> {
    /// Own speed in m/s.
    pub speed: f32,
    /// Speed (m/s) that a plain driver has here, and its slope along the route in 1/s.
    pub profile: (f32, f32),
    /// What a plain driver drives at most across the intersection, m/s.
    pub crossing_speed: f32,
    /// Distance (m) from the own bumper to where it waits for others: the line, or where their ways begin.
    /// Negative past it.
    pub to_line: f32,
    /// Whether it has to stop there whatever comes.
    pub must_stop: bool,
    /// The vehicle ahead.
    pub leader: Option<Leader>,
    /// The others whose ways conflict and who have not yet passed.
    pub rivals: &'a [Rival],
}

/// A driver with what it has in mind.
#[derive(Clone, Debug)]
pub struct Human {
    character: Character,
    rng: Pcg64,
    going: bool,
    /// How long it has stood at the line, s.
    stood: f32,
    /// How long the way has been free, s.
    free: f32,
    acceleration: f32,
    unsteady: f32,
}

impl Human {
    /// A driver of this `character`, with random choices from `rng`.
    #[must_use]
    pub fn new(character: Character, rng: Pcg64) -> Self {
        Self {
            character,
            rng,
            going: false,
            stood: 0.0,
            free: 0.0,
            acceleration: 0.0,
            unsteady: 0.0,
        }
    }

    /// The same driver, already on its way across.
    #[must_use]
    pub fn under_way(mut self) -> Self {
        self.going = true;
        self
    }

    /// Whether it has decided to cross.
    pub fn is_going(&self) -> bool {
        self.going
    }

    /// The acceleration (m/s²) for the step that begins now, in [−3, 3].
    pub fn accelerate(&mut self, seen: &Situation<'_>) -> f32 {
        if !self.going {
            self.decide(seen);
        }
        let mut wish = self.cruise(seen);
        if let Some(leader) = seen.leader {
            wish = wish.min(self.follow(seen.speed, leader));
        }
        if self.going || !seen.must_stop {
            for rival in seen.rivals.iter().filter(|rival| rival.ahead) {
                wish = wish.min(self.let_pass(seen, rival));
            }
        }
        if !self.going {
            wish = wish.min(self.approach_line(seen));
        }
        self.act(seen.speed, wish)
    }

    /// As fast as the route and the driver's pace allow.
    fn cruise(&self, seen: &Situation<'_>) -> f32 {
        let c = &self.character;
        let (limit, slope) = seen.profile;
        let (limit, slope) = (limit * c.pace, slope * c.pace);
        let ratio = seen.speed / limit;
        let free = c.acceleration * (1.0 - ratio * ratio * ratio * ratio);
        // Ahead of a curve the limit falls: follow it down.
        free.min(seen.speed * slope + (limit - seen.speed) / 0.8)
            .max(-2.5)
    }

    /// The intelligent driver model's interaction term.
    fn follow(&self, speed: f32, leader: Leader) -> f32 {
        let c = &self.character;
        let closing = speed - leader.speed;
        let comfort = 2.0 * libm::sqrtf(c.acceleration * c.deceleration);
        let wanted = c.standstill + (speed * c.headway + speed * closing / comfort).max(0.0);
        let ratio = wanted / leader.gap.max(0.1);
        c.acceleration * (1.0 - ratio * ratio)
    }

    /// Slows down to stop at the line, or to roll up to it.
    fn approach_line(&self, seen: &Situation<'_>) -> f32 {
        let c = &self.character;
        let distance = seen.to_line + c.overshoot(seen.must_stop);
        let can_still_stop = seen.speed * seen.speed < 2.0 * 2.5 * (distance - 0.2).max(0.0);
        let rolling = if can_still_stop { c.rolling } else { 0.0 };
        slow_to(seen.speed, rolling, distance, c.deceleration)
    }

    /// Whether to go: sets `going`.
    fn decide(&mut self, seen: &Situation<'_>) {
        let c = self.character;
        let distance = seen.to_line + c.overshoot(seen.must_stop);
        let standing = seen.speed < STANDING && distance < 1.5;
        self.stood = if standing { self.stood + STEP } else { 0.0 };
        let at_line = if seen.must_stop {
            let rolls = c.rolling > 0.0 && seen.speed < c.rolling + 0.5 && distance < 2.0;
            rolls || (standing && self.stood >= c.dwell)
        } else {
            let to_stop = seen.speed * seen.speed / (2.0 * c.deceleration);
            distance < to_stop + 0.4 * seen.speed + 1.5
        };
        let noticed = at_line && seen.rivals.iter().all(|rival| self.lets_me_go(seen, rival));
        self.free = if noticed { self.free + STEP } else { 0.0 };
        let delay = if standing {
            c.reaction
        } else {
            0.3 * c.reaction
        };
        self.going = noticed && self.free >= delay;
    }

    /// Whether `rival` is no reason to wait.
    fn lets_me_go(&self, seen: &Situation<'_>, rival: &Rival) -> bool {
        let c = &self.character;
        let top = seen.crossing_speed * c.pace;
        let arrive = travel_time(rival.own.0, seen.speed, c.acceleration, top);
        let leave = travel_time(rival.own.1, seen.speed, c.acceleration, top);
        if rival.ahead {
            let margin = 0.4 * (c.svo / FRAC_PI_4);
            // Who goes on behind somebody who waits there stands in others' way.
            return rival.speed >= STANDING && arrive > clear_time(rival) + margin - 0.3;
        }
        let (theirs, gap) = match rival.right {
            Right::Mine => (false, c.gap),
            Right::Theirs => (true, c.lag),
            Right::FirstCome(lead) => (lead + c.misjudgement > 0.0, c.gap),
        };
        let hesitates = rival.speed < STANDING && self.stood > c.dwell + c.patience;
        let impatience = 1.0 - 0.02 * self.stood.min(15.0);
        let comes = travel_time(rival.other.0, rival.speed, 1.5, rival.speed.max(5.0));
        !theirs || hesitates || comes > leave + gap * impatience
    }

    /// Comes to the shared zone only when `rival` has left it.
    fn let_pass(&self, seen: &Situation<'_>, rival: &Rival) -> f32 {
        let distance = rival.own.0 - 0.3;
        if rival.own.0 <= 0.0 {
            return f32::INFINITY;
        }
        if distance <= 0.0 {
            return -1.0;
        }
        let wait = clear_time(rival) + 0.3;
        let timed = 2.0 * (distance - seen.speed * wait) / (wait * wait);
        if seen.speed + timed * wait >= 0.0 {
            return timed;
        }
        -seen.speed * seen.speed / (2.0 * distance.max(0.1))
    }

    /// What the foot makes of the wish: not quite steady, and not at once.
    fn act(&mut self, speed: f32, wish: f32) -> f32 {
        const CORRELATION: f32 = 0.92; // about one second
        let c = &self.character;
        let kick = libm::sqrtf(1.0 - CORRELATION * CORRELATION) * c.unsteadiness;
        let normal: f32 = rand_distr::StandardNormal.sample(&mut self.rng);
        self.unsteady = CORRELATION * self.unsteady + kick * normal;
        let held = speed == 0.0 && wish < 0.1;
        if held {
            self.acceleration = 0.0;
            return 0.0;
        }
        let share = (speed / 2.0).min(1.0);
        let wish = wish + share * self.unsteady;
        let fall = if wish < -2.0 { 1.0 } else { 0.4 };
        let next = wish.clamp(self.acceleration - fall, self.acceleration + 0.3);
        self.acceleration = clamp_acceleration(next);
        self.acceleration
    }
}

/// The acceleration that follows the curve of constant `deceleration` down to speed `end` in `distance` m.
fn slow_to(speed: f32, end: f32, distance: f32, deceleration: f32) -> f32 {
    let allowed = libm::sqrtf(end * end + 2.0 * deceleration * distance.max(0.0));
    if allowed < 0.1 {
        return -2.0;
    }
    (allowed - speed) / 0.6 - deceleration * (speed / allowed).min(1.3)
}

/// Time (s) to cover `distance` m from `speed`, accelerating to `top` at most.
fn travel_time(distance: f32, speed: f32, acceleration: f32, top: f32) -> f32 {
    if distance <= 0.0 {
        return 0.0;
    }
    let top = top.max(speed);
    let until_top = (top * top - speed * speed) / (2.0 * acceleration);
    if distance <= until_top {
        return (libm::sqrtf(speed * speed + 2.0 * acceleration * distance) - speed) / acceleration;
    }
    (top - speed) / acceleration + (distance - until_top) / top
}

/// When a rival in the intersection will have left the shared zone, s.
fn clear_time(rival: &Rival) -> f32 {
    let start = if rival.speed < STANDING { 1.0 } else { 0.0 };
    start + travel_time(rival.other.1, rival.speed, 1.0, rival.speed.max(4.0))
}
