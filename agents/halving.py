"""Successive halving on the target: candidates that train maps suggest, run, halved, run again.

What is known of a candidate before it was run counts: a few noisy runs correct the expectation, they do not
replace it.
"""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from agents.experience import Spread
from agents.judgement import cap_failures
from antgym.tuning import Task, Trial

Floats = NDArray[np.float64]
FIRST = 0.6  # share of the budget that the first round spends
REPEATS = 10  # runs of one candidate at most


class Advice(NamedTuple):
    """What experience says of a task: (m, d) candidates, best first, and their expected log costs, (m,)."""

    candidates: Floats
    expected: Floats
    spread: Spread


class Halving(ABC):
    """An agent that runs candidates by successive halving and recommends the best it expects.

    The first round runs the first candidates once, on 0.6 of the budget; each further round runs the better half of
    the round before once more, at least two, until the budget or ten runs of the last two are spent. Budgets of
    0 and 1, with which nothing can be compared, are not spent: the first candidate is recommended.

    With log costs y of r runs, expectation μ, a common unknown level b, variance s² of a candidate about its
    expectation and variance v of a run, a candidate's judged log cost is μ + b + s² / (s² + v / r) · (ȳ − b − μ): see
    :func:`posterior`.
    """

    def reset(self, task: Task, *, seed: int) -> None:  # noqa: ARG002 - nothing here is random
        """Take on a task; ParameterError where it does not fit the experience."""
        self._advice = self._advise(task)
        self._runs: list[list[float]] = [[] for _ in self._advice.candidates]
        self._left = task.budget if task.budget > 1 else 0
        self._alive = list(range(max(2, round(FIRST * task.budget))))[: len(self._runs)]
        self._asked: list[int] = []

    def ask(self) -> Floats:
        """Return the candidates of the next round, (k, d); k = 0 ends the run."""
        if self._asked:
            self._alive = self._better_half()
        fresh = [i for i in self._alive if len(self._runs[i]) < REPEATS]
        self._asked = fresh[: self._left]
        return self._advice.candidates[self._asked].reshape(-1, self._advice.candidates.shape[1])

    def tell(self, trials: Sequence[Trial]) -> None:
        """Note the costs of the last ask's first candidates."""
        for candidate, trial in zip(self._asked, trials, strict=False):
            self._runs[candidate].append(trial.cost)
        self._left -= len(trials)

    def recommend(self) -> Floats:
        """Return the (d,) candidate of the lowest judged cost."""
        return self._advice.candidates[int(np.argmin(self._judged()))].copy()

    @abstractmethod
    def _advise(self, task: Task) -> Advice:
        """Return the candidates for a task."""

    def _judged(self) -> Floats:
        return posterior(self._advice.expected, self._runs, self._advice.spread)

    def _better_half(self) -> list[int]:
        judged = self._judged()
        keep = max(2, len(self._alive) // 2)
        return sorted(self._alive, key=lambda i: judged[i])[:keep]


def posterior(expected: Floats, runs: Sequence[Sequence[float]], spread: Spread) -> Floats:
    """Return the judged log cost of m candidates, (m,), from expectations and runs; see :class:`Halving`.

    Args:
        expected: (m,) expected log costs, up to a level that all share.
        runs: costs of each candidate's runs, none for some; no run counts as more than twice the best of all.
        spread: variances of the expectation and of a run.
    """
    tried = [i for i, costs in enumerate(runs) if costs]
    if not tried:
        return expected.copy()
    ceiling = np.array([min(min(runs[i]) for i in tried)])
    means = np.array([np.log(cap_failures(np.concatenate([ceiling, runs[i]]))[1:].mean()) for i in tried])
    variances = spread.between + spread.noise / np.array([len(runs[i]) for i in tried])
    surprise = means - expected[tried]
    level = (surprise / variances).sum() / (1 / variances).sum()
    judged = expected + level
    judged[tried] += spread.between / variances * (surprise - level)
    return judged
