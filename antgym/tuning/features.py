"""Features of a task: the scenario's descriptors, the effort it is planned with, and the swarm's rules.

Grids and disc worlds have tables of their own, each with the rules that there are for it: what an agent has learnt of
one kind does not change with the other.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antgym.maps.disc_features import DISC_FEATURES
from antgym.maps.discs import DiscWorld
from antgym.maps.features import FEATURES, Feature
from antgym.maps.fleet import Fleet
from antgym.maps.world import Scenario
from antgym.planners.planning import AnyRules
from antgym.tuning.naive import NAIVE_FEATURES, naive_features

_RULES = "rules_"  # how the name of a feature begins that shows a rule
EFFORT_FEATURES = (
    Feature("ants", 0.0, 1.0, "log10 of the ants per iteration, or of the bees, / 3"),
    Feature("iterations", 0.0, 1.0, "log10 of the iterations per run, or of the cycles, / 4"),
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
"""Every published rule of ants, in the order of its features. New ones are appended: the order is what policies have
learnt."""
BEE_RULES_SHOWN = (
    "wu2018",
    "wu2018-paper",
    "wu2018-basic",
    "wu2018-basic-paper",
    "abc_standard",
    "abc_gbest",
    "wu2018-4",
    "abc_standard-4",
    "abc_gbest-4",
)
"""Likewise of bees."""


def _rule_features(names: Sequence[str]) -> tuple[Feature, ...]:
    return tuple(
        Feature(f"{_RULES}{name}", 0.0, 1.0, f"1 if the colony goes by the rules of {name}") for name in names
    )


TASK_FEATURES: tuple[Feature, ...] = (
    *FEATURES,
    *EFFORT_FEATURES,
    *NAIVE_FEATURES,
    *_rule_features(RULES_SHOWN),
)
DISC_TASK_FEATURES: tuple[Feature, ...] = (
    *DISC_FEATURES,
    *EFFORT_FEATURES,
    *_rule_features(BEE_RULES_SHOWN),
)


def task_features(
    scenario: Scenario[Any, Any] | Fleet, ants: int, iterations: int, rules: AnyRules = "liu2020"
) -> NDArray[np.float32]:
    """Return the float32 features of :func:`task_table`; nothing in them depends on the optimum.

    Rules that are given as data, not by a published name, are shown as none of the published ones.
    """
    effort = np.clip([np.log10(ants) / 3, np.log10(iterations) / 4], 0.0, 1.0)
    discs = isinstance(scenario.world, DiscWorld)
    shown = [name == rules for name in (BEE_RULES_SHOWN if discs else RULES_SHOWN)]
    naive = np.empty(0) if discs else naive_features(scenario, rules)
    return np.concatenate([scenario.descriptors, effort, naive, shown]).astype(np.float32)


def task_table(discs: bool) -> tuple[Feature, ...]:
    """Return the table of the features of tasks among discs, or on grids."""
    return DISC_TASK_FEATURES if discs else TASK_FEATURES


def is_rule(feature: Feature) -> bool:
    """Return whether a feature shows which rules a task has."""
    return feature.name.startswith(_RULES)


def feature_bounds(features: Sequence[Feature]) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return (low, high) of some features, float32 both."""
    low, high = [f.low for f in features], [f.high for f in features]
    return np.array(low, dtype=np.float32), np.array(high, dtype=np.float32)


def shown_rules(features: NDArray[np.float32]) -> str | None:
    """Return the published rules that the features of a task show; None where they show rules of one's own."""
    table = DISC_TASK_FEATURES if len(features) == len(DISC_TASK_FEATURES) else TASK_FEATURES
    shown = (f.name for f, value in zip(table, features, strict=True) if value and is_rule(f))
    return next(shown, "").removeprefix(_RULES) or None
