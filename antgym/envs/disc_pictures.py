"""Pictures of disc worlds: the discs from above, the sources that a hive keeps, and its best path over them."""

from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antgym.envs.grid_pictures import GOAL, HIGH, LOW, PATH, PHEROMONE, SIDE, START
from antgym.maps.disc_chart import blocks_of
from antgym.maps.disc_features import raster
from antgym.maps.discs import DiscScenario, DiscWorld, Floats
from antgym.planners.hive import Hive

COLUMNS, ROWS = 56, 28  # of the longer side, in characters, which are twice as high as wide
_SAFE = 0.25  # how much a place looks like a disc where it is nearer to one than D_safe


def canvas(scenario: DiscScenario, hive: Hive | None) -> NDArray[np.str_]:
    """Return (columns, rows) characters: ``#`` discs, ``.`` way-points, ``o`` the path, ``S`` and ``G`` its ends."""
    world = scenario.world
    columns, rows = _shape(world, COLUMNS, ROWS)
    drawn = np.where(raster(world, columns, rows) <= 0, "#", " ")
    marked: list[tuple[ArrayLike, str]] = [([scenario.start], "S"), ([scenario.goal], "G")]
    if hive is not None:
        path = _along(hive.result().path, world, columns)
        marked = [(hive.sources.reshape(-1, 2), "."), (path, "o"), *marked]
    for points, mark in marked:
        drawn[tuple(blocks_of(world, points, columns, rows).T)] = mark
    return drawn


def pixels(scenario: DiscScenario, hive: Hive | None) -> NDArray[np.float64]:
    """Return the world from above, (h, w, 3) in [0, 1], x to the right: sources blue, the best path red."""
    world = scenario.world
    columns, rows = _shape(world, SIDE, SIDE)
    gaps = raster(world, columns, rows)
    shade = np.where(gaps <= 0, 1.0, np.where(gaps < world.safe_distance, _SAFE, 0.0))
    image = LOW + shade[..., None] * (HIGH - LOW)
    if hive is not None:
        for source in hive.sources:
            _draw(image, _along(source, world, columns), world, PHEROMONE, 0)
        _draw(image, _along(hive.result().path, world, columns), world, PATH, 1)
    for end, colour in ((scenario.start, START), (scenario.goal, GOAL)):
        _draw(image, np.array([end]), world, colour, 6)
    return image.transpose(1, 0, 2)[::-1]


def _shape(world: DiscWorld, columns: int, rows: int) -> tuple[int, int]:
    """Return columns and rows, the given ones along the longer side; a narrow world still gets a few."""
    x_min, x_max, y_min, y_max = world.bounds
    across, up = (x_max - x_min) / world.width, (y_max - y_min) / world.width
    return max(8, round(columns * across)), max(8, round(rows * up))


def _along(path: Floats, world: DiscWorld, count: int) -> Floats:
    """Return (n, 2) points along a path, two of them at least for each of ``count`` parts of the world's width."""
    parts = [path[:1]]
    for here, there in pairwise(path):
        steps = 2 + int(2 * count * np.hypot(*(there - here)) / world.width)
        parts.append(here + np.linspace(0, 1, steps)[:, None] * (there - here))
    return np.concatenate(parts)


def _draw(
    image: NDArray[np.float64], points: Floats, world: DiscWorld, colour: NDArray[np.float64], radius: int
) -> None:
    """Colour the squares of 2 radius + 1 pixels round points, cut at the border."""
    columns, rows = image.shape[:2]
    at, last = blocks_of(world, points, columns, rows), np.array([columns, rows]) - 1
    around = np.arange(-radius, radius + 1)
    for offset in np.stack(np.meshgrid(around, around), axis=-1).reshape(-1, 2):
        image[tuple(np.clip(at + offset, 0, last).T)] = colour
