"""The colony: plans a scenario, or many at once, or some in blocks."""

from collections.abc import Sequence
from typing import Any, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antgym.errors import ParameterError
from antgym.kernels import layout
from antgym.kernels.ants import begin
from antgym.kernels.diagnosis import walk_block
from antgym.maps.world import Scenario
from antgym.planners.batch import Batch, Plan, cells_of, write_parameters
from antgym.planners.buffers import Buffers, fitted, grown, new_buffers
from antgym.planners.diagnosis import Diagnosis
from antgym.planners.parameters import ColonyParameters, check_parameters
from antgym.planners.rules import Rules, find_rules
from antgym.planners.threads import run_ranges

__all__ = ["Colony", "Diagnosis", "Plan", "Plans", "advance_together", "plan", "plan_many"]


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
    parameters again touch nothing: any split into blocks gives the plan of one block, bit for bit. A colony is pickled
    as what was asked of it, and walks it again.

    Args:
        scenario, rules, ants, iterations, seed: as for :func:`plan`.
        buffers: what another colony released; without them, new ones are made.
    """

    def __init__(
        self,
        scenario: Scenario,
        *,
        rules: str | Rules = "liu2020",
        ants: int = 20,
        iterations: int = 100,
        seed: int = 0,
        buffers: Buffers | None = None,
    ) -> None:
        default = ColonyParameters(1.0, 1.0, 0.5, 1.0)
        self._batch = batch = Batch.of([scenario], [default], rules, ants, iterations, [seed])
        self._scenario, self._rules = scenario, find_rules(rules)
        self._asked = {"rules": rules, "ants": ants, "iterations": iterations, "seed": seed}
        self._blocks: list[tuple[ColonyParameters, int]] = []
        self._iterations, self._done = iterations, 0
        self._next, self._changed = default, False
        self._kept: Buffers | None = (
            new_buffers(batch.runs) if buffers is None else fitted(buffers, batch.runs)
        )
        self._report, self._first = np.full(layout.REPORT_SIZE, np.inf), np.inf
        begin(batch.runs[0], batch.tables, *self._buffers)

    def __reduce__(self) -> tuple[Any, ...]:
        return _walked_again, (self._scenario, self._asked, self._blocks)

    @property
    def _buffers(self) -> Buffers:
        if self._kept is None:
            raise ParameterError(
                "this colony has released its buffers, or lost them to an error; nothing more can be asked of it"
            )
        return self._kept

    @property
    def parameters(self) -> ColonyParameters:
        """Those of the last block; ParameterError before any."""
        if not self._blocks:
            raise ParameterError("this colony has not walked yet; advance() it")
        return self._blocks[-1][0]

    @property
    def best(self) -> float:
        """Length of the shortest path so far, inf before any."""
        return float(self._report[layout.SHORTEST])

    @property
    def moves(self) -> int:
        """Moves that all ants have made so far."""
        return int(self._buffers.trail.status[layout.MADE])

    @property
    def done(self) -> int:
        """Iterations walked so far."""
        return self._done

    @property
    def left(self) -> int:
        """Iterations that can still be walked."""
        return self._iterations - self._done

    def advance(self, parameters: ArrayLike, iterations: int) -> None:
        """Walk some more iterations under (α, β, ρ, Q); ParameterError if more are asked for than are left."""
        advance_together([self], check_parameters(parameters), [iterations])

    def diagnosis(self) -> Diagnosis:
        """Return how the run stands after its last block."""
        if not self._blocks:
            return Diagnosis()
        best, gained, mean, stagnation, *rest = self._report.tolist()
        done, stagnation = self._done / self._iterations, stagnation / self._iterations
        return Diagnosis(done, best, self._first, gained, mean, stagnation, *rest)

    def release(self) -> Buffers:
        """Give the buffers away to another colony; nothing more can be asked of this one."""
        buffers = self._buffers
        self._kept = None
        return buffers

    def result(self) -> Plan:
        """Return the plan as it stands; its history covers the iterations walked."""
        trail, batch = self._buffers.trail, self._batch
        batch.lengths[0], batch.made[0] = trail.levels[layout.BEST], trail.status[layout.MADE]
        if np.isfinite(batch.lengths[0]):
            edges = trail.best_edge[: trail.status[layout.BEST_DEPTH]]
            batch.paths[0] = self._buffers.nodes.cell[edges // layout.WIDTH]
        return batch.plan(0, self._done)

    def pheromone(self) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Return the (n, 3) cells that ants have visited, and by how much each or any edge into it grew.

        Amounts are over what the rules begin with, and relative to the strongest of all, so 1 at most.
        """
        moves, nodes, trail = self._buffers
        count, unvisited = int(trail.status[layout.ROWS]), trail.levels[layout.UNVISITED]
        strength = np.zeros(count)
        if self._rules.pheromone_on == "node":
            strength = np.maximum(nodes.point[:count] - unvisited, 0.0)
        else:
            rows, slots = np.nonzero(nodes.child[:count] >= 0)
            children, initial = nodes.child[rows, slots], np.full(len(rows), unvisited)
            if self._rules.initial == "degree":
                shares = moves.length[slots] / self._scenario.mean_move
                initial *= np.maximum(nodes.degree[children], 1) * shares
            np.maximum.at(strength, children, nodes.tau[rows, slots] - initial)
        cells = cells_of(self._scenario, nodes.cell[:count])
        return cells, strength / max(strength.max(initial=0.0), np.finfo(float).tiny)

    def _set(self, values: NDArray[np.float64]) -> None:
        """Write the parameters of the next block, (1, 4)."""
        weighed_with = self._weights()
        write_parameters(self._batch.runs, values, [self._rules])
        self._changed = bool(self._blocks) and weighed_with != self._weights()
        self._next = ColonyParameters(*values[0].tolist())

    def _weights(self) -> tuple[float, float]:
        return float(self._batch.runs["alpha"][0]), float(self._batch.runs["beta"][0])

    def _walk(self, iterations: int) -> None:
        span = _, until = self._done, self._done + iterations
        batch, changed = self._batch, self._changed
        # an error on the way leaves nothing half walked to go on with
        buffers, self._kept = self._buffers, None
        while (
            walk_block(batch.ground, batch.runs, *buffers, batch.history, *span, changed, self._report)
            < until
        ):
            buffers, changed = grown(buffers), False
        self._kept = buffers
        self._blocks.append((self._next, iterations))
        self._done = until
        if self._first == np.inf:
            self._first = self.best


