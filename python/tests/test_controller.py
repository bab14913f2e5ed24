import gc
import math

import numpy as np
import pytest

import cede

LEFT = [(-40.0, -2.0), (-6.0, -2.0), (0.0, 0.0), (2.0, 6.0), (2.0, 40.0)]
ONCOMING = np.array([[40.0, 2.0], [-40.0, 2.0]])


def crossing():
    builder = cede.Junction.builder()
    left = builder.path(LEFT, length=4.6, width=1.9)
    oncoming = builder.path(ONCOMING, length=4.6, width=1.9)
    builder.right_of_way(oncoming, left)
    return builder.build(), left, oncoming


def test_a_decision_and_its_reason():
    junction, left, oncoming = crossing()
    drive = cede.Drive(contract=cede.Contract(ego_braking=4.0))
    approach = drive.enter(junction, left)
    tracks = [cede.Track(17, oncoming, junction.vehicle(oncoming, 20.0, 8.0))]
    ego = junction.vehicle(left, 15.0, 6.0)
    assert approach.ready(1.0, ego, tracks) > 0.0
    decision = approach.decide(1.0, ego, tracks)
    assert -4.0 <= decision.acceleration <= 3.0
    assert decision.cause in ("policy", "shielded")
    assert decision.prediction.other == 17
    assert 0.0 <= decision.prediction.svo <= math.pi / 2
    assert decision.fault is None and decision.breach is None


def test_a_car_that_may_arrive_first_is_the_reason():
    junction, left, oncoming = crossing()
    shield = cede.Shield(junction, left)
    tracks = [cede.Track(7, oncoming, junction.vehicle(oncoming, 12.0, 9.0))]
    now, s, speed = 0.0, 18.0, 7.0
    seen = []
    for step in range(40):
        decision = shield.filter(now, junction.vehicle(left, s, speed), tracks, 3.0)
        seen.append(decision)
        speed = max(0.0, speed + 0.1 * decision.acceleration)
        s, now = s + 0.1 * speed, 0.1 * (step + 1)
    shielded = [d for d in seen if d.cause == "shielded"]
    assert shielded and all(d.action in ("nearest", "remembered") for d in shielded)
    reason = shielded[0].reason
    assert reason.other == 7
    assert reason.kind in ("arrival", "entry", "stop")
    assert str(reason) in str(shielded[0])
    assert all(math.isfinite(value) for value in reason.numbers.values())


def test_the_approach_keeps_its_junction_alive():
    junction, left, oncoming = crossing()
    approach = cede.Drive().enter(junction, left)
    ego = junction.vehicle(left, 15.0, 6.0)
    track = cede.Track(1, oncoming, junction.vehicle(oncoming, 20.0, 8.0))
    before = cede.Drive().enter(junction, left).decide(0.0, ego, [track]).acceleration
    del junction
    gc.collect()
    assert approach.decide(0.0, ego, [track]).acceleration == before


def test_a_junction_says_how_paths_meet():
    junction, left, oncoming = crossing()
    conflict = junction.conflict(left, oncoming)
    assert (conflict.kind, conflict.right_of_way) == ("crossing", "other")
    kind, (enters, leaves), _ = conflict.zones[0]
    assert kind == "crossing" and enters < leaves
    assert junction.line(left) == pytest.approx(enters)
    assert junction.points(oncoming).shape == (2, 2)
    assert junction.length(oncoming) == 80.0
    assert junction.project(oncoming, 0.0, 5.0) == 40.0
    assert len(junction) == 2


def test_many_paths_have_room():
    builder = cede.Junction.builder()
    for y in range(60):
        builder.path([(-40.0, 4.0 * y), (40.0, 4.0 * y)])
    junction = builder.build()
    assert len(junction) == 60
    cede.Drive().enter(junction, 59)


def test_a_contract_from_keywords_names_and_toml():
    contract = cede.Contract("all-way-stop", latency=0.05, precedence={"distance": 10.0})
    assert contract.latency == 0.05
    assert contract.precedence["distance"] == 10.0
    assert contract.precedence["patience"] == 15
    assert cede.Contract.from_toml(contract.to_toml()) == contract
    assert contract.replace(precedence=None).precedence is None
    assert cede.Contract().to_dict()["other_max_speed"] == 15.0
    assert "ego_braking=3" in repr(cede.Contract())


