"""Surroundings: the part of a world that a scenario's paths can use, and quick looks at single places of it.

Whatever is asked of a place costs the same in a world of any size: blocked cells are counted in boxes by sums over
all cells below a corner, made once. Distances are in cells and count a diagonal neighbour as one away.
"""

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from antgym.maps.moves import within_reach
from antgym.maps.world import PAD, Scenario

SAMPLE = 256  # free cells that are looked at one by one
LINE_SAMPLES = 4  # per cell of the straight line
FARTHEST = 15  # cells; an obstacle farther away counts as that far
ASIDE = 2  # cells, PAD at most; how far to either side a narrow place is looked for

Cells = NDArray[np.int64]


class Surroundings:
    """A scenario's usable part: under the layered motion from the start's layer to the goal's, else the world.

    Attributes:
        scenario: the scenario.
        first: (3,) int64, the world's cell that is cell (0, 0, 0) here.
        free: (nx, ny, nz) bool, the free cells.
        reach: (nx, ny, nz) bool, the cells between start and goal, see :func:`antgym.maps.moves.within_reach`.
        start: (3,) int64, the start's cell here.
        goal: (3,) int64, the goal's cell here.
    """

    def __init__(self, scenario: Scenario) -> None:
        layers = slice(scenario.start[0], scenario.goal[0] + 1) if scenario.motion.layered else slice(None)
        self.scenario = scenario
        self.first: Cells = np.array((layers.start or 0, 0, 0), dtype=np.int64)
        self.free: NDArray[np.bool_] = scenario.world.free[layers] != 0
        self.reach = within_reach(scenario)
        self.start, self.goal = (np.array(end) - self.first for end in (scenario.start, scenario.goal))

    @cached_property
    def line(self) -> Cells:
        """The cells of the straight line, (n, 3) from start to goal, LINE_SAMPLES of each."""
        apart = self.goal - self.start
        along = np.linspace(0.0, 1.0, LINE_SAMPLES * int(np.abs(apart).max()) + 1)[:, None]
        return np.floor(self.start + along * apart + 0.5).astype(np.int64)

    @cached_property
    def sample(self) -> Cells:
        """Up to SAMPLE free cells within reach, the goal not among them, (n, 3), evenly spread in their order."""
        candidates = self.free & self.reach
        candidates[tuple(self.goal)] = False
        cells = np.flatnonzero(candidates)
        spread = np.linspace(0, len(cells) - 1, min(SAMPLE, len(cells))).astype(np.int64)
        return np.stack(np.unravel_index(cells[spread], self.free.shape), axis=1)

    def blocked_share(self, centres: Cells, radius: int) -> NDArray[np.float64]:
        """Return (n,) the blocked share of the cubes of 2 radius + 1 cells round (n, 3) centres, cut at the border."""
        low, high = self._cube(centres, radius)
        return self._blocked_between(low, high) / (high - low).prod(axis=1)

    def clearance(self, cells: Cells) -> Cells:
        """Return (n,) the distance to the nearest blocked cell in cells, FARTHEST at most; borders block nothing."""
        distance, step = np.zeros(len(cells), dtype=np.int64), (FARTHEST + 1) // 2
        while step:
            open_still = self._blocked_between(*self._cube(cells, distance + step - 1)) == 0
            distance[open_still] += step
            step //= 2
        return distance

    def squeezed(self, cells: Cells) -> NDArray[np.bool_]:
        """Return (n,) bool: along some axis there is a blocked cell on both sides, at most ASIDE cells away.

        Borders block. Neither the one level of a flat world is such an axis, nor that along which layers follow.
        """
        axes = [axis for axis in range(int(self.scenario.motion.layered), 3) if self.free.shape[axis] > 1]
        outward = (
            np.eye(3, dtype=np.int64)[axes][:, None] * np.arange(1, ASIDE + 1)[:, None]
        )  # (axes, ASIDE, 3)
        at = (cells + self.first + PAD)[:, None, None]
        x, y, z = np.moveaxis(np.stack([at + outward, at - outward], axis=1), -1, 0)  # (n, 2, axes, ASIDE)
        beside = (self.scenario.world.storage[x, y, z] == 0).any(axis=3)
        return beside.all(axis=1).any(axis=1)

    def _cube(self, centres: Cells, radius: int | Cells) -> tuple[Cells, Cells]:
        """Return the cubes' lowest cells and those behind their highest, both (n, 3)."""
        around = np.reshape(radius, (-1, 1))
        return np.maximum(centres - around, 0), np.minimum(centres + around + 1, self.free.shape)

    @cached_property
    def _sums(self) -> NDArray[np.int32]:
        """(nx + 1, ny + 1, nz + 1): blocked cells below each corner along all axes."""
        sums = np.zeros([n + 1 for n in self.free.shape], dtype=np.int32)
        inner = sums[1:, 1:, 1:]
        np.cumsum(~self.free, axis=0, out=inner)
        np.cumsum(inner, axis=1, out=inner)
        np.cumsum(inner, axis=2, out=inner)
        return sums

    def _blocked_between(self, low: Cells, high: Cells) -> Cells:
        (x0, y0, z0), (x1, y1, z1), sums = low.T, high.T, self._sums
        upper = sums[x1, y1, z1] - sums[x1, y0, z1] - sums[x1, y1, z0] + sums[x1, y0, z0]
        lower = sums[x0, y1, z1] - sums[x0, y0, z1] - sums[x0, y1, z0] + sums[x0, y0, z0]
        return (upper - lower).astype(np.int64)
