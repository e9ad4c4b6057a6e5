"""Relief: mountains, a height field with free air above it."""

import numpy as np
from numpy.typing import NDArray

from antgym.maps.generators.draws import EDGE, redrawn, straight_line
from antgym.maps.shaping import voxelise
from antgym.maps.world import Cell, GridWorld, Scenario

Heights = NDArray[np.float64]


def mountains(rng: np.random.Generator, size: int = 21) -> Scenario:
    """Draw mountains in the manner of liu2020: from open hills to ceiling-high ridges with passes.

    The surface is a sum of smooth peaks. Over it stand *walls*, ridges across the straight line from start
    to goal, each with one or two passes, and *spurs*, short ridges along the way without one. They cut the
    ground into valleys, some of them blind: an ant that walks into one dies there. Two numbers, uniform in
    [0, 1] and kept over redraws, set the character: ``ruggedness`` how many ridges there are and how high,
    ``alignment`` how often a pass lies on the straight line, where a greedy ant finds it, and not
    elsewhere, where it must be looked for. The start lies on the surface in the first layer, the goal on
    the surface in the last, each at a random y.

    A world is redrawn for the reasons that every family has, the straight line being what a path that needs no
    tuning is measured by.

    Args:
        rng: source of all randomness.
        size: cells along x, y and z, at least 8; cells are cubes of 15 mm.

    Raises:
        MapError: if the size is below 8.
    """
    return redrawn(_mountains, "mountains", rng, size, straight_line)


def over_surface(world: GridWorld, first: int, last: int, name: str) -> Scenario | None:
    """Return the scenario between the lowest free cells of two columns, y given, or None if one is full."""
    if not (world.free[0, first].any() and world.free[-1, last].any()):
        return None
    start: Cell = (0, first, int(world.free[0, first].argmax()))
    goal: Cell = (world.shape[0] - 1, last, int(world.free[-1, last].argmax()))
    return Scenario(world, start, goal, name=name)


def _mountains(rng: np.random.Generator, size: int, ruggedness: float, alignment: float) -> Scenario | None:
    ends = rng.integers(size, size=2)
    heights = _relief(rng, size, (ends + 0.5) / size, ruggedness, alignment)
    world = voxelise(heights * size * EDGE, size, (EDGE, EDGE, EDGE))
    return over_surface(world, int(ends[0]), int(ends[1]), "mountains")


def _relief(
    rng: np.random.Generator, size: int, ends: NDArray[np.float64], ruggedness: float, alignment: float
) -> Heights:
    """Draw (size, size) heights, 1 being the ceiling, between ends at the given y in [0, 1]."""
    x, y = np.meshgrid(*[(np.arange(size) + 0.5) / size] * 2, indexing="ij")
    hills = np.zeros((size, size))
    for _ in range(3 + rng.poisson(4)):
        hills += _peak(rng, x, y) * (0.5 + ruggedness)
    ridges = []
    for _ in range(rng.binomial(4, 0.1 + 0.6 * ruggedness)):
        ridges.append(_wall(rng, x, y, ends, ruggedness, alignment))
    for _ in range(rng.poisson(2.5 * ruggedness)):
        ridges.append(_spur(rng, x, y))
    return np.maximum.reduce([hills, *ridges])


def _peak(rng: np.random.Generator, x: Heights, y: Heights) -> Heights:
    (px, py), width = rng.random(2), rng.uniform(0.05, 0.14)
    return rng.uniform(0.1, 0.7) * np.exp(-((x - px) ** 2 + (y - py) ** 2) / (2 * width**2))


def _wall(
    rng: np.random.Generator,
    x: Heights,
    y: Heights,
    ends: NDArray[np.float64],
    ruggedness: float,
    alignment: float,
) -> Heights:
    angle = np.radians(rng.uniform(-50, 50))
    px = rng.uniform(0.15, 0.85)
    py = ends[0] + px * (ends[1] - ends[0])  # the straight line crosses the wall here
    across = (x - px) * np.cos(angle) - (y - py) * np.sin(angle)
    along = (x - px) * np.sin(angle) + (y - py) * np.cos(angle)
    crest = np.full_like(x, rng.uniform(0.5 + 0.5 * ruggedness, 1.0 + ruggedness))
    for _ in range(rng.integers(1, 3)):
        on_line = rng.random() < alignment
        place = rng.normal(0, 0.03) if on_line else (rng.random() - py) / np.cos(angle)
        width, floor = rng.uniform(0.06, 0.12), rng.uniform(0.0, 0.6)
        crest *= 1 - (1 - floor) * np.exp(-(((along - place) / width) ** 4))
    return crest * _profile(rng, across)


def _spur(rng: np.random.Generator, x: Heights, y: Heights) -> Heights:
    angle, half = np.radians(rng.uniform(-20, 20)), rng.uniform(0.1, 0.25)
    px, py = rng.uniform(0.2, 0.8), rng.uniform(0.1, 0.9)
    along = (x - px) * np.cos(angle) + (y - py) * np.sin(angle)
    across = (y - py) * np.cos(angle) - (x - px) * np.sin(angle)
    beyond = np.maximum(np.abs(along) - half, 0)
    return rng.uniform(0.6, 1.4) * _profile(rng, np.hypot(across, beyond))


def _profile(rng: np.random.Generator, distance: Heights) -> Heights:
    """Return the cross-section of a ridge, 1 at its crest."""
    width = 1 / len(distance) + rng.uniform(0.0, 0.04)  # a thinner one would let diagonal moves slip through
    return np.exp(-(distance**2) / (2 * width**2))
