"""Drivers judged on encounters, as `cede evaluate` judges them."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Union

from . import _cede
from ._cede import Contract, Error, Policy, View
from .data import Dataset, open_dataset

if TYPE_CHECKING:
    import pandas

__all__ = ["DRIVERS", "evaluate"]

DRIVERS: tuple[str, ...] = tuple(_cede.driver_names())
"""The drivers that have a name."""

Driver = Union[str, "os.PathLike[str]", Policy, Callable[[View], float]]


def evaluate(
    driver: Driver | Sequence[Driver] = "cede",
    data: str | os.PathLike[str] | Dataset = "synthetic",
    *,
    site: str = "EP0",
    split: str = "test",
    mode: str = "joint",
    until: str = "conflict",
    partner: str = "replay",
    shield: bool | str | Contract = False,
    encounters: int = 1000,
    seed: int = 0,
    threads: int = 1,
    features: str | None = None,
    episodes: bool = False,
) -> pandas.DataFrame | tuple[pandas.DataFrame, pandas.DataFrame]:
    """The rows of the table, one a driver; with `episodes` also one row an episode.

    Args:
        driver: A name of `DRIVERS`, a `.cede` or `.onnx` file, a `cede.Policy` (with the SVO that
            `Policy.oriented` gives it), a function that takes a `cede.View` and returns an
            acceleration (m/s²), or a list of these.
        data: As in `cede.data.open_dataset`.
        site: Site of the recordings.
        split: `"train"`, `"validation"`, `"test"`, `"all"`, `"leave-one-file-out"` or
            `"seven-fold"`.
        mode: `"joint"` drives both vehicles, `"ego"` one of them in either role.
        until: `"conflict"`, the paper's protocol, or `"cleared"`.
        partner: In ego mode, the driver of the other vehicle: a name of `DRIVERS`.
        shield: `False`, `True` (the worst case), the name of a contract, or a contract.
        encounters: Number of synthetic encounters, at least.
        seed: Seed of every random choice.
        threads: Threads; a function is called by one of them at a time.
        features: Features of an ONNX file that does not say them.
        episodes: Whether the episodes are returned as well.
    """
    import pandas

    dataset = open_dataset(data, site=site, encounters=encounters, seed=seed)
    contract = contract_of(shield)
    rows, all_episodes = [], []
    for one in driver if isinstance(driver, (list, tuple)) else [driver]:
        name, judged = known(one, features)
        row, driven = _cede.evaluate(
            judged, name, dataset, split, mode, until, partner, contract, seed, threads
        )
        rows.append(json.loads(row))
        all_episodes += [{"driver": name, **episode} for episode in json.loads(driven)]
    table = pandas.DataFrame(rows)
    return (table, pandas.DataFrame(all_episodes)) if episodes else table


def contract_of(shield: bool | str | Contract) -> Contract | None:
    """The contract of a shield; `None` without one."""
    if shield is False:
        return None
    if shield is True:
        return Contract()
    return shield if isinstance(shield, Contract) else Contract(shield)


def known(driver: Driver, features: str | None) -> tuple[str, Any]:
    """The name of a driver in the table, and what Rust takes for it."""
    if isinstance(driver, Policy):
        shown = "" if driver.svo == 45 else f" {driver.svo:g}°"
        return f"policy{shown}", driver
    if callable(driver):
        return getattr(driver, "__name__", type(driver).__name__), driver
    name = os.fspath(driver)
    stem = os.path.splitext(os.path.basename(name))[0]
    if name.endswith(".cede"):
        return stem, Policy.load(name)
    if name.endswith(".onnx"):
        return stem, Policy.from_onnx(name, features)
    if name not in DRIVERS:
        names = ", ".join(DRIVERS)
        raise Error(f"driver = `{name}` is neither a .cede nor an .onnx file, nor one of: {names}")
    return name, name
