"""Trains stable-baselines3's SAC on an encounter, and flies its policy behind the shield.

pip install ./python stable-baselines3 onnx && python python/examples/sac.py
"""

import argparse
import time

import gymnasium
import numpy as np
import onnx
import torch
from onnx import TensorProto, helper, numpy_helper
from stable_baselines3 import SAC

import cede
from cede.envs import FEATURES, SCALES

ID = "cede/Encounter-v0"
TASK = {"mode": "left", "reward": "paper", "encounters": 1000}


def export(model, file):
    """Write the actor's mean as the ONNX graph that `cede.Policy.from_onnx` reads."""
    hidden = [layer for layer in model.actor.latent_pi if isinstance(layer, torch.nn.Linear)]
    constants = {"scale": SCALES, "low": np.float32(-8.0), "high": np.float32(8.0)}
    nodes = [
        helper.make_node("Mul", ["features", "scale"], ["scaled"]),
        helper.make_node("Clip", ["scaled", "low", "high"], ["x0"]),
    ]
    layers = [*hidden, model.actor.mu]
    for i, layer in enumerate(layers):
        constants[f"w{i}"] = layer.weight.detach().numpy()
        constants[f"b{i}"] = layer.bias.detach().numpy()
        last = i == len(layers) - 1
        out = "command" if last else f"y{i}"
        gemm = [f"x{i}", f"w{i}", f"b{i}"]
        nodes.append(helper.make_node("Gemm", gemm, [out], transB=1))
        if not last:
            nodes.append(helper.make_node("Relu", [out], [f"x{i + 1}"]))
    graph = helper.make_graph(
        nodes,
        "sac",
        [helper.make_tensor_value_info("features", TensorProto.FLOAT, [1, len(FEATURES)])],
        [helper.make_tensor_value_info("command", TensorProto.FLOAT, [1, 1])],
        [numpy_helper.from_array(np.asarray(v), k) for k, v in constants.items()],
    )
    onnx.save(helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)]), file)


def judge(driver, **keywords):
    """Priority accuracy, length error, collisions and time-outs on the test encounters."""
    row = cede.evaluate(driver, split="test", mode="ego", encounters=1000, **keywords).iloc[0]
    names = ("n", "priority_accuracy", "episode_length_error", "collisions", "time_outs")
    return "  ".join(f"{name} {row[name]:.4g}" for name in names)


def mean_return(model, episodes=256):
    """Mean return of the policy's means on the test encounters, and its standard error."""
    envs = gymnasium.make_vec(ID, num_envs=64, split="test", autoreset="same-step", **TASK)
    seen, _ = envs.reset(seed=1)
    running, returns = np.zeros(64), []
    while len(returns) < episodes:
        seen, rewards, terminated, truncated, _ = envs.step(
            model.predict(seen, deterministic=True)[0]
        )
        running += rewards
        ended = terminated | truncated
        returns += running[ended].tolist()
        running[ended] = 0.0
    return f"{np.mean(returns):.2f} ± {np.std(returns) / len(returns) ** 0.5:.2f}"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--steps", type=int, default=40_000)
    parser.add_argument("--rounds", type=int, default=4)
    parser.add_argument("--seed", type=int, default=0)
    args = parser.parse_args()
    torch.set_num_threads(1)
    env = gymnasium.make(ID, **TASK)
    network = {"net_arch": [64, 64]}
    model = SAC("MlpPolicy", env, policy_kwargs=network, learning_starts=1000, seed=args.seed)
    print(f"nearer-first                {judge('nearer-first')}", flush=True)
    began = time.process_time()
    for done in range(args.rounds + 1):
        export(model, "sac.onnx")
        policy = cede.Policy.from_onnx("sac.onnx", features="route")
        taken = time.process_time() - began
        told = f"{model.num_timesteps:>7} steps {taken:>5.0f} CPU-s  return {mean_return(model)}"
        print(f"{told}  {judge(policy)}", flush=True)
        if done < args.rounds:
            model.learn(args.steps // args.rounds, reset_num_timesteps=False)
    print(f"behind the shield           {judge(policy, shield='worst-case')}")


if __name__ == "__main__":
    main()
