"""What an agent chooses: the four parameters of a colony, and the range each rule gives them."""

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
_LOWEST, _HIGHEST = np.array(list(LIMITS.values())).T


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
    array = np.atleast_2d(np.asarray(values, dtype=np.float64))
    if array.ndim != 2 or array.shape[1] != len(LIMITS):
        raise ParameterError(f"parameters are {tuple(LIMITS)} in this order, got shape {array.shape}")
    good = (array >= _LOWEST) & (array <= _HIGHEST)
    if not good.all():
        column, row = np.argwhere(~good.T)[0].tolist()
        name, (low, high) = list(LIMITS.items())[column]
        value = array[row, column]
        reason = "not a number" if math.isnan(value) else f"outside [{low:g}, {high:g}]"
        raise ParameterError(f"{name} = {value:g} is {reason}")
    return array
