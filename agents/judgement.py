"""What to make of noisy trials: which settings to run again, and which one to recommend.

The best of many single runs is mostly a lucky run. Every searching agent therefore keeps a share of its
budget to run its best settings again, and recommends by a mean that trusts a setting the more, the more often
it was run.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from antgym.errors import ParameterError
from antgym.tuning import COST_CAP, Task, Trial

Floats = NDArray[np.float64]
RERUN_SHARE = 0.2
SMALLEST_WITH_RERUNS = 5
LONGEST = 2.0  # a path twice the optimum scores as none: gaps are capped at 1


class Judgement:
    """The trials of one task, and the split of its budget into search and re-runs.

    Re-runs come in rounds, each of the best third of what is left of their share, so a setting is run again
    only as long as it keeps its place. A budget below five has no re-runs.

    Args:
        task: the task.
        rerun_share: share of the budget kept for re-runs, in [0, 1).
    """

    def __init__(self, task: Task, rerun_share: float = RERUN_SHARE) -> None:
        if not 0 <= rerun_share < 1:
            raise ParameterError(f"rerun_share = {rerun_share}: must lie in [0, 1)")
        self._dimension = len(task.space)
        self._reserve = round(rerun_share * task.budget) if task.budget >= SMALLEST_WITH_RERUNS else 0
        self._search = task.budget - self._reserve
        self._costs: dict[tuple[float, ...], list[float]] = {}
        self.searching = True

    @property
    def to_search(self) -> int:
        """Trials left to search with."""
        return self._search if self.searching else 0

    def add(self, trials: Sequence[Trial]) -> None:
        """Note trials: the search's until the first call of ``reruns``, re-runs after it."""
        for trial in trials:
            self._costs.setdefault(trial.unit, []).append(trial.cost)
        if self.searching:
            self._search -= len(trials)
        else:
            self._reserve -= len(trials)

    def reruns(self) -> Floats:
        """End the search and return the next settings to run again, (k, d); k = 0 when all is spent."""
        self.searching = False
        settings = list(self._costs)
        count = min(len(settings), self._reserve, max(2, -(-self._reserve // 3)))
        if count < 1:
            return np.empty((0, self._dimension))
        order = np.argsort(expected_costs(list(self._costs.values())), kind="stable")
        return np.array([settings[i] for i in order[:count]])

    def best(self) -> Floats:
        """Return the setting of the lowest expected cost, (d,); the published default before any success."""
        if min((min(runs) for runs in self._costs.values()), default=COST_CAP) >= COST_CAP:
            return np.full(self._dimension, 0.5)
        expected = expected_costs(list(self._costs.values()))
        return np.array(list(self._costs)[int(np.argmin(expected))])


def expected_costs(runs: Sequence[Sequence[float]]) -> Floats:
    """Return the expected cost of each of n settings from its runs, (n,).

    Empirical Bayes: a mean of r runs is drawn towards the mean of all settings by the factor s² / (s² + v /
    r), with v the pooled variance between runs of one setting and s² the variance between settings, v taken
    off. Where nothing was run twice, v is unknown and the means stay as they are.
    """
    ceiling = LONGEST * min(min(r) for r in runs)
    capped = [np.minimum(r, ceiling) for r in runs]
    means, counts = np.array([r.mean() for r in capped]), np.array([len(r) for r in capped])
    noise = sum(((r - r.mean()) ** 2).sum() for r in capped) / max(1, counts.sum() - len(counts))
    if noise == 0:
        return means
    firsts = np.array([r[0] for r in capped])
    # the floor keeps an order among settings where unlucky re-runs make the noise look larger than everything
    signal = max(firsts.var() - noise, 0.05 * firsts.var())
    return firsts.mean() + signal / (signal + noise / counts) * (means - firsts.mean())


def cap_failures(costs: Floats, axis: int | tuple[int, ...] | None = None) -> Floats:
    """Return costs, none above twice the lowest along ``axis``.

    Gaps are capped in the same way; the lowest cost stands for the optimum. Without it a run that found no
    path would weigh as much as a path ten times the straight line.
    """
    return np.minimum(costs, LONGEST * costs.min(axis=axis, keepdims=True))
