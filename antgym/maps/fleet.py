"""Fleets: robots that share a grid, each with a start and a goal of its own, none nearer to another than it may be."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antgym.errors import ParameterError, ScenarioError
from antgym.maps.motion import Motion
from antgym.maps.occupancy import Chart
from antgym.maps.world import GridWorld, Scenario

ROUNDING = 1e-9  # world units that robots may be nearer, so that those that touch do not meet by rounding


@dataclass(frozen=True, eq=False)
class Fleet:
    """One planning question for several robots: what a :class:`~antgym.maps.world.Scenario` is for one.

    What is said of a scenario in world units is here the sum over robots, what describes it the mean.

    Args:
        robots: a scenario each, at least one, all in the same world (one object), a grid, under the same motion.
        apart: smallest distance of two robots' centres, world units, > 0: the sum of their radii. On a grid, robots
            that follow each other are a cell apart, and 0.7 of one where they turn.
        speeds: world units per second of all, or of each, > 0.
        name: how tables call it; agents never see it.

    Raises:
        ScenarioError: if worlds or motions differ, the world is no grid, or starts or goals are too near each other.
        ParameterError: if there is no robot, or a distance or a speed cannot be used.
    """

    robots: Sequence[Scenario]
    apart: float
    speeds: float | Sequence[float] = 1.0
    name: str = "unnamed"

    def __post_init__(self) -> None:
        object.__setattr__(self, "robots", tuple(self.robots))
        if not self.robots:
            raise ParameterError("a fleet has at least one robot")
        if not (np.isfinite(self.apart) and self.apart > 0):
            raise ParameterError(f"apart = {self.apart}: robots keep a distance above 0, in world units")
        _require_speeds(self.speeds, len(self.robots))
        _require_shared(self.robots)
        _require_apart(self.robots, self.apart)

    @property
    def world(self) -> GridWorld:
        """The grid that all share."""
        return self.robots[0].world

    @property
    def motion(self) -> Motion:
        """The motion of all of them."""
        return self.robots[0].motion

    @property
    def paces(self) -> NDArray[np.float64]:
        """(n,) world units per second of each robot."""
        return np.broadcast_to(np.asarray(self.speeds, dtype=np.float64), (len(self.robots),))

    @property
    def optimum(self) -> float:
        """Sum of the exact shortest lengths, each robot alone; raises ScenarioError where one has no path.

        A bound: robots that are in each other's way may not all reach theirs.
        """
        return float(self.optima.sum())

    @property
    def optima(self) -> NDArray[np.float64]:
        """(n,) exact shortest length of each robot alone, world units."""
        return np.array([robot.optimum for robot in self.robots])

    @cached_property
    def straight_line(self) -> float:
        """Sum of the Euclidean distances from start to goal, world units."""
        return float(np.sum([robot.straight_line for robot in self.robots]))

    @cached_property
    def descriptors(self) -> NDArray[np.float32]:
        """Mean of what describes each robot's scenario, read-only."""
        mean = np.asarray(np.mean([robot.descriptors for robot in self.robots], axis=0), dtype=np.float32)
        mean.setflags(write=False)
        return mean

    @cached_property
    def chart(self) -> Chart:
        """What draws the down-sampled map, with the starts and goals of all robots on it."""
        return Chart(
            self.world, [robot.start for robot in self.robots], [robot.goal for robot in self.robots]
        )

    @cached_property
    def digest(self) -> str:
        """Hash of everything that defines the question (name excluded), 64 hex digits."""
        parts = [robot.digest for robot in self.robots]
        return hashlib.sha256(f"{parts}{self.apart}{self.paces.tolist()}".encode()).hexdigest()

    def with_motion(self, motion: Motion) -> "Fleet":
        """Return the same question under another motion rule."""
        return replace(self, robots=tuple(robot.with_motion(motion) for robot in self.robots))


def robots_of(question: Scenario[Any, Any] | Fleet) -> Sequence[Scenario[Any, Any]]:
    """Return the scenarios of a fleet's robots, or the one scenario that a question is."""
    return question.robots if isinstance(question, Fleet) else (question,)


def side_by_side(paths: Sequence[NDArray[Any]]) -> NDArray[np.float64]:
    """Return the (n, d) points of several paths in one array, a row of NaN, at which a line breaks, between any two."""
    gap = np.full((1, paths[0].shape[1]), np.nan)
    return np.concatenate([part for path in paths for part in (gap, path)][1:])


def _require_speeds(speeds: float | Sequence[float], count: int) -> None:
    values = np.asarray(speeds, dtype=np.float64)
    if values.ndim and len(values) != count:
        raise ParameterError(f"{len(values)} speeds for {count} robots; give one, or one each")
    if not (np.isfinite(values).all() and (values > 0).all()):
        raise ParameterError(f"speeds = {speeds}: must be numbers above 0, world units per second")


def _require_shared(robots: Sequence[Scenario]) -> None:
    first = robots[0]
    if not isinstance(first.world, GridWorld):
        raise ScenarioError(f"scenario {first.name!r} lies among discs; the robots of a fleet share a grid")
    for i, robot in enumerate(robots):
        if robot.world is not first.world or robot.motion != first.motion:
            raise ScenarioError(
                f"robot {i} moves in another world than robot 0, or by another motion; give all one"
            )


def _require_apart(robots: Sequence[Scenario], apart: float) -> None:
    for (i, one), (j, other) in combinations(enumerate(robots), 2):
        for end in ("start", "goal"):
            here, there = (one.world.centre(getattr(scenario, end)) for scenario in (one, other))
            if np.linalg.norm(here - there) < apart - ROUNDING:
                raise ScenarioError(
                    f"robots {i} and {j} have a {end} at {getattr(one, end)} and {getattr(other, end)}, nearer than "
                    f"{apart:g}; move one"
                )
