//! Where calls are answered.

use crate::call::Call;
use crate::contract;
use crate::refusal::Refusal;
use crate::words::{Input, Output};
use cede_controller::kinematics::{State, advance};
use cede_controller::shield::actuation::Inherited;
use cede_controller::shield::choice::{GRID, grid};
use cede_controller::shield::margin;
use cede_controller::{
    Approach, Bounds, Cause, Class, ConflictKind, Contract, Drive, Instant, JunctionBuilder,
    Observation, OrientedBox, Part, PathId, Plan, Policy, Priority, Route, Track, policy,
};
use core::cell::OnceCell;
use core::fmt::Write;
use heapless::{String, Vec};

/// A junction of the page: the ego's path, and 15 others. Every path can be entered, so that the page's other drivers can
/// ask how their ways meet.
pub type Junction = cede_controller::Junction<PATHS, POINTS, PATHS>;
type Builder = JunctionBuilder<PATHS, POINTS, PATHS>;

/// Where the junction of a desk is once it is built.
pub type Place = OnceCell<Junction>;

const PATHS: usize = 16;
const POINTS: usize = 512;
/// Points of one path.
const ROUTE_POINTS: usize = 128;
/// Most tracks of one observation.
const TRACKS: usize = 16;
/// Most periods of a plan that are told.
const PERIODS: usize = 300;

/// Most commands that may be in effect at once.
const FLIGHTS: usize = 10;

/// The ego's path.
const EGO: PathId = PathId::new(0);

/// One vehicle at one junction.
#[derive(Debug)]
pub struct Desk<'j> {
    place: &'j Place,
    builder: Builder,
    contract: Contract,
    approach: Option<Approach<'j, 'static>>,
    last: Option<Last>,
    /// The commands that were given last, the newest at the end.
    commands: Vec<f32, FLIGHTS>,
    text: String<512>,
}

/// What was decided last, as far as a plan is drawn from it.
#[derive(Clone, Copy, Debug)]
struct Last {
    ego: State,
    /// The accelerations that were in effect: least and most.
    in_effect: [f32; 2],
    acceleration: f32,
    plan: Option<Plan>,
}

impl<'j> Desk<'j> {
    /// A desk without paths, and with the contract of the worst case.
    #[must_use]
    pub fn new(place: &'j Place) -> Self {
        Self {
            place,
            builder: Builder::new(),
            contract: Contract::WORST_CASE,
            approach: None,
            last: None,
            commands: Vec::new(),
            text: String::new(),
        }
    }

    /// Answers call number `call`: whether it is accepted. If not, [`Call::Text`] gives the reason.
    pub fn call(&mut self, call: u32, words: Input<'_>, out: &mut Output) -> bool {
        let answered = Call::new(call)
            .ok_or(Refusal::Call)
            .and_then(|call| self.answer(call, words, out));
        if let Err(refusal) = answered {
            self.say(format_args!("{refusal}"));
        }
        answered.is_ok()
    }

    fn answer(
        &mut self,
        call: Call,
        mut words: Input<'_>,
        out: &mut Output,
    ) -> Result<(), Refusal> {
        let words = &mut words;
        match call {
            Call::Path => self.path(words),
            Call::RightOfWay => self.right_of_way(words),
            Call::Build => self.build(),
            Call::Named => named(words, out),
            Call::Contract => self.set_contract(words),
            Call::Enter => self.enter(),
            Call::Decide => self.decide(words, out),
            Call::Plan => {
                self.plan(out);
                Ok(())
            }
            Call::Text => {
                out.text(&self.text);
                Ok(())
            }
            Call::Zones => self.zones(words, out),
            Call::Reach => self.reach(words, out),
            Call::Pose => self.pose(words, out),
            Call::Line => self.line(words, out),
            Call::Gap => gap(words, out),
            Call::Forget => self.forget(words),
            Call::SetLine => self.set_line(words),
        }
    }

    /// What exceeds the room is cut.
    fn say(&mut self, what: core::fmt::Arguments<'_>) {
        self.text.clear();
        let _ = self.text.write_fmt(what);
    }

    fn path(&mut self, words: &mut Input<'_>) -> Result<(), Refusal> {
        let class = class(words)?;
        let footprint = words.footprint()?;
        let count = words.word()? as usize;
        let mut points = Vec::<_, ROUTE_POINTS>::new();
        for _ in 0..count {
            points.push(words.point()?).map_err(|_| Refusal::Choice)?;
        }
        let route = Route::<ROUTE_POINTS>::new(points)?;
        self.unbuilt()?.path(&route, class, footprint)?;
        Ok(())
    }

