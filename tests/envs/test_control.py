"""Control: one run steered in ten blocks, that a constant action makes OneShot's."""

import pickle
from itertools import pairwise

import gymnasium
import numpy as np
import pytest

import antgym  # noqa: F401 - registers the environments
from antgym.envs.control import BLOCKS
from antgym.errors import ParameterError
from antgym.maps.suites import load_suite
from antgym.maps.world import Scenario
from antgym.planners.colony import Colony
from antgym.tuning.problem import COST_CAP, FRESH
from antgym.tuning.run_features import CONTROL_FEATURES, RUN_FEATURES

MODERATE = {"alpha": 1.0, "beta": 0.3, "rho": 0.9, "Q": 100.0}
GREEDY = np.ones(4, np.float32)  # most ants walk into a mountain and die
NAMES = [feature.name for feature in CONTROL_FEATURES]
RUN = slice(len(NAMES) - 4 - len(RUN_FEATURES), len(NAMES) - 4)


def make(regime="Control", **kwargs):
    return gymnasium.make(f"antgym/Mountain{regime}-v0", **{"effort": [6, 47], **kwargs}).unwrapped


def steered(env, actions, seed=0, scenario=None):
    """(observation, reward, terminated, info) of reset and of every step of an episode."""
    options = None if scenario is None else {"scenario": scenario}
    observation, info = env.reset(seed=seed, options=options)
    seen = [(observation, 0.0, False, info)]
    for action in actions:
        observation, reward, over, truncated, info = env.step(action)
        assert not truncated
        seen.append((observation, reward, over, info))
    return seen


def at_random(seed, count=BLOCKS):
    return (
        np.random.default_rng(seed).uniform([-1, -1, 0, 0], [0.5, -0.4, 1, 1], (count, 4)).astype(np.float32)
    )


@pytest.mark.parametrize("reward", ["gap", "length", "improvement"])
@pytest.mark.parametrize("seed", range(6))
def test_a_constant_action_gives_one_shots_path_and_its_reward(reward, seed):
    env, one_shot = make(reward=reward), make("OneShot", reward=reward)
    one_shot.reset(seed=seed)
    action = [one_shot.encode(**MODERATE), at_random(seed, 1)[0], GREEDY][seed % 3]
    _, whole, _, _, expected = one_shot.step(action)
    steps = steered(env, [action] * BLOCKS, seed)
    assert sum(reward for _, reward, _, _ in steps) == pytest.approx(whole, abs=1e-6)
    assert {key: steps[-1][3][key] for key in expected} == expected
    path = one_shot.session.problem.run(np.array([one_shot.session.trials[0].unit]), 0, 0).plan(0).path
    assert env.trial.colony.result().path.tolist() == path.tolist()
    assert env.session.trials[0][2:] == one_shot.session.trials[0][2:]


def test_some_of_those_runs_are_solved_and_some_are_not():
    ends = [steered(make(), [action] * BLOCKS, 2)[-1][3]["solved"] for action in (at_random(0, 1)[0], GREEDY)]
    assert ends == [True, False]


@pytest.mark.parametrize("reward", ["gap", "length", "improvement"])
def test_rewards_add_up_to_what_the_last_length_is_worth(reward):
    for seed in range(4):
        env = make(reward=reward)
        *_, (_, _, over, info) = steps = steered(env, at_random(seed), seed)
        problem = env.session.problem
        worth = {"gap": -info["gap"], "length": -info["length"], "improvement": -info["gap"]}[reward]
        if reward == "improvement":
            worth += problem.gap(problem.run(np.full((1, 4), 0.5), FRESH, 0).lengths)[0]
        assert over
        assert sum(reward for _, reward, _, _ in steps) == pytest.approx(worth, abs=1e-6)


def test_each_step_but_the_first_pays_what_the_path_gained():
    rewards = [reward for _, reward, _, _ in steered(make(), at_random(3), 3)[1:]]
    assert -1 <= rewards[0] <= 0
    assert all(0 <= reward <= 1 for reward in rewards[1:])


def test_a_run_without_a_path_pays_the_cap_at_once():
    env = make(reward="length")
    cap = COST_CAP * load_suite("mountain-v0", "train")[0].scenario.straight_line
    rewards = [r for _, r, _, _ in steered(env, [GREEDY] * BLOCKS, scenario=0)[1:]]
    assert rewards == [-cap] + [0.0] * (BLOCKS - 1)


@pytest.mark.parametrize("iterations", [40, 47, 59, 100])
def test_blocks_are_of_one_size_up_to_one_and_add_up(iterations):
    env = make(effort=[2, iterations])
    sizes, walked = [], 0
    env.reset(seed=0)
    for _ in range(BLOCKS):
        env.step(np.zeros(4, np.float32))
        sizes.append(env.trial.colony.done - walked)
        walked = env.trial.colony.done
    assert walked == iterations
    assert max(sizes) - min(sizes) <= 1


def test_an_episode_is_ten_blocks_counted_in_info():
    steps = steered(make(), at_random(0))[1:]
    assert [info["block"] for *_, info in steps] == list(range(1, BLOCKS + 1))
    assert [over for _, _, over, _ in steps] == [False] * (BLOCKS - 1) + [True]
    assert all(a["length"] >= b["length"] for (*_, a), (*_, b) in pairwise(steps))


def test_a_scenario_with_few_iterations_is_given_forty():
    suite = load_suite("mountain-v0", "train")
    env = gymnasium.make("antgym/MountainControl-v0")
    for i in range(12):
        assert env.reset(seed=0, options={"scenario": i})[1]["iterations"] == max(40, suite[i].iterations)


def test_fewer_than_forty_iterations_are_refused():
    with pytest.raises(ParameterError, match=r"effort = \[6, 39\]: .* at least 40 iterations"):
        make(effort=[6, 39])


