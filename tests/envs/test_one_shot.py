"""OneShot: what the three rewards pay, and what a step costs."""

import gymnasium
import numpy as np
import pytest

import antgym  # noqa: F401 - registers the environments
from antgym.envs.catalogue import WORLDS
from antgym.errors import ParameterError
from antgym.maps.suites import load_suite
from antgym.tuning.problem import COST_CAP, FRESH

MODERATE = {"alpha": 1.0, "beta": 0.3, "rho": 0.9, "Q": 100.0}


def steps(count, **kwargs):
    """(environment, reward, info) after one step in each of some episodes; every other one is solved, or nearly."""
    env = gymnasium.make("antgym/MountainOneShot-v0", effort=[10, 10], **kwargs).unwrapped
    for episode in range(count):
        env.reset(seed=0 if episode == 0 else None, options={"scenario": episode % 4})
        action = env.encode(**MODERATE) if episode % 2 else np.ones(4, np.float32)
        _, reward, terminated, _, info = env.step(action)
        assert terminated
        yield env, reward, info


@pytest.fixture(scope="module", autouse=True)
def some_are_solved_and_some_are_not():
    assert {info["solved"] for _, _, info in steps(8)} == {True, False}


def test_gap_pays_minus_the_capped_gap():
    for _, reward, info in steps(8):
        gap = (info["length"] - info["optimum"]) / info["optimum"]
        assert reward == pytest.approx(-min(gap, 1.0) if info["solved"] else -1.0)
        assert reward == -info["gap"]


def test_length_pays_minus_the_length_and_its_cap_without_a_path():
    for env, reward, info in steps(8, reward="length"):
        assert reward == -info["length"]
        if not info["solved"]:
            assert reward == -COST_CAP * env.session.problem.scenario.straight_line


def test_improvement_pays_the_difference_to_the_default_on_a_fresh_run():
    for env, reward, info in steps(8, reward="improvement"):
        problem = env.session.problem
        default = problem.gap(problem.run(np.full((1, 4), 0.5), FRESH, 0).lengths)[0]
        assert reward == default - info["gap"]
        assert -1 <= reward <= 1


def test_the_reward_kind_changes_nothing_but_the_reward():
    runs = [[info for _, _, info in steps(4, reward=kind)] for kind in ("gap", "length", "improvement")]
    assert runs[0] == runs[1] == runs[2]


def test_every_planner_run_is_counted():
    for kind, each in (("gap", 1), ("length", 1), ("improvement", 2)):
        *_, (env, _, _) = steps(3, reward=kind)
        assert env.planner_runs == 3 * each


@pytest.mark.parametrize("world", WORLDS)
def test_the_map_is_flat_where_all_worlds_of_a_suite_are(world):
    worlds = {"Room", "Fleet", "Pallet", "Bee", "TabuBee"}
    env = gymnasium.make(f"antgym/{world}OneShot-v0", effort=[4, 5], observation="map").unwrapped
    shape = (3, 32, 32) if world in worlds else (3, 16, 16, 16)
    assert env.observation_space["map"].shape == shape
    assert env.reset(seed=0)[0]["map"].shape == shape
    assert load_suite(WORLDS[world], "test").flat == (world in worlds)


@pytest.mark.parametrize("name", ["budget", "window"])
def test_one_shot_takes_no_budget_and_no_window(name):
    with pytest.raises(ParameterError, match=f"unknown environment argument '{name}'"):
        gymnasium.make("antgym/MountainOneShot-v0", **{name: 5})
