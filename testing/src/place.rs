//! Junctions to drive across: a few shapes, each with all the roads that a case may use.

use cede_controller::{
    Class, Footprint, Junction, JunctionError, PathId, Point, Route, RouteError,
};
use std::fmt;

/// Roads of every junction here.
pub(crate) const ROADS: usize = 6;
/// Points of all of them, at most.
const POINTS: usize = 128;

/// The junction type of all cases.
pub type TestJunction = Junction<ROADS, POINTS>;

/// How the roads meet. Simple ones come first: cases shrink towards them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Shape {
    /// Two straight roads cross at a right angle.
    RightAngle,
    /// Two straight roads cross at so many degrees, 20 to 160.
    Skew(u8),
    /// The ego follows a road that another crosses further on.
    Following,
    /// The ego's road joins another at so many degrees, 10 to 60.
    Merging(u8),
    /// The ego turns left across an oncoming lane.
    LeftTurn,
    /// The ego turns right, into the lane of another road.
    RightTurn,
    /// The ego's road is an S, and another crosses it in its middle.
    SBend,
}

/// A road of a junction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Road {
    /// The ego's.
    Own,
    /// That of a car which crosses, merges, leads or comes towards the ego, as the shape says.
    First,
    /// That of a second car.
    Second,
    /// The first one, for a lorry.
    FirstLorry,
    /// The second one, for a bicycle.
    SecondBicycle,
    /// A road far away, which has nothing to do with the ego.
    Away,
}

/// A junction, as a few numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// How the roads meet.
    pub shape: Shape,
    /// Metres of road before and after the middle, 40 to 230.
    pub arm: u16,
    /// Centimetres by which vehicles may be off their routes, 0 to 30.
    pub tolerance: u8,
    /// Whom the rights of way favour.
    pub right: Right,
}

/// The order of the rights of way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Right {
    /// None is given.
    Nobody,
    /// The ego goes before everybody.
    Ego,
    /// Everybody goes before the ego.
    Others,
}

impl Road {
    /// All of them, in the order of their paths.
    pub const ALL: [Self; ROADS] = [
        Self::Own,
        Self::First,
        Self::Second,
        Self::FirstLorry,
        Self::SecondBicycle,
        Self::Away,
    ];

    /// Its path in the junctions of [`Place::junction`].
    #[must_use]
    pub const fn path(self) -> PathId {
        PathId::new(self as u8)
    }

    /// What drives there.
    #[must_use]
    pub const fn class(self) -> Class {
        match self {
            Self::FirstLorry => Class::Lorry,
            Self::SecondBicycle => Class::Bicycle,
            _ => Class::Car,
        }
    }

    /// What it covers (m), if the ego's footprint is `own`.
    #[must_use]
    pub const fn footprint(self, own: Footprint) -> Footprint {
        match self {
            Self::Own => own,
            Self::FirstLorry => Footprint {
                length: 12.0,
                width: 2.55,
            },
            Self::SecondBicycle => Footprint {
                length: 1.8,
                width: 0.6,
            },
            _ => Footprint::PAPER,
        }
    }
}

/// Points of a road in metres.
type Points = Vec<(f64, f64)>;

impl Place {
    /// The junction; the ego's footprint is `own`.
    ///
    /// Cost: about 0.1 ms.
    ///
    /// # Errors
    /// [`JunctionError::Footprint`].
    pub fn junction(&self, own: Footprint) -> Result<TestJunction, JunctionError> {
        let mut builder = TestJunction::builder();
        builder.tolerance(f32::from(self.tolerance) / 100.0);
        let footprint = |road: Road| road.footprint(own);
        let roads = self.roads();
        for (road, points) in [Road::Own, Road::First, Road::Second]
            .into_iter()
            .zip(&roads)
        {
            builder.path(&route(points), road.class(), footprint(road))?;
        }
        for (of, road) in [
            (Road::First, Road::FirstLorry),
            (Road::Second, Road::SecondBicycle),
        ] {
            builder.variant(of.path(), road.class(), footprint(road))?;
        }
        let away = route(&vec![(-200.0, 900.0), (200.0, 900.0)]);
        builder.path(&away, Class::Car, footprint(Road::Away))?;
        for (first, second) in self.rights() {
            builder.right_of_way(first.path(), second.path())?;
        }
        builder.build()
    }

    /// Whether a vehicle on `road` is in the ego's lane from the start.
    #[must_use]
    pub const fn begins_in_one_lane(&self, road: Road) -> bool {
        match self.shape {
            Shape::Following => matches!(road, Road::Own | Road::First | Road::FirstLorry),
            Shape::LeftTurn => matches!(road, Road::Own | Road::Second | Road::SecondBicycle),
            _ => matches!(road, Road::Own),
        }
    }

    /// Who goes before whom: one order of all roads.
    fn rights(&self) -> Vec<(Road, Road)> {
        let mut order = Road::ALL.to_vec();
        match self.right {
            Right::Nobody => return Vec::new(),
            Right::Ego => {}
            Right::Others => order.reverse(),
        }
        let pairs = order.iter().enumerate();
        pairs
            .flat_map(|(i, first)| order[i + 1..].iter().map(|second| (*first, *second)))
            .collect()
    }

