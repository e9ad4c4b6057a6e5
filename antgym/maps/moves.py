"""Moves in a scenario: which are legal, which cells they can lead to, and where greed alone gets with them."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antgym.maps.motion import REACH, Motion, move_table, step_lengths
from antgym.maps.world import PAD, GridWorld, Scenario

ROUND_ABOUT = (
    1.5  # straight lines: how long a way from start to goal over a cell may be to count as within reach
)
PATIENCE = 4  # times the fewest moves: after that many, a greedy ant on a grid gives up


class Walk(NamedTuple):
    """The walk of a single ant.

    Attributes:
        arrived: whether it reached the goal.
        progress: share of the way that it closed, 1 where it arrived; of the layers under the layered motion, of
            the straight line elsewhere, measured where it came nearest to the goal.
        length: in world units.
    """

    arrived: bool
    progress: float
    length: float


class _Offsets(NamedTuple):
    """A move table in a flat storage: what it takes to get from one cell to another is one addition."""

    strides: NDArray[np.int64]  # (3,)
    steps: NDArray[np.int64]  # (k,)
    required: NDArray[np.int64]  # (r, k)
    either: NDArray[np.int64]  # (2, k), or (0, k) where it says no more than required does


@lru_cache(maxsize=64)
def _offsets(motion: Motion, storage_shape: tuple[int, ...]) -> _Offsets:
    table = move_table(motion)
    strides = np.array((storage_shape[1] * storage_shape[2], storage_shape[2], 1))
    either = (table.either @ strides).T
    says_more = (table.either != table.steps[:, None]).any()
    required = np.ascontiguousarray((table.required @ strides).T)
    return _Offsets(strides, table.steps @ strides, required, either if says_more else either[:0])


def legal_moves(scenario: Scenario, cells: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Return (n, k) bool: which moves of the motion rule are legal from which free cells.

    Args:
        scenario: the scenario; under the layered motion a move that loses the reach of its goal is not legal.
        cells: (n, 3) cell indices; under the layered motion from the start's layer up to, but not including, the
            goal's.
    """
    storage = scenario.world.storage
    offsets = _offsets(scenario.motion, storage.shape)
    base, flat = ((cells + PAD) @ offsets.strides)[:, None], storage.reshape(-1)
    legal = np.ones((len(cells), len(offsets.steps)), dtype=bool)
    for required in offsets.required:
        legal &= flat[base + required] != 0
    if len(offsets.either):
        legal &= (flat[base + offsets.either[0]] | flat[base + offsets.either[1]]) != 0
    if scenario.motion.layered:
        legal &= _keep_reach(scenario, cells)
    return legal


def mean_length(scenario: Scenario) -> float:
    """Return the mean length of all moves between the world's cells, wherever a layered goal lies; 0 without any."""
    table = move_table(scenario.motion)
    rows = zip(table.required, table.either, strict=True)
    counts = np.array([_count(scenario.world, required, either) for required, either in rows])
    return float((counts * step_lengths(scenario.motion, scenario.world.cell)).sum() / max(counts.sum(), 1))


def _count(world: GridWorld, required: NDArray[np.int64], either: NDArray[np.int64]) -> int:
    """Return from how many cells a move leads: all (r, 3) required and one of the (2, 3) either cells are free."""

    def beside(offset: NDArray[np.int64]) -> NDArray[np.bool_]:
        window = (slice(PAD + d, PAD + d + n) for d, n in zip(offset.tolist(), world.shape, strict=True))
        return world.storage[tuple(window)] != 0

    legal = (world.free != 0) & (beside(either[0]) | beside(either[1]))
    for offset in required:
        legal &= beside(offset)
    return int(np.count_nonzero(legal))


def _keep_reach(scenario: Scenario, cells: NDArray[np.int64]) -> NDArray[np.bool_]:
    steps = move_table(scenario.motion).steps
    _, y, z = (cells - scenario.goal).T[:, :, None]
    left = REACH * (scenario.goal[0] - cells[:, :1] - 1)
    return (np.abs(y + steps[:, 1]) <= left) & (np.abs(z + steps[:, 2]) <= left)


def within_reach(scenario: Scenario) -> NDArray[np.bool_]:
    """Return the cells between start and goal, obstacles ignored.

    Returns:
        Under the layered motion (layers + 1, ny, nz) bool: cells on some path if nothing were blocked. Under any
        other (nx, ny, nz) bool: cells over which the way is at most 1.5 straight lines long, an ellipsoid.
    """
    if not scenario.motion.layered:
        over = _distances(scenario, scenario.start) + _distances(scenario, scenario.goal)
        return np.asarray(over <= ROUND_ABOUT * scenario.straight_line)
    layer = np.arange(scenario.layers + 1)[:, None]
    sides = []
    for axis in (1, 2):
        cells = np.arange(scenario.world.shape[axis])
        from_start = np.abs(cells - scenario.start[axis]) <= REACH * layer
        to_goal = np.abs(cells - scenario.goal[axis]) <= REACH * layer[::-1]
        sides.append(from_start & to_goal)
    return sides[0][:, :, None] & sides[1][:, None, :]


def _distances(scenario: Scenario, end: tuple[int, int, int]) -> NDArray[np.float64]:
    """Return (nx, ny, nz) float64, the Euclidean distance of every cell from one of them in world units."""
    world = scenario.world
    squares = [
        ((np.arange(n) - at) * edge) ** 2 for n, at, edge in zip(world.shape, end, world.cell, strict=True)
    ]
    total = squares[0][:, None, None] + squares[1][:, None] + squares[2]
    return np.sqrt(total, out=total)


def fewest_moves(scenario: Scenario) -> int:
    """Return how many moves lead from start to goal if nothing is blocked, at least 1."""
    apart = np.abs(np.subtract(scenario.goal, scenario.start))
    if scenario.motion.layered:
        return scenario.layers
    return int(apart.sum() if scenario.motion.name == "grid4" else apart.max())


def greedy_walk(scenario: Scenario) -> Walk:
    """Walk as an ant that takes the legal move of the shortest step + distance to the goal, never to a cell twice.

    It stops where no such move is left and, on a grid, after four times the fewest moves; the first of equally
    good moves is taken.
    """
    steps = move_table(scenario.motion).steps
    lengths = step_lengths(scenario.motion, scenario.world.cell)
    offsets = _offsets(scenario.motion, scenario.world.storage.shape)
    goal, edges = np.array(scenario.goal), np.array(scenario.world.cell)
    cell, length, nearest = np.array(scenario.start), 0.0, scenario.straight_line
    visited = np.zeros(scenario.world.storage.size, dtype=bool)
    layered, fewest = scenario.motion.layered, fewest_moves(scenario)
    made = 0
    while nearest > 0 and made < PATIENCE * fewest:
        at = (cell + PAD) @ offsets.strides
        visited[at] = True
        legal = legal_moves(scenario, cell[None])[0] & ~visited[at + offsets.steps]
        if not legal.any():
            break
        left = (cell + steps - goal) * edges
        to_goal = np.sqrt((left * left).sum(axis=1))
        move = np.where(legal, lengths + to_goal, np.inf).argmin()
        cell, length, made = cell + steps[move], length + lengths[move], made + 1
        nearest = min(nearest, float(to_goal[move]))
    progress = made / fewest if layered else 1 - nearest / scenario.straight_line
    return Walk(nearest == 0, progress, float(length))
