"""Junctions of a SUMO network: internal lanes become paths."""

from __future__ import annotations

import bisect
import math
import os
from collections import Counter
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from .._cede import Error, Junction

RADIUS = 0.35
"""Metres around the middle of a person within which it is, whichever way it turns."""

TYPES = (
    "allway_stop",
    "priority",
    "priority_stop",
    "right_before_left",
    "left_before_right",
    "unregulated",
    "zipper",
)
"""Junctions that are driven; at traffic lights and elsewhere SUMO drives."""

HEEDLESS = ("unregulated", "zipper")
"""Junctions at which SUMO's drivers give way to nobody."""

STOPS = "sw"
"""States of a connection at which a vehicle stops before it goes: a stop sign, an all-way stop."""

CONTROLS = {"m": "yield", "s": "stop", "w": "all-way-stop"}
"""What obliges a vehicle of a connection to give way, by SUMO's state; elsewhere no sign does."""

DIRECTIONS = {"l": "left", "L": "left", "t": "left", "r": "right", "R": "right"}
"""Where a connection turns, by SUMO's letter: a turn at all, slight ones included, is indicated."""

MOST_CANDIDATES = 4
"""Ways that a lane may lead: a track has so many candidate paths."""

BEFORE_LINE, BEFORE_CROSSING = 0.3, 0.8
"""Metres before a junction, or one with crossings, at which a vehicle waits."""

BEFORE, BEYOND = 300.0, 100.0
"""Metres of the lanes before and beyond a junction that belong to its paths."""

LATERAL = 2.6
"""Lateral acceleration (m/s²) that a curve's speed is chosen for."""

EXCESS = 0.1
"""Speed (m/s) by which SUMO's drivers exceed a limit at most: by rounding alone."""

SLACK = 0.5
"""Metres along a crossing by which a person may be ahead of its track."""

REACH = 12.0
"""Metres around a crossing within which a person counts as on its way to it."""

TOLERANCE = 0.1
"""Metres by which a vehicle may be beside its path."""

MARGIN = 0.5
"""Metres beyond a zone from which a vehicle counts as out of it."""

_GRID = 0.25
"""Metres between two entries of a movement's tables."""
_WINDOW = 3.0
"""Metres over which a curve's radius is measured."""


@dataclass(frozen=True)
class Stretch:
    """The part of a movement that runs along one lane."""

    lane: str
    start: float
    """Metres from the movement's start to the lane's; negative if it starts on the lane."""
    scale: float
    """Metres of the lane's shape for each metre of its length."""


@dataclass(frozen=True)
class Movement:
    """One way through a junction.

    SUMO keeps a vehicle's front and rear bumper on the lanes, so its centre cuts the corners. The
    path is that of the centre. The tables tell where on it a vehicle is whose front bumper is at
    each quarter of a metre along the lanes.
    """

    path: int
    """Of SUMO's own drivers."""
    driven: int
    """The same path for vehicles that are driven: among these another right of way holds."""
    incoming: str
    outgoing: str
    to_edge: str
    state: str
    direction: str
    """Where it turns: `"left"`, `"right"` or `"straight"`."""
    stretches: tuple[Stretch, ...]
    length: float
    line: float
    """Arc length (m) of the vehicle's centre while it waits at the stop line."""
    clear: float
    """Arc length (m) from which the vehicle has left the junction."""
    arc: list[float] = field(repr=False)
    """Arc length (m) of the centre."""
    rate: list[float] = field(repr=False)
    """Its change with the place of the front bumper."""
    curvature: list[float] = field(repr=False)
    """Curvature (1/m) of the path."""
    allowed: list[float] = field(repr=False)
    """Speed (m/s) of the centre that limits and bends allow, there and ahead."""

    @cached_property
    def on(self) -> dict[str, Stretch]:
        """Its stretch on each of its lanes."""
        return {stretch.lane: stretch for stretch in reversed(self.stretches)}

    def place(self, front: float) -> tuple[float, float]:
        """Arc length (m) of the centre, and its change with that of the front bumper."""
        at = front / _GRID
        arc, rate, i = self.arc, self.rate, int(at)
        # Comparisons take half as long as `min` and `max`; every vehicle is placed at each step.
        if i < 0:
            i = 0
        elif i > len(arc) - 2:
            i = len(arc) - 2
        share, before, rate_before = at - i, arc[i], rate[i]
        place = before + share * (arc[i + 1] - before)
        return place, rate_before + share * (rate[i + 1] - rate_before)

    def at(self, table: list[float], front: float) -> float:
        """The entry of a table for a front bumper there."""
        return table[min(max(int(front / _GRID), 0), len(table) - 1)]


