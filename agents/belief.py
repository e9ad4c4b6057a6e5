"""A Gaussian belief about candidates on one map: corrected by runs, asked for the best and for what to run next."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from agents.judgement import LONGEST
from agents.multitask import Prediction
from antgym.tuning import COST_CAP

Floats = NDArray[np.float64]
_NODES, _WEIGHTS = np.polynomial.hermite_e.hermegauss(9)  # of a standard normal
_SHARES = _WEIGHTS / _WEIGHTS.sum()


class Belief:
    """What is believed of m candidates: their log regrets, and the log cost of the map's best.

    A run that finds a path shows the sum of both, one that finds none shows that the regret is as large as it counts:
    log 2, for no run counts as more than twice the best.

    Args:
        prior: before any run.
    """

    def __init__(self, prior: Prediction) -> None:
        self._prior = prior
        self._runs: list[tuple[int, float]] = []
        self._mean, self._covariance = prior.mean, prior.covariance

    def observe(self, runs: Sequence[tuple[int, float]]) -> None:
        """Take in runs: (candidate, cost) each."""
        self._runs += runs
        candidates, costs = (np.array(column) for column in zip(*self._runs, strict=True))
        failed = costs >= COST_CAP
        shown = np.log(costs)
        if not failed.all():  # a lower cost than before shows that earlier ones counted for too much
            shown = np.minimum(shown, shown[~failed].min() + np.log(LONGEST))
        shown[failed] = np.log(LONGEST)
        design = np.zeros((len(candidates), len(self._prior.mean)))
        design[np.arange(len(candidates)), candidates] = 1.0
        design[~failed, -1] = 1.0
        reach = self._prior.covariance @ design.T
        doubt = design @ reach + np.diag(self._prior.noise[candidates])
        gain = np.linalg.solve(doubt, reach.T).T
        self._mean = self._prior.mean + gain @ (shown - design @ self._prior.mean)
        self._covariance = self._prior.covariance - gain @ reach.T

    @property
    def expected(self) -> Floats:
        """Expected log regret of every candidate, (m,)."""
        return self._mean[:-1]

    def best(self) -> int:
        """Return the candidate of the lowest expected regret."""
        return int(np.argmin(self.expected))

    def most_telling(self) -> int:
        """Return the candidate after one more run of which the best can be expected to be best.

        The knowledge gradient for correlated beliefs (Frazier, Powell & Dayanik 2009), its integral by quadrature.
        """
        covariance, variances = self._covariance, np.diag(self._covariance)
        shown = variances[:-1] + 2 * covariance[:-1, -1] + variances[-1] + self._prior.noise
        shifts = (covariance[:-1, :-1] + covariance[-1, :-1]) / np.sqrt(shown)[:, None]
        lowest = [(self.expected + node * shifts).min(axis=1) for node in _NODES]
        return int(np.argmin(_SHARES @ np.array(lowest)))
