"""Recordings, maps and encounters as NumPy arrays and Arrow tables."""

from __future__ import annotations

import functools
import os
from typing import TYPE_CHECKING

from ._cede import Dataset, Error, Junction

if TYPE_CHECKING:
    import pyarrow

__all__ = [
    "Dataset",
    "criticality",
    "encounters",
    "junction",
    "open_dataset",
    "recordings",
    "states",
]

_ROLES = ("left", "other")


def open_dataset(
    data: str | os.PathLike[str] | Dataset = "synthetic",
    *,
    site: str = "EP0",
    encounters: int = 1000,
    seed: int = 0,
) -> Dataset:
    """The data set that `data` names.

    Args:
        data: `"synthetic"`; `"recorded"`, the folder in `CEDE_INTERACTION_DIR`; a folder; a
            CommonRoad scenario (`.xml`) or a folder of them; or a data set, which is returned as
            it is.
        site: Site of the recordings: its name, described by `NAME.toml` beside its folder if that
            is there, or the path of a description. Scenarios are sites of their own.
        encounters: Number of synthetic encounters, at least.
        seed: Seed of the synthetic encounters.
    """
    if isinstance(data, Dataset):
        return data
    if data == "synthetic":
        return _synthetic(encounters, seed)
    if data == "recorded":
        folder = os.environ.get("CEDE_INTERACTION_DIR")
        if not folder:
            raise Error("data = `recorded`: CEDE_INTERACTION_DIR names no folder of recordings")
        data = folder
    return _loaded(os.fspath(data), site)


@functools.lru_cache(maxsize=4)
def _synthetic(encounters: int, seed: int) -> Dataset:
    return Dataset.synthetic(encounters, seed)


@functools.lru_cache(maxsize=4)
def _loaded(folder: str, site: str) -> Dataset:
    return Dataset.load(folder, site)


def recordings(dataset: Dataset) -> pyarrow.Table:
    """The recorded states: one row a vehicle and 0.1 s."""
    return _table(dataset.recording_columns())


def encounters(dataset: Dataset, split: str = "all") -> pyarrow.Table:
    """The encounters: one row each; its number is that of its row."""
    return _table(dataset.encounter_columns(split))


def criticality(dataset: Dataset, split: str = "all") -> pyarrow.Table:
    """How critical the recorded encounters were: one row each, in the order of `encounters`.

    The conflict area is where the lanes of both vehicles overlap (`area` is `lanes`), without a map
    that says it where their footprints can touch on their paths (`paths`). What the record does not
    say is NaN.

    | column | |
    |---|---|
    | `ttc` | least time to collision in s, at constant speed along the own route, up to 5 s |
    | `left_et`, `other_et` | encroachment time in s: how long each is in the conflict area |
    | `pet` | post-encroachment time in s: from the exit of the first to the entry of the second |
    | `gap` | smallest distance between the footprints at one time, in m |
    | `deceleration` | greatest that the second needed in order not to meet the first, in m/s² |
    """
    return _table(dataset.criticality_columns(split))


def junction(dataset: Dataset, encounter: int, split: str = "all") -> Junction:
    """The junction of the two judged vehicles of an encounter.

    Path 0 is the route of `left`, path 1 that of `other`, as they were recorded, with the vehicles'
    sizes, what obliges each to give way, and who has the right of way where the map settles it.
    """
    rows = dataset.encounter_columns(split)
    if not 0 <= encounter < len(rows["file"]):
        raise Error(f"encounter = {encounter} is outside [0, {len(rows['file'])})")
    builder = Junction.builder()
    for vehicle, role in enumerate(_ROLES):
        length, width, control = (
            rows[f"{role}_{what}"][encounter] for what in ("length", "width", "control")
        )
        route = dataset.route(encounter, vehicle, split)
        builder.path(route, length=float(length), width=float(width), control=control)
    first, rule = rows["right_of_way"][encounter], rows["rule"][encounter]
    if first in _ROLES and rule != "all-way-stop":
        priority = "signed" if rule in ("regulation", "minor-road") else "unsigned"
        path = _ROLES.index(first)
        builder.right_of_way(path, 1 - path, priority)
    return builder.build()


def states(dataset: Dataset, split: str = "all") -> pyarrow.Table:
    """The states in the encounters: one row a vehicle and step."""
    return _table(dataset.state_columns(split))


def _table(columns: dict) -> pyarrow.Table:
    import pyarrow

    return pyarrow.table(columns)