Place = tuple[Movement, Stretch]
"""A movement, and its stretch on a lane."""


@dataclass(frozen=True)
class Crossing:
    """A pedestrian crossing.

    Its path leads straight over the road. Nobody on foot keeps to a line, so the path goes on for
    `REACH` metres beyond either kerb, and whoever is so near to the crossing is on it there, as far
    from the kerb as it is from the crossing.
    """

    path: int
    start: tuple[float, float]
    """Where it begins at one kerb."""
    along: tuple[float, float]
    """Its direction."""
    length: float
    """Metres from kerb to kerb."""
    width: float

    @property
    def reach(self) -> float:
        """Length (m) of its path."""
        return self.length + 2 * REACH

    def place(self, x: float, y: float) -> float:
        """Arc length (m) of a person on its path; beyond its ends for who is far away."""
        dx, dy = x - self.start[0], y - self.start[1]
        along = dx * self.along[0] + dy * self.along[1]
        beside = max(0.0, abs(dy * self.along[0] - dx * self.along[1]) - self.width / 2)
        if beside == 0.0 and 0.0 <= along <= self.length:
            return REACH + along
        before, beyond = math.hypot(along, beside), math.hypot(along - self.length, beside)
        return REACH - before if before < beyond else REACH + self.length + beyond


@dataclass
class Site:
    """A junction of the network with its paths."""

    name: str
    kind: str
    junction: Junction
    movements: list[Movement]
    on_lane: dict[str, list[Place]]
    """The movements that use a lane."""
    crossings: list[Crossing] = field(default_factory=list)

    @cached_property
    def shared(self) -> dict[str, float]:
        """The place (m) on each lane up to which all of its movements are one way."""
        shared: dict[str, float] = {}
        for movement in self.movements:
            before, inside = movement.stretches[:2]
            shared[before.lane] = (inside.start - before.start) / before.scale - 2 * _GRID
        # A lane that leads back to the junction also belongs to the ways that end on it.
        ends = {movement.outgoing for movement in self.movements}
        return {lane: place for lane, place in shared.items() if lane not in ends}

    @cached_property
    def left(self) -> dict[int, dict[str, float]]:
        """For each path, the place (m) on each lane from which nobody is in a zone with it.

        Nothing is known of a lane that is not named.
        """
        return {movement.path: self._left(movement) for movement in self.movements}

    def _left(self, movement: Movement) -> dict[str, float]:
        left: dict[str, float] = {}
        for other in self.movements:
            zones = self.junction.conflict(movement.driven, other.path).zones
            arc = max((theirs[1] for _, _, theirs in zones), default=-math.inf)
            # Rounded up to an entry of the table; beyond its end nothing is known.
            i = bisect.bisect_right(other.arc, arc + MARGIN)
            front = i * _GRID if i < len(other.arc) else math.inf
            for stretch in other.stretches:
                place = (front - stretch.start) / stretch.scale
                left[stretch.lane] = max(left.get(stretch.lane, -math.inf), place)
        return left


