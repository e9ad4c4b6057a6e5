"""Sessions side by side: row by row what a session alone would tell."""

import pickle

import numpy as np
import pytest

from antgym.errors import BudgetError, ParameterError
from antgym.tuning.observation import observe
from antgym.tuning.problem import FRESH, TuningProblem
from antgym.tuning.session import Session, incumbent
from antgym.tuning.sessions import Sessions

N, BUDGET = 4, 20  # more trials than there is room for at first
ROWS, SEEDS = np.arange(N), np.arange(N) + 7


@pytest.fixture
def problem(valley):
    return TuningProblem(valley, ants=2, iterations=2)


@pytest.fixture
def sessions(problem):
    made = Sessions(N, BUDGET, 4)
    made.begin(ROWS, [problem] * N, SEEDS)
    return made


def settings(trial, few=3):
    """One of few settings for every row, so that they come again and again."""
    picks = np.random.default_rng(trial).integers(few, size=N)
    return np.random.default_rng(99).random((few, 4))[picks]


def told(session):
    return session.trials, session.lengths, session.left


def test_every_row_is_a_session_alone(sessions, problem):
    alone = [Session(problem.seeded(int(seed)), BUDGET) for seed in SEEDS]
    for trial in range(BUDGET):
        rows = ROWS[trial % 3 == 0 :]  # the first falls behind
        sessions.evaluate(rows, settings(trial)[rows])
        for i in rows:
            alone[i].evaluate(settings(trial)[i])
        assert [told(sessions.account(i)) for i in ROWS] == [told(session) for session in alone]
    assert sessions.account(0).task is alone[0].task


def test_incumbents_are_those_of_the_trials(sessions):
    for trial in range(BUDGET):
        sessions.evaluate(ROWS, settings(trial))
        for i in ROWS:
            unit, cost = incumbent(sessions.account(i).trials)
            assert (tuple(sessions.best["unit"][i].tolist()), sessions.best["cost"][i]) == (unit, cost)


def test_the_incumbent_comes_first_then_the_latest_trials_and_nothing_where_there_are_none(sessions):
    for trial in range(2):
        sessions.evaluate(ROWS[:2], settings(trial)[:2])
    history, trials = sessions.history(ROWS, 3), sessions.account(1).trials
    unit, cost = incumbent(trials)
    assert history["unit"][1].tolist() == [
        list(each) for each in (unit, trials[1].unit, trials[0].unit, [0.0] * 4)
    ]
    assert history["cost"][1].tolist() == [cost, trials[1].cost, trials[0].cost, 0.0]
    assert not history["cost"][2:].any()


def test_a_session_without_trials_left_keeps_all_from_being_charged(problem):
    sessions = Sessions(2, 1, 4)
    rows = np.arange(2)
    sessions.begin(rows, [problem] * 2, SEEDS[:2])
    sessions.evaluate(rows[:1], settings(0)[:1])
    with pytest.raises(BudgetError, match="all 1 trials are spent"):
        sessions.evaluate(rows, settings(0)[:2])
    assert sessions.left.tolist() == [0, 1]
    assert sessions.made.tolist() == [1, 0]


def test_nobody_pays_once_for_two_trials(sessions):
    with pytest.raises(ParameterError, match="each session pays for one setting"):
        sessions.evaluate(np.array([0, 2, 2]), settings(0)[:3])
    assert sessions.left.tolist() == [BUDGET] * N


def test_a_session_begun_anew_knows_nothing_of_before(sessions, problem):
    sessions.evaluate(ROWS, settings(0))
    before = sessions.account(1)
    sessions.begin(ROWS[1:2], [problem], SEEDS[:1])
    assert told(sessions.account(1)) == ((), (), BUDGET)
    assert (len(before.trials), before.left) == (1, BUDGET - 1)
    assert sessions.left.tolist() == [BUDGET - 1, BUDGET, BUDGET - 1, BUDGET - 1]
    sessions.evaluate(ROWS, settings(0))
    alone = Session(problem.seeded(int(SEEDS[0])), BUDGET)
    assert alone.evaluate(settings(0)[1]) == sessions.account(1).trials


def test_what_the_harness_runs_is_charged_to_nobody(sessions, problem):
    ran = sessions.run(ROWS, settings(0), FRESH, ROWS)
    alone = [problem.seeded(int(SEEDS[i])).run(settings(0)[i : i + 1], FRESH, i).lengths[0] for i in ROWS]
    assert ran.lengths.tolist() == alone
    assert sessions.left.tolist() == [BUDGET] * N


def test_what_is_run_for_nothing_is_still_charged(sessions, monkeypatch):
    """A planner that is cut off has been paid; nothing is recorded of it, and the next trial has its index."""

    def cut_off(*_, **__):
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr("antgym.tuning.problem.plan_many", cut_off)
        with pytest.raises(KeyboardInterrupt):
            sessions.evaluate(ROWS, settings(0))
    assert (sessions.account(0).left, sessions.account(0).trials) == (BUDGET - 1, ())
    sessions.evaluate(ROWS, settings(0))
    assert [trial.index for trial in sessions.account(0).trials] == [0]


def test_they_go_on_after_pickling(sessions):
    sessions.evaluate(ROWS, settings(0))
    again = pickle.loads(pickle.dumps(sessions))
    for each in (sessions, again):
        each.evaluate(ROWS, settings(1))
    assert [told(again.account(i)) for i in ROWS] == [told(sessions.account(i)) for i in ROWS]


def test_an_account_pays_for_nothing(sessions):
    assert not hasattr(sessions.account(0), "evaluate")
    assert observe(sessions.account(0).task, window=2)[-8:].tolist() == [0.0] * 8
