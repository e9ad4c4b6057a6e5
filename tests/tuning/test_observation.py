"""What an agent sees: bounded, in order, and nothing that depends on the optimum."""

import pickle
from dataclasses import replace

import numpy as np
import pytest
from conftest import random_scenario
from hypothesis import given, settings
from hypothesis import strategies as st
from scenarios import scenarios

from antgym.errors import ParameterError
from antgym.maps.occupancy import occupancy
from antgym.maps.world import Scenario
from antgym.planners.rules import PAPERS, Rules
from antgym.tuning.features import RULES_SHOWN, TASK_FEATURES, shown_rules, task_features
from antgym.tuning.observation import bounds, observe, observe_with_map
from antgym.tuning.problem import COST_CAP, Task, TuningProblem
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


def test_the_features_show_the_rules_by_one_of_their_places(valley):
    first = len(TASK_FEATURES) - len(RULES_SHOWN)
    for place, name in enumerate(RULES_SHOWN):
        seen = TuningProblem(valley, name, ants=10, iterations=100).task(0).features[first:]
        assert np.flatnonzero(seen).tolist() == [place]
        assert seen[place] == 1


def test_rules_of_ones_own_are_none_of_the_published(valley):
    assert not task_features(valley, 10, 100, Rules(q0=0.5))[-len(RULES_SHOWN) :].any()


def test_the_rules_can_be_read_off_the_features(valley):
    seen = [TuningProblem(valley, name, ants=10, iterations=100).task(0).features for name in RULES_SHOWN]
    assert [shown_rules(features) for features in seen] == list(RULES_SHOWN)
    assert shown_rules(task_features(valley, 10, 100, Rules(q0=0.5))) is None


def test_the_order_of_the_rules_is_what_policies_have_learnt():
    """New rules are appended; whoever moves one changes what every trained policy sees."""
    assert RULES_SHOWN[:7] == tuple(PAPERS)[:7]
    assert RULES_SHOWN[7:13] == (
        "zhang_apf",
        "zhang_apf-original",
        "zhang2011",
        "zhang2011-basic",
        "wei2018",
        "wei2018-basic",
    )
    assert set(RULES_SHOWN) == set(PAPERS)


def walk(scenario):
    """Everything an agent sees of a session of six trials, as bytes."""
    session = Session(TuningProblem(scenario, ants=5, iterations=5, seed=2), 6)
    rng, seen = np.random.default_rng(0), []
    while session.left:
        seen.append(observe(session.task, session.trials, window=4).tobytes())
        seen += [session.task.map(flat).tobytes() for flat in (None, True, False)]
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
    assert len(walk(random_scenario(0))) == 17


def test_a_task_holds_no_name_no_scenario_and_no_seed(task):
    assert set(vars(task)) == {"space", "features", "ants", "iterations", "budget", "map"}


def test_nothing_that_a_task_holds_leads_to_its_scenario(valley):
    """Its map is drawn when it is asked for, from cells alone."""
    named = replace(valley, name="a-telling-name")
    _ = named.optimum
    task = TuningProblem(named, seed=918_273_645).task(8)
    task.map()
    kept = pickle.dumps(task)
    assert not any(word in kept for word in (b"a-telling-name", b"Scenario", b"optimum"))
    assert (918_273_645).to_bytes(4, "little") not in kept
    assert "map" not in repr(task)


@settings(deadline=None, max_examples=20)
@given(scenario=scenarios())
def test_the_features_of_a_task_are_bounded_under_every_motion(scenario):
    low, high = bounds(4)
    seen = task_features(scenario, ants=10, iterations=100)
    assert ((low <= seen) & (seen <= high)).all()


@pytest.mark.parametrize("flat", [None, True, False])
def test_a_task_shows_the_map_on_request(task, valley, flat):
    assert (task.map(flat) == occupancy(valley, flat)).all()
    assert task.map(flat) is task.map(flat)


def test_a_map_is_seen_beside_the_features(task):
    seen = observe_with_map(task, trials((A, 1.0)), window=2, flat=True)
    assert seen["features"].tolist() == observe(task, trials((A, 1.0)), window=2).tolist()
    assert (seen["map"] == task.map(True)).all()
    seen["map"][:] = 7
    assert 7 not in task.map(True)


def test_a_task_without_a_world_says_that_it_has_no_map(task):
    bare = Task(task.space, task.features, 10, 100, 8)
    with pytest.raises(ParameterError, match="holds no world, so there is no map"):
        bare.map()
