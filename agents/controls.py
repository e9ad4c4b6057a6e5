"""Controls: what any tuner has to beat."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from agents.search import Search
from antgym.tuning import Task, Trial

Floats = NDArray[np.float64]


class UniformRandom:
    """Recommend one setting drawn uniformly from the unit cube; no trial."""

    def reset(self, task: Task, *, seed: int) -> None:
        """Draw the setting."""
        self._setting = np.random.default_rng(seed).random(len(task.space))

    def ask(self) -> Floats:
        """Return no settings, (0, d)."""
        return np.empty((0, len(self._setting)))

    def tell(self, trials: Sequence[Trial]) -> None:
        """Ignore trials."""

    def recommend(self) -> Floats:
        """Return the setting, (d,)."""
        return self._setting.copy()


class PublishedDefault:
    """Recommend the rule's published setting, the middle of the unit cube; no trial."""

    def reset(self, task: Task, *, seed: int) -> None:  # noqa: ARG002 - the protocol's signature
        """Note the number of parameters."""
        self._dimension = len(task.space)

    def ask(self) -> Floats:
        """Return no settings, (0, d)."""
        return np.empty((0, self._dimension))

    def tell(self, trials: Sequence[Trial]) -> None:
        """Ignore trials."""

    def recommend(self) -> Floats:
        """Return 1/2 everywhere, (d,)."""
        return np.full(self._dimension, 0.5)


class RandomSearch(Search):
    """Search with uniform settings, all in one batch, then run the best again."""

    def _start(self, task: Task, trials: int, seed: int) -> None:
        self._batch = np.random.default_rng(seed).random((trials, len(task.space)))

    def _propose(self) -> Floats:
        batch, self._batch = self._batch, self._batch[:0]
        return batch

    def _learn(self, costs: Floats) -> None:
        """Nothing to learn."""
