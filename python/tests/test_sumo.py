import collections
import json
import math
import os
import shutil
import subprocess
import sys

import pytest

import cede

sumolib = pytest.importorskip("sumolib", reason="no SUMO (pip install 'cede[sumo]')")
pytest.importorskip("libsumo", reason="no SUMO (pip install 'cede[sumo]')")

from cede.sumo import Bridge, Network, Settings
from cede.sumo.__main__ import main
from cede.sumo._bridge import Car, contract_named
from cede.sumo._network import LATERAL, REACH, Site
from cede.sumo._persons import Person, Walk, nearest, zones_of

ARMS = {"N": (0, 200), "S": (0, -200), "E": (200, 0), "W": (-200, 0)}


def netconvert(folder, kind, lanes=1, more=("--no-turnarounds",)):
    """A junction of four arms."""
    program = shutil.which("netconvert", path=os.path.dirname(sys.executable))
    program = program or shutil.which("netconvert")
    nodes = [f'<node id="{name}" x="{x}" y="{y}"/>' for name, (x, y) in ARMS.items()]
    nodes.append(f'<node id="C" x="0" y="0" type="{kind}"/>')
    edges = []
    for name in ARMS:
        for ends in ((name, "C"), ("C", name)):
            priority = 2 if name in "EW" else 1
            edges.append(
                f'<edge id="{"".join(ends)}" from="{ends[0]}" to="{ends[1]}" numLanes="{lanes}" '
                f'speed="13.89" priority="{priority}"/>'
            )
    (folder / "n.nod.xml").write_text(f"<nodes>{''.join(nodes)}</nodes>")
    (folder / "n.edg.xml").write_text(f"<edges>{''.join(edges)}</edges>")
    net = folder / f"{kind}.net.xml"
    files = ["-n", folder / "n.nod.xml", "-e", folder / "n.edg.xml", "-o", net]
    subprocess.run([program, *map(str, files), *more], check=True, capture_output=True)
    return net


def run(net, pedestrians=0.0, **settings):
    demand = settings.pop("demand", 150.0)
    settings = Settings(**{"time": 120.0, **settings})
    return Bridge(Network(net), settings, demand=demand, pedestrians=pedestrians).run().summary()


CROSSINGS = ("--no-turnarounds", "--sidewalks.guess", "--crossings.guess")


def roundabout(folder):
    """Four arms at a ring of four junctions."""
    program = shutil.which("netconvert", path=os.path.dirname(sys.executable)) or "netconvert"
    around = ((0, 20), (-20, 0), (0, -20), (20, 0))
    nodes, edges = [], []
    for i, (x, y) in enumerate(around):
        nodes.append(f'<node id="R{i}" x="{x}" y="{y}" type="priority"/>')
        nodes.append(f'<node id="A{i}" x="{8 * x}" y="{8 * y}"/>')
        ends = ((f"R{i}", f"R{(i + 1) % 4}", 3), (f"A{i}", f"R{i}", 1), (f"R{i}", f"A{i}", 1))
        for one, two, priority in ends:
            edges.append(
                f'<edge id="{one}{two}" from="{one}" to="{two}" numLanes="1" speed="8.33" '
                f'priority="{priority}"/>'
            )
    (folder / "r.nod.xml").write_text(f"<nodes>{''.join(nodes)}</nodes>")
    (folder / "r.edg.xml").write_text(f"<edges>{''.join(edges)}</edges>")
    net = folder / "roundabout.net.xml"
    files = ["-n", folder / "r.nod.xml", "-e", folder / "r.edg.xml", "-o", net]
    options = ["--no-turnarounds"]
    subprocess.run([program, *map(str, files), *options], check=True, capture_output=True)
    return net


