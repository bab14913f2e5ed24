//! What a map says about who gives way to whom, and about speeds.

use super::MapPoint;

/// Who gives way to whom at one place of a map: a `regulatory_element`.
#[derive(Clone, Debug, PartialEq)]
pub struct Regulation {
    /// What kind it is.
    pub kind: RegulationKind,
    /// The lanelets that have the right of way.
    pub first: Vec<usize>,
    /// The lanelets whose vehicles give way, or stop.
    pub yielding: Vec<usize>,
    /// Where those wait.
    pub lines: Vec<Vec<MapPoint>>,
    /// The sign that says so.
    pub sign: Option<Sign>,
}

impl Regulation {
    /// Each lanelet that gives way, with each that it gives way to; none at an all-way stop.
    pub fn pairs(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let of = |&yielding: &usize| self.first.iter().map(move |&first| (yielding, first));
        self.yielding.iter().flat_map(of)
    }
}

/// What kind of regulation it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RegulationKind {
    /// Everybody stops; who has stopped first goes first.
    AllWayStop,
    /// Some give way to others.
    RightOfWay,
}

impl RegulationKind {
    /// Lanelet2's `subtype`.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::AllWayStop => "all_way_stop",
            Self::RightOfWay => "right_of_way",
        }
    }
}

/// A sign that tells a vehicle to give way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sign {
    /// Stop.
    Stop,
    /// Give way.
    Yield,
}

impl Sign {
    /// The sign of a `traffic_sign` of this subtype: a country's code and the number in its catalogue. `None`
    /// for a sign that tells nobody to give way.
    pub(super) fn named(subtype: &str) -> Option<Self> {
        match subtype {
            "usR1-1" | "de206" => Some(Self::Stop),
            "usR1-2" | "de205" => Some(Self::Yield),
            _ => None,
        }
    }
}

/// The speed (m/s) of a `sign_type` such as `40mph`, `50km/h`, or `de274-50`, which is in km/h; `None` for any
/// other text.
pub(super) fn speed_of(sign: &str) -> Option<f64> {
    const MILE_PER_HOUR: f64 = 0.447_04;
    const KILOMETRE_PER_HOUR: f64 = 1.0 / 3.6;
    let text = sign.trim();
    let (number, unit) = if let Some(number) = text.strip_prefix("de274-") {
        (number, KILOMETRE_PER_HOUR)
    } else if let Some(number) = text.strip_suffix("mph") {
        (number, MILE_PER_HOUR)
    } else {
        let number = text
            .strip_suffix("km/h")
            .or_else(|| text.strip_suffix("kmh"))?;
        (number, KILOMETRE_PER_HOUR)
    };
    let value: f64 = number.trim().parse().ok()?;
    (value.is_finite() && value > 0.0).then_some(value * unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speeds_are_read_in_their_units() {
        let close = |text, expected: f64| (speed_of(text).unwrap() - expected).abs() < 1e-9;
        assert!(close("40mph", 17.881_6));
        assert!(close("25 mph", 11.176));
        assert!(close("50 km/h", 50.0 / 3.6) && close("de274-30", 30.0 / 3.6));
        for text in ["", "40", "mph", "-5mph", "NaNmph", "fast"] {
            assert_eq!(speed_of(text), None, "{text}");
        }
    }
}
