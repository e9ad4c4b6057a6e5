"""A tuning problem, as the harness holds it, and the task, which is all of it that an agent may see."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import accumulate
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antgym.errors import BudgetError, ParameterError, is_count
from antgym.maps.fleet import Fleet
from antgym.maps.world import Scenario
from antgym.planners.batch import MOST_EFFORT
from antgym.planners.fleet import FleetPlans, plan_fleets
from antgym.planners.planning import plan_many
from antgym.planners.plans import Plans
from antgym.planners.rules import Rules
from antgym.planners.space import ParameterSpace, decode_together
from antgym.planners.swarms import find_swarm_rules, require_fit, space_of
from antgym.tuning.features import task_features
from antgym.tuning.seeding import SEED_LIMIT, child_states

COST_CAP = 10.0
"""Cost of a run that found no path; also the cap of every other cost."""
GAP_CAP = 1.0
"""Gap of a run that found no path; also the cap of every other gap where gaps are averaged."""
TRIAL, FRESH = 0, 1  # seed domains: what an agent pays for, and what the harness alone runs


def no_map(flat: bool | None = None) -> NDArray[np.float32]:
    """Stand in for the map of a task that was made without a world."""
    raise ParameterError(f"this task holds no world, so there is no map of it (flat={flat})")


@dataclass(frozen=True, eq=False)
class Task:
    """All that an agent may see of a problem: no name, no path, no optimum.

    Attributes:
        space: the parameters to choose.
        features: float32, the scenario's descriptors, the effort and the rules, bounded; see
            :func:`antgym.tuning.features.task_table`.
        ants: ants per iteration, or bees.
        iterations: iterations per planner run, or cycles.
        budget: trials the agent may pay for; 0 for a zero-shot recommendation.
        map: called with ``flat`` or nothing, returns the down-sampled map, read-only; see
            :func:`antgym.maps.occupancy.occupancy`. It is drawn when it is first asked for.
    """

    space: ParameterSpace
    features: NDArray[np.float32]
    ants: int
    iterations: int
    budget: int
    map: Callable[..., NDArray[np.float32]] = field(default=no_map, repr=False)


@dataclass(frozen=True, eq=False)
class TuningProblem:
    """A scenario, a rule and an effort; the harness's side of a task.

    Args:
        scenario: what is planned; a fleet is planned as a whole, all of its robots under the one setting.
        rules: name of the swarm's rules: of ants on a grid, of bees among discs.
        ants: ants per iteration, ≥ 1, or bees, ≥ 4.
        iterations: iterations per run, ≥ 1, or cycles.
        seed: root of every planner seed of this problem.

    Raises:
        ParameterError: on unknown rules, rules that are not for such a world, or an effort that is too small.
    """

    scenario: Scenario[Any, Any] | Fleet
    rules: str = "liu2020"
    ants: int = 20
    iterations: int = 50
    seed: int = 0

    def __post_init__(self) -> None:
        motion, rules = self.scenario.motion, find_swarm_rules(self.rules)
        loosely = isinstance(rules, Rules) and not rules.check_segments
        if motion.layered and motion.check_segments and loosely:
            loose = self.scenario.with_motion(replace(motion, check_segments=False))
            object.__setattr__(self, "scenario", loose)  # with the optimum of that motion
        _require_seed(self.seed)
        for name in ("ants", "iterations"):
            value = getattr(self, name)
            if not isinstance(value, int) or isinstance(value, bool) or not 1 <= value <= MOST_EFFORT:
                raise ParameterError(
                    f"{name} = {value!r}: a run needs a whole number from 1 to {MOST_EFFORT:,}"
                )
        require_fit(self.rules, self.scenario, self.ants)

    @cached_property
    def space(self) -> ParameterSpace:
        """The rule's parameters, scaled to this scenario and this swarm."""
        return space_of(self.rules, self.scenario, self.ants)

    def seeded(self, seed: int) -> "TuningProblem":
        """Return the same problem under another seed; the two share space and tasks."""
        _require_seed(seed)
        _ = self.space, self._tasks  # made now, so that they are shared
        other = object.__new__(TuningProblem)
        other.__dict__.update(self.__dict__)  # which is checked already
        other.__dict__["seed"] = seed
        return other

    @cached_property
    def _tasks(self) -> dict[int, Task]:
        """Tasks by budget; what an agent may see does not depend on the seed."""
        return {}

    def task(self, budget: int) -> Task:
        """Return what an agent may see; BudgetError where the budget is no whole number from 0 on."""
        if budget != 0 and not is_count(budget):
            raise BudgetError(
                f"budget = {budget!r}: must be 0 (zero-shot) or the number of trials to pay for"
            )
        task = self._tasks.get(budget)
        if task is None:
            features = task_features(self.scenario, self.ants, self.iterations, self.rules)
            features.setflags(write=False)  # many sessions share it
            task = Task(self.space, features, self.ants, self.iterations, budget, self.scenario.chart)
            self._tasks[budget] = task
        return task

    def seeds(self, domain: int, first: int, count: int) -> NDArray[np.uint64]:
        """Return planner seeds, a pure function of (seed, domain, index), by SeedSequence children."""
        keys = [(domain, index) for index in range(first, first + count)]
        return child_states([self.seed] * count, keys)[:, 0]

    def run(self, units: NDArray[np.float64], domain: int, first: int) -> Plans | FleetPlans:
        """Run settings on the seeds ``first`` onwards of a domain; the harness's way, charged to nobody."""
        return run_together([(self, units, domain, first)])[0]

    def fresh(self, unit: NDArray[np.float64], count: int) -> Plans | FleetPlans:
        """Run one setting on ``count`` seeds that no trial uses."""
        return self.run(np.repeat(self.space.check(unit), count, axis=0), FRESH, 0)

    def cost(self, lengths: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the :func:`costs` of some runs of this problem."""
        return costs([self] * len(lengths), lengths)

    def gap(self, lengths: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the :func:`gaps` of some runs of this problem."""
        return gaps([self] * len(lengths), lengths)


def _require_seed(seed: int) -> None:
    if not isinstance(seed, int) or not 0 <= seed < SEED_LIMIT:
        raise ParameterError(f"seed = {seed!r}: a whole number from 0 to 2^128 - 1 is needed")


Request = tuple[TuningProblem, NDArray[np.float64], int, int]
"""(problem, (k, d) settings, seed domain, index of the first seed)"""


@dataclass(frozen=True, eq=False)
class Runs:
    """Planner runs that several problems ask for.

    Attributes:
        problems: n of them, one a run.
        seeds: under which each is run, in the place of its own.
        units: (n, d) settings.
        keys: seed domain of each, and its index among the runs of its problem; (n, 2).
    """

    problems: list[TuningProblem]
    seeds: list[int]
    units: NDArray[np.float64]
    keys: ArrayLike

    @classmethod
    def of(cls, requests: Sequence[Request]) -> "Runs":
        """Lay at least one request's runs out, one after the other."""
        problems = [problem for problem, units, _, _ in requests for _ in range(len(units))]
        keys = [(domain, first + i) for _, units, domain, first in requests for i in range(len(units))]
        units = np.concatenate([units for _, units, _, _ in requests])
        return cls(problems, [problem.seed for problem in problems], units, keys)

    @cached_property
    def naturals(self) -> NDArray[np.float64]:
        """What the settings are to the planner, (n, d)."""
        return decode_together([problem.space for problem in self.problems], self.units)

    def plan(self) -> Plans | FleetPlans:
        """Run them in one planner call, fleets in a few; the only caller of the planner above it.

        Raises:
            ParameterError: where some problems are of fleets and some of single robots.
        """
        problems, planned = self.problems, self._scenarios()
        others: Any = {
            "rules": [p.rules for p in problems],
            "ants": [p.ants for p in problems],
            "iterations": [p.iterations for p in problems],
            "seeds": child_states(self.seeds, self.keys)[:, 0],
        }
        if isinstance(planned[0], Fleet):
            return plan_fleets(planned, self.naturals, **others)
        return plan_many(planned, self.naturals, **others)

    def _scenarios(self) -> list[Any]:
        planned = [problem.scenario for problem in self.problems]
        if len({isinstance(scenario, Fleet) for scenario in planned}) > 1:
            raise ParameterError("fleets and single robots in one batch; run them apart")
        return planned


def run_together(requests: Sequence[Request]) -> list[Plans | FleetPlans]:
    """Run the settings of several problems in one planner call."""
    if not any(len(units) for _, units, _, _ in requests):
        return []
    plans, ends = Runs.of(requests).plan(), accumulate(len(units) for _, units, _, _ in requests)
    return [plans[end - len(units) : end] for (_, units, _, _), end in zip(requests, ends, strict=True)]


def costs(problems: Sequence[TuningProblem], lengths: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return length / straight-line distance, each of its own problem; COST_CAP at most and where there is no path."""
    return np.minimum(lengths / [problem.scenario.straight_line for problem in problems], COST_CAP)


def gaps(problems: Sequence[TuningProblem], lengths: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (length - optimum) / optimum, each of its own problem; GAP_CAP at most and where there is no path.

    Raises:
        AssertionError: on a length below the exact optimum, which would be a bug of the planner.
    """
    optima = np.array([problem.scenario.optimum for problem in problems])
    below = np.flatnonzero(lengths < optima)
    if len(below):
        name, optimum = problems[below[0]].scenario.name, optima[below[0]]
        raise AssertionError(f"{name}: length {lengths[below[0]]} below the exact optimum {optimum}")
    return np.minimum(lengths / optima - 1.0, GAP_CAP)
