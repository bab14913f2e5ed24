"""`python -m cede.sumo`: drives a share of the vehicles of a SUMO network."""

from __future__ import annotations

import argparse
import json
import sys

from .._cede import Contract, Error, Policy
from ._bridge import DRIVERS, INTENTS, Bridge, Settings, contract_named
from ._network import Network


def main(arguments: list[str] | None = None) -> int:
    """Run the command; the exit code is returned: 0 fine, 3 bad input."""
    args = _parser().parse_args(arguments)
    try:
        summary = _run(args)
    except Error as wrong:
        print(f"error: {wrong}", file=sys.stderr)
        return 3
    if args.json:
        print(json.dumps(summary, indent=2))
    else:
        for name, value in summary.items():
            print(f"{name:<26} {_shown(value)}")
    return 0


def _run(args: argparse.Namespace) -> dict[str, float | int | None]:
    settings = Settings(
        driver=args.driver,
        share=args.share,
        ego=args.ego,
        contract=_contract(args.contract),
        shield=args.shield == "on",
        step=args.step,
        time=args.time,
        seed=args.seed,
        gui=args.gui,
        stops=args.stops == "on",
        intent=args.intent,
        policy=_policy(args),
    )
    settings.check()
    bridge = Bridge(
        Network(args.net, length=args.length, width=args.width),
        settings,
        routes=args.routes,
        demand=args.demand,
        pedestrians=args.pedestrians,
    )
    return bridge.run().summary()


def _policy(args: argparse.Namespace) -> Policy | None:
    if args.svo is not None and args.driver != "cede":
        raise Error(f"--svo has no effect with --driver {args.driver}")
    policy = Policy.load(args.weights) if args.weights else None
    return policy if args.svo is None else (policy or Policy.embedded()).oriented(args.svo)


def _contract(name: str | None) -> Contract | None:
    if name is None or name == "sumo":
        return None
    return Contract.load(name) if name.endswith(".toml") else contract_named(name)


def _shown(value: float | int | None) -> str:
    if value is None:
        return "-"
    return f"{value:.3f}" if isinstance(value, float) else str(value)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m cede.sumo", description=__doc__)
    option = parser.add_argument
    option("net", metavar="NET.net.xml", help="the network")
    traffic = parser.add_mutually_exclusive_group(required=True)
    traffic.add_argument("--routes", metavar="R.rou.xml", help="the vehicles and their routes")
    traffic.add_argument(
        "--demand", type=float, metavar="N", help="random vehicles an hour from every arm"
    )
    option(
        "--pedestrians",
        type=float,
        default=0.0,
        metavar="N",
        help="with --demand: random persons on foot an hour from every arm",
    )
    option("--share", type=float, default=1.0, help="share of the vehicles that are driven")
    option("--ego", type=int, metavar="N", help="drive at most N vehicles")
    option("--driver", choices=DRIVERS, default="cede")
    option("--weights", metavar="FILE.cede", help="the policy of the driver cede")
    option(
        "--svo",
        type=float,
        metavar="DEGREES",
        help="social value orientation that the driver cede shows: 0 an egoist, 45 as learned, "
        "90 an altruist",
    )
    option(
        "--contract",
        metavar="NAME|FILE.toml",
        help="sumo, or a named contract of `cede`, or a file [default: sumo, which is all-way-stop "
        "with the brakes of SUMO's vehicles and the network's speed limits]",
    )
    option("--shield", choices=("on", "off"), default="on")
    option(
        "--intent",
        choices=INTENTS,
        default="indicated",
        help="what is known of where others turn: what they indicate, nothing until they are "
        "inside, or everything, as by radio",
    )
    option("--stops", choices=("on", "off"), default="on", help="whether stop signs are obeyed")
    option("--length", type=float, default=5.0, metavar="M", help="of the longest vehicle")
    option("--width", type=float, default=1.8, metavar="M", help="of the widest vehicle")
    option("--step", type=float, default=0.1, metavar="S", help="the contract's period")
    option("--time", type=float, default=600.0, metavar="S", help="seconds to simulate")
    option("--seed", type=int, default=0)
    option("--gui", action="store_true", help="show it in SUMO's window")
    option("--json", action="store_true", help="print one JSON object")
    return parser


if __name__ == "__main__":
    sys.exit(main())
