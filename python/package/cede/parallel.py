"""PettingZoo's parallel API: the two vehicles of an encounter are two agents.

Each sees the encounter from its own seat and commands itself. Both earn the same reward.
"""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
from pettingzoo import ParallelEnv

from .envs import FEATURES, EncounterEnv, _spaces

__all__ = ["AGENTS", "parallel_env"]

AGENTS = ("left", "other")


class parallel_env(ParallelEnv):
    """An encounter of two agents; it takes the keywords of `EncounterEnv`, but `mode`."""

    metadata: ClassVar[dict[str, Any]] = {
        "name": "cede_encounter_v0",
        "render_modes": ["rgb_array"],
        "render_fps": 10,
    }

    def __init__(self, **keywords: Any) -> None:
        self._env = EncounterEnv(mode="joint", **keywords)
        self.render_mode = self._env.render_mode
        self.possible_agents = list(AGENTS)
        self.agents: list[str] = []
        seats = {agent: _spaces(agent) for agent in AGENTS}
        self.observation_spaces = {agent: seen for agent, (seen, _) in seats.items()}
        self.action_spaces = {agent: acts for agent, (_, acts) in seats.items()}

    def observation_space(self, agent: str) -> Any:
        """What the agent sees."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> Any:
        """What the agent does."""
        return self.action_spaces[agent]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, np.ndarray], dict[str, dict[str, Any]]]:
        """Begin an encounter."""
        _, info = self._env.reset(seed=seed, options=options)
        self.agents = list(AGENTS)
        return self._seen(), {agent: dict(info) for agent in AGENTS}

    def step(self, actions: dict[str, np.ndarray]) -> tuple[dict[str, Any], ...]:
        """One step of 0.1 s of both."""
        asked = np.concatenate([actions[agent] for agent in AGENTS])
        _, reward, terminated, truncated, info = self._env.step(asked)
        if terminated or truncated:
            self.agents = []
        each = ((agent, dict(info)) for agent in AGENTS)
        return (
            self._seen(),
            dict.fromkeys(AGENTS, reward),
            dict.fromkeys(AGENTS, terminated),
            dict.fromkeys(AGENTS, truncated),
            dict(each),
        )

    def render(self) -> np.ndarray | None:
        """A picture from above."""
        return self._env.render()

    def _seen(self) -> dict[str, np.ndarray]:
        seen = {agent: np.zeros(len(FEATURES), np.float32) for agent in AGENTS}
        for vehicle, agent in enumerate(AGENTS):
            self._env._batch.view(0, vehicle, seen[agent])
        return seen