class Network:
    """The driven junctions of a `.net.xml` file.

    Args:
        file: The network.
        length: Length (m) of the longest vehicle.
        width: Width (m) of the widest vehicle.
        braking: Comfortable braking (m/s²) before limits and curves.
        pace: Highest speed (m/s) of persons on crossings.
    """

    def __init__(
        self,
        file: str | os.PathLike[str],
        *,
        length: float = 5.0,
        width: float = 1.8,
        braking: float = 2.0,
        pace: float = 1.5,
    ) -> None:
        self.file = os.fspath(file)
        self.length, self.width, self.braking, self.pace = length, width, braking, pace
        self.net = _read(self.file)
        self._crossed: dict[str, list[Any]] = {}
        for edge in self.net.getEdges(withInternal=True):
            if edge.getFunction() == "crossing":
                self._crossed.setdefault(edge.getToNode().getID(), []).append(edge)
        nodes = [node for node in self.net.getNodes() if node.getType() in TYPES]
        sites = [self._site(node) for node in nodes]
        self.sites = [site for site in sites if site is not None]
        if not self.sites:
            raise Error(f"{self.file}: no junction of a type that is driven: {', '.join(TYPES)}")
        allowed = (movement.allowed for site in self.sites for movement in site.movements)
        self.fastest = max(map(max, allowed)) + EXCESS
        """Speed (m/s) that nobody exceeds at these junctions."""
        self.entering: dict[str, Site] = {}
        self.using: dict[str, list[str]] = {}
        for site in self.sites:
            for movement in site.movements:
                self.entering[movement.incoming] = site
            for lane in site.on_lane:
                self.using.setdefault(lane, []).append(site.name)

    def _site(self, node: Any) -> Site | None:
        """The junction at a node; `None` where nobody meets anybody."""
        # Those between a pavement and the corner of a junction are for persons.
        connections = [
            c
            for c in node.getConnections()
            if not any(_is_internal(edge.getID()) for edge in (c.getFrom(), c.getTo()))
        ]
        if len({c.getFromLane().getID() for c in connections}) < 2:
            return None
        ways = Counter(c.getFromLane().getID() for c in connections)
        for lane, count in ways.items():
            if count > MOST_CANDIDATES:
                raise Error(
                    f"{self.file}: junction {node.getID()}: lane {lane} leads {count} ways: "
                    f"at most {MOST_CANDIDATES} are followed; build the network without turnarounds"
                )
        builder = Junction.builder(TOLERANCE)
        crossed = self._crossed.get(node.getID(), ())
        short = BEFORE_CROSSING if crossed else BEFORE_LINE
        ways = [_Way.along(self._lanes(node, c), self.length, short) for c in connections]
        size = {"kind": "car", "length": self.length, "width": self.width}
        paths = []
        for connection, way in zip(connections, ways):
            control = CONTROLS.get(connection.getState(), "free")
            rules = {"line": way.line, "control": control}
            try:
                paths.append(builder.path(_simplified(way.centre), **size, **rules))
            except Error as wrong:
                raise self._wrong(node, connection, wrong) from None
        driven = [builder.variant(p, **size, line=way.line) for p, way in zip(paths, ways)]
        crossings = [self._crossing(builder, edge) for edge in crossed]
        _tell_rights(builder, node, connections, (paths, driven))
        try:
            junction = builder.build()
        except Error as wrong:
            mend = _without_turnarounds(connections)
            raise Error(f"{self.file}: junction {node.getID()}: {wrong}{mend}") from None
        each = zip(paths, driven, connections, ways)
        movements = [_movement(*one, self.braking) for one in each]
        site = Site(node.getID(), node.getType(), junction, movements, {}, crossings)
        for movement in movements:
            for stretch in movement.stretches:
                site.on_lane.setdefault(stretch.lane, []).append((movement, stretch))
        return site

    def _crossing(self, builder: Any, edge: Any) -> Crossing:
        (lane,) = edge.getLanes()
        shape = np.array(lane.getShape(), float)[:, :2]
        start, chord = shape[0], shape[-1] - shape[0]
        length = float(np.hypot(*chord))
        along = chord / length
        # Where it bends, the straight path is as much wider.
        bend = float(np.abs((shape - start) @ np.array([-along[1], along[0]])).max())
        width = lane.getWidth() + 2 * bend
        path = builder.path(
            [start - REACH * along, shape[-1] + REACH * along],
            kind="pedestrian",
            length=2 * (RADIUS + SLACK),
            width=width,
            pace=self.pace,
        )
        return Crossing(path, tuple(start), tuple(along), length, width)

    def _lanes(self, node: Any, connection: Any) -> list[Any]:
        """The lanes of a connection: before, inside, beyond the junction."""
        lanes, via = [connection.getFromLane()], connection.getViaLaneID()
        while via:
            lane = self.net.getLane(via)
            lanes.append(lane)
            onward = lane.getOutgoing()
            if not onward:
                raise self._wrong(node, connection, "its lane inside the junction leads nowhere")
            via = onward[0].getViaLaneID()
        if len(lanes) == 1:
            raise self._wrong(
                node, connection, "the network has no internal lanes: build it with them"
            )
        return [*lanes, connection.getToLane()]

    def _wrong(self, node: Any, connection: Any, what: object) -> Error:
        ends = f"{connection.getFromLane().getID()} → {connection.getToLane().getID()}"
        return Error(f"{self.file}: junction {node.getID()}, connection {ends}: {what}")


