//! The families of scenarios.

use super::cast::{Cast, Manners, Start};
use super::terms::Terms;
use crate::rng::Rng;
use crate::sight::Sensing;
use crate::sight::View;
use crate::sketch::{self, Users, Way};

/// Scenarios of one kind.
#[derive(Clone, Copy, Debug)]
pub struct Family {
    /// Its name, for the command line.
    pub name: &'static str,
    /// What is special about it.
    pub about: &'static str,
    /// The ways of a site.
    pub ways: fn(&mut Rng) -> Vec<Way>,
    /// The contract.
    pub terms: fn(&mut Rng) -> Terms,
    /// Who takes part.
    pub cast: fn(&mut Rng) -> Cast,
    /// What is seen.
    pub sensing: fn(&mut Rng) -> Sensing,
    /// Probability that a call is missed: beyond the contract.
    pub missed: f64,
    /// Sites mostly have an order of rights of way.
    pub ordered: bool,
    /// How long a scenario lasts at most, in s.
    pub seconds: f64,
    /// Sites in a round of a campaign: more, where scenarios have fewer decisions.
    pub sites: u64,
    /// The accelerations of others are searched for.
    pub searches: bool,
}

/// One shielded vehicle among hostile others, which see well or not.
const ONE: Family = Family {
    name: "",
    about: "",
    ways: |rng| sketch::crossroads(6, Users::Cars, rng),
    terms: |rng| Terms::usual(rng).perhaps_blurred(rng),
    cast: |rng| Cast::one(1 + rng.below(8)),
    sensing: |_| Sensing::PLAIN,
    missed: 0.0,
    ordered: false,
    seconds: 18.0,
    sites: 10,
    searches: false,
};

/// Only shielded vehicles.
const ALL: Family = Family {
    ways: |rng| sketch::star(5, Users::Cars, rng),
    terms: |rng| Terms::usual(rng).perhaps_blurred(rng).among_equals(rng),
    cast: |rng| Cast::all(2 + rng.below(4)),
    seconds: 25.0,
    sites: 3,
    ..ONE
};

/// Only shielded vehicles that keep a rule of precedence.
const STOP: Family = Family {
    ways: |rng| sketch::crossroads(6, Users::Cars, rng),
    terms: |rng| {
        Terms::usual(rng)
            .perhaps_blurred(rng)
            .among_equals(rng)
            .with_rule(rng)
    },
    ordered: true,
    seconds: 40.0,
    ..ALL
};

/// Somebody may come out from behind corners.
const CORNERS: Sensing = Sensing {
    view: View::Corners,
    ..Sensing::PLAIN
};

/// One shielded vehicle among others and up to six on foot: four are watched one by one.
const ON_FOOT: Family = Family {
    ways: |rng| sketch::with_crossings(5, Users::Mixed, rng),
    cast: |rng| Cast {
        walkers: 1 + rng.below(6),
        start: rng.pick(&[Start::Moving, Start::Far, Start::Rest]),
        ..Cast::one(rng.below(4))
    },
    ..ONE
};

