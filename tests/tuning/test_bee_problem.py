"""Bees on the same path as ants: problems, sessions, steered trials and observations, with three parameters or four."""

import numpy as np
import pytest
from conftest import random_scenario
from discs import scattered

from antgym.errors import ParameterError
from antgym.planners.hive import Hive
from antgym.tuning import shown_rules
from antgym.tuning.features import BEE_RULES_SHOWN, DISC_TASK_FEATURES, TASK_FEATURES
from antgym.tuning.observation import bounds, observe
from antgym.tuning.problem import TuningProblem
from antgym.tuning.run_features import RUN_FEATURES, control_table, observe_run
from antgym.tuning.session import Session, steer_together

EFFORT = {"ants": 12, "iterations": 60}
both = pytest.mark.parametrize(("rules", "dimension"), [("wu2018", 4), ("abc_standard", 3)])


def problem(rules, seed=5, **changes):
    return TuningProblem(scattered(1), rules, **{**EFFORT, **changes}, seed=seed)


@both
def test_the_space_is_that_of_the_rules_for_such_a_world_and_swarm(rules, dimension):
    few, many = problem(rules).space, problem(rules, ants=24).space
    assert few.names == ("limit", "xi_max", "xi_min", "tabu_radius")[:dimension]
    assert many.default[0] == 2 * few.default[0]


@both
def test_a_session_pays_for_bees_as_for_ants(rules, dimension):
    session, units = Session(problem(rules), 6), np.random.default_rng(0).random((4, dimension))
    told = session.evaluate(units)
    assert (session.left, len(told)) == (2, 4)
    hive = Hive(
        scattered(1), rules=rules, ants=12, iterations=60, seed=int(session.problem.seeds(0, 2, 1)[0])
    )
    hive.advance(session.problem.space.decode(units[2]), 60)
    assert (hive.best, hive.moves) == (session.lengths[2], told[2].work)


@both
def test_steered_by_one_setting_it_is_the_trial_of_that_setting(rules, dimension):
    for unit in np.random.default_rng(1).random((4, dimension)):
        plain, other = Session(problem(rules), 1), Session(problem(rules), 1)
        plain.evaluate(unit)
        trial = other.open(7)
        while not trial.over:
            steer_together([(other, unit)])
            assert trial.parameters == tuple(other.problem.space.decode(unit)[0].tolist())
        assert (other.trials[0][2:], other.lengths) == (plain.trials[0][2:], plain.lengths)


@both
def test_observations_lie_in_their_bounds(rules, dimension):
    session, units = Session(problem(rules), 3), np.random.default_rng(2).random((2, dimension))
    session.evaluate(units)
    shown, (low, high) = (
        observe(session.task, session.trials, window=4),
        bounds(dimension, window=4, features=DISC_TASK_FEATURES),
    )
    assert shown.shape == low.shape == high.shape
    assert ((low <= shown) & (shown <= high)).all()


@both
def test_a_run_is_shown_within_its_bounds_from_the_first_block_to_the_last(rules, dimension):
    for seed in range(5):
        session = Session(problem(rules, seed), 1)
        trial, table = session.open(6), control_table(True, session.problem.space.names)
        names = [f.name for f in table]
        low, high = (np.array([f[i] for f in table]) for i in (1, 2))
        seen = [observe_run(session.task, trial)]
        while not trial.over:
            steer_together([(session, np.full(dimension, 0.5))])
            seen.append(observe_run(session.task, trial))
        assert all(((low <= shown) & (shown <= high)).all() for shown in seen)
        shown = dict(zip(names, seen[-1].tolist(), strict=True))
        assert shown["done"] == 1
        assert shown["arrived"] == pytest.approx(trial.colony.result().arrived[-10:].mean() / 6)
        assert len(names) == len(DISC_TASK_FEATURES) + len(RUN_FEATURES) + dimension


def test_the_rules_can_be_read_off_the_features():
    tasks = [problem(name).task(0) for name in BEE_RULES_SHOWN]
    assert [shown_rules(task.features) for task in tasks] == list(BEE_RULES_SHOWN)
    assert len(DISC_TASK_FEATURES) != len(TASK_FEATURES), "it is by their length that tables are told apart"


@pytest.mark.parametrize(
    ("scenario", "rules", "message"),
    [
        (scattered(1), "liu2020", "'liu2020' are of ants, which walk a grid, and 'unnamed' lies among discs"),
        (
            random_scenario(0),
            "wu2018",
            "'wu2018' are of bees, which fly among discs, and 'random-0' is a grid",
        ),
        (scattered(1), "wu2019", "unknown rules 'wu2019'; did you mean 'wu2018'"),
    ],
)
def test_rules_that_are_not_for_a_world_are_refused(scenario, rules, message):
    with pytest.raises(ParameterError, match=message):
        TuningProblem(scenario, rules)


def test_three_bees_are_too_few():
    with pytest.raises(ParameterError, match="a hive has 4 bees at least"):
        problem("wu2018", ants=3)
