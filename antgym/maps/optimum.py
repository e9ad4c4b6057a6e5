"""The exact optimum of a scenario under its own motion rule.

Lengths are float64 sums from the start on, one addition a move, as the ants add theirs. The optimum is the smallest
such sum over all paths, so no plan is shorter, not even by one bit. It is within n · 2⁻⁵³ of the true length,
relatively, for n moves. Layers are swept by dynamic programming; grids are searched by A*; among discs see
:mod:`antgym.maps.tangents`.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antgym.errors import ScenarioError
from antgym.maps import tangents
from antgym.maps.fleet import Fleet, side_by_side
from antgym.maps.motion import REACH, STRAIGHT, Motion, move_table, step_lengths
from antgym.maps.world import PAD, Scenario

_HEAP = 1 << 12  # entries to begin with; a heap that is too small is copied into one four times the size
_RANKS = 1e4  # per longest move: sums of a million moves still round to within one rank


def shortest_length(scenario: Scenario[Any, Any]) -> float:
    """Return the exact shortest length in world units; ScenarioError where no path exists."""
    if scenario.motion == STRAIGHT:
        return tangents.shortest_length(scenario)
    if scenario.motion.layered:
        return _sweep(scenario, np.empty((0, 0, 0), dtype=np.uint8))
    return _search(scenario)[0]


def shortest_path(scenario: Scenario[Any, Any] | Fleet) -> NDArray[Any]:
    """Return one shortest path from start to goal; ScenarioError where none exists.

    On a grid, (n, 3) int64 cell indices; among discs, (n, 2) float64 points with arcs as chords of at most a degree,
    which cut into discs by that much. Of a fleet, those of its robots, each alone, see
    :func:`~antgym.maps.fleet.side_by_side`.
    """
    if isinstance(scenario, Fleet):
        return side_by_side([shortest_path(robot) for robot in scenario.robots])
    if scenario.motion == STRAIGHT:
        return tangents.shortest_path(scenario)
    return _layered_path(scenario) if scenario.motion.layered else _grid_path(scenario)


def _layered_path(scenario: Scenario) -> NDArray[np.int64]:
    table = move_table(scenario.motion)
    moves = np.empty((scenario.layers, *scenario.world.padded[1:]), dtype=np.uint8)
    _sweep(scenario, moves)
    path = np.empty((scenario.layers + 1, 3), dtype=np.int64)
    path[-1] = scenario.goal
    for layer in range(scenario.layers - 1, -1, -1):
        _, y, z = path[layer + 1]
        path[layer] = path[layer + 1] - table.steps[moves[layer, y + PAD, z + PAD]]
    return path


def _sweep(scenario: Scenario, moves: NDArray[np.uint8]) -> float:
    from antgym.kernels.paths import layered_distances

    table, strides = move_table(scenario.motion), np.array(scenario.world.strides)
    length = layered_distances(
        scenario.world.bits,
        strides,
        table.required @ strides,
        table.steps,
        step_lengths(scenario.motion, scenario.world.cell),
        np.asarray(scenario.start) + PAD,
        np.asarray(scenario.goal) + PAD,
        REACH,
        np.empty((2, *scenario.world.padded[1:])),
        moves,
    )
    return _found(scenario, float(length))


def _grid_path(scenario: Scenario) -> NDArray[np.int64]:
    """Walk back from the goal along moves whose sums agree to the bit; the search left all of them final."""
    free, strides = scenario.world.storage.reshape(-1), np.array(scenario.world.strides)
    table, lengths = move_table(scenario.motion), step_lengths(scenario.motion, scenario.world.cell)
    steps, required, either = table.steps @ strides, table.required @ strides, table.either @ strides
    sums, start = _search(scenario)[1], (np.asarray(scenario.start) + PAD) @ strides
    cells = [int((np.asarray(scenario.goal) + PAD) @ strides)]
    while cells[-1] != start:
        before = cells[-1] - steps
        leads = (sums[before] + lengths == sums[cells[-1]]) & ((sums[before] > 0) | (before == start))
        leads &= free[before[:, None] + required].all(axis=1) & free[before[:, None] + either].any(axis=1)
        cells.append(int(before[leads.argmax()]))
    return np.stack(np.unravel_index(cells[::-1], scenario.world.padded), axis=1) - PAD


def _search(scenario: Scenario) -> tuple[float, NDArray[np.float64]]:
    """Return the shortest length and the flat sums over storage cells, 0.0 in all that were not reached."""
    from antgym.kernels.paths import grid_search

    table, strides = move_table(scenario.motion), np.array(scenario.world.strides)
    sums = np.zeros(math.prod(scenario.world.padded))  # untouched pages take no memory
    heap = np.empty((_HEAP, 3))
    state = np.zeros(2, dtype=np.int64)
    lengths = step_lengths(scenario.motion, scenario.world.cell)
    arrays = (
        scenario.world.bits,
        table.steps,
        table.required @ strides,
        table.either @ strides,
        lengths,
        _spans(scenario.motion, scenario.world.cell),
        _RANKS / lengths.max(),
        strides,
        np.asarray(scenario.start) + PAD,
        np.asarray(scenario.goal) + PAD,
    )
    while not grid_search(*arrays, sums, heap, state):
        heap = np.concatenate([heap, np.empty((3 * len(heap), 3))])
    length = float(sums[(np.asarray(scenario.goal) + PAD) @ strides])
    return _found(scenario, length or np.inf), sums


def _spans(motion: Motion, cell: tuple[float, float, float]) -> NDArray[np.float64]:
    """Return (8,) float64, the way of one cell along the axes whose bits are set (1 = x, 2 = y, 4 = z)."""
    bits = np.arange(8)[:, None] >> np.arange(3) & 1
    edges = bits * np.asarray(cell)
    return edges.sum(axis=1) if motion.name == "grid4" else np.sqrt((edges * edges).sum(axis=1))


def _found(scenario: Scenario, length: float) -> float:
    if np.isfinite(length):
        return length
    raise ScenarioError(
        f"no path leads from {scenario.start} to {scenario.goal} in scenario {scenario.name!r} under the "
        f"{scenario.motion.name} motion; move one of them or lower the obstacles"
    )
