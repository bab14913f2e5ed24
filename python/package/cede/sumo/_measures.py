"""What is counted while vehicles drive."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

HARD = 3.5
"""Braking (m/s²) from which it is hard."""
STANDING = 0.1
"""Speed (m/s) below which a vehicle waits."""
STUCK = 60.0
"""Seconds of waiting at the end after which a vehicle is stuck."""
CRITICAL = 1.0
"""Time to collision (s) that is counted."""


@dataclass
class Measures:
    """The numbers of one run; `summary` is what `--json` prints."""

    demanded: int = 0
    arrived: int = 0
    delays: list[float] = field(default_factory=list)
    max_wait: float = 0.0
    stuck: int = 0
    collisions: set[frozenset[str]] = field(default_factory=set)
    ego_collisions: set[frozenset[str]] = field(default_factory=set)
    persons: int = 0
    person_collisions: set[frozenset[str]] = field(default_factory=set)
    ego_person_collisions: set[frozenset[str]] = field(default_factory=set)
    person_wait: float = 0.0
    stood: float = 0.0
    metres: float = 0.0
    hard_brakes: int = 0
    jerk_squares: float = 0.0
    jerks: int = 0
    lateral_max: float = 0.0
    decisions: int = 0
    shielded: int = 0
    no_plan: int = 0
    breaches: int = 0
    critical: int = 0
    driven: int = 0
    seconds: float = 0.0
    refused: int = 0

    def moved(
        self, metres: float, step: float, accelerations: tuple[float, float], lateral: float
    ) -> None:
        """Count a step (s) of a vehicle under test: accelerations (m/s²) before and after it."""
        before, after = accelerations
        self.metres += metres
        self.hard_brakes += after < -HARD <= before
        self.jerk_squares += ((after - before) / step) ** 2
        self.jerks += 1
        self.lateral_max = max(self.lateral_max, lateral)

    def summary(self) -> dict[str, float | int | None]:
        """The numbers by their names; what cannot be told is `None`."""

        def share(of: float, all_: float) -> float | None:
            return of / all_ if all_ else None

        delay = share(sum(self.delays), len(self.delays))
        jerk = share(self.jerk_squares, self.jerks)
        per_decision = share(self.seconds, self.decisions)
        return {
            "arrived": self.arrived,
            "demanded": self.demanded,
            "driven": self.driven,
            "mean_delay_s": delay,
            "max_wait_s": self.max_wait,
            "stuck": self.stuck,
            "collisions": len(self.collisions),
            "ego_collisions": len(self.ego_collisions),
            "persons": self.persons,
            "person_collisions": len(self.person_collisions),
            "ego_person_collisions": len(self.ego_person_collisions),
            "person_mean_wait_s": share(self.stood, self.persons),
            "person_max_wait_s": self.person_wait,
            "hard_brakes_per_km": share(self.hard_brakes, self.metres / 1000),
            "jerk_rms": None if jerk is None else math.sqrt(jerk),
            "lateral_acceleration_max": self.lateral_max,
            "shielded_share": share(self.shielded, self.decisions),
            "no_plan_share": share(self.no_plan, self.decisions),
            "breaches": self.breaches,
            "ttc_below_1s": self.critical,
            "handovers_refused": self.refused,
            "us_per_decision": None if per_decision is None else per_decision * 1e6,
        }
