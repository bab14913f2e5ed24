//! Who waits for ever, if everybody goes that has precedence over all others, and nothing is missed.

use crate::body::Body;
use crate::setting::{ARRIVED, Setting};
use crate::watch::{Glance, Look, Watch};
use cede_controller::dangerous::Sound;
use cede_controller::dangerous::precedence::RestState;
use cede_controller::{Instant, RightOfWay};
use core::fmt;

/// Place in the very first call.
const FAR_AWAY: i8 = -8;

/// How the vehicles come and what they know.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Story<const N: usize> {
    /// The period in which each arrives and comes to rest.
    pub arrives: [u8; N],
    /// Whether each shield is switched on only when all rest.
    pub late: [bool; N],
    /// `rights[i][j]` is what vehicle i knows of itself and j.
    pub rights: [[RightOfWay; N]; N],
}

/// How the vehicles that wait for ever come to do so.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Kind {
    /// The shield of somebody who waits was switched on at rest: it takes no turns, and nobody knows when it arrived.
    Late,
    /// Two who wait have no right of way, and arrived less than two periods apart.
    NoOrder,
    /// The rights of those who wait, or where there are none their arrivals, form a cycle.
    Cycle,
    /// Something else.
    Other,
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Late => "a shield was switched on at rest",
            Self::NoOrder => "no right of way, arrived less than two periods apart",
            Self::Cycle => "rights of way and arrivals in a cycle",
            Self::Other => "something else",
        })
    }
}

/// Plays the story for so many periods: who still waits at the end, if anybody, one flag each.
///
/// # Panics
/// If two rely on precedence over each other.
#[must_use]
pub fn waits<const N: usize>(
    setting: &Setting<N>,
    story: &Story<N>,
    periods: u16,
) -> Option<[bool; N]> {
    let mut setting = setting.clone();
    setting.rights = story.rights;
    let mut watches = [Watch::<N>::new(false); N];
    let mut gone = [false; N];
    let all = story
        .arrives
        .iter()
        .max()
        .map_or(0, |last| u16::from(*last) + 2);
    for period in 0..periods {
        let bodies = story.arrives.map(|arrives| body(arrives, period));
        let now = Instant::from_millis(1_000 + 100 * u64::from(period));
        for own in (0..N).filter(|&own| !gone[own]) {
            watches[own].on |= !story.late[own] || period > all;
            if watches[own].on {
                let look = Look::Call(bodies.map(glance));
                watches[own].does::<Sound>(&setting, own, (&bodies, now), look);
            }
        }
        let first = |one: usize| {
            let mut others = (0..N).filter(|&two| two != one);
            others.all(|two| gone[two] || watches[one].claims(two))
        };
        let going = (0..N).find(|&one| !gone[one] && period > all && first(one));
        both(&watches, &gone);
        if let Some(one) = going {
            gone[one] = true;
        }
    }
    let waits = gone.map(|gone| !gone);
    waits.contains(&true).then_some(waits)
}

fn both<const N: usize>(watches: &[Watch<N>; N], gone: &[bool; N]) {
    for one in (0..N).filter(|&one| !gone[one]) {
        for two in (0..one).filter(|&two| !gone[two]) {
            let both = watches[one].claims(two) && watches[two].claims(one);
            assert!(!both, "{one} and {two}: {watches:#?}");
        }
    }
}

fn body(arrives: u8, period: u16) -> Body {
    if period < u16::from(arrives) {
        Body {
            place: FAR_AWAY,
            speed: 9,
        }
    } else {
        Body {
            place: ARRIVED,
            speed: 0,
        }
    }
}

fn glance(body: Body) -> Glance {
    let rest = if body.speed > 0 {
        RestState::No
    } else {
        RestState::Surely
    };
    Glance::Seen(0, rest)
}

/// Why these wait.
#[must_use]
pub fn kind<const N: usize>(story: &Story<N>, waits: [bool; N]) -> Kind {
    let pairs = || {
        let all = (0..N).flat_map(|one| (0..N).map(move |two| (one, two)));
        all.filter(|&(one, two)| one != two && waits[one] && waits[two])
    };
    let no_order = |(one, two): (usize, usize)| {
        story.rights[one][two] == RightOfWay::Unsettled
            && story.arrives[one].abs_diff(story.arrives[two]) < 2
    };
    let goes_before = |(one, two): (usize, usize)| match story.rights[one][two] {
        RightOfWay::Ego => true,
        RightOfWay::Other => false,
        RightOfWay::Unsettled => story.arrives[one] + 2 <= story.arrives[two],
    };
    let cycle = pairs().any(|(one, two)| {
        goes_before((one, two))
            && (0..N).any(|three| goes_before((two, three)) && goes_before((three, one)))
    });
    if (0..N).any(|i| waits[i] && story.late[i]) {
        Kind::Late
    } else if pairs().any(no_order) {
        Kind::NoOrder
    } else if cycle {
        Kind::Cycle
    } else {
        Kind::Other
    }
}

/// Every story in which all arrive within `periods`.
#[must_use]
pub fn stories<const N: usize>(periods: u8) -> Vec<Story<N>> {
    let mut all = vec![Story {
        arrives: [1; N],
        late: [false; N],
        rights: [[RightOfWay::Unsettled; N]; N],
    }];
    for i in 0..N {
        all = vary(&all, |story, all| {
            for arrives in 1..=periods {
                for late in [false, true] {
                    let mut story = story.clone();
                    (story.arrives[i], story.late[i]) = (arrives, late);
                    all.push(story);
                }
            }
        });
        for j in 0..i {
            all = vary(&all, |story, all| {
                use RightOfWay::{Ego, Other, Unsettled};
                for [mine, its] in [[Ego, Other], [Other, Ego], [Unsettled; 2]] {
                    let mut story = story.clone();
                    (story.rights[i][j], story.rights[j][i]) = (mine, its);
                    all.push(story);
                }
            });
        }
    }
    all
}

fn vary<const N: usize>(
    stories: &[Story<N>],
    ways: impl Fn(&Story<N>, &mut Vec<Story<N>>),
) -> Vec<Story<N>> {
    let mut all = Vec::new();
    for story in stories {
        ways(story, &mut all);
    }
    all
}
