"""What agents share: a recommendation without a trial, or a search in batches, then the best again, then a verdict."""

from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from agents.judgement import RERUN_SHARE, Judgement
from antgym.tuning import Task, Trial

Floats = NDArray[np.float64]


class ZeroShot(ABC):
    """An agent that recommends what it sees fit for a task, with no trial."""

    def reset(self, task: Task, *, seed: int) -> None:
        """Choose for a task."""
        self._setting = self._choose(task, seed)

    def ask(self) -> Floats:
        """Return no settings, (0, d)."""
        return np.empty((0, len(self._setting)))

    def tell(self, trials: Sequence[Trial]) -> None:  # noqa: B027 - nothing to do, not to be filled in
        """Ignore trials."""

    def recommend(self) -> Floats:
        """Return the setting, (d,)."""
        return self._setting.copy()

    @abstractmethod
    def _choose(self, task: Task, seed: int) -> Floats:
        """Return the setting, (d,) in [0, 1]."""


class Search(ABC):
    """A search that proposes batches and learns their costs.

    Args:
        rerun_share: share of the budget kept to run the best settings again, in [0, 1).
    """

    def __init__(self, rerun_share: float = RERUN_SHARE) -> None:
        self.rerun_share = rerun_share

    def reset(self, task: Task, *, seed: int) -> None:
        """Start anew on a task."""
        self._judgement = Judgement(task, self.rerun_share)
        self._start(task, self._judgement.to_search, seed)

    def ask(self) -> Floats:
        """Return the next (k, d) settings: proposals, cut to the search's budget, then re-runs."""
        left = self._judgement.to_search
        if left and len(batch := self._propose()):
            return batch[:left]
        return self._judgement.reruns()

    def tell(self, trials: Sequence[Trial]) -> None:
        """Learn from trials; of a batch that came back short, the library learns only if it can."""
        if self._judgement.searching:
            self._learn(np.array([trial.cost for trial in trials]))
        self._judgement.add(trials)

    def recommend(self) -> Floats:
        """Return the (d,) setting with the lowest expected cost; the published default before any success."""
        return self._judgement.best()

    @abstractmethod
    def _start(self, task: Task, trials: int, seed: int) -> None:
        """Set up for a search of so many trials."""

    @abstractmethod
    def _propose(self) -> Floats:
        """Return the next batch, (k, d) in [0, 1]; k = 0 ends the search."""

    @abstractmethod
    def _learn(self, costs: Floats) -> None:
        """Take the costs of the last batch's first settings, (j,), j ≤ k."""


def narrow_seed(seed: int) -> int:
    """Return a seed below 2³², all that some libraries take, from any seed."""
    return int(np.random.SeedSequence(seed).generate_state(1)[0])
