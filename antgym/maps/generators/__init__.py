"""Generators: seeded families of scenarios, and scenarios cut from real terrain.

A family is a function of a random generator and a size, cells a side, at least 8: the same generator state gives the
same scenario. It draws two numbers, uniform in [0, 1], that set the scenario's character, then worlds of that
character until one is worthwhile: it has a path, it is seldom one where any greedy ant goes straight to the goal, and
it is not hopeless (``draws.redrawn``). A family is as varied as it is for a reason: where plain greed always
wins, or nothing does, there are no parameters to choose.

``mountains``, ``ridges``, ``forest``, ``boxes``, ``caves`` and ``pockets`` are cubes of 15 mm cells under the layered
motion, in which no ant turns round, so that a blind valley kills. ``rooms``, ``mazes``, ``clutter`` and ``warehouse``
are flat, of 0.1 m cells, under the motion of eight neighbours.
"""

from collections.abc import Callable

import numpy as np

from antgym.maps.generators.barriers import ridges
from antgym.maps.generators.draws import (
    EDGE,
    KEPT,
    MAX_DRAWS,
    NEARLY_STRAIGHT,
    RARELY,
    SMALLEST,
    random_arrival,
)
from antgym.maps.generators.floors import rooms, warehouse
from antgym.maps.generators.noise import caves, clutter
from antgym.maps.generators.passages import mazes
from antgym.maps.generators.relief import mountains
from antgym.maps.generators.solids import boxes, forest, pockets
from antgym.maps.generators.windows import SAMPLES_PER_CELL, terrain_windows
from antgym.maps.world import Scenario

__all__ = [
    "EDGE",
    "FAMILIES",
    "KEPT",
    "MAX_DRAWS",
    "NEARLY_STRAIGHT",
    "RARELY",
    "SAMPLES_PER_CELL",
    "SMALLEST",
    "boxes",
    "caves",
    "clutter",
    "forest",
    "mazes",
    "mountains",
    "pockets",
    "random_arrival",
    "ridges",
    "rooms",
    "terrain_windows",
    "warehouse",
]

FAMILIES: dict[str, Callable[[np.random.Generator, int], Scenario]] = {
    family.__name__: family
    for family in (mountains, ridges, forest, boxes, caves, pockets, rooms, mazes, clutter, warehouse)
}
