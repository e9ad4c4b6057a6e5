"""Controls: what any tuner has to beat."""

import numpy as np
from numpy.typing import NDArray

from agents.judgement import RERUN_SHARE
from agents.search import Search, ZeroShot
from antgym.errors import ParameterError, nearest
from antgym.tuning import Task

Floats = NDArray[np.float64]
FADING = 7.5
FEWEST_SETS = 10


class UniformRandom(ZeroShot):
    """Recommend one setting drawn uniformly from the unit cube; no trial."""

    def _choose(self, task: Task, seed: int) -> Floats:
        return np.random.default_rng(seed).random(len(task.space))


class PublishedDefault(ZeroShot):
    """Recommend the rule's published setting, the middle of the unit cube; no trial."""

    def _choose(self, task: Task, seed: int) -> Floats:  # noqa: ARG002 - the same for every seed
        return np.full(len(task.space), 0.5)


class RuleOfThumb(ZeroShot):
    """Recommend the published setting, its persistence fitted to the length of a run; no trial.

    ρ = exp(-7.5 / (α T)) over T iterations, α published: what was laid in the first iteration weighs ρ^(α T) = e^-7.5
    as much in the last one, so pheromone fades neither long before the end of a run nor never. Where the rule leaves
    the range of ρ, the range's end is taken; where nothing persists, the published setting is.
    """

    def _choose(self, task: Task, seed: int) -> Floats:  # noqa: ARG002 - the same for every seed
        names, values = task.space.names, task.space.default.copy()
        if "rho" not in names:
            return np.full(len(names), 0.5)
        rho = task.space.parameters[names.index("rho")]
        persistence = np.exp(-FADING / (values[names.index("alpha")] * task.iterations))
        values[names.index("rho")] = np.clip(persistence, rho.low, rho.high)
        return task.space.encode(values)[0]


class RandomSearch(Search):
    """Search with settings that are all drawn beforehand, in one batch, then run the best again.

    Args:
        rerun_share: share of the budget kept to run the best settings again, in [0, 1).
        design: ``"uniform"``, or ``"sobol"``: a scrambled Sobol sequence, which fills the cube more evenly.
    """

    def __init__(self, rerun_share: float = RERUN_SHARE, design: str = "uniform") -> None:
        if design not in DESIGNS:
            raise ParameterError(f"unknown design {design!r}; {nearest(design, tuple(DESIGNS))}")
        super().__init__(rerun_share)
        self.design = design

    def _start(self, task: Task, trials: int, seed: int) -> None:
        self._batch = DESIGNS[self.design](trials, len(task.space), np.random.default_rng(seed))

    def _propose(self) -> Floats:
        batch, self._batch = self._batch, self._batch[:0]
        return batch

    def _learn(self, costs: Floats) -> None:
        """Nothing to learn."""


class TrialAndError(Search):
    """Run random sets equally often and recommend the one of the lowest mean: liu2020's second method.

    The paper tries 1,000 sets, every figure a mean over ten runs. Here the sets are as many as the budget pays for; the
    rest of a division stays unspent, and nothing is kept for re-runs, for the runs are the judgement.

    Args:
        repeats: runs of each set at most, ≥ 1; fewer, and at last one, where the budget would not pay for ten sets.
    """

    def __init__(self, repeats: int = 10) -> None:
        if repeats < 1:
            raise ParameterError(f"repeats = {repeats}: needs at least 1")
        super().__init__(rerun_share=0.0)
        self.repeats = repeats

    def _start(self, task: Task, trials: int, seed: int) -> None:
        repeats = max(1, min(self.repeats, trials // FEWEST_SETS))
        sets = np.random.default_rng(seed).random((trials // repeats, len(task.space)))
        self._left = np.tile(
            sets, (repeats, 1)
        )  # every set once, then again: even where a batch comes back short

    def _propose(self) -> Floats:
        return self._left

    def _learn(self, costs: Floats) -> None:
        self._left = self._left[len(costs) :]


def _uniform(count: int, dimension: int, rng: np.random.Generator) -> Floats:
    return rng.random((count, dimension))


def _sobol(count: int, dimension: int, rng: np.random.Generator) -> Floats:
    from scipy.stats import qmc

    # the first points of the next power of two: scipy warns of any other number
    return qmc.Sobol(dimension, seed=rng).random_base2(max(0, count - 1).bit_length())[:count]


DESIGNS = {"uniform": _uniform, "sobol": _sobol}
