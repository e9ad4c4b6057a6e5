"""Fleets: several robots on one map, each planned by a colony, none nearer to another than it may be (zhang2011).

How robots keep apart is for :mod:`antgym.planners.placing`; here their paths are planned, those of many fleets in few
calls.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import accumulate
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antgym.errors import ParameterError
from antgym.maps.fleet import Fleet, side_by_side
from antgym.maps.world import Scenario
from antgym.planners.effort import each_rules, effort, keys_of
from antgym.planners.parameters import ColonyParameters, check_parameters
from antgym.planners.placing import Dialogue, Placement, Way, placing
from antgym.planners.planning import AnyRules, plan_many
from antgym.planners.plans import Plans
from antgym.planners.timed import TimedPath

RESTARTS = 30

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class FleetPlan:
    """What was found for a fleet.

    Attributes:
        fleet: that was planned.
        paths: a timed path a robot, in world units and seconds; empty where there is none for all of them.
        lengths: (n,) of these paths, as the colony adds them up; empty where there are none.
        order: how robots were placed, in the end.
        restarts: how often all was begun anew.
        plans: planner runs in all.
        moves: that ants made in all of them.
        status: ``"solved"``, or what stood in the way.
    """

    fleet: Fleet = field(repr=False)
    paths: tuple[TimedPath, ...] = field(repr=False)
    lengths: Floats = field(repr=False)
    order: tuple[int, ...]
    restarts: int
    plans: int
    moves: int
    status: str

    @property
    def solved(self) -> bool:
        """Whether every robot has its path."""
        return self.status == "solved"

    @property
    def length(self) -> float:
        """World units of all paths, and what robots would have travelled while they waited; inf without a solution.

        Never below the fleet's optimum, not even by one bit.
        """
        if not self.solved:
            return np.inf
        waited = np.array([path.waited for path in self.paths])
        return float((self.lengths + self.fleet.paces * waited).sum())

    @property
    def path(self) -> Floats:
        """(n, 3) cells of all paths, a row of NaN between any two; (0, 3) without a solution."""
        if not self.solved:
            return np.empty((0, 3))
        cells = [np.round(path.points / self.fleet.world.cell - 0.5) for path in self.paths]
        return side_by_side(cells)

    @property
    def alone(self) -> Floats:
        """(n,) seconds that each robot would take on an exact shortest path, alone."""
        return self.fleet.optima / self.fleet.paces

    @property
    def makespan(self) -> float:
        """Seconds until the last robot stands at its goal; inf without a solution."""
        return max((path.arrival for path in self.paths), default=np.inf)

    @property
    def gap(self) -> float:
        """Length, waits included, over that of exact paths alone, less 1; inf without a solution."""
        return self.length / self.fleet.optimum - 1

    @property
    def makespan_gap(self) -> float:
        """The makespan over that of exact paths among which nobody waits, less 1: a bound, not always reached."""
        return self.makespan / float(self.alone.max()) - 1

    @property
    def length_gap(self) -> float:
        """Length of the paths, without waits, over that of exact ones alone, less 1; inf without a solution."""
        return float(self.lengths.sum()) / self.fleet.optimum - 1 if self.solved else np.inf

    @property
    def time_gap(self) -> float:
        """Sum of arrivals over that of exact paths among which nobody waits, less 1; inf without a solution."""
        return (
            sum(path.arrival for path in self.paths) / float(self.alone.sum()) - 1 if self.solved else np.inf
        )


@dataclass(frozen=True, eq=False)
class FleetPlans:
    """What was found for several fleets: arrays over them, and each as a :class:`FleetPlan`; as ``Plans`` are.

    Attributes:
        lengths: (B,) float64, each plan's ``length``, inf where there is none.
        moves: (B,) int64, moves that all ants of all planner runs of a fleet made.
        seeds: (B,) uint64, what each was planned with.
    """

    lengths: Floats
    moves: NDArray[np.int64]
    seeds: NDArray[np.uint64]
    _plans: tuple[FleetPlan, ...] = field(repr=False)

    def __len__(self) -> int:
        return len(self._plans)

    def __getitem__(self, part: slice) -> "FleetPlans":
        return FleetPlans(self.lengths[part], self.moves[part], self.seeds[part], self._plans[part])

    def plan(self, index: int) -> FleetPlan:
        """Return one plan."""
        return self._plans[index]


@dataclass(frozen=True, eq=False)
class FleetRun:
    """A fleet that has been planned, behind the face of a colony that has walked to its end."""

    parameters: ColonyParameters
    _plan: FleetPlan = field(repr=False)

    @classmethod
    def of(cls, fleet: Fleet, parameters: ArrayLike, *, seed: int, **others: Any) -> "FleetRun":
        """Plan a fleet; arguments as for :func:`plan_fleet`."""
        values = check_parameters(parameters)
        plan = plan_fleets([fleet], values, seeds=[seed], **others).plan(0)
        return cls(ColonyParameters(*values[0].tolist()), plan)

    def result(self) -> FleetPlan:
        """Return what was found."""
        return self._plan


def plan_fleet(
    robots: Fleet | Sequence[Scenario],
    parameters: ArrayLike,
    *,
    apart: float | None = None,
    speeds: float | Sequence[float] = 1.0,
    rules: AnyRules = "zhang2011",
    ants: int = 20,
    iterations: int = 50,
    seed: int = 0,
    restarts: int = RESTARTS,
) -> FleetPlan:
    """Plan robots that share a map, so that no two are ever nearer than ``apart``.

    A robot stands at its start until it leaves and at its goal for good; others keep away from it there too.

    Args:
        robots: a fleet; or a scenario for each robot, with the next two arguments as for
            :class:`~antgym.maps.fleet.Fleet`, which a fleet holds already.
        parameters: natural values of the colony, the same for every robot, as for
            :func:`~antgym.planners.planning.plan`.
        apart: smallest distance of two robots' centres, world units, > 0.
        speeds: world units per second of all, or of each, > 0.
        rules: of the colony.
        ants: ants per iteration.
        iterations: iterations of every run.
        seed: 0 ≤ seed < 2^64; the same gives the same fleet.
        restarts: how often all may begin anew, in another order.

    Raises:
        ScenarioError: if the robots make no fleet, or one has no path.
        ParameterError: if another argument cannot be used.
    """
    fleet = _fleet_of(robots, apart, speeds)
    _ = fleet.optimum  # where a robot has no path, no ant need try
    values = np.atleast_2d(np.asarray(parameters, dtype=np.float64))
    return plan_fleets(
        [fleet], values, rules=rules, ants=ants, iterations=iterations, seeds=[seed], restarts=restarts
    ).plan(0)


def _fleet_of(
    robots: Fleet | Sequence[Scenario], apart: float | None, speeds: float | Sequence[float]
) -> Fleet:
    if isinstance(robots, Fleet):
        return robots
    if apart is None:
        raise ParameterError("apart is missing: how near two robots' centres may come, in world units")
    return Fleet(robots, apart, speeds)


def plan_fleets(
    fleets: Sequence[Fleet],
    parameters: ArrayLike,
    *,
    rules: AnyRules | Sequence[AnyRules] = "zhang2011",
    ants: int | Sequence[int] = 20,
    iterations: int | Sequence[int] = 50,
    seeds: ArrayLike,
    restarts: int = RESTARTS,
) -> FleetPlans:
    """Plan B fleets; fleet i comes out as :func:`plan_fleet` plans it alone.

    Their robots are planned in one call, then all that have to be planned again in another, and so on.

    Args:
        fleets: B of them.
        parameters: (B, 4) natural values.
        rules: one for all, or B.
        ants: one for all, or B.
        iterations: one for all, or B.
        seeds: (B,) integers in [0, 2^64).
        restarts: of each.

    Raises:
        ParameterError: if a parameter, rule, effort, seed or number of restarts cannot be used, or the counts differ.
    """
    if restarts < 0:
        raise ParameterError(f"restarts = {restarts}: must be 0 or more")
    count, naturals = len(fleets), check_parameters(parameters)
    if len(naturals) != count:
        raise ParameterError(f"{len(naturals)} parameter sets for {count} fleets")
    how = _How(
        naturals,
        each_rules(rules, count),
        effort("ants", ants, count),
        effort("iterations", iterations, count),
    )
    keys = keys_of(seeds, count)
    runs = [_Run(fleet, restarts, int(key)) for fleet, key in zip(fleets, keys, strict=True)]
    while waiting := [i for i, run in enumerate(runs) if run.wanted]:
        _plan_wanted(runs, waiting, how)
    found = tuple(run.plan() for run in runs)
    lengths, moves = np.array([plan.length for plan in found]), np.array([plan.moves for plan in found])
    return FleetPlans(lengths.astype(np.float64), moves.astype(np.int64), keys, found)


class _How(NamedTuple):
    """How each of B fleets is planned: (B, 4) natural values, and rules, ants and iterations by fleet."""

    naturals: Floats
    rules: Sequence[AnyRules]
    ants: NDArray[np.int64]
    iterations: NDArray[np.int64]


def _plan_wanted(runs: Sequence["_Run"], waiting: Sequence[int], how: _How) -> None:
    """Plan in one call what all fleets that wait want planned, and answer each."""
    sizes = [len(runs[i].wanted) for i in waiting]
    of = np.repeat(waiting, sizes)
    plans = plan_many(
        [scenario for i in waiting for scenario in runs[i].wanted],
        how.naturals[of],
        rules=[how.rules[i] for i in of.tolist()],
        ants=how.ants[of].tolist(),
        iterations=how.iterations[of].tolist(),
        seeds=np.concatenate([runs[i].seeds() for i in waiting]),
    )
    for i, size, end in zip(waiting, sizes, accumulate(sizes), strict=True):
        runs[i].answer(plans[end - size : end])


class _Run:
    """A fleet on its way: the dialogue that places it, what it wants planned, and what that has cost."""

    def __init__(self, fleet: Fleet, restarts: int, seed: int) -> None:
        self._fleet, self._rng = fleet, np.random.default_rng(np.random.SeedSequence(seed))
        self._dialogue: Dialogue[Placement] = placing(fleet, restarts, self._rng)
        self._placement: Placement | None = None
        self._plans = self._moves = 0
        self.wanted: Sequence[Scenario] = next(self._dialogue)

    def seeds(self) -> NDArray[np.int64]:
        """Draw a planner seed for each scenario that is wanted."""
        return self._rng.integers(1 << 63, size=len(self.wanted))

    def answer(self, plans: Plans) -> None:
        """Tell what was found for all that was wanted."""
        pairs = zip(self.wanted, map(plans.plan, range(len(plans))), strict=True)
        ways = [Way(s.world.centre(plan.path), plan.length) if plan.solved else None for s, plan in pairs]
        self._plans += len(plans)
        self._moves += int(plans.moves.sum())
        try:
            self.wanted = self._dialogue.send(ways)
        except StopIteration as end:
            self._placement, self.wanted = end.value, ()

    def plan(self) -> FleetPlan:
        """Return what came of it."""
        assert self._placement is not None
        robots, order, restarts, status = self._placement
        paths, lengths = tuple(one.path for one in robots), np.array([one.length for one in robots])
        return FleetPlan(self._fleet, paths, lengths, order, restarts, self._plans, self._moves, status)
