"""Optuna's samplers over the unit cube, asked in batches: one class for all, and one that races repeated runs."""

import inspect
import math
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from agents.judgement import LONGEST, RERUN_SHARE
from agents.search import Search, narrow_seed
from antgym.errors import MissingExtraError, ParameterError, nearest
from antgym.tuning import COST_CAP, Task

Floats = NDArray[np.float64]
LARGEST_BATCH, MOST_RUNS = 10, 6
SAMPLERS = {
    "TPESampler": (),
    "GPSampler": ("greenlet", "torch"),
    "CmaEsSampler": ("cmaes",),
    "QMCSampler": (),
}
"""Which of Optuna's samplers can be asked, and what each needs beside Optuna (GPSampler is slow without greenlet)."""
EXTRAS = {"torch": "gp", "greenlet": "gp", "cmaes": "agents", "optuna": "agents"}


class OptunaSearch(Search):
    """A sampler of Optuna's, with the defaults of Optuna 5 unless told otherwise.

    Args:
        sampler: its class: ``TPESampler`` (by default multivariate, constant liar), ``GPSampler``, ``CmaEsSampler`` or
            ``QMCSampler``.
        batch: settings per ask, ≥ 1; None takes a tenth of the search, 1 to 10: small enough to learn often, large
            enough to keep the planner's threads busy; and whole generations of ``CmaEsSampler``, after its one random
            setting.
        rerun_share: share of the budget kept to run the best settings again, in [0, 1).
        arguments: of the sampler, ``seed`` apart.
    """

    def __init__(
        self,
        sampler: str = "TPESampler",
        batch: int | None = None,
        rerun_share: float = RERUN_SHARE,
        **arguments: Any,
    ) -> None:
        if batch is not None and batch < 1:
            raise ParameterError(f"batch = {batch}: needs at least 1")
        if sampler not in SAMPLERS:
            raise ParameterError(f"unknown sampler {sampler!r}; {nearest(sampler, tuple(SAMPLERS))}")
        self._optuna = _library("optuna")
        for library in SAMPLERS[sampler]:
            _library(library)
        _check_arguments(getattr(self._optuna.samplers, sampler), arguments)
        super().__init__(rerun_share)
        self.sampler, self.batch, self.arguments = sampler, batch, arguments

    def _start(self, task: Task, trials: int, seed: int) -> None:
        names = (f"x{i}" for i in range(len(task.space)))
        self._distributions = {name: self._optuna.distributions.FloatDistribution(0.0, 1.0) for name in names}
        self._size = self.batch or self._fit_batch(trials, len(task.space))
        self._begun, self._lowest = False, COST_CAP
        with _quiet(self._optuna):
            sampler = getattr(self._optuna.samplers, self.sampler)(seed=narrow_seed(seed), **self.arguments)
            self._study = self._optuna.create_study(sampler=sampler)

    def _fit_batch(self, trials: int, dimension: int) -> int:
        if self.sampler == "CmaEsSampler":
            return int(self.arguments.get("popsize") or 4 + math.floor(3 * math.log(dimension)))
        return fit_batch(trials)

    def _propose(self) -> Floats:
        # CmaEsSampler draws at random until a first cost is known: a batch of those would be a generation wasted
        size = 1 if self.sampler == "CmaEsSampler" and not self._begun else self._size
        with _quiet(self._optuna):
            self._asked = [self._study.ask(self._distributions) for _ in range(size)]
        self._begun = True
        return self._settings(self._asked)

    def _settings(self, trials: list[Any]) -> Floats:
        return np.array([[trial.params[name] for name in self._distributions] for trial in trials])

    def _learn(self, costs: Floats) -> None:
        """Tell costs; what came back without one has failed, else the sampler would wait for it for ever."""
        if self.sampler == "GPSampler":  # it takes costs at face value, the others go by their order
            costs = self._cap(costs)
        for trial, cost in zip(self._asked, costs, strict=False):
            self._study.tell(trial, float(cost))
        for trial in self._asked[len(costs) :]:
            self._study.tell(trial, state=self._optuna.trial.TrialState.FAIL)

    def _cap(self, costs: Floats) -> Floats:
        """Return costs, none above twice the lowest so far, as gaps are capped."""
        self._lowest = min([self._lowest, *costs.tolist()])
        return np.minimum(costs, LONGEST * self._lowest)


