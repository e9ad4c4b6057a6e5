"""Environments over a folder of map files."""

import gymnasium
import numpy as np
import pytest

import antgym
from antgym.envs.checking import check_vector_env
from antgym.errors import ParameterError
from antgym.maps.world import GridWorld

UNIT = (1.0, 1.0, 1.0)


@pytest.fixture
def folder(tmp_path):
    for seed in range(2):
        free = np.random.default_rng(seed).random((10, 12)) > 0.2
        antgym.write_map(tmp_path / f"floor-{seed}.map", GridWorld(free, UNIT))
    (tmp_path / "suite.toml").write_text(
        'rules = ["ant_colony_system", "wei2018"]\nants = 4\niterations = 10\n'
    )
    return tmp_path


@pytest.mark.parametrize("regime", ["OneShot", "Trials", "Control"])
def test_open_takes_the_path_of_a_folder(folder, regime):
    env = gymnasium.make(f"antgym/Open{regime}-v0", suite=str(folder), observation="map")
    _, info = env.reset(seed=1)
    assert info["scenario"].startswith("floor-")
    assert info["ants"] == 4
    assert env.observation_space["map"].shape == (3, 32, 32)
    assert env.step(env.action_space.sample())[4]["gap"] >= 0


def test_a_batch_repeats_single_environments(folder):
    check_vector_env("antgym/OpenOneShot-v0", steps=6, suite=str(folder))


def test_a_spec_with_a_folder_is_json(folder):
    env = gymnasium.make("antgym/OpenTrials-v0", suite=str(folder))
    again = gymnasium.envs.registration.EnvSpec.from_json(env.spec.to_json())
    assert gymnasium.make(again).reset(seed=2)[1] == env.reset(seed=2)[1]


def test_a_folder_that_is_not_there_is_told_from_a_suite_that_is_not(folder):
    with pytest.raises(ParameterError, match=r"no such folder \(looked in"):
        gymnasium.make("antgym/OpenTrials-v0", suite=str(folder / "gone"))
    with pytest.raises(ParameterError, match="unknown suite 'open-v1', nor is it a folder"):
        gymnasium.make("antgym/OpenTrials-v0", suite="open-v1")


def test_unknown_rules_of_a_folder_are_named(folder):
    (folder / "suite.toml").write_text('rules = ["ant_system2"]\n')
    with pytest.raises(ParameterError, match=r"suite\.toml: rules of .*: .*did you mean 'ant_system'"):
        gymnasium.make("antgym/OpenTrials-v0", suite=str(folder))
