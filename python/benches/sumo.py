"""The tables of docs/python.md: SUMO's drivers, the shield with a plain profile, and Cede.

python python/benches/sumo.py [--json FILE] [allway_stop priority …], all seven types by default

The first table has a row for each junction and demand, the second one a row for each driver and share. A run takes 5 to 30
seconds; there are 441. The file gets the summary of each run, one a line.
"""

import argparse
import json
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "tests"))

from test_sumo import netconvert

from cede.sumo import Bridge, Network, Settings
from cede.sumo._network import TYPES

DEMANDS = (100.0, 200.0, 300.0)
SHARES = (0.1, 0.5, 1.0)
DRIVERS = [("sumo", 1.0), *((driver, share) for driver in ("profile", "cede") for share in SHARES)]
SECONDS = 300.0
SEEDS = (0, 1, 2)


def main(kinds, file):
    everything = {driver: [] for driver in DRIVERS}
    names = [name(*driver) for driver in DRIVERS]
    print("arrived / mean delay in s / stuck; sums over the seeds, the delay their mean\n")
    print("| junction | vehicles/h and arm | demanded | " + " | ".join(names) + " |")
    print("|---|---|---|" + "---|" * len(names))
    for kind in kinds:
        with tempfile.TemporaryDirectory() as folder:
            network = Network(netconvert(pathlib.Path(folder), kind))
            for demand in DEMANDS:
                cells = []
                for driver, share in DRIVERS:
                    runs = [run(network, demand, driver, share, seed) for seed in SEEDS]
                    everything[driver, share] += runs
                    cells.append(cell(runs))
                    for seed, summary in zip(SEEDS, runs):
                        case = {
                            "junction": kind,
                            "demand": demand,
                            "driver": driver,
                            "share": share,
                        }
                        if file:
                            print(
                                json.dumps({**case, "seed": seed, **summary}), file=file, flush=True
                            )
                demanded = total(runs, "demanded")
                print(f"| `{kind}` | {demand:.0f} | {demanded} | {' | '.join(cells)} |", flush=True)
    print(
        "\n| driver, share | runs | arrived | stuck | longest wait, s | collisions (of driven) "
        "| jerk RMS, m/s³ | lateral, m/s²: greatest; runs above 3.5 | share without a plan | µs a decision |\n"
        "|---|---|---|---|---|---|---|---|---|---|"
    )
    for driver, runs in everything.items():
        print(f"| {name(*driver)} | {sums(runs)} |")


def run(network, demand, driver, share, seed):
    """The summary of one run."""
    settings = Settings(driver=driver, share=share, time=SECONDS, seed=seed)
    return Bridge(network, settings, demand=demand).run().summary()


def name(driver, share):
    """A driver's heading."""
    return "SUMO" if driver == "sumo" else f"{driver} {share:.0%}"


def total(runs, field):
    return sum(run[field] for run in runs)


def mean(runs, field):
    known = [run[field] for run in runs if run[field] is not None]
    return f"{sum(known) / len(known):.3g}" if known else ""


def cell(runs):
    """Arrived, mean delay, stuck."""
    return f"{total(runs, 'arrived')} / {mean(runs, 'mean_delay_s')} / {total(runs, 'stuck')}"


def sums(runs):
    """All of one driver's runs."""
    lateral = [run["lateral_acceleration_max"] for run in runs]
    return " | ".join(
        [
            f"{len(runs)}",
            f"{total(runs, 'arrived')} of {total(runs, 'demanded')}",
            f"{total(runs, 'stuck')}",
            f"{max(run['max_wait_s'] for run in runs):.0f}",
            f"{total(runs, 'collisions')} ({total(runs, 'ego_collisions')})",
            mean(runs, "jerk_rms"),
            f"{max(lateral):.1f}; {sum(a > 3.5 for a in lateral)}",
            mean(runs, "no_plan_share"),
            mean(runs, "us_per_decision"),
        ]
    )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("kinds", nargs="*", metavar="TYPE", help=", ".join(TYPES))
    parser.add_argument("--json", metavar="FILE", type=argparse.FileType("w"))
    arguments = parser.parse_args()
    main(arguments.kinds or TYPES, arguments.json)