    fn right_of_way(&mut self, words: &mut Input<'_>) -> Result<(), Refusal> {
        let (first, second) = (words.path()?, words.path()?);
        let priority = match words.word()? {
            0 => Priority::FirstCome,
            1 => Priority::Unsigned,
            2 => Priority::Signed,
            _ => return Err(Refusal::Choice),
        };
        Ok(self.unbuilt()?.priority(first, second, priority)?)
    }

    fn set_line(&mut self, words: &mut Input<'_>) -> Result<(), Refusal> {
        let (path, s) = (words.path()?, words.number()?);
        Ok(self.unbuilt()?.line(path, s)?)
    }

    fn unbuilt(&mut self) -> Result<&mut Builder, Refusal> {
        if self.place.get().is_some() {
            return Err(Refusal::Built);
        }
        Ok(&mut self.builder)
    }

    fn build(&mut self) -> Result<(), Refusal> {
        let junction = self.unbuilt()?.build_in_place()?.clone();
        self.place.set(junction).map_err(|_| Refusal::Built)
    }

    fn junction(&self) -> Result<&'j Junction, Refusal> {
        self.place.get().ok_or(Refusal::NotBuilt)
    }

    fn set_contract(&mut self, words: &mut Input<'_>) -> Result<(), Refusal> {
        let contract = contract::read(words)?;
        if let Some(approach) = &mut self.approach {
            approach.set_contract(contract)?;
        }
        self.contract = contract;
        Ok(())
    }

    fn enter(&mut self) -> Result<(), Refusal> {
        // The policy that ships is one.
        let policy = Policy::new(policy::embedded::words()).map_err(|_| Refusal::Choice)?;
        let drive = Drive::new(policy, self.contract, Part::Left);
        self.approach = Some(drive.enter(self.junction()?, EGO)?);
        self.last = None;
        self.commands.clear();
        Ok(())
    }

    fn decide(&mut self, words: &mut Input<'_>, out: &mut Output) -> Result<(), Refusal> {
        let now = instant(words)?;
        let ego = words.vehicle()?;
        let mut tracks = Vec::<_, TRACKS>::new();
        for _ in 0..words.word()? {
            tracks.push(track(words)?).map_err(|_| Refusal::Tracks)?;
        }
        let seen = Observation {
            ego,
            tracks: &tracks,
        };
        let approach = self.approach.as_mut().ok_or(Refusal::NotEntered)?;
        let before = approach.clone();
        let decision = approach.decide(now, &seen);
        cede_golden::answer(&decision)
            .into_iter()
            .for_each(|word| out.word(word));
        out.number(before.clone().proposal(&seen));
        for i in 0..GRID {
            let wanted = grid(&self.contract.ego(), i);
            let judged = before.shield().clone().filter(now, &seen, wanted);
            out.number(wanted);
            out.word((judged.cause == Cause::Policy).into());
            out.number(judged.margin);
        }
        self.last = Some(Last {
            ego: State {
                s: ego.s,
                v: ego.speed,
            },
            in_effect: self.in_effect(),
            acceleration: decision.acceleration,
            plan: decision.plan,
        });
        if self.commands.is_full() {
            self.commands.remove(0);
        }
        let _ = self.commands.push(decision.acceleration);
        self.say(format_args!("{decision}"));
        Ok(())
    }

    /// The least and the largest of the commands that may be in effect until one that is given now certainly is; before
    /// there are as many, anything may be.
    fn in_effect(&self) -> [f32; 2] {
        let contract = &self.contract;
        // Truncates; a command that is given exactly the response ago is followed.
        let flying = 1 + (contract.response() / contract.period() - 1.0e-3).max(0.0) as usize;
        let Some(from) = self.commands.len().checked_sub(flying) else {
            return [-contract.ego().emergency, contract.ego().acceleration];
        };
        let flying = self.commands.get(from..).unwrap_or_default().iter();
        flying.fold(
            [f32::INFINITY, f32::NEG_INFINITY],
            |[least, most], &command| [least.min(command), most.max(command)],
        )
    }

    fn plan(&self, out: &mut Output) {
        let Some((last, plan)) = self.last.and_then(|last| Some((last, last.plan?))) else {
            return;
        };
        let (contract, ego) = (&self.contract, self.contract.ego());
        let inherited = Inherited::all(contract, last.in_effect);
        let departure = margin::departure(contract, last.ego.v, &inherited, last.acceleration);
        let rest = if plan.go == 0 {
            departure.braking.rest(margin::braking(contract))
        } else {
            let time = f32::from(plan.go) * contract.period();
            margin::rest(contract, departure.most, time)
        };
        out.number(last.ego.s + rest);
        let mut state = advance(last.ego, last.acceleration);
        for period in 0..PERIODS {
            out.number(state.s);
            if state.v <= 0.0 && period >= usize::from(plan.go) {
                break;
            }
            let goes = period < usize::from(plan.go);
            let limited = state.v >= ego.max_speed;
            state = advance(
                state,
                match (goes, limited) {
                    (true, false) => ego.go,
                    (true, true) => 0.0,
                    (false, _) => -ego.braking,
                },
            );
        }
    }

    fn zones(&self, words: &mut Input<'_>, out: &mut Output) -> Result<(), Refusal> {
        let (mine, theirs) = (words.path()?, words.path()?);
        let conflict = self.junction()?.conflict(mine, theirs);
        for zone in conflict.ok_or(Refusal::NotBuilt)?.zones() {
            out.word(match zone.kind {
                ConflictKind::Merging => 1,
                ConflictKind::Following => 2,
                _ => 0,
            });
            let (ego, other, lead) = (zone.ego, zone.other, zone.lead);
            out.numbers([ego.from, ego.to, other.from, other.to, lead.from, lead.to]);
        }
        Ok(())
    }

    fn reach(&self, words: &mut Input<'_>, out: &mut Output) -> Result<(), Refusal> {
        let (s, speed, time) = (words.number()?, words.number()?, words.number()?);
        let bounds = Bounds::sensed(&self.contract, s, speed).after(&self.contract, time);
        out.numbers([bounds.s.from, bounds.s.to]);
        Ok(())
    }

    fn pose(&self, words: &mut Input<'_>, out: &mut Output) -> Result<(), Refusal> {
        let polyline = self.junction()?.polyline(words.path()?);
        let pose = polyline.ok_or(Refusal::NotBuilt)?.pose(words.number()?);
        let (position, direction) = (pose.position, pose.direction);
        out.numbers([position.x, position.y, direction.x, direction.y]);
        Ok(())
    }

    fn line(&self, words: &mut Input<'_>, out: &mut Output) -> Result<(), Refusal> {
        let id = words.path()?;
        let junction = self.junction()?;
        let path = junction.path(id).ok_or(Refusal::NotBuilt)?;
        let length = junction.polyline(id).map_or(0.0, |points| points.length());
        out.numbers([length, path.line()]);
        Ok(())
    }

    fn forget(&mut self, words: &mut Input<'_>) -> Result<(), Refusal> {
        let number = words.track_number()?;
        let approach = self.approach.as_mut().ok_or(Refusal::NotEntered)?;
        approach.forget(number);
        Ok(())
    }
}

