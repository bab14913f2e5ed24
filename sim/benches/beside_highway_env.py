"""Steps per CPU-second of highway-env's intersection with two vehicles, beside the batch stepper.

    python3 -m venv .build/highway-env
    .build/highway-env/bin/pip install highway-env==1.12.1
    .build/highway-env/bin/python sim/benches/beside_highway_env.py

One step is 0.1 s of both vehicles: one controlled along its lane by an acceleration, one by IDM.
"""

import statistics
import time
import warnings

import gymnasium
import highway_env  # noqa: F401 (registers the environments)

warnings.filterwarnings("ignore")

CONFIG = {
    "action": {"type": "ContinuousAction", "longitudinal": True, "lateral": False},
    "observation": {"type": "Kinematics", "vehicles_count": 2},
    "simulation_frequency": 10,
    "policy_frequency": 10,
    "initial_vehicle_count": 1,  # beside the ego and its challenger: none
    "spawn_probability": 0.0,
    "duration": 13,
}


def steps_per_cpu_second(env, seconds):
    """With resets, and without the time that they take."""
    steps, stepping, vehicles = 0, 0.0, []
    env.reset(seed=0)
    start = time.process_time()
    while time.process_time() - start < seconds:
        before = time.process_time()
        _, _, terminated, truncated, _ = env.step([0.3])
        stepping += time.process_time() - before
        steps += 1
        vehicles.append(len(env.unwrapped.road.vehicles))
        if terminated or truncated:
            env.reset()
    return steps / (time.process_time() - start), steps / stepping, statistics.mean(vehicles)


def main():
    env = gymnasium.make("intersection-v1", config=CONFIG)
    rounds = [steps_per_cpu_second(env, 4.0) for _ in range(5)]
    with_resets, without, vehicles = (statistics.median(column) for column in zip(*rounds))
    print(f"highway-env {highway_env.__version__ if hasattr(highway_env, '__version__') else ''}")
    print(f"{with_resets:.0f} steps per CPU-second with resets, {without:.0f} without")
    print(f"{vehicles:.2f} vehicles on average, median of {len(rounds)} rounds of 4 s")


if __name__ == "__main__":
    main()
