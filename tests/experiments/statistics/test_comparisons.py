"""Comparisons against scipy, rliable and statsmodels, and answers by eye."""

import numpy as np
import pytest
import scipy.stats
from gaps import drawn, level_of_percentiles, remembered
from reference import rliable_values

from antgym.errors import AntgymError
from experiments.statistics import (
    cluster_interval,
    holm,
    paired_difference,
    paired_p_value,
    probability_of_improvement,
    share_closed,
)


def scipys(*samples, statistic):
    """Percentile interval of a statistic of several (maps,) samples whose maps are drawn together."""
    rng = np.random.default_rng(4)
    how = {"paired": len(samples) > 1, "method": "percentile", "rng": rng, "vectorized": True}
    return tuple(scipy.stats.bootstrap(samples, statistic, **how).confidence_interval)


def test_difference_by_eye():
    """Every map is harder for a by exactly 1/4, so there is nothing to be unsure of."""
    assert paired_difference([[0.25, 0.25], [1.25, 1.25]], [[0, 0], [1, 1]]) == (0.25, 0.25, 0.25)


def test_pairing_takes_the_difficulty_of_maps_out():
    easy = drawn(12, 3, seed=8)
    hard = easy * 1.1 + 0.05
    assert paired_difference(hard, easy).mean == pytest.approx(hard.mean() - easy.mean())
    assert paired_difference(hard, easy).low > 0
    assert cluster_interval(hard)[0] < cluster_interval(easy)[1]


def test_difference_is_antisymmetric_and_takes_unequal_seeds():
    a, b = drawn(8, 3, seed=9), drawn(8, 1, seed=10)
    there, back = paired_difference(a, b), paired_difference(b, a)
    assert there == pytest.approx((-back.mean, -back.high, -back.low))


def test_difference_and_share_closed_have_the_intervals_that_scipy_gives_them():
    a, sbs, vbs = drawn(25, 1, 11), 2 * drawn(25, 1, 12), 0.3 * drawn(25, 1, 13)
    how = {"reps": 10_000, "level": level_of_percentiles(25)}
    theirs = scipys(a[:, 0], sbs[:, 0], statistic=lambda a, b, axis: a.mean(axis) - b.mean(axis))
    assert paired_difference(a, sbs, **how)[1:] == pytest.approx(theirs, abs=0.03)
    theirs = scipys(
        *(sample[:, 0] for sample in (a, sbs, vbs)),
        statistic=lambda a, b, v, axis: (b.mean(axis) - a.mean(axis)) / (b.mean(axis) - v.mean(axis)),
    )
    assert share_closed(a, sbs, vbs, **how)[1:] == pytest.approx(theirs, abs=0.03)


def test_improvement_by_eye():
    """Better on the first map whichever seeds meet, never on the second, as good on the third."""
    a, b = [[0.1, 0.2], [0.5, 0.6], [0.3, 0.3]], [[0.3], [0.4], [0.3]]
    assert probability_of_improvement(a, b).mean == pytest.approx(0.5)
    assert probability_of_improvement(a[:1] * 2, b[:1] * 2) == (1.0, 1.0, 1.0)


def test_improvement_is_rliables_and_the_rest_of_the_others():
    a, b = rliable_values.drawn(12, 5, 1), rliable_values.drawn(12, 3, 2)
    there, back = probability_of_improvement(a, b), probability_of_improvement(b, a)
    assert there.mean == pytest.approx(remembered()["probability_of_improvement"])
    assert there == pytest.approx((1 - back.mean, 1 - back.high, 1 - back.low))


def test_share_closed_by_eye():
    sbs, vbs = [[0.4], [0.2]], [[0.2], [0.0]]
    assert share_closed([[0.3], [0.1]], sbs, vbs) == pytest.approx((0.5, 0.5, 0.5))
    assert share_closed(sbs, sbs, vbs) == pytest.approx((0, 0, 0))
    assert share_closed(vbs, sbs, vbs) == pytest.approx((1, 1, 1))


def test_there_is_no_share_of_nothing():
    same = drawn(10, 2, seed=14)
    with pytest.raises(AntgymError, match="nothing to close: SBS − VBS is 0"):
        share_closed(drawn(10, 2, seed=15), same, same)


def test_a_share_is_bounded_as_long_as_few_resamples_lack_headroom():
    """Half of six maps hold all that there is to gain: one resample of 64 has none of them."""
    static, own = np.full((6, 1), 0.2), np.linspace(0.1, 0.2, 6)[:, None]
    oracle = np.array([[0.1], [0.2]]).repeat(3, axis=0)
    found = share_closed(own, static, oracle, level=0.8)
    assert found.mean == pytest.approx(1)
    assert 0 < found.low < 1 < found.high < np.inf
    with pytest.raises(AntgymError, match=r"SBS − VBS is 0\.05 \[0, 0\.1\]"):
        share_closed(own, static, oracle)


def test_the_p_value_is_where_the_interval_comes_to_touch_zero():
    a, b = drawn(15, 3, seed=16), 1.5 * drawn(15, 3, seed=17)
    p = paired_p_value(a, b, reps=10_000)
    assert 0.01 < p < 0.5
    assert paired_difference(a, b, reps=10_000, level=1 - 1.02 * p).high < 0
    assert paired_difference(a, b, reps=10_000, level=1 - 0.98 * p).high > 0


def test_the_p_value_is_students_for_normal_differences():
    rng = np.random.default_rng(18)
    a, b = rng.normal(0.1, 0.5, (40, 2)), rng.normal(0, 0.5, (40, 2))
    theirs = scipy.stats.ttest_rel(a.mean(axis=1), b.mean(axis=1)).pvalue
    assert paired_p_value(a, b, reps=20_000) == pytest.approx(theirs, rel=0.2)


def test_agents_that_do_not_differ_have_a_p_value_of_one():
    assert paired_p_value(drawn(9, 2, seed=19), drawn(9, 2, seed=19)) == 1.0
    assert 0 < paired_p_value(drawn(9, 2, seed=19), drawn(9, 2, seed=19) + 1) < 0.01


def test_holm_is_statsmodels():
    assert holm(rliable_values.P_VALUES) == pytest.approx(remembered()["holm"])


def test_holm_by_eye():
    assert holm([0.04, 0.01, 0.03]).tolist() == pytest.approx([0.06, 0.03, 0.06])
    assert holm([0.9, 0.8]).tolist() == [1.0, 1.0]
    with pytest.raises(AntgymError, match=r"from 0 to 1, got \[1\.5\]"):
        holm([1.5])


@pytest.mark.parametrize("compare", [paired_difference, paired_p_value, probability_of_improvement])
def test_other_maps_are_not_compared(compare):
    with pytest.raises(AntgymError, match="a has 3 and b has 2"):
        compare(np.ones((3, 1)), np.ones((2, 1)))
    with pytest.raises(AntgymError, match="one map"):
        compare(np.ones((1, 1)), np.ones((1, 1)))
    with pytest.raises(AntgymError, match="nan"):
        compare(np.ones((2, 1)), [[np.nan], [0]])
