"""Evaluations, campaigns, trainings and sweeps on a Ray cluster.

What is computed does not depend on the cluster: each item is computed by itself, from the item
alone, and the results come in the order of the items. A worker that is lost costs its items,
which another computes again.
"""

from __future__ import annotations

import itertools
import os
import subprocess
from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, Any, TypeVar

from ._cede import Contract, Error
from .evaluation import Driver, evaluate

# Ray reports its use to its makers unless told not to.
os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")

try:
    import ray
except ImportError as missing:
    raise ImportError("cede.ray needs Ray: pip install 'cede[ray]'") from missing

if TYPE_CHECKING:
    import pandas

__all__ = ["commands", "evaluations", "map"]

Item = TypeVar("Item")
Result = TypeVar("Result")


def map(
    function: Callable[[Item], Result],
    items: Iterable[Item],
    *,
    address: str | None = None,
    cpus: float = 1.0,
    retries: int = 3,
) -> list[Result]:
    """`[function(item) for item in items]`, on a Ray cluster.

    Args:
        function: What is computed of an item. It and the items travel to the workers; the files
            that they name, and modules of your own, have to be there. What it raises is raised.
        items: The items.
        address: The cluster, as in `ray.init`; by default the one that is connected, or that of
            `RAY_ADDRESS`, or this machine.
        cpus: Processors that one item takes.
        retries: How often an item is computed again whose worker was lost.
    """
    if not ray.is_initialized():
        ray.init(address=address, log_to_driver=False)
    task = ray.remote(num_cpus=cpus, max_retries=retries)(_call)
    function = ray.put(function)
    results = [task.remote(function, item) for item in items]
    try:
        return ray.get(results)
    except ray.exceptions.RayError as lost:
        # Only what still waits: to cancel a task while its result arrives can end the whole driver.
        for result in ray.wait(results, num_returns=len(results), timeout=0)[1]:
            ray.cancel(result)
        if isinstance(lost, ray.exceptions.RayTaskError):
            raise
        raise Error(f"an item was lost with its worker, and {retries} times again") from lost


def _call(function: Callable[[Any], Any], item: Any) -> Any:
    return function(item)


def evaluations(
    driver: Driver | Sequence[Driver] = "cede",
    data: str | os.PathLike[str] = "synthetic",
    *,
    sites: Sequence[str] = ("EP0",),
    seeds: Sequence[int] = (0,),
    shields: Sequence[bool | str | Contract] = (False,),
    address: str | None = None,
    cpus: float = 1.0,
    retries: int = 3,
    **options: Any,
) -> pandas.DataFrame:
    """The rows of `cede.evaluate` for every driver, site, shield and seed, in this order.

    Args:
        driver: As in `cede.evaluate`, but for a `cede.Policy`: name its file.
        data: As in `cede.evaluate`; the workers read it.
        sites: Sites of the recordings.
        seeds: Seeds; each row has a column `seed`.
        shields: Shields, as in `cede.evaluate`; each row has a column `contract`.
        address: As in `map`.
        cpus: As in `map`.
        retries: As in `map`.
        options: Further options of `cede.evaluate`.
    """
    import pandas

    drivers = driver if isinstance(driver, (list, tuple)) else [driver]
    jobs = list(itertools.product(drivers, sites, shields, seeds))

    def row(job: tuple[Driver, str, bool | str | Contract, int]) -> pandas.DataFrame:
        driver, site, shield, seed = job
        table = evaluate(driver, data, site=site, shield=shield, seed=seed, **options)
        return table.assign(contract=_name(shield), seed=seed)

    rows = map(row, jobs, address=address, cpus=cpus, retries=retries)
    return pandas.concat(rows, ignore_index=True)


def _name(shield: bool | str | Contract) -> str:
    if isinstance(shield, bool):
        return "worst-case" if shield else "none"
    return shield if isinstance(shield, str) else "as given"


def commands(
    arguments: Iterable[Sequence[str]],
    *,
    program: str = "cede",
    address: str | None = None,
    cpus: float = 1.0,
    retries: int = 3,
) -> list[str]:
    """What the command line prints for each list of arguments: trainings, campaigns, proofs.

    The program and the files that it reads have to be on every machine, and what it writes stays on
    the machine that ran it unless they share a folder. A command that fails raises `cede.Error`.

    Args:
        arguments: The lists of arguments, as in `[["verify", "campaign", "--json"]]`.
        program: The program.
        address: As in `map`.
        cpus: As in `map`; a command with `--threads N` takes N.
        retries: As in `map`.
    """

    def run(arguments: Sequence[str]) -> str:
        words = [program, *arguments]
        try:
            done = subprocess.run(words, capture_output=True, text=True, check=False)
        except OSError as wrong:
            raise Error(f"program = `{program}`: {wrong}") from wrong
        if done.returncode != 0:
            said = done.stderr.strip() or done.stdout.strip()
            raise Error(f"`{' '.join(words)}` ended with {done.returncode}: {said}")
        return done.stdout

    return map(run, arguments, address=address, cpus=cpus, retries=retries)
