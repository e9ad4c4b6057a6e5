"""Sessions: the only place where planner effort is spent, and the one evaluation counter."""

from collections.abc import Iterable, Iterator, Sequence
from contextlib import AbstractContextManager, ExitStack, contextmanager
from itertools import islice
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antgym.errors import LedgerError, ParameterError
from antgym.planners.space import check_together, decode_together
from antgym.tuning.budget import Budget
from antgym.tuning.open_trial import OpenTrial, walk_together
from antgym.tuning.problem import TRIAL, Request, Runs, Task, TuningProblem, costs


class Trial(NamedTuple):
    """One paid planner run.

    Attributes:
        index: 0 for the first trial of the session.
        unit: the setting, each value in [0, 1]; of a steered run the settings of all its blocks, one after the other.
        cost: length / straight-line distance, COST_CAP where no path was found.
        work: moves that ants made, or paths that bees evaluated.
    """

    index: int  # type: ignore[assignment]  # shadows tuple.index, which nobody wants of a trial
    unit: tuple[float, ...]
    cost: float
    work: int


class Record(NamedTuple):
    """A trial as a ledger keeps it: with what only the harness may see."""

    trial: Trial
    length: float
    seed: int


class Journal(Protocol):
    """Where a session writes what it paid for, and finds what an interrupted run had paid for."""

    def replay(self, index: int, unit: tuple[float, ...], seed: int) -> Record | None:
        """Return the recorded trial ``index``, or None; raise where it was made with another setting or seed."""
        ...

    def append(self, records: Sequence[Record]) -> None:
        """Keep records; on return, or when the outermost :meth:`hold` ends, they survive a crash."""
        ...

    def hold(self) -> AbstractContextManager[None]:
        """Let what is kept within be one write, of several journals where they lie together."""
        ...


class Session:
    """A budget of trials on one problem.

    Args:
        problem: what is tuned.
        budget: trials to pay for, ≥ 1.
        journal: a ledger's run; recorded trials are fed back instead of being run again.

    Attributes:
        opened: the trial that was opened last, under way or over; None where none was.
    """

    def __init__(self, problem: TuningProblem, budget: int, journal: Journal | None = None) -> None:
        self._budget = Budget(budget)
        self.problem = problem
        self.task: Task = problem.task(self._budget.total)
        self._records: list[Record] = []
        self.opened: OpenTrial | None = None
        self._journal = journal

    @property
    def left(self) -> int:
        """Trials that can still be paid for."""
        return int(self._budget.left[0])

    @property
    def trials(self) -> tuple[Trial, ...]:
        """What was paid for so far."""
        return tuple([record.trial for record in self._records])

    @property
    def lengths(self) -> tuple[float, ...]:
        """Path lengths of the trials in world units, inf where there was no path; the harness's, not the agent's."""
        return tuple([record.length for record in self._records])

    def evaluate(self, units: ArrayLike) -> tuple[Trial, ...]:
        """Pay for settings and return their trials.

        Args:
            units: (k, d) settings in [0, 1]; where fewer than k trials are left, the first of them are run.

        Raises:
            ParameterError: on a wrong shape or a value outside [0, 1] (nothing is charged).
            BudgetError: when no trial is left.
        """
        return evaluate_together([(self, units)])[0]

    def open(self, blocks: int, buffers: Any = None) -> OpenTrial:
        """Pay for one run that is steered by :func:`steer_together`; it becomes a trial with its last block.

        What a journal keeps of it is the sequence of its settings, and only once it is over: a run that is cut off is
        begun anew, one that is resumed is walked again, and must then come to what was recorded.

        Args:
            blocks: in how many the run is walked; 1 ≤ blocks ≤ iterations.
            buffers: released by a colony or a hive that is done with, see ``release`` of either.

        Raises:
            ParameterError: on a number of blocks that cannot be walked, or while a trial is under way.
            BudgetError: when no trial is left.
        """
        self._require_nothing_under_way()
        self._budget.check(1)
        self.opened = OpenTrial(self.problem, len(self._records), blocks, buffers)
        self._budget.charge(1)
        return self.opened

    def _require_nothing_under_way(self) -> None:
        if self.opened is not None and not self.opened.over:
            raise ParameterError("a trial is under way; steer it to its end first")

    def _under_way(self) -> OpenTrial:
        if self.opened is None or self.opened.over:
            raise ParameterError("no trial is under way; open() one")
        return self.opened

    def _close(self) -> None:
        """Enter the opened trial among those paid for."""
        assert self.opened is not None
        trial, length = self.opened, self.opened.length
        unit = tuple(value for setting in trial.units for value in setting)
        cost = float(self.problem.cost(np.array([length]))[0])
        record = Record(Trial(trial.index, unit, cost, trial.colony.moves), length, trial.seed)
        if self._journal is not None:
            kept = self._journal.replay(trial.index, unit, trial.seed)
            if kept is None:
                self._journal.append([record])
            elif kept != record:
                raise LedgerError(
                    f"steered again, trial {trial.index} comes to {record}, not to {kept} as before"
                )
        self._records.append(record)

    def _check(self, wanted: int) -> None:
        """Raise unless this number of trials can be asked for; charges nothing."""
        self._require_nothing_under_way()
        self._budget.check(wanted)

    def _claim(self, batch: NDArray[np.float64]) -> tuple[list[Record], Request]:
        """Charge a batch and split it into what a journal already holds and what is left to run."""
        first = len(self._records)
        granted = int(self._budget.charge(len(batch))[0])
        if granted < len(batch):
            batch = batch[:granted]
        replayed: list[Record] = []
        if self._journal is not None:
            for offset, unit in enumerate(batch):
                seed = int(self.problem.seeds(TRIAL, first + offset, 1)[0])
                record = self._journal.replay(first + offset, tuple(unit.tolist()), seed)
                if record is None:
                    break
                replayed.append(record)
            batch = batch[len(replayed) :]
        return replayed, (self.problem, batch, TRIAL, first + len(replayed))

    def _settle(self, replayed: list[Record], new: list[Record]) -> tuple[Trial, ...]:
        """Enter what was paid for among the trials and return it."""
        if self._journal is not None and new:
            self._journal.append(new)
        records = replayed + new
        self._records += records
        return tuple([record.trial for record in records])


