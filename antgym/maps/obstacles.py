"""Obstacles: grown by a robot's radius, and filled until they are convex (zhang2011, 2.2 and 2.4.1)."""

import math
from collections.abc import Iterator, Sequence
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antgym.errors import MapError
from antgym.maps.world import Cell, GridWorld

Bools = NDArray[np.bool_]
_Filling = tuple[tuple[slice, slice], Bools]
_TOUCHING = np.ones((3, 3), bool)  # cells that share a corner are one obstacle: nothing passes between them


def grown(world: GridWorld, radius: float) -> GridWorld:
    """Return the world in which a disc, or a ball, of some radius is a point.

    A cell is blocked where a disc about its centre would reach into a blocked cell. The borders of the box are no
    obstacles.

    Args:
        world: the grid.
        radius: of the largest robot, R_max, in world units, 0 or more.

    Raises:
        MapError: if the radius is no such number.
    """
    from scipy.ndimage import maximum_filter1d

    if not (math.isfinite(radius) and radius >= 0):
        raise MapError(f"radius = {radius}: must be 0 or a positive number, in the unit of the map")
    blocked, shape = world.free == 0, world.shape
    reach = [
        0 if n == 1 else min(math.ceil(radius / edge + 0.5), n)
        for n, edge in zip(shape, world.cell, strict=True)
    ]
    found = np.zeros_like(blocked)
    for dx, dy in product(range(-reach[0], reach[0] + 1), range(-reach[1], reach[1] + 1)):
        left = radius**2 - _aside(dx, world.cell[0]) ** 2 - _aside(dy, world.cell[1]) ** 2
        if left <= 0 and (dx, dy) != (0, 0):
            continue
        run = 0 if shape[2] == 1 else max(math.ceil(math.sqrt(max(left, 0.0)) / world.cell[2] - 0.5), 0)
        shifted = blocked if run == 0 else maximum_filter1d(blocked, 2 * run + 1, axis=2, mode="constant")
        (to_x, from_x), (to_y, from_y) = _shifted(dx, shape[0]), _shifted(dy, shape[1])
        found[to_x, to_y] |= shifted[from_x, from_y]
    return GridWorld(~found, world.cell)


def _aside(steps: int, edge: float) -> float:
    """Return how far the nearer side of the cell some steps away lies from a cell's centre."""
    return max(abs(steps) - 0.5, 0.0) * edge


def _shifted(by: int, count: int) -> tuple[slice, slice]:
    return slice(max(by, 0), count + min(by, 0)), slice(max(-by, 0), count - max(by, 0))


class Filled(NamedTuple):
    """What filling came to.

    Attributes:
        world: the grid with its obstacles filled.
        cells: how many cells were filled.
        left: obstacles left concave, because their filling would cover an end or part start and goal.
    """

    world: GridWorld
    cells: int
    left: int


def convex(world: GridWorld, start: Cell, goal: Cell) -> Filled:
    """Fill concave obstacles of a flat world to convex ones, so that no ant walks into a pocket.

    Cells that touch, by a corner too, are one obstacle. It is convex when it holds every cell whose centre lies in the
    convex hull of its cells' centres. Filled obstacles that touch are one, and filled again. One whose filling would
    cover the start or the goal, or part them, is left as it is: the print has none such.

    Raises:
        MapError: if the world is not flat.
    """
    if world.shape[2] != 1:
        raise MapError(f"obstacles are filled in flat worlds alone, this one has {world.shape} cells")
    blocked = world.free[:, :, 0] == 0
    before, left, changed = int(blocked.sum()), 0, True
    while changed:
        fillings = list(_fillings(blocked))
        everything = _with(blocked, fillings)
        if _joined(everything, start, goal):
            blocked, left, changed = everything, 0, bool(fillings)
        else:
            blocked, left = _one_by_one(blocked, fillings, start, goal)
            changed = left < len(fillings)
    return Filled(GridWorld(~blocked, world.cell), int(blocked.sum()) - before, left)


def _fillings(blocked: Bools) -> Iterator[_Filling]:
    """Yield the box and the hull of every obstacle that is not convex."""
    from scipy.ndimage import find_objects, label

    labels, _ = label(blocked, _TOUCHING)
    for number, box in enumerate(find_objects(labels), 1):
        hull = hull_of(labels[box] == number)
        if (hull & ~blocked[box]).any():
            yield box, hull


def _one_by_one(blocked: Bools, fillings: Sequence[_Filling], start: Cell, goal: Cell) -> tuple[Bools, int]:
    """Return the obstacles with the fillings that leave a way from start to goal, and how many do not."""
    left = 0
    for filling in fillings:
        trial = _with(blocked, [filling])
        if _joined(trial, start, goal):
            blocked = trial
        else:
            left += 1
    return blocked, left


def _with(blocked: Bools, fillings: Sequence[_Filling]) -> Bools:
    filled = blocked.copy()
    for box, hull in fillings:
        filled[box] |= hull
    return filled


def _joined(blocked: Bools, start: Cell, goal: Cell) -> bool:
    from scipy.ndimage import label

    labels, _ = label(~blocked)
    return bool(labels[start[:2]] == labels[goal[:2]] != 0)


def hull_of(cells: Bools) -> Bools:
    """Return the cells of an (nx, ny) array whose centres lie in the convex hull of those that are set."""
    columns = np.flatnonzero(cells.any(axis=1))
    low = _chain(columns, cells[columns].argmax(axis=1))
    high = _chain(columns, cells.shape[1] - 1 - cells[columns, ::-1].argmax(axis=1), upper=True)
    first, last = int(columns[0]), int(columns[-1])
    x, y = np.arange(first, last + 1), np.arange(cells.shape[1])
    hull = np.zeros_like(cells)
    # fractions between whole numbers: what is nearly whole is whole
    bottom, top = np.ceil(np.interp(x, *low) - 1e-9), np.floor(np.interp(x, *high) + 1e-9)
    hull[first : last + 1] = (bottom[:, None] <= y) & (y <= top[:, None])
    return hull


def _chain(
    x: NDArray[np.intp], y: NDArray[np.intp], upper: bool = False
) -> tuple[Sequence[int], Sequence[int]]:
    """Return the corners of the lower, or upper, hull of points in order of x (Andrew's monotone chain)."""
    kept: list[tuple[int, int]] = []
    sign = -1 if upper else 1
    for point in zip(x.tolist(), y.tolist(), strict=True):
        while len(kept) > 1 and sign * _turning(kept[-2], kept[-1], point) <= 0:
            kept.pop()
        kept.append(point)
    xs, ys = zip(*kept, strict=True)
    return xs, ys


def _turning(a: tuple[int, int], b: tuple[int, int], c: tuple[int, int]) -> int:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
