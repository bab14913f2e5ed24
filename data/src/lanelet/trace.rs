//! Which lanelets a recorded vehicle drove along.

use super::lane::apart;
use super::{Lanelet, Map, MapPoint};
use crate::tracks::{RawState, Track, wrap};

/// A vehicle is on no lanelet whose middle is farther away than this (m).
const FARTHEST: f64 = 4.0;
/// A vehicle is on no lanelet whose direction differs by more than this (rad).
const STEEPEST: f64 = 1.05;
/// What a metre beside the middle costs as much as: an angle in rad to the lanelet's direction.
const METRE: f64 = 0.35;
/// The cost of changing to a lanelet that does not follow: that of 4 m beside the middle.
const JUMP: f64 = 16.0;
/// States are looked at when the vehicle has moved this far (m).
const STRIDE: f64 = 0.5;

/// The lanelets along which a vehicle drove, in their order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Trace(pub Vec<OnLanelet>);

/// A lanelet of a [`Trace`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OnLanelet {
    /// Its index in the map's list.
    pub lanelet: usize,
    /// Index of the track's first state on it.
    pub from: usize,
    /// Whether it does not follow the lanelet before it in the trace.
    pub changed: bool,
}

impl Trace {
    /// Whether the vehicle drove along one of `lanelets`, which it did not come to by a change of lanes.
    #[must_use]
    pub fn follows(&self, lanelets: &[usize]) -> bool {
        let mut on = self.0.iter();
        on.any(|on| !on.changed && lanelets.contains(&on.lanelet))
    }
}

/// The cheapest way to be on a lanelet at a state.
#[derive(Clone, Copy)]
struct Node {
    lanelet: usize,
    cost: f64,
    /// Place of the node before it in the layer before.
    before: usize,
}

impl Map {
    /// The lanelets that explain `track` best: each state costs its distance from the middle of its lanelet
    /// and the angle to it, squared, and so does a change to a lanelet that does not follow (Viterbi's algorithm).
    ///
    /// Empty if the track is nowhere on the map. Cost: O(states · lanelets).
    #[must_use]
    pub fn trace(&self, track: &Track) -> Trace {
        let mut layers: Vec<(usize, Vec<Node>)> = Vec::new();
        let mut last: Option<MapPoint> = None;
        for (index, state) in track.states.iter().enumerate() {
            if last.is_some_and(|last| apart(&last, &state.position()) < STRIDE) {
                continue;
            }
            let layer = self.layer(state, layers.last().map_or(&[], |(_, nodes)| nodes));
            if !layer.is_empty() {
                last = Some(state.position());
                layers.push((index, layer));
            }
        }
        self.backwards(&layers)
    }

    fn layer(&self, state: &RawState, before: &[Node]) -> Vec<Node> {
        let on = self.lanelets.iter().enumerate();
        let costs = on.filter_map(|(lanelet, shape)| Some((lanelet, shape.cost(state)?)));
        let node = |(lanelet, cost)| {
            let reached = |node: &Node| {
                let follows = node.lanelet == lanelet
                    || self.lanelets[node.lanelet].successors.contains(&lanelet);
                node.cost + if follows { 0.0 } else { JUMP }
            };
            let ways = before.iter().map(reached).enumerate();
            let (before, so_far) = ways.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or_default();
            Node {
                lanelet,
                cost: so_far + cost,
                before,
            }
        };
        costs.map(node).collect()
    }

    /// The cheapest way through the layers.
    fn backwards(&self, layers: &[(usize, Vec<Node>)]) -> Trace {
        let cheapest = |nodes: &[Node]| {
            let costs = nodes.iter().map(|node| node.cost).enumerate();
            costs
                .min_by(|a, b| a.1.total_cmp(&b.1))
                .map(|(place, _)| place)
        };
        let mut place = layers.last().and_then(|(_, nodes)| cheapest(nodes));
        let mut trace: Vec<OnLanelet> = Vec::new();
        for (from, nodes) in layers.iter().rev() {
            let Some(node) = place.and_then(|place| nodes.get(place)) else {
                break;
            };
            match trace.last_mut() {
                Some(on) if on.lanelet == node.lanelet => on.from = *from,
                after => {
                    if let Some(after) = after {
                        let successors = &self.lanelets[node.lanelet].successors;
                        after.changed = !successors.contains(&after.lanelet);
                    }
                    trace.push(OnLanelet {
                        lanelet: node.lanelet,
                        from: *from,
                        changed: false,
                    });
                }
            }
            place = Some(node.before);
        }
        trace.reverse();
        Trace(trace)
    }
}

