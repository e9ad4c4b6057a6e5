"""Flats: what the worlds that are one cell high share.

Their cells are squares of 0.1 m, as on a service robot's map, and the motion is that of such maps: eight
neighbours, no cutting of corners. Obstacles count as grown by the robot's radius already (zhang2011), so a gap
one cell wide is one that the robot fits through. No length enters other than as a ratio, so the unit says
where these worlds come from and nothing else.
"""

import numpy as np
from numpy.typing import NDArray

from antgym.maps.motion import Motion
from antgym.maps.world import GridWorld, Scenario

TILE = 0.1  # m
FAR = 0.5  # of the side, at least, from start to goal
GRID8 = Motion("grid8")


def across(
    rng: np.random.Generator, blocked: NDArray[np.bool_], name: str, rooms: NDArray[np.int64] | None = None
) -> Scenario | None:
    """Return a scenario between two free cells that are connected and far apart, None if the first has no such.

    Args:
        rng: source of all randomness.
        blocked: (n, n) bool.
        name: of the scenario.
        rooms: (n, n) int, the room that a cell lies in, 0 for none; start and goal then lie in two of them.
    """
    from scipy.ndimage import label

    parts, _ = label(~blocked)  # by sides alone: where no corner is cut, eight neighbours lead no farther
    cells = np.argwhere(~blocked if rooms is None else ~blocked & (rooms > 0))
    if not len(cells):
        return None
    start = rng.choice(cells)
    good = (np.hypot(*(cells - start).T) >= FAR * len(blocked)) & (parts[*cells.T] == parts[*start])
    if rooms is not None:
        good &= rooms[*cells.T] != rooms[*start]
    if not good.any():
        return None
    (xs, ys), (xg, yg) = start.tolist(), rng.choice(cells[good]).tolist()
    return Scenario(
        GridWorld((~blocked).astype(np.uint8), (TILE, TILE, TILE)), (xs, ys, 0), (xg, yg, 0), GRID8, name
    )
