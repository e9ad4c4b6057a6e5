"""Placing: which robot of a fleet goes when, over paths that a colony finds; a dialogue with whoever plans them.

Robots are placed one after the other. Each follows the path that its colony found, at times that meet nobody who was
placed before: it is staggered, by waits anywhere on the way. Where that delays it, it is planned again with a safety
radius blocked around the cell that it heads for where it would meet somebody, a few times, and the earliest arrival
counts. A robot that cannot be placed at all goes to the front of the order, and everything begins anew, now with an eye
to where later ones still stand.

Nothing here plans, nor knows an optimum: a generator yields the scenarios that it wants planned and is sent their ways,
so that those of many fleets are planned in one call.
"""

import math
from collections.abc import Generator, Sequence
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from antgym.maps.fleet import ROUNDING, Fleet
from antgym.maps.world import GridWorld, Scenario
from antgym.planners.schedules import schedule
from antgym.planners.timed import TimedPath, meeting

DETOURS = 4  # plans around a place of conflict, at most, every time that a robot is placed

Floats = NDArray[np.float64]


class Way(NamedTuple):
    """What a colony found: (n, 3) points in world units, and the length as the colony adds it up."""

    points: Floats
    length: float


class Placed(NamedTuple):
    """A robot's path with its times, and its length as the colony adds it up."""

    path: TimedPath
    length: float


class Placement(NamedTuple):
    """How a fleet was placed.

    Attributes:
        robots: what was found for each, in their order; none where one could not be placed.
        order: how they were placed, in the end; none where a robot has no path.
        restarts: how often all was begun anew.
        status: ``"solved"``, or what stood in the way.
    """

    robots: tuple[Placed, ...]
    order: tuple[int, ...]
    restarts: int
    status: str


Found = TypeVar("Found")
Dialogue = Generator[Sequence[Scenario], Sequence[Way | None], Found]
"""Yields scenarios to plan, is sent their ways, None where no ant arrived, and returns what it comes to."""


def placing(fleet: Fleet, restarts: int, rng: np.random.Generator) -> Dialogue[Placement]:
    """Place the robots of a fleet.

    Args:
        fleet: the robots.
        restarts: how often all may begin anew, in another order.
        rng: of the orders that are tried once those that come to mind are through.
    """
    own = yield fleet.robots
    ways = [way for way in own if way is not None]
    if len(ways) < len(own):
        return Placement((), (), 0, f"no ant of robot {own.index(None)} arrived")
    lasts = [way.length / speed for way, speed in zip(ways, fleet.paces.tolist(), strict=True)]
    order = np.argsort(-np.array(lasts), kind="stable").tolist()  # the longest way first
    placed = yield from _placed(fleet, ways, order, False)
    seen = {tuple(order)}
    while len(placed) < len(own) and len(seen) <= min(restarts, math.factorial(len(own)) - 1):
        stuck = order[len(placed)]
        order = [stuck, *(robot for robot in order if robot != stuck)]
        while tuple(order) in seen:
            order = rng.permutation(len(own)).tolist()
        seen.add(tuple(order))
        placed = yield from _placed(fleet, ways, order, True)
    if len(placed) < len(own):
        status = f"robot {order[len(placed)]} found no way past others, in the last of {len(seen)} orders"
        return Placement((), tuple(order), len(seen) - 1, status)
    return Placement(tuple(placed[i] for i in sorted(placed)), tuple(order), len(seen) - 1, "solved")


def _placed(fleet: Fleet, ways: Sequence[Way], order: list[int], wary: bool) -> Dialogue[dict[int, Placed]]:
    """Return what was found for robots in an order, up to the first that cannot be placed.

    Where they are wary, each keeps away from the starts of those after it, too; only if it cannot, they have to leave.
    """
    placed: dict[int, Placed] = {}
    for i, robot in enumerate(order):
        starts = [TimedPath(_start(fleet, later), np.zeros(1)) for later in order[i + 1 :]] if wary else []
        before = [one.path for one in placed.values()]
        for company in ([*before, *starts], before)[: 2 if starts else 1]:
            found = yield from _place(fleet, robot, ways[robot], company)
            if found is not None:
                break
        if found is None:
            break
        placed[robot] = found
    return placed


def _place(fleet: Fleet, robot: int, own: Way, others: list[TimedPath]) -> Dialogue[Placed | None]:
    """Return what arrives first of a robot's own way and some around places of conflict.

    None where none of them keeps clear of others.
    """
    best, scenario, speed = None, fleet.robots[robot], float(fleet.paces[robot])
    way: Way | None = own
    for detours in range(DETOURS + 1):
        if way is None:
            break
        even = TimedPath.even(way.points, speed)
        met = [time for other in others if (time := meeting(even, other, fleet.apart - ROUNDING)) is not None]
        timed = schedule(way.points, speed, others, fleet.apart) if met else even
        if timed is not None and (best is None or timed.arrival < best.path.arrival):
            best = Placed(timed, way.length)
        if detours == DETOURS or not met:
            break
        heading_for = way.points[np.searchsorted(even.times, min(met)).clip(max=len(way.points) - 1)]
        scenario = _around(scenario, heading_for, fleet.apart)
        (way,) = yield [scenario]
    return best


def _start(fleet: Fleet, robot: int) -> Floats:
    """Return (1, 3), where a robot starts, in world units."""
    return fleet.world.centre([fleet.robots[robot].start])


def _around(scenario: Scenario, place: Floats, apart: float) -> Scenario:
    """Return a scenario with the cells around a place blocked whose centres are nearer than ``apart``, its ends not."""
    free = scenario.world.free.copy()
    centres = scenario.world.centre(np.moveaxis(np.indices(free.shape), 0, -1))
    free[np.linalg.norm(centres - place, axis=-1) < apart] = 0
    free[scenario.start] = free[scenario.goal] = 1
    return Scenario(GridWorld(free, scenario.world.cell), scenario.start, scenario.goal, scenario.motion)
