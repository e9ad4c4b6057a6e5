"""CMA-ES that starts where settings did well on similar train maps (Nomura et al. 2021, arXiv 2012.06932)."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from agents.covariance import load_cmaes
from agents.experience import Experience, as_experience
from agents.judgement import RERUN_SHARE
from agents.neighbours import NEIGHBOURS, nearest_maps
from agents.search import Search, narrow_seed
from antgym.errors import ParameterError
from antgym.tuning import COST_CAP, Task, Trial

Floats = NDArray[np.float64]
SMALLEST_POPULATION = 4
GENERATIONS = 3  # that a search should have before its populations grow to the library's default


class WarmCmaEs(Search):
    """CMA-ES of the ``cmaes`` package, its first distribution fitted to trials on the nearest train maps.

    The source task is the mean of the nearest maps: its solutions are the settings of the experience with the
    neighbours' weighted mean of their log regrets, and the best share ``gamma`` of them gives mean, step and covariance
    (``cmaes.get_warm_start_mgd``). Pooling the maps' own best trials instead mixes settings that are each fatal on
    another's map: the mean of those lost 60 % on mountain-v0 where this one loses 24 %. The mean is run first: it is
    what the experience itself suggests, and what is recommended as long as no trial found a path.

    Args:
        experience: costs on train maps, or their file.
        neighbours: how many maps make up the source task, ≥ 1.
        gamma: share of the settings that counts as promising, in (0, 1].
        alpha: prior standard deviation added to the fitted one, > 0.
        rerun_share: share of the budget kept to run the best settings again, in [0, 1).
    """

    def __init__(
        self,
        experience: Experience | str | Path,
        neighbours: int = NEIGHBOURS,
        gamma: float = 0.1,
        alpha: float = 0.1,
        rerun_share: float = RERUN_SHARE,
    ) -> None:
        if neighbours < 1 or not 0 < gamma <= 1 or not alpha > 0:
            raise ParameterError(
                f"neighbours = {neighbours} must be ≥ 1, gamma = {gamma} in (0, 1], alpha = {alpha} positive"
            )
        self._cmaes = load_cmaes()
        super().__init__(rerun_share)
        self.experience = as_experience(experience)
        self.neighbours, self.gamma, self.alpha = neighbours, gamma, alpha

    def tell(self, trials: Sequence[Trial]) -> None:
        """Learn from trials, as every search does."""
        self._found |= any(trial.cost < COST_CAP for trial in trials)
        super().tell(trials)

    def recommend(self) -> Floats:
        """Return the (d,) setting with the lowest expected cost; the warm start's mean before any success."""
        return super().recommend() if self._found else self._centre.copy()

    def source_solutions(self, task: Task) -> list[tuple[Floats, float]]:
        """Return every setting with its expected log regret on maps like the task's."""
        nearest, weights = nearest_maps(self.experience, task, self.neighbours)
        expected = weights @ self.experience.regrets[nearest]
        return list(zip(self.experience.settings, expected.tolist(), strict=True))

    def _start(self, task: Task, trials: int, seed: int) -> None:
        self.experience.check(task)
        solutions, d = self.source_solutions(task), len(task.space)
        promising = max(self.gamma, min(1.0, 1.5 / len(solutions)))  # the library needs one setting at least
        mean, sigma, cov = self._cmaes.get_warm_start_mgd(solutions, gamma=promising, alpha=self.alpha)
        self._centre, self._found, self._asked = np.clip(mean, 0.0, 1.0), False, np.empty((0, d))
        self._at_centre = False
        default = 4 + int(3 * np.log(d))
        self._optimizer = self._cmaes.CMA(
            mean=self._centre,
            sigma=sigma,
            cov=cov,
            bounds=np.tile([0.0, 1.0], (d, 1)),
            seed=narrow_seed(seed),
            population_size=min(default, max(SMALLEST_POPULATION, (trials - 1) // GENERATIONS)),
        )

    def _propose(self) -> Floats:
        if not self._at_centre:
            self._at_centre, self._asked = True, np.empty((0, len(self._centre)))
            return self._centre[None].copy()
        self._asked = np.array([self._optimizer.ask() for _ in range(self._optimizer.population_size)])
        return self._asked

    def _learn(self, costs: Floats) -> None:
        """Tell a whole population; the library cannot learn from a part of one."""
        if len(costs) == len(self._asked):
            self._optimizer.tell(list(zip(self._asked, costs.tolist(), strict=True)))