def test_a_junction_becomes_paths(tmp_path):
    (site,) = Network(netconvert(tmp_path, "right_before_left")).sites
    assert (site.name, site.kind, len(site.movements)) == ("C", "right_before_left", 12)
    left = next(m for m in site.movements if (m.incoming, m.outgoing) == ("SC_0", "CW_0"))
    straight = next(m for m in site.movements if (m.incoming, m.outgoing) == ("NC_0", "CS_0"))
    conflict = site.junction.conflict(left.driven, straight.path)
    assert conflict.kind == "crossing"
    # Who comes from the right goes first; oncoming straight traffic goes before a left turn.
    assert (conflict.right_of_way, conflict.priority) == ("other", "unsigned")
    # Among those who are driven whoever arrives first does.
    assert site.junction.conflict(left.driven, straight.driven).priority == "first-come"
    # Nobody has the right of way over whoever is ahead in one lane.
    ahead = next(m for m in site.movements if (m.incoming, m.outgoing) == ("SC_0", "CN_0"))
    assert site.junction.conflict(left.driven, ahead.path).right_of_way == "unsettled"
    assert site.junction.length(left.path) == pytest.approx(left.length, abs=0.02)

    # A turn is slower than the limit, a straight way is not.
    assert min(left.allowed) < 8.0 and min(straight.allowed) == pytest.approx(13.89)


def test_a_vehicle_comes_down_to_a_bend_in_comfort(tmp_path):
    network = Network(netconvert(tmp_path, "priority"))
    for movement in network.sites[0].movements:
        allowed, arc = movement.allowed, movement.arc
        for i in range(1, len(allowed)):
            down = allowed[i - 1] ** 2 - allowed[i] ** 2
            assert down <= 2 * network.braking * (arc[i] - arc[i - 1]) + 1e-9
            assert allowed[i] ** 2 * movement.curvature[i] <= LATERAL + 1e-9
    # The contract is told of the limits, too.
    assert network.fastest == pytest.approx(13.89 + 0.1)


KINDS = (
    "allway_stop",
    "priority",
    "priority_stop",
    "right_before_left",
    "left_before_right",
    "unregulated",
    "zipper",
)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("driver", ["profile", "cede"])
def test_every_kind_of_junction_is_driven_without_a_collision(tmp_path, kind, driver):
    summary = run(netconvert(tmp_path, kind), driver=driver)
    assert summary["driven"] > 5
    assert summary["collisions"] == 0
    assert summary["us_per_decision"] > 0.0


def test_the_profile_brings_light_traffic_through_an_all_way_stop(tmp_path):
    net = netconvert(tmp_path, "allway_stop")
    shielded = run(net, driver="profile", time=300.0, demand=60.0)
    sumo = run(net, driver="sumo", time=300.0, demand=60.0)
    assert shielded["arrived"] == sumo["arrived"] > 5
    assert (shielded["collisions"], shielded["stuck"], shielded["breaches"]) == (0, 0, 0)


def is_through(net, driver, arrivals):
    """Nobody is hit or stuck, and so many arrive of those that arrive with SUMO's own drivers."""
    summary = run(net, driver=driver, time=300.0, demand=200.0)
    assert (summary["collisions"], summary["stuck"]) == (0, 0)
    sumo = run(net, driver="sumo", time=300.0, demand=200.0)
    assert summary["arrived"] >= arrivals * sumo["arrived"]


@pytest.mark.parametrize("kind", KINDS)
def test_nobody_is_stuck_where_the_profile_drives_everybody(tmp_path, kind):
    is_through(netconvert(tmp_path, kind), "profile", 0.95)


@pytest.mark.parametrize("kind", KINDS)
def test_nobody_is_stuck_where_the_policy_drives_everybody(tmp_path, kind):
    is_through(netconvert(tmp_path, kind), "cede", 0.95)


@pytest.mark.parametrize(
    ("kind", "seed"), [("priority", 4), ("priority_stop", 4), ("priority_stop", 5)]
)
def test_nobody_stops_where_others_have_to_pass(tmp_path, kind, seed):
    """Turning vehicles that came to rest among the zones kept each other, and all others, waiting."""
    summary = run(netconvert(tmp_path, kind), time=300.0, demand=200.0, seed=seed)
    assert (summary["collisions"], summary["stuck"]) == (0, 0)
    # In the bend no plan had to make up for a driver that is slower.
    assert summary["lateral_acceleration_max"] < 4.0
    assert summary["no_plan_share"] < 0.001


