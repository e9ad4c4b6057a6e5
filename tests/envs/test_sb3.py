"""The stable-baselines3 face of the native batch."""

import gymnasium
import numpy as np
import pytest

pytest.importorskip("stable_baselines3")

from antgym.envs.sb3 import make_sb3_vec
from antgym.envs.vector import env_seeds

ID, N = "antgym/MountainOneShot-v0", 3
EFFORT = {"effort": [3, 5]}


@pytest.fixture
def envs():
    return make_sb3_vec(ID, N, seed=4, **EFFORT)


def test_it_gives_what_the_native_batch_gives(envs):
    native = gymnasium.make_vec(ID, num_envs=N, **EFFORT)
    observations, _ = native.reset(seed=4)
    assert envs.reset().tolist() == observations.tolist()
    rng = np.random.default_rng(0)
    for _ in range(4):
        actions = rng.uniform(-1, 1, (N, 4)).astype(np.float32)
        theirs, ours = native.step(actions), envs.step(actions)
        assert ours[0].tolist() == theirs[0].tolist()
        assert ours[1].tolist() == theirs[1].astype(np.float32).tolist()
        assert ours[2].tolist() == theirs[2].tolist()


def test_a_finished_slot_shows_its_last_observation_and_its_own_info(envs):
    envs.reset()
    observations, rewards, ends, infos = envs.step(np.zeros((N, 4), np.float32))
    alone = gymnasium.make(ID, **EFFORT)
    last, _ = alone.reset(seed=env_seeds(4, N)[2])
    _, _, _, _, info = alone.step(np.zeros(4, np.float32))
    assert ends.all()
    assert infos[2]["terminal_observation"].tolist() == last.tolist()
    assert {k: v for k, v in infos[2].items() if k in info} == info
    assert infos[2]["TimeLimit.truncated"] is False
    assert observations[2].tolist() == alone.reset()[0].tolist()
    assert rewards.dtype == np.float32


def test_a_later_reset_goes_on_with_the_next_episodes(envs):
    first, again = envs.reset(), envs.reset()
    assert first.tolist() != again.tolist()


def test_seeding_begins_anew(envs):
    first = envs.reset()
    envs.seed(4)
    assert envs.reset().tolist() == first.tolist()


def test_info_of_each_slot_is_plain(envs):
    envs.reset()
    *_, infos = envs.step(np.zeros((N, 4), np.float32))
    for info in (*infos, *envs.reset_infos):
        assert all(type(v) in (int, float, str, bool, dict, np.ndarray) for v in info.values())
    assert {type(v) for v in infos[0]["parameters"].values()} == {float}


def test_attributes_and_methods_of_the_slots_are_reached(envs):
    envs.reset()
    assert envs.get_attr("planner_runs") == [0] * N
    envs.set_attr("planner_runs", 5, indices=[1])
    assert envs.get_attr("planner_runs", indices=[0, 1]) == [0, 5]
    values = {"alpha": 1.0, "beta": 5.0, "rho": 0.9, "Q": 100.0}
    assert [a.shape for a in envs.env_method("encode", **values)] == [(4,)] * N
    assert envs.env_is_wrapped(gymnasium.Wrapper) == [False] * N


def test_a_map_comes_beside_the_features_and_so_does_the_last_one():
    envs = make_sb3_vec(ID, N, seed=4, observation="map", **EFFORT)
    native = gymnasium.make_vec(ID, num_envs=N, observation="map", **EFFORT)
    begun, first = envs.reset(), native.reset(seed=4)[0]
    actions = np.zeros((N, 4), np.float32)
    (observations, _, _, infos), (theirs, *_) = envs.step(actions), native.step(actions)
    for name in ("features", "map"):
        assert (begun[name] == first[name]).all()
        assert (observations[name] == theirs[name]).all()
        assert (infos[1]["terminal_observation"][name] == begun[name][1]).all()
