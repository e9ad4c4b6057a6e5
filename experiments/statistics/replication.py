"""Replication: how many maps and seeds tell two agents apart, from what their difference varies by.

The difference of two agents on map m and seed s is taken as delta + I_m + E_ms, with a part of the map (map x agent)
and one of the seed, both of mean 0. Over n maps with k seeds each its mean varies by (var I + var E / k) / n: seeds
wear out, maps do not (Campelo & Wanner 2020). What both agents share on a map, its difficulty, is not in it.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import nctdtrinc, stdtrit

from antgym.errors import AntgymError
from experiments.statistics.bootstrap import as_matrix

POWER, ALPHA = 0.8, 0.05


class Components(NamedTuple):
    """Variances of the difference of two agents, in squared gaps.

    Attributes:
        shared: covariance of the two agents' means over maps, the difficulty of maps, which pairing takes out.
        interaction: of the difference from map to map; where there is one seed a map, what seeds add is in it.
        seeds: of the difference from seed to seed of one map; None where there is one seed a map.
    """

    shared: float
    interaction: float
    seeds: float | None

    def variance(self, seeds: float) -> float:
        """Return the variance of the difference on one map, the mean of so many seeds; inf leaves that of maps.

        Raises:
            AntgymError: if nothing is known of so many seeds.
        """
        if seeds < 1 or (self.seeds is None and seeds != 1):
            measured = "1 seed a map was measured; " if self.seeds is None else ""
            raise AntgymError(f"nothing is known of {seeds} seeds a map: {measured}measure 2 or more")
        return self.interaction + (self.seeds or 0.0) / seeds


def components(a: ArrayLike, b: ArrayLike) -> Components:
    """Return what the difference of two agents varies by: a one-way analysis of variance, none of it below 0.

    Args:
        a: (maps, seeds) gaps, finite.
        b: (maps, seeds) gaps, finite, the same maps and seeds in the same order.

    Raises:
        AntgymError: if the shapes differ, or there are fewer than two maps.
    """
    first, second = as_matrix(a), as_matrix(b)
    if first.shape != second.shape or len(first) < 2:
        raise AntgymError(
            f"variances need the same maps, two or more, and seeds of both agents, got {first.shape} and {second.shape}"
        )
    differences, seeds = first - second, first.shape[1]
    between = float(differences.mean(axis=1).var(ddof=1))
    within = float(differences.var(axis=1, ddof=1).mean()) if seeds > 1 else None
    shared = float(np.cov(first.mean(axis=1), second.mean(axis=1))[0, 1])
    return Components(max(shared, 0.0), max(between - (within or 0.0) / seeds, 0.0), within)


def resolved(found: Components, maps: int, seeds: float) -> float:
    """Return the least true difference that is told from 0 in four of five contests of so many maps and seeds.

    The test is Student's of the means over maps, two-sided at 5 %.

    Raises:
        AntgymError: if there are fewer than two maps, or nothing is known of so many seeds.
    """
    if maps < 2:
        raise AntgymError(f"a test needs two maps or more, got {maps}")
    return _noncentrality(maps) * float(np.sqrt(found.variance(seeds) / maps))


def maps_needed(found: Components, difference: float, seeds: float) -> int:
    """Return the least number of maps, with so many seeds each, that resolves a difference of gaps.

    Raises:
        AntgymError: if the difference is not above 0, or nothing is known of so many seeds.
    """
    if not difference > 0:
        raise AntgymError(f"a difference to resolve is above 0, got {difference}")
    enough = 2
    while resolved(found, enough, seeds) > difference:
        enough *= 2
    low = enough // 2
    while enough - low > 1:
        middle = (low + enough) // 2
        low, enough = (middle, enough) if resolved(found, middle, seeds) > difference else (low, middle)
    return enough


@lru_cache(maxsize=4096)
def _noncentrality(maps: int) -> float:
    """Return the true difference over its standard error at which Student's test has its power."""
    return float(nctdtrinc(maps - 1, 1 - POWER, stdtrit(maps - 1, 1 - ALPHA / 2)))
