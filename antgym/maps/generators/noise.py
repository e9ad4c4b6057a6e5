"""Noise: smooth random fields, cut at a level: caves in the layered worlds, clutter in the flat ones."""

import numpy as np
from numpy.typing import NDArray

from antgym.maps.generators.draws import redrawn
from antgym.maps.generators.flats import across
from antgym.maps.generators.solids import Line
from antgym.maps.world import Scenario

CHAMBER = np.array([1.2, 1.0, 2.5])  # higher than wide, as clefts are: a low rock would be flown over


def caves(rng: np.random.Generator, size: int = 21) -> Scenario:
    """Draw caves: clefts and chambers in rock, the highest part of smooth noise.

    They branch, and many a branch is blind. Two numbers set the character: ``tightness`` how much of the world
    is rock, 55 to 80 %, ``scale`` how wide the clefts are. Start and goal lie anywhere in the first and in the
    last layer.
    """
    return redrawn(_caves, "caves", rng, size)


def clutter(rng: np.random.Generator, size: int = 21) -> Scenario:
    """Draw a floor that is strewn with obstacles: random cells or small blobs.

    At 20 cells a side and a quarter of them blocked it is the kind of world that wei2018 plans in. Two numbers
    set the character: ``density``, 15 to 40 % blocked, ``clumping`` from single cells to blobs.
    """
    return redrawn(_clutter, "clutter", rng, size)


def _caves(rng: np.random.Generator, size: int, tightness: float, scale: float) -> Scenario | None:
    rock = _highest(rng, (size, size, size), CHAMBER * (0.04 + 0.05 * scale) * size, 0.55 + 0.25 * tightness)
    first, last = (np.argwhere(~rock[x]) for x in (0, -1))
    if not (len(first) and len(last)):
        return None
    (ys, zs), (yg, zg) = rng.choice(first).tolist(), rng.choice(last).tolist()
    return Line((0, ys, zs), (size - 1, yg, zg)).through(rock, "caves")


def _clutter(rng: np.random.Generator, size: int, density: float, clumping: float) -> Scenario | None:
    return across(
        rng, _highest(rng, (size, size), np.full(2, 1.2 * clumping), 0.15 + 0.25 * density), "clutter"
    )


def _highest(
    rng: np.random.Generator, shape: tuple[int, ...], widths: NDArray[np.float64], share: float
) -> NDArray[np.bool_]:
    """Return where noise that is smoothed over ``widths`` cells along each axis is highest, in that share."""
    from scipy.ndimage import gaussian_filter

    noise = gaussian_filter(rng.standard_normal(shape), widths)
    return noise > np.quantile(noise, 1 - share)