def advance_together(colonies: Sequence[Colony], parameters: ArrayLike, iterations: Sequence[int]) -> None:
    """Walk a block of several colonies on ANTGYM_THREADS threads; each as its own ``advance`` would.

    Args:
        colonies: n different ones.
        parameters: (n, 4) natural values (α, β, ρ, Q).
        iterations: n numbers, none larger than what its colony has left.

    Raises:
        ParameterError: if one of them cannot be walked; then none is.
    """
    values = check_parameters(parameters)
    if not len({id(colony) for colony in colonies}) == len(values) == len(iterations):
        raise ParameterError(
            f"{len(values)} parameter sets and {len(iterations)} numbers of iterations for "
            f"{len({id(colony) for colony in colonies})} different colonies"
        )
    for colony, count in zip(colonies, iterations, strict=True):
        if not 1 <= count <= colony.left:
            raise ParameterError(f"iterations = {count}: this colony has {colony.left} left")
    for i, colony in enumerate(colonies):
        colony._set(values[i : i + 1])

    def walk(first: int, last: int) -> None:
        with np.errstate(over="ignore"):  # interpreted, random numbers and hashes wrap around
            for i in range(first, last):
                colonies[i]._walk(iterations[i])

    if len(colonies):
        run_ranges(walk, len(colonies))


def _walked_again(
    scenario: Scenario, asked: dict[str, Any], blocks: list[tuple[ColonyParameters, int]]
) -> Colony:
    """Return the colony that a pickled one was."""
    colony = Colony(scenario, **asked)
    for parameters, iterations in blocks:
        colony.advance(parameters, iterations)
    return colony
