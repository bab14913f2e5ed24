"""Pictures from above, drawn with NumPy alone."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

SIZE = 480
"""Pixels of a side."""
REACH = 35.0
"""Metres from the middle to a side."""
LENGTH, WIDTH, LANE = 5.0, 2.0, 3.5

_GROUND = (250, 250, 249)
_ROAD = (214, 211, 209)
_COLOURS = ((194, 65, 12), (29, 78, 216))
_OTHERS = (120, 113, 108)


class Scene:
    """The routes of an encounter; `draw` puts its vehicles on them."""

    def __init__(self, routes: Sequence[np.ndarray]) -> None:
        middle = _meeting_point(*routes[:2])
        axis = (np.arange(SIZE) + 0.5) * (2 * REACH / SIZE) - REACH
        self._x, self._y = middle[0] + axis[None, :], middle[1] - axis[:, None]
        self._road = np.empty((SIZE, SIZE, 3), np.uint8)
        self._road[:] = _GROUND
        for route in routes:
            self._road[self._near(route, LANE / 2)] = _ROAD

    def draw(self, poses: np.ndarray, sizes: np.ndarray | None = None) -> np.ndarray:
        """A picture with a vehicle at each pose: x, y (m) and heading (rad).

        Args:
            poses: The two judged vehicles, then others.
            sizes: Lengths and widths (m); 5.0 and 2.0 by default.
        """
        picture = self._road.copy()
        for i in reversed(range(len(poses))):
            length, width = (LENGTH, WIDTH) if sizes is None else sizes[i]
            colour = _COLOURS[i] if i < len(_COLOURS) else _OTHERS
            picture[self._box(*poses[i], length, width)] = colour
        return picture

    def _near(self, route: np.ndarray, away: float) -> np.ndarray:
        near = np.zeros((SIZE, SIZE), bool)
        for (x, y), (to_x, to_y) in zip(route[:-1], route[1:]):
            dx, dy = to_x - x, to_y - y
            along = ((self._x - x) * dx + (self._y - y) * dy) / (dx * dx + dy * dy)
            along = np.clip(along, 0.0, 1.0)
            near |= np.hypot(self._x - x - along * dx, self._y - y - along * dy) < away
        return near

    def _box(self, x: float, y: float, heading: float, length: float, width: float) -> np.ndarray:
        cos, sin = np.cos(heading), np.sin(heading)
        along = (self._x - x) * cos + (self._y - y) * sin
        beside = (self._y - y) * cos - (self._x - x) * sin
        return (np.abs(along) < length / 2) & (np.abs(beside) < width / 2)


def _meeting_point(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """The middle between the nearest points of two routes."""
    first, second = _dense(first), _dense(second)
    gaps = np.linalg.norm(first[:, None] - second[None], axis=2)
    i, j = np.unravel_index(np.argmin(gaps), gaps.shape)
    return (first[i] + second[j]) / 2


def _dense(route: np.ndarray) -> np.ndarray:
    """The route with a point every half metre: its own may be far apart."""
    steps = np.linalg.norm(np.diff(route, axis=0), axis=1)
    arc = np.concatenate([[0.0], np.cumsum(steps)])
    at = np.arange(0.0, arc[-1] + 0.25, 0.5)
    return np.column_stack([np.interp(at, arc, route[:, axis]) for axis in range(2)])
