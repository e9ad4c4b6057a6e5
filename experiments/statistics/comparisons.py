"""Comparisons of agents on the same maps: differences, chances, shares of what there is to gain, and p-values."""

import numpy as np
from numpy.typing import ArrayLike

from antgym.errors import AntgymError
from experiments.statistics.bootstrap import (
    Estimate,
    Resampling,
    Values,
    as_finite,
    as_matrix,
    contracted_tail,
)


def paired_difference(
    a: ArrayLike, b: ArrayLike, *, reps: int = 2000, seed: int = 0, level: float = 0.95
) -> Estimate:
    """Return mean(a) − mean(b) and its interval; every resample takes the same maps from both.

    Seeds are paired by nothing but their map, so their numbers may differ.

    Args:
        a: (maps, seeds of a), finite.
        b: (maps, seeds of b), finite, the same maps in the same order.
        reps: number of resamples.
        seed: of the resampling.
        level: share of intervals that shall hold the truth.

    Raises:
        AntgymError: as ``cluster_interval``, and if the numbers of maps differ.
    """
    return Resampling(reps, seed, level).estimate(_differences(a, b))


def paired_p_value(a: ArrayLike, b: ArrayLike, *, reps: int = 10_000, seed: int = 0) -> float:
    """Return the two-sided p-value of a paired difference: 1 − level where its interval comes to touch 0.

    Where none of the resamples reaches 0, one more is supposed to have done so (Davison & Hinkley 1997, section 4.2):
    p never is 0, and the least that it can be falls with ``reps`` and with the number of maps.

    Args:
        a: (maps, seeds of a), finite.
        b: (maps, seeds of b), finite, the same maps in the same order.
        reps: number of resamples.
        seed: of the resampling.

    Raises:
        AntgymError: as ``paired_difference``.
    """
    differences = _differences(a, b)
    resampled = Resampling(reps, seed, 0.95).draw(len(differences)) @ differences
    rarer = min(int((resampled <= 0).sum()), int((resampled >= 0).sum()))
    return min(1.0, 2 * contracted_tail((rarer + 1) / (reps + 1), len(differences)))


def probability_of_improvement(
    a: ArrayLike, b: ArrayLike, *, reps: int = 2000, seed: int = 0, level: float = 0.95
) -> Estimate:
    """Return the chance that a run of a is better (its gap lower) than one of b on the same map, and its interval.

    Per map it is Mann & Whitney's U over the number of pairs of seeds, a tie counting half; then the mean over maps
    (Agarwal et al. 2021, section 4.3). 1/2 is no improvement.

    Args:
        a: (maps, seeds of a) gaps, finite.
        b: (maps, seeds of b) gaps, finite, the same maps in the same order.
        reps: number of resamples.
        seed: of the resampling.
        level: share of intervals that shall hold the truth.

    Raises:
        AntgymError: as ``paired_difference``.
    """
    first, second = _same_maps(a=a, b=b)
    signs = np.sign(second[:, None, :] - first[:, :, None])
    return Resampling(reps, seed, level).estimate((1 + signs.mean(axis=(1, 2))) / 2)


def share_closed(
    values: ArrayLike,
    sbs: ArrayLike,
    vbs: ArrayLike,
    *,
    reps: int = 2000,
    seed: int = 0,
    level: float = 0.95,
) -> Estimate:
    """Return the share of what lies between SBS and VBS that is closed, and its interval.

    (mean(sbs) − mean(values)) / (mean(sbs) − mean(vbs)): 0 is no better than the single best setting, 1 as good as
    the best setting of every map (Lindauer, van Rijn & Kotthoff 2019). Resamples take the same maps for numerator and
    denominator.

    Args:
        values: (maps, seeds) gaps, finite.
        sbs: (maps, seeds) gaps of the single best setting, the same maps in the same order.
        vbs: (maps, seeds) gaps of the virtual best setting, likewise.
        reps: number of resamples.
        seed: of the resampling.
        level: share of intervals that shall hold the truth.

    Raises:
        AntgymError: as ``paired_difference``, and if SBS and VBS are not told apart, which makes any share of their
            difference meaningless.
    """
    own, static, oracle = (matrix.mean(axis=1) for matrix in _same_maps(values=values, sbs=sbs, vbs=vbs))
    how = Resampling(reps, seed, level)
    headroom = how.estimate(static - oracle)
    if headroom.low <= 0:
        raise AntgymError(
            f"there is nothing to close: SBS − VBS is {headroom.mean:.4g} [{headroom.low:.4g}, {headroom.high:.4g}]; "
            "take more maps, or leave this world out of this view"
        )
    return how.estimate(static - own, static - oracle, statistic=_ratio)


def holm(p_values: ArrayLike) -> Values:
    """Return (n,) p-values adjusted for their number, in the order given (Holm 1979).

    The i-th smallest of n is multiplied by n − i + 1, made no smaller than the one before it and no larger than 1.
    Rejecting those below 0.05 then makes one false claim or more in at most one of twenty such families.

    Raises:
        AntgymError: if they are not (n,) numbers from 0 to 1.
    """
    given = as_finite(p_values)
    if given.ndim != 1 or not ((given >= 0) & (given <= 1)).all():
        raise AntgymError(f"p-values are an (n,) array of numbers from 0 to 1, got {given.tolist()}")
    order = np.argsort(given, kind="stable")
    adjusted = np.empty_like(given)
    adjusted[order] = np.maximum.accumulate(given[order] * np.arange(len(given), 0, -1))
    return np.minimum(adjusted, 1.0)


def _differences(a: ArrayLike, b: ArrayLike) -> Values:
    first, second = _same_maps(a=a, b=b)
    differences: Values = first.mean(axis=1) - second.mean(axis=1)
    return differences


def _same_maps(**named: ArrayLike) -> list[Values]:
    """Return (maps, seeds) arrays; AntgymError where their numbers of maps differ."""
    arrays = {name: as_matrix(values) for name, values in named.items()}
    if len({len(array) for array in arrays.values()}) > 1:
        counts = " and ".join(f"{name} has {len(array)}" for name, array in arrays.items())
        raise AntgymError(f"agents are compared on the same maps, but {counts}")
    return list(arrays.values())


def _ratio(closed: Values, headroom: Values) -> Values:
    """Return closed / headroom; a resample that holds no headroom says that the share may be anything."""
    positive = headroom > 0
    beyond = np.where(closed >= 0, np.inf, -np.inf)
    return np.where(positive, closed / np.where(positive, headroom, 1.0), beyond)
