//! Which tracks of a site meet: from a small scene description, or from headings alone.

use super::error::{DataError, Problem};
use super::tracks::{RawState, Track, wrap};
use crate::role::Manoeuvre;
use cede_controller::ConflictKind;
use serde::Deserialize;
use std::f64::consts::PI;
use std::path::Path;

/// Scene descriptions that come with the program.
const EMBEDDED: [(&str, &str); 1] = [("EP0", include_str!("sites/EP0.toml"))];

/// Degrees by which the other's first heading may differ from the reverse of the left-turner's.
const ONCOMING_DEGREES: f64 = 50.0;
/// Tracks whose last headings differ by less (degrees) leave by the same exit.
const SAME_EXIT_DEGREES: f64 = 45.0;

/// A site: its name, where its recordings are, and which tracks meet there.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Site {
    /// The name, as in `EP0`.
    pub name: String,
    /// Name of the folder of its recordings, as in `DR_USA_Intersection_EP0`.
    pub folder: String,
    /// Which files serve for what.
    #[serde(default)]
    pub split: Files,
    /// Whether every two vehicles whose ways cross or merge make a pair, not only left-turners
    /// and those that they meet: more to learn from, but not what a site is judged on.
    #[serde(default)]
    pub every_pair: bool,
    #[serde(default, rename = "arm")]
    arms: Vec<Arm>,
    #[serde(default, rename = "movement")]
    movements: Vec<Movement>,
    #[serde(default, rename = "conflict")]
    conflicts: Vec<Conflict>,
    #[serde(skip)]
    described: bool,
}

/// Numbers of the recording files kept for validation and test; all others are for training.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Files {
    /// Files on which training is stopped and compared.
    pub validation: Vec<u16>,
    /// Files that nothing is fitted to.
    pub test: Vec<u16>,
}

