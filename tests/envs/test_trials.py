"""Trials: a budget of paid runs, rewarded by fresh runs of the incumbent."""

import gymnasium
import numpy as np
import pytest

import antgym  # noqa: F401 - registers the environments
from antgym.errors import BudgetError
from antgym.tuning.observation import observe
from antgym.tuning.problem import FRESH
from antgym.tuning.session import incumbent


def make(**kwargs):
    return gymnasium.make("antgym/MountainTrials-v0", **{"effort": [8, 8], "budget": 6, **kwargs}).unwrapped


def episode(env, seed=0):
    """(reward, terminated, info) of every step of one episode, settings drawn at random."""
    env.reset(seed=seed, options={"scenario": seed})
    rng, out, over = np.random.default_rng(seed), [], False
    while not over:
        _, reward, over, _, info = env.step(rng.uniform([-1, -1, 0, 0], [0.5, -0.4, 1, 1]))
        out.append((reward, over, info))
    return out


@pytest.mark.parametrize("budget", [1, 2, 7])
def test_an_episode_ends_exactly_when_the_budget_is_spent(budget):
    env = make(budget=budget)
    assert [over for _, over, _ in episode(env)] == [False] * (budget - 1) + [True]
    assert env.session.left == 0


@pytest.mark.parametrize("seed", range(4))
def test_the_return_of_gap_lies_between_minus_one_and_zero(seed):
    rewards = [reward for reward, _, _ in episode(make(), seed)]
    assert -1 <= sum(rewards) <= 0
    assert all(-1 / 6 <= reward <= 0 for reward in rewards)


def test_each_step_pays_for_a_fresh_run_of_the_incumbent():
    env = make()
    steps = episode(env)
    problem, trials = env.session.problem, env.session.trials
    for i, (reward, _, info) in enumerate(steps):
        unit, _ = incumbent(trials[: i + 1])
        length = problem.run(np.array([unit]), FRESH, 2 * i).lengths
        assert reward == -problem.gap(length)[0] / 6
        assert info["gap"] == problem.gap(length)[0]
        assert info["cost"] == trials[i].cost


def test_the_reward_is_not_the_trials_own():
    """A lucky trial must not pay: the noise the agent selects on is not the noise that judges it."""
    env = make(budget=12)
    shown = [
        (info["length"] / env.session.problem.scenario.straight_line, info["cost"])
        for _, _, info in episode(env)
    ]
    assert any(own != paid for own, paid in shown)


def test_fresh_runs_share_no_seed_with_trials_or_with_each_other():
    env = make(reward="improvement")
    episode(env)
    problem = env.session.problem
    trials, fresh = problem.seeds(0, 0, 6).tolist(), problem.seeds(FRESH, 0, 12).tolist()
    assert len({*trials, *fresh}) == 18


def test_improvement_draws_the_default_anew_each_step():
    env = make(reward="improvement")
    for i, (reward, _, info) in enumerate(episode(env)):
        problem = env.session.problem
        default = problem.gap(problem.run(np.full((1, 4), 0.5), FRESH, 2 * i + 1).lengths)[0]
        assert reward == (default - info["gap"]) / 6


def test_every_planner_run_is_counted():
    for kind, each in (("gap", 2), ("length", 2), ("improvement", 3)):
        env = make(reward=kind)
        episode(env)
        assert env.planner_runs == 6 * each


def test_the_observation_is_that_of_the_sessions_trials():
    """One function for environments and policies."""
    env = make(window=3)
    env.reset(seed=1)
    for _ in range(3):
        seen = env.step(env.action_space.sample())[0]
        assert seen.tolist() == observe(env.session.task, env.session.trials, window=3).tolist()


def test_proposing_a_setting_again_measures_it_again():
    """The way to re-evaluate: other ants walk, and the incumbent's cost is the mean of all measurements."""
    env = make(budget=8)
    env.reset(seed=3)
    action = env.encode(alpha=1.0, beta=0.3, rho=0.9, Q=100.0)
    costs = [env.step(action)[4]["cost"] for _ in range(8)]
    assert len({trial.unit for trial in env.session.trials}) == 1
    assert len(set(costs)) > 1
    assert incumbent(env.session.trials)[1] == pytest.approx(np.mean(costs))


def test_what_is_shown_of_the_incumbent_can_be_measured_again():
    """A policy sees float32 settings: proposed again, they are the settings that were paid for."""
    env, again = make(budget=2, window=1), 0
    rng = np.random.default_rng(1)
    for seed in range(30):
        env.reset(seed=seed)
        shown = env.step(rng.uniform(-1, 1, 4).astype(np.float32))[0]
        latest = shown[-6:-2]
        env.step(2 * latest - 1)
        again += len({trial.unit for trial in env.session.trials}) == 1
    assert again == 30


@pytest.mark.parametrize("name", ["budget", "window"])
@pytest.mark.parametrize("value", [0, -1, 2.5, float("nan"), "3", None])
def test_an_episode_without_trials_is_refused(name, value):
    with pytest.raises(BudgetError, match=f"{name} = "):
        make(**{name: value})
