"""Environment steps a second: Cede's environments beside highway-env, in one run, on one core.

pip install highway-env && python python/benches/steps.py
"""

import os
import statistics
import time

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(name, "1")

import gymnasium
import numpy as np

import cede.envs

ID = "cede/Encounter-v0"
RUNS = 5
SECONDS = 2.0


def rate(step, per_call):
    """Steps a second: median, least and most of some runs, in processor time of this process."""
    step()
    rates = []
    for _ in range(RUNS):
        calls, began = 0, time.process_time()
        while (taken := time.process_time() - began) < SECONDS:
            for _ in range(16):
                step()
            calls += 16
        rates.append(per_call * calls / taken)
    return statistics.median(rates), min(rates), max(rates)


def vector(num_envs, sample, **keywords):
    """A random policy on the vector environment; `sample` draws its actions."""
    env = gymnasium.make_vec(ID, num_envs=num_envs, **keywords)
    env.reset(seed=0)
    env.action_space.seed(0)
    rng = np.random.default_rng(0)
    buffer = np.empty(env.action_space.shape, np.float32)

    def fast():
        rng.random(out=buffer, dtype=np.float32)
        np.multiply(buffer, 2, out=buffer)
        np.subtract(buffer, 1, out=buffer)
        return buffer

    draw = {"space": env.action_space.sample, "numpy": fast}[sample]
    return lambda: env.step(draw())


def single(env, actions):
    """A random policy on a single environment, begun anew when an episode ends."""
    env.reset(seed=0)
    chosen = iter(())

    def step():
        nonlocal chosen
        action = next(chosen, None)
        if action is None:
            chosen = iter(actions)
            action = next(chosen)
        _, _, terminated, truncated, _ = env.step(action)
        if terminated or truncated:
            env.reset()

    return step


def report(name, measured):
    median, least, most = measured
    print(f"{name:<62} {median:>12,.0f} [{least:,.0f}, {most:,.0f}]", flush=True)


def main():
    print(
        f"steps a second of processor time, median of {RUNS} runs of {SECONDS:.0f} s [least, most]"
    )
    n = 4096
    for mode in ("joint", "left"):
        for sample, copy in (("numpy", False), ("numpy", True), ("space", True)):
            how = f"actions by {sample}, {'copies' if copy else 'no copies'}"
            measured = rate(vector(n, sample, mode=mode, copy=copy), n)
            report(f"vector environment, {mode}, {n:,} encounters, {how}", measured)
    rng = np.random.default_rng(0)
    actions = list(rng.uniform(-1, 1, (1024, 2)).astype(np.float32))
    report("single environment, gymnasium.make", rate(single(gymnasium.make(ID), actions), 1))
    report("single environment, no wrappers", rate(single(cede.envs.EncounterEnv(), actions), 1))
    try:
        import highway_env  # noqa: F401
    except ImportError:
        print("skipped: highway-env is not installed")
        return
    # One simulated step for each step of the environment, as Cede's; by default there are 15.
    each = {"simulation_frequency": 10, "policy_frequency": 10}
    env = gymnasium.make("intersection-v2", config=each)
    actions = [env.action_space.sample() for _ in range(64)]
    report("highway-env intersection-v2, gymnasium.make", rate(single(env, actions), 1))


if __name__ == "__main__":
    main()
