//! A place where ways meet: the attacker's own polylines beside the junction that the controller is given.

use crate::lane::{Lane, Leg};
use crate::numbers::Numbers;
use crate::polyline::Polyline;
use crate::rng::Rng;
use crate::shared::Shared;
use crate::sketch::{Kind, Way};
use cede_controller::{
    Class, Footprint, Junction, JunctionError, Point, Priority, Route, RouteError, Zone,
};
use std::sync::OnceLock;

/// Most paths of a junction.
pub const PATHS: usize = 16;
/// Most points of all of its paths.
pub const POINTS: usize = 1536;

/// The junction that is attacked.
pub type Room = Junction<PATHS, POINTS>;

/// A conflict zone of the controller's, in arc lengths of the lanes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Area {
    /// Of the ego.
    pub ego: [f64; 2],
    /// Of the other.
    pub other: [f64; 2],
    /// The ego's less the other's.
    pub lead: [f64; 2],
    /// Both run along one lane in it.
    pub lane: bool,
}

/// Ways, the junctions that they make, and how they meet there.
#[derive(Debug)]
pub struct Site {
    /// The lanes.
    pub lanes: Vec<Lane>,
    /// The junctions, one after the other.
    pub junctions: Vec<Box<Room>>,
    /// The areas of each lane with each lane.
    areas: Vec<Vec<Area>>,
    /// The stretches that each lane shares with each lane, found when they are asked for.
    shared: Vec<OnceLock<Vec<Shared>>>,
    /// Whose vehicles go first in a tie: the lanes in order. None: nobody's.
    pub order: Option<Vec<usize>>,
    /// When that counts.
    pub priority: Priority,
    /// How far vehicles may be from their lanes.
    pub tolerance: f64,
}

/// Why the controller refuses a site.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refusal {
    /// A route.
    Route(RouteError),
    /// A junction.
    Junction(JunctionError),
}

impl From<RouteError> for Refusal {
    fn from(error: RouteError) -> Self {
        Self::Route(error)
    }
}

impl From<JunctionError> for Refusal {
    fn from(error: JunctionError) -> Self {
        Self::Junction(error)
    }
}

fn class(kind: Kind) -> Class {
    match kind {
        Kind::Car => Class::Car,
        Kind::Lorry => Class::Lorry,
        Kind::Bicycle => Class::Bicycle,
        Kind::Pedestrian => Class::Pedestrian,
    }
}

impl Site {
    /// The site of `ways`, whose vehicles may be `tolerance` m beside them; with rights of way by the lanes' `order`.
    ///
    /// # Errors
    /// What the controller refuses.
    pub fn new(ways: &[Way], tolerance: f64, order: Option<Vec<usize>>) -> Result<Self, Refusal> {
        Self::with_lines(ways, tolerance, (order, Priority::FirstCome), None)
    }

    /// The same with an order that counts as the priority says. The junctions are told lines, so many metres before the
    /// first zones.
    ///
    /// # Errors
    /// What the controller refuses.
    pub fn with_lines(
        ways: &[Way],
        tolerance: f64,
        (order, priority): (Option<Vec<usize>>, Priority),
        back: Option<f64>,
    ) -> Result<Self, Refusal> {
        let count = ways
            .iter()
            .flat_map(|way| &way.cuts)
            .map(|cut| cut.junction + 1);
        let mut site = Self {
            lanes: ways.iter().map(lane).collect(),
            junctions: Vec::new(),
            areas: vec![Vec::new(); ways.len() * ways.len()],
            shared: vec![OnceLock::new(); ways.len() * ways.len()],
            order,
            priority,
            tolerance,
        };
        for junction in 0..count.max().unwrap_or(0) {
            site.add_junction(ways, junction, back)?;
        }
        Ok(site)
    }