def test_a_contract_from_a_file(tmp_path):
    file = tmp_path / "contract.toml"
    file.write_text(cede.Contract().to_toml())
    assert cede.Contract.load(file) == cede.Contract()
    file.write_text(cede.Contract().to_toml().replace("jitter = 0.0", "jitter = 9.0"))
    with pytest.raises(cede.Error, match=r"contract\.toml.*jitter = 9 is outside \[0, 0\.035\]"):
        cede.Contract.load(file)
    with pytest.raises(cede.Error, match="missing.toml"):
        cede.Contract.load(tmp_path / "missing.toml")


def test_a_number_out_of_range_is_named_with_value_and_range():
    with pytest.raises(cede.Error, match=r"ego\.braking = 9 is outside \(0, 8\]") as caught:
        cede.Contract(ego_braking=9)
    assert (caught.value.field, caught.value.value) == ("ego.braking", 9.0)
    assert isinstance(caught.value, ValueError)


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (
            lambda: cede.Contract("best-case"),
            "base = `best-case` is none of: worst-case, all-way-stop",
        ),
        (lambda: cede.Contract(brakes=1.0), "no number `brakes`; it has: period"),
        (lambda: cede.Contract(period="x"), "period = x is not a number"),
        (lambda: cede.Junction.builder().build(), "a junction without paths"),
        (
            lambda: cede.Junction.builder().path([(0, 0)]),
            "points of path 0: a route needs two points",
        ),
        (lambda: cede.Junction.builder().path(np.zeros((3, 3))), r"shape \[3, 3\] is not \(n, 2\)"),
        (lambda: cede.Junction.builder().path([(0, 0), (1, 0)], kind="tram"), "kind = `tram`"),
        (lambda: cede.Junction.builder().right_of_way(0, 1), "path 0: there are 0"),
        (lambda: crossing()[0].length(5), "path 5: there are 2"),
        (lambda: cede.Drive().enter(crossing()[0], 9), "path 9 is not one that the junction lets"),
        (lambda: cede.Drive(part="right"), "part = `right` is none of: left, other"),
        (lambda: cede.Policy.load("none.cede"), "cannot read none.cede"),
        (lambda: cede.Policy.from_onnx("none.onnx"), "none.onnx"),
    ],
)
def test_bad_input_is_one_clear_exception(call, said):
    with pytest.raises(cede.Error, match=said):
        call()


def test_a_sharp_turn_is_refused_when_the_junction_is_built():
    builder = cede.Junction.builder()
    builder.path([(0, 0), (10, 0), (0, 1)])
    with pytest.raises(cede.Error, match=r"path 0: a turn of .* at point 1, more than 90"):
        builder.build()


def test_a_wrong_observation_is_a_fault_not_an_exception():
    junction, left, _ = crossing()
    approach = cede.Drive().enter(junction, left)
    ego = junction.vehicle(left, 15.0, 6.0)
    decision = approach.decide(0.0, cede.Vehicle(ego.s, 300.0, ego.x, ego.y, ego.heading))
    assert decision.cause == "fallback" and decision.no_plan
    assert (decision.fault.kind, decision.fault.track) == ("input", None)
    assert decision.fault.value == 300.0
    assert decision.fault.range[1] == 100.0
    assert "speed (m/s) 300 is outside" in str(decision.fault)


def test_the_embedded_policy_and_its_replacement():
    policy = cede.Policy.embedded()
    assert (policy.features, policy.perspective) == ("rights", "ego")
    junction, left, _ = crossing()
    approach = cede.Drive(policy).enter(junction, left)
    approach.set_policy(policy)
    approach.set_contract(cede.Contract("all-way-stop"))
    assert approach.contract.precedence is not None


def test_a_policy_shows_another_orientation():
    policy = cede.Policy.embedded()
    assert policy.svo == 45
    junction, left, oncoming = crossing()
    ego = junction.vehicle(left, 15.0, 5.0)
    car = [cede.Track(7, oncoming, junction.vehicle(oncoming, 20.0, 6.0))]

    def proposal(svo):
        return cede.Drive(policy, svo=svo).enter(junction, left).proposal(ego, car)

    assert proposal(75) <= proposal(45) <= proposal(15)
    assert proposal(45) == proposal(None)
    with pytest.raises(cede.Error, match="svo = 91: an orientation is between 0 and 90"):
        policy.oriented(91)


def test_the_orientation_of_the_other_is_estimated_if_it_is_wanted():
    junction, left, oncoming = crossing()
    for wanted in (False, True):
        approach = cede.Drive(estimates=wanted).enter(junction, left)
        for step in range(5):
            ego = junction.vehicle(left, 10.0 + 0.5 * step, 5.0)
            car = [cede.Track(7, oncoming, junction.vehicle(oncoming, 10.0 + 0.6 * step, 6.0))]
            prediction = approach.decide(0.1 * step, ego, car).prediction
        assert (prediction.shown is not None) == wanted
    assert 0 <= prediction.shown.svo <= 1.58 and 0 <= prediction.shown.confidence <= 1


