"""Regression, then argmin: what trees or nets predict that settings cost on a map, asked about the new map."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from agents.ensemble import Ensemble, as_ensemble
from agents.experience import Experience, as_experience
from agents.halving import Advice, Halving
from agents.neighbours import blended_advice
from antgym.errors import MissingExtraError, ParameterError
from antgym.tuning import Task

Floats = NDArray[np.float64]
TREES, SHARE, LEAF, TAU = 200, 0.5, 3, 0.03
"""Without a trial, on 50 validation maps of mountain-v0 and 100 of open-v0, the blend's gap was 19.0 and 29.0 % with
trees, 19.5 and 28.5 % with nets; with tau = 0.1 and trees 20.7 and 31.1 %, that of the best setting 19.1 and 28.3 %."""


class ForestAgent(Halving):
    """An empirical performance model: extra trees from a map's features to the log regrets of all settings at once.

    A forest is fitted to all maps of an experience when the agent is made, always alike (half of the features a split,
    three maps a leaf), so that the artefact holds data and no code; with 1,600 maps that takes some seconds. Its trees
    are cases of what the map may be like: they are averaged and blended, and blend and settings are then tried, as
    those of the neighbours are.

    Args:
        experience: costs on train maps, or their file.
        trees: trees of the forest, ≥ 1.
        tau: log cost by which a setting's weight in the blend falls to 1/e, > 0.

    Raises:
        MissingExtraError: where scikit-learn is not installed.
    """

    def __init__(self, experience: Experience | str | Path, trees: int = TREES, tau: float = TAU) -> None:
        _require_positive(tau)
        self.experience, self.tau = as_experience(experience), tau
        forest = _forest_class()(trees, max_features=SHARE, min_samples_leaf=LEAF, random_state=0)
        self._forest = forest.fit(self.experience.described_maps, self.experience.regrets)

    def _advise(self, task: Task) -> Advice:
        self.experience.check(task)
        described = self.experience.standardise(task.features.astype(np.float64))[None]
        trees = np.array([tree.predict(described).ravel() for tree in self._forest.estimators_])
        return blended_advice(task.space, self.experience, trees, _alike(trees), self.tau)


class EnsembleAgent(Halving):
    """The same by nets, each of which is a case of what the map may be like; fitted before, see ``agents.ensemble``.

    Args:
        ensemble: the nets, or either of their files.
        tau: log cost by which a setting's weight in the blend falls to 1/e, > 0.
    """

    def __init__(self, ensemble: Ensemble | str | Path, tau: float = TAU) -> None:
        _require_positive(tau)
        self.ensemble, self.tau = as_ensemble(ensemble), tau

    def _advise(self, task: Task) -> Advice:
        nets = self.ensemble.predict(task)
        return blended_advice(task.space, self.ensemble, nets, _alike(nets), self.tau)


def _alike(cases: Floats) -> Floats:
    """Return the weights of cases of which none is likelier than another."""
    return np.full(len(cases), 1 / len(cases))


def _require_positive(tau: float) -> None:
    if not tau > 0:
        raise ParameterError(f"tau = {tau}: must be positive")


def _forest_class() -> Any:
    try:
        from sklearn.ensemble import ExtraTreesRegressor
    except ModuleNotFoundError as error:
        raise MissingExtraError("scikit-learn", "agents") from error
    return ExtraTreesRegressor
