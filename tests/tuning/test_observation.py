"""What an agent sees: bounded, in order, and nothing that depends on the optimum."""

import numpy as np
import pytest
from conftest import random_scenario
from hypothesis import given, settings
from hypothesis import strategies as st

from antgym.maps.world import Scenario
from antgym.tuning.features import TASK_FEATURES, task_features
from antgym.tuning.observation import bounds, observe
from antgym.tuning.problem import COST_CAP, TuningProblem
from antgym.tuning.session import Session, Trial

N = len(TASK_FEATURES)
A, B, C = ((x,) * 4 for x in (0.1, 0.2, 0.3))


@pytest.fixture
def task(valley):
    return TuningProblem(valley, ants=10, iterations=100).task(8)


def trials(*pairs):
    return tuple(Trial(i, unit, cost, 5) for i, (unit, cost) in enumerate(pairs))


def test_without_a_window_the_features_are_all(task):
    assert observe(task).tolist() == task.features.tolist()
    assert observe(task).dtype == np.float32


def test_observing_hands_out_no_view_of_the_task(task):
    observe(task)[:] = 7
    assert 7 not in task.features


def test_before_any_trial_the_history_is_empty(task):
    assert observe(task, window=2)[N:].tolist() == [1.0] + [0.0] * (5 + 2 * 6)


def test_history_shows_budget_incumbent_and_the_last_trials_latest_first(task):
    seen = observe(task, trials((A, 1.0), (B, 10.0), (C, 10**0.5)), window=2)[N:]
    left, incumbent, window = seen[0], seen[1:6], seen[6:].reshape(2, 6)
    assert left == 5 / 8
    assert incumbent == pytest.approx([*A, 0.0])
    assert window == pytest.approx(np.array([[*C, 0.5, 1.0], [*B, 1.0, 1.0]]))


def test_the_incumbent_is_shown_with_its_mean_cost(task):
    seen = observe(task, trials((A, 1.0), (A, 3.0), (B, 2.5)), window=1)
    assert seen[N + 1 : N + 6] == pytest.approx([*A, np.log10(2.0)])


def test_a_window_longer_than_the_history_ends_in_zeros(task):
    window = observe(task, trials((A, 2.0)), window=4)[N + 6 :].reshape(4, 6)
    assert window[0] == pytest.approx([*A, np.log10(2.0), 1.0])
    assert not window[1:].any()


@given(
    seed=st.integers(0, 30),
    window=st.integers(0, 6),
    efforts=st.tuples(st.integers(1, 10**6), st.integers(1, 10**6)),
    costs=st.lists(st.floats(0.5, COST_CAP), max_size=9),
    unit=st.tuples(*[st.floats(0, 1)] * 4),
)
@settings(max_examples=50, deadline=None)
def test_every_observation_lies_within_its_bounds(seed, window, efforts, costs, unit):
    task = TuningProblem(random_scenario(seed), ants=efforts[0], iterations=efforts[1]).task(9)
    low, high = bounds(4, window=window)
    seen = observe(task, trials(*((unit, cost) for cost in costs)), window=window)
    assert seen.shape == low.shape == high.shape
    assert ((low <= seen) & (seen <= high)).all()


def test_effort_is_among_the_features(valley):
    names = [feature.name for feature in TASK_FEATURES]
    seen = dict(zip(names, task_features(valley, ants=10, iterations=100).tolist(), strict=True))
    assert (seen["ants"], seen["iterations"]) == pytest.approx((1 / 3, 1 / 2))
    assert len(set(names)) == N


def walk(scenario):
    """Everything an agent sees of a session of six trials, as bytes."""
    session = Session(TuningProblem(scenario, ants=5, iterations=5, seed=2), 6)
    rng, seen = np.random.default_rng(0), []
    while session.left:
        seen.append(observe(session.task, session.trials, window=4).tobytes())
        seen.append(repr(session.evaluate(rng.random((2, 4)))))
    space = session.task.space
    return [*seen, observe(session.task, session.trials, window=4).tobytes(), repr(space)]


@pytest.mark.parametrize("seed", [0, 1])
def test_nothing_that_an_agent_sees_depends_on_the_optimum(monkeypatch, seed):
    honest = walk(random_scenario(seed, blocked=0.1))
    monkeypatch.setattr(Scenario, "optimum", 1.0)
    assert walk(random_scenario(seed, blocked=0.1)) == honest


def test_an_agent_can_tune_where_the_optimum_cannot_be_known(monkeypatch):
    """Nobody may even ask for it."""
    monkeypatch.setattr(
        Scenario, "optimum", property(lambda _: pytest.fail("somebody asked for the optimum"))
    )
    assert len(walk(random_scenario(0))) == 8


def test_a_task_holds_no_name_no_scenario_and_no_seed(task):
    assert set(vars(task)) == {"space", "features", "ants", "iterations", "budget"}
