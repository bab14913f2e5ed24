"""Soft actor-critic updates a CPU-second: Cede, JAX (jitted) and PyTorch (eager), in turn and in one run.

    python3 -m venv .build/frameworks
    .build/frameworks/bin/pip install jax torch
    .build/frameworks/bin/python train/benches/beside_frameworks.py

One update: batch 512, 8 features, 2 actions, three hidden layers; labels from twin targets, both critics, the
policy through the smaller critic, the temperature, Adam, soft targets. One thread each, `f32`. What is
missing is left out.
"""

import json
import os
import resource
import statistics
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BATCH, FEATURES, ACTIONS, WIDTHS, ROUNDS, SECONDS = 512, 8, 2, (128, 256), 3, 1.0
SIDE = 768
DISCOUNT, SOFTNESS, ENTROPY = 0.99, 0.005, -2.0
RATES = {"policy": 1e-4, "critic": 1e-3, "temperature": 1e-4}
LOW, HIGH = -5.0, 2.0


def cpu_seconds():
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime


def rate(step):
    """Calls of `step` a CPU-second, after warming up."""
    start = cpu_seconds()
    while cpu_seconds() - start < 0.3:
        step()
    start, count = cpu_seconds(), 0
    while cpu_seconds() - start < SECONDS:
        for _ in range(5):
            step()
        count += 5
    return count / (cpu_seconds() - start)


def sizes(inputs, width, outputs):
    return [inputs, width, width, width, outputs]


def pytorch(width):
    import torch
    from torch import nn

    torch.set_num_threads(1)
    torch.manual_seed(0)

    def network(inputs, outputs):
        layers = []
        for i, o in zip(sizes(inputs, width, outputs), sizes(inputs, width, outputs)[1:]):
            layers += [nn.Linear(i, o), nn.ReLU()]
        return nn.Sequential(*layers[:-1])

    actor = network(FEATURES, 2 * ACTIONS)
    critics = [network(FEATURES + ACTIONS, 1) for _ in range(2)]
    targets = [network(FEATURES + ACTIONS, 1) for _ in range(2)]
    for target, critic in zip(targets, critics):
        target.load_state_dict(critic.state_dict())
    log_alpha = torch.tensor(-2.3, requires_grad=True)
    actor_adam = torch.optim.Adam(actor.parameters(), RATES["policy"])
    critic_parameters = [p for critic in critics for p in critic.parameters()]
    critic_adam = torch.optim.Adam(critic_parameters, RATES["critic"])
    alpha_adam = torch.optim.Adam([log_alpha], RATES["temperature"])
    observations, following = torch.rand(BATCH, FEATURES), torch.rand(BATCH, FEATURES)
    taken, rewards = torch.rand(BATCH, ACTIONS), torch.rand(BATCH, 1)

    def sample(seen):
        mean, raw = actor(seen).chunk(2, 1)
        log_sigma = LOW + 0.5 * (HIGH - LOW) * (torch.tanh(raw) + 1)
        noise = torch.randn_like(mean)
        u = mean + log_sigma.exp() * noise
        density = -0.5 * noise**2 - log_sigma - 0.9189385
        density = density - 2 * (0.6931472 - u - nn.functional.softplus(-2 * u))
        return torch.tanh(u), density.sum(1, keepdim=True)

    def smaller(networks, seen, actions):
        joined = torch.cat([seen, actions], 1)
        return torch.min(*(network(joined) for network in networks))

    def step():
        alpha = log_alpha.exp().detach()
        with torch.no_grad():
            actions, density = sample(following)
            label = rewards + DISCOUNT * (smaller(targets, following, actions) - alpha * density)
        joined = torch.cat([observations, taken], 1)
        loss = sum(0.5 * ((critic(joined) - label) ** 2).mean() for critic in critics)
        critic_adam.zero_grad()
        loss.backward()
        critic_adam.step()
        for p in critic_parameters:
            p.requires_grad_(False)
        actions, density = sample(observations)
        loss = (alpha * density - smaller(critics, observations, actions)).mean()
        actor_adam.zero_grad()
        loss.backward()
        actor_adam.step()
        for p in critic_parameters:
            p.requires_grad_(True)
        loss = -(log_alpha.exp() * (density.detach() + ENTROPY)).mean()
        alpha_adam.zero_grad()
        loss.backward()
        alpha_adam.step()
        with torch.no_grad():
            for target, critic in zip(targets, critics):
                ours, theirs = list(target.parameters()), list(critic.parameters())
                torch._foreach_lerp_(ours, theirs, SOFTNESS)

    return step


