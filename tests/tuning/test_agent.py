"""The loops that run agents: one alone, and many in lock-step, which comes to the same."""

import numpy as np
import pytest
from conftest import random_scenario

from antgym.errors import ParameterError
from antgym.tuning import problem as problems
from antgym.tuning.agent import tune, tune_together
from antgym.tuning.problem import TuningProblem
from antgym.tuning.session import Session


class Wanderer:
    """Asks for batches of one size around the best setting so far, and stops after so many rounds."""

    def __init__(self, size, rounds):
        self.size, self.rounds = size, rounds

    def reset(self, task, *, seed):
        self.rng, self.best, self.asked = (
            np.random.default_rng(seed),
            (np.inf, np.full(len(task.space), 0.5)),
            0,
        )

    def ask(self):
        self.asked += 1
        count = self.size if self.asked <= self.rounds else 0
        return np.clip(self.best[1] + self.rng.normal(0, 0.2, (count, 4)), 0, 1)

    def tell(self, trials):
        for trial in trials:
            self.best = min(self.best, (trial.cost, np.array(trial.unit)), key=lambda pair: pair[0])

    def recommend(self):
        return self.best[1]


def _runs():
    sizes = [(1, 9), (3, 2), (5, 9), (2, 0), (4, 1)]
    return [
        (Wanderer(*size), Session(TuningProblem(random_scenario(i, blocked=0.1), ants=3, iterations=4), 8), i)
        for i, size in enumerate(sizes)
    ]


def test_lock_step_comes_to_what_one_by_one_comes_to():
    together = tune_together(_runs())
    alone = [tune(agent, session, seed=seed) for agent, session, seed in _runs()]
    assert [len(result.trials) for result in together] == [8, 6, 8, 0, 4]
    for result, own in zip(together, alone, strict=True):
        assert result.trials == own.trials
        assert result.recommendation.tolist() == own.recommendation.tolist()


def test_a_round_is_one_planner_call(monkeypatch):
    calls, plan_many = [], problems.plan_many

    def counted(scenarios, *args, **kwargs):
        calls.append(len(scenarios))
        return plan_many(scenarios, *args, **kwargs)

    monkeypatch.setattr(problems, "plan_many", counted)
    tune_together(_runs())
    assert calls == [1 + 3 + 5 + 4, 1 + 3 + 3, *[1] * 6]


def test_nobody_is_charged_where_an_agent_or_a_session_appears_twice():
    (agent, session, seed), (other, another, _), *_ = _runs()
    with pytest.raises(ParameterError, match="an agent appears twice"):
        tune_together([(agent, session, seed), (agent, another, 1)])
    with pytest.raises(ParameterError, match="a session appears twice"):
        tune_together([(agent, session, 0), (other, session, 1)])
    assert session.left == another.left == 8


def test_no_run_is_no_result():
    assert tune_together([]) == []


class Answers:
    """An agent in the harness's own process that answers the same whatever happens."""

    def __init__(self, asks=(0.5,) * 4, recommends=(0.5,) * 4, on_tell=lambda task, trials: None):
        self.asks, self.recommends, self.on_tell = np.array(asks), recommends, on_tell

    def reset(self, task, *, seed):
        self.task = task

    def ask(self):
        return self.asks

    def tell(self, trials):
        self.on_tell(self.task, trials)

    def recommend(self):
        return self.recommends


def cheapen(task, trials):
    trials[0].cost = 0.0


def redescribe(task, trials):
    task.features[0] = 0.0


def grant(task, trials):
    task.budget = 1000


def peek(task, trials):
    return trials[0].seed


@pytest.mark.parametrize(
    ("adversary", "error", "message"),
    [
        (Answers(asks=[[np.nan] * 4]), ParameterError, "alpha = nan lies outside"),
        (Answers(asks=[[0.5] * 3]), ParameterError, r"shape \(k, 4\).* got \(1, 3\)"),
        (Answers(asks=[[0.5, 2.0, 0.5, 0.5]]), ParameterError, "beta = 2.0 lies outside"),
        (Answers(recommends=[np.inf] * 4), ParameterError, "alpha = inf lies outside"),
        (Answers(recommends=[0.5] * 5), ParameterError, r"got \(1, 5\)"),
        (Answers(on_tell=cheapen), AttributeError, "can't set attribute"),
        (Answers(on_tell=redescribe), ValueError, "read-only"),
        (Answers(on_tell=grant), AttributeError, "cannot assign to field 'budget'"),
        (Answers(on_tell=peek), AttributeError, "has no attribute 'seed'"),
    ],
)
def test_what_an_agent_may_not_do_has_a_message_of_its_own(adversary, error, message):
    session = Session(TuningProblem(random_scenario(0, blocked=0.1), ants=3, iterations=4), 8)
    with pytest.raises(error, match=message):
        tune(adversary, session, seed=0)


def test_who_asks_for_more_than_is_left_gets_what_is_left():
    session = Session(TuningProblem(random_scenario(0, blocked=0.1), ants=3, iterations=4), 8)
    tune(Answers(asks=np.full((1000, 4), 0.5)), session, seed=0)
    assert (len(session.trials), session.left) == (8, 0)