class OptunaRace(OptunaSearch):
    """A sampler of Optuna's whose settings are run several times, with its Wilcoxon pruner to stop the worse ones.

    It begins with one run each of up to ten settings, and the best of them gets all its runs. From then on a few are
    under way, each with one run per ask. One is over after ``repeats`` runs; or after its first, where that is worse
    than every run of the best setting; or as soon as the signed-rank test against the best says so. The sampler learns
    its mean. Runs of two settings are paired by their order: they share no seed, but runs that do hardly correlate.

    Args:
        repeats: runs of a setting at most, ≥ 2; None takes an eighth of the search, 2 to 6.
        p_threshold: of the pruner; with its own 0.1 nothing is stopped before the fourth run, with 0.2 the third.
        batch: settings under way at once, ≥ 1; None takes a twentieth of the search, 1 to 10.
        rerun_share: share of the budget kept to run the best settings again, in [0, 1).
        sampler: as for :class:`OptunaSearch`.
        arguments: of the sampler, ``seed`` apart.
    """

    def __init__(
        self,
        repeats: int | None = None,
        p_threshold: float = 0.2,
        batch: int | None = None,
        rerun_share: float = RERUN_SHARE,
        sampler: str = "TPESampler",
        **arguments: Any,
    ) -> None:
        if repeats is not None and repeats < 2:
            raise ParameterError(f"repeats = {repeats}: a race needs at least 2")
        if not 0 <= p_threshold <= 1:
            raise ParameterError(f"p_threshold = {p_threshold}: must lie in [0, 1]")
        super().__init__(sampler, batch, rerun_share, **arguments)
        self.repeats, self.p_threshold = repeats, p_threshold

    def _start(self, task: Task, trials: int, seed: int) -> None:
        super()._start(task, trials, seed)
        with _quiet(self._optuna):
            self._study.pruner = self._optuna.pruners.WilcoxonPruner(p_threshold=self.p_threshold)
        self._runs = self.repeats or min(MOST_RUNS, max(2, trials // 8))
        self._first = min(LARGEST_BATCH, max(1, trials // 2))
        self._under_way: list[_Runs] = []
        self._bar: float | None = None  # the worst run of the best setting, once one has all its runs

    def _fit_batch(self, trials: int, dimension: int) -> int:  # noqa: ARG002 - a race has no generations
        return fit_batch(trials // 2)

    def _propose(self) -> Floats:
        self._asked = self._next()
        return self._settings([runs.trial for runs in self._asked])

    def _next(self) -> "list[_Runs]":
        """Return what to run next, a setting as often as it is to be run."""
        if self._bar is None and self._under_way:
            if unseen := [runs for runs in self._under_way if not runs.costs]:
                return unseen
            best = min(self._under_way, key=lambda runs: runs.costs[0])
            return [best] * (self._runs - len(best.costs))
        with _quiet(self._optuna):
            while len(self._under_way) < (self._first if self._bar is None else self._size):
                self._under_way.append(_Runs(self._study.ask(self._distributions), []))
        return list(self._under_way)

    def _learn(self, costs: Floats) -> None:
        """Report the runs, and tell what is over; a setting that got no run waits for its next."""
        for runs, cost in zip(self._asked, self._cap(costs).tolist(), strict=False):
            runs.trial.report(cost, step=len(runs.costs))
            runs.costs.append(cost)
        with _quiet(self._optuna):
            for runs in sorted(self._under_way, key=lambda runs: -len(runs.costs)):
                if self._is_over(runs):
                    self._study.tell(runs.trial, float(np.mean(runs.costs)))
                    self._bar = max(self._study.best_trial.intermediate_values.values())
                    self._under_way.remove(runs)

    def _is_over(self, runs: "_Runs") -> bool:
        """Whether a setting has had its runs, or is worse than the best; what is told is so never the best by luck."""
        if len(runs.costs) == self._runs:
            return True
        if self._bar is None or not runs.costs:
            return False
        return runs.costs[0] > self._bar if len(runs.costs) == 1 else bool(runs.trial.should_prune())


class _Runs(NamedTuple):
    """A setting under way: Optuna's trial, and the costs of its runs so far."""

    trial: Any
    costs: list[float]


def fit_batch(trials: int) -> int:
    """Return the batch for a search of so many trials: a tenth of them, 1 to 10."""
    return min(LARGEST_BATCH, max(1, trials // 10))


@contextmanager
def _quiet(optuna: Any) -> Iterator[None]:
    """Silence Optuna's notes and its warnings of what is experimental; the user's verbosity is back afterwards."""
    verbosity = optuna.logging.get_verbosity()
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", optuna.exceptions.ExperimentalWarning)
            yield
    finally:
        optuna.logging.set_verbosity(verbosity)


def _check_arguments(sampler: type, arguments: dict[str, Any]) -> None:
    known = tuple(name for name in inspect.signature(sampler).parameters if name != "seed")
    for name in arguments:
        if name not in known:
            raise ParameterError(f"{sampler.__name__} has no argument {name!r}; {nearest(name, known)}")


def _library(name: str) -> Any:
    try:
        return import_module(name)
    except ModuleNotFoundError as error:
        raise MissingExtraError(name, EXTRAS[name]) from error
