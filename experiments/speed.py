"""How fast the planner is: CPU time per ant move, as a ratio to a plain port measured in the same run.

    python -m experiments.speed

These machines are shared: a figure alone says little, a ratio of two codes that take turns says more.
"""

import hashlib
import inspect
import json
import os
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Annotated, Any, NamedTuple

import numba
import numpy as np
import tyro
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from antgym.maps.motion import move_table
from antgym.maps.shaping import voxelise
from antgym.maps.world import Scenario
from antgym.planners.colony import plan
from antgym.planners.rules import Rules
from antgym.console import main

PARAMETERS = (1.0, 5.0, 0.9, 100.0)


class Workload(NamedTuple):
    """One size of the standard plan: 21 × 21 × 21 mountains, η = 1 / (step + distance to the goal)."""

    name: str
    ants: int
    iterations: int
    q0: float


WORKLOADS = (
    Workload("20x100", 20, 100, 0.0),
    Workload("30x150", 30, 150, 0.0),
    Workload("50x200", 50, 200, 0.0),
    Workload("50x200 q0=.5", 50, 200, 0.5),
)
GATE = "20x100"


@dataclass(frozen=True)
class Arguments:
    """Measure the planner beside a plain numba port of the same equations."""

    repeats: int = 9
    """Turns of each code; the median counts."""
    out: Annotated[Path | None, tyro.conf.arg(name="json")] = None
    """File to write the figures to."""


def standard_scenario(size: int = 21) -> Scenario:
    """Return open mountains: four peaks between start and goal, air above them."""
    x, y = np.mgrid[0:size, 0:size] * (20 / (size - 1))
    peaks = ((14, 6, 6, 12), (12, 14, 12, 14), (10, 10, 16, 10), (13, 16, 4, 12))
    heights = sum(h * np.exp(-((x - px) ** 2 + (y - py) ** 2) / w) for h, px, py, w in peaks)
    world = voxelise(np.asarray(heights) * 15.0 * (size - 1) / 20, size, (15.0, 15.0, 15.0))
    middle = size // 2
    start, goal = ((i, middle, int(world.free[i, middle].argmax())) for i in (0, size - 1))
    return Scenario(world, start, goal, name="standard")


@numba.njit
def plain_colony(
    free: NDArray[np.uint8],
    crossed: NDArray[np.int64],
    start: NDArray[np.int64],
    goal: NDArray[np.int64],
    cell: float,
    parameters: tuple[float, float, float, float],
    ants: int,
    iterations: int,
    seed: int,
) -> tuple[float, int]:
    """Walk liu2020's equations as they are printed: 50 powers a move, all pheromone swept every iteration."""
    np.random.seed(seed)  # noqa: NPY002 - numba's generator inside compiled code
    alpha, beta, rho, q = parameters
    nx, ny, nz = free.shape
    tau = np.ones((nx, ny, nz, 25))
    layers = goal[0] - start[0]
    weights = np.empty(25)
    paths = np.empty((ants, layers, 3), np.int64)
    best, moves = np.inf, 0
    for _ in range(iterations):
        lengths = np.full(ants, np.inf)
        for a in range(ants):
            x, y, z = start[0], start[1], start[2]
            length = 0.0
            for layer in range(layers):
                total = 0.0
                for k in range(25):
                    yn, zn = y + crossed[2, k, 1], z + crossed[2, k, 2]
                    left = 2 * (layers - layer - 1)
                    feasible = 0.0  # S of (6)
                    reachable = abs(yn - goal[1]) <= left and abs(zn - goal[2]) <= left
                    if reachable and 0 <= yn < ny and 0 <= zn < nz:
                        feasible = 1.0
                        for part in range(3):
                            dx, dy, dz = crossed[part, k, 0], crossed[part, k, 1], crossed[part, k, 2]
                            feasible *= free[x + dx, y + dy, z + dz]
                    step = cell * np.sqrt(1.0 + (yn - y) ** 2 + (zn - z) ** 2)
                    far = (goal[0] - x - 1) ** 2 + (goal[1] - yn) ** 2 + (goal[2] - zn) ** 2
                    eta = feasible / (step + cell * np.sqrt(far))
                    weights[k] = tau[x, y, z, k] ** alpha * eta**beta
                    total += weights[k]
                if total == 0.0:
                    length = np.inf
                    break
                mark, k = np.random.random() * total, 0  # noqa: NPY002
                mark -= weights[0]
                while mark >= 0.0 and k < 24:
                    k += 1
                    mark -= weights[k]
                paths[a, layer] = (y, z, k)
                yn, zn = y + crossed[2, k, 1], z + crossed[2, k, 2]
                length += cell * np.sqrt(1.0 + (yn - y) ** 2 + (zn - z) ** 2)
                x, y, z = x + 1, yn, zn
                moves += 1
            lengths[a] = length
            best = min(best, length)
        tau *= rho
        for a in range(ants):
            if lengths[a] < np.inf:
                for layer in range(layers):
                    y, z, k = paths[a, layer]
                    tau[start[0] + layer, y, z, k] += q / lengths[a]
    return best, moves