def pytorch_product():
    import torch

    torch.set_num_threads(1)
    a, b = torch.rand(SIDE, SIDE), torch.rand(SIDE, SIDE)
    return lambda: torch.mm(a, b)


def jax(width):
    os.environ["XLA_FLAGS"] = "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"
    import jax
    import jax.numpy as jnp

    def network(key, inputs, outputs):
        layers = []
        for i, o in zip(sizes(inputs, width, outputs), sizes(inputs, width, outputs)[1:]):
            key, one, two = jax.random.split(key, 3)
            bound = i**-0.5
            layers.append(
                (
                    jax.random.uniform(one, (i, o), minval=-bound, maxval=bound),
                    jax.random.uniform(two, (o,), minval=-bound, maxval=bound),
                )
            )
        return layers

    def run(layers, x):
        for weights, biases in layers[:-1]:
            x = jax.nn.relu(x @ weights + biases)
        weights, biases = layers[-1]
        return x @ weights + biases

    def sample(actor, seen, key):
        mean, raw = jnp.split(run(actor, seen), 2, 1)
        log_sigma = LOW + 0.5 * (HIGH - LOW) * (jnp.tanh(raw) + 1)
        noise = jax.random.normal(key, mean.shape)
        u = mean + jnp.exp(log_sigma) * noise
        density = -0.5 * noise**2 - log_sigma - 0.9189385
        density = density - 2 * (0.6931472 - u - jax.nn.softplus(-2 * u))
        return jnp.tanh(u), density.sum(1, keepdims=True)

    def smaller(critics, seen, actions):
        joined = jnp.concatenate([seen, actions], 1)
        return jnp.minimum(run(critics[0], joined), run(critics[1], joined))

    def adam(parameters, gradient, moments, t, rate):
        first = jax.tree.map(lambda m, g: m + 0.1 * (g - m), moments[0], gradient)
        second = jax.tree.map(lambda v, g: v + 0.001 * (g * g - v), moments[1], gradient)
        scale = rate * jnp.sqrt(1 - 0.999**t) / (1 - 0.9**t)
        moved = jax.tree.map(
            lambda p, m, v: p - scale * m / (jnp.sqrt(v) + 1e-8), parameters, first, second
        )
        return moved, (first, second)

    def update(state, batch):
        observations, taken, rewards, following = batch
        t = state["t"] + 1
        key, one, two = jax.random.split(state["key"], 3)
        alpha = jnp.exp(state["log_alpha"])
        actions, density = sample(state["actor"], following, one)
        value = smaller(state["targets"], following, actions) - alpha * density
        label = rewards + DISCOUNT * value

        def critic_loss(critics):
            joined = jnp.concatenate([observations, taken], 1)
            return sum(0.5 * ((run(critic, joined) - label) ** 2).mean() for critic in critics)

        gradient = jax.grad(critic_loss)(state["critics"])
        critics, critic_moments = adam(
            state["critics"], gradient, state["critic_moments"], t, RATES["critic"]
        )

        def policy_loss(actor):
            actions, density = sample(actor, observations, two)
            return (alpha * density - smaller(critics, observations, actions)).mean(), density

        gradient, density = jax.grad(policy_loss, has_aux=True)(state["actor"])
        actor, actor_moments = adam(
            state["actor"], gradient, state["actor_moments"], t, RATES["policy"]
        )
        gradient = -alpha * (density.mean() + ENTROPY)
        log_alpha, alpha_moments = adam(
            state["log_alpha"], gradient, state["alpha_moments"], t, RATES["temperature"]
        )
        targets = jax.tree.map(lambda a, b: a + SOFTNESS * (b - a), state["targets"], critics)
        return {
            "t": t,
            "key": key,
            "actor": actor,
            "critics": critics,
            "targets": targets,
            "log_alpha": log_alpha,
            "actor_moments": actor_moments,
            "critic_moments": critic_moments,
            "alpha_moments": alpha_moments,
        }

    keys = jax.random.split(jax.random.key(0), 8)
    actor = network(keys[0], FEATURES, 2 * ACTIONS)
    critics = [network(key, FEATURES + ACTIONS, 1) for key in keys[1:3]]
    still = lambda tree: (jax.tree.map(jnp.zeros_like, tree),) * 2  # noqa: E731
    log_alpha = jnp.float32(-2.3)
    state = {
        "t": jnp.float32(0),
        "key": keys[3],
        "actor": actor,
        "critics": critics,
        "targets": critics,
        "log_alpha": log_alpha,
        "actor_moments": still(actor),
        "critic_moments": still(critics),
        "alpha_moments": still(log_alpha),
    }
    columns = (FEATURES, ACTIONS, 1, FEATURES)
    batch = [jax.random.uniform(key, (BATCH, n)) for key, n in zip(keys[4:], columns)]
    compiled = jax.jit(update)
    held = [state]

    def step():
        held[0] = jax.block_until_ready(compiled(held[0], batch))

    return step


