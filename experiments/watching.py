"""Sessions that are watched: a bar moves as they pay, and little is lost when they are stopped."""

from collections.abc import Callable

from numpy.typing import ArrayLike

from antgym.tuning.problem import TuningProblem
from antgym.tuning.session import Journal, Session, Trial


class WatchedSession(Session):
    """A session that pays for a large batch in parts; its trials are those of an unwatched one.

    Args:
        problem: what is tuned.
        budget: trials to pay for, ≥ 1.
        advance: called with the number of trials after each part.
        journal: a ledger's run; what it holds of each part is on disk before the next begins.
        part: settings at most in one planner call, ≥ 1.
    """

    def __init__(
        self,
        problem: TuningProblem,
        budget: int,
        advance: Callable[[int], None],
        journal: Journal | None = None,
        part: int = 64,
    ) -> None:
        super().__init__(problem, budget, journal)
        self._advance, self._part = advance, part

    def evaluate(self, units: ArrayLike) -> tuple[Trial, ...]:
        """Pay for settings and return their trials; see :meth:`Session.evaluate`."""
        batch = self.problem.space.check(units)
        trials: tuple[Trial, ...] = ()
        while not trials or (len(trials) < len(batch) and self.left):
            paid = super().evaluate(batch[len(trials) : len(trials) + self._part])
            self._advance(len(paid))
            trials += paid
        return trials
