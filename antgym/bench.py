"""How fast the planner is: the standard workloads, and the clock that every code under comparison is given.

``antgym bench`` prints the short version; ``experiments/speed.py`` lets other codes take turns with ours. These
machines are shared: a figure alone says little, a ratio of two codes that take turns says more.
"""

import os
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from statistics import median
from typing import Any, NamedTuple

import numpy as np

from antgym.errors import ParameterError, nearest
from antgym.maps.generators.discs import wu2018
from antgym.maps.motion import Motion
from antgym.maps.shaping import voxelise
from antgym.maps.world import GridWorld, Scenario
from antgym.planners.bee_rules import BEE_PAPERS, BeeRules
from antgym.planners.rules import Rules

BLOCKED, PLANE_SEED = 0.25, 1  # of the plane; this one has a way through
PARAMETERS = (1.0, 5.0, 0.9, 100.0)
"""α, β, ρ and Q of every workload of ants."""
BEES = "abc_standard"

Work = Callable[[int], int]
"""One timed turn: takes a seed, returns how many moves its ants made or paths its bees evaluated (1 without either)."""


class Workload(NamedTuple):
    """One plan over the standard mountains or the standard plane, η = 1 / (step + distance to the goal), or past discs.

    Attributes:
        name: how tables and ``--workload`` call it.
        ants, iterations: effort; of bees, how many and their cycles.
        q0: probability of the greedy move.
        size: cells along y and z; along x and y of a plane; how many discs.
        layers: moves of a path; by default ``size - 1``, a cube.
        world: ``"mountains"``; ``"plane"``, eight neighbours and a tabu list; or ``"discs"``, the obstacles of wu2018,
            past which bees fly as Karaboga's standard colony.
    """

    name: str
    ants: int
    iterations: int
    q0: float = 0.0
    size: int = 21
    layers: int | None = None
    world: str = "mountains"

    @property
    def rules(self) -> Rules | BeeRules:
        """The rules of this workload."""
        return BEE_PAPERS[BEES] if self.world == "discs" else Rules(w1=1.0, w2=0.0, q0=self.q0)

    @property
    def parameters(self) -> tuple[float, ...]:
        """What the planner goes by: ``PARAMETERS``; of bees the published limit and ξ."""
        if self.world == "discs":
            return tuple(BEE_PAPERS[BEES].space(self.ants, 1.0).default.tolist())  # no radius, so no width
        return PARAMETERS

    def scenario(self) -> Scenario[Any, Any]:
        """Return the world of this workload."""
        if self.world == "discs":
            return wu2018(np.random.default_rng(0), self.size)
        return (
            standard_plane(self.size) if self.world == "plane" else standard_scenario(self.size, self.layers)
        )


WORKLOADS = (
    Workload("20x100", 20, 100),
    Workload("30x150", 30, 150),
    Workload("50x200", 50, 200),
    Workload("50x200-greedy", 50, 200, q0=0.5),
    Workload("plane-50x100", 50, 100, size=20, world="plane"),
    Workload("bees", 40, 1000, size=20, world="discs"),
)
TINY = Workload("tiny", 3, 4, size=9)
"""For trying things out; no table shows it unless asked."""


def find_workloads(names: "tuple[str, ...]") -> tuple[Workload, ...]:
    """Return workloads by name, all of the standard ones for no name; ParameterError names what is unknown."""
    known = {workload.name: workload for workload in (*WORKLOADS, TINY)}
    for name in names:
        if name not in known:
            raise ParameterError(f"unknown workload {name!r}; {nearest(name, tuple(known))}")
    return tuple(known[name] for name in names) or WORKLOADS


def standard_scenario(size: int = 21, layers: int | None = None) -> Scenario:
    """Return open mountains: four peaks between start and goal, air above them.

    Args:
        size: cells along y and z, at least 5.
        layers: moves from start to goal, at least 1; ``size - 1`` by default. More of them stretch the mountains.
    """
    length = size if layers is None else layers + 1
    x, y = np.mgrid[0:length, 0:size] * (20 / np.array([length - 1, size - 1]))[:, None, None]
    peaks = ((14, 6, 6, 12), (12, 14, 12, 14), (10, 10, 16, 10), (13, 16, 4, 12))
    heights = sum(h * np.exp(-((x - px) ** 2 + (y - py) ** 2) / w) for h, px, py, w in peaks)
    world = voxelise(np.asarray(heights) * 15.0 * (size - 1) / 20, size, (15.0, 15.0, 15.0))
    middle = size // 2
    start, goal = ((i, middle, int(world.free[i, middle].argmax())) for i in (0, length - 1))
    return Scenario(world, start, goal, name="standard")


