"""Start and goal: what makes a cell fit to be one, and what to say where it is not."""

from collections.abc import Sequence
from operator import index
from typing import TYPE_CHECKING

import numpy as np

from antgym.errors import ScenarioError
from antgym.maps.motion import REACH

if TYPE_CHECKING:
    from antgym.maps.world import Cell, GridWorld


def checked_end(world: "GridWorld", cell: Sequence[int], label: str) -> "Cell":
    """Return a start or goal as a cell, (x, y) as (x, y, 0) in a world one cell high.

    Raises:
        ScenarioError: if it is no cell, lies outside the world or is blocked.
    """
    cell = _whole_cell(cell, label)
    if len(cell) == 2 and world.shape[2] == 1:
        cell = (*cell, 0)
    if len(cell) != 3 or not all(0 <= i < n for i, n in zip(cell, world.shape, strict=False)):
        raise ScenarioError(f"{label} {cell} lies outside the world of {world.shape} cells (indices from 0)")
    if not world.is_free(cell):
        near = _nearest_free(world, (cell[0], cell[1], cell[2]))
        if near is None:
            raise ScenarioError(f"{label} {cell} is blocked, and so is every cell of the world")
        raise ScenarioError(f"{label} {cell} is blocked; the nearest free cell is {near}")
    return cell[0], cell[1], cell[2]


def require_reach(start: "Cell", goal: "Cell") -> None:
    """Raise ScenarioError unless the layered motion can lead from start to goal."""
    (xs, ys, zs), (xg, yg, zg) = start, goal
    if xg <= xs:
        raise ScenarioError(
            f"the layered motion advances along x: goal {goal} must lie in a later layer "
            f"than start {start}; swap them or rotate the world"
        )
    if max(abs(yg - ys), abs(zg - zs)) > REACH * (xg - xs):
        raise ScenarioError(
            f"goal {goal} is out of reach of start {start}: {xg - xs} layers allow "
            f"{REACH * (xg - xs)} cells along y and z"
        )


def _whole_cell(cell: Sequence[int], label: str) -> tuple[int, ...]:
    try:
        return tuple(index(i) for i in cell)
    except TypeError:
        raise ScenarioError(
            f"{label} = {cell!r}: a cell is whole indices (x, y, z), counted from 0"
        ) from None


def _nearest_free(world: "GridWorld", cell: "Cell") -> "Cell | None":
    """Return the free cell the fewest steps away, None where all are blocked; looks no further around than it must."""
    reach, largest = 1, sum(world.shape)
    while True:
        low = [max(i - reach, 0) for i in cell]
        x, y, z = (slice(a, i + reach + 1) for a, i in zip(low, cell, strict=True))
        near = world.planes(x.start, min(x.stop, world.shape[0]))[:, y, z]
        found = np.argwhere(near) + low
        steps = np.abs(found - np.array(cell)).sum(axis=1)
        if len(found) and (steps.min() <= reach or reach >= largest):
            return tuple(found[steps.argmin()].tolist())
        if reach >= largest:
            return None
        reach = int(steps.min()) if len(found) else 2 * reach
