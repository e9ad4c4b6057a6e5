"""Means and their intervals against plain loops, scipy, rliable, and answers by eye."""

import numpy as np
import pytest
import scipy.stats
from gaps import drawn, level_of_percentiles, remembered
from reference import rliable_values

from antgym.errors import AntgymError
from experiments.statistics import (
    cluster_interval,
    interquartile_interval,
    interquartile_mean,
    optimality_gap,
    wilson_interval,
)


def slow_interval(values, reps, seed, statistic=np.mean):
    """Percentiles of a plain loop over resamples of whole maps."""
    rng = np.random.default_rng(seed)
    found = [statistic([values[int(rng.integers(len(values)))] for _ in values]) for _ in range(reps)]
    return np.quantile(found, [0.025, 0.975])


@pytest.mark.parametrize(
    ("interval", "statistic"), [(cluster_interval, np.mean), (interquartile_interval, interquartile_mean)]
)
def test_interval_agrees_with_a_plain_loop(interval, statistic):
    values = drawn(9, 4, seed=1)
    ours = interval(values, reps=20_000, level=level_of_percentiles(9))
    assert ours == pytest.approx(slow_interval(values, 2500, seed=2, statistic=statistic), abs=0.035)


def test_interval_agrees_with_scipy_at_the_same_percentiles():
    values = drawn(20, 1, seed=3)
    rng = np.random.default_rng(4)
    other = scipy.stats.bootstrap((values[:, 0],), np.mean, method="percentile", rng=rng).confidence_interval
    ours = cluster_interval(values, reps=10_000, level=level_of_percentiles(20))
    assert ours == pytest.approx(tuple(other), abs=0.02)


def test_few_maps_have_intervals_as_wide_as_student_says():
    """Means of normal values: the percentiles are moved out until the interval is Student's."""
    values = np.random.default_rng(5).normal(size=(9, 1))
    theirs = scipy.stats.t.interval(0.95, 8, values.mean(), scipy.stats.sem(values[:, 0]))
    assert np.ptp(cluster_interval(values, reps=50_000)) == pytest.approx(np.ptp(theirs), rel=0.06)


def test_interval_of_two_maps_without_noise_spans_both():
    """The resampled means are 0, 1/2 and 1 with probabilities 1/4, 1/2, 1/4."""
    assert cluster_interval([[0, 0], [1, 1]]) == (0.0, 1.0)
    assert cluster_interval([[0, 0], [1, 1]], level=0.2) == (0.5, 0.5)


def test_maps_are_clusters_so_more_seeds_do_not_buy_certainty_about_maps():
    few = np.repeat(drawn(10, 1, seed=5), 2, axis=1)
    assert cluster_interval(np.repeat(few, 50, axis=1)) == pytest.approx(cluster_interval(few))


def test_equal_seeds_give_equal_intervals():
    values = drawn(6, 3, seed=7)
    assert cluster_interval(values, seed=1) == cluster_interval(values, seed=1)
    assert cluster_interval(values, seed=1) != cluster_interval(values, seed=2)


@pytest.mark.parametrize("shape", [(8,), (3, 5), (2, 2), (1,)])
def test_interquartile_mean_is_scipys_trimmed_mean(shape):
    values = np.random.default_rng(11).random(shape)
    assert interquartile_mean(values) == pytest.approx(scipy.stats.trim_mean(values.ravel(), 0.25))


def test_interquartile_mean_by_eye():
    assert interquartile_mean([[0, 1], [3, 100]]) == 2.0


def test_optimality_gap_counts_what_lies_above_the_target_alone():
    found = optimality_gap([[0.0, 0.3], [0.0, 0.3]], target=0.1)
    assert found == pytest.approx((0.1, 0.1, 0.1))
    assert optimality_gap([[0.0, 0.3], [0.2, 0.1]]).mean == pytest.approx(0.15)


def test_means_are_rliables():
    gaps, theirs = rliable_values.drawn(12, 5, 1), remembered()
    assert interquartile_mean(gaps) == pytest.approx(theirs["interquartile_mean"])
    assert optimality_gap(gaps, target=0.1).mean == pytest.approx(theirs["optimality_gap_0.9"])


def test_intervals_are_rliables_where_maps_have_one_run_each():
    gaps, theirs = rliable_values.drawn(30, 1, 3), np.array(remembered()["intervals"])
    how = {"reps": 20_000, "level": level_of_percentiles(30)}
    assert cluster_interval(gaps, **how) == pytest.approx(1 - theirs[0, ::-1], abs=0.003)
    assert interquartile_interval(gaps, **how) == pytest.approx(1 - theirs[1, ::-1], abs=0.003)
    assert optimality_gap(gaps, target=0.1, **how)[1:] == pytest.approx(theirs[2], abs=0.003)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ([[0.1, 0.2]], "one map"),
        ([[0.1, 0.2], [0.3, np.nan]], r"\(1, 1\) is nan"),
        ([[0.1], [np.inf]], r"\(1, 0\) is inf"),
        ([0.1, 0.2], r"shape \(2,\)"),
        ([[], []], "no values"),
        ([[0.1], [0.2, 0.3]], "equally many seeds"),
    ],
)
def test_unusable_values_are_named(values, words):
    for function in (cluster_interval, interquartile_interval, optimality_gap):
        with pytest.raises(AntgymError, match=words):
            function(values)


def test_unusable_settings_are_named():
    with pytest.raises(AntgymError, match="reps=0"):
        cluster_interval([[0.1], [0.2]], reps=0)
    with pytest.raises(AntgymError, match=r"level=1\.0"):
        cluster_interval([[0.1], [0.2]], level=1.0)
    with pytest.raises(AntgymError, match="target is a gap, got nan"):
        optimality_gap([[0.1], [0.2]], target=np.nan)
    with pytest.raises(AntgymError, match="nan"):
        interquartile_mean([np.nan])


@pytest.mark.parametrize(("hits", "count"), [(0, 1), (1, 1), (0, 100), (79, 100), (100, 100)])
def test_a_share_has_the_interval_that_scipy_gives_it(hits, count):
    theirs = scipy.stats.binomtest(hits, count).proportion_ci(0.95, method="wilson")
    assert wilson_interval(hits, count) == pytest.approx((theirs.low, theirs.high), abs=1e-12)


@pytest.mark.parametrize(("hits", "count"), [(0, 0), (2, 1), (-1, 5)])
def test_a_share_of_nothing_is_refused(hits, count):
    with pytest.raises(AntgymError, match=f"got {hits} of {count}"):
        wilson_interval(hits, count)
