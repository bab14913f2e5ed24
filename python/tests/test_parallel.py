import numpy as np
import pytest

pytest.importorskip("pettingzoo", reason="no PettingZoo (pip install 'cede[pettingzoo]')")

from pettingzoo.test import parallel_api_test, parallel_seed_test

from cede.parallel import parallel_env


def test_pettingzoo_accepts_it():
    parallel_api_test(parallel_env(encounters=40), num_cycles=500)
    parallel_seed_test(lambda: parallel_env(encounters=40))


def test_each_sees_the_other_as_its_other():
    env = parallel_env(encounters=40)
    seen, _ = env.reset(seed=4)
    np.testing.assert_allclose(seen["left"][0:2], seen["other"][2:4], rtol=1e-6)
    np.testing.assert_allclose(seen["left"][6] + seen["other"][6], np.pi / 2, atol=1e-5)