@pytest.mark.parametrize(
    ("kind", "demand", "seed"),
    [
        ("priority", 200.0, 0),
        ("priority", 300.0, 0),
        ("priority", 300.0, 1),
        ("priority_stop", 300.0, 1),
    ],
)
def test_bends_are_comfortable_in_dense_traffic(tmp_path, kind, demand, seed):
    """A plan with little to spare is left in time, or not at all; and without one nobody races."""
    summary = run(netconvert(tmp_path, kind), time=300.0, demand=demand, seed=seed)
    assert (summary["collisions"], summary["stuck"]) == (0, 0)
    assert summary["lateral_acceleration_max"] <= 3.5


def test_nobody_is_hit_among_sumos_drivers(tmp_path):
    net = netconvert(tmp_path, "right_before_left")
    summary = run(net, time=300.0, demand=300.0, share=0.5, seed=1)
    assert (summary["ego_collisions"], summary["stuck"]) == (0, 0)


def test_who_has_set_off_is_let_pass(tmp_path):
    network = Network(netconvert(tmp_path, "right_before_left"))
    (site,) = network.sites
    by_ends = {(m.incoming, m.outgoing): m for m in site.movements}

    def car(name, ends, beyond, speed):
        movement = by_ends[ends]
        return Car(
            name,
            0,
            5.0,
            True,
            site=site,
            movement=movement,
            placed=0.0,
            on_path=True,
            s=movement.line + beyond,
            speed=speed,
        )

    bridge = Bridge(network, Settings(), demand=1.0)

    def lets_pass(ego, other):
        bridge.cars = {car.name: car for car in (ego, other)}
        return bridge._lets_pass(ego)

    ego = car("ego", ("NC_0", "CS_0"), -0.1, 0.0)
    left = car("left", ("SC_0", "CW_0"), 0.5, 1.0)
    # It has the right of way over the left turn, which has begun all the same.
    assert lets_pass(ego, left)
    # Who waits, has passed, keeps out of its way or is driven is the shield's matter.
    assert not lets_pass(ego, car("waits", ("SC_0", "CW_0"), 0.2, 0.0))
    assert not lets_pass(ego, car("past", ("SC_0", "CW_0"), 18.0, 5.0))
    assert not lets_pass(ego, car("right", ("NC_0", "CW_0"), 0.5, 1.0))
    left.shield = object()
    assert not lets_pass(ego, left)
    # As it is of who is on the way already.
    left.shield = None
    assert not lets_pass(car("ego", ("NC_0", "CS_0"), 0.0, 5.0), left)
    assert not lets_pass(car("ego", ("NC_0", "CS_0"), 3.0, 1.0), left)


@pytest.mark.parametrize("stops", [True, False])
def test_a_stop_sign_is_obeyed(tmp_path, stops):
    routes = tmp_path / "r.rou.xml"
    routes.write_text(
        '<routes><vehicle id="a" depart="0"><route edges="SC CN"/></vehicle></routes>'
    )
    net = Network(netconvert(tmp_path, "priority_stop"))
    bridge = Bridge(net, Settings(time=40.0, stops=stops), routes=routes)
    slowest = math.inf
    for _ in bridge.steps():
        for car in bridge.cars.values():
            if car.shield is not None and abs(car.s - car.movement.line) < 2.0:
                assert bridge.sumo.vehicle.getSpeed(car.name) == car.speed
                slowest = min(slowest, car.speed)
    assert (slowest < 0.1) == stops
    assert bridge.measures.arrived == 1


