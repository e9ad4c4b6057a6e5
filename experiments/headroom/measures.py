"""What the gaps of many settings on many scenarios say: where variance comes from, what matters, what is flat."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
BINS = 8  # of a parameter's range, for its main effect


class Interval(NamedTuple):
    """A value and the 95 % interval around it."""

    value: float
    low: float
    high: float


def headroom(static: Floats, oracle: Floats, reps: int = 4000, seed: int = 0) -> Interval:
    """Return (SBS - VBS) / SBS of mean gaps, with its interval from a bootstrap over maps.

    Args:
        static: (maps,) mean gap of the static setting on each map.
        oracle: (maps,) mean gap of each map's own setting, scored on seeds that its search did not see.
        reps: resamples.
        seed: of the resampling.
    """
    drawn = np.random.default_rng(seed).integers(len(static), size=(reps, len(static)))
    shares = _share(static[drawn].mean(axis=1), oracle[drawn].mean(axis=1))
    low, high = np.quantile(shares, (0.025, 0.975))
    return Interval(float(_share(static.mean(), oracle.mean())), float(low), float(high))


def _share(static: Floats, oracle: Floats) -> Floats:
    return np.where(static > 0, (static - oracle) / np.maximum(static, 1e-12), 0.0)


def mean_interval(values: Floats, reps: int = 4000, seed: int = 0) -> Interval:
    """Return the mean of (maps,) values, with its interval from a bootstrap over maps."""
    drawn = np.random.default_rng(seed).integers(len(values), size=(reps, len(values)))
    low, high = np.quantile(values[drawn].mean(axis=1), (0.025, 0.975))
    return Interval(float(values.mean()), float(low), float(high))


def variance_shares(gaps: Floats) -> dict[str, float]:
    """Return the shares of variance of map, setting, map × setting and run.

    A two-way layout with equal repeats: every mean square is cleared of the run noise in it, and no component is
    below zero.

    Args:
        gaps: (maps, settings, repeats), repeats ≥ 2.
    """
    maps, settings, repeats = gaps.shape
    cells, grand = gaps.mean(axis=2), gaps.mean()
    by_map, by_setting = cells.mean(axis=1), cells.mean(axis=0)
    noise = gaps.var(axis=2, ddof=1).mean()
    rest = cells - by_map[:, None] - by_setting[None, :] + grand
    interaction = (rest**2).sum() / ((maps - 1) * (settings - 1)) - noise / repeats
    both = max(interaction, 0.0) + noise / repeats
    parts = {
        "map": by_map.var(ddof=1) - both / settings,
        "setting": by_setting.var(ddof=1) - both / maps,
        "map x setting": interaction,
        "run": noise,
    }
    positive = {name: max(float(part), 0.0) for name, part in parts.items()}
    total = sum(positive.values()) or 1.0
    return {name: part / total for name, part in positive.items()}


def sensitivity(units: Floats, gaps: Floats) -> Floats:
    """Return (d,) main effects: the share of the settings' variance that each parameter alone explains.

    For every map the variance of the conditional mean over BINS equal bins of the parameter's range (the first-order
    term of a functional analysis of variance), cleared of what the finite bins add by chance, over the variance of
    all settings; both summed over maps.

    Interactions are not in it: a parameter can matter beside others and have no main effect.

    Args:
        units: (settings, d) in [0, 1], drawn independently: a design that fills the cube evenly has less chance in its
            bins than what is taken off for it.
        gaps: (maps, settings) mean gaps.
    """
    variance = gaps.var(axis=1, ddof=1).sum()
    effects = []
    for column in units.T:
        bins = np.minimum((column * BINS).astype(int), BINS - 1)
        explained = 0.0
        for row in gaps:
            groups = [row[bins == b] for b in range(BINS) if (bins == b).sum() > 1]
            means, sizes = (np.array([f(group) for group in groups]) for f in (np.mean, len))
            within = np.mean([group.var(ddof=1) for group in groups])
            between = np.average((means - np.average(means, weights=sizes)) ** 2, weights=sizes)
            explained += between - within * (len(groups) - 1) / sizes.sum()
        effects.append(max(explained, 0.0) / max(variance, 1e-12))
    return np.array(effects)


def better_by_two_errors(a: Floats, b: Floats) -> NDArray[np.bool_]:
    """Return (maps,) whether the mean of a is below that of b by more than two standard errors.

    Args:
        a: (maps, runs).
        b: (maps, runs).
    """
    error = np.sqrt(a.var(axis=1, ddof=1) / a.shape[1] + b.var(axis=1, ddof=1) / b.shape[1])
    return np.asarray(a.mean(axis=1) < b.mean(axis=1) - 2 * error)