def _movement(path: int, driven: int, connection: Any, way: _Way, braking: float) -> Movement:
    curvature = way.curvature()
    return Movement(
        path=path,
        driven=driven,
        incoming=connection.getFromLane().getID(),
        outgoing=connection.getToLane().getID(),
        to_edge=connection.getTo().getID(),
        state=connection.getState(),
        direction=DIRECTIONS.get(connection.getDirection(), "straight"),
        stretches=tuple(way.stretches),
        length=float(way.arc[-1]),
        line=way.line,
        clear=float(np.interp(way.stretches[-1].start + way.length, way.fronts, way.arc)),
        arc=way.arc.tolist(),
        rate=np.maximum(np.gradient(way.arc, _GRID), 0.1).tolist(),
        curvature=curvature.tolist(),
        allowed=_allowed(way, curvature, braking).tolist(),
    )


def _allowed(way: _Way, curvature: np.ndarray, braking: float) -> np.ndarray:
    """The speed (m/s) that limits and bends allow, and to come down to what they allow ahead."""
    starts, speeds = zip(*way.limits)
    limits = np.array(speeds)[np.searchsorted(starts, way.arc, side="right") - 1]
    allowed = np.minimum(limits, np.sqrt(LATERAL / np.maximum(curvature, 1e-6)))
    for i in range(len(allowed) - 2, -1, -1):
        down = math.sqrt(allowed[i + 1] ** 2 + 2 * braking * (way.arc[i + 1] - way.arc[i]))
        allowed[i] = min(allowed[i], down)
    return allowed


def _read(file: str) -> Any:
    try:
        import sumolib
    except ImportError as missing:
        raise Error("cede.sumo needs SUMO: pip install 'cede[sumo]'") from missing
    if not os.path.isfile(file):
        raise Error(f"{file}: no such network")
    if file.endswith(".sumocfg"):
        raise Error(
            f"{file}: a configuration: pass the network and the routes (--routes) that it names"
        )
    try:
        return sumolib.net.readNet(file, withInternal=True)
    except Exception as wrong:
        raise Error(f"{file}: not a network of SUMO: {wrong}") from wrong


@dataclass(frozen=True)
class _Right:
    """Which of two connections has the right of way, and when it counts."""

    first: Any
    priority: str


def _tell_rights(
    builder: Any, node: Any, connections: list[Any], paths: tuple[list[int], list[int]]
) -> None:
    """Tell the right of way of every two connections, whose paths are SUMO's and the driven ones.

    Driven vehicles go in the order of their arrival where no sign says who goes first. SUMO's
    drivers know no such order, and at some junctions they give way to nobody.
    """
    sumo, driven = paths
    for second, later in enumerate(connections):
        for first, earlier in enumerate(connections[:second]):
            if earlier.getFromLane() is later.getFromLane():
                # Whoever is ahead goes first.
                continue
            right = _right(node, earlier, later)
            one, two = (first, second) if right.first is earlier else (second, first)
            among = "signed" if right.priority == "signed" else "first-come"
            builder.right_of_way(driven[one], driven[two], among)
            if node.getType() in HEEDLESS:
                builder.right_of_way(sumo[one], driven[two], "signed")
                builder.right_of_way(sumo[two], driven[one], "signed")
            else:
                builder.right_of_way(sumo[one], driven[two], right.priority)
                builder.right_of_way(driven[one], sumo[two], right.priority)


def _right(node: Any, one: Any, two: Any) -> _Right:
    """The right of way of two connections as SUMO has it, and an order where it has none."""
    if node.getType() == "allway_stop":
        return _Right(one, "first-come")
    forbids, forbidden = _forbids(node, one, two), _forbids(node, two, one)
    if forbids != forbidden:
        signs = node.getType() in ("priority", "priority_stop", "zipper")
        return _Right(one if forbids else two, "signed" if signs else "unsigned")
    # Vehicles of these two touch only where they cut corners, or both have to look out.
    one_major, two_major = (connection.getState() == "M" for connection in (one, two))
    if one_major != two_major:
        return _Right(one if one_major else two, "signed")
    return _Right(one, "unsigned")


def _forbids(node: Any, first: Any, second: Any) -> bool:
    """Whether one connection of a junction goes before another."""
    try:
        return node.forbids(first, second)
    except KeyError:
        # Nothing is regulated here.
        return False


def _without_turnarounds(connections: list[Any]) -> str:
    """What to do where some turn back, and nothing where none does."""
    back = any(connection.getDirection() == "t" for connection in connections)
    return "; build the network without turnarounds (--no-turnarounds)" if back else ""


def _is_internal(name: str) -> bool:
    return name.startswith(":")


