"""Random demand: so many vehicles and persons an hour from every arm, each to another one."""

from __future__ import annotations

import os
import random
from collections.abc import Iterator
from typing import Any

from .._cede import Error

WALK = 30.0
"""Metres of the pavements that a person walks before and after the junctions."""


def write_demand(
    net: Any,
    file: str | os.PathLike[str],
    *,
    per_hour: float,
    pedestrians: float = 0.0,
    time: float,
    seed: int,
) -> int:
    """Write the routes of Poisson arrivals over `time` s; the number of vehicles is returned."""
    edges = net.getEdges(withInternal=False)
    into = [e for e in edges if not _vehicles(e.getIncoming())]
    out_of = [e for e in edges if not _vehicles(e.getOutgoing())]
    if not into or not out_of:
        into = out_of = [e for e in edges if e.is_fringe()]
    routes = {edge: _routes(net, edge, out_of) for edge in into}
    random_ = random.Random(seed)
    trips = [
        (at, _vehicle(at, random_.choice(routes[edge])))
        for edge in into
        if routes[edge]
        for at in _arrivals(random_, per_hour, time)
    ]
    if not trips:
        raise Error(f"a demand of {per_hour} vehicles an hour and arm gives none in {time} s")
    walks = _walks(into, out_of, random_, pedestrians, time) if pedestrians else []
    with open(file, "w", encoding="utf-8") as out:
        out.write("<routes>\n")
        for number, (_, trip) in enumerate(sorted(trips + walks)):
            out.write(trip.format(number) + "\n")
        out.write("</routes>\n")
    return len(trips)


def _arrivals(random_: random.Random, per_hour: float, time: float) -> Iterator[float]:
    """The moments (s) of Poisson arrivals."""
    at = random_.expovariate(per_hour / 3600.0)
    while at < time:
        yield at
        at += random_.expovariate(per_hour / 3600.0)


def _vehicles(edges: Any) -> list[Any]:
    """Those that are no corner of a junction, where persons walk."""
    return [edge for edge in edges if not edge.getID().startswith(":")]


def _vehicle(at: float, edges: list[str]) -> str:
    return (
        f'<vehicle id="{{}}" depart="{at:.1f}" departLane="best" departSpeed="max">'
        f'<route edges="{" ".join(edges)}"/></vehicle>'
    )


def _walks(
    into: list[Any], out_of: list[Any], random_: random.Random, per_hour: float, time: float
) -> list[tuple[float, str]]:
    """Persons who walk from one arm to another; they begin and end a little way from a junction."""
    starts, ends = ([e for e in edges if _has_pavement(e)] for edges in (into, out_of))
    walks = []
    for start in starts:
        others = [end for end in ends if end.getToNode() is not start.getFromNode()]
        for at in _arrivals(random_, per_hour, time) if others else ():
            end = random_.choice(others)
            begins = max(0.0, start.getLength() - WALK)
            walk = (
                f'<person id="on-foot-{{}}" depart="{at:.1f}" departPos="{begins:.1f}">'
                f'<walk from="{start.getID()}" to="{end.getID()}" '
                f'arrivalPos="{min(WALK, end.getLength()):.1f}"/></person>'
            )
            walks.append((at, walk))
    if not walks:
        raise Error(
            f"{per_hour} pedestrians an hour and arm give none in {time} s: are there pavements "
            "on the arms (netconvert --sidewalks.guess --crossings.guess)?"
        )
    return walks


def _has_pavement(edge: Any) -> bool:
    return any(
        lane.allows("pedestrian") and not lane.allows("passenger") for lane in edge.getLanes()
    )


def _routes(net: Any, start: Any, ends: list[Any]) -> list[list[str]]:
    """The shortest way to each end that is not the arm itself."""
    ways = []
    for end in ends:
        if end.getToNode() is start.getFromNode():
            continue
        edges, _ = net.getShortestPath(start, end, vClass="passenger")
        if edges:
            ways.append([edge.getID() for edge in edges])
    return ways
