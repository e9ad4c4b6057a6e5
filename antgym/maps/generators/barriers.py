"""Barriers: solid ridges across the way."""

import numpy as np
from numpy.typing import NDArray

from antgym.maps.generators.draws import redrawn
from antgym.maps.generators.solids import WALL, Blocked, Line, any_line, nothing
from antgym.maps.world import Scenario


def ridges(rng: np.random.Generator, size: int = 21) -> Scenario:
    """Draw ridges from floor to ceiling across the way, with passes and windows, and alleys between them.

    The alleys run between spurs, walls along the way; those that end at the next ridge are blind: an ant
    that walks into one dies there. Two numbers set the character: ``ruggedness`` how many ridges and spurs there
    are, ``alignment`` how often a gap lies on the straight line, where a greedy ant finds it, and not
    elsewhere, where it must be looked for.
    """
    return redrawn(_ridges, "ridges", rng, size)


def _ridges(rng: np.random.Generator, size: int, ruggedness: float, alignment: float) -> Scenario | None:
    line, blocked = any_line(rng, size), nothing(size)
    count = 1 + rng.binomial(3, 0.2 + 0.7 * ruggedness)
    for share in (np.arange(count) + rng.uniform(0.35, 0.85, count)) / count:
        blocked |= _ridge(rng, size, share * size, line, alignment)
    return line.through(blocked, "ridges")


def _ridge(rng: np.random.Generator, size: int, place: float, line: Line, alignment: float) -> Blocked:
    """Return one ridge; it is slanted by at most one cell in two, so that WALL cells along x close it."""
    x, y, z = np.indices((size, size, size), sparse=True)
    front = np.floor(place + rng.uniform(-0.5, 0.5) * (y - size / 2))
    crest = size if rng.random() < 0.7 else round(size * rng.uniform(0.8, 1.0))
    ridge = (x >= front) & (x < front + WALL + rng.integers(1 + size // 12)) & (z < crest)
    for _ in range(rng.integers(1, 3)):
        ridge &= ~_gap(rng, size, line.at(place), alignment)
    for _ in range(rng.poisson(1.5)):
        foot, length = rng.integers(size), rng.uniform(0.15, 0.35) * size
        ridge |= (y >= foot) & (y < foot + WALL) & (x >= front - length) & (x < front) & (z < crest)
    return ridge


def _gap(rng: np.random.Generator, size: int, crossing: NDArray[np.float64], alignment: float) -> Blocked:
    """Return (1, size, size): a pass, free up to the ceiling, or a window, where the line crosses or anywhere."""
    _, y, z = np.indices((1, size, size), sparse=True)
    on_line = rng.random() < 0.7 * alignment
    py, pz = crossing + rng.normal(0, 0.03 * size, 2) if on_line else rng.uniform(0, size, 2)
    width, height = np.maximum(rng.uniform(0.05, 0.12, 2) * size, 1)
    top = np.inf if rng.random() < 0.5 else pz + height
    return (np.abs(y - py) <= width) & (z >= pz - height) & (z <= top)