def test_who_is_behind_another_is_told_if_it_may_take_another_way(tmp_path):
    routes = tmp_path / "r.rou.xml"
    vehicle = '<vehicle id="{}" depart="{}" departSpeed="8"><route edges="{}"/></vehicle>'
    rows = (("a", 0, "WC CN"), ("b", 2, "WC CE"), ("c", 4, "WC CE"), ("ego", 5, "SC CN"))
    routes.write_text(f"<routes>{''.join(vehicle.format(*row) for row in rows)}</routes>")
    told = set()

    class Watched(Bridge):
        def _drive(self, car, tracks):
            if car.name == "ego" and self.cars["a"].lane == "WC_0":
                told.update(track.number for track in tracks)
            super()._drive(car, tracks)

    net = Network(netconvert(tmp_path, "priority"))
    bridge = Watched(net, Settings(driver="profile", time=14.0, intent="known"), routes=routes)
    bridge.run()
    # Numbers follow departures: the third is behind the second, and goes the same way.
    assert told == {1, 2}


@pytest.mark.parametrize("intent", ["indicated", "known"])
def test_turns_are_believed(tmp_path, intent):
    net = netconvert(tmp_path, "priority")
    summary = run(net, driver="profile", intent=intent, time=200.0, demand=150.0, seed=1)
    assert (summary["collisions"], summary["stuck"]) == (0, 0)
    assert summary["arrived"] > 15


def test_turns_need_not_be_known(tmp_path):
    net = netconvert(tmp_path, "priority")
    summary = run(net, driver="profile", intent="hidden", time=200.0, demand=150.0, seed=1)
    assert summary["collisions"] == 0
    assert summary["arrived"] > 10


@pytest.mark.parametrize("kind", ["roundabout", "right_before_left"])
def test_what_is_left_out_or_worked_out_once_changes_nothing(tmp_path, kind, monkeypatch):
    """Who has left all zones is no track, and ways that are still one are placed once."""
    net = roundabout(tmp_path) if kind == "roundabout" else netconvert(tmp_path, kind)

    def summary():
        return {**run(net, demand=250.0, share=0.5, seed=2), "us_per_decision": None}

    quick = summary()
    monkeypatch.setattr(Site, "shared", {})
    monkeypatch.setattr(Site, "left", collections.defaultdict(dict))
    assert summary() == quick


def test_nobody_is_left_out_before_it_has_left(tmp_path):
    (site,) = Network(netconvert(tmp_path, "unregulated")).sites
    finite = 0
    for movement in site.movements:
        left = site.left[movement.path]
        assert left[movement.outgoing] == math.inf
        for other in site.movements:
            zones = site.junction.conflict(movement.driven, other.path).zones
            for stretch in other.stretches:
                if left[stretch.lane] < math.inf:
                    finite += 1
                    place, _ = other.place(stretch.start + left[stretch.lane] * stretch.scale)
                    assert all(theirs[1] < place for _, _, theirs in zones)
    assert finite > 0


def test_the_right_of_way_is_that_of_the_signs(tmp_path):
    (site,) = Network(netconvert(tmp_path, "priority")).sites
    by_ends = {(m.incoming, m.outgoing): m for m in site.movements}
    major, minor = by_ends["WC_0", "CE_0"], by_ends["SC_0", "CN_0"]
    conflict = site.junction.conflict(major.driven, minor.path)
    assert (conflict.right_of_way, conflict.priority) == ("ego", "signed")
    assert (minor.direction, by_ends["SC_0", "CW_0"].direction) == ("straight", "left")


def test_a_share_is_driven_and_a_number_of_egos(tmp_path):
    net = netconvert(tmp_path, "priority")
    assert run(net, driver="profile", ego=1)["driven"] == 1
    half = run(net, driver="profile", share=0.5)
    assert 0 < half["driven"] < half["demanded"]


def test_the_same_seed_gives_the_same_run(tmp_path):
    net = netconvert(tmp_path, "allway_stop")
    one, two = (run(net, driver="cede", seed=3) for _ in range(2))
    one.pop("us_per_decision"), two.pop("us_per_decision")
    assert one == two


@pytest.mark.parametrize("driver", ["profile", "cede"])
def test_persons_on_crossings_are_let_pass(tmp_path, driver):
    net = netconvert(tmp_path, "priority", more=CROSSINGS)
    summary = run(net, driver=driver, pedestrians=50.0, demand=80.0, time=150.0)
    assert summary["persons"] > 5
    assert (summary["collisions"], summary["person_collisions"], summary["breaches"]) == (0, 0, 0)
    assert summary["stuck"] == 0
    assert summary["person_max_wait_s"] < 30.0
    assert summary["arrived"] > 2