def cede():
    """Updates a CPU-second by width, and operations a second of the large product."""
    command = ["cargo", "bench", "--quiet", "-p", "cede", "-p", "cede-train", "--bench", "update", "--"]
    command += ["--warm-up-time", "0.3", "--measurement-time", str(SECONDS), "--sample-size", "10"]
    subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    target = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))

    def seconds(name):
        text = (target / "criterion" / name / "new/estimates.json").read_text()
        return json.loads(text)["median"]["point_estimate"] * 1e-9

    rates = {f"{width}": 1 / seconds(f"update/{width}") for width in WIDTHS}
    rates["product"] = 2 * SIDE**3 / seconds(f"product/{SIDE}x{SIDE}x{SIDE}")
    return rates


def measured(name):
    """What a child process prints; nothing if the framework is not installed."""
    child = subprocess.run([sys.executable, __file__, name], capture_output=True, text=True)
    return json.loads(child.stdout) if child.returncode == 0 else {}


def child(name):
    if name == "jax":
        rates = {f"{width}": rate(jax(width)) for width in WIDTHS}
    else:
        rates = {f"{width}": rate(pytorch(width)) for width in WIDTHS}
        rates["product"] = 2 * SIDE**3 * rate(pytorch_product())
    print(json.dumps(rates))


def operations(width):
    """As `train/benches/update.rs` counts them."""
    actor = FEATURES * width + 2 * width**2 + width * 2 * ACTIONS
    critic = (FEATURES + ACTIONS) * width + 2 * width**2 + width
    return 2 * BATCH * (4 * actor + 12 * critic)


def main():
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    rounds = []
    for _ in range(ROUNDS):
        rounds.append({"cede": cede(), "jax": measured("jax"), "pytorch": measured("pytorch")})

    def median(program, key):
        values = [r[program][key] for r in rounds if key in r[program]]
        return statistics.median(values) if values else None

    peak = max(r[p]["product"] for r in rounds for p in r if "product" in r[p])
    print(f"sgemm peak {peak / 1e9:.0f} GFLOP/s (largest of both libraries', {ROUNDS} rounds)")
    for width in WIDTHS:
        ours = median("cede", f"{width}")
        for program in ("cede", "jax", "pytorch"):
            updates = median(program, f"{width}")
            if updates is not None:
                ratios = [r["cede"][f"{width}"] / r[program][f"{width}"] for r in rounds]
                share = updates * operations(width) / peak
                print(
                    f"3 x {width}  {program:<8} {updates:6.1f} updates a CPU-second,"
                    f" {100 * share:3.0f} % of the peak; ours {ours / updates:.2f} times as fast"
                    f" ({min(ratios):.2f} to {max(ratios):.2f} by round)"
                )


if __name__ == "__main__":
    child(sys.argv[1]) if len(sys.argv) > 1 else main()
