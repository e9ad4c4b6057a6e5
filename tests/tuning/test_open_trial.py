"""Trials under way: paid when they are opened, steered in blocks, and an ordinary trial in the end."""

import pickle

import numpy as np
import pytest
from conftest import random_grid, random_scenario

from antgym.errors import BudgetError, LedgerError, ParameterError
from antgym.maps.motion import Motion
from antgym.tuning.ledger import Ledger
from antgym.tuning.problem import TRIAL, TuningProblem
from antgym.tuning.run_features import CONTROL_FEATURES, observe_run
from antgym.tuning.session import Session, steer_together

DEFAULT = (0.5,) * 4


@pytest.fixture
def problem(valley):
    return TuningProblem(valley, ants=3, iterations=11, seed=5)


def settings(count, seed=0):
    return np.random.default_rng(seed).random((count, 4))


def steered(session, units):
    """Open a trial and steer it to its end."""
    trial = session.open(len(units))
    for unit in units:
        steer_together([(session, unit)])
    return trial


def test_a_trial_is_charged_when_it_is_opened_and_entered_when_it_is_over(problem):
    session = Session(problem, 2)
    trial = session.open(3)
    assert (session.left, session.trials, session.opened) == (1, (), trial)
    for block in range(3):
        assert not trial.over
        assert session.trials == ()
        assert steer_together([(session, settings(3)[block])]) == [trial]
    assert trial.over
    assert (session.left, len(session.trials), len(session.lengths)) == (1, 1, 1)


def test_steered_by_one_setting_it_is_the_trial_of_that_setting(problem):
    plain, other = Session(problem, 3), Session(problem, 3)
    unit = settings(1)[0]
    plain.evaluate([unit] * 3)
    for _ in range(3):
        steered(other, [unit] * 4)
    assert [trial[2:] for trial in other.trials] == [trial[2:] for trial in plain.trials]
    assert other.lengths == plain.lengths


@pytest.mark.parametrize("rules", ["max_min", "ant_colony_system", "zhang_apf", "zhang2011", "wei2018"])
@pytest.mark.parametrize("motion", [Motion(), Motion("grid8")], ids=lambda motion: motion.name)
def test_so_it_is_under_any_rules_and_motion(rules, motion):
    scenario = random_scenario(3, blocked=0.1) if motion.layered else random_grid(1, motion, 8, 0.2)
    problem = TuningProblem(scenario, rules, 5, 13, seed=2)
    for unit in settings(3):
        plain, other = Session(problem, 1), Session(problem, 1)
        plain.evaluate(unit)
        steered(other, [unit] * 5)
        assert (other.trials[0][2:], other.lengths) == (plain.trials[0][2:], plain.lengths)


def test_it_keeps_the_settings_of_all_its_blocks_in_order(problem):
    session, units = Session(problem, 1), settings(5)
    steered(session, units)
    assert session.trials[0].unit == tuple(units.ravel().tolist())
    assert {type(value) for value in session.trials[0].unit} == {float}


def test_runs_steered_together_are_those_steered_alone(problem, monkeypatch):
    units = settings(12).reshape(3, 4, 4)
    alone = [Session(problem, 1) for _ in units]
    for session, mine in zip(alone, units, strict=True):
        steered(session, mine)
    for threads in "12":
        monkeypatch.setenv("ANTGYM_THREADS", threads)
        together = [Session(problem, 1) for _ in units]
        for session in together:
            session.open(4)
        for block in range(4):
            steer_together([(s, unit) for s, unit in zip(together, units[:, block], strict=True)])
        assert [s.trials for s in together] == [s.trials for s in alone]


def test_nothing_else_can_be_paid_for_while_a_trial_is_under_way(problem):
    session = Session(problem, 3)
    session.open(2)
    for attempt in (lambda: session.evaluate(DEFAULT), lambda: session.open(2)):
        with pytest.raises(ParameterError, match="a trial is under way; steer it to its end"):
            attempt()
    assert session.left == 2
    for _ in range(2):
        steer_together([(session, DEFAULT)])
    session.evaluate(DEFAULT)
    assert [trial.index for trial in session.trials] == [0, 1]


