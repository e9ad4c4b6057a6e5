"""Environments of fleets: one setting for three robots, judged by what all of them travel and wait together."""

import gymnasium
import numpy as np
import pytest

import antgym
from antgym import SuiteItem, load_suite
from antgym.envs import fleet_pictures
from antgym.errors import ParameterError
from antgym.maps.fleet import Fleet
from antgym.planners import fleet as fleets
from antgym.planners.timed import TimedPath
from antgym.tuning import Session
from antgym.tuning.problem import TRIAL, TuningProblem, run_together
from antgym.tuning.session import evaluate_together

EFFORT = [4, 6]


def item(index=0):
    return load_suite("fleet-v0", "test")[index]


def make(regime="OneShot", **kwargs):
    return gymnasium.make(f"antgym/Fleet{regime}-v0", split="test", effort=EFFORT, **kwargs).unwrapped


def test_an_episode_is_one_house_with_three_robots_and_one_setting_for_all():
    env = make()
    env.reset(seed=0, options={"scenario": 2})
    fleet = env.session.problem.scenario
    assert isinstance(fleet, Fleet)
    assert (len(fleet.robots), env.action_space.shape) == (3, (4,))
    _, _, _, _, info = env.step(np.array([0.2, 0.1, 0.0, -0.3], np.float32))
    seed = int(env.session.problem.seeds(TRIAL, 0, 1)[0])
    plan = antgym.plan_fleet(
        fleet, tuple(info["parameters"].values()), ants=EFFORT[0], iterations=EFFORT[1], seed=seed
    )
    assert plan.solved
    assert (info["length"], info["optimum"], info["gap"]) == (plan.length, fleet.optimum, min(plan.gap, 1.0))
    assert plan.length >= fleet.optimum
    travelled = sum(path.length for path in plan.paths)
    waited = sum(pace * path.waited for pace, path in zip(fleet.paces, plan.paths, strict=True))
    assert plan.length == pytest.approx(travelled + waited)


def test_q_is_scaled_by_the_mean_straight_line_of_the_robots():
    scenario = item().scenario
    alone = TuningProblem(scenario.robots[0], "zhang2011").space.default
    together = TuningProblem(scenario, "zhang2011").space.default
    ratio = scenario.straight_line / 3 / scenario.robots[0].straight_line
    assert together == pytest.approx([*alone[:3], alone[3] * ratio])


def test_features_are_means_over_robots():
    scenario = item().scenario
    features = TuningProblem(scenario, "zhang2011").task(1).features
    each = [TuningProblem(robot, "zhang2011").task(1).features for robot in scenario.robots]
    assert features == pytest.approx(np.mean(each, axis=0), abs=1e-6)


def test_robots_of_all_slots_are_planned_in_few_calls(monkeypatch):
    calls, plan_many = [], fleets.plan_many

    def counted(scenarios, *args, **kwargs):
        calls.append(len(scenarios))
        return plan_many(scenarios, *args, **kwargs)

    monkeypatch.setattr(fleets, "plan_many", counted)
    batch = gymnasium.make_vec("antgym/FleetOneShot-v0", num_envs=8, effort=EFFORT)
    batch.reset(seed=1)
    batch.step(np.zeros((8, 4), np.float32))
    assert calls[0] == 24
    assert all(count <= 8 for count in calls[1:])  # a robot a fleet, of those that have to go round


def test_a_fleet_comes_out_the_same_alone_and_in_a_batch():
    problems = [TuningProblem(item(i).scenario, "zhang2011", *EFFORT, seed=i) for i in range(3)]
    units = np.random.default_rng(0).random((2, 4))
    together = run_together([(problem, units, TRIAL, 0) for problem in problems])
    for problem, found in zip(problems, together, strict=True):
        alone = problem.run(units, TRIAL, 0)
        assert (alone.lengths == found.lengths).all()
        assert (alone.moves == found.moves).all()
        assert (alone.seeds == found.seeds).all()


def test_fleets_and_single_robots_are_not_mixed():
    fleet = item()
    single = SuiteItem("one", fleet.scenario.robots[0], *EFFORT, "zhang2011")
    with pytest.raises(ParameterError, match=r"suite\[1\]: fleets and single robots in one environment"):
        gymnasium.make("antgym/FleetOneShot-v0", suite=[fleet, single])
    sessions = [Session(TuningProblem(one.scenario, "zhang2011", *EFFORT), 1) for one in (fleet, single)]
    with pytest.raises(ParameterError, match="fleets and single robots in one batch"):
        evaluate_together([(session, [[0.5] * 4]) for session in sessions])


def test_a_fleet_of_ones_own_makes_an_environment():
    own = SuiteItem("three", item().scenario, *EFFORT, "zhang2011")
    env = gymnasium.make("antgym/FleetOneShot-v0", suite=[own])
    env.reset(seed=0)
    assert env.step(np.zeros(4, np.float32))[4]["scenario"] == "three"


def test_no_run_of_a_fleet_is_steered():
    with pytest.raises(ParameterError, match="Control steers one run, and a fleet's robots"):
        gymnasium.make("antgym/RoomControl-v0", suite="fleet-v0")
    with pytest.raises(ParameterError, match="is a fleet, whose robots are planned one after another"):
        Session(TuningProblem(item().scenario, "zhang2011", 4, 40), 1).open(10)
    with pytest.raises(ParameterError, match="is a fleet; plan it by plan_fleet"):
        antgym.plan(item().scenario, (1.0, 2.0, 0.9, 1.0), rules="zhang2011")


def test_a_picture_is_a_strip_in_which_every_robot_goes_from_its_start_to_its_goal():
    env = make(render_mode="rgb_array")
    env.reset(seed=0, options={"scenario": 1})
    before = env.render()
    env.step(np.zeros(4, np.float32))
    after, run = env.render(), env._episodes.walked(0)
    assert before.shape == after.shape
    fleet, plan = env.session.problem.scenario, run.result()
    first, last = (fleet_pictures.frame(fleet, plan, time) for time in (0.0, plan.makespan))
    scale = first.shape[0] // fleet.world.shape[0]
    for i, robot in enumerate(fleet.robots):
        for image, cell in ((first, robot.start), (first, robot.goal), (last, robot.goal)):
            x, y, _ = (np.array(cell) * scale + scale // 2).tolist()
            assert image[x, y] == pytest.approx(fleet_pictures.COLOURS[i])


def test_a_trail_has_no_gaps_where_a_robot_waited_or_arrived_long_ago():
    path = TimedPath(np.array([[0.0, 0, 0], [3, 4, 0], [3, 4, 0], [3, 9, 0]]), np.array([0.0, 5, 50, 55]))
    for time, length in ((0.0, 0.0), (5.0, 5.0), (52.0, 7.0), (500.0, 10.0)):
        steps = np.linalg.norm(np.diff(fleet_pictures.trail(path, time, 0.1), axis=0), axis=1)
        assert steps.max(initial=0.0) <= 0.1 + 1e-9
        assert steps.sum() == pytest.approx(length)
