"""Features: what can be seen of a scenario before anything is planned.

None needs the optimum or anything derived from it; lengths enter only as ratios, so the unit does not matter.
The one walk taken is that of a single greedy ant.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antgym.maps.motion import REACH, move_table, step_lengths
from antgym.maps.world import PAD, Scenario

SAMPLE = 256  # free cells whose moves are counted
LINE_SAMPLES = 4  # per layer


class Feature(NamedTuple):
    """One entry of the descriptor; values are clipped into [low, high]."""

    name: str
    low: float
    high: float
    meaning: str


FEATURES: tuple[Feature, ...] = (
    Feature("layers", -1.0, 1.0, "log10 of the moves from start to goal, over 20"),
    Feature("width", -1.0, 1.0, "log10 of the cells along y, over 20"),
    Feature("height", -1.0, 1.0, "log10 of the cells along z, over 20"),
    Feature("stretch_y", -1.0, 1.0, "log2 of a cell's edge along y over that along x, / 3"),
    Feature("stretch_z", -1.0, 1.0, "log2 of a cell's edge along z over that along x, / 3"),
    Feature("offset_y", 0.0, 1.0, "cells from start to goal along y, over the farthest that moves can reach"),
    Feature("offset_z", -1.0, 1.0, "the same along z, positive upwards"),
    Feature("blocked", 0.0, 1.0, "share of blocked cells from the start's layer to the goal's"),
    Feature("blocked_in_reach", 0.0, 1.0, "the same among cells between start and goal by distance alone"),
    Feature("blocked_on_line", 0.0, 1.0, "blocked share of the straight line from start to goal"),
    Feature("narrowest_layer", 0.0, 1.0, "free share, within reach, of the layer where it is smallest"),
    Feature("column_mean", 0.0, 1.0, "mean height of the columns (their topmost blocked cell), 1 = ceiling"),
    Feature("column_sd", 0.0, 1.0, "twice the standard deviation of the column heights"),
    Feature("column_max", 0.0, 1.0, "highest column"),
    Feature("full_columns", 0.0, 1.0, "share of columns without a free cell"),
    Feature("roughness", 0.0, 1.0, "mean difference in height between columns side by side"),
    Feature("branching", 0.0, 1.0, f"mean share of legal moves over up to {SAMPLE} free cells within reach"),
    Feature("dead_ends", 0.0, 1.0, "share of those cells without a legal move"),
    Feature(
        "greedy_arrives", 0.0, 1.0, "1 if always taking the shortest step + distance to the goal arrives"
    ),
    Feature("greedy_progress", 0.0, 1.0, "share of the layers that this walk passes before it is stuck"),
    Feature("greedy_detour", 0.0, 1.0, "its length over the straight line, minus 1; 1 if it is stuck"),
)


def describe(scenario: Scenario) -> NDArray[np.float32]:
    """Return the (len(FEATURES),) float32 descriptor of a scenario, each entry within its bounds."""
    reach = within_reach(scenario)
    values = {
        **_sizes(scenario),
        **_obstacles(scenario, reach),
        **_columns(scenario),
        **_moves(scenario, reach),
        **_greedy_walk(scenario),
    }
    return np.array([np.clip(values[f.name], f.low, f.high) for f in FEATURES], dtype=np.float32)


def feature_table(features: Sequence[Feature] = FEATURES) -> str:
    """Return the Markdown table of some features, by default of all that describe a scenario."""
    rows = ["| num | feature | low | high | meaning |", "|---|---|---|---|---|"]
    rows += [f"| {i} | {f.name} | {f.low:g} | {f.high:g} | {f.meaning} |" for i, f in enumerate(features)]
    return "\n".join(rows)


def within_reach(scenario: Scenario) -> NDArray[np.bool_]:
    """Return (layers + 1, ny, nz) bool: cells on some path from start to goal if nothing were blocked."""
    layer = np.arange(scenario.layers + 1)[:, None]
    sides = []
    for axis in (1, 2):
        cells = np.arange(scenario.world.shape[axis])
        from_start = np.abs(cells - scenario.start[axis]) <= REACH * layer
        to_goal = np.abs(cells - scenario.goal[axis]) <= REACH * layer[::-1]
        sides.append(from_start & to_goal)
    return sides[0][:, :, None] & sides[1][:, None, :]


def legal_moves(scenario: Scenario, cells: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Return (n, k) bool: which moves of the motion rule are legal from which free cells.

    Args:
        scenario: the scenario; a move that loses the reach of its goal is not legal.
        cells: (n, 3) cell indices from the start's layer up to, but not including, the goal's.
    """
    table, storage = move_table(scenario.motion), scenario.world.storage
    strides = np.array((storage.shape[1] * storage.shape[2], storage.shape[2], 1))
    base = ((cells + PAD) @ strides)[:, None]
    flat = storage.reshape(-1)
    legal = flat[base + table.steps @ strides] != 0
    for crossed in (table.before, table.after):
        legal &= flat[base + crossed @ strides] != 0
    _, y, z = (cells - scenario.goal).T[:, :, None]
    left = REACH * (scenario.goal[0] - cells[:, :1] - 1)
    legal &= np.abs(y + table.steps[:, 1]) <= left
    legal &= np.abs(z + table.steps[:, 2]) <= left
    return legal


