"""The colony: one run of ants that can be paused, steered and advanced together with others."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antgym.kernels import layout
from antgym.kernels.ants import begin
from antgym.kernels.diagnosis import walk_block
from antgym.maps.world import Scenario
from antgym.planners.batch import Batch, cells_of, write_parameters
from antgym.planners.buffers import Buffers, fitted, grown, new_buffers
from antgym.planners.diagnosis import Diagnosis
from antgym.planners.parameters import ColonyParameters, check_parameters
from antgym.planners.pausing import Paused, advance_together
from antgym.planners.planning import plan, plan_many
from antgym.planners.plans import Plan, Plans
from antgym.planners.rules import Rules, find_rules

__all__ = ["Colony", "Diagnosis", "Plan", "Plans", "advance_together", "plan", "plan_many"]


class Colony(Paused[ColonyParameters, Buffers]):
    """One run that can be paused: ``Colony(...)``, ``advance(parameters, iterations)``, ``result()``.

    Pheromone is the state; a change of α or β makes rows be weighed again when they are next visited, the same
    parameters again touch nothing: any split into blocks gives the plan of one block, bit for bit. A colony is pickled
    as what was asked of it, and walks it again.

    Args:
        scenario, rules, ants, iterations, seed: as for :func:`plan`.
        buffers: what another colony released; without them, new ones are made.
    """

    _idle = "this colony has not walked yet"
    _released = "this colony has released its buffers, or lost them to an error"

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
        self._iterations = iterations
        self._next, self._changed = default, False
        self._begin(new_buffers(batch.runs) if buffers is None else fitted(buffers, batch.runs))
        self._report = np.full(layout.REPORT_SIZE, np.inf)
        begin(batch.runs[0], batch.tables, *self._buffers)

    @property
    def best(self) -> float:
        """Length of the shortest path so far, inf before any."""
        return float(self._report[layout.SHORTEST])

    @property
    def moves(self) -> int:
        """Moves that all ants have made so far."""
        return int(self._buffers.trail.status[layout.MADE])

    def check(self, parameters: ArrayLike) -> NDArray[np.float64]:
        """Return (k, 4) natural values; ParameterError where one cannot be used."""
        return check_parameters(parameters)

    def diagnosis(self) -> Diagnosis:
        """Return how the run stands after its last block."""
        if not self._blocks:
            return Diagnosis()
        best, gained, mean, stagnation, *rest = self._report.tolist()
        done, stagnation = self._done / self._iterations, stagnation / self._iterations
        return Diagnosis(done, best, self._first, gained, mean, stagnation, *rest)

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
