import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import cede
from cede import envs

ID = "cede/Encounter-v0"
FEW = {"encounters": 40}


@pytest.mark.parametrize("mode", ["joint", "left", "other"])
@pytest.mark.parametrize("reward", ["paper", "plain"])
def test_gymnasium_accepts_it(mode, reward):
    env = gymnasium.make(ID, mode=mode, reward=reward, render_mode="rgb_array", **FEW)
    check_env(env.unwrapped)


def test_stable_baselines_accepts_it():
    checker = pytest.importorskip("stable_baselines3.common.env_checker")
    for mode in ("joint", "left"):
        checker.check_env(gymnasium.make(ID, mode=mode, **FEW))


def test_an_episode_ends_and_a_time_out_is_a_truncation():
    env = gymnasium.make(ID, **FEW)
    for action, ends in (([1.0, 1.0], (True, False)), ([-1.0, -1.0], (False, True))):
        env.reset(seed=3)
        for step in range(1, 2000):  # noqa: B007
            _, _, terminated, truncated, info = env.step(np.array(action, np.float32))
            if terminated or truncated:
                break
        assert (terminated, truncated) == ends
        assert info["outcome"] in envs.OUTCOMES[1:]
        table = cede.data.encounters(env.unwrapped.dataset, "train")
        recorded = table["steps"][env.unwrapped._number].as_py()
        assert not truncated or step == 2 * recorded


def test_the_papers_return_is_that_of_the_record():
    # Replaying the recorded accelerations in ego mode earns nearly the most there is.
    env = envs.EncounterEnv(mode="left", **FEW)
    states = cede.data.states(env.dataset, "train").to_pandas()
    means = []
    for number in range(20):
        env.reset(options={"encounter": number})
        of_left = (states.encounter == number) & (states.vehicle == 0)
        accelerations = states[of_left].a.to_numpy()
        rewards = []
        for step in range(10_000):
            asked = accelerations[step] / 3 if step < len(accelerations) else 0.0
            _, reward, terminated, truncated, _ = env.step(np.array([asked], np.float32))
            rewards.append(reward)
            if terminated or truncated:
                break
        means.append(np.mean(rewards))
    assert min(means) > -0.3


def test_features_are_named_and_scaled():
    env = envs.EncounterEnv(mode="left", **FEW)
    seen, _ = env.reset(options={"encounter": 0})
    (s, v, distance), (_, _, other_distance) = env._batch.states(0)
    assert envs.FEATURES[:3] == ("ego_distance", "ego_speed", "other_distance")
    np.testing.assert_allclose(seen[:3] / envs.SCALES[:3], [distance, v, other_distance], atol=1.0)
    assert seen[1] == np.float32(v) * envs.SCALES[1]
    assert s >= 0.0


def test_what_is_drawn_changes_with_the_vehicles():
    env = gymnasium.make(ID, render_mode="rgb_array", **FEW)
    env.reset(seed=1)
    before = env.render()
    for _ in range(10):
        env.step(np.array([1.0, 1.0], np.float32))
    after = env.render()
    assert before.shape == (480, 480, 3) and before.dtype == np.uint8
    assert (before != after).any()


def drive(envs_, steps, seed=5):
    rng = np.random.default_rng(0)
    seen, _ = envs_.reset(seed=seed)
    all_ = [seen]
    for _ in range(steps):
        actions = rng.uniform(-1, 1, envs_.action_space.shape).astype(np.float32)
        all_.append(np.concatenate([np.ravel(x) for x in envs_.step(actions)[:4]]))
    return np.concatenate([np.ravel(x) for x in all_])


@pytest.mark.parametrize("autoreset", ["next-step", "same-step"])
def test_any_number_of_threads_gives_the_same_bits(autoreset):
    def run(threads):
        made = gymnasium.make_vec(ID, num_envs=301, threads=threads, autoreset=autoreset, **FEW)
        return drive(made, 120)

    one, two = run(1), run(2)
    assert (one == two).all()
    assert not (one == drive(gymnasium.make_vec(ID, num_envs=301, **FEW), 120, seed=6)).all()


def test_the_vector_environment_begins_anew_with_the_next_step():
    made = gymnasium.make_vec(ID, num_envs=64, **FEW)
    assert made.metadata["autoreset_mode"] is gymnasium.vector.AutoresetMode.NEXT_STEP
    made.reset(seed=0)
    ended = np.zeros(64, bool)
    seen_ends = 0
    for _ in range(300):
        seen, rewards, terminated, truncated, infos = made.step(made.action_space.sample())
        assert seen in made.observation_space
        assert (rewards[ended] == 0).all()
        assert not (terminated | truncated)[ended].any()
        ended = terminated | truncated
        seen_ends += ended.sum()
        if ended.any():
            assert (infos["_outcome"] == ended).all()
            assert (infos["outcome"][ended] > 0).all()
    assert seen_ends > 64


def test_the_vector_environment_begins_anew_at_once():
    made = gymnasium.make_vec(ID, num_envs=64, autoreset="same-step", **FEW)
    made.reset(seed=0)
    for _ in range(300):
        seen, _, terminated, truncated, infos = made.step(made.action_space.sample())
        ended = terminated | truncated
        if ended.any():
            assert (infos["_final_obs"] == ended).all()
            assert (infos["final_obs"][ended] != seen[ended]).any()
            assert (infos["final_info"]["outcome"][truncated] == 4).all()


def test_one_and_many_drive_alike():
    # Place 0 of a batch, driven as the single environment is.
    one = envs.EncounterEnv(mode="joint", **FEW)
    many = envs.EncounterVectorEnv(16, **FEW)
    seen, _ = many.reset(seed=9)
    number, _ = many._batch.scene(0)
    alone, _ = one.reset(options={"encounter": number})
    np.testing.assert_array_equal(alone, seen[0])
    for _ in range(30):
        actions = many.action_space.sample()
        seen, rewards, terminated, truncated, _ = many.step(actions)
        alone, reward, *ends, _ = one.step(actions[0])
        np.testing.assert_array_equal(alone, seen[0])
        assert (reward, *ends) == (rewards[0], terminated[0], truncated[0])
        if any(ends):
            break


def test_without_copies_a_step_writes_into_the_same_arrays():
    made = envs.EncounterVectorEnv(8, copy=False, **FEW)
    first, _ = made.reset(seed=0)
    second, *_ = made.step(made.action_space.sample())
    assert first is second


@pytest.mark.parametrize(
    ("keywords", "said"),
    [
        ({"mode": "both"}, "mode = `both` is none of: joint, left, other"),
        ({"reward": "score"}, "reward = `score` is none of: paper, plain"),
        ({"split": "half"}, "split = `half` is none of: train"),
        ({"encounters": 0}, r"encounters = 0 is outside \[1, 500000\]"),
        ({"data": "/none"}, "/none"),
    ],
)
def test_wrong_keywords_are_named(keywords, said):
    with pytest.raises(cede.Error, match=said):
        envs.EncounterEnv(**{**FEW, **keywords})


def test_the_number_of_actions_is_checked():
    made = envs.EncounterVectorEnv(8, **FEW)
    with pytest.raises(cede.Error, match="actions: not 8 contiguous rows"):
        made.step(np.zeros((7, 2), np.float32))
