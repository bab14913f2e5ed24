import os
import signal
import sys
import threading
import time

import pytest

import cede

pytest.importorskip("ray", reason="no Ray (pip install 'cede[ray]')")
os.environ["RAY_USAGE_STATS_ENABLED"] = "0"

import ray
from ray.cluster_utils import Cluster

import cede.ray

# The workers do not have this file.
ray.cloudpickle.register_pickle_by_value(sys.modules[__name__])


@pytest.fixture(scope="module")
def cluster():
    """A head without processors, and two workers of one each."""
    made = Cluster(initialize_head=True, head_node_args={"num_cpus": 0})
    made.workers = [made.add_node(num_cpus=1) for _ in range(2)]
    made.wait_for_nodes()
    ray.init(address=made.address, log_to_driver=False)
    yield made
    ray.shutdown()
    made.shutdown()


def row(seed):
    return cede.evaluate("human", encounters=40, split="all", seed=seed).to_dict("records")[0]


def test_a_cluster_gives_the_bits_of_one_machine(cluster):
    options = {"encounters": 40, "split": "all"}
    rows = cede.ray.evaluations(
        ["cede", "idm"], seeds=[1, 2], shields=[False, "all-way-stop"], **options
    )
    assert len(rows) == 8
    assert list(rows.seed) == [1, 2] * 4
    for (driver, contract, seed), far in rows.groupby(["driver", "contract", "seed"]):
        shield = contract if contract != "none" else False
        near = cede.evaluate(driver, shield=shield, seed=seed, **options)
        far = far.drop(columns=["contract", "seed"]).reset_index(drop=True)
        assert far.equals(near), (driver, contract, seed)


def test_a_killed_worker_costs_nothing_but_time(cluster, tmp_path):
    def kills_its_worker_once(seed):
        if seed == 2 and not (tmp_path / "killed").exists():
            (tmp_path / "killed").touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return row(seed)

    found = cede.ray.map(kills_its_worker_once, range(5))
    assert (tmp_path / "killed").exists()
    assert found == [row(seed) for seed in range(5)]


def test_a_lost_machine_costs_nothing_but_time(cluster, tmp_path):
    def slow(seed):
        (tmp_path / f"{seed}.{time.monotonic_ns()}").touch()
        time.sleep(1.0)
        return row(seed)

    def lose():
        while len(list(tmp_path.iterdir())) < 2:
            time.sleep(0.05)
        cluster.remove_node(cluster.workers.pop(), allow_graceful=False)

    loses = threading.Thread(target=lose, daemon=True)
    loses.start()
    found = cede.ray.map(slow, range(4))
    loses.join(timeout=10)
    assert not loses.is_alive()
    assert found == [row(seed) for seed in range(4)]
    # What the lost machine was at was begun twice.
    assert len(list(tmp_path.iterdir())) > 4
    cluster.workers.append(cluster.add_node(num_cpus=1))


def test_an_item_that_always_kills_its_worker_is_an_error(cluster):
    with pytest.raises(cede.Error, match="lost with its worker"):
        cede.ray.map(lambda _: os.kill(os.getpid(), signal.SIGKILL), [1], retries=1)


def test_what_an_item_raises_is_raised(cluster):
    with pytest.raises(cede.Error, match="ghost"):
        cede.ray.evaluations("ghost", encounters=20, split="all")


def test_commands_run_on_the_cluster(cluster):
    printed = cede.ray.commands([["-c", f"print({i})"] for i in range(3)], program=sys.executable)
    assert printed == ["0\n", "1\n", "2\n"]
    with pytest.raises(cede.Error, match="ended with 3: nothing"):
        cede.ray.commands(
            [["-c", "import sys; print('nothing', file=sys.stderr); sys.exit(3)"]],
            program=sys.executable,
        )
    with pytest.raises(cede.Error, match="program = `no-such-program`"):
        cede.ray.commands([[]], program="no-such-program")
