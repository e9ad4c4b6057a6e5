"""Variances and powers against simulated contests, statsmodels, and answers by eye."""

import numpy as np
import pytest
import scipy.stats
from gaps import remembered
from reference import rliable_values

from antgym.errors import AntgymError
from experiments.statistics import paired_difference
from experiments.statistics.replication import Components, components, maps_needed, resolved


def contest(maps, seeds, difference, deviations, seed):
    """Gaps of two agents: normal, with deviations between maps, of map × agent, and between seeds."""
    rng = np.random.default_rng(seed)
    shared, interaction, runs = deviations
    b = 0.5 + rng.normal(0, shared, (maps, 1)) + np.zeros((maps, seeds))
    return b + difference + rng.normal(0, interaction, (maps, 1)) + rng.normal(0, runs, (maps, seeds)), b


def test_variances_go_where_they_come_from():
    found = components(*contest(4000, 3, 0.1, (0.2, 0.05, 0.1), seed=1))
    assert np.sqrt(found) == pytest.approx([0.2, 0.05, 0.1], rel=0.06)


def test_variances_by_eye():
    """Differences of 0 and 2 on one map and 2 and 4 on the other; half of their noise is in the maps' means."""
    found = components([[0, 2], [2, 4]], np.zeros((2, 2)))
    assert found == (0.0, 1.0, 2.0)
    assert [found.variance(seeds) for seeds in (1, 2, np.inf)] == [3.0, 2.0, 1.0]


def test_with_one_seed_a_map_nothing_is_known_of_more():
    found = components([[0], [2]], [[0], [0]])
    assert found.seeds is None
    assert found.variance(1) == 2.0
    with pytest.raises(AntgymError, match="nothing is known of 3 seeds a map: 1 seed a map was measured"):
        maps_needed(found, 0.1, 3)


def test_as_many_maps_are_needed_as_statsmodels_says():
    theirs = remembered()["pairs_needed"]
    needed = [maps_needed(Components(0.0, 1.0, 0.0), effect, 1) for effect in rliable_values.EFFECTS]
    assert needed == np.ceil(theirs).tolist()


def test_what_so_many_maps_resolve_needs_as_many_maps():
    found = Components(0.3, 0.02, 0.05)
    for maps, seeds in ((2, 1), (17, 3), (500, 10)):
        assert maps_needed(found, resolved(found, maps, seeds) * (1 + 1e-9), seeds) == maps


def test_seeds_wear_out_and_maps_do_not():
    found = Components(0.0, 0.03**2, 0.05**2)
    assert resolved(found, 400, 3) == pytest.approx(resolved(found, 100, 3) / 2, rel=0.02)
    assert resolved(found, 100, 10**9) == pytest.approx(resolved(found, 100, np.inf))
    assert resolved(found, 100, np.inf) > 0.5 * resolved(found, 100, 1)


def test_a_resolved_difference_is_found_in_four_of_five_contests():
    """By Student's test, and by the intervals that a board marks ties with."""
    deviations, difference, seeds = (0.2, 0.03, 0.05), 0.02, 3
    maps = maps_needed(Components(0.04, 0.03**2, 0.05**2), difference, seeds)
    found = [contest(maps, seeds, difference, deviations, seed) for seed in range(600)]
    p_values = [scipy.stats.ttest_rel(a.mean(axis=1), b.mean(axis=1)).pvalue for a, b in found]
    told = [paired_difference(a, b, reps=400, seed=i).low > 0 for i, (a, b) in enumerate(found)]
    assert np.mean(np.array(p_values) < 0.05) == pytest.approx(0.8, abs=0.04)
    assert np.mean(told) == pytest.approx(0.8, abs=0.05)


def test_what_cannot_be_asked_is_named():
    with pytest.raises(AntgymError, match=r"got \(2, 1\) and \(3, 1\)"):
        components(np.ones((2, 1)), np.ones((3, 1)))
    with pytest.raises(AntgymError, match=r"above 0, got 0\.0"):
        maps_needed(Components(0, 1, 1), 0.0, 1)
    with pytest.raises(AntgymError, match="two maps or more, got 1"):
        resolved(Components(0, 1, 1), 1, 1)
    with pytest.raises(AntgymError, match="nothing is known of 0 seeds"):
        resolved(Components(0, 1, 1), 2, 0)