@dataclass
class _Way:
    """The way along some lanes: tables over the place of the front bumper."""

    length: float
    """Metres of the vehicle."""
    short: float
    """Metres before the junction at which its front bumper waits."""
    stretches: list[Stretch]
    fronts: np.ndarray
    centre: np.ndarray
    """Where the centre is, shape (n, 2)."""
    arc: np.ndarray
    """Its arc length (m)."""
    limits: list[tuple[float, float]]
    """From which arc length (m) on there are which speed limits (m/s)."""

    @classmethod
    def along(cls, lanes: list[Any], length: float, short: float) -> _Way:
        """The way of a vehicle of this length, which waits so short (m) of the junction."""
        shapes = [np.array(lane.getShape(), float)[:, :2] for lane in lanes]
        whole = [_arc(shape)[-1] for shape in shapes]
        cut = max(0.0, whole[0] - BEFORE)
        shapes[0], shapes[-1] = _part(shapes[0], cut), _part(shapes[-1], 0.0, BEYOND)
        starts = np.cumsum([-cut, *whole[:-1]])
        points = np.concatenate(shapes)
        along = _arc(points)
        fronts = np.arange(0.0, along[-1] + _GRID, _GRID)
        front, rear = _points_at(points, along, fronts), _points_at(points, along, fronts - length)
        centre = (front + rear) / 2
        arc = _arc(centre)
        return cls(
            length=length,
            short=short,
            stretches=[
                Stretch(lane.getID(), start, size / max(lane.getLength(), 0.1))
                for lane, start, size in zip(lanes, starts, whole)
            ],
            fronts=fronts,
            centre=centre,
            arc=arc,
            limits=[
                (float(np.interp(start, fronts, arc)), lane.getSpeed())
                for start, lane in zip(starts, lanes)
            ],
        )

    @property
    def line(self) -> float:
        """Where the centre is while the front bumper is a little before the junction."""
        return float(np.interp(self.stretches[1].start - self.short, self.fronts, self.arc))

    def curvature(self) -> np.ndarray:
        """By how much (rad) the path of the centre turns a metre.

        From its mean heading over a window before a place to that over the window beyond it: lanes
        are polylines, whose corners no vehicle takes as such.
        """
        moved = np.diff(self.centre, axis=0, append=2 * self.centre[-1:] - self.centre[-2:-1])
        heading = np.unwrap(np.arctan2(moved[:, 1], moved[:, 0]))
        steps = np.diff(self.arc) * (heading[1:] + heading[:-1]) / 2
        total = np.concatenate([[0.0], np.cumsum(steps)])

        def up_to(place: np.ndarray) -> np.ndarray:
            before, beyond = np.minimum(place, 0.0), np.maximum(place - self.arc[-1], 0.0)
            inside = np.interp(place, self.arc, total)
            return inside + before * heading[0] + beyond * heading[-1]

        before, here, beyond = (up_to(self.arc + side * _WINDOW) for side in (-1.0, 0.0, 1.0))
        return np.abs(beyond - 2.0 * here + before) / _WINDOW**2


def _arc(points: np.ndarray) -> np.ndarray:
    """Arc length (m) at each point of a polyline."""
    return np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])


def _points_at(points: np.ndarray, arc: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Points of a polyline at arc lengths (m), straight on beyond its ends."""
    inside = np.stack([np.interp(places, arc, points[:, axis]) for axis in (0, 1)], axis=1)
    before, beyond = np.minimum(places, 0.0), np.maximum(places - arc[-1], 0.0)
    first, last = points[1] - points[0], points[-1] - points[-2]
    inside += before[:, None] * first / np.hypot(*first)
    return inside + beyond[:, None] * last / np.hypot(*last)


def _part(shape: np.ndarray, low: float, high: float = np.inf) -> np.ndarray:
    """The part of a polyline between two arc lengths (m)."""
    arc = _arc(shape)
    ends = np.array([low, min(high, arc[-1])])
    inside = (arc > ends[0]) & (arc < ends[1])
    first, last = _points_at(shape, arc, ends)
    return np.concatenate([[first], shape[inside], [last]])


def _simplified(points: np.ndarray, away: float = 0.01) -> np.ndarray:
    """The points without those that are as near (m) as this to the straight line past them."""
    first, last = points[0], points[-1]
    along = (last - first) / max(np.hypot(*(last - first)), 1e-9)
    beside = np.abs((points - first) @ np.array([-along[1], along[0]]))
    farthest = int(beside.argmax())
    if beside[farthest] <= away:
        return np.stack([first, last])
    halves = (_simplified(points[: farthest + 1], away), _simplified(points[farthest:], away))
    return np.concatenate([halves[0][:-1], halves[1]])
