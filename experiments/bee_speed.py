"""How fast the bees are: CPU time per evaluated path, as a ratio to other codes that take turns in the same run.

    python -m experiments.bee_speed

The workload is 40 bees × 1,000 cycles over 12 way-points past 20 discs. The peers get our cost as a Python function, as
their users would write it; where a package is absent its row says so.
"""

from collections.abc import Callable
from dataclasses import dataclass
from statistics import median
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table
from rich.text import Text

from antgym.bench import Work, load_average, take_turns, threads
from antgym.console import main, parse
from antgym.errors import MissingExtraError, ParameterError
from antgym.maps.discs import DiscScenario
from antgym.maps.generators.discs import wu2018
from antgym.planners.bee_rules import BEE_PAPERS
from antgym.planners.planning import plan

BEES, CYCLES = 40, 1000
PEER_CYCLES = 10  # of a peer's turn: a whole run takes minutes


@dataclass(frozen=True)
class Arguments:
    """Measure the bees beside a plain numba port and peers."""

    repeats: int = 5
    """Turns of each code; the median counts."""
    peers: bool = True
    """Whether mealpy and beecolpy take part; they are slow."""


def standard_discs() -> DiscScenario:
    """Return the world of the workload: the 20 obstacles of wu2018."""
    return wu2018(np.random.default_rng(0), 20)


@numba.njit
def plain_cost(path: NDArray[np.float64], discs: NDArray[np.float64], safe: float, straight: float) -> float:
    """Return the sound cost of a path (points, 2): every segment against every disc."""
    length, low, hits = 0.0, np.inf, 0
    for j in range(path.shape[0] - 1):
        dx, dy = path[j + 1, 0] - path[j, 0], path[j + 1, 1] - path[j, 1]
        square = dx * dx + dy * dy
        length += np.sqrt(square)
        inverse = 1.0 / square if square > 0.0 else 0.0
        nearest = np.inf
        for i in range(discs.shape[0]):
            ux, uy = discs[i, 0] - path[j, 0], discs[i, 1] - path[j, 1]
            t = min(max((ux * dx + uy * dy) * inverse, 0.0), 1.0)
            nearest = min(nearest, np.sqrt((ux - t * dx) ** 2 + (uy - t * dy) ** 2) - discs[i, 2])
        low = min(low, nearest)
        hits += nearest <= 0.0
    return 0.5 * (length + max(safe - low, 0.0)) / straight + 5.0 * hits


@numba.njit
def plain_hive(
    discs: NDArray[np.float64],
    bounds: NDArray[np.float64],
    ends: NDArray[np.float64],
    safe: float,
    effort: tuple[int, int, int, float],
    seed: int,
) -> tuple[float, int]:
    """Fly Karaboga's standard colony as it is written down; return the least cost and the paths evaluated.

    Args:
        discs: (n, 3).
        bounds: x_min, x_max, y_min, y_max.
        ends: (2, 2) start and goal.
        safe: D_safe.
        effort: bees, cycles, way-points and limit.
        seed: of numba's own generator.
    """
    np.random.seed(seed)  # noqa: NPY002 - numba's generator inside compiled code
    bees, cycles, points, limit = effort
    count = bees // 2
    straight = np.hypot(ends[1, 0] - ends[0, 0], ends[1, 1] - ends[0, 1])
    paths, values, tries = np.empty((count, points + 2, 2)), np.empty(count), np.zeros(count)
    qualities, best, evaluated = np.empty(count), np.inf, 0
    for s in range(count):
        values[s] = -1.0
        tries[s] = limit
    for cycle in range(cycles + 1):
        for bee in range(bees if cycle > 0 else 0):
            s = bee
            if bee >= count:
                if bee == count:
                    for i in range(count):
                        qualities[i] = 1.0 / (1.0 + values[i])
                mark, s = np.random.random() * qualities.sum(), 0  # noqa: NPY002
                while mark >= qualities[s] and s < count - 1:
                    mark -= qualities[s]
                    s += 1
            j, axis = np.random.randint(points) + 1, np.random.randint(2)  # noqa: NPY002
            other = np.random.randint(count - 1)  # noqa: NPY002
            other += other >= s
            here, phi = paths[s, j, axis], np.random.uniform(-1.0, 1.0)  # noqa: NPY002
            moved = here + phi * (here - paths[other, j, axis])
            paths[s, j, axis] = min(max(moved, bounds[2 * axis]), bounds[2 * axis + 1])
            value = plain_cost(paths[s], discs, safe, straight)
            evaluated += 1
            if value < values[s]:
                values[s], tries[s] = value, 0
            else:
                paths[s, j, axis] = here
                tries[s] += 1
        if cycle > 0:
            best = min(best, values.min())
        worst = tries.argmax()
        for s in range(count):  # one scout a cycle; at first all of them
            if cycle == 0 or (s == worst and tries[s] >= limit):
                paths[s, 0], paths[s, -1] = ends[0], ends[1]
                for j in range(1, points + 1):
                    for axis in range(2):
                        low, high = bounds[2 * axis], bounds[2 * axis + 1]
                        paths[s, j, axis] = np.random.uniform(low, high)  # noqa: NPY002
                values[s], tries[s] = plain_cost(paths[s], discs, safe, straight), 0
                evaluated += 1
    return best, evaluated


