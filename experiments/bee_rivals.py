"""Codes that take turns with our bees: our tabu colony, and the standard colonies of two packages.

Numba is not imported here, so that a child process which measures memory does not hold it. The packages get our cost as
a Python function, as their users would write it.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from antgym.bench import Work, Workload
from antgym.errors import MissingExtraError
from antgym.maps.discs import DiscScenario
from antgym.planners.bee_rules import BEE_PAPERS


def tabu_bees(workload: Workload) -> Work:
    """Return a turn of our wu2018 at its published setting."""
    from antgym.planners.planning import plan

    scenario, effort = workload.scenario(), {"ants": workload.ants, "iterations": workload.iterations}
    setting = BEE_PAPERS["wu2018"].space(workload.ants, scenario.world.width).default
    return lambda seed: plan(scenario, setting, rules="wu2018", seed=seed, **effort).moves


def _objective(scenario: DiscScenario, count: list[int]) -> Callable[[Any], float]:
    """Return the same cost as a function of 24 numbers, in numpy; it counts its calls."""
    world, straight = scenario.world, scenario.straight_line
    ends = np.array([scenario.start]), np.array([scenario.goal])

    def cost(solution: Any) -> float:
        count[0] += 1
        path = np.concatenate([ends[0], np.reshape(solution, (12, 2)), ends[1]])
        gaps = world.clearances(path)
        length = np.hypot(*np.diff(path, axis=0).T).sum()
        shortfall = max(world.safe_distance - gaps.min(), 0.0)
        return float(0.5 * (length + shortfall) / straight + 5.0 * (gaps <= 0).sum())

    return cost


def mealpy(workload: Workload) -> Work:
    """Return a turn of mealpy's standard ABC; MissingExtraError where it is absent."""
    try:
        from mealpy import ABC, FloatVar
    except ImportError:
        raise MissingExtraError("mealpy", "bench") from None
    scenario: DiscScenario = workload.scenario()
    x_min, x_max, y_min, y_max = scenario.world.bounds
    limit = int(workload.parameters[0])

    def work(seed: int) -> int:
        count = [0]
        problem = {
            "obj_func": _objective(scenario, count),
            "bounds": FloatVar(lb=[x_min, y_min] * 12, ub=[x_max, y_max] * 12),
            "minmax": "min",
            "log_to": None,
        }
        size, cycles = workload.ants // 2, workload.iterations
        ABC.OriginalABC(epoch=cycles, pop_size=size, n_limits=limit).solve(problem, seed=seed)
        return count[0]

    return work


def beecolpy(workload: Workload) -> Work:
    """Return a turn of beecolpy's ABC; MissingExtraError where it is absent."""
    try:
        from beecolpy import abc
    except ImportError:
        raise MissingExtraError("beecolpy", "bench") from None
    scenario: DiscScenario = workload.scenario()
    x_min, x_max, y_min, y_max = scenario.world.bounds

    def work(seed: int) -> int:
        count = [0]
        effort = {"colony_size": workload.ants, "iterations": workload.iterations}
        limits = [(x_min, x_max), (y_min, y_max)] * 12
        colony = abc(_objective(scenario, count), limits, seed=seed, **effort)
        colony.fit()
        return count[0]

    return work