def evaluate_together(requests: Iterable[tuple[Session, ArrayLike]]) -> list[tuple[Trial, ...]]:
    """Pay for the settings of several sessions in one planner call; the results are those of single calls.

    Raises:
        ParameterError: on settings that cannot be used, or a session that appears twice (nobody is charged).
        BudgetError: when one of them has no trial left (nobody is charged).
    """
    asked = list(requests)
    sessions = [session for session, _ in asked]
    batches = check_together([s.problem.space for s in sessions], [units for _, units in asked])
    for session, batch in zip(sessions, batches, strict=True):
        session._check(len(batch))
    _require_different(sessions)
    claims = [session._claim(batch) for session, batch in zip(sessions, batches, strict=True)]
    new = iter(_run([request for _, request in claims]))
    with _hold(sessions):
        return [
            session._settle(replayed, list(islice(new, len(request[1]))))
            for session, (replayed, request) in zip(sessions, claims, strict=True)
        ]


def steer_together(requests: Iterable[tuple[Session, ArrayLike]]) -> list[OpenTrial]:
    """Walk the next block of the trials that several sessions opened, in one planner call; they are paid already.

    Args:
        requests: sessions with a trial under way, and the setting of each for its next block, (d,) in [0, 1].

    Returns:
        The opened trials; those that are over now are among ``session.trials``.

    Raises:
        ParameterError: on a setting that cannot be used, a session without a trial under way, or one that appears
            twice (nothing is walked).
    """
    asked = list(requests)
    sessions = [session for session, _ in asked]
    trials = [session._under_way() for session in sessions]
    _require_different(sessions)
    if not asked:
        return []
    spaces = [session.problem.space for session in sessions]
    settings = np.concatenate([session.problem.space.check(unit) for session, unit in asked])
    if len(settings) != len(trials):
        raise ParameterError(
            f"{len(settings)} settings for {len(trials)} trials; each takes one for its next block"
        )
    walk_together(trials, settings, decode_together(spaces, settings))
    with _hold(sessions):
        for session, trial in zip(sessions, trials, strict=True):
            if trial.over:
                session._close()
    return trials


@contextmanager
def _hold(sessions: Iterable[Session]) -> Iterator[None]:
    """Let what journals keep of several sessions be one write."""
    with ExitStack() as stack:
        for session in sessions:
            if session._journal is not None:
                stack.enter_context(session._journal.hold())
        yield


def _require_different(sessions: Sequence[Session]) -> None:
    if len({id(session) for session in sessions}) < len(sessions):
        raise ParameterError("a session appears twice in one batch; hand over its settings as one request")


def incumbent(trials: Sequence[Trial]) -> tuple[tuple[float, ...], float]:
    """Return the setting with the lowest mean cost over its trials, and that mean; the earliest on a tie."""
    costs: dict[tuple[float, ...], list[float]] = {}
    for trial in trials:
        costs.setdefault(trial.unit, []).append(trial.cost)
    means = {unit: float(np.mean(values)) for unit, values in costs.items()}
    best = min(means, key=means.__getitem__)
    return best, means[best]


def _run(requests: list[Request]) -> list[Record]:
    """Run what is asked for in one planner call; return the records in order."""
    if not any(len(units) for _, units, _, _ in requests):
        return []
    runs = Runs.of(requests)
    plans = runs.plan()
    columns = (
        [first + i for _, units, _, first in requests for i in range(len(units))],
        runs.units.tolist(),
        costs(runs.problems, plans.lengths).tolist(),
        plans.moves.tolist(),
        plans.lengths.tolist(),
        plans.seeds.tolist(),
    )
    return [
        Record(Trial(index, tuple(unit), cost, work), length, seed)
        for index, unit, cost, work, length, seed in zip(*columns, strict=True)
    ]
