"""Sessions of a batch: the same budget on many problems, a trial of each at a time, in arrays."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antgym.errors import ParameterError
from antgym.tuning.budget import Budget
from antgym.tuning.problem import TRIAL, Runs, Task, TuningProblem, costs
from antgym.tuning.session import Trial, incumbent

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


class Ran(NamedTuple):
    """What n planner runs came to.

    Attributes:
        naturals: (n, d), what their settings were to the planner.
        lengths: (n,) in world units, inf where there was no path.
        costs: (n,), see :func:`antgym.tuning.problem.costs`.
        moves: (n,) int64, that all ants of a run made.
    """

    naturals: NDArray[np.float64]
    lengths: NDArray[np.float64]
    costs: NDArray[np.float64]
    moves: NDArray[np.int64]


class Sessions:
    """Sessions with the same budget, each of which pays for one setting at a time.

    Row i tells, bit for bit, what a :class:`Session` on its problem would; their budget charges them as it does that.

    Args:
        count: how many.
        budget: trials that each can pay for, ≥ 1.
        dimension: parameters of the space of every problem.

    Attributes:
        problems: (count,) what is tuned, seeds aside; None before it begins.
        seeds: (count,) int64, of the problems.
        made: (count,) int64, trials so far.
        best: (count,) the incumbents: ``unit`` and ``cost``, its mean; see :func:`incumbent`. Of no meaning before
            the first trial.
    """

    def __init__(self, count: int, budget: int, dimension: int) -> None:
        self._budget = Budget(budget, count)
        plain = ("cost", np.float64), ("work", np.int64), ("length", np.float64)
        kind = np.dtype([("unit", np.float64, dimension), *plain])
        self._paid = np.zeros((count, min(self._budget.total, _ROOM)), kind)
        self.problems = np.full(count, None, object)
        self.seeds, self.made = np.zeros((2, count), np.int64)
        self.best = np.zeros(count, kind)

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

    def evaluate(self, rows: NDArray[np.intp], units: NDArray[np.float64]) -> Ran:
        """Pay for a setting of each of some sessions in one planner call.

        Args:
            rows: sessions, at least one, in ascending order.
            units: (len(rows), d) settings in [0, 1].

        Raises:
            ParameterError: where one appears twice (nobody is charged).
            BudgetError: when one of them has no trial left (nobody is charged).
        """
        if (rows[1:] <= rows[:-1]).any():
            raise ParameterError(
                f"rows {rows.tolist()}: each session pays for one setting, in ascending order"
            )
        self._budget.charge(1, rows)
        ran = self.run(rows, units, TRIAL, self.made[rows])
        self._record(rows, units, ran)
        return ran

    def run(
        self, rows: NDArray[np.intp], units: NDArray[np.float64], domain: int, indices: NDArray[np.int64]
    ) -> Ran:
        """Run settings on seeds of a domain, a row each; the harness's way, charged to nobody."""
        keys = np.stack([np.full_like(indices, domain), indices], axis=1)
        runs = Runs(self.problems[rows].tolist(), self.seeds[rows].tolist(), units, keys)
        plans = runs.plan()
        return Ran(runs.naturals, plans.lengths, costs(runs.problems, plans.lengths), plans.moves)

    def history(self, rows: NDArray[np.intp], window: int) -> NDArray[np.void]:
        """Return ``unit`` and ``cost`` of the incumbents, then of the last trials of some sessions, latest first.

        Returns:
            (len(rows), 1 + window), zeros where there is none yet.
        """
        indices = self.made[rows, None] - np.maximum(np.arange(1 + window), 1)
        trials = self._paid[rows[:, None], np.maximum(indices, 0)]
        trials[:, 0] = self.best[rows]
        trials[indices < 0] = np.zeros((), trials.dtype)
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

    def _record(self, rows: NDArray[np.intp], units: NDArray[np.float64], ran: Ran) -> None:
        """Enter a trial of each of some sessions, and keep their incumbents."""
        made, trials = self.made[rows], np.empty(len(rows), self._paid.dtype)
        trials["unit"], trials["cost"] = units, ran.costs
        trials["work"], trials["length"] = ran.moves, ran.lengths
        if made.max() == self._paid.shape[1]:
            self._paid = np.concatenate([self._paid, np.zeros_like(self._paid)], axis=1)
        again = self._again(rows, units)
        self._paid[rows, made] = trials
        self.made[rows] += 1
        better = (made == 0) | (ran.costs < self.best["cost"][rows])
        self.best[rows[better]] = trials[better]
        for row in again:  # the mean of what was measured before has moved
            self.best["unit"][row], self.best["cost"][row] = incumbent(self._trials(row))

    def _again(self, rows: NDArray[np.intp], units: NDArray[np.float64]) -> list[int]:
        """Return which of some sessions have paid for a setting before."""
        made = self.made[rows]
        most = made.max()
        if most == 0:
            return []
        earlier = self._paid["unit"][rows, :most]
        same = (earlier == units[:, None]).all(axis=2) & (np.arange(most) < made[:, None])
        again: list[int] = rows[same.any(axis=1)].tolist()
        return again
