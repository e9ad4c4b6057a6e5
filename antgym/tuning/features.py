"""Features of a task: the scenario's descriptors and the effort it is planned with."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from antgym.maps.features import FEATURES, Feature
from antgym.maps.world import Scenario

EFFORT_FEATURES = (
    Feature("ants", 0.0, 1.0, "log10 of the ants per iteration, / 3"),
    Feature("iterations", 0.0, 1.0, "log10 of the iterations per run, / 4"),
)
TASK_FEATURES: tuple[Feature, ...] = (*FEATURES, *EFFORT_FEATURES)


def task_features(scenario: Scenario, ants: int, iterations: int) -> NDArray[np.float32]:
    """Return the (len(TASK_FEATURES),) float32 features; nothing in them depends on the optimum."""
    effort = np.clip([np.log10(ants) / 3, np.log10(iterations) / 4], 0.0, 1.0)
    return np.concatenate([scenario.descriptors, effort]).astype(np.float32)


def feature_bounds(features: Sequence[Feature]) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return (low, high) of some features, float32 both."""
    low, high = [f.low for f in features], [f.high for f in features]
    return np.array(low, dtype=np.float32), np.array(high, dtype=np.float32)
