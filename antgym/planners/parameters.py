"""What an agent chooses: the parameters of a colony or a hive, and the range each rule gives them."""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antgym.errors import ParameterError
from antgym.planners.space import Parameter, ParameterSpace

KAPPA = (1e-3, 100.0)
"""Range of κ = Q / (straight line · τ₀), the only form in which Q acts (papers.md, liu2020 note 4)."""


class ColonyParameters(NamedTuple):
    """Parameters of an ant colony, natural values.

    Attributes:
        alpha: weight of the pheromone, ≥ 0.
        beta: weight of the heuristic, ≥ 0.
        rho: persistence of the pheromone per iteration, in (0, 1]: what stays, not what evaporates.
        Q: deposit constant, > 0, in world units of length × pheromone.
    """

    alpha: float
    beta: float
    rho: float
    Q: float


LIMITS = {"alpha": (0.0, 1e3), "beta": (0.0, 1e3), "rho": (1e-9, 1.0), "Q": (1e-12, 1e15)}
"""What the kernels can take, far wider than what is sensible."""


class ColonyRanges(NamedTuple):
    """Low, default and high of every parameter of one rule; Q's default is given as κ."""

    alpha: tuple[float, float, float]
    beta: tuple[float, float, float]
    rho: tuple[float, float, float]
    kappa: tuple[float, float, float]

    def space(self, straight_line: float, initial_pheromone: float = 1.0) -> ParameterSpace:
        """Return the space of natural values for a start and goal ``straight_line`` world units apart."""
        return _space(self, straight_line * initial_pheromone)


@lru_cache(maxsize=4096)  # a suite's scenarios come again and again
def _space(ranges: ColonyRanges, to_q: float) -> ParameterSpace:
    low, default, high = ranges.kappa
    return ParameterSpace(
        (
            Parameter("alpha", *ranges.alpha, "log", "weight of the pheromone"),
            Parameter("beta", *ranges.beta, "log", "weight of the heuristic"),
            Parameter("rho", *ranges.rho, "logit", "persistence of the pheromone per iteration"),
            Parameter("Q", to_q * low, to_q * default, to_q * high, "log", "deposit: Q / length per edge"),
        )
    )


def check_parameters(values: ArrayLike) -> NDArray[np.float64]:
    """Return (k, 4) float64 natural values in ColonyParameters order; ParameterError outside ``LIMITS``."""
    return _checked(np.atleast_2d(np.asarray(values, dtype=np.float64)), LIMITS)


class BeeParameters(NamedTuple):
    """Parameters of an artificial bee colony, natural values.

    Attributes:
        limit: tries in vain after which a source is abandoned, ≥ 1.
        xi_max: ξ of (12) in the first cycle, ≥ 0: the largest share by which a bee moves.
        xi_min: ξ in the last cycle, ≥ 0.
        tabu_radius: how far from a forbidden source, in world units over all coordinates of a path, a new one must
            lie, ≥ 0; without a tabu list it has no effect.
    """

    limit: float
    xi_max: float
    xi_min: float
    tabu_radius: float = 0.0


BEE_LIMITS = {"limit": (1.0, 1e12), "xi_max": (0.0, 1e3), "xi_min": (0.0, 1e3), "tabu_radius": (0.0, 1e12)}
"""What the kernel can take, far wider than what is sensible."""


class BeeRanges(NamedTuple):
    """Low, default and high of every parameter of one rule of bees.

    The limit is given over sources × dimensions, the tabu radius over the world's width × √dimensions, for a path of
    p way-points has 2·p dimensions. Two random paths lie 0.41 of that apart, give or take a tenth of it: the published
    radius, 0.005, forbids next to nothing; only the upper end of the range does. A few bees with a few way-points have
    limits from 1 on all the same.
    """

    limit: tuple[float, float, float] = (1 / 48, 1 / 12, 10.0)
    xi_max: tuple[float, float, float] = (0.2, 1.0, 4.0)
    xi_min: tuple[float, float, float] = (0.05, 1.0, 4.0)
    tabu_radius: tuple[float, float, float] = (0.0005, 1 / (40 * math.sqrt(24)), 0.5)

    def space(self, bees: int, points: int, width: float, tabu: bool = True) -> ParameterSpace:
        """Return the space of natural values for so many bees and way-points in a world so wide.

        Args:
            bees: bees of the run; half of them, rounded down, have a source.
            points: way-points of a path.
            width: the longer side of the world's bounds.
            tabu: whether the rule has a tabu list; without one, a setting has three numbers, and no radius.
        """
        return _bee_space(self, (bees // 2) * 2 * points, width * math.sqrt(2 * points), tabu)


_LEAST_LIMITS = (1.0, 1.5, 2.0)


@lru_cache(maxsize=4096)
def _bee_space(ranges: BeeRanges, tries: int, reach: float, tabu: bool) -> ParameterSpace:
    low, default, high = (max(tries * x, least) for x, least in zip(ranges.limit, _LEAST_LIMITS, strict=True))
    near, usual, far = (reach * x for x in ranges.tabu_radius)
    parameters = (
        Parameter("limit", low, default, high, "log", "tries in vain before a source is abandoned"),
        Parameter("xi_max", *ranges.xi_max, "log", "largest share of a move, first cycle"),
        Parameter("xi_min", *ranges.xi_min, "log", "largest share of a move, last cycle"),
        Parameter("tabu_radius", near, usual, far, "log", "distance to keep from abandoned sources"),
    )
    return ParameterSpace(parameters if tabu else parameters[:-1])


def check_bee_parameters(values: ArrayLike, tabu: bool = True) -> NDArray[np.float64]:
    """Return (k, 4) float64 natural values in BeeParameters order; ParameterError outside ``BEE_LIMITS``.

    Args:
        values: (k, 4), or (k, 3) without the radius where there is no tabu list.
        tabu: whether there is one.
    """
    array = np.atleast_2d(np.asarray(values, dtype=np.float64))
    if array.ndim == 2 and array.shape[1] == len(BEE_LIMITS) - 1 and not tabu:
        array = np.pad(array, ((0, 0), (0, 1)))
    return _checked(array, BEE_LIMITS)


def _checked(array: NDArray[np.float64], limits: dict[str, tuple[float, float]]) -> NDArray[np.float64]:
    if array.ndim != 2 or array.shape[1] != len(limits):
        raise ParameterError(f"parameters are {tuple(limits)} in this order, got shape {array.shape}")
    lowest, highest = np.array(list(limits.values())).T
    good = (array >= lowest) & (array <= highest)
    if not good.all():
        column, row = np.argwhere(~good.T)[0].tolist()
        name, (low, high) = list(limits.items())[column]
        value = array[row, column]
        reason = "not a number" if math.isnan(value) else f"outside [{low:g}, {high:g}]"
        raise ParameterError(f"{name} = {value:g} is {reason}")
    return array
