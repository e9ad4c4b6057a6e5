"""Nearest neighbours among train maps: what did well on maps like this one, blended."""

from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from agents.experience import Experience, Spread, as_experience
from agents.halving import Advice, Halving
from agents.ordering import greedy_portfolio
from antgym.errors import ParameterError
from antgym.tuning import ParameterSpace, Task

Floats = NDArray[np.float64]
NEIGHBOURS, TAU = 20, 0.1
"""Chosen on 60 train maps of mountain-v0, each left out in turn: without a trial, the blend's gap was 16.9 % (16.8 %
with tau = 0.05), that of the setting that did best on the neighbours 18.5 %, of that best on all maps 22.8 %."""


class Known(Protocol):
    """What a blend needs of an experience, or of what was fitted to one."""

    @property
    def settings(self) -> Floats:
        """The settings, (k, d) in [0, 1]."""
        ...

    @property
    def spread(self) -> Spread:
        """How far runs and maps differ."""
        ...


def blended_advice(
    space: ParameterSpace, known: Known, regrets: Floats, weights: Floats, tau: float
) -> Advice:
    """Return the settings of an experience in the order to try them on a target, and before them their blend.

    The blend is the mean of all settings on each parameter's own scale, weighted by exp(-(μ - min μ) / tau) with μ the
    expected log regret. A single setting's table entry is lucky or not; the blend lies where many good ones lie. After
    it the settings come as a greedy portfolio, so that each is tried for the case that those before it fail.

    Args:
        space: the target's.
        known: whose settings they are.
        regrets: (s, k) log regret of every setting in s cases of what the target may be like.
        weights: (s,) probabilities of the cases.
        tau: log cost by which a setting's weight falls to 1/e, > 0.
    """
    expected = weights @ regrets
    shares = np.exp(-(expected - expected.min()) / tau)
    blend = space.mean(known.settings, shares / shares.sum())
    order = greedy_portfolio(regrets, weights=weights)
    candidates = np.vstack([blend, known.settings[order]])
    return Advice(candidates, np.concatenate([[expected.min()], expected[order]]), known.spread)


class NeighbourAgent(Halving):
    """Blend the settings that did well on the train maps nearest by features, then try blend and settings.

    Features are standardised over the train maps; neighbours have the task's own rules, where at least eight maps have.
    The j-th of k neighbours weighs exp(-d_j / d_k), with d the squared distance.

    Args:
        experience: costs on train maps, or their file.
        neighbours: how many maps speak, ≥ 1; all where there are fewer.
        tau: log cost by which a setting's weight in the blend falls to 1/e, > 0.
    """

    def __init__(
        self, experience: Experience | str | Path, neighbours: int = NEIGHBOURS, tau: float = TAU
    ) -> None:
        if neighbours < 1 or not tau > 0:
            raise ParameterError(f"neighbours = {neighbours} must be ≥ 1 and tau = {tau} positive")
        self.experience = as_experience(experience)
        self.neighbours, self.tau = neighbours, tau

    def _advise(self, task: Task) -> Advice:
        self.experience.check(task)
        nearest, weights = nearest_maps(self.experience, task, self.neighbours)
        return blended_advice(
            task.space, self.experience, self.experience.regrets[nearest], weights, self.tau
        )


def nearest_maps(experience: Experience, task: Task, count: int) -> tuple[NDArray[np.intp], Floats]:
    """Return the ``count`` akin maps nearest to a task, nearest first, and their weights, which add up to 1."""
    akin = experience.akin(task)
    distances = experience.distances(task)[akin]
    nearest = np.argsort(distances, kind="stable")[:count]
    farthest = max(float(distances[nearest[-1]]), np.finfo(float).tiny)
    weights = np.exp(-distances[nearest] / farthest)
    return akin[nearest], weights / weights.sum()
