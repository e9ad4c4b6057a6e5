"""Occupancy: a scenario as a small picture of fixed shape, for convolutional policies.

Channels come first, as torch has it: ``(channels, x, y)`` for Conv2d, ``(channels, x, y, z)`` for Conv3d. The world
is stretched to fill the picture along every axis; how many cells it has is among the features.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from antgym.maps.world import Cell, GridWorld, Scenario

CHANNELS = ("blocked", "start", "goal")
FLAT, SOLID = (32, 32, 1), (16, 16, 16)  # blocks along x, y, z

Picture = NDArray[np.float32]


def picture_shape(flat: bool) -> tuple[int, ...]:
    """Return (channels, 32, 32) for flat pictures, (channels, 16, 16, 16) for others."""
    return (len(CHANNELS), *(FLAT[:2] if flat else SOLID))


def occupancy(scenario: Scenario, flat: bool | None = None) -> Picture:
    """Return the down-sampled map of a scenario, float32 in [0, 1].

    Args:
        scenario: what is shown.
        flat: whether the picture is; None: if the world is one cell high. A flat world in a solid picture is its
            one level at every height, and so are its start and goal. A solid world in a flat picture is seen from
            above: blocked shares of whole columns.

    Returns:
        :func:`picture_shape`. Channel 0 is the blocked share of each block, by exact area along axes with at least
        as many cells as the picture has blocks, that of the nearest cell along others. Channels 1 and 2 mark the
        blocks of start and goal, several where the world is smaller than the picture: with a 1, or, seen from above,
        with the height of the cell's ceiling over the world's.
    """
    return scenario.chart(flat).copy()


class Chart:
    """Draws the down-sampled map when it is first asked for; it knows neither the scenario nor its optimum.

    Args:
        world: the grid.
        starts: (x, y, z) cell indices each; several of a fleet.
        goals: likewise.
    """

    def __init__(self, world: GridWorld, starts: Sequence[Cell], goals: Sequence[Cell]) -> None:
        self._world, self._ends = world, (starts, goals)
        self._pictures: dict[bool, Picture] = {}

    def __reduce__(self) -> tuple[type["Chart"], tuple[GridWorld, Sequence[Cell], Sequence[Cell]]]:
        return Chart, (self._world, *self._ends)

    def __call__(self, flat: bool | None = None) -> Picture:
        """Return :func:`occupancy`, read-only."""
        flat = self._world.shape[2] == 1 if flat is None else bool(flat)
        if flat not in self._pictures:
            picture = _drawn(self._world, self._ends, flat)
            picture.setflags(write=False)
            self._pictures[flat] = picture
        return self._pictures[flat]


def _drawn(world: GridWorld, ends: tuple[Sequence[Cell], Sequence[Cell]], flat: bool) -> Picture:
    blocks = FLAT if flat else SOLID
    picture = np.zeros((len(CHANNELS), *blocks), dtype=np.float32)
    picture[0] = _blocked(world, blocks)
    for channel, cells in zip(picture[1:], ends, strict=True):
        for cell in cells:
            shown_in = [_shown_in(at, n, m) for at, n, m in zip(cell, world.shape, blocks, strict=True)]
            channel[np.ix_(*shown_in)] = (cell[2] + 1) / world.shape[2] if flat else 1.0
    return picture.reshape(picture_shape(flat))


def _blocked(world: GridWorld, blocks: Cell) -> NDArray[np.float64]:
    """Return the blocked share of every block; all sums are of whole numbers, and exact in whatever order."""
    over_x, over_y, over_z = (_weights(n, m) for n, m in zip(world.shape, blocks, strict=True))
    nx, ny, nz = world.shape
    sums = over_x @ (world.free == 0).reshape(nx, -1).astype(np.float64)
    sums = over_y @ sums.reshape(-1, ny, nz) @ over_z.T
    return np.asarray(sums / (over_x[0].sum() * over_y[0].sum() * over_z[0].sum()))


def _weights(cells: int, blocks: int) -> NDArray[np.float64]:
    """Return (blocks, cells): how much each block holds of each cell, in whole numbers; rows add up to the same."""
    if cells < blocks:
        return np.asarray(_nearest(cells, blocks)[:, None] == np.arange(cells), dtype=np.float64)
    block, cell = np.arange(blocks)[:, None] * cells, np.arange(cells) * blocks
    shared = np.minimum(block + cells, cell + blocks) - np.maximum(block, cell)
    return np.maximum(shared, 0).astype(np.float64)


def _shown_in(at: int, cells: int, blocks: int) -> NDArray[np.int64]:
    """Return the blocks along one axis that show the cell ``at``: those nearest to it, or the one of its centre."""
    if cells < blocks:
        return np.flatnonzero(_nearest(cells, blocks) == at)
    return np.array([(2 * at + 1) * blocks // (2 * cells)])


def _nearest(cells: int, blocks: int) -> NDArray[np.int64]:
    """Return (blocks,) the cell in which each block's centre lies."""
    return (2 * np.arange(blocks) + 1) * cells // (2 * blocks)