fn named(words: &mut Input<'_>, out: &mut Output) -> Result<(), Refusal> {
    let named = match words.word()? {
        0 => Contract::WORST_CASE,
        1 => Contract::ALL_WAY_STOP,
        2 => cede_golden::INEXACT,
        _ => return Err(Refusal::Choice),
    };
    contract::write(&named, out);
    Ok(())
}

fn gap(words: &mut Input<'_>, out: &mut Output) -> Result<(), Refusal> {
    let mut rectangle = || Ok::<_, Refusal>(OrientedBox::new(words.pose()?, words.footprint()?));
    let (first, second) = (rectangle()?, rectangle()?);
    out.number(first.separation(&second));
    Ok(())
}

fn class(words: &mut Input<'_>) -> Result<Class, Refusal> {
    match words.word()? {
        0 => Ok(Class::Car),
        1 => Ok(Class::Lorry),
        2 => Ok(Class::Bicycle),
        _ => Err(Refusal::Choice),
    }
}

fn instant(words: &mut Input<'_>) -> Result<Instant, Refusal> {
    let (low, high) = (words.word()?, words.word()?);
    Ok(Instant::from_micros(u64::from(high) << 32 | u64::from(low)))
}

fn track(words: &mut Input<'_>) -> Result<Track, Refusal> {
    let (number, class) = (words.track_number()?, class(words)?);
    let path = words.path()?;
    Ok(Track::on(number, path, words.vehicle()?).class(class))
}