def test_a_crossing_is_a_path_for_persons(tmp_path):
    (site,) = Network(netconvert(tmp_path, "priority", more=CROSSINGS)).sites
    assert len(site.crossings) == 4
    straight = next(m for m in site.movements if (m.incoming, m.outgoing) == ("WC_1", "CE_1"))
    crossed = [c for c in site.crossings if zones_of(site, straight, c)]
    # That of the arm it comes from and that of the arm it leaves by.
    assert len(crossed) == 2
    for crossing in crossed:
        assert crossing.width == pytest.approx(4.0)
        (x, y), (dx, dy) = crossing.start, crossing.along
        assert crossing.place(x, y) == pytest.approx(REACH)
        assert crossing.place(x + 3 * dx, y + 3 * dy) == pytest.approx(REACH + 3)
        # Beside it, before the kerb: as far as it is from its end.
        beside = crossing.width / 2 + 3
        at = (x - 4 * dx + beside * dy, y - 4 * dy - beside * dx)
        assert crossing.place(*at) == pytest.approx(REACH - 5)


def test_a_person_touches_a_vehicle():
    person = Person("p", x=10.0, y=0.0)
    assert person.touches((12.0, 0.0), 0.0, (5.0, 1.8))
    assert person.touches((9.8, 0.0), 0.0, (5.0, 1.8))
    assert not person.touches((9.6, 0.0), 0.0, (5.0, 1.8))
    assert not person.touches((12.0, 1.3), 0.0, (5.0, 1.8))
    assert person.touches((10.0, 2.0), math.pi / 2, (5.0, 1.8))
    assert not person.touches((8.0, 0.0), math.pi, (1.0, 1.8))


def test_nobody_in_the_lee_of_another_person_is_told(tmp_path):
    walks = [Walk(Person(name), 0, 0, s) for name, s in (("a", 1.0), ("b", 4.0), ("c", 9.0))]
    assert [walk.person.name for walk in nearest(walks, (5.0, 7.0))] == ["b", "c"]
    assert [walk.person.name for walk in nearest(walks, (0.5, 7.0))] == ["a"]


def test_a_roundabout(tmp_path):
    net = roundabout(tmp_path)
    assert len(Network(net).sites) == 4
    for driver in ("profile", "cede"):
        summary = run(net, driver=driver, time=200.0)
        assert (summary["collisions"], summary["stuck"]) == (0, 0)
        assert summary["arrived"] > 10


def test_lanes_and_a_grid(tmp_path):
    assert run(netconvert(tmp_path, "priority", lanes=2), driver="profile")["collisions"] == 0
    program = shutil.which("netgenerate", path=os.path.dirname(sys.executable)) or "netgenerate"
    net = tmp_path / "grid.net.xml"
    options = ["--grid", "--grid.number", "3", "--grid.length", "150", "--no-turnarounds"]
    options += ["--grid.attach-length", "120", "-j", "allway_stop", "-o", str(net)]
    subprocess.run([program, *options], check=True, capture_output=True)
    assert len(Network(net).sites) == 9
    assert run(net, driver="profile", demand=60.0)["collisions"] == 0


def test_the_command_line(tmp_path, capsys):
    net = netconvert(tmp_path, "allway_stop")
    arguments = [str(net), "--demand", "100", "--driver", "profile", "--time", "60", "--json"]
    assert main(arguments) == 0
    out = capsys.readouterr().out
    summary = json.loads(out[out.index("{") :])
    assert {"arrived", "mean_delay_s", "us_per_decision", "ttc_below_1s"} <= set(summary)
    contract = tmp_path / "c.toml"
    contract.write_text("period = 9")
    assert main([*arguments, "--contract", str(contract)]) == 3
    assert "c.toml" in capsys.readouterr().err


