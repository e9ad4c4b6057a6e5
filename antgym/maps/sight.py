"""Sight: whether a straight line between two cells is clear, exactly, under a motion's corner rule.

A line from centre to centre leaves every cell through a face, or where it passes exactly through an edge or a corner of
cells, through that. So it is a chain of steps between neighbours, and each must be legal as a move is: its end free,
and what the corner rule asks of a diagonal one.
"""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antgym.maps.motion import Motion, move_table
from antgym.maps.world import PAD, GridWorld

_Array = NDArray[Any]


def sees(world: GridWorld, motion: Motion, here: ArrayLike, there: ArrayLike) -> bool:
    """Return whether the line between the centres of two cells enters no blocked one and keeps the corner rule.

    Where it passes between cells that meet in an edge or a corner, that of ``motion`` decides; a layered motion has
    none, so there it may pass, as its moves may.

    Args:
        world: the grid.
        motion: whose corner rule holds; any of a grid.
        here: (3,) cell indices within the world, free.
        there: likewise.
    """
    from antgym.kernels import lines

    ends = (np.asarray(end, dtype=np.int64) + PAD for end in (here, there))
    return bool(lines.clear(*_steps(world, motion), *ends))


def shortest_chain(world: GridWorld, motion: Motion, path: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return which cells of a path the shortest polyline over some of them takes, first and last included.

    Args:
        world: the grid.
        motion: whose corner rule holds.
        path: (n, 3) cells, n ≥ 1, each seen from the one before.

    Returns:
        (k,) indices, rising; where ways are equally short, few.
    """
    from antgym.kernels import lines

    ways, before = np.empty(len(path)), np.empty(len(path), dtype=np.int64)
    lines.shortest_chain(*_steps(world, motion), path + PAD, world.centre(path), ways, before)
    kept = [len(path) - 1]
    while kept[-1]:
        kept.append(int(before[kept[-1]]))
    return np.array(kept[::-1])


def _steps(world: GridWorld, motion: Motion) -> tuple[_Array, _Array, _Array, _Array, _Array]:
    """Return what the kernels take of a world, and of the steps that lines in it make."""
    table, strides = move_table(_line_rule(motion)), np.array(world.strides)
    rows = np.zeros((3, 3, 3), dtype=np.int64)
    rows[tuple((table.steps + 1).T)] = np.arange(len(table.steps))
    return world.bits, strides, rows, table.required @ strides, table.either @ strides


def _line_rule(motion: Motion) -> Motion:
    """Return the motion between neighbours, diagonal ones too, whose corner rule lines keep."""
    if motion.layered:
        return Motion("grid26", corners="cut")
    return motion if motion.name == "grid26" else Motion("grid8", corners=motion.corners)
