"""Judgement under noise: how a budget is split, what is run again, what is recommended."""

import numpy as np
import pytest

from agents.judgement import Judgement, cap_failures, expected_costs
from antgym.errors import ParameterError
from antgym.tuning import COST_CAP, Trial


def _judgement(bowl, budget, costs, share=0.2):
    judgement = Judgement(bowl(budget).task, share)
    judgement.add([_trial(i, cost) for i, cost in enumerate(costs)])
    return judgement


def _trial(setting, cost):
    return Trial(0, (setting / 100, 0.0, 0.0, 0.0), cost, 1)


@pytest.mark.parametrize(("budget", "search"), [(1, 1), (4, 4), (5, 4), (20, 16), (100, 80)])
def test_a_fifth_of_the_budget_is_kept_for_reruns(bowl, budget, search):
    assert Judgement(bowl(budget).task).to_search == search


def test_reruns_take_the_best_first_and_spend_exactly_their_share(bowl):
    judgement = _judgement(bowl, 100, 1.1 + np.arange(80) / 100)
    rounds = []
    while len(batch := judgement.reruns()):
        rounds.append([round(100 * row[0]) for row in batch])
        judgement.add([_trial(i, 1.1 + i / 100) for i in rounds[-1]])
    assert rounds == [[0, 1, 2, 3, 4, 5, 6], [0, 1, 2, 3, 4], [0, 1, 2], [0, 1], [0, 1], [0]]


def test_a_lucky_run_that_is_not_confirmed_is_not_recommended(bowl):
    judgement = _judgement(bowl, 20, [1.1, 1.2, *[1.5] * 14])
    judgement.reruns()
    judgement.add([_trial(0, 1.6), _trial(1, 1.2)])
    assert judgement.best()[0] == 0.01


def test_a_single_run_is_trusted_less_than_a_mean_of_many():
    lucky, proven, *_ = expected_costs([[1.20], [1.31, 1.10, 1.40, 1.01], [1.9], [2.0], [1.5]])
    assert proven < lucky


def test_without_repeats_the_means_stay_as_they_are():
    assert expected_costs([[1.0], [2.0], [1.5]]).tolist() == [1.0, 2.0, 1.5]


def test_expected_costs_keep_their_order_where_all_runs_of_a_setting_agree():
    assert expected_costs([[1.0, 1.0], [1.0], [1.5]]).tolist() == [1.0, 1.0, 1.5]


def test_a_failure_counts_as_twice_the_best():
    assert cap_failures(np.array([1.2, COST_CAP, 2.0])).tolist() == [1.2, 2.4, 2.0]


def test_with_no_success_the_published_default_is_recommended(bowl):
    assert _judgement(bowl, 10, [COST_CAP] * 8).best().tolist() == [0.5] * 4


def test_reruns_pay_off_under_noise(bowl):
    """Random search with and without re-runs: the mean true cost over 40 seeds is lower."""
    from agents.controls import RandomSearch
    from antgym.tuning import tune

    costs = {
        share: np.mean(
            [_true_cost(tune, RandomSearch(share), bowl(60, noise=0.25), seed) for seed in range(40)]
        )
        for share in (0.0, 0.2)
    }
    assert costs[0.2] < costs[0.0]


def _true_cost(tune, agent, session, seed):
    session._rng = np.random.default_rng(seed)
    return session.cost(tune(agent, session, seed=seed).recommendation)[0]


def test_a_share_outside_its_range_is_refused(bowl):
    with pytest.raises(ParameterError, match="rerun_share"):
        Judgement(bowl(10).task, 1.0)
