"""Recordings, maps and encounters as NumPy arrays and Arrow tables."""

from __future__ import annotations

import functools
import os
from typing import TYPE_CHECKING

from ._cede import Dataset, Error

if TYPE_CHECKING:
    import pyarrow

__all__ = ["Dataset", "encounters", "open_dataset", "recordings", "states"]


def open_dataset(
    data: str | os.PathLike[str] | Dataset = "synthetic",
    *,
    site: str = "EP0",
    encounters: int = 1000,
    seed: int = 0,
) -> Dataset:
    """The data set that `data` names.

    Args:
        data: `"synthetic"`; `"recorded"`, the folder in `CEDE_INTERACTION_DIR`; a folder; or a
            data set, which is returned as it is.
        site: Site of the recordings.
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


def states(dataset: Dataset, split: str = "all") -> pyarrow.Table:
    """The states in the encounters: one row a vehicle and step."""
    return _table(dataset.state_columns(split))


def _table(columns: dict) -> pyarrow.Table:
    import pyarrow

    return pyarrow.table(columns)
