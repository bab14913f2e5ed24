"""Gymnasium environments: two vehicles whose routes conflict, stepped at 10 Hz.

`gymnasium.make("cede/Encounter-v0")` is one encounter at a time, `gymnasium.make_vec` thousands.
Both take the keywords of `EncounterEnv`.
"""

from __future__ import annotations

from typing import Any, ClassVar

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space

from . import _cede
from ._draw import Scene
from .data import Dataset, open_dataset

__all__ = ["FEATURES", "OUTCOMES", "SCALES", "EncounterEnv", "EncounterVectorEnv"]

FEATURES: tuple[str, ...] = tuple(_cede.FEATURES)
"""What the numbers of an observation are, in their order; `docs/python.md` has the units."""

SCALES: np.ndarray = np.array(_cede.SCALES, np.float32)
"""What each feature is multiplied by; then it is limited to ± 8."""

OUTCOMES: tuple[str, ...] = ("running", "left-first", "other-first", "collision", "time-out")
"""How an episode may end; `infos["outcome"]` of the vector environment is an index."""

_LIMIT = 8.0


def _spaces(mode: str) -> tuple[gymnasium.spaces.Box, gymnasium.spaces.Box]:
    """Observations and actions of one encounter."""
    commands = 2 if mode == "joint" else 1
    seen = gymnasium.spaces.Box(-_LIMIT, _LIMIT, (len(FEATURES),), np.float32)
    return seen, gymnasium.spaces.Box(-1.0, 1.0, (commands,), np.float32)


