"""Disc charts: a scenario among discs as the small picture that grids have, too."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antgym.maps.disc_features import raster
from antgym.maps.discs import DiscWorld, Point
from antgym.maps.occupancy import FLAT, SOLID, Picture, picture_shape

FINE = 4  # samples a side of every block


class DiscChart:
    """Draws the map of a disc world when it is first asked for; it knows neither the scenario nor its optimum.

    As :class:`antgym.maps.occupancy.Chart` does; the bounds are stretched to fill the picture, a block's blocked share
    is that of FINE × FINE places in it, and a solid picture is the flat one at every height.

    Args:
        world: the discs.
        start: a point.
        goal: a point.
    """

    def __init__(self, world: DiscWorld, start: Point, goal: Point) -> None:
        self._world, self._ends = world, (start, goal)
        self._pictures: dict[bool, Picture] = {}

    def __reduce__(self) -> tuple[type["DiscChart"], tuple[DiscWorld, Point, Point]]:
        return DiscChart, (self._world, *self._ends)

    def __call__(self, flat: bool | None = None) -> Picture:
        """Return the picture, read-only; flat where it is not said."""
        flat = flat is None or bool(flat)
        if flat not in self._pictures:
            picture = self._drawn(flat)
            picture.setflags(write=False)
            self._pictures[flat] = picture
        return self._pictures[flat]

    def _drawn(self, flat: bool) -> Picture:
        side = (FLAT if flat else SOLID)[0]
        plane = np.zeros((3, side, side), dtype=np.float32)
        blocked = raster(self._world, FINE * side, FINE * side) <= 0
        plane[0] = blocked.reshape(side, FINE, side, FINE).mean(axis=(1, 3))
        for channel, (column, row) in zip(
            plane[1:], blocks_of(self._world, self._ends, side, side), strict=True
        ):
            channel[column, row] = 1.0
        if flat:
            return plane
        return np.ascontiguousarray(np.broadcast_to(plane[..., None], picture_shape(False)))


def blocks_of(world: DiscWorld, points: ArrayLike, columns: int, rows: int) -> NDArray[np.int64]:
    """Return which of columns × rows equal blocks of the bounds (n, 2) points of them lie in, (n, 2)."""
    x_min, x_max, y_min, y_max = world.bounds
    shares = (np.asarray(points, dtype=np.float64) - (x_min, y_min)) / (x_max - x_min, y_max - y_min)
    last = np.array([columns, rows]) - 1
    return np.minimum((shares * (columns, rows)).astype(np.int64), last)
