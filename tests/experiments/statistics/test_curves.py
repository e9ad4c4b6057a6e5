"""Curves point by point against the statistics of single points, rliable, and answers by eye."""

import numpy as np
import pytest
from gaps import drawn, level_of_percentiles, remembered
from reference import rliable_values

from antgym.errors import AntgymError
from experiments.statistics import anytime, cluster_interval, performance_profile, targets_reached


def falling(maps, seeds, points, seed):
    """Gaps that shrink with every point."""
    return drawn(maps, seeds, seed)[:, :, None] * np.geomspace(1, 0.01, points)


def test_a_band_is_the_interval_of_every_point():
    curves = falling(12, 2, 3, seed=0)
    mean, low, high = anytime(curves)
    for i in range(3):
        assert mean[i] == pytest.approx(curves[:, :, i].mean())
        assert (low[i], high[i]) == pytest.approx(cluster_interval(curves[:, :, i]))


def test_a_profile_is_the_interval_of_the_share_at_every_tau():
    values, taus = drawn(12, 4, seed=1), [0.5, 1.0, 2.0]
    found = performance_profile(values, taus)
    for i, tau in enumerate(taus):
        assert found.mean[i] == pytest.approx((values <= tau).mean())
        assert (found.low[i], found.high[i]) == pytest.approx(cluster_interval(values <= tau))


def test_a_profile_is_rliables():
    taus, theirs = rliable_values.TAUS, remembered()
    assert performance_profile(rliable_values.drawn(12, 5, 1), taus).mean == pytest.approx(
        theirs["performance_profile"]
    )
    band = performance_profile(
        rliable_values.drawn(30, 1, 3), taus, reps=20_000, level=level_of_percentiles(30)
    )
    assert np.transpose(band[1:]) == pytest.approx(np.array(theirs["intervals"][3:]), abs=0.04)


def test_a_gap_of_exactly_tau_is_within_it():
    assert performance_profile([[0.1], [0.2]], [0.1]).mean.tolist() == [0.5]


def test_reached_targets_by_eye():
    """Two maps, two targets: at first one pair of four is reached, in the end three."""
    curves = [[[0.15, 0.15]], [[0.5, 0.05]]]
    assert targets_reached(curves, (0.2, 0.1)).mean.tolist() == [0.25, 0.75]


def test_a_target_that_is_lost_again_is_not_reached():
    assert targets_reached([[[0.05, 0.3]], [[0.05, 0.3]]], (0.1,)).mean.tolist() == [1.0, 0.0]


def test_reached_targets_are_the_mean_of_the_profiles_at_them():
    curves, targets = falling(10, 3, 4, seed=2), (0.5, 0.1, 0.02)
    found = targets_reached(curves, targets)
    for i in range(4):
        profile = performance_profile(curves[:, :, i], targets)
        assert found.mean[i] == pytest.approx(profile.mean.mean())
        assert found.low[i] <= found.mean[i] <= found.high[i]


def test_what_is_no_curve_is_named():
    with pytest.raises(AntgymError, match=r"\(maps, seeds, points\) array, got shape \(2, 3\)"):
        anytime(np.ones((2, 3)))
    with pytest.raises(AntgymError, match=r"\(0, 0, 1\) is nan"):
        targets_reached([[[0.1, np.nan]], [[0.1, 0.1]]])
    with pytest.raises(AntgymError, match="no values"):
        targets_reached(np.ones((2, 1, 1)), ())
    with pytest.raises(AntgymError, match=r"taus are a \(points,\) array of gaps, got shape \(\)"):
        performance_profile(np.ones((2, 1)), 0.1)
