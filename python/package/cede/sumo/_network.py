"""Junctions of a SUMO network: internal lanes become paths."""

from __future__ import annotations

import os
from collections import Counter
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .._cede import Error, Junction

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

STOPS = "sw"
"""States of a connection at which a vehicle stops before it goes: a stop sign, an all-way stop."""

CONTROLS = {"m": "yield", "s": "stop", "w": "all-way-stop"}
"""What obliges a vehicle of a connection to give way, by SUMO's state; elsewhere no sign does."""

DIRECTIONS = {"l": "left", "L": "left", "t": "left", "r": "right", "R": "right"}
"""Where a connection turns, by SUMO's letter: a turn at all, slight ones included, is indicated."""

MOST_CANDIDATES = 4
"""Ways that a lane may lead: a track has so many candidate paths."""

BEFORE, BEYOND = 300.0, 100.0
"""Metres of the lanes before and beyond a junction that belong to its paths."""

LATERAL = 3.0
"""Lateral acceleration (m/s²) that a curve's speed is chosen for."""

TOLERANCE = 0.1
"""Metres by which a vehicle may be beside its path."""

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
    limit: list[float] = field(repr=False)
    """Speed (m/s), low enough for the limits and curves ahead."""
    curvature: list[float] = field(repr=False)
    """Curvature (1/m) of the path."""

    def place(self, front: float) -> tuple[float, float]:
        """Arc length (m) of the centre, and its change with that of the front bumper."""
        at = front / _GRID
        i = min(max(int(at), 0), len(self.arc) - 2)
        share = at - i
        place = self.arc[i] + share * (self.arc[i + 1] - self.arc[i])
        return place, self.rate[i] + share * (self.rate[i + 1] - self.rate[i])

    def at(self, table: list[float], front: float) -> float:
        """The entry of `limit` or `curvature` for a front bumper there."""
        return table[min(max(int(front / _GRID), 0), len(table) - 1)]


@dataclass
class Site:
    """A junction of the network with its paths."""

    name: str
    kind: str
    junction: Junction
    """With the rights that SUMO's drivers know."""
    fleet: Junction
    """Where all are driven: the order of arrival counts where no sign says who goes first."""
    movements: list[Movement]
    on_lane: dict[str, list[tuple[Movement, Stretch]]]
    """The movements that use a lane."""


class Network:
    """The driven junctions of a `.net.xml` file.

    Args:
        file: The network.
        length: Length (m) of the longest vehicle.
        width: Width (m) of the widest vehicle.
        braking: Comfortable braking (m/s²) before limits and curves.
    """

    def __init__(
        self,
        file: str | os.PathLike[str],
        *,
        length: float = 5.0,
        width: float = 1.8,
        braking: float = 2.0,
    ) -> None:
        self.file = os.fspath(file)
        self.length, self.width, self.braking = length, width, braking
        self.net = _read(self.file)
        nodes = [node for node in self.net.getNodes() if node.getType() in TYPES]
        sites = [self._site(node) for node in nodes]
        self.sites = [site for site in sites if site is not None]
        if not self.sites:
            raise Error(f"{self.file}: no junction of a type that is driven: {', '.join(TYPES)}")
        self.entering: dict[str, Site] = {}
        self.using: dict[str, list[Site]] = {}
        for site in self.sites:
            for movement in site.movements:
                self.entering[movement.incoming] = site
            for lane in site.on_lane:
                self.using.setdefault(lane, []).append(site)

    def _site(self, node: Any) -> Site | None:
        """The junction at a node; `None` where nobody meets anybody."""
        connections = [c for c in node.getConnections() if not _is_internal(c.getFrom().getID())]
        if len({c.getFromLane().getID() for c in connections}) < 2:
            return None
        ways = Counter(c.getFromLane().getID() for c in connections)
        for lane, count in ways.items():
            if count > MOST_CANDIDATES:
                raise Error(
                    f"{self.file}: junction {node.getID()}: lane {lane} leads {count} ways: "
                    f"at most {MOST_CANDIDATES} are followed; build the network without turnarounds"
                )
        builder, movements = Junction.builder(TOLERANCE), []
        for connection in connections:
            way = _Way.along(self._lanes(node, connection), self.length)
            kinds = {"kind": "car", "length": self.length, "width": self.width, "line": way.line}
            kinds["control"] = CONTROLS.get(connection.getState(), "free")
            try:
                path = builder.path(_simplified(way.centre), **kinds)
            except Error as wrong:
                raise self._wrong(node, connection, wrong) from None
            movements.append(self._movement(path, connection, way))
        junction = self._build(builder, node, connections, "unsigned")
        fleet = self._build(builder, node, connections, "first-come")
        site = Site(node.getID(), node.getType(), junction, fleet, movements, {})
        for movement in movements:
            for stretch in movement.stretches:
                site.on_lane.setdefault(stretch.lane, []).append((movement, stretch))
        return site

    def _build(self, builder: Any, node: Any, connections: list[Any], unsigned: str) -> Junction:
        """The junction with the right of way of every two connections."""
        for second, later in enumerate(connections):
            for first, earlier in enumerate(connections[:second]):
                right = _right(node, earlier, later, unsigned)
                pair = (first, second) if right.first is earlier else (second, first)
                builder.right_of_way(*pair, right.priority)
        try:
            return builder.build()
        except Error as wrong:
            raise Error(f"{self.file}: junction {node.getID()}: {wrong}") from None

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

    def _movement(self, path: int, connection: Any, way: _Way) -> Movement:
        curvature = way.curvature()
        allowed = np.minimum(way.speeds, np.sqrt(LATERAL / np.maximum(curvature, 1e-4)))
        return Movement(
            path=path,
            incoming=connection.getFromLane().getID(),
            outgoing=connection.getToLane().getID(),
            to_edge=connection.getTo().getID(),
            state=connection.getState(),
            direction=DIRECTIONS.get(connection.getDirection(), "straight"),
            stretches=tuple(way.stretches),
            length=float(way.arc[-1]),
            line=way.line,
            clear=float(np.interp(way.stretches[-1].start + self.length, way.fronts, way.arc)),
            arc=way.arc.tolist(),
            rate=np.maximum(np.gradient(way.arc, _GRID), 0.1).tolist(),
            limit=_ahead(allowed, self.braking).tolist(),
            curvature=curvature.tolist(),
        )

    def _wrong(self, node: Any, connection: Any, what: object) -> Error:
        ends = f"{connection.getFromLane().getID()} → {connection.getToLane().getID()}"
        return Error(f"{self.file}: junction {node.getID()}, connection {ends}: {what}")


