"""Effort: what the runs of a batch are asked for beside their parameters, one for all or one each."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antgym.errors import ParameterError
from antgym.planners.bee_rules import BeeRules
from antgym.planners.rules import Rules

MOST_EFFORT = 1_000_000  # ants, or iterations


def each_rules(rules: Any, count: int) -> list[Any]:
    """Return the rules of each of ``count`` runs, by name or as data."""
    if isinstance(rules, (str, Rules, BeeRules)):
        return [rules] * count
    if len(rules) != count:
        raise ParameterError(f"{len(rules)} rules for {count} scenarios; give one, or one each")
    return list(rules)


def effort(name: str, values: int | Sequence[int], count: int) -> NDArray[np.int64]:
    """Return (count,) numbers of ants, bees or iterations; ParameterError unless whole and from 1 to a million."""
    array = np.asarray(values)
    if array.size and (array.dtype.kind not in "iu" or (array < 1).any() or (array > MOST_EFFORT).any()):
        raise ParameterError(f"{name} = {values}: whole numbers from 1 to {MOST_EFFORT:,} are needed")
    if array.ndim and len(array) != count:
        raise ParameterError(f"{len(array)} values of {name} for {count} scenarios; give one, or one each")
    return np.broadcast_to(array, (count,)).astype(np.int64)


def keys_of(seeds: ArrayLike, count: int) -> NDArray[np.uint64]:
    """Return (count,) seeds as the kernels take them; ParameterError outside [0, 2^64)."""
    values = np.asarray(seeds)
    if len(values.ravel()) != count:
        raise ParameterError(f"{values.size} seeds for {count} scenarios")
    if values.dtype != np.uint64:
        for seed in np.asarray(seeds, dtype=object).ravel():
            if not isinstance(seed, int | np.integer) or not 0 <= seed < 1 << 64:
                raise ParameterError(f"seed = {seed!r}: must be a whole number in [0, 2^64)")
    return np.asarray(seeds, dtype=np.uint64).ravel()