class EncounterEnv(gymnasium.Env):
    """One encounter at a time.

    Args:
        data: `"synthetic"`, `"recorded"` (the folder in `CEDE_INTERACTION_DIR`), a folder, or a
            `cede.data.Dataset`.
        site: Site of the recordings.
        split: `"train"`, `"validation"`, `"test"` or `"all"`.
        encounters: Number of synthetic encounters, at least.
        data_seed: Seed of the synthetic encounters.
        mode: `"joint"` commands both vehicles, `"left"` and `"other"` one of them, while the
            other repeats its recorded accelerations.
        reward: `"paper"` or `"plain"`.
        render_mode: `None` or `"rgb_array"`.
    """

    metadata: ClassVar[dict[str, Any]] = {"render_modes": ["rgb_array"], "render_fps": 10}

    def __init__(
        self,
        *,
        data: str | Dataset = "synthetic",
        site: str = "EP0",
        split: str = "train",
        encounters: int = 1000,
        data_seed: int = 0,
        mode: str = "joint",
        reward: str = "paper",
        render_mode: str | None = None,
    ) -> None:
        self.dataset = open_dataset(data, site=site, encounters=encounters, seed=data_seed)
        self.split = split
        self.render_mode = render_mode
        self._batch = _cede.Batch(
            self.dataset, split, 1, mode=mode, reward=reward, autoreset="disabled"
        )
        self.observation_space, self.action_space = _spaces(mode)
        self._arrays = _arrays(1)
        self._action = np.zeros((1, self.action_space.shape[0]), np.float32)
        self._scene: Scene | None = None
        self._number = 0
        # As locals of `step`: what it does at every step costs more to find than to do.
        seen, reward_, terminated, truncated, _, outcome = self._arrays
        self._views = (self._action[0], seen[0], reward_, terminated, truncated, outcome)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Begin an encounter: one drawn by the seed, or number `options["encounter"]`."""
        super().reset(seed=seed)
        number = (options or {}).get("encounter")
        if number is None:
            number = int(self.np_random.integers(self._batch.encounters))
        self._number, self._scene = number % self._batch.encounters, None
        self._batch.place(0, self._number)
        self._batch.observe(self._arrays[0])
        return self._views[1].copy(), {"encounter": self._number}

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """One step of 0.1 s; `action` is a share of ± 3 m/s² for each vehicle commanded."""
        asked, seen, reward, terminated, truncated, outcome = self._views
        asked[:] = action
        self._batch.step(self._action, *self._arrays)
        done, cut = bool(terminated[0]), bool(truncated[0])
        info = {"outcome": OUTCOMES[outcome[0]]} if done or cut else {}
        return seen.copy(), float(reward[0]), done, cut, info

    def render(self) -> np.ndarray | None:
        """A picture from above, 480 × 480."""
        if self.render_mode is None:
            return None
        number, poses = self._batch.scene(0)
        if self._scene is None:
            routes = [self.dataset.route(number, vehicle, self.split) for vehicle in (0, 1)]
            self._scene = Scene(routes)
        return self._scene.draw(np.array(poses))


class EncounterVectorEnv(gymnasium.vector.VectorEnv):
    """Thousands of encounters at once, one step of all of them in one call.

    It takes the keywords of `EncounterEnv` and these.

    Args:
        num_envs: Number of encounters.
        threads: Threads that step them; results have the same bits on any number.
        autoreset: `"next-step"` or `"same-step"`, as `gymnasium.vector.AutoresetMode` means them.
        copy: Whether a step returns copies. Without, it returns the arrays that the next step
            overwrites.
    """

    metadata: ClassVar[dict[str, Any]] = {"render_modes": ["rgb_array"], "render_fps": 10}

    def __init__(
        self,
        num_envs: int = 1,
        *,
        data: str | Dataset = "synthetic",
        site: str = "EP0",
        split: str = "train",
        encounters: int = 1000,
        data_seed: int = 0,
        mode: str = "joint",
        reward: str = "paper",
        render_mode: str | None = None,
        threads: int = 1,
        autoreset: str = "next-step",
        copy: bool = True,
    ) -> None:
        self.num_envs = num_envs
        self.dataset = open_dataset(data, site=site, encounters=encounters, seed=data_seed)
        self.split = split
        self.render_mode = render_mode
        self._batch = _cede.Batch(
            self.dataset,
            split,
            num_envs,
            mode=mode,
            reward=reward,
            autoreset=autoreset,
            threads=threads,
        )
        modes = {"next-step": AutoresetMode.NEXT_STEP, "same-step": AutoresetMode.SAME_STEP}
        self.metadata = {**type(self).metadata, "autoreset_mode": modes[autoreset]}
        self._same_step = autoreset == "same-step"
        self._copy = copy
        self.single_observation_space, self.single_action_space = _spaces(mode)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._arrays = _arrays(num_envs)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Draw all encounters anew."""
        super().reset(seed=seed)
        if seed is None:
            seed = int(self.np_random.integers(2**63))
        self._batch.seed(seed)
        self._batch.observe(self._arrays[0])
        return self._given(self._arrays[0]), {}

    def step(
        self, actions: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, dict[str, Any]]:
        """One step of 0.1 s of all encounters."""
        self._batch.step(np.ascontiguousarray(actions, np.float32), *self._arrays)
        seen, reward, terminated, truncated, final, outcome = self._arrays
        ended = terminated | truncated
        infos: dict[str, Any] = {}
        if ended.any():
            infos = {"outcome": outcome.copy(), "_outcome": ended}
            if self._same_step:
                infos = {
                    "final_obs": final.copy(),
                    "_final_obs": ended,
                    "final_info": infos,
                    "_final_info": ended,
                }
        given = self._given
        return given(seen), given(reward), given(terminated), given(truncated), infos

    def render(self) -> tuple[np.ndarray, ...] | None:
        """Pictures from above of the first encounters, at most 16."""
        if self.render_mode is None:
            return None
        return tuple(self._picture(place) for place in range(min(self.num_envs, 16)))

    def _given(self, array: np.ndarray) -> np.ndarray:
        return array.copy() if self._copy else array

    def _picture(self, place: int) -> np.ndarray:
        number, poses = self._batch.scene(place)
        routes = [self.dataset.route(number, vehicle, self.split) for vehicle in (0, 1)]
        return Scene(routes).draw(np.array(poses))


def _arrays(n: int) -> tuple[np.ndarray, ...]:
    """What a step writes: what is seen, rewards, ends, what is seen at an end, outcomes."""
    features = len(FEATURES)
    return (
        np.zeros((n, features), np.float32),
        np.zeros(n, np.float32),
        np.zeros(n, np.bool_),
        np.zeros(n, np.bool_),
        np.zeros((n, features), np.float32),
        np.zeros(n, np.uint8),
    )
