"""Intervals against plain loops, scipy, and answers by eye."""

import numpy as np
import pytest
import scipy.stats

from antgym.errors import AntgymError
from experiments.statistics import (
    cluster_interval,
    interquartile_mean,
    mean_band,
    paired_difference,
    wilson_interval,
)


def slow_interval(values, reps, seed, level=0.95):
    rng = np.random.default_rng(seed)
    means = []
    for _ in range(reps):
        maps = [values[int(rng.integers(len(values)))] for _ in values]
        means.append(
            np.mean([np.mean([seeds[int(rng.integers(len(seeds)))] for _ in seeds]) for seeds in maps])
        )
    return np.quantile(means, [(1 - level) / 2, (1 + level) / 2])


def drawn(maps, seeds, seed):
    """Log-normal gaps with mean 1: hard and easy maps, lucky and unlucky seeds."""
    rng = np.random.default_rng(seed)
    return rng.lognormal(-0.125, 0.5, (maps, 1)) * rng.lognormal(-0.125, 0.5, (maps, seeds))


def test_interval_agrees_with_a_plain_loop():
    values = drawn(9, 4, seed=1)
    assert cluster_interval(values, reps=20_000) == pytest.approx(
        slow_interval(values, 2500, seed=2), abs=0.035
    )


def test_interval_agrees_with_scipy_where_maps_have_one_seed_each():
    values = drawn(20, 1, seed=3)
    other = scipy.stats.bootstrap((values[:, 0],), np.mean, method="percentile", rng=np.random.default_rng(4))
    assert cluster_interval(values, reps=10_000) == pytest.approx(tuple(other.confidence_interval), abs=0.02)


def test_interval_of_two_maps_without_noise_spans_both():
    """The resampled means are 0, 1/2 and 1 with probabilities 1/4, 1/2, 1/4."""
    assert cluster_interval([[0, 0], [1, 1]]) == (0.0, 1.0)
    assert cluster_interval([[0, 0], [1, 1]], level=0.4) == (0.5, 0.5)


def test_maps_are_clusters_so_more_seeds_do_not_buy_certainty_about_maps():
    few = np.repeat(drawn(10, 1, seed=5), 2, axis=1)
    many = np.repeat(few, 50, axis=1)
    assert np.ptp(cluster_interval(many)) == pytest.approx(np.ptp(cluster_interval(few)), rel=0.1)


def test_interval_covers_the_truth_about_as_often_as_it_says():
    hits = 0
    for seed in range(300):
        low, high = cluster_interval(drawn(40, 3, seed), reps=300, seed=seed)
        hits += low <= 1.0 <= high
    assert 0.88 <= hits / 300 <= 0.98


def test_equal_seeds_give_equal_intervals():
    values = drawn(6, 3, seed=7)
    assert cluster_interval(values, seed=1) == cluster_interval(values, seed=1)
    assert cluster_interval(values, seed=1) != cluster_interval(values, seed=2)


def test_difference_by_eye():
    """Every map is harder for a by exactly 1/4, so there is nothing to be unsure of."""
    assert paired_difference([[0.25, 0.25], [1.25, 1.25]], [[0, 0], [1, 1]]) == (0.25, 0.25, 0.25)


def test_pairing_takes_the_difficulty_of_maps_out():
    easy = drawn(12, 3, seed=8)
    hard = easy * 1.1 + 0.05
    assert paired_difference(hard, easy).mean == pytest.approx(hard.mean() - easy.mean())
    paired = paired_difference(hard.mean(axis=1, keepdims=True), easy.mean(axis=1, keepdims=True))
    assert paired.low > 0
    assert cluster_interval(hard)[0] < cluster_interval(easy)[1]


def test_difference_is_antisymmetric_and_takes_unequal_seeds():
    a, b = drawn(8, 3, seed=9), drawn(8, 1, seed=10)
    there, back = paired_difference(a, b, reps=8000), paired_difference(b, a, reps=8000)
    assert there.mean == pytest.approx(-back.mean)
    assert (there.low, there.high) == pytest.approx((-back.high, -back.low), abs=0.03)


@pytest.mark.parametrize("shape", [(8,), (3, 5), (2, 2), (1,)])
def test_interquartile_mean_is_scipys_trimmed_mean(shape):
    values = np.random.default_rng(11).random(shape)
    assert interquartile_mean(values) == pytest.approx(scipy.stats.trim_mean(values.ravel(), 0.25))


def test_interquartile_mean_by_eye():
    assert interquartile_mean([[0, 1], [3, 100]]) == 2.0


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
    with pytest.raises(AntgymError, match=words):
        cluster_interval(values)


def test_unusable_settings_are_named():
    with pytest.raises(AntgymError, match="reps=0"):
        cluster_interval([[0.1], [0.2]], reps=0)
    with pytest.raises(AntgymError, match=r"level=1\.0"):
        cluster_interval([[0.1], [0.2]], level=1.0)
    with pytest.raises(AntgymError, match="a has 3 maps and b has 2"):
        paired_difference(np.ones((3, 1)), np.ones((2, 1)))
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


def test_a_band_is_the_interval_of_every_point():
    curves = np.random.default_rng(0).random((12, 3))
    low, high = mean_band(curves)
    for i in range(3):
        assert (low[i], high[i]) == pytest.approx(cluster_interval(curves[:, i : i + 1]))