def test_bad_networks_and_options_are_one_clear_exception(tmp_path):
    with pytest.raises(cede.Error, match="none.net.xml: no such network"):
        Network(tmp_path / "none.net.xml")
    wrong = tmp_path / "wrong.net.xml"
    wrong.write_text("no xml")
    with pytest.raises(cede.Error, match="wrong.net.xml: not a network"):
        Network(wrong)
    with pytest.raises(cede.Error, match="no junction of a type that is driven"):
        Network(netconvert(tmp_path, "traffic_light"))
    plain = netconvert(tmp_path, "priority", more=["--no-turnarounds", "--no-internal-links"])
    with pytest.raises(cede.Error, match="junction C, connection .* no internal lanes"):
        Network(plain)
    net = netconvert(tmp_path, "allway_stop")
    with pytest.raises(cede.Error, match=r"share = 2 is outside \[0, 1\]"):
        run(net, share=2)
    with pytest.raises(cede.Error, match="step = 0.2 s is not the contract's period, 0.1 s"):
        run(net, step=0.2)
    for demand in (-5.0, 0.0, math.inf, math.nan):
        with pytest.raises(cede.Error, match=r"demand = .* is outside \[1, 100000\] an hour"):
            Bridge(Network(net), Settings(), demand=demand).run()
    with pytest.raises(cede.Error, match="none of: worst-case, .*, sumo$"):
        contract_named("all-way-stp")
    configuration = tmp_path / "x.sumocfg"
    configuration.write_text("<configuration/>")
    with pytest.raises(cede.Error, match="x.sumocfg: a configuration: pass the network"):
        Network(configuration)
    back = netconvert(tmp_path, "priority", more=())
    with pytest.raises(cede.Error, match="--no-turnarounds"):
        Network(back)
    with pytest.raises(cede.Error, match="no such file of routes"):
        Bridge(Network(net), Settings(), routes=tmp_path / "r.rou.xml").run()


def test_a_vehicle_that_is_too_long_is_named(tmp_path):
    routes = tmp_path / "r.rou.xml"
    routes.write_text(
        '<routes><vType id="t" length="12" width="2.5"/>'
        '<vehicle id="bus" type="t" depart="0"><route edges="NC CS"/></vehicle></routes>'
    )
    net = Network(netconvert(tmp_path, "allway_stop"))
    with pytest.raises(cede.Error, match=r"vehicle bus is 12.0 m × 2.5 m: .* for 5.0 m × 1.8 m"):
        Bridge(net, Settings(time=5.0), routes=routes).run()
    bridge = Bridge(Network(net.file, length=12.0, width=2.5), Settings(time=60.0), routes=routes)
    assert bridge.run().arrived == 1


def test_a_vehicle_that_leaves_the_network_is_let_go(tmp_path):
    routes = tmp_path / "r.rou.xml"
    routes.write_text(
        '<routes><vehicle id="a" depart="0" departSpeed="max" arrivalPos="50">'
        '<route edges="NC CS"/></vehicle></routes>'
    )
    net = Network(netconvert(tmp_path, "allway_stop"))
    summary = Bridge(net, Settings(driver="profile", time=60.0), routes=routes).run().summary()
    assert (summary["arrived"], summary["demanded"]) == (1, 1)


def test_pedestrians_need_pavements_and_a_demand(tmp_path):
    net = netconvert(tmp_path, "priority")
    with pytest.raises(cede.Error, match="pedestrians an hour and arm give none"):
        run(net, pedestrians=100.0)
    routes = tmp_path / "r.rou.xml"
    routes.write_text("<routes/>")
    with pytest.raises(cede.Error, match="pedestrians come with a demand"):
        Bridge(Network(net), Settings(), routes=routes, pedestrians=5.0).run()


def test_a_closed_connection_is_one_clear_exception(tmp_path):
    class Closed(Bridge):
        def _drive_all(self):
            super()._drive_all()
            if self._now > 1.0:
                self.sumo.close()

    net = Network(netconvert(tmp_path, "allway_stop"))
    with pytest.raises(cede.Error, match=r"SUMO is gone after 1\.\d s"):
        Closed(net, Settings(driver="profile"), demand=100.0).run()
