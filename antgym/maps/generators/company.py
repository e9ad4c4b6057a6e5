"""Company: other robots for the one of a scenario, with which it makes a fleet.

Their ends are drawn so that the fleet is well-formed (Čáp et al. 2015): each robot has a path that meets no start and
no goal of another, so that robots that go one after the other always arrive, whatever the order. What is left unsolved
is left so by the colony.
"""

from collections.abc import Sequence
from itertools import cycle, islice
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antgym.maps.fleet import Fleet
from antgym.maps.generators.draws import has_path
from antgym.maps.generators.flats import FAR
from antgym.maps.world import GridWorld, Scenario

APART = 0.9  # cells: robots follow each other, and do not pass side by side through a door of one cell
SPEEDS = (1.0, 0.7, 1.3)  # m/s, of the first, the second, the third, and so on
TRIES = 60  # draws of all ends


def in_company(
    rng: np.random.Generator, scenario: Scenario[Any, Any], robots: int, longest: float
) -> Fleet | None:
    """Return a well-formed fleet whose first robot has the ends of a scenario, None if none is found.

    Args:
        rng: source of all randomness.
        scenario: flat, under the motion of eight neighbours that cut no corner: there, a path that enters no end of
            another keeps a cell away from it.
        robots: in all, at least two.
        longest: shortest path of each robot, in straight lines, at most.
    """
    from scipy.ndimage import label

    world = scenario.world
    parts, _ = label(world.free)
    cells = np.argwhere(parts == parts[scenario.start])
    for _ in range(TRIES):
        chosen = rng.choice(len(cells), size=(2, robots - 1), replace=False)
        starts, goals = cells[chosen]
        if _far(starts, goals, world.shape[0]) and not _taken(cells[chosen.ravel()], scenario):
            ends = zip(starts.tolist(), goals.tolist(), strict=True)
            others = [Scenario(world, s, g, scenario.motion, scenario.name) for s, g in ends]
            team = [scenario, *others]
            if all(r.optimum <= longest * r.straight_line for r in others) and _well_formed(team):
                speeds = tuple(islice(cycle(SPEEDS), robots))
                return Fleet(team, APART * min(world.cell), speeds, scenario.name)
    return None


def _far(starts: NDArray[np.int64], goals: NDArray[np.int64], side: int) -> bool:
    """Whether every robot has as far to go as the first."""
    return bool((np.linalg.norm(goals - starts, axis=1) >= FAR * side).all())


def _taken(cells: NDArray[np.int64], scenario: Scenario) -> bool:
    """Whether one of some cells is an end of a scenario."""
    ends = np.array([scenario.start, scenario.goal])
    return bool((cells[:, None] == ends).all(axis=2).any())


def _well_formed(team: Sequence[Scenario]) -> bool:
    """Whether each robot has a path that meets no end of another."""
    world = team[0].world
    for robot in team:
        free = world.free.copy()
        for other in team:
            free[other.start] = free[other.goal] = 0
        free[robot.start] = free[robot.goal] = 1
        if not has_path(Scenario(GridWorld(free, world.cell), robot.start, robot.goal, robot.motion)):
            return False
    return True
