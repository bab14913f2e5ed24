"""One encounter as it is driven: as a table, as a GIF, as a recording for Rerun.

`python -m cede.replay DATA --driver cede --out x.gif` is the same from a shell.
"""

from __future__ import annotations

import argparse
import os
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from . import _cede
from ._cede import Contract, Dataset, Error
from ._draw import Scene
from .data import open_dataset
from .evaluation import Driver, contract_of, known

if TYPE_CHECKING:
    import pandas

__all__ = ["Replay", "replay"]

STEP = 0.1
"""Seconds of a step."""
NAMES = ("left", "other")
"""The judged vehicles, which are those with the numbers 0 and 1."""


@dataclass(frozen=True)
class Replay:
    """An encounter as it was driven."""

    states: pandas.DataFrame
    """One row a vehicle and step: `step`, `vehicle`, `track`, `s`, `distance` to the conflict
    point, `v`, `a`, `x`, `y`, `heading`, `length`, `width`, and `shielded`: whether a shield
    overruled the driver. The vehicles 0 and 1 are judged; the others are as recorded."""
    end: str
    """`finished`, `collision` or `time-out`."""
    routes: list[np.ndarray]
    """The routes of the judged vehicles in m, shape (n, 2)."""
    lines: list[tuple[str, np.ndarray]]
    """The lines of the map, as of `Dataset.map_lines`."""

    def gif(self, path: str | os.PathLike[str], *, speed: float = 1.0) -> None:
        """Write an animation, seen from above. Needs Pillow: `pip install 'cede[gif]'`.

        Args:
            path: The file, which ends in `.gif`.
            speed: How much faster than it was.
        """
        image = _needed("PIL.Image", "gif")
        if not 0.1 <= speed <= 10:
            raise Error(f"speed = {speed} is outside [0.1, 10]")
        scene = Scene(self.routes)
        pictures = []
        for _, now in self.states.sort_values(["step", "vehicle"]).groupby("step"):
            poses = now[["x", "y", "heading"]].to_numpy()
            pictures.append(scene.draw(poses, now[["length", "width"]].to_numpy()))
        # A GIF has 256 colours, and these are five.
        frames = [image.fromarray(picture).quantize(16) for picture in pictures]
        frames[0].save(
            path,
            format="GIF",
            save_all=True,
            append_images=frames[1:],
            duration=round(1000 * STEP / speed),
            loop=0,
        )

    def rerun(self, path: str | os.PathLike[str]) -> None:
        """Write a recording for Rerun's viewer. Needs its SDK: `pip install 'cede[rerun]'`.

        Args:
            path: The file, which ends in `.rrd`.
        """
        rr = _needed("rerun", "rerun")
        with rr.RecordingStream("cede") as recording:
            recording.save(os.fspath(path))
            recording.log("/", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
            for kind in sorted({kind for kind, _ in self.lines}):
                strips = [flat(line) for name, line in self.lines if name == kind]
                recording.log(f"map/{kind}", rr.LineStrips3D(strips), static=True)
            for name, route in zip(NAMES, self.routes):
                recording.log(f"route/{name}", rr.LineStrips3D([flat(route)]), static=True)
            for state in self.states.itertuples(index=False):
                judged = state.vehicle < len(NAMES)
                name = NAMES[state.vehicle] if judged else f"track-{state.track}"
                recording.set_time("time", duration=STEP * state.step)
                recording.log(f"vehicle/{name}", _box(rr, state))
                if judged:
                    for what in ("v", "a", "distance"):
                        recording.log(f"{what}/{name}", rr.Scalars(getattr(state, what)))
                    recording.log(f"shielded/{name}", rr.Scalars(float(state.shielded)))


def replay(
    driver: Driver = "replay",
    data: str | os.PathLike[str] | Dataset = "synthetic",
    *,
    encounter: int = 0,
    site: str = "EP0",
    split: str = "test",
    until: str = "cleared",
    shield: bool | str | Contract = False,
    encounters: int = 1000,
    seed: int = 0,
    features: str | None = None,
) -> Replay:
    """Drive both vehicles of one encounter.

    Args:
        driver: As in `cede.evaluate`; `"replay"` repeats the record.
        data: As in `cede.data.open_dataset`.
        encounter: Its number in the split: the row in `cede.data.encounters(dataset, split)`.
        site: Site of the recordings.
        split: `"train"`, `"validation"`, `"test"` or `"all"`.
        until: `"cleared"`, or `"conflict"`: until the first is at the conflict point.
        shield: As in `cede.evaluate`.
        encounters: Number of synthetic encounters, at least.
        seed: Seed of every random choice.
        features: Features of an ONNX file that does not say them.
    """
    import pandas

    dataset = open_dataset(data, site=site, encounters=encounters, seed=seed)
    name, driver = known(driver, features)
    columns, end = _cede.replay(
        driver, name, dataset, split, encounter, until, contract_of(shield), seed
    )
    routes = [dataset.route(encounter, vehicle, split) for vehicle in range(2)]
    return Replay(pandas.DataFrame(columns), end, routes, dataset.map_lines())


def flat(line: np.ndarray) -> np.ndarray:
    """Points of a plane in space."""
    return np.column_stack([line, np.zeros(len(line))])


def _box(rr, state):
    """What a vehicle covers, 1.5 m high."""
    half = (state.length / 2, state.width / 2, 0.75)
    quaternion = (0.0, 0.0, np.sin(state.heading / 2), np.cos(state.heading / 2))
    return rr.Boxes3D(
        centers=[(state.x, state.y, 0.75)], half_sizes=[half], quaternions=[quaternion]
    )


def _needed(module: str, extra: str):
    """The module that writes a format."""
    import importlib

    try:
        return importlib.import_module(module)
    except ImportError as missing:
        raise ImportError(f"this needs {module}: pip install 'cede[{extra}]'") from missing


def main(arguments: list[str] | None = None) -> None:
    """The command line."""
    parser = argparse.ArgumentParser(prog="python -m cede.replay", description=__doc__)
    parser.add_argument(
        "data", help="`synthetic`, a folder of recordings, or a CommonRoad scenario"
    )
    parser.add_argument("--site", default="EP0", help="site of the recordings [default: EP0]")
    parser.add_argument("--split", default="all", help="[default: all]")
    parser.add_argument("--encounter", type=int, default=0, help="its number in the split")
    parser.add_argument("--driver", default="replay", help="a name, or a .cede or .onnx file")
    parser.add_argument("--shield", metavar="CONTRACT", help="with the shield of this contract")
    parser.add_argument("--speed", type=float, default=1.0, help="of a GIF [default: 1]")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", required=True, help="a file that ends in .gif or .rrd")
    told = parser.parse_args(arguments)
    if not told.out.endswith((".gif", ".rrd")):
        parser.error(f"--out {told.out}: it has to end in .gif or .rrd")
    try:
        driven = replay(
            told.driver,
            told.data,
            encounter=told.encounter,
            site=told.site,
            split=told.split,
            shield=told.shield or False,
            seed=told.seed,
        )
        if told.out.endswith(".gif"):
            driven.gif(told.out, speed=told.speed)
        else:
            driven.rerun(told.out)
    except (Error, ImportError, OSError) as wrong:
        parser.exit(3, f"{parser.prog}: {wrong}\n")
    print(f"{told.out}: {driven.states.step.max() * STEP:.1f} s, {driven.end}")


if __name__ == "__main__":
    main()
