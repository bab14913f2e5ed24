//! Which sites there are, which recordings each has, and what they serve for.

use rand_pcg::Pcg64;

/// Who has to stop or to give way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Control {
    /// Everybody stops; who came first goes first.
    AllWayStop,
    /// The minor road stops and waits for a gap in the major one.
    TwoWayStop,
    /// The minor road gives way to the major one without a stop.
    Yield,
    /// Nobody has to stop; who comes from the right goes first.
    Uncontrolled,
}

/// The class of a site.
#[derive(Clone, Copy)]
pub(super) struct Class {
    pub(super) control: Control,
    pub(super) arms: usize,
    /// Whether its map has signs; without them nobody knows who has the right of way.
    pub(super) signs: bool,
    name: &'static str,
}

const fn class(control: Control, arms: usize, name: &'static str) -> Class {
    Class {
        control,
        arms,
        signs: true,
        name,
    }
}

/// The classes in turn: all-way stops most often.
const CLASSES: [Class; 12] = [
    class(Control::AllWayStop, 3, "T-AWS"),
    class(Control::AllWayStop, 4, "X-AWS"),
    class(Control::TwoWayStop, 3, "T-TWS"),
    class(Control::AllWayStop, 4, "X-AWS"),
    class(Control::TwoWayStop, 4, "X-TWS"),
    class(Control::AllWayStop, 3, "T-AWS"),
    class(Control::Yield, 4, "X-YLD"),
    class(Control::Uncontrolled, 3, "T-UNC"),
    Class {
        signs: false,
        ..class(Control::AllWayStop, 4, "X-UNK")
    },
    class(Control::TwoWayStop, 4, "X-TWS"),
    class(Control::Yield, 3, "T-YLD"),
    class(Control::Uncontrolled, 4, "X-UNC"),
];
const PER_ROUND: u16 = CLASSES.len() as u16;
/// Recordings of one site.
const RECORDINGS: u16 = 4;

/// Number of the site of recording `file`: a round of recordings is of as many sites.
pub(super) fn site_of(file: u16) -> u16 {
    file % PER_ROUND + PER_ROUND * (file / (PER_ROUND * RECORDINGS))
}

/// The recordings of site `number`.
pub(super) fn files_of(number: u16) -> impl Iterator<Item = u16> {
    let (class, round) = (number % PER_ROUND, number / PER_ROUND);
    (0..RECORDINGS).map(move |k| class + PER_ROUND * (round * RECORDINGS + k))
}

pub(super) fn class_of(number: u16) -> Class {
    CLASSES[usize::from(number % PER_ROUND)]
}

/// How the names of synthetic sites begin.
pub(super) const PREFIX: &str = "SYN-";

/// As in `SYN-T-AWS-10`.
pub(super) fn name_of(number: u16) -> String {
    format!("{PREFIX}{}-{number}", class_of(number).name)
}

/// Two of seven recordings are kept apart; seven has no factor in common with the classes.
pub(super) fn in_validation(file: u16) -> bool {
    file % 7 == 5
}

/// See [`in_validation`].
pub(super) fn in_test(file: u16) -> bool {
    file % 7 == 6
}

/// What random numbers are for; none depends on those of another item.
#[derive(Clone, Copy)]
pub(super) enum Purpose {
    Site,
    Traffic,
}

/// The random numbers of one site or recording.
pub(super) fn stream(seed: u64, item: u16, purpose: Purpose) -> Pcg64 {
    let stream = u128::from(item) << 8 | purpose as u128;
    Pcg64::new(u128::from(seed), stream)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_recording_has_one_site() {
        for file in 0..200 {
            let sites: Vec<u16> = (0..96)
                .filter(|&n| files_of(n).any(|f| f == file))
                .collect();
            assert_eq!(sites, [site_of(file)]);
        }
    }
}