def test_headroom_says_how_near_the_contract_is_to_its_limits():
    junction, left, oncoming = crossing()
    shield = cede.Shield(junction, left)
    ego = junction.vehicle(left, 10.0, 0.0)
    car = [cede.Track(7, oncoming, junction.vehicle(oncoming, 10.0, 0.0))]
    shield.filter(0.0, ego, car, 0.0)
    headroom = shield.filter(0.1, ego, car, 0.0).headroom
    assert headroom["other-speed"].track == 7
    assert all(room.left >= 0.0 for room in headroom.values())
    jumped = [cede.Track(7, oncoming, junction.vehicle(oncoming, 12.0, 0.0))]
    decision = shield.filter(0.2, ego, jumped, 0.0)
    assert decision.breach == 7 and decision.headroom["other-position"].left < 0.0


def test_limits_and_bends_bound_the_proposal():
    builder = cede.Junction.builder(lateral=2.0)
    path = builder.path(LEFT, limits=[(0.0, 5.0)])
    junction = builder.build()
    assert junction.allowed_speed(path, 1.0) == 5.0
    assert junction.allowed_speed(path, 40.0) < 5.0
    assert junction.allowed_acceleration(path, 1.0, 9.0) < 0.0
    decision = cede.Drive().enter(junction, path).decide(0.0, junction.vehicle(path, 1.0, 9.0))
    assert decision.acceleration < 0.0


def test_somebody_out_of_sight_is_a_reason():
    junction, left, oncoming = crossing()
    zone = junction.conflict(left, oncoming).zones[0]
    shield = cede.Shield(junction, left)
    shield.set_sight(0.0, [(oncoming, zone[2][0] - 5.0, 15.0)])
    decision = shield.filter(0.0, junction.vehicle(left, zone[1][0] - 8.0, 6.0), [], 3.0)
    assert (decision.reason.kind, decision.reason.path) == ("hidden", oncoming)
    with pytest.raises(cede.Error, match="it must be on the path"):
        shield.set_sight(0.1, [(oncoming, 1e4, 15.0)])


def test_a_pedestrian_may_turn_back():
    builder = cede.Junction.builder()
    road = builder.path([(-40.0, 0.0), (40.0, 0.0)])
    square = {"length": 0.6, "width": 0.6}
    over = builder.path([(0.0, -7.0), (0.0, 7.0)], kind="pedestrian", pace=2.0, **square)
    junction = builder.build()
    shield = cede.Shield(junction, road)
    before = junction.conflict(road, over).zones[0][1][0] - 3.7
    ego = junction.vehicle(road, before, 4.0)
    gone = cede.Track(3, over, junction.vehicle(over, 10.0, 1.0), kind="pedestrian")
    decision = shield.filter(0.0, ego, [gone], 3.0)
    assert decision.reason.kind == "arrival" and decision.reason.other == 3


def both_go(order):
    """Periods in which two that came to their lines at once, and wait, would both go."""
    east, north = [(-60.0, 0.0), (60.0, 0.0)], [(0.0, -60.0), (0.0, 60.0)]
    shields = []
    for ways, places in (((east, north), order), ((north, east), order[::-1])):
        # Each has its own way as path 0.
        builder = cede.Junction.builder(tolerance=0.0)
        paths = [
            builder.path(way, order=place, length=4.5, width=1.8)
            for way, place in zip(ways, places, strict=True)
        ]
        junction = builder.build()
        shields.append(
            (junction, paths, cede.Shield(junction, paths[0], cede.Contract("all-way-stop")))
        )
    both = 0
    for period in range(200):
        left = max(50 - period, 0) / 50
        goes = []
        for junction, (own, other), shield in shields:
            at = junction.conflict(own, other).zones[0][1][0] - 0.01 - 10 * left * left
            ego, track = (junction.vehicle(path, at, 4 * left) for path in (own, other))
            decision = shield.filter(0.1 * period, ego, [cede.Track(1, other, track)], 2.0)
            goes.append(decision.acceleration > 0 and left == 0)
        both += all(goes)
    return both


def test_vehicles_that_number_paths_differently_agree_on_the_order_of_turns():
    assert both_go([None, None]) > 0
    assert both_go([3, 7]) == 0