def standard_plane(side: int = 20) -> Scenario:
    """Return a plane of side x side cells, a quarter of them blocked at random, from one corner to the other."""
    free = np.random.default_rng(PLANE_SEED).random((side, side)) >= BLOCKED
    free[0, 0] = free[-1, -1] = True
    return Scenario(GridWorld(free), (0, 0, 0), (side - 1, side - 1, 0), Motion("grid8"), name="plane")


def vast_scenario(size: int = 512, boxes: int = 200) -> Scenario:
    """Return a cube of size cells a side with boxes in it: what a planner meets whose memory grows with the world."""
    rng = np.random.default_rng(PLANE_SEED)
    free = np.ones((size, size, size), np.uint8)
    for _ in range(boxes):
        low = rng.integers(1, size - size // 12, 3)
        x, y, z = (slice(first, first + int(rng.integers(size // 50 + 1, size // 12))) for first in low)
        free[x, y, z] = 0
    free[-1] = 1
    middle = size // 2
    free[0] = 1
    return Scenario(GridWorld(free), (0, middle, middle), (size - 1, middle, middle), name="vast")


def our_planner(workload: Workload) -> Work:
    """Return a turn of antgym's own planner."""
    from antgym.planners.planning import plan  # brings numba, which the memory of another code must not count

    scenario, setting = workload.scenario(), workload.parameters
    effort: dict[str, Any] = {
        "rules": workload.rules,
        "ants": workload.ants,
        "iterations": workload.iterations,
    }
    return lambda seed: plan(scenario, setting, seed=seed, **effort).moves


def our_optimum(workload: Workload) -> Work:
    """Return a turn of the exact planner: dynamic programming over layers, A* on a plane, tangents past discs."""
    from antgym.maps.optimum import shortest_length

    scenario = workload.scenario()

    def work(_: int) -> int:
        shortest_length(scenario)
        return 1

    return work


class Turn(NamedTuple):
    """CPU seconds of one turn and the moves it made."""

    seconds: float
    moves: int

    @property
    def nanoseconds(self) -> float:
        """CPU nanoseconds per move."""
        return self.seconds / self.moves * 1e9


def take_turns(codes: Mapping[str, Work], repeats: int, least: float = 0.0) -> dict[str, list[Turn]]:
    """Time codes in turn, ``repeats`` turns each after one that compiles and does not count.

    Args:
        codes: a turn each, by name.
        repeats: turns, at least 1.
        least: CPU seconds a turn lasts at least; a short work is done several times over, with other seeds.
    """
    for work in codes.values():
        work(0)
    turns: dict[str, list[Turn]] = {name: [] for name in codes}
    for seed in range(1, repeats + 1):
        for name, work in codes.items():
            turns[name].append(_turn(work, 1_000 * seed, least))
    return turns


def _turn(work: Work, seed: int, least: float) -> Turn:
    moves, begun = 0, time.process_time()
    while True:
        moves += work(seed)
        spent = time.process_time() - begun
        if spent > least:
            return Turn(spent, moves)
        seed += 1


@contextmanager
def threads(count: int) -> Iterator[None]:
    """Let the planner use ``count`` threads inside the block."""
    before = os.environ.get("ANTGYM_THREADS")
    os.environ["ANTGYM_THREADS"] = str(count)
    try:
        yield
    finally:
        if before is None:
            del os.environ["ANTGYM_THREADS"]
        else:
            os.environ["ANTGYM_THREADS"] = before


def measure(workload: Workload, repeats: int) -> dict[str, Any]:
    """Return one row of ``antgym bench``: medians over ``repeats`` turns on one thread."""
    codes = {"antgym": our_planner(workload), "exact": our_optimum(workload)}
    with threads(1):
        turns = take_turns(codes, repeats, least=0.02)
        moves = codes["antgym"](1)
    nanoseconds = median(turn.nanoseconds for turn in turns["antgym"])
    return {
        "workload": workload.name,
        "ns_per_move": round(nanoseconds, 1),
        "plans_per_second": round(1e9 / (nanoseconds * moves), 1),
        "exact_plans_per_second": round(1e9 / median(turn.nanoseconds for turn in turns["exact"]), 1),
    }


def load_average() -> float | None:
    """Return the machine's load over the last minute, None where it is not told."""
    return round(os.getloadavg()[0], 2) if hasattr(os, "getloadavg") else None
