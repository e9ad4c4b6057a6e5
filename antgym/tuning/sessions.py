"""Sessions of a batch: the same budget on many problems, a trial of each at a time, in arrays."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antgym.planners.colony import Plans
from antgym.planners.parameters import ColonyParameters
from antgym.tuning.budget import Budget
from antgym.tuning.problem import TRIAL, Runs, Task, TuningProblem, costs
from antgym.tuning.session import Trial, incumbent

_DIMENSION = len(ColonyParameters._fields)
_PAID = np.dtype(
    [("unit", np.float64, _DIMENSION), ("cost", np.float64), ("work", np.int64), ("length", np.float64)]
)
_ROOM = 8  # trials that there is room for at first


class Account(NamedTuple):
    """How one session of a batch stands: what a :class:`Session` tells, but nothing can be paid from it.

    Attributes:
        problem: what is tuned.
        task: what an agent sees of it.
        left: trials that could still be paid for.
        trials: what was paid for.
        lengths: path lengths of the trials in world units, inf where there was no path.
    """

    problem: TuningProblem
    task: Task
    left: int
    trials: tuple[Trial, ...]
    lengths: tuple[float, ...]


class Sessions:
    """Sessions with the same budget, each of which pays for one setting at a time.

    Row i tells, bit for bit, what a :class:`Session` on its problem would; their budget charges them as it does that.

    Args:
        count: how many.
        budget: trials that each can pay for, ≥ 1.

    Attributes:
        problems: (count,) what is tuned, seeds aside; None before it begins.
        seeds: (count,) int64, of the problems.
        made: (count,) int64, trials so far.
        best: (count,) the incumbents: ``unit`` and ``cost``, its mean; see :func:`incumbent`. Of no meaning before
            the first trial.
    """

    def __init__(self, count: int, budget: int) -> None:
        self._budget = Budget(budget, count)
        self._paid = np.zeros((count, min(self._budget.total, _ROOM)), _PAID)
        self.problems = np.full(count, None, object)
        self.seeds, self.made = np.zeros((2, count), np.int64)
        self.best = np.zeros(count, _PAID)

    @property
    def total(self) -> int:
        """Trials that each session has to begin with."""
        return self._budget.total

    @property
    def left(self) -> NDArray[np.int64]:
        """Trials that each session can still pay for, (count,)."""
        return self._budget.left

    def begin(
        self, rows: NDArray[np.intp], problems: Sequence[TuningProblem], seeds: NDArray[np.int64]
    ) -> None:
        """Begin some sessions anew, on problems under seeds in the place of their own."""
        self.problems[rows], self.seeds[rows], self.made[rows] = problems, seeds, 0
        self._budget.renew(rows)

    def evaluate(self, rows: NDArray[np.intp], units: NDArray[np.float64]) -> tuple[Runs, Plans]:
        """Pay for a setting of each of some sessions in one planner call and return what was run, and its plans.

        Args:
            rows: different sessions.
            units: (len(rows), d) settings in [0, 1].

        Raises:
            BudgetError: when one of them has no trial left (nobody is charged).
        """
        self._budget.charge(1, rows)
        runs, plans = self.run(rows, units, TRIAL, self.made[rows])
        self._record(rows, units, costs(runs.problems, plans.lengths), plans)
        return runs, plans

    def run(
        self, rows: NDArray[np.intp], units: NDArray[np.float64], domain: int, indices: NDArray[np.int64]
    ) -> tuple[Runs, Plans]:
        """Run settings on seeds of a domain, a row each; the harness's way, charged to nobody."""
        keys = np.stack([np.full_like(indices, domain), indices], axis=1)
        runs = Runs(self.problems[rows].tolist(), self.seeds[rows].tolist(), units, keys)
        return runs, runs.plan()

    def latest(self, rows: NDArray[np.intp], count: int) -> NDArray[np.void]:
        """Return the last trials of some sessions, (len(rows), count), latest first, zeros where there is none yet."""
        indices = self.made[rows, None] - 1 - np.arange(count)
        trials = self._paid[rows[:, None], np.maximum(indices, 0)]
        trials[indices < 0] = np.zeros((), _PAID)
        return trials

    def account(self, row: int) -> Account:
        """Return how one session stands."""
        problem = self.problems[row].seeded(int(self.seeds[row]))
        lengths = self._paid["length"][row, : self.made[row]].tolist()
        task, left = problem.task(self.total), int(self.left[row])
        return Account(problem, task, left, self._trials(row), tuple(lengths))

    def _trials(self, row: int) -> tuple[Trial, ...]:
        paid = self._paid[row, : self.made[row]]
        columns = paid["unit"].tolist(), paid["cost"].tolist(), paid["work"].tolist()
        return tuple(
            [Trial(i, tuple(unit), *rest) for i, (unit, *rest) in enumerate(zip(*columns, strict=True))]
        )

    def _record(
        self, rows: NDArray[np.intp], units: NDArray[np.float64], paid: NDArray[np.float64], plans: Plans
    ) -> None:
        """Enter a trial of each of some sessions, and keep their incumbents."""
        made = self.made[rows]
        if made.max() == self._paid.shape[1]:
            self._paid = np.concatenate([self._paid, np.zeros_like(self._paid)], axis=1)
        earlier = self._paid["unit"][rows, : made.max()]
        again = (earlier == units[:, None]).all(axis=2) & (np.arange(earlier.shape[1]) < made[:, None])
        trials = np.empty(len(rows), _PAID)
        trials["unit"], trials["cost"], trials["work"], trials["length"] = (
            units,
            paid,
            plans.moves,
            plans.lengths,
        )
        self._paid[rows, made] = trials
        self.made[rows] += 1
        better = (made == 0) | (paid < self.best["cost"][rows])
        self.best[rows[better]] = trials[better]
        for row in rows[again.any(axis=1)].tolist():  # its mean has moved
            self.best["unit"][row], self.best["cost"][row] = incumbent(self._trials(row))
