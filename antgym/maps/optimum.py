"""The exact optimum of a scenario under its own motion rule."""

import numpy as np
from numpy.typing import NDArray

from antgym.errors import ScenarioError
from antgym.maps.motion import REACH, move_table, step_lengths
from antgym.maps.world import PAD, Scenario


def shortest_length(scenario: Scenario) -> float:
    """Return the exact shortest length in world units; ScenarioError where no path exists."""
    return _solve(scenario, np.empty((0, 0, 0), dtype=np.uint8))


def shortest_path(scenario: Scenario) -> NDArray[np.int64]:
    """Return one shortest path, (layers + 1, 3) cell indices from start to goal; ScenarioError where none exists."""
    table = move_table(scenario.motion)
    moves = np.empty((scenario.layers, *scenario.world.storage.shape[1:]), dtype=np.uint8)
    _solve(scenario, moves)
    path = np.empty((scenario.layers + 1, 3), dtype=np.int64)
    path[-1] = scenario.goal
    for layer in range(scenario.layers - 1, -1, -1):
        _, y, z = path[layer + 1]
        path[layer] = path[layer + 1] - table.steps[moves[layer, y + PAD, z + PAD]]
    return path


def _solve(scenario: Scenario, moves: NDArray[np.uint8]) -> float:
    from antgym.kernels.paths import layered_distances

    table = move_table(scenario.motion)
    offsets = np.stack([table.before, table.after, table.steps], axis=1)
    shift = np.array((0, PAD, PAD))
    length = layered_distances(
        scenario.world.storage,
        offsets,
        step_lengths(scenario.motion, scenario.world.cell),
        np.asarray(scenario.start) + shift,
        np.asarray(scenario.goal) + shift,
        REACH,
        np.empty((2, *scenario.world.storage.shape[1:])),
        moves,
    )
    if not np.isfinite(length):
        raise ScenarioError(
            f"no path leads from {scenario.start} to {scenario.goal} in scenario {scenario.name!r} under the "
            f"{scenario.motion.name} motion; move one of them or lower the obstacles"
        )
    return float(length)