def _plain(scenario: Scenario, workload: Workload, seed: int) -> int:
    table = move_table(scenario.motion)
    crossed = np.stack([table.before, table.after, table.steps])
    ends = (np.array(scenario.start), np.array(scenario.goal))
    free = np.ascontiguousarray(scenario.world.free)
    effort = (workload.ants, workload.iterations, seed)
    return int(plain_colony(free, crossed, *ends, scenario.world.cell[0], PARAMETERS, *effort)[1])


def _ours(scenario: Scenario, workload: Workload, seed: int) -> int:
    rules = Rules(w1=1.0, w2=0.0, q0=workload.q0)
    done = plan(
        scenario, PARAMETERS, rules=rules, ants=workload.ants, iterations=workload.iterations, seed=seed
    )
    return done.moves


def _nanoseconds(work: Callable[[int], int], seed: int) -> float:
    begun = time.process_time()
    moves = work(seed)
    return (time.process_time() - begun) / moves * 1e9


def measure(workload: Workload, repeats: int) -> dict[str, Any]:
    """Let both codes take turns; return CPU nanoseconds per move, the ratio turn by turn, and plans per second."""
    scenario = standard_scenario()
    codes: tuple[Callable[[int], int], ...] = (
        lambda seed: _ours(scenario, workload, seed),
        lambda seed: _plain(scenario, workload, seed),
    )
    moves = [work(0) for work in codes]  # compiles
    turns = [[_nanoseconds(work, seed) for work in codes] for seed in range(1, repeats + 1)]
    ours, plain = (median(column) for column in zip(*turns, strict=True))
    return {
        "workload": workload.name,
        "ours_ns": round(ours, 1),
        "plain_ns": round(plain, 1),
        "ratio": round(median(plain / ours for ours, plain in turns), 2),
        "plans_per_second": round(1e9 / (ours * moves[0])),
    }


def run(arguments: Arguments) -> None:
    """Measure every workload, print the table, write the JSON."""
    os.environ["ANTGYM_THREADS"] = "1"
    rows = [measure(workload, arguments.repeats) for workload in WORKLOADS]
    source = inspect.getsource(plain_colony.py_func)
    digest = hashlib.sha256(source.encode()).hexdigest()[:16]
    table = Table(title=f"CPU time per ant move, one core, {arguments.repeats} turns (plain port {digest})")
    for heading in ("ants x iterations", "antgym ns", "plain port ns", "ratio", "plans/s"):
        table.add_column(heading, justify="right")
    for row in rows:
        table.add_row(*(str(value) for value in row.values()))
    Console().print(table)
    if arguments.out is not None:
        arguments.out.write_text(json.dumps({"plain_port": digest, "rows": rows}, indent=2) + "\n")


if __name__ == "__main__":
    main(lambda: run(tyro.cli(Arguments)))
