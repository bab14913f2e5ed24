"""Random demand: so many vehicles an hour from every arm, each to a random other arm."""

from __future__ import annotations

import os
import random
from typing import Any

from .._cede import Error


def write_demand(
    net: Any, file: str | os.PathLike[str], *, per_hour: float, time: float, seed: int
) -> int:
    """Write the routes of Poisson arrivals over `time` seconds; their number is returned."""
    into = [e for e in net.getEdges(withInternal=False) if not e.getIncoming()]
    out_of = [e for e in net.getEdges(withInternal=False) if not e.getOutgoing()]
    if not into or not out_of:
        into = out_of = [e for e in net.getEdges(withInternal=False) if e.is_fringe()]
    routes = {edge: _routes(net, edge, out_of) for edge in into}
    random_ = random.Random(seed)
    trips = []
    for edge in into:
        ways = routes[edge]
        at = random_.expovariate(per_hour / 3600.0)
        while ways and at < time:
            trips.append((at, random_.choice(ways)))
            at += random_.expovariate(per_hour / 3600.0)
    if not trips:
        raise Error(f"a demand of {per_hour} vehicles an hour and arm gives none in {time} s")
    trips.sort()
    with open(file, "w", encoding="utf-8") as out:
        out.write("<routes>\n")
        for number, (at, edges) in enumerate(trips):
            out.write(
                f'<vehicle id="{number}" depart="{at:.1f}" departLane="best" departSpeed="max">'
                f'<route edges="{" ".join(edges)}"/></vehicle>\n'
            )
        out.write("</routes>\n")
    return len(trips)


def _routes(net: Any, start: Any, ends: list[Any]) -> list[list[str]]:
    """The shortest way to each end that is not the arm itself."""
    ways = []
    for end in ends:
        if end.getToNode() is start.getFromNode():
            continue
        edges, _ = net.getShortestPath(start, end)
        if edges:
            ways.append([edge.getID() for edge in edges])
    return ways
