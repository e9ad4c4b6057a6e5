"""Optuna's tree-structured Parzen estimator, asked in batches over the unit cube."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
from numpy.typing import NDArray

from agents.judgement import RERUN_SHARE
from agents.search import Search
from antgym.errors import MissingExtraError, ParameterError
from antgym.tuning import Task

Floats = NDArray[np.float64]
LARGEST_BATCH = 10


class TreeParzen(Search):
    """Optuna's TPE sampler with the defaults of Optuna 5: multivariate, constant liar.

    Args:
        batch: settings per ask, ≥ 1; None takes a tenth of the search, 1 to 10: small enough to learn often,
            large enough to keep the planner's threads busy.
        rerun_share: share of the budget kept to run the best settings again, in [0, 1).
    """

    def __init__(self, batch: int | None = None, rerun_share: float = RERUN_SHARE) -> None:
        if batch is not None and batch < 1:
            raise ParameterError(f"batch = {batch}: needs at least 1")
        super().__init__(rerun_share)
        self.batch = batch

    def _start(self, task: Task, trials: int, seed: int) -> None:
        optuna = _optuna()
        self._size = self.batch or fit_batch(trials)
        names = (f"x{i}" for i in range(len(task.space)))
        self._distributions = {name: optuna.distributions.FloatDistribution(0.0, 1.0) for name in names}
        self._failed = optuna.trial.TrialState.FAIL
        with _quiet(optuna):
            self._study = optuna.create_study(sampler=optuna.samplers.TPESampler(seed=narrow_seed(seed)))

    def _propose(self) -> Floats:
        self._asked = [self._study.ask(self._distributions) for _ in range(self._size)]
        return np.array([[trial.params[name] for name in self._distributions] for trial in self._asked])

    def _learn(self, costs: Floats) -> None:
        """Tell costs; what came back without one has failed, else the sampler would wait for it for ever."""
        for trial, cost in zip(self._asked, costs, strict=False):
            self._study.tell(trial, float(cost))
        for trial in self._asked[len(costs) :]:
            self._study.tell(trial, state=self._failed)


def fit_batch(trials: int) -> int:
    """Return the batch for a search of so many trials: a tenth of them, 1 to 10."""
    return min(LARGEST_BATCH, max(1, trials // 10))


def narrow_seed(seed: int) -> int:
    """Return a seed below 2³², all that Optuna takes, from any seed."""
    return int(np.random.SeedSequence(seed).generate_state(1)[0])


@contextmanager
def _quiet(optuna: Any) -> Iterator[None]:
    """Silence Optuna's note about every new study; the user's verbosity is back afterwards."""
    verbosity = optuna.logging.get_verbosity()
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    try:
        yield
    finally:
        optuna.logging.set_verbosity(verbosity)


def _optuna() -> Any:
    try:
        import optuna
    except ModuleNotFoundError as error:
        raise MissingExtraError("optuna", "agents") from error
    return optuna