    /// The ego's road, the first and the second other's.
    fn roads(&self) -> [Points; 3] {
        let arm = f64::from(self.arm);
        let straight = |(x, y): (f64, f64), degrees: f64| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            vec![
                (x - arm * cos, y - arm * sin),
                (x + arm * cos, y + arm * sin),
            ]
        };
        let east = straight((0.0, 0.0), 0.0);
        match self.shape {
            Shape::RightAngle => [
                east,
                straight((0.0, 0.0), 90.0),
                straight((-4.0, 0.0), -90.0),
            ],
            Shape::Skew(degrees) => {
                let angle = f64::from(degrees);
                [
                    east,
                    straight((0.0, 0.0), angle),
                    straight((6.0, 0.0), angle - 180.0),
                ]
            }
            Shape::Following => [east.clone(), east, straight((20.0, 0.0), 90.0)],
            Shape::Merging(degrees) => {
                let (sin, cos) = f64::from(degrees).to_radians().sin_cos();
                let ramp = vec![(-arm * cos, -arm * sin), (0.0, 0.0), (arm, 0.0)];
                [ramp, east, straight((25.0, 0.0), 90.0)]
            }
            Shape::LeftTurn => [
                turn(arm, 1.0),
                straight((0.0, 4.0), 180.0),
                vec![(-arm, -2.0), (arm, -2.0)],
            ],
            Shape::RightTurn => [
                turn(arm, -1.0),
                vec![(2.0, arm), (2.0, -arm)],
                straight((0.0, 4.0), 180.0),
            ],
            Shape::SBend => [
                s_bend(arm),
                straight((0.0, 0.0), 60.0),
                straight((15.0, 0.0), -90.0),
            ],
        }
    }
}

/// From the west, in bends of 10° to the north (`side` 1) or the south (−1), 8 m wide.
fn turn(arm: f64, side: f64) -> Points {
    let start = -2.0 * side;
    let mut points = vec![(-arm, start)];
    points.extend((0..=9).map(|i| {
        let (sin, cos) = f64::from(i * 10).to_radians().sin_cos();
        (-6.0 + 8.0 * sin, start + side * (8.0 - 8.0 * cos))
    }));
    points.push((2.0, start + side * arm));
    points
}

/// West to east, from 6 m south of the middle to 6 m north of it.
fn s_bend(arm: f64) -> Points {
    let mut points = vec![(-arm, -6.0)];
    points.extend((-10..=10).map(|i| {
        let x = f64::from(i) * 2.0;
        (x, 6.0 * (x / 20.0 * std::f64::consts::FRAC_PI_2).sin())
    }));
    points.push((arm, 6.0));
    points
}

fn route(points: &Points) -> Route<32> {
    let points = points.iter().map(|&(x, y)| Point::new(x as f32, y as f32));
    let route: Result<_, RouteError> = Route::new(points);
    route.expect("every shape has few points, which are apart and near the origin")
}

impl fmt::Display for Shape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::RightAngle => f.write_str("two straight roads cross at a right angle"),
            Self::Skew(degrees) => write!(f, "two straight roads cross at {degrees}°"),
            Self::Following => f.write_str("one straight road, and another crosses it 20 m on"),
            Self::Merging(degrees) => write!(f, "the ego's road joins another at {degrees}°"),
            Self::LeftTurn => f.write_str("the ego turns left across an oncoming lane"),
            Self::RightTurn => f.write_str("the ego turns right into the lane of another road"),
            Self::SBend => f.write_str("another road crosses the ego's S-bend"),
        }
    }
}

impl fmt::Display for Road {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Own => "a car on the ego's road",
            Self::First => "a car on the first road",
            Self::Second => "a car on the second road",
            Self::FirstLorry => "a lorry on the first road",
            Self::SecondBicycle => "a bicycle on the second road",
            Self::Away => "a car on a road far away",
        })
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            shape,
            arm,
            tolerance,
            right,
        } = self;
        write!(
            f,
            "{shape}; arms of {arm} m, vehicles up to {tolerance} cm off their routes"
        )?;
        match right {
            Right::Nobody => Ok(()),
            Right::Ego => f.write_str("; the ego has the right of way"),
            Right::Others => f.write_str("; the others have the right of way"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cede_controller::{ConflictKind, Zone};

    fn kinds(shape: Shape) -> [ConflictKind; ROADS] {
        let place = Place {
            shape,
            arm: 80,
            tolerance: 10,
            right: Right::Ego,
        };
        let junction = place.junction(Footprint::PAPER).unwrap();
        Road::ALL.map(|road| {
            junction
                .conflict(Road::Own.path(), road.path())
                .unwrap()
                .kind
        })
    }

    #[test]
    fn shapes_meet_as_they_say() {
        use ConflictKind::{Crossing, Following, Merging, None};
        let all = [
            (Shape::RightAngle, Crossing, Crossing),
            (Shape::Skew(45), Crossing, Crossing),
            (Shape::Following, Following, Crossing),
            (Shape::Merging(30), Merging, Crossing),
            (Shape::LeftTurn, Crossing, Following),
            (Shape::SBend, Crossing, Crossing),
        ];
        for (shape, first, second) in all {
            let found = kinds(shape);
            assert_eq!(found[1..3], [first, second], "{shape}");
            assert_eq!(found[5], None, "{shape}");
        }
        let place = Place {
            shape: Shape::RightTurn,
            arm: 80,
            tolerance: 10,
            right: Right::Ego,
        };
        let junction = place.junction(Footprint::PAPER).unwrap();
        let conflict = junction
            .conflict(Road::Own.path(), Road::First.path())
            .unwrap();
        assert!(conflict.zones().any(Zone::is_lane));
    }
}
