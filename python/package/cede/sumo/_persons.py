"""Persons on foot: where on a junction's crossings each may be next."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

from ._network import RADIUS, REACH, Crossing, Movement, Site

OTHER_SIDE = 3.0
"""Metres along a crossing's path that say that a person has come nearer to the other kerb."""


@dataclass
class Person:
    """Somebody on foot."""

    name: str
    x: float = 0.0
    y: float = 0.0
    speed: float = 0.0
    waits: float = 0.0
    """Seconds since it stood still."""
    tracks: dict[tuple[str, int], tuple[int, float]] = field(default_factory=dict)
    """Its track on each crossing, by junction and path: the number, and the arc length (m)."""
    before: dict[tuple[str, int], tuple[int, float]] = field(default_factory=dict)
    """The same a step ago."""

    def moved(self) -> None:
        """A step has passed."""
        self.before, self.tracks = self.tracks, {}

    def follow(
        self, on: tuple[str, int], s: float, stride: float, new: Callable[[], int]
    ) -> tuple[int, float]:
        """Its track on a crossing, where it is at `s`: no more than a `stride` (m) from the last.

        Between pavement and corner SUMO moves persons by up to a metre at once; `SLACK` covers
        that. Nearer to the other kerb than before it is somebody else, coming from there.
        """
        number, last = self.before.get(on, (-1, math.inf))
        if abs(s - last) > OTHER_SIDE:
            number, last = new(), s
        track = self.tracks[on] = number, last + min(max(s - last, -stride), stride)
        return track

    def touches(
        self, front: tuple[float, float], heading: float, size: tuple[float, float]
    ) -> bool:
        """Whether it overlaps a vehicle whose front bumper is there; `heading` from the x axis."""
        dx, dy = self.x - front[0], self.y - front[1]
        cos, sin = math.cos(heading), math.sin(heading)
        behind, beside = -(dx * cos + dy * sin), abs(dy * cos - dx * sin)
        length, width = size
        away = max(-behind, behind - length, 0.0), max(beside - width / 2, 0.0)
        return math.hypot(*away) < RADIUS


@dataclass(frozen=True)
class Walk:
    """A person on a crossing, or near it."""

    person: Person
    path: int
    """The crossing's."""
    number: int
    """Of its track."""
    s: float
    """Arc length (m) on the crossing's path."""


def walks_at(
    site: Site, persons: list[Person], stride: float, new: Callable[[], int]
) -> dict[int, list[Walk]]:
    """Who is on the path of each crossing of a junction, in the order along it."""
    walks: dict[int, list[Walk]] = {}
    for crossing in site.crossings:
        path, there = crossing.path, []
        for person in persons:
            s = crossing.place(person.x, person.y)
            if 0.0 <= s <= crossing.reach:
                track = person.follow((site.name, path), s, stride, new)
                there.append(Walk(person, path, *track))
        if there:
            walks[path] = sorted(there, key=lambda walk: walk.s)
    return walks


def nearest(walks: list[Walk], zone: tuple[float, float]) -> list[Walk]:
    """Of those on one crossing, who keeps a vehicle out of its zone there.

    All are as fast, and may turn: the nearest on either side is there first, and with somebody
    inside nobody else matters.
    """
    low, high = zone
    inside = [walk for walk in walks if low <= walk.s <= high]
    if inside:
        return inside[:1]
    return [walk for walk in walks if walk.s < low][-1:] + [
        walk for walk in walks if walk.s > high
    ][:1]


def zones_of(
    site: Site, movement: Movement, crossing: Crossing
) -> list[tuple[float, float, float]]:
    """The zones of a movement with a crossing: where a vehicle is past each, and its two ends.

    One beside the road, where a vehicle turns close to the end of a path, is none: nobody is there
    who is told on this path.
    """
    kerbs = REACH, REACH + crossing.length
    zones = site.junction.conflict(movement.driven, crossing.path).zones
    there = [(ego[1], *other) for _, ego, other in zones]
    return [zone for zone in there if zone[1] < kerbs[1] and zone[2] > kerbs[0]]
