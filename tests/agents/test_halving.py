"""Portfolio, neighbours and successive halving on tables small enough to work out by hand."""

import dataclasses
from itertools import combinations

import numpy as np
import pytest

from agents.experience import Experience, Spread
from agents.halving import Advice, Halving, posterior
from agents.neighbours import NeighbourAgent, blended_advice, nearest_maps
from agents.ordering import greedy_portfolio
from agents.portfolio import PortfolioAgent
from antgym.errors import ParameterError
from antgym.tuning import COST_CAP, tune


def mean_of_best(regrets, portfolio):
    return regrets[:, list(portfolio)].min(axis=1).mean()


@pytest.mark.parametrize("seed", range(10))
def test_each_greedy_step_is_the_best_single_addition(seed):
    regrets = np.random.default_rng(seed).random((6, 8))
    order = greedy_portfolio(regrets, 4)
    for size in range(1, 5):
        rest = set(range(8)) - set(order[: size - 1])
        best = min(mean_of_best(regrets, [*order[: size - 1], j]) for j in rest)
        assert mean_of_best(regrets, order[:size]) == best


@pytest.mark.parametrize("seed", range(10))
def test_a_greedy_portfolio_is_within_its_bound_of_brute_force(seed):
    """The gain over the first setting is submodular: at least 1 - 1/e of the best."""
    regrets = np.random.default_rng(seed).random((6, 8))
    first = mean_of_best(regrets, greedy_portfolio(regrets, 1))
    greedy = mean_of_best(regrets, greedy_portfolio(regrets, 3))
    brute = min(mean_of_best(regrets, some) for some in combinations(range(8), 3))
    assert first - greedy >= (1 - 1 / np.e) * (first - brute) - 1e-12


def test_a_portfolio_by_hand():
    """Setting 1 is best on average; setting 2 helps where it fails; the others gain nothing any more."""
    regrets = np.array([[0.0, 0.1, 0.9, 0.2], [0.9, 0.1, 0.9, 0.2], [0.9, 0.6, 0.0, 0.7]])
    assert greedy_portfolio(regrets, 3) == [1, 2, 0]
    assert greedy_portfolio(regrets) == [1, 2, 0, 3]


def test_settings_that_gain_nothing_follow_by_their_own_regret():
    assert greedy_portfolio(np.array([[0.0, 0.5, 0.2, 0.9]])) == [0, 2, 1, 3]


SPREAD = Spread(noise=0.01, between=0.03)


def test_expectations_stand_where_nothing_was_run():
    assert posterior(np.array([0.1, 0.3]), [[], []], SPREAD).tolist() == [0.1, 0.3]


def test_one_run_shifts_the_level_of_all_and_no_order():
    judged = posterior(np.array([0.1, 0.3]), [[2.0], []], SPREAD)
    assert judged == pytest.approx([np.log(2), np.log(2) + 0.2])


def test_runs_correct_an_expectation_by_their_share_of_the_variance():
    """By hand: equal expectations, one run each, costs e^0 and e^0.4: level 0.2, share 0.03 / 0.04."""
    judged = posterior(np.zeros(2), [[1.0], [np.exp(0.4)]], SPREAD)
    assert judged == pytest.approx([0.2 - 0.75 * 0.2, 0.2 + 0.75 * 0.2])


def test_a_failure_counts_as_twice_the_best_run():
    judged = posterior(np.zeros(2), [[1.0], [COST_CAP]], Spread(0.0, 1.0))
    assert judged == pytest.approx([0.0, np.log(2)])


class Fixed(Halving):
    """Ten candidates on a diagonal, in the order of their first coordinate."""

    def _advise(self, task):
        along = np.linspace(0, 1, 10)
        return Advice(np.repeat(along[:, None], len(task.space), axis=1), np.zeros(10), SPREAD)


def test_rounds_halve_until_the_budget_is_spent(bowl):
    session = bowl(20, optimum=(0.33,) * 4)
    result = tune(Fixed(), session, seed=0)
    assert [len(batch) for batch in session.batches] == [10, 5, 2, 2, 1]
    assert result.recommendation == pytest.approx([1 / 3] * 4)


