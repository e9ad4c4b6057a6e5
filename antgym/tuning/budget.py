"""Budgets: the one count of what sessions have paid for, alone or side by side."""

import numpy as np
from numpy.typing import NDArray

from antgym.errors import BudgetError, is_count

Rows = NDArray[np.intp] | slice
ALL = slice(None)


class Budget:
    """A number of trials; each of some sessions can spend it once.

    Args:
        total: trials.
        sessions: that have as many each; one alone by default.

    Attributes:
        spent: (sessions,) int64, trials that each has paid for.

    Raises:
        BudgetError: if ``total`` is not a positive whole number.
    """

    def __init__(self, total: int, sessions: int = 1) -> None:
        if not is_count(total):
            raise BudgetError(f"budget = {total!r}: a session needs a whole number of trials, at least one")
        self.total = int(total)
        self.spent = np.zeros(sessions, np.int64)

    @property
    def left(self) -> NDArray[np.int64]:
        """Trials that each session can still pay for."""
        return self.total - self.spent

    def check(self, wanted: int, rows: Rows = ALL) -> None:
        """Raise BudgetError where ``wanted`` is nothing, or one of some sessions has nothing left."""
        if wanted < 1:
            raise BudgetError("an empty batch of settings was asked for; ask for at least one")
        if (self.spent[rows] == self.total).any():
            raise BudgetError(f"all {self.total} trials are spent; stop when session.left is 0")

    def charge(self, wanted: int, rows: Rows = ALL) -> NDArray[np.int64]:
        """Spend up to ``wanted`` trials of each of some sessions and return how many."""
        self.check(wanted, rows)
        granted = np.minimum(wanted, self.left[rows])
        self.spent[rows] += granted
        return granted

    def renew(self, rows: Rows) -> None:
        """Hand the whole budget to some sessions that begin anew."""
        self.spent[rows] = 0