impl Default for Files {
    /// As the paper's site has them: file 4 for validation, file 7 for test.
    fn default() -> Self {
        Self {
            validation: vec![4],
            test: vec![7],
        }
    }
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Arm {
    name: String,
    above_x: Option<f64>,
    below_x: Option<f64>,
    above_y: Option<f64>,
    below_y: Option<f64>,
}

#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Way {
    from: String,
    to: String,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Movement {
    way: Way,
    manoeuvre: Manoeuvre,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Conflict {
    left: Way,
    other: Way,
    #[serde(deserialize_with = "kind")]
    kind: ConflictKind,
}

fn kind<'d, D: serde::Deserializer<'d>>(deserializer: D) -> Result<ConflictKind, D::Error> {
    let name = String::deserialize(deserializer)?;
    match name.as_str() {
        "crossing" => Ok(ConflictKind::Crossing),
        "merging" => Ok(ConflictKind::Merging),
        "following" => Ok(ConflictKind::Following),
        _ => Err(serde::de::Error::unknown_variant(
            &name,
            &["crossing", "merging", "following"],
        )),
    }
}

impl Arm {
    fn holds(&self, state: RawState) -> bool {
        self.above_x.is_none_or(|x| state.x > x)
            && self.below_x.is_none_or(|x| state.x < x)
            && self.above_y.is_none_or(|y| state.y > y)
            && self.below_y.is_none_or(|y| state.y < y)
    }
}

impl Site {
    /// The site called `name`: a path of a scene description (`….toml`), one that
    /// comes with the program (`EP0`), or else any name, read by the rule on headings.
    /// A folder of INTERACTION (`DR_USA_Intersection_EP0`) is called by the end of its name.
    ///
    /// # Errors
    /// When the file cannot be read or is not a scene description.
    pub fn named(name: &str) -> Result<Self, DataError> {
        let path = Path::new(name);
        if path
            .extension()
            .is_some_and(|extension| extension == "toml")
        {
            return Self::read(path);
        }
        let short = short(name);
        match EMBEDDED.iter().find(|(known, _)| *known == short) {
            Some((_, text)) => Self::parse(path, text),
            None => Ok(Self {
                name: short.to_owned(),
                ..Self::by_headings(name)
            }),
        }
    }

    /// The site that the scene description at `path` describes.
    pub(crate) fn read(path: &Path) -> Result<Self, DataError> {
        let text = std::fs::read_to_string(path)
            .map_err(|error| DataError::new(path, Problem::Unreadable(error)))?;
        Self::parse(path, &text)
    }

    /// A site whose manoeuvres are told by headings: left +50° to +130°, straight
    /// within 40°, right −50° to −130°; a left-turner meets whoever starts within
    /// 50° of the opposite heading.
    #[must_use]
    pub fn by_headings(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            folder: name.to_owned(),
            split: Files::default(),
            every_pair: false,
            arms: Vec::new(),
            movements: Vec::new(),
            conflicts: Vec::new(),
            described: false,
        }
    }

    /// Whether headings alone tell its manoeuvres and who meets whom: there is no scene description.
    pub(crate) fn is_by_headings(&self) -> bool {
        !self.described && !self.every_pair
    }

    /// What whoever asked for recordings of this site should know: that nothing describes it.
    #[must_use]
    pub fn remark(&self) -> Option<String> {
        let Self { name, .. } = self;
        self.is_by_headings().then(|| {
            format!("site {name}: no description (no {name}.toml beside its recordings); headings tell who turns left and meets whom")
        })
    }

    pub(crate) fn parse(path: &Path, text: &str) -> Result<Self, DataError> {
        let mut site: Self = toml::from_str(text).map_err(|error| {
            DataError::new(path, Problem::Site(error.to_string().trim_end().to_owned()))
        })?;
        site.check()
            .map_err(|problem| DataError::new(path, Problem::Site(problem)))?;
        site.described = true;
        Ok(site)
    }

    /// Every arm that is named must exist: a misspelt one would silently match nothing.
    fn check(&self) -> Result<(), String> {
        let of_movements = self.movements.iter().map(|movement| &movement.way);
        let of_conflicts = self.conflicts.iter().flat_map(|c| [&c.left, &c.other]);
        for name in of_movements
            .chain(of_conflicts)
            .flat_map(|w| [&w.from, &w.to])
        {
            if !self.arms.iter().any(|arm| &arm.name == name) {
                return Err(format!("there is no arm `{name}`"));
            }
        }
        Ok(())
    }

    /// What `track` does: as described for its arms, or else by its change of heading.
    #[must_use]
    pub fn manoeuvre(&self, track: &Track) -> Manoeuvre {
        let way = self.way(track);
        let described = self.movements.iter().find(|m| Some(&m.way) == way.as_ref());
        described.map_or_else(|| by_turn(track.turn()), |movement| movement.manoeuvre)
    }

    /// How `left` and `other` conflict if their polylines cross; `None` if they do not make a pair.
    #[must_use]
    pub fn conflict(&self, left: &Track, other: &Track) -> Option<ConflictKind> {
        if self.every_pair {
            return conflict_of_any(left, other);
        }
        if self.conflicts.is_empty() {
            return conflict_by_headings(left, other);
        }
        let (left, other) = (self.way(left)?, self.way(other)?);
        let matching = |c: &&Conflict| c.left == left && c.other == other;
        self.conflicts.iter().find(matching).map(|c| c.kind)
    }

    fn way(&self, track: &Track) -> Option<Way> {
        let arm = |state| {
            let holding = self.arms.iter().find(|arm| arm.holds(state))?;
            Some(holding.name.clone())
        };
        Some(Way {
            from: arm(track.first())?,
            to: arm(track.last())?,
        })
    }
}

/// What a site is called whose folder has the name `folder`: the end of INTERACTION's names, else all of it.
fn short(folder: &str) -> &str {
    match folder.rsplit_once('_') {
        Some((beginning, end)) if beginning.starts_with("DR_") && !end.is_empty() => end,
        _ => folder,
    }
}

pub(crate) fn by_turn(turn: f64) -> Manoeuvre {
    match turn.to_degrees() {
        50.0..=130.0 => Manoeuvre::Left,
        -130.0..=-50.0 => Manoeuvre::Right,
        degrees if degrees.abs() < 40.0 => Manoeuvre::Straight,
        _ => Manoeuvre::Unknown,
    }
}

/// The conflict of any two vehicles that come from different sides; each pair is told once.
fn conflict_of_any(one: &Track, other: &Track) -> Option<ConflictKind> {
    let apart = |a: RawState, b: RawState| wrap(a.heading - b.heading).abs().to_degrees();
    let once = one.id < other.id;
    let sides = apart(one.first(), other.first()) >= SAME_EXIT_DEGREES;
    let merging = apart(one.last(), other.last()) < SAME_EXIT_DEGREES;
    (once && sides).then_some(if merging {
        ConflictKind::Merging
    } else {
        ConflictKind::Crossing
    })
}

/// Whether `other` comes from ahead of `one`.
pub(crate) fn is_oncoming(one: RawState, other: RawState) -> bool {
    let difference = wrap(other.heading - one.heading - PI);
    difference.abs().to_degrees() <= ONCOMING_DEGREES
}

fn conflict_by_headings(left: &Track, other: &Track) -> Option<ConflictKind> {
    let apart = |a: RawState, b: RawState| wrap(a.heading - b.heading).abs().to_degrees();
    let meets = by_turn(left.turn()) == Manoeuvre::Left && is_oncoming(left.first(), other.first());
    let merging = apart(left.last(), other.last()) < SAME_EXIT_DEGREES;
    meets.then_some(if merging {
        ConflictKind::Merging
    } else {
        ConflictKind::Crossing
    })
}
