"""The table of docs/python.md: SUMO's drivers, the shield with a plain profile, and Cede.

python python/benches/sumo.py [allway_stop priority …], all seven types by default
"""

import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "tests"))

from test_sumo import netconvert

from cede.sumo import Bridge, Network, Settings
from cede.sumo._network import TYPES

DEMANDS = (100.0, 200.0, 300.0)
SHARES = (0.5, 1.0)
SECONDS = 300.0
SEEDS = (0, 1)


def main(kinds):
    print(
        "| junction | demand | driver | share driven | runs | arrived | delay, s | stuck "
        "| collisions (of driven) | share without a plan | lateral, m/s² | µs |"
    )
    print("|---|---|---|---|---|---|---|---|---|---|---|---|")
    for kind in kinds:
        with tempfile.TemporaryDirectory() as folder:
            network = Network(netconvert(pathlib.Path(folder), kind))
            for demand in DEMANDS:
                row(network, kind, demand, "sumo", 1.0)
                for driver in ("profile", "cede"):
                    for share in SHARES:
                        row(network, kind, demand, driver, share)


def row(network, kind, demand, driver, share):
    """One row: the sums over the seeds, and the means of the rest."""
    runs = []
    for seed in SEEDS:
        settings = Settings(driver=driver, share=share, time=SECONDS, seed=seed)
        runs.append(Bridge(network, settings, demand=demand).run().summary())

    def total(name):
        return sum(run[name] for run in runs)

    def mean(name):
        known = [run[name] for run in runs if run[name] is not None]
        return f"{sum(known) / len(known):.3g}" if known else ""

    arrived = f"{total('arrived')} of {total('demanded')}"
    counts = f"{total('stuck')} | {total('collisions')} ({total('ego_collisions')})"
    lateral = max(run["lateral_acceleration_max"] for run in runs)
    means = f"{mean('no_plan_share')} | {lateral:.1f} | {mean('us_per_decision')}"
    delay = mean("mean_delay_s")
    print(
        f"| `{kind}` | {demand:.0f} | {driver} | {share:.0%} | {len(runs)} | {arrived} | {delay} "
        f"| {counts} | {means} |",
        flush=True,
    )


if __name__ == "__main__":
    main(sys.argv[1:] or TYPES)
