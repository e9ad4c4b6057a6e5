"""Features of a task: the scenario's descriptors, the effort it is planned with, and the colony's rules."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from antgym.maps.features import FEATURES, Feature
from antgym.maps.world import Scenario
from antgym.planners.rules import Rules

EFFORT_FEATURES = (
    Feature("ants", 0.0, 1.0, "log10 of the ants per iteration, / 3"),
    Feature("iterations", 0.0, 1.0, "log10 of the iterations per run, / 4"),
)
RULES_SHOWN = (
    "liu2020",
    "liu2020-paper",
    "ant_system",
    "elitist",
    "rank_based",
    "max_min",
    "ant_colony_system",
    "zhang_apf",
    "zhang_apf-original",
    "zhang2011",
    "zhang2011-basic",
    "wei2018",
    "wei2018-basic",
)
"""Every published rule, in the order of its features. New ones are appended: the order is what policies have learnt."""
RULE_FEATURES = tuple(
    Feature(f"rules_{name}", 0.0, 1.0, f"1 if the colony goes by the rules of {name}") for name in RULES_SHOWN
)
TASK_FEATURES: tuple[Feature, ...] = (*FEATURES, *EFFORT_FEATURES, *RULE_FEATURES)


def task_features(
    scenario: Scenario, ants: int, iterations: int, rules: str | Rules = "liu2020"
) -> NDArray[np.float32]:
    """Return the (len(TASK_FEATURES),) float32 features; nothing in them depends on the optimum.

    Rules that are given as data, not by a published name, are shown as none of the published ones.
    """
    effort = np.clip([np.log10(ants) / 3, np.log10(iterations) / 4], 0.0, 1.0)
    shown = [name == rules for name in RULES_SHOWN]
    return np.concatenate([scenario.descriptors, effort, shown]).astype(np.float32)


def feature_bounds(features: Sequence[Feature]) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return (low, high) of some features, float32 both."""
    low, high = [f.low for f in features], [f.high for f in features]
    return np.array(low, dtype=np.float32), np.array(high, dtype=np.float32)


def shown_rules(features: NDArray[np.float32]) -> str | None:
    """Return the published rules that the features of a task show; None where they show rules of one's own."""
    first = TASK_FEATURES.index(RULE_FEATURES[0])
    shown = np.flatnonzero(features[first : first + len(RULES_SHOWN)])
    return RULES_SHOWN[shown[0]] if len(shown) else None
