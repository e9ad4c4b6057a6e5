"""Codes that take turns with ours: a plain numpy colony, exact planners, and peers from the package index.

Every entry takes a workload and returns the turn that is timed; what is built once (a graph, a grid) is built before
the clock starts. Numba is not imported here, so that a child process which measures memory does not hold it.
"""

import json
import random
import subprocess
import sys
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from antgym.bench import PARAMETERS, Work, Workload
from antgym.errors import MissingExtraError
from antgym.maps.motion import REACH, move_table, step_lengths
from antgym.maps.world import PAD, Scenario

ROOT = Path(__file__).parents[1]


class Code(NamedTuple):
    """A code under comparison.

    Attributes:
        name: as the tables show it.
        entry: ``"module:function"``; the function takes a workload and returns a turn.
        moves: whether it walks ants or flies bees, so that time per move, or path, means something.
        part: a turn walks one ``part``-th of the iterations, because a whole plan takes too long.
        worlds: of the workloads that it can take.
        note: where its question is not ours.
    """

    name: str
    entry: str
    moves: bool = True
    part: int = 1
    worlds: tuple[str, ...] = ("mountains",)
    note: str = ""

    def takes(self, workload: Workload) -> bool:
        """Whether it can plan this workload."""
        return workload.world in self.worlds

    def prepare(self, workload: Workload) -> Work:
        """Return the turn; MissingExtraError where the package is absent."""
        return self._function()(workload._replace(iterations=self.iterations(workload)))

    def iterations(self, workload: Workload) -> int:
        """Iterations of one turn."""
        return max(1, workload.iterations // self.part)

    def _function(self) -> Callable[[Workload], Work]:
        module, name = self.entry.split(":")
        return cast(Callable[[Workload], Work], getattr(import_module(module), name))


DRAWS = "draws every move, whatever q0"
ALL = ("mountains", "plane", "discs")

CODES = (
    Code("antgym", "antgym.bench:our_planner", worlds=ALL),
    Code("plain numba port", "experiments.ports:colony_port", note=DRAWS),
    Code("numpy, ants vectorised", "experiments.rivals:numpy_colony", part=10, note=DRAWS),
    Code(
        "aco-routing 1.2.1",
        "experiments.rivals:aco_routing",
        part=50,
        note="same graph and parameters; its heuristic sees the step alone, evaporation only where it deposits",
    ),
    Code(
        "python-motion-planning 1.1.1",
        "experiments.rivals:python_motion_planning",
        part=10,
        worlds=("plane",),
        note="same plane, effort and parameters",
    ),
    Code("antgym, wu2018", "experiments.bee_rivals:tabu_bees", worlds=("discs",), note="tabu colony"),
    Code("plain numba port", "experiments.ports:hive_port", worlds=("discs",), note="all segments, always"),
    Code("mealpy", "experiments.bee_rivals:mealpy", part=100, worlds=("discs",), note="our cost, in numpy"),
    Code(
        "beecolpy", "experiments.bee_rivals:beecolpy", part=100, worlds=("discs",), note="our cost, in numpy"
    ),
    Code("exact: ours", "antgym.bench:our_optimum", moves=False, worlds=ALL),
    Code("exact: scipy Dijkstra", "experiments.rivals:dijkstra", moves=False, note="the graph is given"),
)


def numpy_colony(workload: Workload) -> Work:
    """Walk liu2020's equations with all ants of a layer in one array operation."""
    scenario = workload.scenario()
    return lambda seed: _numpy_colony(scenario, workload, np.random.default_rng(seed))


def _numpy_colony(scenario: Scenario, workload: Workload, rng: np.random.Generator) -> int:
    alpha, beta, rho, q = PARAMETERS
    table, edges = move_table(scenario.motion), step_lengths(scenario.motion, scenario.world.cell)
    free, (cell, *_), layers, ants = (
        scenario.world.storage[PAD:],
        scenario.world.cell,
        scenario.layers,
        workload.ants,
    )
    tau = np.ones((layers, *free.shape[1:], len(edges)))
    goal, moves = np.array(scenario.goal[1:]) + PAD, 0
    for _ in range(workload.iterations):
        trail = np.empty((layers, ants, 3), np.int64)
        lengths, at = np.zeros(ants), np.tile(np.array(scenario.start[1:]) + PAD, (ants, 1))
        for layer in range(layers):
            x, alive = scenario.start[0] + layer, np.isfinite(lengths)
            there, left = at[:, None] + table.steps[:, 1:], layers - layer - 1
            possible = (np.abs(there - goal) <= REACH * left).all(axis=2) & alive[:, None]
            for crossed in (table.before, table.after, table.steps):
                y, z = (at[:, None] + crossed[:, 1:]).transpose(2, 0, 1)
                possible &= free[x + crossed[:, 0], y, z] == 1
            eta = possible / (edges + cell * np.sqrt(left**2 + ((there - goal) ** 2).sum(axis=2)))
            weights = (tau[layer, at[:, 0], at[:, 1]] ** alpha * eta**beta).cumsum(axis=1)
            k = (weights <= rng.random((ants, 1)) * weights[:, -1:]).sum(axis=1)
            lengths[weights[:, -1] == 0] = np.inf
            alive, k = np.isfinite(lengths), np.minimum(k, len(edges) - 1)
            trail[layer] = np.column_stack([at, k])
            at = np.where(alive[:, None], at + table.steps[k, 1:], at)
            lengths += edges[k]
            moves += int(alive.sum())
        tau *= rho
        arrived = np.flatnonzero(np.isfinite(lengths))
        y, z, k = trail[:, arrived].transpose(2, 0, 1)
        np.add.at(tau, (np.arange(layers)[:, None], y, z, k), q / lengths[arrived])
    return moves


def layered_graph(scenario: Scenario) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]:
    """Return every legal move as (from, to, length); a node is a cell's index in ``world.free``."""
    table, edges = move_table(scenario.motion), step_lengths(scenario.motion, scenario.world.cell)
    storage, shape = scenario.world.storage, scenario.world.shape
    cells = np.argwhere(scenario.world.free[:-1])
    nodes = np.asarray(np.ravel_multi_index(cells.T, shape))
    found = []
    for k, edge in enumerate(edges):
        legal = np.ones(len(cells), bool)
        for crossed in (table.before[k], table.after[k], table.steps[k]):
            legal &= storage[tuple((cells + crossed + PAD).T)] == 1
        targets = np.asarray(np.ravel_multi_index((cells[legal] + table.steps[k]).T, shape))
        found.append((nodes[legal], targets, np.full(len(targets), edge)))
    sources, ends, lengths = zip(*found, strict=True)
    return np.concatenate(sources), np.concatenate(ends), np.concatenate(lengths)


