"""Maps: a world that was read from a file, and where its cells lie in the file's own coordinates."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antgym.errors import ScenarioError
from antgym.maps.motion import Motion
from antgym.maps.obstacles import grown
from antgym.maps.world import Cell, GridWorld, Scenario

Floats = NDArray[np.float64]


class Frame(NamedTuple):
    """Where the cells of a world lie in the coordinates of its file.

    Attributes:
        origin: (x, y, z) of the outer corner of cell (0, 0, 0), in the file's unit.
        yaw: by how much the cells' x axis is turned from the file's, counter-clockwise, radians.
        unit: of the coordinates: ``"m"``, ``"cells"``, or ``"units"`` where the file does not say.
        down: whether y counts from the top of the map as people draw it.
    """

    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    yaw: float = 0.0
    unit: str = "units"
    down: bool = False


@dataclass(frozen=True, eq=False)
class Map:
    """A world from a file; see :func:`antgym.read_map`.

    Attributes:
        world: the grid.
        motion: how things move in such files, unless told otherwise.
        frame: where the cells lie.
        source: the file.
        kind: what it is, in words.
        heights: (nx, ny) of the ground where the file holds elevations, None in others.
    """

    world: GridWorld
    motion: Motion
    frame: Frame
    source: str
    kind: str
    heights: Floats | None = None

    def points(self, cells: ArrayLike) -> Floats:
        """Return the centres of (..., 3) cells in the file's coordinates, (..., 3)."""
        inside = self.world.centre(cells)
        return np.asarray(inside @ _turn(self.frame.yaw).T + self.frame.origin)

    def cell(self, point: Sequence[float]) -> Cell:
        """Return the cell in which a point (x, y, z) of the file's coordinates lies, inside the world or not.

        Raises:
            ScenarioError: if the point is not finite.
        """
        if len(point) != 3 or not all(math.isfinite(part) for part in point):
            raise ScenarioError(f"{tuple(point)} is not a point: three finite numbers (x, y, z)")
        inside = (np.asarray(point, dtype=np.float64) - self.frame.origin) @ _turn(self.frame.yaw)
        # on a border between cells, rounding must not choose
        x, y, z = np.floor(np.round(inside / self.world.cell, 9)).astype(int).tolist()
        return x, y, z

    def end(self, numbers: Sequence[float], label: str, unit: str = "cells") -> Cell:
        """Return a start or goal as a cell: x y z, or x y alone for the lowest free cell of the column.

        Args:
            numbers: cell indices; or the file's coordinates, x y or x y z.
            label: ``"start"`` or ``"goal"``, for the message.
            unit: ``"cells"``, or ``"map"`` for the file's coordinates.

        Raises:
            ScenarioError: if they are not two or three such numbers, or no cell is meant.
        """
        if len(numbers) not in (2, 3):
            raise ScenarioError(f"{label} takes x y z, or x y alone, got {len(numbers)} numbers")
        if unit == "cells" and not all(float(number).is_integer() for number in numbers):
            raise ScenarioError(
                f"{label} {tuple(numbers)}: cells have whole indices; are these coordinates (--unit map)?"
            )
        if unit == "cells":
            x, y, *level = (int(number) for number in numbers)
        else:
            floor = self.frame.origin[2] + self.world.cell[2] / 2
            x, y, z = self.cell((*numbers, floor)[:3])
            level = [z] if len(numbers) == 3 else []
        nx, ny, nz = self.world.shape
        if not (0 <= x < nx and 0 <= y < ny and all(0 <= z < nz for z in level)):
            raise ScenarioError(f"{label} {tuple(numbers)} lies outside the map: {self.extent}")
        if level:
            return x, y, level[0]
        column = self.world.planes(x, x + 1)[0, y]
        if nz > 1 and not column.any():
            raise ScenarioError(f"{label} {tuple(numbers)}: no free cell above, in {nz} levels; give more")
        return x, y, int(column.argmax())

    @property
    def extent(self) -> str:
        """Where the map lies, in words."""
        nx, ny, nz = self.world.shape
        corners = self.points([(x, y, 0) for x in (-0.5, nx - 0.5) for y in (-0.5, ny - 0.5)])[:, :2]
        low, high = corners.min(axis=0), corners.max(axis=0)
        sides = f"{nx} x {ny}" if nz == 1 else f"{nx} x {ny} x {nz}"
        return (
            f"{sides} cells, counted from 0; x {low[0]:.6g} to {high[0]:.6g}, y {low[1]:.6g} to {high[1]:.6g} "
            f"{self.frame.unit}"
        )

    def grown(self, radius: float) -> "Map":
        """Return the map for a robot of some radius, in the file's unit: its centre keeps that far from obstacles."""
        return self if radius == 0 else replace(self, world=grown(self.world, radius))

    def scenario(self, start: Cell, goal: Cell, motion: Motion | None = None) -> Scenario:
        """Return the scenario between two cells, by default under the motion of such files.

        Raises:
            ScenarioError: as for :class:`~antgym.maps.world.Scenario`.
        """
        return Scenario(self.world, start, goal, motion or self.motion, self.source)


def _turn(yaw: float) -> Floats:
    cos, sin = math.cos(yaw), math.sin(yaw)
    return np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
