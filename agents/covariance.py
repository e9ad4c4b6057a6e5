"""CMA-ES, by the package ``cmaes``, a whole generation per ask.

Of the packages at hand it is the one whose every optimiser has a random generator of its own; pymoo wraps pycma, which
seeds NumPy's global one, so that agents that take turns would disturb each other. Optuna's sampler stands on it too.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from agents.judgement import RERUN_SHARE
from agents.search import Search, narrow_seed
from antgym.errors import MissingExtraError, ParameterError
from antgym.tuning import Task

Floats = NDArray[np.float64]
GROWTH = 2


class CovarianceAdaptation(Search):
    """CMA-ES from the published default, started anew with twice the population where it has converged (IPOP).

    Args:
        population: settings per generation, ≥ 2; None takes 4 + 3 ln d, as published.
        sigma: standard deviation of the first generation, in the unit cube, > 0. Half the cube, for around the
            published default a whole generation can fail, and its ranks then say nothing.
        lr_adapt: whether learning rates adapt to the noise (LRA-CMA-ES); slower where there is little of it.
        rerun_share: share of the budget kept to run the best settings again, in [0, 1).
    """

    def __init__(
        self,
        population: int | None = None,
        sigma: float = 0.5,
        lr_adapt: bool = False,
        rerun_share: float = RERUN_SHARE,
    ) -> None:
        if population is not None and population < 2:
            raise ParameterError(f"population = {population}: needs at least 2")
        if not sigma > 0:
            raise ParameterError(f"sigma = {sigma}: must be positive")
        self._cma = load_cmaes().CMA
        super().__init__(rerun_share)
        self.population, self.sigma, self.lr_adapt = population, sigma, lr_adapt

    def _start(self, task: Task, trials: int, seed: int) -> None:  # noqa: ARG002 - the population is as published
        self._rng = np.random.default_rng(seed)
        self._optimizer = self._begin(np.full(len(task.space), 0.5), self.population, narrow_seed(seed))

    def _begin(self, mean: Floats, population: int | None, seed: int) -> Any:
        bounds = np.tile((0.0, 1.0), (len(mean), 1))
        return self._cma(
            mean, self.sigma, bounds, seed=seed, population_size=population, lr_adapt=self.lr_adapt
        )

    def _propose(self) -> Floats:
        self._asked = [self._optimizer.ask() for _ in range(self._optimizer.population_size)]
        return np.array(self._asked)

    def _learn(self, costs: Floats) -> None:
        """Close the generation; one that came back short is dropped, for its ranks would be wrong."""
        optimizer = self._optimizer
        if len(costs) < optimizer.population_size:
            return
        optimizer.tell(list(zip(self._asked, costs.tolist(), strict=True)))
        if optimizer.should_stop():
            mean, seed = self._rng.random(optimizer.dim), int(self._rng.integers(2**32))
            self._optimizer = self._begin(mean, GROWTH * optimizer.population_size, seed)


def load_cmaes() -> Any:
    """Import the library; MissingExtraError where it is not installed."""
    try:
        import cmaes
    except ModuleNotFoundError as error:
        raise MissingExtraError("cmaes", "agents") from error
    return cmaes
