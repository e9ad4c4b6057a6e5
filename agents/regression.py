"""Regression, then argmin: a forest that predicts the cost of a setting on a map, asked about the new map."""

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from agents.experience import Experience, as_experience
from agents.halving import Advice, Halving
from agents.neighbours import TAU, blended_advice
from antgym.errors import MissingExtraError
from antgym.tuning import Task

Floats = NDArray[np.float64]


class ForestAgent(Halving):
    """An empirical performance model: a random forest from (features, setting) to log cost over the map's best.

    A forest is fitted when a task comes, to the train maps under its own rules (to all, where fewer than eight are),
    always alike (100 trees, a third of the inputs per split, two samples a leaf), and kept for others of the kind, so
    that the artefact holds data and no code. It predicts every setting of the experience, each tree as a case of what
    the map may be like; blend and settings are then tried, as the neighbours' are.

    Args:
        experience: costs on train maps, or their file.
        trees: trees of the forest, ≥ 1.
        tau: log cost by which a setting's weight in the blend falls to 1/e, > 0.

    Raises:
        MissingExtraError: where scikit-learn is not installed.
    """

    def __init__(self, experience: Experience | str | Path, trees: int = 100, tau: float = TAU) -> None:
        self.experience, self.tau = as_experience(experience), tau
        self._new_forest = partial(
            _forest_class(), trees, max_features=1 / 3, min_samples_leaf=2, random_state=0
        )
        self._forests: dict[bytes, Any] = {}  # by the maps that they are fitted to

    def _advise(self, task: Task) -> Advice:
        self.experience.check(task)
        settings = self.experience.settings
        described = self.experience.standardise(task.features.astype(np.float64))
        rows = np.hstack([np.tile(described, (len(settings), 1)), settings])
        forest = self._forest(self.experience.akin(task))
        trees = np.array([tree.predict(rows) for tree in forest.estimators_])
        alike = np.full(len(trees), 1 / len(trees))
        return blended_advice(task.space, self.experience, trees, alike, self.tau)

    def _forest(self, akin: NDArray[np.intp]) -> Any:
        if akin.tobytes() not in self._forests:
            maps, settings = self.experience.described_maps[akin], self.experience.settings
            rows = np.hstack([np.repeat(maps, len(settings), axis=0), np.tile(settings, (len(maps), 1))])
            self._forests[akin.tobytes()] = self._new_forest().fit(
                rows, self.experience.regrets[akin].ravel()
            )
        return self._forests[akin.tobytes()]


def _forest_class() -> Any:
    try:
        from sklearn.ensemble import RandomForestRegressor
    except ModuleNotFoundError as error:
        raise MissingExtraError("scikit-learn", "agents") from error
    return RandomForestRegressor