def _read(file: str) -> Any:
    try:
        import sumolib
    except ImportError as missing:
        raise Error("cede.sumo needs SUMO: pip install 'cede[sumo]'") from missing
    if not os.path.isfile(file):
        raise Error(f"{file}: no such network")
    try:
        return sumolib.net.readNet(file, withInternal=True)
    except Exception as wrong:
        raise Error(f"{file}: not a network of SUMO: {wrong}") from wrong


@dataclass(frozen=True)
class _Right:
    """Which of two connections has the right of way, and when it counts."""

    first: Any
    priority: str


def _right(node: Any, one: Any, two: Any, unsigned: str) -> _Right:
    """The right of way of two connections as SUMO has it, and an order where it has none.

    `unsigned` is the priority where no sign says who goes first.
    """
    if node.getType() == "allway_stop":
        return _Right(one, "first-come")
    forbids, forbidden = _forbids(node, one, two), _forbids(node, two, one)
    if forbids != forbidden:
        signs = node.getType() in ("priority", "priority_stop", "zipper")
        return _Right(one if forbids else two, "signed" if signs else unsigned)
    # Vehicles of these two touch only where they cut corners, or both have to look out.
    one_major, two_major = (connection.getState() == "M" for connection in (one, two))
    if one_major != two_major:
        return _Right(one if one_major else two, "signed")
    return _Right(one, unsigned)


def _forbids(node: Any, first: Any, second: Any) -> bool:
    """Whether one connection of a junction goes before another."""
    try:
        return node.forbids(first, second)
    except KeyError:
        # Nothing is regulated here.
        return False


def _is_internal(name: str) -> bool:
    return name.startswith(":")


@dataclass
class _Way:
    """The way along some lanes: tables over the place of the front bumper."""

    stretches: list[Stretch]
    fronts: np.ndarray
    centre: np.ndarray
    """Where the centre is, shape (n, 2)."""
    arc: np.ndarray
    """Its arc length (m)."""
    heading: np.ndarray
    speeds: np.ndarray
    """The speed limit (m/s)."""

    @classmethod
    def along(cls, lanes: list[Any], length: float) -> _Way:
        """The way of a vehicle of this length."""
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
        ahead = front - rear
        return cls(
            stretches=[
                Stretch(lane.getID(), start, size / max(lane.getLength(), 0.1))
                for lane, start, size in zip(lanes, starts, whole)
            ],
            fronts=fronts,
            centre=centre,
            arc=_arc(centre),
            heading=np.unwrap(np.arctan2(ahead[:, 1], ahead[:, 0])),
            speeds=np.array([lane.getSpeed() for lane in lanes])[
                np.searchsorted(starts, fronts, side="right") - 1
            ],
        )

    @property
    def line(self) -> float:
        """Where the centre is while the front bumper is a little before the junction."""
        return float(np.interp(self.stretches[1].start - 0.3, self.fronts, self.arc))

    def curvature(self) -> np.ndarray:
        """The change of heading a metre, over a window of a few metres."""
        side = int(_WINDOW / 2 / _GRID)
        padded = np.pad(self.heading, side, mode="edge")
        return np.abs(padded[2 * side :] - padded[: -2 * side]) / _WINDOW


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


def _ahead(allowed: np.ndarray, braking: float) -> np.ndarray:
    """The speeds from which comfortable braking keeps to all that are `allowed` ahead."""
    limit = allowed.copy()
    for i in range(len(limit) - 2, -1, -1):
        limit[i] = min(limit[i], np.sqrt(limit[i + 1] ** 2 + 2 * braking * _GRID))
    return limit
