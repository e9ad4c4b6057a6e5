"""Solids: what the layered worlds are built of, and three families of them: forest, boxes and pockets.

Every wall is at least ``WALL`` cells thick, so that no layered move gets past it, two cells sideways in one layer
though it may go, nor slips through where two walls meet. Places and sizes are shares of the world's side: a family
looks alike at every size.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antgym.maps.generators.draws import EDGE, redrawn
from antgym.maps.world import Cell, GridWorld, Scenario

Blocked = NDArray[np.bool_]

WALL = 2


class Line(NamedTuple):
    """The straight line from a cell of the first layer to one of the last."""

    start: Cell
    goal: Cell

    def at(self, x: float) -> NDArray[np.float64]:
        """Return (2,) float64, the y and z of the line at x, in cells."""
        first, last = (np.array(end[1:], dtype=np.float64) for end in self)
        return first + (last - first) * (x / self.goal[0])

    def through(self, blocked: Blocked, name: str) -> Scenario | None:
        """Return the scenario in a world of (n, n, n) blocked cells, None if an end of the line is one of them."""
        if blocked[self.start] or blocked[self.goal]:
            return None
        world = GridWorld((~blocked).astype(np.uint8), (EDGE, EDGE, EDGE))
        return Scenario(world, self.start, self.goal, name=name)


def any_line(rng: np.random.Generator, size: int) -> Line:
    """Draw where the way begins and ends, anywhere in the first and in the last layer, in the air as well."""
    (ys, zs), (yg, zg) = rng.integers(size, size=(2, 2)).tolist()
    return Line((0, ys, zs), (size - 1, yg, zg))


def nothing(size: int) -> Blocked:
    """Return (size, size, size) bool without a blocked cell."""
    return np.zeros((size, size, size), dtype=np.bool_)


def box(blocked: Blocked, low: Sequence[int], high: Sequence[int]) -> None:
    """Block the cells from one corner up to, but not including, the other, as far as they lie in the world."""
    blocked[_span(low, high)] = True


def cup(blocked: Blocked, low: Sequence[int], high: Sequence[int]) -> None:
    """Block the walls of a box that is open towards the start; where the world ends, its border is the wall.

    One that is too small to have an inside is a plain box.
    """
    inner_low = [low[0], *(a + WALL if a > 0 else a for a in low[1:])]
    inner_high = [b - WALL if b < n else b for b, n in zip(high, blocked.shape, strict=True)]
    shell = np.zeros_like(blocked)
    box(shell, low, high)
    shell[_span(inner_low, inner_high)] = False
    blocked |= shell


def bowl(size: int, mouth: tuple[float, float, float], depth: float, radius: float) -> Blocked:
    """Return a wall round half an ellipsoid, cut through its centre, the mouth, across its axis along x.

    Whatever cell a move out of the inside could end in is part of the wall, whether or not moves are checked for
    what they cross.
    """
    from scipy.ndimage import maximum_filter

    cells = np.indices((size, size, size), sparse=True)
    x, y, z = (axis - centre for axis, centre in zip(cells, mouth, strict=True))
    inside = (x / depth) ** 2 + (y**2 + z**2) / radius**2 <= 1
    return maximum_filter(inside, 2 * WALL + 1) & ~inside & (x >= 0)


def forest(rng: np.random.Generator, size: int = 21) -> Scenario:
    """Draw a forest: trunks from floor to ceiling, of varying thickness, and some that have grown together.

    Those form walls across the way and pockets that are open towards the start, most of them near the
    straight line: an ant that walks into one dies there. Two numbers set the character: ``density`` how
    many trunks stand alone, ``growth`` how many walls and pockets there are.
    """
    return redrawn(_forest, "forest", rng, size)


def boxes(rng: np.random.Generator, size: int = 21) -> Scenario:
    """Draw boxes of all sizes, on the ground and in the air, some of them hollow and open towards the start.

    An ant that walks into a hollow one dies there. Two numbers set the character: ``density`` how much of the
    world is blocked, 15 to 50 %, ``hollowness`` how many boxes are hollow.
    """
    return redrawn(_boxes, "boxes", rng, size)


def pockets(rng: np.random.Generator, size: int = 21) -> Scenario:
    """Draw pockets: bowls that are open towards the start, on or near the straight line to the goal.

    A greedy ant walks into the first and dies there; one that swerves in time gets past. Two numbers set the
    character: ``depth`` how deep the bowls are, from plates to tubes, ``spread`` how far they lie off the line.
    """
    return redrawn(_pockets, "pockets", rng, size)


def _forest(rng: np.random.Generator, size: int, density: float, growth: float) -> Scenario | None:
    line, blocked = any_line(rng, size), nothing(size)
    x, y = np.mgrid[0:size, 0:size]
    while np.count_nonzero(blocked[:, :, 0]) < (0.04 + 0.16 * density) * size**2:
        (px, py), radius = rng.uniform(0, size, 2), rng.uniform(1.0, max(1.5, 0.08 * size))
        blocked[(x - px) ** 2 + (y - py) ** 2 <= radius**2] = True
    for _ in range(1 + rng.poisson(1 + 3 * growth)):
        back = rng.uniform(0.2, 0.9) * size
        side = line.at(back)[0] + rng.normal(0, 0.2 * size)
        depth, width = rng.uniform((0.0, 0.3), (0.35, 0.9)) * size
        low = round(back - depth), round(side - width / 2), 0
        cup(blocked, low, (round(back) + WALL, low[1] + max(round(width), 2 * WALL + 1), size))
    return line.through(blocked, "forest")


def _boxes(rng: np.random.Generator, size: int, density: float, hollowness: float) -> Scenario | None:
    line, blocked = any_line(rng, size), nothing(size)
    while np.count_nonzero(blocked) < (0.15 + 0.35 * density) * blocked.size:
        edges = np.maximum(rng.uniform((0.12, 0.25, 0.25), (0.35, 1.1, 1.1)) * size, WALL).round()
        low = rng.uniform(-edges / 2, size - edges / 2).round()
        if rng.random() < 0.5:
            low[2] = 0
        shape = cup if rng.random() < 0.2 + 0.8 * hollowness else box
        shape(blocked, low.astype(int).tolist(), (low + edges).astype(int).tolist())
    return line.through(blocked, "boxes")


def _pockets(rng: np.random.Generator, size: int, depth: float, spread: float) -> Scenario | None:
    line, blocked = any_line(rng, size), nothing(size)
    for _ in range(1 + rng.poisson(2)):
        back = rng.uniform(0.2, 0.85) * size
        side, height = line.at(back) + rng.normal(0, 0.2 * spread * size, 2)
        along, across = rng.uniform((0.1, 0.2), (0.2 + 0.4 * depth, 0.5)) * size
        blocked |= bowl(size, (back - along, side, height), max(along - WALL, 1), max(across - WALL, 1))
    return line.through(blocked, "pockets")


def _span(low: Sequence[int], high: Sequence[int]) -> tuple[slice, ...]:
    return tuple(slice(max(a, 0), max(b, 0)) for a, b in zip(low, high, strict=True))
