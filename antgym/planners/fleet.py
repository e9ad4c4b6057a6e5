"""Fleets: several robots on one map, each planned by a colony, none nearer to another than it may be (zhang2011).

Robots are placed one after the other. Each follows the path that its colony found, at times that meet nobody who was
placed before: it is staggered, by waits anywhere on the way. Where that delays it, it is planned again with a safety
radius blocked around the cell that it heads for where it would meet somebody, a few times, and the earliest arrival
counts. A robot that cannot be placed at all goes to the front of the order, and everything begins anew, now with an eye
to where later ones still stand.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antgym.errors import ParameterError, ScenarioError
from antgym.maps.world import GridWorld, Scenario
from antgym.planners.planning import AnyRules, plan_many
from antgym.planners.schedules import ROUNDING, schedule
from antgym.planners.timed import TimedPath, meeting

DETOURS = 4  # plans around a place of conflict, at most, every time that a robot is placed

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class FleetPlan:
    """What was found for a fleet.

    Attributes:
        paths: a timed path a robot, in world units and seconds; empty where there is none for all of them.
        order: how robots were placed, in the end.
        restarts: how often all was begun anew.
        plans: planner runs in all.
        alone: (n,) seconds that each robot would take on an exact shortest path, alone.
        optimum: world units of these paths in all.
        status: ``"solved"``, or what stood in the way.
    """

    paths: tuple[TimedPath, ...] = field(repr=False)
    order: tuple[int, ...]
    restarts: int
    plans: int
    alone: Floats = field(repr=False)
    optimum: float
    status: str

    @property
    def solved(self) -> bool:
        """Whether every robot has its path."""
        return self.status == "solved"

    @property
    def makespan(self) -> float:
        """Seconds until the last robot stands at its goal; inf without a solution."""
        return max((path.arrival for path in self.paths), default=np.inf)

    @property
    def makespan_gap(self) -> float:
        """The makespan over that of exact paths among which nobody waits, less 1: a bound, not always reached."""
        return self.makespan / float(self.alone.max()) - 1

    @property
    def length_gap(self) -> float:
        """Length of all paths over that of exact ones alone, less 1; inf without a solution."""
        return sum(path.length for path in self.paths) / self.optimum - 1 if self.solved else np.inf

    @property
    def time_gap(self) -> float:
        """Sum of arrivals over that of exact paths among which nobody waits, less 1; inf without a solution."""
        return (
            sum(path.arrival for path in self.paths) / float(self.alone.sum()) - 1 if self.solved else np.inf
        )


class _Fleet(NamedTuple):
    """What does not change while robots are placed."""

    scenarios: Sequence[Scenario]
    parameters: ArrayLike
    rules: AnyRules
    ants: int
    iterations: int
    speeds: Floats
    apart: float

    def start(self, robot: int) -> Floats:
        """Return (1, 3), where a robot starts, in world units."""
        return self.scenarios[robot].world.centre([self.scenarios[robot].start])


def plan_fleet(
    scenarios: Sequence[Scenario],
    parameters: ArrayLike,
    *,
    apart: float,
    speeds: float | Sequence[float] = 1.0,
    rules: AnyRules = "zhang2011",
    ants: int = 20,
    iterations: int = 50,
    seed: int = 0,
    restarts: int = 30,
) -> FleetPlan:
    """Plan robots that share a map, so that no two are ever nearer than ``apart``.

    A robot stands at its start until it leaves and at its goal for good; others keep away from it there too.

    Args:
        scenarios: one a robot, all in the same world (one object) and under the same motion.
        parameters: natural values of the colony, as for :func:`~antgym.planners.planning.plan`.
        apart: smallest distance of two robots' centres, world units, > 0: the sum of their radii. On a grid, robots
            that follow each other are a cell apart, and 0.7 of one where they turn.
        speeds: world units per second of all, or of each, > 0.
        rules: of the colony.
        ants: ants per iteration.
        iterations: iterations of every run.
        seed: 0 ≤ seed < 2^64; the same gives the same fleet.
        restarts: how often all may begin anew, in another order.

    Raises:
        ScenarioError: if worlds or motions differ, starts or goals are too near each other, or a robot has no path.
        ParameterError: if another argument cannot be used.
    """
    fleet = _Fleet(scenarios, parameters, rules, ants, iterations, _checked_speeds(scenarios, speeds), apart)
    _check(fleet, restarts)
    rng = np.random.default_rng(np.random.SeedSequence(seed))
    optima = np.array([scenario.optimum for scenario in scenarios])
    alone = optima / fleet.speeds
    own = _planned(fleet, scenarios, rng)
    lost = [robot for robot, points in enumerate(own) if points is None]
    if lost:
        status = f"no ant of robot {lost[0]} arrived"
        return FleetPlan((), (), 0, len(own), alone, float(optima.sum()), status)
    order = np.argsort(-alone, kind="stable").tolist()  # the longest way first
    paths, plans = _placed(fleet, own, order, False, rng)
    seen = {tuple(order)}
    while len(paths) < len(own) and len(seen) <= min(restarts, math.factorial(len(own)) - 1):
        stuck = order[len(paths)]
        order = [stuck, *(robot for robot in order if robot != stuck)]
        while tuple(order) in seen:
            order = rng.permutation(len(own)).tolist()
        seen.add(tuple(order))
        paths, runs = _placed(fleet, own, order, True, rng)
        plans += runs
    found, status = tuple(paths[robot] for robot in sorted(paths)), "solved"
    if len(paths) < len(own):
        found, status = (
            (),
            f"robot {order[len(paths)]} found no way past others, in the last of {len(seen)} orders",
        )
    return FleetPlan(found, tuple(order), len(seen) - 1, len(own) + plans, alone, float(optima.sum()), status)


def _placed(
    fleet: _Fleet, own: Sequence[Floats | None], order: list[int], wary: bool, rng: np.random.Generator
) -> tuple[dict[int, TimedPath], int]:
    """Return the timed paths of robots in an order, up to the first that cannot be placed, and planner runs.

    Where they are wary, each keeps away from the starts of those after it, too; only if it cannot, they have to leave.
    """
    paths: dict[int, TimedPath] = {}
    plans = 0
    for i, robot in enumerate(order):
        starts = [TimedPath(fleet.start(later), np.zeros(1)) for later in order[i + 1 :]] if wary else []
        for company in ([*paths.values(), *starts], [*paths.values()])[: 2 if starts else 1]:
            path, runs = _place(fleet, robot, own[robot], company, rng)
            plans += runs
            if path is not None:
                break
        if path is None:
            break
        paths[robot] = path
    return paths, plans


def _place(
    fleet: _Fleet, robot: int, points: Floats | None, others: list[TimedPath], rng: np.random.Generator
) -> tuple[TimedPath | None, int]:
    """Return what arrives first of a robot's own path and some around places of conflict, and planner runs.

    None where none of them keeps clear of others.
    """
    best, runs, scenario = None, 0, fleet.scenarios[robot]
    while points is not None:
        even = TimedPath.even(points, fleet.speeds[robot])
        timed = schedule(points, fleet.speeds[robot], others, fleet.apart)
        if timed is not None and (best is None or timed.arrival < best.arrival):
            best = timed
        met = [time for other in others if (time := meeting(even, other, fleet.apart - ROUNDING)) is not None]
        if runs == DETOURS or not met:
            break
        heading_for = points[np.searchsorted(even.times, min(met)).clip(max=len(points) - 1)]
        scenario = _around(scenario, heading_for, fleet.apart)
        (points,) = _planned(fleet, [scenario], rng)
        runs += 1
    return best, runs


def _around(scenario: Scenario, place: Floats, apart: float) -> Scenario:
    """Return a scenario with the cells around a place blocked whose centres are nearer than ``apart``, its ends not."""
    free = scenario.world.free.copy()
    centres = scenario.world.centre(np.moveaxis(np.indices(free.shape), 0, -1))
    free[np.linalg.norm(centres - place, axis=-1) < apart] = 0
    free[scenario.start] = free[scenario.goal] = 1
    return Scenario(GridWorld(free, scenario.world.cell), scenario.start, scenario.goal, scenario.motion)


def _planned(fleet: _Fleet, scenarios: Sequence[Scenario], rng: np.random.Generator) -> list[Floats | None]:
    """Return the (n, 3) points that the colony finds for each scenario, None where no ant arrived."""
    plans = plan_many(
        scenarios,
        np.tile(np.asarray(fleet.parameters, dtype=np.float64), (len(scenarios), 1)),
        rules=fleet.rules,
        ants=fleet.ants,
        iterations=fleet.iterations,
        seeds=rng.integers(1 << 63, size=len(scenarios)),
    )
    found = (plans.plan(i) for i in range(len(scenarios)))
    pairs = zip(scenarios, found, strict=True)
    return [scenario.world.centre(plan.path) if plan.solved else None for scenario, plan in pairs]


def _checked_speeds(scenarios: Sequence[Scenario], speeds: float | Sequence[float]) -> Floats:
    values = np.asarray(speeds, dtype=np.float64)
    if values.ndim and len(values) != len(scenarios):
        raise ParameterError(f"{len(values)} speeds for {len(scenarios)} robots; give one, or one each")
    if not (np.isfinite(values).all() and (values > 0).all()):
        raise ParameterError(f"speeds = {speeds}: must be numbers above 0, world units per second")
    return np.broadcast_to(values, (len(scenarios),))


def _check(fleet: _Fleet, restarts: int) -> None:
    """Raise where robots do not share a map, cannot keep apart at their ends, or an argument is out of its range."""
    if not fleet.scenarios:
        raise ParameterError("a fleet has at least one robot")
    if not (np.isfinite(fleet.apart) and fleet.apart > 0):
        raise ParameterError(f"apart = {fleet.apart}: robots keep a distance above 0, in world units")
    if restarts < 0:
        raise ParameterError(f"restarts = {restarts}: must be 0 or more")
    first = fleet.scenarios[0]
    for i, scenario in enumerate(fleet.scenarios):
        if scenario.world is not first.world or scenario.motion != first.motion:
            raise ScenarioError(
                f"robot {i} moves in another world than robot 0, or by another motion; give all one"
            )
    for (i, one), (j, other) in combinations(enumerate(fleet.scenarios), 2):
        for end in ("start", "goal"):
            here, there = (first.world.centre(getattr(scenario, end)) for scenario in (one, other))
            if np.linalg.norm(here - there) < fleet.apart - ROUNDING:
                raise ScenarioError(
                    f"robots {i} and {j} have a {end} at {getattr(one, end)} and {getattr(other, end)}, nearer than "
                    f"{fleet.apart:g}; move one"
                )
