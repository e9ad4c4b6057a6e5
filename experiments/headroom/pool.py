"""A pool of settings under test: what is known of each, over one scenario or many, and the search that refines it."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from antgym.errors import ParameterError
from antgym.tuning.problem import Request, TuningProblem, run_together

Floats = NDArray[np.float64]
Advance = Callable[[int], None]
SEARCH, SCORE, DESIGN = 2, 3, 4  # seed domains: none is an agent's or a board's
_CHUNK = 4096  # planner runs per call: their histories lie in memory at once


class Stage(NamedTuple):
    """One round of a search.

    Attributes:
        keep: the best so many settings are measured further; 0: none are.
        repeats: runs each of these gets, per scenario.
        around: settings to draw near each of the three best, before measuring; 0: none.
        spread: standard deviation of these draws, in the unit cube.
    """

    keep: int
    repeats: int
    around: int = 0
    spread: float = 0.0


def design(count: int, dimension: int, seed: int = 0) -> Floats:
    """Return (count, d) settings that fill the unit cube (scrambled Sobol), the published default first."""
    filling = qmc.Sobol(dimension, rng=np.random.default_rng(seed)).random(1 << (count - 1).bit_length())
    return np.vstack([np.full((1, dimension), 0.5), filling[: count - 1]])


def run_gaps(requests: Sequence[Request], advance: Advance = lambda _: None) -> list[Floats]:
    """Return the gaps of many runs, chunk by chunk; charged to nobody: this is the harness measuring."""
    gaps: list[Floats] = []
    begun, runs = 0, 0
    for i, (_, units, _, _) in enumerate(requests):
        runs += len(units)
        if runs >= _CHUNK or i + 1 == len(requests):
            plans = run_together(list(requests[begun : i + 1]))
            gaps += [
                request[0].gap(p.lengths) for request, p in zip(requests[begun : i + 1], plans, strict=True)
            ]
            advance(runs)
            begun, runs = i + 1, 0
    return gaps


class Pool:
    """Settings and the mean gap of each over some problems.

    Args:
        problems: a setting's worth is its mean gap over all of them.
        units: (k, d) settings to begin with.
        seed: of the draws around the best.
    """

    def __init__(self, problems: Sequence[TuningProblem], units: Floats, seed: int = 0) -> None:
        if not problems:
            raise ParameterError("a pool needs a problem to measure its settings on")
        self.problems = tuple(problems)
        self.units = units
        self.total, self.count = np.zeros(len(units)), np.zeros(len(units))
        self._runs = 0
        self._rng = np.random.default_rng(seed)

    def best(self, count: int, among: NDArray[np.int64] | None = None) -> NDArray[np.int64]:
        """Return the indices of the settings with the lowest mean gap, of those that were measured, or of some."""
        mean = np.where(self.count > 0, self.total / np.maximum(self.count, 1), np.inf)
        order = np.argsort(mean, kind="stable").astype(np.int64)
        return (order if among is None else order[np.isin(order, among)])[:count]

    def draw_near(self, around: int, spread: float) -> NDArray[np.int64]:
        """Add settings near the three best; return their indices."""
        centres = np.repeat(self.units[self.best(3)], around, axis=0)
        fresh = np.clip(centres + self._rng.normal(0, spread, centres.shape), 0, 1)
        first = len(self.units)
        self.units = np.vstack([self.units, fresh])
        self.total, self.count = (
            np.append(array, np.zeros(len(fresh))) for array in (self.total, self.count)
        )
        return np.arange(first, len(self.units))

    def requests(self, indices: NDArray[np.int64], repeats: int) -> list[Request]:
        """Return the runs that measure some settings, on seeds of their own."""
        units, first = np.repeat(self.units[indices], repeats, axis=0), self._runs
        self._runs += len(units)
        return [(problem, units, SEARCH, first) for problem in self.problems]

    def record(self, indices: NDArray[np.int64], repeats: int, gaps: Sequence[Floats]) -> None:
        """Take in what these runs gave."""
        sums = np.sum([each.reshape(len(indices), repeats).sum(axis=1) for each in gaps], axis=0)
        self.total[indices] += sums
        self.count[indices] += repeats * len(self.problems)


def search(pools: Sequence[Pool], stages: Sequence[Stage], advance: Advance) -> Floats:
    """Refine all pools together, stage by stage; return the (len(pools), d) winners."""
    for number, stage in enumerate(stages):
        for new in (True, False) if stage.around else (False,):
            chosen = []
            for pool in pools:
                if new:
                    chosen.append(pool.draw_near(stage.around, stage.spread))
                else:
                    chosen.append(pool.best(stage.keep) if number else np.arange(len(pool.units)))
            _measure(pools, chosen, stage.repeats, advance)
    # of the last round alone: what was dropped before it was run too few times to win
    return np.array([p.units[p.best(1, among=last)[0]] for p, last in zip(pools, chosen, strict=True)])


def cost(settings: int, stages: Sequence[Stage]) -> int:
    """Return how many runs per problem a search takes that begins with so many settings."""
    runs = 0
    for number, stage in enumerate(stages):
        new = min(3, settings) * stage.around
        kept = min(stage.keep, settings + new) if number else settings
        settings += new
        runs += (kept + new) * stage.repeats
    return runs


def _measure(
    pools: Sequence[Pool], chosen: Sequence[NDArray[np.int64]], repeats: int, advance: Advance
) -> None:
    requests = [pool.requests(indices, repeats) for pool, indices in zip(pools, chosen, strict=True)]
    gaps = iter(run_gaps([request for each in requests for request in each], advance))
    for pool, indices, each in zip(pools, chosen, requests, strict=True):
        pool.record(indices, repeats, [next(gaps) for _ in each])