def dijkstra(workload: Workload) -> Work:
    """Solve the layered graph with scipy's Dijkstra from the start."""
    from scipy.sparse import csgraph, csr_array

    scenario = workload.scenario()
    sources, targets, lengths = layered_graph(scenario)
    count = scenario.world.free.size
    graph = csr_array((lengths, (sources, targets)), shape=(count, count))
    start = int(np.ravel_multi_index(scenario.start, scenario.world.shape))

    def work(_: int) -> int:
        csgraph.dijkstra(graph, indices=start)
        return 1

    return work


def aco_routing(workload: Workload) -> Work:
    """Let aco-routing's ants walk the layered graph; MissingExtraError where it is absent."""
    try:
        import networkx
        from aco_routing import ACO
    except ImportError:
        raise MissingExtraError("aco-routing", "bench") from None
    scenario = workload.scenario()
    ends = [int(np.ravel_multi_index(cell, scenario.world.shape)) for cell in (scenario.start, scenario.goal)]
    edges = [(str(i), str(j), {"cost": c}) for i, j, c in np.column_stack(layered_graph(scenario)).tolist()]
    names = [str(float(end)) for end in ends]
    alpha, beta, rho, _ = PARAMETERS
    # built once, as that takes longer than a turn: its pheromone stays, and time per move does not depend on it
    colony = ACO(networkx.DiGraph(edges), scenario.layers, 1, False, 1 - rho, alpha, beta)

    def work(seed: int) -> int:
        random.seed(seed)
        moves = 0
        for _ in range(workload.iterations):  # its ants of an iteration are gone when the next begins
            colony._deploy_search_ants(*names, workload.ants)
            moves += sum(len(ant.path) - 1 for ant in colony.search_ants)
        return moves

    return work


def python_motion_planning(workload: Workload) -> Work:
    """Plan the plane with python-motion-planning's ants; MissingExtraError where it is absent."""
    try:
        import matplotlib as mpl

        mpl.use("Agg")
        import python_motion_planning as peer
    except ImportError:
        raise MissingExtraError("python-motion-planning", "bench") from None
    alpha, beta, rho, q = PARAMETERS
    scenario = workload.scenario()
    nx, ny, _ = scenario.world.shape
    grid = peer.Grid(nx + 2, ny + 2)  # it has a border of its own
    blocked = np.argwhere(scenario.world.free[:, :, 0] == 0) + 1
    ends = tuple((x + 1, y + 1) for x, y, _ in (scenario.start, scenario.goal))
    grid.update(grid.obstacles | {(x, y) for x, y in blocked.tolist()})
    effort = {"n_ants": workload.ants, "max_iter": workload.iterations}
    planner = peer.ACO(*ends, grid, alpha=alpha, beta=beta, rho=1 - rho, Q=q, **effort)
    made: list[Any] = []

    class CountedAnt(planner.Ant):  # type: ignore[name-defined]
        """An ant that can be asked for its moves afterwards."""

        def __init__(self) -> None:
            super().__init__()
            made.append(self)

    planner.Ant = CountedAnt

    def work(seed: int) -> int:
        random.seed(seed)
        made.clear()
        planner.plan()
        return sum(ant.steps + ant.found_goal for ant in made)

    return work


def peak_megabytes(code: Code | None, workload: Workload) -> float:
    """Return the peak resident memory of a fresh process that does one turn, or only imports what all share."""
    script = f"from experiments.rivals import _peak; _peak({CODES.index(code) if code else None}, {tuple(workload)})"
    done = subprocess.run(
        [sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, check=True
    )
    return float(json.loads(done.stdout.splitlines()[-1]))


def _peak(index: int | None, workload: tuple[Any, ...]) -> None:
    if index is not None:
        CODES[index].prepare(Workload(*workload))(1)
    print(json.dumps(resident_megabytes()))


def resident_megabytes() -> float:
    """Return the peak resident memory of this process."""
    status = Path("/proc/self/status")
    if status.exists():  # ru_maxrss would count the parent that this process was forked from
        kilobytes = next(int(line.split()[1]) for line in status.open() if line.startswith("VmHWM"))
    else:
        import resource

        kilobytes = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024  # macOS counts bytes
    return kilobytes / 1024
