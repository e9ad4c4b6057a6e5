"""Passages: mazes of corridors."""

import numpy as np
from numpy.typing import NDArray

from antgym.maps.generators.draws import redrawn
from antgym.maps.generators.flats import across
from antgym.maps.world import Scenario

KNOCKED_OUT = 0.3  # of the inner walls, at most
SIDES = ((1, 0), (0, 1), (-1, 0), (0, -1))


def mazes(rng: np.random.Generator, size: int = 21) -> Scenario:
    """Draw a maze of corridors, one or two cells wide, with some of its walls knocked out.

    Two numbers set the character: ``branching`` from few long dead ends to many short ones, ``loops`` how many
    walls are missing, so that there are several ways.
    """
    return redrawn(_mazes, "mazes", rng, size)


def _mazes(rng: np.random.Generator, size: int, branching: float, loops: float) -> Scenario | None:
    width = int(rng.integers(1, 3))
    junctions = (size + 1) // (width + 1)
    closed = _tree(rng, 2 * junctions - 1, branching)
    walls = np.add.outer(np.arange(len(closed)), np.arange(len(closed))) % 2 == 1
    closed &= ~(walls & (rng.random(closed.shape) < KNOCKED_OUT * loops))
    widths = np.where(np.arange(len(closed)) % 2 == 0, width, 1)
    blocked = np.ones((size, size), dtype=np.bool_)
    used = int(widths.sum())
    blocked[:used, :used] = closed.repeat(widths, axis=0).repeat(widths, axis=1)
    return across(rng, blocked, "mazes")


def _tree(rng: np.random.Generator, side: int, branching: float) -> NDArray[np.bool_]:
    """Return (side, side) bool, True where closed: junctions at even indices, joined by exactly one way.

    The tree grows from its newest junction, or with probability ``branching`` from any.
    """
    closed = np.ones((side, side), dtype=np.bool_)
    closed[0, 0] = False
    growing = [(0, 0)]
    while growing:
        index = int(rng.integers(len(growing))) if rng.random() < branching else -1
        i, j = growing[index]
        ways = [(di, dj) for di, dj in SIDES if _is_new(closed, i + 2 * di, j + 2 * dj)]
        if not ways:
            growing.pop(index)
            continue
        di, dj = ways[rng.integers(len(ways))]
        closed[i + di, j + dj] = closed[i + 2 * di, j + 2 * dj] = False
        growing.append((i + 2 * di, j + 2 * dj))
    return closed


def _is_new(closed: NDArray[np.bool_], i: int, j: int) -> bool:
    return 0 <= i < len(closed) and 0 <= j < len(closed) and bool(closed[i, j])