impl Lanelet {
    /// What it costs to be on it in `state`; `None` if the vehicle is not.
    fn cost(&self, state: &RawState) -> Option<f64> {
        let position = state.position();
        let pieces = self.centre.windows(2).map(|w| {
            let along = [w[1][0] - w[0][0], w[1][1] - w[0][1]];
            let square = along[0] * along[0] + along[1] * along[1];
            let to = [position[0] - w[0][0], position[1] - w[0][1]];
            let share = (to[0] * along[0] + to[1] * along[1]) / square.max(1e-12);
            let share = share.clamp(0.0, 1.0);
            let foot = [0, 1].map(|i| w[0][i] + along[i] * share);
            (apart(&foot, &position), along[1].atan2(along[0]))
        });
        let (away, direction) = pieces.min_by(|a, b| a.0.total_cmp(&b.0))?;
        let angle = wrap(state.heading - direction).abs();
        let on = away < FARTHEST && angle < STEEPEST;
        on.then(|| away * away + (angle / METRE) * (angle / METRE))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lanes 4 m wide: east, then straight on or to the north; and one that goes west beside the first.
    fn map() -> Map {
        let lane = |points: &[MapPoint], normal: MapPoint| {
            let shift = |side: f64| {
                points
                    .iter()
                    .map(|p| [p[0] + side * normal[0], p[1] + side * normal[1]])
                    .collect::<Vec<_>>()
            };
            Lanelet::new(&shift(2.0), &shift(-2.0), None)
        };
        let mut lanelets = vec![
            lane(&[[0.0, 0.0], [20.0, 0.0]], [0.0, 1.0]),
            lane(&[[20.0, 0.0], [40.0, 0.0]], [0.0, 1.0]),
            Lanelet::new(
                &[[20.0, 2.0], [24.0, 10.0], [24.0, 20.0]],
                &[[20.0, -2.0], [28.0, 6.0], [28.0, 20.0]],
                None,
            ),
            lane(&[[40.0, 4.0], [0.0, 4.0]], [0.0, -1.0]),
        ];
        super::super::lane::join(&mut lanelets);
        Map {
            lanelets,
            ..Map::default()
        }
    }

    fn track(points: impl Iterator<Item = (f64, f64, f64)>) -> Track {
        let state = |(x, y, heading)| RawState {
            x,
            y,
            vx: 0.0,
            vy: 0.0,
            heading,
        };
        Track {
            id: 1,
            first_ms: 0,
            length: 4.0,
            width: 2.0,
            states: points.map(state).collect(),
        }
    }

    #[test]
    fn a_vehicle_is_matched_to_the_lanes_that_it_drives_along() {
        let map = map();
        let lanelets = |track: &Track| {
            map.trace(track)
                .0
                .iter()
                .map(|on| on.lanelet)
                .collect::<Vec<_>>()
        };
        // A metre to the left of the middle, so the lane of the opposite direction is as near.
        let straight = track((0..39).map(|i| (f64::from(i) + 0.5, 2.0, 0.0)));
        assert_eq!(lanelets(&straight), [0, 1]);
        assert_eq!(map.trace(&straight).0[1].from, 20);
        let west = track((0..40).map(|i| (40.0 - f64::from(i), 2.5, std::f64::consts::PI)));
        assert_eq!(lanelets(&west), [3]);
        let turn = (0..20).map(|i| (f64::from(i), 0.0, 0.0));
        let turn =
            turn.chain((0..14).map(|i| (20.0 + 0.4 * f64::from(i), 0.7 * f64::from(i), 0.9)));
        let turn = turn.chain((0..10).map(|i| (26.0, 10.0 + f64::from(i), 1.57)));
        assert_eq!(lanelets(&track(turn)), [0, 2]);
        assert_eq!(
            map.trace(&track([(500.0, 0.0, 0.0)].into_iter())),
            Trace::default()
        );
    }
}