/// All of them.
pub const FAMILIES: &[Family] = &[
    Family {
        name: "crossroads",
        about: "a crossing at right angles, 1 to 8 others",
        ..ONE
    },
    Family {
        name: "star",
        about: "three to five arms at any angles",
        ways: |rng| sketch::star(6, Users::Cars, rng),
        ..ONE
    },
    Family {
        name: "curves",
        about: "ways that bend all along",
        ways: |rng| sketch::curves(5, Users::Cars, rng),
        cast: |rng| Cast::one(1 + rng.below(5)),
        ..ONE
    },
    Family {
        name: "near-parallel",
        about: "ways in nearly one direction or nearly opposite ones",
        ways: |rng| sketch::near_parallel(3, Users::Mixed, rng),
        cast: |rng| Cast::one(1 + rng.below(4)),
        ..ONE
    },
    Family {
        name: "weaving",
        about: "ways that cross two or three times",
        ways: |rng| sketch::weaving(4, Users::Cars, rng),
        cast: |rng| Cast::one(1 + rng.below(4)),
        ..ONE
    },
    Family {
        name: "winding",
        about: "ways with long bends through one another",
        ways: |rng| sketch::winding(4, Users::Mixed, rng),
        cast: |rng| Cast::one(1 + rng.below(4)),
        ..ONE
    },
    Family {
        name: "corners",
        about: "ways with kinks of up to a right angle",
        ways: |rng| sketch::corners(4, Users::Mixed, rng),
        cast: |rng| Cast::one(1 + rng.below(4)),
        ..ONE
    },
    Family {
        name: "merge",
        about: "everybody leaves by one arm",
        ways: |rng| sketch::merge(4, Users::Mixed, rng),
        cast: |rng| Cast::one(1 + rng.below(6)),
        ..ONE
    },
    Family {
        name: "lane",
        about: "one behind the other, and ways across",
        ways: |rng| sketch::lanes(3, Users::Mixed, rng),
        cast: |rng| Cast {
            start: Start::Queue,
            first_lane: true,
            ..Cast::one(1 + rng.below(5))
        },
        ..ONE
    },
    Family {
        name: "lorries",
        about: "12 m long and 2.55 m wide",
        ways: |rng| sketch::star(5, Users::Lorries, rng),
        ..ONE
    },
    Family {
        name: "bicycles",
        about: "1.8 m long and 0.6 m wide",
        ways: |rng| sketch::star(5, Users::Bicycles, rng),
        ..ONE
    },
    Family {
        name: "crowd",
        about: "9 to 14 others, more than the shield has room for",
        ways: |rng| sketch::star(10, Users::Mixed, rng),
        cast: |rng| Cast::one(9 + rng.below(6)),
        ..ONE
    },
    Family {
        name: "blurred",
        about: "errors of sensors at their bounds",
        ways: |rng| sketch::star(5, Users::Mixed, rng),
        terms: |rng| Terms::usual(rng).blurred(rng),
        cast: |rng| Cast::one(1 + rng.below(4)),
        ..ONE
    },
    Family {
        name: "clocks",
        about: "other periods, calls that are early or late, any latency",
        ways: |rng| sketch::star(5, Users::Cars, rng),
        terms: |rng| Terms::usual(rng).perhaps_blurred(rng).other_times(rng),
        cast: |rng| Cast::one(1 + rng.below(4)),
        ..ONE
    },
    Family {
        name: "drivetrain",
        about: "several commands in flight, lag, gain and disturbance",
        ways: |rng| match rng.below(3) {
            0 => sketch::merge(4, Users::Mixed, rng),
            1 => sketch::crossroads(6, Users::Cars, rng),
            _ => sketch::star(5, Users::Mixed, rng),
        },
        terms: |rng| Terms::usual(rng).perhaps_blurred(rng).driven(rng),
        cast: |rng| Cast::one(1 + rng.below(5)),
        ..ONE
    },
    Family {
        name: "real-car",
        about: "delay 0.3 s, lag 0.2 s, gain ± 10 %, jitter ± 30 %, errors of 0.3 m and 0.3 m/s, tracks missing for up to 5 periods, two candidates, all at once",
        ways: |rng| match rng.below(3) {
            0 => sketch::merge(4, Users::Mixed, rng),
            1 => sketch::crossroads(9, Users::Cars, rng),
            _ => sketch::star(5, Users::Mixed, rng),
        },
        terms: |rng| Terms::usual(rng).real(rng),
        sensing: |rng| Sensing {
            gaps: 0.03,
            bursts: rng.pick(&[0.0, 0.01]),
            undecided: rng.chance(0.5),
            blinking: true,
            ..Sensing::PLAIN
        },
        cast: |rng| Cast::one(1 + rng.below(5)),
        ..ONE
    },
    Family {
        name: "on-foot",
        about: "pedestrians who walk to and fro, lurk, dart and turn back",
        ..ON_FOOT
    },
    Family {
        name: "on-foot-gaps",
        about: "the same, whose tracks are missing for a moment or for seconds, or whose states are not numbers",
        terms: |rng| Terms::usual(rng).blurred(rng).other_times(rng),
        sensing: |rng| Sensing {
            gaps: rng.pick(&[0.01, 0.05, 0.3]),
            bursts: rng.pick(&[0.0, 0.01, 0.05]),
            faults: rng.pick(&[0.0, 0.0, 0.02]),
            ..Sensing::PLAIN
        },
        ..ON_FOOT
    },
    Family {
        name: "on-foot-real-car",
        about: "pedestrians before a real car, whose sensors and drivetrain have all their deviations at once",
        terms: |rng| Terms::usual(rng).real(rng),
        sensing: |rng| Sensing {
            gaps: 0.03,
            bursts: rng.pick(&[0.0, 0.01]),
            ..Sensing::PLAIN
        },
        ..ON_FOOT
    },
    Family {
        name: "stop-on-foot",
        about: "vehicles that all have the shield and a rule of precedence, with pedestrians among them",
        ways: |rng| sketch::with_crossings(5, Users::Cars, rng),
        cast: |rng| Cast {
            walkers: 1 + rng.below(4),
            start: rng.pick(&[Start::Rest, Start::Far]),
            ..Cast::all(2 + rng.below(3))
        },
        ..STOP
    },
    Family {
        name: "gaps",
        about: "tracks are missing, for a moment or for seconds",
        ways: |rng| sketch::star(5, Users::Mixed, rng),
        sensing: |rng| Sensing {
            gaps: rng.pick(&[0.01, 0.05, 0.3]),
            bursts: rng.pick(&[0.0, 0.01, 0.05]),
            ..Sensing::PLAIN
        },
        cast: |rng| Cast::one(1 + rng.below(5)),
        ..ONE
    },
    Family {
        name: "faults",
        about: "states that are not numbers, for up to two seconds",
        sensing: |rng| Sensing {
            faults: rng.pick(&[0.01, 0.05]),
            ..Sensing::PLAIN
        },
        cast: |rng| Cast::one(1 + rng.below(5)),
        ..ONE
    },
    Family {
        name: "bystanders",
        about: "vehicles that meet nobody come and go",
        ways: |rng| sketch::with_bystanders(3, Users::Cars, rng),
        terms: |rng| Terms::usual(rng).blurred(rng),
        sensing: |_| Sensing {
            blinking: true,
            ..Sensing::PLAIN
        },
        cast: |rng| Cast::one(2 + rng.below(6)),
        ..ONE
    },
    Family {
        name: "newcomers",
        about: "others are first seen at the last moment at which they do not matter yet",
        ways: |rng| sketch::star(5, Users::Mixed, rng),
        sensing: |_| Sensing {
            newcomers: true,
            ..Sensing::PLAIN
        },
        cast: |rng| Cast {
            start: Start::Far,
            ..Cast::one(1 + rng.below(6))
        },
        ..ONE
    },
    Family {
        name: "occluded",
        about: "others come out from behind corners, which move",
        ways: |rng| match rng.below(3) {
            0 => sketch::merge(4, Users::Mixed, rng),
            1 => sketch::crossroads(6, Users::Cars, rng),
            _ => sketch::star(5, Users::Mixed, rng),
        },
        sensing: |_| CORNERS,
        cast: |rng| Cast::one(1 + rng.below(6)),
        ..ONE
    },
    Family {
        name: "occluded-drivetrain",
        about: "the same with several commands in flight, lag, gain and disturbance",
        ways: |rng| match rng.below(2) {
            0 => sketch::merge(4, Users::Mixed, rng),
            _ => sketch::star(5, Users::Mixed, rng),
        },
        terms: |rng| Terms::usual(rng).perhaps_blurred(rng).driven(rng),
        sensing: |_| CORNERS,
        cast: |rng| Cast::one(1 + rng.below(5)),
        ..ONE
    },
    Family {
        name: "undecided",
        about: "nobody knows where the others turn until they do",
        ways: |rng| sketch::crossroads(9, Users::Cars, rng),
        sensing: |_| Sensing {
            undecided: true,
            ..Sensing::PLAIN
        },
        cast: |rng| Cast::one(1 + rng.below(5)),
        ..ONE
    },
    Family {
        name: "all",
        about: "every vehicle has the shield, nobody has precedence",
        ..ALL
    },
    Family {
        name: "all-merge",
        about: "every vehicle has the shield, into one exit",
        ways: |rng| sketch::merge(4, Users::Mixed, rng),
        ..ALL
    },
    Family {
        name: "all-drivetrain",
        about: "every vehicle has the shield and a drivetrain that is late and not exact",
        ways: |rng| match rng.below(2) {
            0 => sketch::merge(4, Users::Mixed, rng),
            _ => sketch::star(5, Users::Cars, rng),
        },
        terms: |rng| {
            Terms::usual(rng)
                .perhaps_blurred(rng)
                .among_equals(rng)
                .driven(rng)
        },
        ..ALL
    },
    Family {
        name: "all-late",
        about: "shields are switched on late, nobody has precedence",
        cast: |rng| Cast {
            late: 0.6,
            ..Cast::all(2 + rng.below(4))
        },
        ..ALL
    },
    Family {
        name: "stop",
        about: "every vehicle has the shield and keeps a rule of precedence",
        ..STOP
    },
    Family {
        name: "stop-star",
        about: "the same at any angles, with lorries and bicycles, and merging",
        ways: |rng| match rng.below(3) {
            0 => sketch::merge(4, Users::Mixed, rng),
            _ => sketch::star(5, Users::Mixed, rng),
        },
        ..STOP
    },
    Family {
        name: "stop-rest",
        about: "from rest at the lines: turns",
        cast: |rng| Cast {
            start: Start::Rest,
            ..Cast::all(2 + rng.below(4))
        },
        ..STOP
    },
    Family {
        name: "stop-blurred",
        about: "two at their lines that see each other differently",
        ways: |rng| sketch::crossroads(3, Users::Cars, rng),
        terms: |rng| {
            Terms::usual(rng)
                .blurred(rng)
                .among_equals(rng)
                .with_rule(rng)
        },
        cast: |rng| Cast {
            start: rng.pick(&[Start::Rest, Start::Far]),
            ..Cast::all(2)
        },
        ..STOP
    },
    Family {
        name: "stop-late",
        about: "shields are switched on while their vehicles coast or stand",
        cast: |rng| Cast {
            late: 0.6,
            start: rng.pick(&[Start::Rest, Start::Far, Start::Moving]),
            ..Cast::all(2 + rng.below(3))
        },
        ..STOP
    },
    Family {
        name: "stop-gaps",
        about: "tracks are missing now and then",
        sensing: |rng| Sensing {
            gaps: rng.pick(&[0.01, 0.01, 0.1]),
            bursts: rng.pick(&[0.0, 0.01]),
            ..Sensing::PLAIN
        },
        cast: |rng| Cast {
            start: rng.pick(&[Start::Rest, Start::Far]),
            ..Cast::all(2 + rng.below(3))
        },
        ..STOP
    },
    Family {
        name: "stop-occluded",
        about: "vehicles that see each other late",
        sensing: |_| CORNERS,
        cast: |rng| Cast {
            start: rng.pick(&[Start::Rest, Start::Far]),
            ..Cast::all(2 + rng.below(3))
        },
        ..STOP
    },
    Family {
        name: "stop-clocks",
        about: "calls that are early or late, other periods",
        terms: |rng| {
            Terms::usual(rng)
                .perhaps_blurred(rng)
                .other_times(rng)
                .among_equals(rng)
                .with_rule(rng)
        },
        cast: |rng| Cast {
            start: rng.pick(&[Start::Rest, Start::Far]),
            ..Cast::all(2 + rng.below(3))
        },
        ..STOP
    },
    Family {
        name: "stop-drivetrain",
        about: "a rule of precedence among drivetrains that are late and not exact",
        terms: |rng| {
            Terms::usual(rng)
                .perhaps_blurred(rng)
                .among_equals(rng)
                .driven(rng)
                .with_rule(rng)
        },
        cast: |rng| Cast {
            start: rng.pick(&[Start::Rest, Start::Far]),
            ..Cast::all(2 + rng.below(3))
        },
        ..STOP
    },
    Family {
        name: "row",
        about: "from one junction to the next, everybody shielded",
        ways: |rng| sketch::row(2 + rng.below(4), Users::Cars, rng),
        cast: |rng| Cast {
            first_lane: true,
            start: rng.pick(&[Start::Rest, Start::Far]),
            ..Cast::all(2 + rng.below(5))
        },
        seconds: 45.0,
        ..STOP
    },
    Family {
        name: "humans",
        about: "a rule of precedence, and others without a shield that keep it at its very limit",
        terms: |rng| Terms::usual(rng).perhaps_blurred(rng).with_rule(rng),
        cast: |rng| Cast {
            shielded: 1 + rng.below(2),
            start: rng.pick(&[Start::Rest, Start::Far, Start::Moving]),
            ..Cast::one(1 + rng.below(5))
        },
        seconds: 30.0,
        ..STOP
    },
    Family {
        name: "everything",
        about: "gaps, faults or undecided tracks, errors, other clocks and all kinds of vehicles at once",
        ways: |rng| match rng.below(4) {
            0 => sketch::merge(4, Users::Mixed, rng),
            1 => sketch::crossroads(9, Users::Mixed, rng),
            2 => sketch::lanes(3, Users::Mixed, rng),
            _ => sketch::star(6, Users::Mixed, rng),
        },
        terms: |rng| Terms::usual(rng).blurred(rng).other_times(rng),
        sensing: |rng| {
            // Candidates take room, and of a track that is not watched nothing is known if its state is not a number.
            let undecided = rng.chance(0.5);
            Sensing {
                gaps: rng.pick(&[0.0, 0.01, 0.1]),
                bursts: rng.pick(&[0.0, 0.01]),
                faults: if undecided { 0.0 } else { 0.02 },
                undecided,
                blinking: true,
                ..Sensing::PLAIN
            }
        },
        cast: |rng| Cast::one(1 + rng.below(7)),
        ..ONE
    },
    Family {
        name: "queue",
        about: "bumper to bumper in the ego's lane and in one across, stopping and going",
        ways: |rng| match rng.below(3) {
            0 => sketch::merge(3, Users::Mixed, rng),
            1 => sketch::crossroads(4, Users::Mixed, rng),
            _ => sketch::lanes(3, Users::Mixed, rng),
        },
        cast: |rng| Cast {
            start: Start::Platoon,
            manners: Manners::Queueing,
            first_lane: true,
            ..Cast::one(3 + rng.below(8))
        },
        seconds: 30.0,
        sites: 6,
        ..ONE
    },
    Family {
        name: "jam",
        about: "10 to 20 others at rest in the junction and around it, who leave one after the other",
        ways: |rng| sketch::star(10, Users::Mixed, rng),
        cast: |rng| Cast {
            start: Start::Jam,
            manners: Manners::Leaving,
            ..Cast::one(10 + rng.below(11))
        },
        seconds: 40.0,
        sites: 4,
        ..ONE
    },
    Family {
        name: "turns",
        about: "one lane before a kink of up to a right angle and after it, and lorries in arcs",
        ways: |rng| sketch::turns(5, rng.pick(&[Users::Lorries, Users::Mixed]), rng),
        cast: |rng| Cast {
            start: rng.pick(&[Start::Moving, Start::Queue, Start::Platoon]),
            ..Cast::one(1 + rng.below(6))
        },
        ..ONE
    },
    Family {
        name: "zipper",
        about: "lanes side by side that become one",
        ways: |rng| sketch::zipper(4, Users::Mixed, rng),
        cast: |rng| Cast {
            start: rng.pick(&[Start::Moving, Start::Far, Start::Platoon]),
            ..Cast::one(1 + rng.below(6))
        },
        ..ONE
    },
    Family {
        name: "all-queue",
        about: "every vehicle has the shield, bumper to bumper, into one exit or around corners",
        ways: |rng| match rng.below(3) {
            0 => sketch::zipper(3, Users::Mixed, rng),
            1 => sketch::turns(3, Users::Mixed, rng),
            _ => sketch::merge(3, Users::Mixed, rng),
        },
        cast: |rng| Cast {
            start: Start::Platoon,
            first_lane: true,
            ..Cast::all(3 + rng.below(4))
        },
        ..ALL
    },
    Family {
        name: "blind",
        about: "the ego's own state is not a number from when it goes for a gap until after the plan",
        ways: |rng| match rng.below(3) {
            0 => sketch::weaving(4, Users::Cars, rng),
            1 => sketch::star(6, Users::Cars, rng),
            _ => sketch::crossroads(6, Users::Cars, rng),
        },
        sensing: |rng| Sensing {
            blinds: rng.pick(&[0.02, 0.1, 0.3]),
            ..Sensing::PLAIN
        },
        cast: |rng| Cast::one(2 + rng.below(6)),
        ..ONE
    },
    Family {
        name: "surprise",
        about: "others come into sight anywhere, calls are missed: a plan that is reported holds all the same",
        ways: |rng| sketch::star(5, Users::Mixed, rng),
        sensing: |_| Sensing {
            surprises: true,
            ..Sensing::PLAIN
        },
        missed: 0.02,
        cast: |rng| Cast::one(2 + rng.below(6)),
        ..ONE
    },
    Family {
        name: "stop-turns",
        about: "at the very edges of their zones, letting their turns pass, or not quite",
        ways: |rng| sketch::across(Users::Cars, rng),
        terms: |rng| {
            let mut terms = Terms::usual(rng).among_equals(rng).with_rule(rng);
            if let Some(rule) = &mut terms.rule {
                rule.patience = rng.pick(&[5, 5, 8]);
            }
            terms
        },
        cast: |_| Cast {
            start: Start::Rest,
            hesitant: true,
            first_lane: true,
            ..Cast::all(2)
        },
        ..STOP
    },
    Family {
        name: "search",
        about: "others whose accelerations a search has chosen to come as near as possible",
        ways: |rng| sketch::star(3, Users::Cars, rng),
        cast: |rng| Cast {
            manners: Manners::Searched,
            ..Cast::one(1 + rng.below(2))
        },
        seconds: 12.0,
        sites: 3,
        searches: true,
        ..ONE
    },
];