def _slab(scenario: Scenario) -> NDArray[np.bool_]:
    """Return (layers + 1, ny, nz) bool, the free cells from the start's layer to the goal's."""
    return scenario.world.free[scenario.start[0] : scenario.goal[0] + 1] != 0


def _sizes(scenario: Scenario) -> dict[str, float]:
    _, ny, nz = scenario.world.shape
    dx, dy, dz = scenario.world.cell
    farthest = REACH * scenario.layers
    return {
        "layers": np.log10(scenario.layers / 20),
        "width": np.log10(ny / 20),
        "height": np.log10(nz / 20),
        "stretch_y": np.log2(dy / dx) / 3,
        "stretch_z": np.log2(dz / dx) / 3,
        "offset_y": abs(scenario.goal[1] - scenario.start[1]) / farthest,
        "offset_z": (scenario.goal[2] - scenario.start[2]) / farthest,
    }


def _obstacles(scenario: Scenario, reach: NDArray[np.bool_]) -> dict[str, float]:
    free = _slab(scenario)
    in_reach = reach.sum(axis=(1, 2))
    free_in_reach = (free & reach).sum(axis=(1, 2))
    return {
        "blocked": 1 - free.mean(),
        "blocked_in_reach": 1 - free_in_reach.sum() / in_reach.sum(),
        "blocked_on_line": _blocked_on_line(scenario),
        "narrowest_layer": (free_in_reach / in_reach).min(),
    }


def _blocked_on_line(scenario: Scenario) -> float:
    start, goal = np.array(scenario.start), np.array(scenario.goal)
    along = np.linspace(0.0, 1.0, LINE_SAMPLES * scenario.layers + 1)[:, None]
    x, y, z = np.floor(start + along * (goal - start) + 0.5).astype(np.intp).T
    return float(np.mean(scenario.world.free[x, y, z] == 0))


def _columns(scenario: Scenario) -> dict[str, float]:
    free = _slab(scenario)
    nz = free.shape[2]
    topmost = nz - (~free[:, :, ::-1]).argmax(axis=2)
    heights = np.where(free.all(axis=2), 0, topmost) / nz
    jumps = [np.abs(np.diff(heights, axis=axis)).ravel() for axis in (0, 1)]
    return {
        "column_mean": heights.mean(),
        "column_sd": 2 * heights.std(),
        "column_max": heights.max(),
        "full_columns": 1 - free.any(axis=2).mean(),
        "roughness": np.concatenate(jumps).mean(),
    }


def _moves(scenario: Scenario, reach: NDArray[np.bool_]) -> dict[str, float]:
    candidates = np.flatnonzero((_slab(scenario) & reach)[:-1])
    spread = np.linspace(0, len(candidates) - 1, min(SAMPLE, len(candidates))).astype(np.intp)
    cells = np.stack(np.unravel_index(candidates[spread], reach.shape), axis=1)
    cells[:, 0] += scenario.start[0]
    legal = legal_moves(scenario, cells).mean(axis=1)
    return {"branching": legal.mean(), "dead_ends": (legal == 0).mean()}


def _greedy_walk(scenario: Scenario) -> dict[str, float]:
    steps = move_table(scenario.motion).steps
    lengths = step_lengths(scenario.motion, scenario.world.cell)
    goal, edges = np.array(scenario.goal), np.array(scenario.world.cell)
    cell, length = np.array(scenario.start), 0.0
    for layer in range(scenario.layers):
        legal = legal_moves(scenario, cell[None])[0]
        if not legal.any():
            return {"greedy_arrives": 0.0, "greedy_progress": layer / scenario.layers, "greedy_detour": 1.0}
        left = (cell + steps - goal) * edges
        move = np.where(legal, lengths + np.sqrt((left * left).sum(axis=1)), np.inf).argmin()
        cell, length = cell + steps[move], length + lengths[move]
    return {
        "greedy_arrives": 1.0,
        "greedy_progress": 1.0,
        "greedy_detour": length / scenario.straight_line - 1,
    }
