"""Controls: a rule of thumb, random and Sobol settings, trial and error."""

import numpy as np
import pytest

from agents.controls import PublishedDefault, RandomSearch, RuleOfThumb, TrialAndError
from antgym.errors import ParameterError
from antgym.tuning import COST_CAP, tune


@pytest.mark.parametrize("iterations", [25, 100, 400])
def test_the_rule_of_thumb_fits_persistence_to_the_iterations_and_leaves_the_rest(iterations, bowl):
    session = bowl(5, iterations=iterations)
    values = session.space.decode(tune(RuleOfThumb(), session, seed=0).recommendation)[0]
    default = session.space.default
    assert values[2] == pytest.approx(np.exp(-7.5 / (default[0] * iterations)))
    np.testing.assert_allclose(values[[0, 1, 3]], default[[0, 1, 3]])
    assert session.trials == ()


@pytest.mark.parametrize(("iterations", "end"), [(1, "low"), (10**6, "high")])
def test_the_rule_of_thumb_stays_in_the_range_of_the_persistence(iterations, end, bowl):
    session = bowl(0, iterations=iterations)
    values = session.space.decode(tune(RuleOfThumb(), session, seed=0).recommendation)[0]
    assert values[2] == getattr(session.space.parameters[2], end)


def test_the_published_default_is_what_the_rules_publish(bowl):
    session = bowl(0)
    recommended = tune(PublishedDefault(), session, seed=0).recommendation
    np.testing.assert_array_equal(session.space.decode(recommended)[0], session.space.default)


@pytest.mark.parametrize("trials", [1, 3, 16, 21])
def test_sobol_settings_are_scipys_first_points(trials, bowl):
    qmc = pytest.importorskip("scipy.stats").qmc
    session = bowl(trials)
    tune(RandomSearch(0.0, design="sobol"), session, seed=3)
    points = qmc.Sobol(4, seed=np.random.default_rng(3)).random_base2(5)[:trials]
    np.testing.assert_array_equal(np.concatenate(session.batches), points)


def test_sobol_settings_fill_the_cube_more_evenly_than_uniform_ones(bowl):
    qmc = pytest.importorskip("scipy.stats").qmc
    holes = {}
    for design in ("uniform", "sobol"):
        session = bowl(64)
        tune(RandomSearch(0.0, design=design), session, seed=3)
        holes[design] = qmc.discrepancy(session.batches[0])
    assert holes["sobol"] < holes["uniform"] / 2


def test_an_unknown_design_names_the_nearest():
    with pytest.raises(ParameterError, match="did you mean 'sobol'"):
        RandomSearch(design="sobl")


@pytest.mark.parametrize(
    ("budget", "sets", "repeats"), [(1, 1, 1), (7, 7, 1), (25, 12, 2), (100, 10, 10), (1000, 100, 10)]
)
def test_trial_and_error_runs_its_sets_equally_often(budget, sets, repeats, bowl):
    session = bowl(budget, noise=0.1)
    tune(TrialAndError(), session, seed=0)
    units, counts = np.unique([trial.unit for trial in session.trials], axis=0, return_counts=True)
    assert (len(units), set(counts)) == (sets, {repeats})
    assert len(session.batches) == 1


@pytest.mark.parametrize("granted", [None, 3])
def test_trial_and_error_recommends_the_best_mean(granted, bowl):
    session = bowl(60, noise=0.2, granted=granted)
    recommended = tune(TrialAndError(repeats=4), session, seed=0).recommendation
    costs = {}
    for trial in session.trials:
        costs.setdefault(trial.unit, []).append(trial.cost)
    assert len(session.trials) == 60
    assert tuple(recommended) == min(costs, key=lambda unit: np.mean(costs[unit]))


def test_a_set_that_fails_now_and_then_is_not_worth_less_than_one_that_always_does(bowl):
    session = bowl(20)
    agent = TrialAndError(repeats=2)
    agent.reset(session.task, seed=0)
    trials = session.evaluate(agent.ask())
    costs = [1.2, *[COST_CAP] * 9, COST_CAP, *[COST_CAP] * 9]
    agent.tell([trial._replace(cost=cost) for trial, cost in zip(trials, costs, strict=True)])
    assert tuple(agent.recommend()) == trials[0].unit


def test_no_repeats_are_refused():
    with pytest.raises(ParameterError, match="repeats = 0"):
        TrialAndError(repeats=0)