def test_no_candidate_is_run_more_than_ten_times(bowl):
    session = bowl(200)
    tune(Fixed(), session, seed=0)
    assert np.unique(np.concatenate(session.batches), axis=0, return_counts=True)[1].max() == 10
    assert session.left > 0


def test_a_single_trial_has_nothing_to_compare_and_is_not_spent(bowl):
    session = bowl(1)
    assert tune(Fixed(), session, seed=0).recommendation.tolist() == [0.0] * 4
    assert session.left == 1


def test_the_portfolio_runs_in_its_order(bowl, experience):
    session = bowl(5)
    tune(PortfolioAgent(experience), session, seed=0)
    first = experience.settings[greedy_portfolio(experience.regrets)[:3]]
    assert session.batches[0].tolist() == first.tolist()


def crafted(experience):
    """Four maps on a line of one feature; each map has one setting that is best there, by far."""
    features = np.zeros((4, len(experience.described)))
    features[:, 0] = (0, 1, 9, 10)
    costs = 2.0 - np.eye(4)[:, :, None]
    units = np.repeat([[0.1], [0.3], [0.6], [0.9]], 4, axis=1)
    return Experience(
        ("a", "b", "c", "d"),
        experience.parameters,
        experience.described,
        *(tuple(map(tuple, table.tolist())) for table in (features, units)),
        tuple(tuple(tuple(runs) for runs in row) for row in costs.tolist()),
    )


def test_the_nearest_map_decides_where_one_speaks(bowl, experience):
    for place, best in ((0.0, 0.1), (1.2, 0.3), (8.0, 0.6), (30.0, 0.9)):
        agent, task = NeighbourAgent(crafted(experience), 1, tau=1e-3), bowl(0, features=(place,)).task
        agent.reset(task, seed=0)
        assert agent.recommend() == pytest.approx([best] * 4)


def test_two_neighbours_blend_on_the_parameters_own_scales(bowl, experience):
    """Halfway between two maps both weigh alike; a large tau lets their settings weigh alike too."""
    found, session = crafted(experience), bowl(0, features=(0.5,))
    nearest, weights = nearest_maps(found, session.task, 2)
    assert sorted(nearest.tolist()) == [0, 1]
    assert weights == pytest.approx([0.5, 0.5])
    advice = blended_advice(session.space, found, found.regrets[nearest], weights, 1e-3)
    assert advice.candidates[0] == pytest.approx(session.space.mean(found.settings[:2], [0.5, 0.5]))


def test_after_the_blend_settings_are_tried_for_the_case_that_those_before_fail(bowl, experience):
    """Two cases by hand: setting 1 is best on average, setting 0 helps where it is worst, 3 no more than 2."""
    regrets = np.array([[0.0, 0.2, 0.3, 0.4], [0.6, 0.1, 0.3, 0.4]])
    advice = blended_advice(bowl(0).space, crafted(experience), regrets, np.array([0.5, 0.5]), 0.1)
    assert advice.expected == pytest.approx([0.15, 0.15, 0.3, 0.3, 0.4])
    assert advice.candidates[1:, 0].tolist() == [0.3, 0.1, 0.6, 0.9]


def test_a_likely_case_comes_before_an_unlikely_one():
    regrets = np.array([[0.0, 1.0], [1.0, 0.0]])
    assert greedy_portfolio(regrets, weights=np.array([0.3, 0.7])) == [1, 0]


def test_features_far_outside_the_train_maps_are_cut_off(bowl, experience):
    task = bowl(0).task
    far = dataclasses.replace(task, features=np.full_like(task.features, 1e6))
    assert np.isfinite(crafted(experience).distances(far)).all()


@pytest.mark.parametrize("wrong", [{"neighbours": 0}, {"tau": 0.0}, {"tau": float("nan")}])
def test_neighbours_refuse_what_they_cannot_use(experience, wrong):
    with pytest.raises(ParameterError, match="must be ≥ 1"):
        NeighbourAgent(experience, **wrong)
