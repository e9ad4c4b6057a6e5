"""The hive: one run of bees that can be paused, steered and advanced together with others."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antgym.kernels.bees import begin, fly_block
from antgym.kernels.hive import MADE, Comb
from antgym.maps.discs import DiscScenario
from antgym.planners.bee_rules import BeeRules, find_bee_rules
from antgym.planners.diagnosis import Diagnosis
from antgym.planners.flights import Flights, fitted, write_bee_parameters
from antgym.planners.parameters import BeeParameters, check_bee_parameters
from antgym.planners.pausing import Paused
from antgym.planners.plans import Plan

LOOKED_AT = 32  # sources, at most, that are told apart
APART = 0.01  # of the world's width: sources whose way-points all lie closer are the same


class Hive(Paused[BeeParameters, Comb]):
    """One run that can be paused: ``Hive(...)``, ``advance(parameters, iterations)``, ``result()``.

    The sources are the state, and parameters are read anew every cycle: any split into blocks gives the plan of one
    block, bit for bit. ξ falls over all ``iterations``, however they are split. A hive is pickled as what was asked of
    it, and flies again.

    Args:
        scenario, rules, ants, iterations, seed: as for :func:`~antgym.planners.planning.plan`; ants are bees and
            iterations their cycles.
        buffers: what another hive released; without them, new ones are made.
    """

    _idle = "this hive has not flown yet"
    _released = "this hive has released its buffers"

    def __init__(
        self,
        scenario: DiscScenario,
        *,
        rules: str | BeeRules = "wu2018",
        ants: int = 40,
        iterations: int = 100,
        seed: int = 0,
        buffers: Comb | None = None,
    ) -> None:
        default = BeeParameters(1.0, 1.0, 1.0, 0.0)
        self._flights = Flights.of([scenario], [default], rules, ants, iterations, [seed])
        self._scenario, self._tabu = scenario, find_bee_rules(rules).tabu > 0
        self._asked = {"rules": rules, "ants": ants, "iterations": iterations, "seed": seed}
        self._iterations, self._next, self._since = iterations, default, 0
        self._begin(fitted(buffers, self._flights.runs))
        with np.errstate(over="ignore"):
            begin(self._flights.runs[0], self._flights.discs, self._buffers)

    @property
    def best(self) -> float:
        """Length of the best path so far, inf before any and where it touches a disc."""
        return float(self._flights.history.best[self._done - 1]) if self._done else np.inf

    @property
    def moves(self) -> int:
        """Paths that all bees have evaluated so far."""
        return int(self._buffers.status[MADE])

    @property
    def sources(self) -> NDArray[np.float64]:
        """The sources as they stand, (s, p + 2, 2) points from start to goal; a copy."""
        run = self._flights.runs[0]
        return self._buffers.place[: run.sources, :, : run.points + 2].swapaxes(1, 2).copy()

    def check(self, parameters: ArrayLike) -> NDArray[np.float64]:
        """Return (k, 4) natural values; ParameterError where one cannot be used."""
        return check_bee_parameters(parameters, self._tabu)

    def diagnosis(self) -> Diagnosis:
        """Return how the run stands after its last block, in the words of a colony's.

        ``arrived`` is the share of sources that are clear of discs, ``branching`` how far apart the sources lie, the
        mean standard deviation of their coordinates over that of random ones, and ``distinct`` the share of different
        sources; where a distance to the discs is to be kept, a better path may be longer, which gains nothing.
        """
        if not self._blocks:
            return Diagnosis()
        history, sources = self._flights.history, self.sources
        best = history.best[: self._done]
        before = float(best[self._since - 1]) if self._since else np.inf
        changes = np.flatnonzero(best[1:] != best[:-1])
        still = self._done - 1 - (int(changes[-1]) + 1 if len(changes) else 0)
        return Diagnosis(
            self._done / self._iterations,
            self.best,
            self._first,
            _gained(before, self.best),
            float(history.mean[self._done - 1]),
            (self._done if self.best == np.inf else still) / self._iterations,
            float(history.arrived[self._since : self._done].mean()) / len(sources),
            _spread(sources, self._scenario.world.bounds),
            _distinct(sources, APART * self._scenario.world.width),
        )

    def result(self) -> Plan:
        """Return the plan as it stands; its history covers the cycles flown."""
        flights = self._flights
        flights.lengths[0], flights.made[0] = self.best, self.moves
        flights.paths[0] = self._buffers.best[:, : flights.paths.shape[2]]
        return flights.plan(0, self._done)

    def _set(self, values: NDArray[np.float64]) -> None:
        """Write the parameters of the next block, (1, 4)."""
        write_bee_parameters(self._flights.runs, values)
        self._next = BeeParameters(*values[0].tolist())

    def _walk(self, iterations: int) -> None:
        flights, self._since, self._done = self._flights, self._done, self._done + iterations
        fly_block(flights.discs, flights.runs, self._buffers, flights.history, self._done)
        self._blocks.append((self._next, iterations))
        if self._first == np.inf:
            self._first = self.best


def _gained(before: float, after: float) -> float:
    """Return the share by which the shortest length fell; 1 for the first path."""
    if before == np.inf:
        return float(after < np.inf)
    return max((before - after) / before, 0.0)


def _spread(sources: NDArray[np.float64], bounds: tuple[float, float, float, float]) -> float:
    x_min, x_max, y_min, y_max = bounds
    random = np.array([x_max - x_min, y_max - y_min]) / np.sqrt(12)
    return min(float((sources[:, 1:-1].std(axis=0) / random).mean()), 1.0)


def _distinct(sources: NDArray[np.float64], apart: float) -> float:
    looked_at = sources[:LOOKED_AT].reshape(min(len(sources), LOOKED_AT), -1)
    same = np.abs(looked_at[:, None] - looked_at[None]).max(axis=2) < apart
    return 1.0 - float(np.tril(same, -1).any(axis=1).mean())