def test_a_spent_session_opens_nothing(problem):
    session = Session(problem, 1)
    session.evaluate(DEFAULT)
    with pytest.raises(BudgetError, match="all 1 trials are spent"):
        session.open(2)


@pytest.mark.parametrize("blocks", [0, -1, 12, 2.0, None])
def test_blocks_that_cannot_be_walked_are_refused_and_cost_nothing(problem, blocks):
    session = Session(problem, 1)
    with pytest.raises(ParameterError, match=f"blocks = {blocks}: a run of 11 iterations"):
        session.open(blocks)
    assert (session.left, session.opened) == (1, None)


def test_a_trial_that_is_over_cannot_be_steered_on(problem):
    session = Session(problem, 2)
    steered(session, [DEFAULT])
    with pytest.raises(ParameterError, match=r"no trial is under way; open\(\) one"):
        steer_together([(session, DEFAULT)])


@pytest.mark.parametrize("bad", [[1.5] * 4, [0.5] * 3, [DEFAULT] * 2, [float("nan")] * 4])
def test_one_setting_that_cannot_be_used_walks_nobody(problem, bad):
    good, other = Session(problem, 1), Session(problem, 1)
    good.open(2)
    other.open(2)
    with pytest.raises(ParameterError):
        steer_together([(good, DEFAULT), (other, bad)])
    assert (good.opened.units, other.opened.units) == ((), ())


def test_a_session_may_not_be_steered_twice_at_once(problem):
    session = Session(problem, 1)
    session.open(2)
    with pytest.raises(ParameterError, match="appears twice"):
        steer_together([(session, DEFAULT), (session, DEFAULT)])
    assert session.opened.units == ()


def test_steering_nobody_is_nothing():
    assert steer_together([]) == []


def test_a_ledger_keeps_the_settings_and_a_resumed_run_must_come_to_the_same(problem, tmp_path):
    units = settings(4)
    with Ledger(tmp_path, {}, {}) as ledger:
        first = Session(problem, 2, ledger.run("a"))
        steered(first, units)
        first.evaluate(DEFAULT)
    with Ledger(tmp_path, {}, {}) as ledger:
        again = Session(problem, 2, ledger.run("a"))
        steered(again, units)
        again.evaluate(DEFAULT)
        assert again.trials == first.trials
        assert len(ledger.run("a").records) == 2
        assert ledger.run("a").records[0].seed == int(problem.seeds(TRIAL, 0, 1)[0])


def test_a_run_steered_otherwise_does_not_fit_the_ledger(problem, tmp_path):
    with Ledger(tmp_path, {}, {}) as ledger:
        steered(Session(problem, 1, ledger.run("a")), settings(4))
        with pytest.raises(LedgerError, match=r"trial 0: the ledger .* holds the setting"):
            steered(Session(problem, 1, ledger.run("a")), settings(4, 1))


def test_a_planner_that_walks_otherwise_than_recorded_stops_the_run(problem, tmp_path):
    with Ledger(tmp_path, {}, {}) as ledger:
        steered(Session(problem, 1, ledger.run("a")), settings(4))
        run = ledger.run("a")
        run.records[0] = run.records[0]._replace(length=1.0)
        with pytest.raises(LedgerError, match="steered again, trial 0 comes to"):
            steered(Session(problem, 1, run), settings(4))


def test_a_session_pickled_on_the_way_goes_on(problem):
    session, units = Session(problem, 1), settings(4)
    session.open(4)
    steer_together([(session, units[0])])
    copy = pickle.loads(pickle.dumps(session))
    for unit in units[1:]:
        steer_together([(session, unit), (copy, unit)])
    assert copy.trials == session.trials


def test_an_observation_lies_within_its_bounds_at_every_block(problem):
    session = Session(problem, 1)
    trial = session.open(11)
    low, high = (np.array([feature[i] for feature in CONTROL_FEATURES], np.float32) for i in (1, 2))
    for unit in [None, *settings(11)]:
        if unit is not None:
            steer_together([(session, unit)])
        seen = observe_run(session.task, trial)
        assert (seen.dtype, seen.shape) == (np.float32, low.shape)
        assert ((low <= seen) & (seen <= high)).all()