    fn add_junction(
        &mut self,
        ways: &[Way],
        junction: usize,
        back: Option<f64>,
    ) -> Result<(), Refusal> {
        let mut builder = Room::builder();
        builder.tolerance(self.tolerance as f32);
        let mut there = Vec::new();
        for (number, way) in ways.iter().enumerate() {
            let Some(cut) = way.cuts.iter().find(|cut| cut.junction == junction) else {
                continue;
            };
            let points = &way.points[cut.from..cut.to];
            let route = Route::<256>::new(points.iter().map(|p| Point::new(p[0], p[1])))?;
            let footprint = Footprint {
                length: way.size.length as f32,
                width: way.size.width as f32,
            };
            let path = builder.path(&route, class(way.kind), footprint)?;
            if way.kind == Kind::Pedestrian {
                builder.pace(path, way.pace as f32)?;
            }
            let leg = Leg {
                junction,
                path,
                offset: self.lanes[number].line.arc()[cut.from],
                length: route.length().into(),
            };
            self.lanes[number].legs.push(leg);
            there.push((number, leg));
        }
        let rank = |lane: usize| {
            let order = self.order.as_ref()?;
            order.iter().position(|&other| other == lane)
        };
        for &(a, leg_a) in &there {
            for &(b, leg_b) in &there {
                if a != b && rank(a).zip(rank(b)).is_some_and(|(a, b)| a < b) {
                    builder.priority(leg_a.path, leg_b.path, self.priority)?;
                }
            }
        }
        if let Some(back) = back {
            let first_zones = builder.clone().build()?;
            for (_, leg) in &there {
                let line = first_zones.path(leg.path).map_or(0.0, |path| path.line());
                builder.line(leg.path, (line - back as f32).max(0.0))?;
            }
        }
        let built = Box::new(builder.build()?);
        for &(a, leg_a) in &there {
            for &(b, leg_b) in &there {
                let conflict = built.conflict(leg_a.path, leg_b.path);
                let zones = conflict.into_iter().flat_map(|conflict| conflict.zones());
                let found = zones.map(|zone| area(zone, leg_a.offset, leg_b.offset));
                self.areas[a * ways.len() + b].extend(found);
            }
        }
        self.junctions.push(built);
        Ok(())
    }

    /// How many lanes are of vehicles. Those of pedestrians come after them.
    #[must_use]
    pub fn roads(&self) -> usize {
        let walks = |lane: &&Lane| lane.class == Class::Pedestrian;
        self.lanes.len() - self.lanes.iter().filter(walks).count()
    }

    /// The zones of a vehicle on lane `ego` with one on lane `other`.
    #[must_use]
    pub fn areas(&self, ego: usize, other: usize) -> &[Area] {
        &self.areas[ego * self.lanes.len() + other]
    }

    /// The stretches in which lane `ego` and lane `other` are one, by the attacker's own geometry.
    #[must_use]
    pub fn shared(&self, ego: usize, other: usize) -> &[Shared] {
        let lanes = [ego, other].map(|lane| &self.lanes[lane]);
        self.shared[ego * self.lanes.len() + other]
            .get_or_init(|| Shared::between(lanes[0], lanes[1], self.tolerance))
    }

    /// Whether vehicles of lane `ego` go before those of lane `other` in a tie; none if nobody says so.
    #[must_use]
    pub fn goes_first(&self, ego: usize, other: usize) -> Option<bool> {
        let order = self.order.as_ref()?;
        let rank = |lane| order.iter().position(|&there| there == lane);
        Some(rank(ego)? < rank(other)?)
    }

    /// A random order of the lanes.
    #[must_use]
    pub fn random_order(lanes: usize, rng: &mut Rng) -> Vec<usize> {
        let mut order: Vec<usize> = (0..lanes).collect();
        rng.shuffle(&mut order);
        order
    }

    /// Where on a lane its vehicles wait, by the controller.
    #[must_use]
    pub fn line(&self, lane: usize) -> f64 {
        let leg = self.lanes[lane].legs[0];
        let path = self.junctions[leg.junction].path(leg.path);
        leg.offset + path.map_or(0.0, |path| f64::from(path.line()))
    }

    /// Whether `contract` tells who is ahead in every lane.
    #[must_use]
    pub fn suits(&self, numbers: &Numbers) -> bool {
        let lanes = self.areas.iter().flatten().filter(|area| area.lane);
        let widths = lanes.map(|area| area.lead[1] - area.lead[0]);
        numbers.position_error < 0.249 * widths.fold(f64::INFINITY, f64::min)
    }
}

fn lane(way: &Way) -> Lane {
    let line = Polyline::new(&way.points);
    Lane {
        jump: 2.0 * way.size.radius() * (0.5 * line.sharpest()).sin(),
        line,
        size: way.size,
        class: class(way.kind),
        pace: way.pace,
        legs: Vec::new(),
        entry: way.entry,
    }
}

fn area(zone: &Zone, ego: f64, other: f64) -> Area {
    Area {
        ego: [f64::from(zone.ego.from) + ego, f64::from(zone.ego.to) + ego],
        other: [
            f64::from(zone.other.from) + other,
            f64::from(zone.other.to) + other,
        ],
        lead: [
            f64::from(zone.lead.from) + ego - other,
            f64::from(zone.lead.to) + ego - other,
        ],
        lane: zone.is_lane(),
    }
}
