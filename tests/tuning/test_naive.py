"""Naive ants show how far the heuristic leads, to everyone alike and at nobody's expense."""

import numpy as np
import pytest
from hypothesis import given, settings
from scenarios import scenarios

from antgym.maps.world import GridWorld, Scenario
from antgym.planners.planning import plan
from antgym.planners.rules import PAPERS
from antgym.planners.swarms import space_of
from antgym.tuning import Session
from antgym.tuning.features import TASK_FEATURES
from antgym.tuning.naive import NAIVE_ANTS, NAIVE_FEATURES, WEIGHTS, naive_features
from antgym.tuning.problem import TuningProblem

ARRIVE, DETOUR = slice(0, len(WEIGHTS)), slice(len(WEIGHTS), None)


def test_on_open_ground_all_arrive_and_a_stronger_heuristic_makes_shorter_ways():
    scenario = Scenario(GridWorld(np.ones((12, 12, 12), bool)), (0, 6, 6), (11, 6, 6))
    seen = naive_features(scenario, "ant_system")
    assert (seen[ARRIVE] == 1).all()
    assert (np.diff(seen[DETOUR]) < 0).all()
    assert seen[DETOUR][-1] < 0.1
    assert seen[DETOUR][0] > 0.3


def test_where_none_arrives_the_detour_is_the_longest():
    free = np.ones((12, 12, 12), bool)
    free[6] = False
    seen = naive_features(Scenario(GridWorld(free), (0, 6, 6), (11, 6, 6)), "ant_system")
    assert not seen[ARRIVE].any()
    assert (seen[DETOUR] == 1).all()


def test_they_are_what_a_first_iteration_of_the_planner_shows(valley):
    for i, weight in enumerate(WEIGHTS):
        unit = np.array([0.5, weight, 0.5, 0.5])
        values = space_of("max_min", valley, NAIVE_ANTS).decode(unit[None])[0]
        walk = plan(valley, values, rules="max_min", ants=NAIVE_ANTS, iterations=1, seed=i)
        seen = naive_features(valley, "max_min")
        assert seen[ARRIVE][i] == pytest.approx(np.log2(1 + walk.arrived[0]) / np.log2(1 + NAIVE_ANTS))


@settings(deadline=None, max_examples=20)
@given(scenario=scenarios())
def test_they_lie_in_the_unit_interval_under_every_rule_that_fits(scenario):
    for rules in ("ant_system", "zhang2011"):
        if PAPERS[rules].trap != "retreat" or not scenario.motion.layered:
            seen = naive_features(scenario, rules)
            assert ((seen >= 0) & (seen <= 1)).all()
            assert (seen == naive_features(scenario, rules)).all()


def test_every_agent_sees_the_same_and_none_pays(valley):
    problem = TuningProblem(valley, ants=10, iterations=20)
    tasks = [problem.seeded(seed).task(budget) for seed, budget in ((0, 0), (7, 20))]
    assert (tasks[0].features == tasks[1].features).all()
    first = [feature.name for feature in TASK_FEATURES].index(NAIVE_FEATURES[0].name)
    shown = tasks[0].features[first : first + len(NAIVE_FEATURES)]
    assert (shown == naive_features(valley, problem.rules).astype(np.float32)).all()
    assert Session(problem, 5).left == 5
