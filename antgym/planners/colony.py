"""The colony: plans a scenario, or many at once, or one in blocks. Sole caller of the ant layout."""

from collections.abc import Sequence
from typing import Any, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antgym.errors import ParameterError
from antgym.kernels import layout
from antgym.kernels.ants import advance, begin
from antgym.kernels.nodes import forget_weights
from antgym.maps.world import Scenario
from antgym.planners.batch import Batch, Plan, cells_of, write_parameters
from antgym.planners.buffers import grown, new_buffers
from antgym.planners.parameters import ColonyParameters, check_parameters
from antgym.planners.rules import Rules, find_rules
from antgym.planners.threads import run_ranges

__all__ = ["Colony", "Plan", "Plans", "plan", "plan_many"]


class Plans:
    """What many planner runs found: arrays over the runs, and each as a :class:`Plan` by index.

    Attributes:
        lengths: (B,) float64 in world units, inf where no ant arrived.
        moves: (B,) int64, moves that all ants of a run made.
        seeds: (B,) uint64, what each was planned with.
    """

    def __init__(self, batch: "Batch", first: int, last: int) -> None:
        self._batch, self._first = batch, first
        self.lengths = batch.lengths[first:last]
        self.moves = batch.made[first:last]
        self.seeds: NDArray[np.uint64] = batch.runs["key"][first:last]

    def __len__(self) -> int:
        return len(self.lengths)

    @overload
    def __getitem__(self, key: int) -> Plan: ...
    @overload
    def __getitem__(self, key: slice) -> "Plans": ...
    def __getitem__(self, key: int | slice) -> "Plan | Plans":
        if not isinstance(key, slice):
            return self.plan(key)
        first, last, step = key.indices(len(self))
        if step != 1:
            raise ParameterError(f"plans are sliced without a step, got {step}")
        return Plans(self._batch, self._first + first, self._first + max(first, last))

    def plan(self, index: int) -> Plan:
        """Return one run."""
        return self._batch.plan(self._first + range(len(self))[index])


def plan(
    scenario: Scenario,
    parameters: ArrayLike,
    *,
    rules: str | Rules = "liu2020",
    ants: int = 20,
    iterations: int = 100,
    seed: int = 0,
) -> Plan:
    """Plan one scenario.

    Args:
        scenario: what to plan.
        parameters: (α, β, ρ, Q), natural values; see :class:`ColonyParameters`.
        rules: name or data of the colony's rules.
        ants: ants per iteration, ≥ 1.
        iterations: iterations, ≥ 1.
        seed: 0 ≤ seed < 2^64; the same seed gives the same plan on every machine and thread count.

    Raises:
        ParameterError: if a parameter, rule, effort or seed cannot be used.
    """
    values = np.atleast_2d(np.asarray(parameters, dtype=np.float64))
    plans = plan_many([scenario], values, rules=rules, ants=ants, iterations=iterations, seeds=[seed])
    return plans.plan(0)


def plan_many(
    scenarios: Sequence[Scenario],
    parameters: ArrayLike,
    *,
    rules: str | Rules | Sequence[str | Rules] = "liu2020",
    ants: int | Sequence[int] = 20,
    iterations: int | Sequence[int] = 100,
    seeds: ArrayLike,
) -> Plans:
    """Plan B runs in one call, on ANTGYM_THREADS threads; run i is what ``plan`` gives for its arguments.

    Args:
        scenarios: B scenarios, in any mixture of sizes.
        parameters: (B, 4) natural values (α, β, ρ, Q).
        rules: one for all, or B.
        ants: one for all, or B.
        iterations: one for all, or B.
        seeds: (B,) integers in [0, 2^64).

    Raises:
        ParameterError: if a parameter, rule, effort or seed cannot be used, or the counts differ.
    """
    batch = Batch.of(list(scenarios), parameters, rules, ants, iterations, seeds)
    if len(batch.runs):
        run_ranges(batch.plan_range, len(batch.runs))
    return Plans(batch, 0, len(batch.runs))


class Colony:
    """One run that can be paused: ``Colony(...)``, ``advance(parameters, iterations)``, ``result()``.

    Pheromone is the state; a change of α or β makes rows be weighed again when they are next visited, the same
    parameters again touch nothing: any split into blocks gives the plan of one block, bit for bit.
    """

    def __init__(
        self,
        scenario: Scenario,
        *,
        rules: str | Rules = "liu2020",
        ants: int = 20,
        iterations: int = 100,
        seed: int = 0,
    ) -> None:
        default = ColonyParameters(1.0, 1.0, 0.5, 1.0)
        self._batch = Batch.of([scenario], [default], rules, ants, iterations, [seed])
        self._scenario, self._rules = scenario, find_rules(rules)
        run = self._batch.runs[0]
        self._buffers = new_buffers(self._batch.runs)
        begin(run, self._batch.tables, *self._buffers)

    @property
    def done(self) -> int:
        """Iterations walked so far."""
        return int(self._buffers.trail.status[layout.DONE])

    @property
    def left(self) -> int:
        """Iterations that can still be walked."""
        return int(self._batch.runs[0].iterations) - self.done

    def advance(self, parameters: ArrayLike, iterations: int) -> None:
        """Walk some more iterations under (α, β, ρ, Q); ParameterError if more are asked for than are left."""
        if not 1 <= iterations <= self.left:
            raise ParameterError(f"iterations = {iterations}: this colony has {self.left} left")
        run = self._batch.runs[0]
        before = (run.alpha, run.beta)
        write_parameters(self._batch.runs, check_parameters(parameters), [self._rules])
        if before != (run.alpha, run.beta) and self.done:
            forget_weights(self._buffers.nodes, self._buffers.trail)
        until = self.done + iterations
        with np.errstate(over="ignore"):  # interpreted, random numbers and hashes wrap around
            while self._walk(run, until) < until:
                self._buffers = grown(self._buffers)

    def result(self) -> Plan:
        """Return the plan as it stands; its history covers the iterations walked."""
        trail, batch = self._buffers.trail, self._batch
        batch.lengths[0], batch.made[0] = trail.levels[layout.BEST], trail.status[layout.MADE]
        if np.isfinite(batch.lengths[0]):
            edges = trail.best_edge[: trail.status[layout.BEST_DEPTH]]
            batch.paths[0] = self._buffers.nodes.cell[edges // layout.WIDTH]
        return batch.plan(0, self.done)

    def pheromone(self) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Return the (n, 3) cells where ants have left pheromone, and the most that each or any edge into it holds.

        Amounts are relative to the strongest of all, so 1 at most.
        """
        nodes, count = self._buffers.nodes, int(self._buffers.trail.status[layout.ROWS])
        unvisited, strength = self._buffers.trail.levels[layout.UNVISITED], np.zeros(count)
        if self._rules.pheromone_on == "node":
            strength = np.maximum(nodes.point[:count] - unvisited, 0.0)
        else:
            rows, slots = np.nonzero(nodes.child[:count] >= 0)
            np.maximum.at(strength, nodes.child[rows, slots], nodes.tau[rows, slots] - unvisited)
        cells = cells_of(self._scenario, nodes.cell[:count])
        return cells, strength / max(strength.max(initial=0.0), np.finfo(float).tiny)

    def _walk(self, run: Any, until: int) -> int:
        return int(advance(self._batch.ground, run, *self._buffers, self._batch.history, until))
