"""Curves over maps with their bands: gaps against the budget, and shares of runs that reach what is asked."""

from collections.abc import Sequence
from typing import NamedTuple

from numpy.typing import ArrayLike

from antgym.errors import AntgymError
from experiments.statistics.bootstrap import Resampling, Values, as_finite, as_matrix

TARGETS = (0.2, 0.1, 0.05, 0.02, 0.01, 0.005)
"""Gaps that a run may reach, from easy to hard."""


class Band(NamedTuple):
    """A curve, (points,), and the (points,) low and high ends of the intervals around it, at each point by itself."""

    mean: Values
    low: Values
    high: Values


def anytime(curves: ArrayLike, *, reps: int = 2000, seed: int = 0, level: float = 0.95) -> Band:
    """Return the mean curve and its band; every resample takes whole maps.

    Args:
        curves: (maps, seeds, points), finite: gaps at budgets, say.
        reps: number of resamples.
        seed: of the resampling.
        level: share of intervals that shall hold the truth, at each point by itself.

    Raises:
        AntgymError: if the curves are not that, hold fewer than two maps, or if ``reps`` or ``level`` is out of range.
    """
    return _band(_as_curves(curves).mean(axis=1), Resampling(reps, seed, level))


def targets_reached(
    curves: ArrayLike,
    targets: Sequence[float] = TARGETS,
    *,
    reps: int = 2000,
    seed: int = 0,
    level: float = 0.95,
) -> Band:
    """Return the share of all pairs (map, target) that runs reach, at each point of their curves, and its band.

    It is COCO's distribution of runtimes (Hansen et al. 2016) for a recommendation that is judged by fresh runs: a
    pair counts at a budget where the gap is the target or below at that budget. A tuner that finds a good setting and
    then recommends a worse one loses the pair again, so the curve may fall.

    Args:
        curves: (maps, seeds, points) gaps, finite.
        targets: gaps, at least one.
        reps: number of resamples.
        seed: of the resampling.
        level: share of intervals that shall hold the truth, at each point by itself.

    Raises:
        AntgymError: as ``anytime``, and if there are no targets, or one is not finite.
    """
    gaps, asked = _as_curves(curves), as_finite(targets)
    return _band((gaps[..., None] <= asked).mean(axis=(1, 3)), Resampling(reps, seed, level))


def performance_profile(
    values: ArrayLike, taus: ArrayLike, *, reps: int = 2000, seed: int = 0, level: float = 0.95
) -> Band:
    """Return the share of runs whose gap is tau or below, for every tau, and its band.

    It is the score distribution of Agarwal et al. 2021, section 4.2, over gaps, hence from the other side: the higher
    the better. Whatever other agents do, an agent's profile stays as it is.

    Args:
        values: (maps, seeds) gaps, finite.
        taus: (points,) gaps.
        reps: number of resamples.
        seed: of the resampling.
        level: share of intervals that shall hold the truth, at each point by itself.

    Raises:
        AntgymError: as ``cluster_interval``, and if the taus are not (points,) finite numbers.
    """
    gaps, asked = as_matrix(values), as_finite(taus)
    if asked.ndim != 1:
        raise AntgymError(f"taus are a (points,) array of gaps, got shape {asked.shape}")
    return _band((gaps[..., None] <= asked).mean(axis=1), Resampling(reps, seed, level))


def _band(per_map: Values, how: Resampling) -> Band:
    maps = len(per_map)
    return Band(per_map.mean(axis=0), *how.ends(how.draw(maps) @ per_map / maps, maps))


def _as_curves(curves: ArrayLike) -> Values:
    array = as_finite(curves)
    if array.ndim != 3:
        raise AntgymError(f"curves are a (maps, seeds, points) array, got shape {array.shape}")
    return array
