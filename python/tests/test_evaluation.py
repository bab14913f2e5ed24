import numpy as np
import pytest
from test_data import recorded

import cede
from cede.evaluation import DRIVERS


def test_a_row_for_each_driver_and_the_episodes():
    table, episodes = cede.evaluate(["replay", "cede"], encounters=60, split="all", episodes=True)
    assert list(table.driver) == ["replay", "cede"]
    assert table.priority_accuracy[0] == 1.0
    assert set(episodes.end) <= {"finished", "collision", "time-out"}
    assert len(episodes) == table.n.sum()


def test_a_function_drives():
    seen = []

    def cautious(view):
        seen.append(view)
        return -1.0 if view.other_distance < view.distance else 1.0

    table = cede.evaluate(cautious, encounters=40, split="all", mode="ego", partner="idm")
    assert table.driver[0] == "cautious"
    assert table.n[0] == 2 * table.encounters[0]
    view = seen[0]
    assert view.role in ("left", "other")
    assert view.observation.shape == (14,)
    assert view.observation[1] == np.float32(view.speed) * np.float32(0.1)


def test_an_altruist_goes_first_less_often_than_an_egoist():
    policy = cede.Policy.embedded()
    table = cede.evaluate(
        [policy.oriented(75), policy.oriented(15)],
        encounters=60,
        split="all",
        mode="ego",
        until="cleared",
        partner="cede",
    )
    assert list(table.driver) == ["policy 75°", "policy 15°"]
    assert table.went_first[0] < table.went_first[1]


def test_a_function_behind_the_shield_does_not_collide():
    def blind(view):
        return 3.0

    off, on = (
        cede.evaluate(blind, encounters=60, split="all", until="cleared", shield=shield)
        for shield in (False, True)
    )
    assert off.collisions[0] > 0 and on.collisions[0] == 0
    assert on.shielded_steps[0] > 0


def test_what_a_function_raises_is_raised():
    def broken(view):
        raise RuntimeError("no idea")

    with pytest.raises(RuntimeError, match="no idea"):
        cede.evaluate(broken, encounters=20, split="all")
    with pytest.raises(TypeError):
        cede.evaluate(lambda view: "fast", encounters=20, split="all")


def test_any_number_of_threads_gives_the_same_rows():
    rows = [cede.evaluate("human", encounters=60, split="all", threads=n) for n in (1, 3)]
    assert rows[0].equals(rows[1])


def test_the_rows_are_those_of_the_command_line():
    # What `cede evaluate --site EP0 --split train --driver cede` prints.
    table = cede.evaluate("cede", recorded(), site="EP0", split="train")
    assert (table.n[0], table.collisions[0]) == (215, 3)
    assert table.priority_accuracy[0] == pytest.approx(195 / 215)


def test_unknown_drivers_and_splits_are_named():
    with pytest.raises(cede.Error, match="driver = `ghost` is neither"):
        cede.evaluate("ghost")
    with pytest.raises(cede.Error, match="no split is called `half`"):
        cede.evaluate("replay", encounters=20, split="half")
    assert "cede" in DRIVERS
