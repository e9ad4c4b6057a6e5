"""What every interval stands on: checked arrays, resamples of maps, and the ends of what the resamples say."""

from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ndtr, ndtri, stdtr, stdtrit

from antgym.errors import AntgymError

Values = NDArray[np.float64]


class Estimate(NamedTuple):
    """What maps say about a number: its mean over them, or a ratio of means, and the interval around it."""

    mean: float
    low: float
    high: float


class Resampling(NamedTuple):
    """How an interval is found.

    Attributes:
        reps: number of resamples.
        seed: of the resampling; equal seeds draw the same maps, whatever is measured on them.
        level: share of intervals that shall hold the truth.
    """

    reps: int
    seed: int
    level: float

    def draw(self, maps: int) -> Values:
        """Return (reps, maps), how often each map is in each resample; read-only.

        Raises:
            AntgymError: if there are fewer than two maps, or if reps or level is out of range.
        """
        if maps < 2:
            raise AntgymError("one map says nothing about other maps: an interval needs at least two")
        if self.reps < 1 or not 0 < self.level < 1:
            raise AntgymError(
                f"an interval needs reps >= 1 and 0 < level < 1, got reps={self.reps}, level={self.level}"
            )
        return _drawn(maps, self.reps, self.seed)

    def ends(self, resampled: Values, maps: int) -> tuple[Values, Values]:
        """Return the low and high ends of (reps, ...) resampled values, at each point by itself."""
        ordered = np.sort(resampled, axis=0)
        rank = int(expanded_tail((1 - self.level) / 2, maps) * (len(ordered) - 1))
        return ordered[rank], ordered[-1 - rank]

    def estimate(self, *per_map: Values, statistic: Callable[..., Values] = lambda mean: mean) -> Estimate:
        """Return a function of one or several means of (maps,) values, every resample taking the same maps of all."""
        maps = len(per_map[0])
        drawn = self.draw(maps)
        resampled = statistic(*(drawn @ values / maps for values in per_map))
        low, high = self.ends(resampled, maps)
        return Estimate(float(statistic(*(values.mean() for values in per_map))), float(low), float(high))


def expanded_tail(tail: float, maps: int) -> float:
    """Return the percentile that stands for a tail, further out for few maps (Hesterberg 2015, section 3.2).

    The spread of resampled means is too small by sqrt((n - 1) / n), and normal where Student's t with n - 1 degrees of
    freedom is due: tail' = Phi(sqrt(n / (n - 1)) t(tail)).
    """
    return float(ndtr(np.sqrt(maps / (maps - 1)) * stdtrit(maps - 1, tail)))


def contracted_tail(tail: float, maps: int) -> float:
    """Return the tail that a percentile stands for, the inverse of ``expanded_tail``."""
    return float(stdtr(maps - 1, np.sqrt((maps - 1) / maps) * ndtri(tail)))


def as_matrix(values: ArrayLike) -> Values:
    """Return (maps, seeds) values as an array; AntgymError where they are not that, or not finite."""
    array = as_finite(values)
    if array.ndim != 2:
        raise AntgymError(f"values are a (maps, seeds) array, got shape {array.shape}")
    return array


def as_finite(values: ArrayLike) -> Values:
    """Return values as an array; AntgymError where there are none, or where one is not finite."""
    try:
        array = np.asarray(values, dtype=np.float64)
    except ValueError as error:
        raise AntgymError(f"values are an array of numbers, equally many seeds a map: {error}") from None
    if array.size == 0:
        raise AntgymError(f"there are no values in an array of shape {array.shape}")
    if not np.isfinite(array).all():
        index = tuple(np.argwhere(~np.isfinite(array))[0].tolist())
        raise AntgymError(
            f"the value at {index} is {array[index]}; a run without a path counts as the cap, not as NaN"
        )
    return array


@lru_cache(maxsize=8)
def _drawn(maps: int, reps: int, seed: int) -> Values:
    chosen = np.random.default_rng(seed).integers(maps, size=(reps, maps))
    cells = (chosen + maps * np.arange(reps)[:, None]).ravel()
    counts = np.bincount(cells, minlength=reps * maps).reshape(reps, maps).astype(np.float64)
    counts.flags.writeable = False  # the cache hands it out again
    return counts
