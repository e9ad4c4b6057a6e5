"""Shaping: from a height field to a world of blocked and free cells (liu2020, section "environment").

A cell whose inside the surface reaches is blocked, whether the surface fills it or only passes through it;
raising the surface first gives the gripper its clearance.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antgym.errors import MapError
from antgym.maps.world import GridWorld

FILLED = np.uint8(0)
HALF_FILLED = np.uint8(1)
UNFILLED = np.uint8(2)


def classify(heights: ArrayLike, levels: int, level_height: float, rise: float = 0.0) -> NDArray[np.uint8]:
    """Sort the cells above every column into filled, half-filled and unfilled.

    Cell k spans z in [k, k + 1) · ``level_height``. It is filled where the raised surface lies at or above
    its top, half-filled where the surface passes through its inside, unfilled otherwise.

    Args:
        heights: (nx, ny) finite heights above the floor of the box, in world units; negative ones are below.
        levels: number of cells along z, at least 1.
        level_height: edge of a cell along z, in world units, positive.
        rise: how far the surface is raised in every column, in world units, at least 0.

    Returns:
        (nx, ny, levels) uint8 of ``FILLED``, ``HALF_FILLED`` and ``UNFILLED``.

    Raises:
        MapError: if a height is missing or infinite, or an argument is out of its range.
    """
    if levels < 1:
        raise MapError(f"a box has at least one level along z, got levels={levels}")
    if not (np.isfinite(level_height) and level_height > 0):
        raise MapError(f"the height of a level must be a positive number, got {level_height}")
    if not (np.isfinite(rise) and rise >= 0):
        raise MapError(f"the rise must be 0 or a positive number, got {rise}")
    surface = (_finite(heights) + rise)[:, :, None]
    floors = np.arange(levels + 1) * level_height
    codes = np.full((*surface.shape[:2], levels), UNFILLED)
    codes[surface > floors[:-1]] = HALF_FILLED
    codes[surface >= floors[1:]] = FILLED
    return codes


def voxelise(
    heights: ArrayLike, levels: int, cell: tuple[float, float, float], rise: float = 0.0
) -> GridWorld:
    """Return the world over a height field: filled and half-filled cells are blocked, unfilled ones free.

    Args:
        heights: (nx, ny) finite heights above the floor of the box, in world units, one per column of cells.
        levels: number of cells along z.
        cell: edges of a cell along x, y, z in world units.
        rise: how far the surface is raised in every column, in world units.

    Raises:
        MapError: as for ``classify`` and ``GridWorld``.
    """
    return GridWorld(classify(heights, levels, cell[2], rise) == UNFILLED, cell)


def fill_missing(heights: ArrayLike, value: float) -> NDArray[np.float64]:
    """Return a copy of (nx, ny) heights with every NaN and infinity replaced by ``value``.

    Raises:
        MapError: if the heights are not a two-dimensional array of numbers or ``value`` is not finite.
    """
    if not np.isfinite(value):
        raise MapError(f"missing heights must be filled with a finite number, got {value}")
    array = height_array(heights)
    return np.where(np.isfinite(array), array, value)


def block_max(heights: ArrayLike, shape: tuple[int, int]) -> NDArray[np.float64]:
    """Reduce a fine height field to one height per column of cells: the highest sample over it.

    Blocks are as equal as whole samples allow. A missing sample makes its block NaN.

    Args:
        heights: (rows, columns) heights.
        shape: (nx, ny), blocks along either axis, from 1 to the samples there.

    Returns:
        (nx, ny) float64.

    Raises:
        MapError: if a block would hold no sample.
    """
    reduced = height_array(heights)
    for axis, (blocks, samples) in enumerate(zip(shape, reduced.shape, strict=True)):
        if not 1 <= blocks <= samples:
            raise MapError(
                f"{samples} samples along axis {axis} cannot be cut into {blocks} blocks; "
                f"choose 1 to {samples} cells there or use a finer height field"
            )
        firsts = np.arange(blocks) * samples // blocks
        reduced = np.maximum.reduceat(reduced, firsts, axis=axis)
    return reduced


def height_array(heights: ArrayLike) -> NDArray[np.float64]:
    """Return heights as a float64 array, possibly a view; missing values stay.

    Raises:
        MapError: if they are not a non-empty two-dimensional array of real numbers.
    """
    array = np.asarray(heights)
    if array.ndim != 2 or array.size == 0:
        raise MapError(f"heights are a non-empty (nx, ny) array, got shape {array.shape}")
    if array.dtype.kind not in "biuf":
        raise MapError(f"heights are real numbers, got an array of {array.dtype}")
    return array.astype(np.float64, copy=False)


def _finite(heights: ArrayLike) -> NDArray[np.float64]:
    array = height_array(heights)
    missing = np.argwhere(~np.isfinite(array))
    if len(missing):
        i, j = missing[0].tolist()
        raise MapError(
            f"{len(missing)} of {array.size} heights are missing or infinite, the first is {array[i, j]} at "
            f"[{i}, {j}]; replace them first with antgym.fill_missing(heights, value)"
        )
    return array
