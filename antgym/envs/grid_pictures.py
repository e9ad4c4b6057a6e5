"""Pictures of grids: terrain from above and from the side, pheromone and path over it."""

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from antgym.maps.world import Scenario
from antgym.planners.colony import Colony

SIDE = 480  # pixels of the longer edge of a panel
_SHADES = " .:-=+*%"
LOW, HIGH = np.array([0.93, 0.91, 0.86]), np.array([0.35, 0.30, 0.27])  # valley and summit
PHEROMONE, PATH = np.array([0.10, 0.55, 0.75]), np.array([0.85, 0.15, 0.10])
START, GOAL = np.array([0.10, 0.60, 0.20]), np.array([0.95, 0.70, 0.05])


def canvas(scenario: Scenario, colony: Colony | None) -> NDArray[np.str_]:
    """Return (nx, ny) characters: shades are heights, ``o`` the path, ``S`` and ``G`` its ends."""
    height = _relative_height(scenario.world.free)
    drawn = np.array(list(_SHADES))[np.minimum(height * len(_SHADES), len(_SHADES) - 1).astype(int)]
    if colony is not None:
        for x, y, _ in colony.result().path:
            drawn[x, y] = "o"
    drawn[scenario.start[:2]], drawn[scenario.goal[:2]] = "S", "G"
    return drawn


def pixels(scenario: Scenario, colony: Colony | None) -> NDArray[np.float64]:
    """Return two panels, (h, w, 3) in [0, 1]: from above (x, y) and from the side (x, z), both with x to the right.

    A flat world is shown from above alone.
    """
    path, cells, amounts = np.empty((0, 3), np.int64), np.empty((0, 3), np.int64), np.empty(0)
    if colony is not None:
        path, (cells, amounts) = colony.result().path, colony.pheromone()
    height = _relative_height(scenario.world.free)
    skyline = scenario.world.free.min(axis=1)  # a cell of the side view is open where it is free for every y
    side = np.where(skyline, 0.05, 0.2 + 0.6 * (1 - scenario.world.free.mean(axis=1)))
    panels = []
    for shade, axis in ((height, 1), (side, 2))[: 1 if scenario.world.shape[2] == 1 else 2]:
        image = LOW + shade[..., None] * (HIGH - LOW)
        glow = np.zeros(shade.shape)
        np.maximum.at(glow, (cells[:, 0], cells[:, axis]), amounts)
        image += 0.8 * glow[..., None] * (PHEROMONE - image)
        scale = max(1, SIDE // max(shade.shape))
        panel = image.repeat(scale, axis=0).repeat(scale, axis=1)
        _draw_line(panel, path[:, [0, axis]], scale)
        for end, colour in ((scenario.start, START), (scenario.goal, GOAL)):
            _draw_dot(panel, np.array([end[0], end[axis]]), scale, 0.45, colour)
        panels.append(panel.transpose(1, 0, 2)[::-1])
    gap = np.ones((4, panels[0].shape[1], 3))
    return np.vstack([panels[0], *(part for panel in panels[1:] for part in (gap, panel))])


def _relative_height(free: NDArray[np.uint8]) -> NDArray[np.float64]:
    """Return the height of every column, (nx, ny) in [0, 1]: its highest blocked cell."""
    levels = free.shape[2]
    return np.where((free == 0).any(axis=2), levels - (free == 0)[:, :, ::-1].argmax(axis=2), 0) / levels


def _draw_line(pixels: NDArray[np.float64], cells: NDArray[np.int64], scale: int) -> None:
    for here, there in pairwise(cells):
        for t in np.linspace(0, 1, 2 * scale):
            _draw_dot(pixels, here + t * (there - here), scale, 0.12, PATH)


def _draw_dot(
    pixels: NDArray[np.float64],
    cell: NDArray[np.float64],
    scale: int,
    size: float,
    colour: NDArray[np.float64],
) -> None:
    radius = max(1, round(size * scale))
    row, column = np.round((cell + 0.5) * scale).astype(int)
    pixels[max(0, row - radius) : row + radius, max(0, column - radius) : column + radius] = colour
