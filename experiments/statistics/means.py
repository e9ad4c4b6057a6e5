"""Means of gaps over maps and seeds: all of them, the middle half, and what lies above a target."""

import numpy as np
from numpy.typing import ArrayLike

from antgym.errors import AntgymError
from experiments.statistics.bootstrap import Estimate, Resampling, Values, as_finite, as_matrix


def cluster_interval(
    values: ArrayLike, *, reps: int = 2000, seed: int = 0, level: float = 0.95
) -> tuple[float, float]:
    """Return the (low, high) bootstrap interval of the mean; maps are resampled, each with all of its seeds.

    One seed a map is enough, since maps still vary; one map is not.

    Args:
        values: (maps, seeds), finite.
        reps: number of resamples.
        seed: of the resampling; equal seeds give equal intervals.
        level: share of intervals that shall hold the truth.

    Raises:
        AntgymError: if the values are not (maps, seeds), are not finite or hold fewer than two maps, or if
            ``reps`` or ``level`` is out of range.
    """
    found = Resampling(reps, seed, level).estimate(as_matrix(values).mean(axis=1))
    return found.low, found.high


def interquartile_mean(values: ArrayLike) -> float:
    """Return the mean of the middle half: a quarter of all values, rounded down, is dropped at either end.

    Raises:
        AntgymError: if there are no values or one is not finite.
    """
    ordered = np.sort(as_finite(values), axis=None)
    cut = ordered.size // 4
    return float(ordered[cut : ordered.size - cut].mean())


def interquartile_interval(
    values: ArrayLike, *, reps: int = 2000, seed: int = 0, level: float = 0.95
) -> tuple[float, float]:
    """Return the (low, high) bootstrap interval of the interquartile mean (Agarwal et al. 2021), over maps.

    Args:
        values: (maps, seeds), finite.
        reps: number of resamples.
        seed: of the resampling.
        level: share of intervals that shall hold the truth.

    Raises:
        AntgymError: as ``cluster_interval``.
    """
    array, how = as_matrix(values), Resampling(reps, seed, level)
    low, high = how.ends(_interquartile_means(array, how.draw(len(array))), len(array))
    return float(low), float(high)


def optimality_gap(
    values: ArrayLike, *, target: float = 0.0, reps: int = 2000, seed: int = 0, level: float = 0.95
) -> Estimate:
    """Return by how much gaps miss a target, mean(max(gap − target, 0)), and its interval.

    It is the optimality gap of Agarwal et al. 2021, gamma − mean(min(score, gamma)), of the scores 1 − gap at
    gamma = 1 − target: what is better than the target makes up for nothing.

    Args:
        values: (maps, seeds) gaps, finite.
        target: gap that is good enough; 0 asks for the optimum.
        reps: number of resamples.
        seed: of the resampling.
        level: share of intervals that shall hold the truth.

    Raises:
        AntgymError: as ``cluster_interval``, and if the target is not finite.
    """
    if not np.isfinite(target):
        raise AntgymError(f"a target is a gap, got {target}")
    missed = np.maximum(as_matrix(values) - target, 0.0)
    return Resampling(reps, seed, level).estimate(missed.mean(axis=1))


def _interquartile_means(values: Values, drawn: Values) -> Values:
    """Return the (reps,) interquartile means of resamples without making them.

    In a resample every value stands as often as its map was drawn. In the order of the values, what of these copies
    lies between the lower and the upper cut is kept.
    """
    order = np.argsort(values, axis=None)
    copies = drawn[:, order // values.shape[1]]
    until = np.cumsum(copies, axis=1)
    cut = values.size // 4
    first, last = cut, values.size - cut
    kept = np.clip(until, first, last) - np.clip(until - copies, first, last)
    means: Values = kept @ values.ravel()[order] / (last - first)
    return means