def our_bees(name: str, scenario: DiscScenario) -> Work:
    """Return a turn of one rule at its published setting."""
    setting = BEE_PAPERS[name].space(BEES, scenario.world.width).default
    return lambda seed: plan(scenario, setting, rules=name, ants=BEES, iterations=CYCLES, seed=seed).moves


def plain_port(scenario: DiscScenario) -> Work:
    """Return a turn of the plain port."""
    world, ends = scenario.world, np.array([scenario.start, scenario.goal])
    arguments = (np.ascontiguousarray(world.grown), np.array(world.bounds), ends, world.safe_distance)
    return lambda seed: int(plain_hive(*arguments, (BEES, CYCLES, 12, 480.0), seed)[1])


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


def mealpy(scenario: DiscScenario) -> Work:
    """Return a turn of mealpy's standard ABC; MissingExtraError where it is absent."""
    try:
        from mealpy import ABC, FloatVar
    except ImportError:
        raise MissingExtraError("mealpy", "bench") from None
    x_min, x_max, y_min, y_max = scenario.world.bounds

    def work(seed: int) -> int:
        count = [0]
        problem = {
            "obj_func": _objective(scenario, count),
            "bounds": FloatVar(lb=[x_min, y_min] * 12, ub=[x_max, y_max] * 12),
            "minmax": "min",
            "log_to": None,
        }
        ABC.OriginalABC(epoch=PEER_CYCLES, pop_size=BEES // 2, n_limits=480).solve(problem, seed=seed)
        return count[0]

    return work


def beecolpy(scenario: DiscScenario) -> Work:
    """Return a turn of beecolpy's ABC; MissingExtraError where it is absent."""
    try:
        from beecolpy import abc
    except ImportError:
        raise MissingExtraError("beecolpy", "bench") from None
    x_min, x_max, y_min, y_max = scenario.world.bounds

    def work(seed: int) -> int:
        count = [0]
        limits = [(x_min, x_max), (y_min, y_max)] * 12
        colony = abc(_objective(scenario, count), limits, colony_size=BEES, iterations=PEER_CYCLES, seed=seed)
        colony.fit()
        return count[0]

    return work


def measure(repeats: int, peers: bool) -> list[dict[str, Any]]:
    """Let all codes take turns on one thread; return a row each: ns per path, ratio to ours, or why it is skipped."""
    scenario = standard_discs()
    works = {f"antgym, {name}": our_bees(name, scenario) for name in ("abc_standard", "wu2018")}
    works["plain numba port"] = plain_port(scenario)
    rows: list[dict[str, Any]] = []
    for name, prepare in (("mealpy", mealpy), ("beecolpy", beecolpy)) if peers else ():
        try:
            works[name] = prepare(scenario)
        except MissingExtraError as error:
            rows.append({"code": name, "ns_per_path": None, "ratio": None, "skipped": str(error)})
    with threads(1):
        turns = take_turns(works, repeats)
    ours = [turn.nanoseconds for turn in turns["antgym, abc_standard"]]
    for name in works:
        cost = [turn.nanoseconds for turn in turns[name]]
        ratio = median(other / own for other, own in zip(cost, ours, strict=True))
        rows.append(
            {"code": name, "ns_per_path": round(median(cost), 1), "ratio": round(ratio, 2), "skipped": None}
        )
    return rows


def run(arguments: Arguments) -> list[dict[str, Any]]:
    """Measure, print the table, return its rows."""
    if arguments.repeats < 1:
        raise ParameterError(f"repeats = {arguments.repeats}: at least one turn is needed")
    rows = measure(arguments.repeats, arguments.peers)
    table = Table(title=f"{BEES} bees x {CYCLES} cycles, one thread, load average {load_average()}")
    for heading in ("code", "ns/path", "ratio to ours", "note"):
        table.add_column(heading, justify="left" if heading in ("code", "note") else "right")
    for row in rows:
        numbers = ("–" if row[name] is None else f"{row[name]:,}" for name in ("ns_per_path", "ratio"))
        table.add_row(row["code"], *numbers, Text(row["skipped"] or ""))
    Console(width=None if Console().is_terminal else 120).print(table)
    return rows


def script() -> None:
    """Run the command line."""
    run(parse(Arguments, None, "python -m experiments.bee_speed"))


if __name__ == "__main__":
    main(script, interrupted="interrupted")