def test_a_change_of_the_action_changes_the_run_from_there_on():
    actions, changed = at_random(1), at_random(1)
    changed[5] = [0.9, -0.9, -0.9, -0.9]
    one, other = steered(make(), actions, 1), steered(make(), changed, 1)
    assert [step[0].tolist() for step in one[:6]] == [step[0].tolist() for step in other[:6]]
    assert one[6][0].tolist() != other[6][0].tolist()


def test_the_setting_of_the_last_block_is_shown_half_before_any():
    env, actions = make(), at_random(2)
    steps = steered(env, actions, 2)
    assert steps[0][0][-4:].tolist() == [0.5] * 4
    for (observation, *_), action in zip(steps[1:], actions, strict=True):
        assert observation[-4:] == pytest.approx((action + 1) / 2)


def test_the_run_is_shown_as_what_it_has_come_to():
    env = make(effort=[6, 50])
    for scenario in range(4):
        steps = steered(env, [env_action(env, scenario)] * BLOCKS, 5, scenario)
        seen = [dict(zip(NAMES[RUN], step[0][RUN].tolist(), strict=True)) for step in steps]
        lengths = [info["length"] if info["solved"] else np.inf for *_, info in steps[1:]]
        plan, straight = env.trial.colony.result(), env.session.problem.scenario.straight_line
        first = next((length for length in lengths if length < np.inf), np.inf)
        assert seen[0] == {**dict.fromkeys(NAMES[RUN], 0.0), **dict.fromkeys(AT_FIRST_ONE, 1.0)}
        for block, (shown, length) in enumerate(zip(seen[1:], lengths, strict=True), start=1):
            arrived = plan.arrived[5 * (block - 1) : 5 * block]
            assert shown["done"] == pytest.approx(block / 10)
            assert shown["arrived"] == pytest.approx(arrived.sum() / 30)
            solved = length < np.inf
            assert shown["cost"] == pytest.approx(np.log10(length / straight) if solved else 1.0)
            assert shown["progress"] == pytest.approx(length / first if solved else 1.0)
            mean = plan.mean[5 * block - 1]
            assert shown["spread"] == pytest.approx(min(mean / length - 1, 1) if mean < np.inf else 1.0)


AT_FIRST_ONE = ("cost", "progress", "spread", "branching", "distinct")


def env_action(env, scenario):
    env.reset(seed=5, options={"scenario": scenario})
    return env.encode(**MODERATE)


@pytest.mark.parametrize("seed", range(3))
def test_nothing_that_is_seen_depends_on_the_optimum(monkeypatch, seed):
    honest = [step[0].tolist() for step in steered(make(), at_random(seed), seed)]
    monkeypatch.setattr(Scenario, "optimum", 1.0)
    assert [step[0].tolist() for step in steered(make(), at_random(seed), seed)] == honest


def test_an_episode_is_one_paid_trial_and_one_planner_run():
    env = make()
    steered(env, at_random(0))
    assert (env.planner_runs, env.session.left, len(env.session.trials)) == (1, 0, 1)
    (trial,) = env.session.trials
    assert trial.unit == pytest.approx(((at_random(0) + 1) / 2).ravel(), abs=2**-24)  # the grid of settings
    env.reset()
    assert env.planner_runs == 1
    env.step(np.zeros(4, np.float32))
    assert env.planner_runs == 2


def test_improvement_pays_for_one_more_run():
    env = make(reward="improvement")
    steered(env, at_random(0))
    assert env.planner_runs == 2


@pytest.mark.parametrize("walked", [0, 1, 4, BLOCKS])
def test_an_environment_pickled_on_the_way_goes_on_like_the_original(walked):
    env, actions = make(), at_random(7)
    steered(env, actions[:walked], 7)
    copy = pickle.loads(pickle.dumps(env))
    for action in actions[walked:]:
        mine, theirs = env.step(action), copy.step(action)
        assert mine[0].tolist() == theirs[0].tolist()
        assert mine[1:] == theirs[1:]
    assert env.reset()[0].tolist() == copy.reset()[0].tolist()


def test_the_next_episode_walks_in_the_memory_of_the_last(monkeypatch):
    env = make()
    env.reset(seed=0)
    made = []
    monkeypatch.setattr("antgym.planners.colony.new_buffers", lambda runs: made.append(1))
    for _ in range(3):
        env.reset()
        env.step(np.zeros(4, np.float32))
    assert not made


def test_what_was_walked_before_leaves_no_trace():
    env, fresh = make(), make()
    for seed in range(3):
        steered(env, at_random(seed, 4), seed)
    mine, alone = steered(env, at_random(9), 9), steered(fresh, at_random(9), 9)
    assert [step[0].tolist() for step in mine] == [step[0].tolist() for step in alone]


@pytest.mark.parametrize("mode", ["ansi", "rgb_array"])
def test_a_run_is_drawn_as_far_as_it_has_come_and_nothing_is_walked_for_it(monkeypatch, mode):
    env = make(render_mode=mode)
    env.reset(seed=0, options={"scenario": 1})
    pictures, action = [env.render()], env.encode(**MODERATE)
    monkeypatch.setattr(Colony, "__init__", lambda *_, **__: pytest.fail("a colony was made"))
    for factor in (1.0, 0.9):
        env.step(action * np.float32(factor))
        pictures.append(env.render())
    assert not np.array_equal(pictures[0], pictures[1])
    assert not np.array_equal(pictures[1], pictures[2])


@pytest.mark.parametrize("name", ["budget", "window", "blocks"])
def test_control_takes_no_budget_no_window_and_no_other_number_of_blocks(name):
    with pytest.raises(ParameterError, match=f"unknown environment argument '{name}'"):
        make(**{name: 5})
