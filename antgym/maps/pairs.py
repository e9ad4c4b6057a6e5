"""Pairs: starts and goals on a map that names none, and which parts of it are joined."""

import hashlib
from collections.abc import Iterator
from itertools import islice
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antgym.errors import ScenarioError
from antgym.maps.generators.draws import has_path
from antgym.maps.generators.relief import over_surface
from antgym.maps.map import Map
from antgym.maps.world import GridWorld, Scenario

TRIES = 60  # draws for every pair that is asked for
GOALS = 8  # of so many goals that are drawn, the farthest is taken


class Components(NamedTuple):
    """The parts of a world that are joined by faces of free cells.

    Attributes:
        labels: (nx, ny, nz) int32, 0 where blocked.
        sizes: (n,) free cells of parts 1, 2, ..., n.
    """

    labels: NDArray[np.int32]
    sizes: NDArray[np.int64]


def components(world: GridWorld) -> Components:
    """Return the parts of a world; no move that cuts no corner leads from one to another."""
    from scipy.ndimage import label

    labels, count = label(world.free)
    return Components(labels, np.bincount(labels.reshape(-1), minlength=count + 1)[1:])


def drawn(map_: Map, count: int) -> tuple[Scenario, ...]:
    """Return scenarios between places of a map that are drawn at random, but the same for the same world.

    On ground, from the surface of the first layer to that of the last, under the layered motion; on others, from a free
    cell of the largest part to the farthest of eight more. Fewer than ``count``, or none, where no more are found.
    """
    digest = hashlib.sha256(map_.world.frame.encode())
    for part in map_.world.contents():
        digest.update(part)
    rng = np.random.default_rng(int(digest.hexdigest(), 16))
    found = (_over_ground if map_.motion.layered else _in_largest)(map_, rng, TRIES * count)
    return tuple(islice((scenario for scenario in found if has_path(scenario)), count))


def _over_ground(map_: Map, rng: np.random.Generator, tries: int) -> Iterator[Scenario]:
    for first, last in rng.integers(map_.world.shape[1], size=(tries, 2)).tolist():
        try:
            scenario = over_surface(map_.world, first, last, map_.source)
        except ScenarioError:  # too far aside for so few layers
            continue
        if scenario is not None:
            yield scenario


def _in_largest(map_: Map, rng: np.random.Generator, tries: int) -> Iterator[Scenario]:
    parts = components(map_.world)
    if not len(parts.sizes) or parts.sizes.max() < 2:
        return
    cells = np.flatnonzero(parts.labels == parts.sizes.argmax() + 1)
    for _ in range(tries):
        chosen = rng.choice(cells, GOALS + 1)
        start, *goals = np.stack(np.unravel_index(chosen, map_.world.shape), axis=1)
        away = ((np.array(goals) - start) * map_.world.cell) ** 2
        goal = goals[int(away.sum(axis=1).argmax())]
        if (goal != start).any():
            yield map_.scenario(tuple(start.tolist()), tuple(goal.tolist()))
